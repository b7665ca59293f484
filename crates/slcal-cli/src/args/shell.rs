//! `slcal completions` and `slcal man`.

use std::path::PathBuf;

use clap::Args;
use clap_complete::Shell;

use super::headings::OUTPUT;

#[derive(Debug, Args)]
pub(crate) struct CompletionsArgs {
    /// Whose script to print.
    #[arg(value_enum)]
    pub(crate) shell: Shell,
}

#[derive(Debug, Args)]
pub(crate) struct ManArgs {
    /// A folder for one page per verb; without it the main page goes to stdout.
    #[arg(long, value_name = "DIR", help_heading = OUTPUT)]
    pub(crate) out: Option<PathBuf>,
    /// Replace files that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
