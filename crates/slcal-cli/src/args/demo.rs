//! `slcal demo`.

use std::path::PathBuf;

use clap::Args;

use super::headings::OUTPUT;

#[derive(Debug, Args)]
pub(crate) struct DemoArgs {
    /// Folder for the files; created when it does not exist.
    #[arg(long, value_name = "DIR", default_value = "slcal-demo", help_heading = OUTPUT)]
    pub(crate) out: PathBuf,
    /// Replace outputs that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
