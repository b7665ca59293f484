//! `slcal demo`.

use std::path::PathBuf;

use clap::Args;

#[derive(Debug, Args)]
pub(crate) struct DemoArgs {
    /// Where to put the files; made when it does not exist.
    #[arg(long, value_name = "DIR", default_value = "slcal-demo")]
    pub(crate) out: PathBuf,
    /// Replace files that exist.
    #[arg(long)]
    pub(crate) force: bool,
}
