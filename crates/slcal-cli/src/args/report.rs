//! `slcal report`.

use std::path::PathBuf;

use clap::{ArgAction, Args};

use super::headings::{INPUT, OUTPUT};
use super::photo::GammaArg;

#[derive(Debug, Args)]
pub(crate) struct ReportArgs {
    /// The rig to show.
    #[arg(long, value_name = "RIG.json", help_heading = INPUT)]
    pub(crate) rig: PathBuf,
    /// Where to write the report; `-` for stdout.
    #[arg(short, long, value_name = "REPORT.html", help_heading = OUTPUT)]
    pub(crate) output: PathBuf,
    /// A photograph that the rig was calibrated from; repeat it once per view, in the order of the views. Without it they are
    /// looked for by the names in the rig, beside it and in the current folder.
    #[arg(long, value_name = "PHOTO", action = ArgAction::Append, help_heading = INPUT)]
    pub(crate) photo: Vec<PathBuf>,
    /// What was found in the photographs (`slcal calibrate --save-observations`): the report shows the residuals.
    #[arg(long, value_name = "FILE.json", conflicts_with = "pattern", help_heading = INPUT)]
    pub(crate) observations: Option<PathBuf>,
    /// The checkerboard that was projected: it is looked for in the photographs again, for the residuals.
    #[arg(long, value_name = "FILE.json", help_heading = INPUT)]
    pub(crate) pattern: Option<PathBuf>,
    /// A cloud that was made with the rig, to show beside it.
    #[arg(long, value_name = "CLOUD.ply", help_heading = INPUT)]
    pub(crate) cloud: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) gamma: GammaArg,
    /// Replace files that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
