//! `slcal rectify`.

use std::path::PathBuf;

use clap::Args;

use super::headings::{INPUT, OUTPUT};

#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("what").required(true))]
pub(crate) struct RectifyArgs {
    /// Calibrated rig. The sheet must still stand where it stood in its first view.
    #[arg(long, value_name = "RIG.json", help_heading = INPUT)]
    pub(crate) rig: PathBuf,
    /// Checkerboard to draw.
    ///
    /// It is drawn anew, not resampled.
    #[arg(long, value_name = "FILE.json", group = "what", help_heading = INPUT)]
    pub(crate) pattern: Option<PathBuf>,
    /// Picture to show.
    #[arg(long, value_name = "FILE", group = "what", help_heading = INPUT)]
    pub(crate) image: Option<PathBuf>,
    /// PNG file for the picture to project; `-` for stdout.
    #[arg(short, long, value_name = "FILE.png", help_heading = OUTPUT)]
    pub(crate) output: PathBuf,
    /// Replace outputs that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
