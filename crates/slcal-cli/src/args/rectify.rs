//! `slcal rectify`.

use std::path::PathBuf;

use clap::Args;

#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("what").required(true))]
pub(crate) struct RectifyArgs {
    /// The calibrated rig, with the sheet where it is now.
    #[arg(long, value_name = "RIG.json")]
    pub(crate) rig: PathBuf,
    /// A checkerboard to draw anew.
    #[arg(long, value_name = "FILE.json", group = "what")]
    pub(crate) pattern: Option<PathBuf>,
    /// A picture to show.
    #[arg(long, value_name = "FILE", group = "what")]
    pub(crate) image: Option<PathBuf>,
    /// The picture to project; `-` for stdout.
    #[arg(short, long, value_name = "FILE.png")]
    pub(crate) output: PathBuf,
    /// Replace files that exist.
    #[arg(long)]
    pub(crate) force: bool,
}
