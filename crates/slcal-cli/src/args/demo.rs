//! `slcal demo`.

use std::path::PathBuf;

use clap::Args;

use super::headings::OUTPUT;

#[derive(Debug, Args)]
pub(crate) struct DemoArgs {
    /// Where to put the files; made when it does not exist.
    #[arg(long, value_name = "DIR", default_value = "slcal-demo", help_heading = OUTPUT)]
    pub(crate) out: PathBuf,
    /// Replace files that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
