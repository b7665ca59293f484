//! `slcal report`.

use std::path::PathBuf;

use clap::{ArgAction, Args};

use super::headings::{INPUT, OUTPUT};
use super::photo::GammaArg;

#[derive(Debug, Args)]
pub(crate) struct ReportArgs {
    /// Rig to show.
    #[arg(long, value_name = "RIG.json", help_heading = INPUT)]
    pub(crate) rig: PathBuf,
    /// HTML file for the report; `-` for stdout.
    #[arg(short, long, value_name = "REPORT.html", help_heading = OUTPUT)]
    pub(crate) output: PathBuf,
    /// Photograph of a view; repeat it once per view, in the order of the views. A folder or a name with * or ? stands
    /// for several.
    ///
    /// Without it, photographs are looked for by the names in the rig, in the folder of the rig and below it.
    #[arg(long, value_name = "PHOTO", action = ArgAction::Append, help_heading = INPUT)]
    pub(crate) photo: Vec<PathBuf>,
    /// Follow the names of photographs in the rig wherever they lead, as absolute paths and with `..`.
    ///
    /// A rig from somebody else could name a picture of yours, and the report would carry it.
    #[arg(long, help_heading = INPUT)]
    pub(crate) allow_paths: bool,
    /// Measurements in the photographs (`slcal calibrate --save-observations`); the report then shows the residuals.
    #[arg(long, value_name = "FILE.json", conflicts_with = "pattern", help_heading = INPUT)]
    pub(crate) observations: Option<PathBuf>,
    /// Checkerboard that was projected. It is detected in the photographs again, and the report then shows the
    /// residuals.
    #[arg(long, value_name = "FILE.json", help_heading = INPUT)]
    pub(crate) pattern: Option<PathBuf>,
    /// Cloud that was reconstructed with the rig, to show beside it.
    #[arg(long, value_name = "CLOUD.ply", help_heading = INPUT)]
    pub(crate) cloud: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) gamma: GammaArg,
    /// Replace outputs that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
