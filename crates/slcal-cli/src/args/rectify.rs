//! `slcal rectify`.

use std::path::PathBuf;

use clap::Args;

use super::headings::{INPUT, OUTPUT};

#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("what").required(true))]
pub(crate) struct RectifyArgs {
    /// The calibrated rig, with the sheet where it is now.
    #[arg(long, value_name = "RIG.json", help_heading = INPUT)]
    pub(crate) rig: PathBuf,
    /// A checkerboard to draw anew.
    #[arg(long, value_name = "FILE.json", group = "what", help_heading = INPUT)]
    pub(crate) pattern: Option<PathBuf>,
    /// A picture to show.
    #[arg(long, value_name = "FILE", group = "what", help_heading = INPUT)]
    pub(crate) image: Option<PathBuf>,
    /// The picture to project; `-` for stdout.
    #[arg(short, long, value_name = "FILE.png", help_heading = OUTPUT)]
    pub(crate) output: PathBuf,
    /// Replace files that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
