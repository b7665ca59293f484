//! `slcal decode`, and what every decoding needs.

use std::path::{Path, PathBuf};

use clap::Args;

use super::headings::{INPUT, OUTPUT};
use super::photo::GammaArg;

#[derive(Debug, Args)]
pub(crate) struct DecodeArgs {
    /// The photograph; `-` for stdin.
    pub(crate) image: PathBuf,
    #[command(flatten)]
    pub(crate) input: DecodeInput,
    /// Where to write the matches; `-` for stdout.
    #[arg(short, long, value_name = "MATCHES.csv", help_heading = OUTPUT)]
    pub(crate) output: PathBuf,
    /// Draw the stripes that were decoded on the photograph.
    #[arg(long, value_name = "FILE.png", help_heading = OUTPUT)]
    pub(crate) overlay: Option<PathBuf>,
    /// Print the report as JSON instead of a summary.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// Replace files that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}

/// What decoding needs.
#[derive(Debug, Args)]
pub(crate) struct DecodeInput {
    /// The stripes that were projected.
    #[arg(long, value_name = "STRIPES.json", help_heading = INPUT)]
    pub(crate) pattern: PathBuf,
    /// The same view with the projector dark.
    #[arg(long, value_name = "IMAGE", help_heading = INPUT)]
    pub(crate) black: Option<PathBuf>,
    /// The same view under the projector's full white.
    #[arg(long, value_name = "IMAGE", help_heading = INPUT)]
    pub(crate) white: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) gamma: GammaArg,
}

impl DecodeInput {
    /// All files that are read.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        [Some(&self.pattern), self.black.as_ref(), self.white.as_ref()]
            .into_iter()
            .flatten()
            .map(PathBuf::as_path)
    }
}
