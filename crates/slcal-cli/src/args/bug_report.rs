//! `slcal bug-report`.

use std::path::PathBuf;

use clap::{ArgAction, Args};

use super::headings::{INPUT, OUTPUT};

#[derive(Debug, Args)]
pub(crate) struct BugReportArgs {
    /// Folder with the rig, the observations (`slcal calibrate --save-observations`), the descriptions of the patterns and the
    /// photographs.
    #[arg(value_name = "DIR", help_heading = INPUT)]
    pub(crate) folder: PathBuf,
    /// A command that went wrong, as it was typed; repeat it for several. Those of the studio are in its folder.
    #[arg(long, value_name = "COMMAND", action = ArgAction::Append, help_heading = INPUT)]
    pub(crate) command: Vec<String>,
    /// Archive to write; `-` for stdout.
    #[arg(short, long, value_name = "FILE.zip", default_value = "bug-report.zip", help_heading = OUTPUT)]
    pub(crate) output: PathBuf,
    /// Longest side of a photograph's thumbnail, px; 0 packs none.
    #[arg(long, value_name = "PX", default_value_t = 640, value_parser = clap::value_parser!(u32).range(0..=4096),
          help_heading = OUTPUT)]
    pub(crate) thumbnail: u32,
    /// Only show what would be packed.
    #[arg(short = 'n', long, help_heading = OUTPUT)]
    pub(crate) dry_run: bool,
    /// Replace outputs that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
