//! `slcal export` and `slcal import`.

use std::path::PathBuf;

use clap::Args;
use slcal_core::format::ExchangeFormat;

use super::headings::{INPUT, OUTPUT};
use super::value::{choice, parse_pair};

#[derive(Debug, Args)]
pub(crate) struct ExportArgs {
    /// Rig to write.
    #[arg(long, value_name = "RIG.json", help_heading = INPUT)]
    pub(crate) rig: PathBuf,
    /// Format to write. npz holds NumPy arrays.
    #[arg(long, value_name = "FORMAT", value_parser = choice::<ExchangeFormat>(ExchangeFormat::NAMES),
          ignore_case = true, help_heading = OUTPUT)]
    pub(crate) to: ExchangeFormat,
    /// File to write; `-` for stdout where the format has one file.
    ///
    /// opencv: .yml, .xml or .json. ros: the .yaml of the camera (the one of the projector is written beside it), or a
    /// folder. colmap: a folder. kalibr: .yaml. blender: .py. npz: .npz.
    #[arg(short, long, value_name = "FILE", help_heading = OUTPUT)]
    pub(crate) output: PathBuf,
    /// Leave out what the format cannot hold, even where this moves pixels, and report by how much.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) lossy: bool,
    /// Print the result as JSON instead of a summary.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// Replace outputs that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ImportArgs {
    /// Files to read, or their folder; `-` for stdin.
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Format of the files [default: detected from their content].
    #[arg(long, value_name = "FORMAT", value_parser = choice::<ExchangeFormat>(ExchangeFormat::NAMES),
          ignore_case = true, help_heading = INPUT)]
    pub(crate) from: Option<ExchangeFormat>,
    /// File for the rig; `-` for stdout.
    #[arg(short, long, value_name = "RIG.json", help_heading = OUTPUT)]
    pub(crate) output: PathBuf,
    /// Size of the camera images, for files that do not state it.
    #[arg(long, value_name = "WxH", value_parser = parse_pair, help_heading = INPUT)]
    pub(crate) camera_size: Option<[u32; 2]>,
    /// Size of the projector panel, for files that do not state it.
    #[arg(long, value_name = "WxH", value_parser = parse_pair, help_heading = INPUT)]
    pub(crate) projector_size: Option<[u32; 2]>,
    /// Print the result as JSON instead of a summary.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// Replace outputs that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
