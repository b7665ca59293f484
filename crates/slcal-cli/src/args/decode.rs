//! `slcal decode`, and what every decoding needs.

use std::path::{Path, PathBuf};

use clap::Args;

use super::headings::{INPUT, OUTPUT};
use super::photo::{GammaArg, MirrorArg};

#[derive(Debug, Args)]
pub(crate) struct DecodeArgs {
    /// Photograph of the stripes; `-` for stdin. Of a sequence, the folder of its frames, or the frames.
    ///
    /// The photographs of a folder are the frames in natural order of their names, unless the pattern names files that are there.
    #[arg(required = true, value_name = "IMAGE")]
    pub(crate) images: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) input: DecodeInput,
    /// Calibrated rig: its registration of the colour channels is used.
    ///
    /// Without it the registration is estimated from the stripes where they show it.
    #[arg(long, value_name = "RIG.json", help_heading = INPUT)]
    pub(crate) rig: Option<PathBuf>,
    /// File for the matches, .csv or, of a sequence, .npz; `-` for CSV on stdout.
    #[arg(short, long, value_name = "MATCHES.csv", help_heading = OUTPUT)]
    pub(crate) output: PathBuf,
    /// Draw the decoded stripes on the photograph; of a sequence, the projector column of every pixel.
    #[arg(long, value_name = "FILE.png", help_heading = OUTPUT)]
    pub(crate) overlay: Option<PathBuf>,
    /// Print the result as JSON instead of a summary.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// Replace outputs that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}

/// What decoding needs.
#[derive(Debug, Args)]
pub(crate) struct DecodeInput {
    /// Description of what was projected: stripes or a sequence (`slcal pattern` writes it).
    #[arg(long, value_name = "PATTERN.json", help_heading = INPUT)]
    pub(crate) pattern: PathBuf,
    /// Photograph of the same view with the projector dark.
    ///
    /// It helps on coloured surfaces and in bright rooms.
    #[arg(long, value_name = "IMAGE", help_heading = INPUT)]
    pub(crate) black: Option<PathBuf>,
    /// Photograph of the same view with the projector all white.
    ///
    /// It helps on coloured surfaces and in bright rooms.
    #[arg(long, value_name = "IMAGE", help_heading = INPUT)]
    pub(crate) white: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) mirror: MirrorArg,
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
