//! `slcal export` and `slcal import`.

use std::path::PathBuf;

use clap::Args;
use slcal_core::format::ExchangeFormat;

use super::headings::{INPUT, OUTPUT};
use super::value::{choice, parse_pair};

#[derive(Debug, Args)]
pub(crate) struct ExportArgs {
    /// The rig to write.
    #[arg(long, value_name = "RIG.json", help_heading = INPUT)]
    pub(crate) rig: PathBuf,
    /// For which program: opencv, ros, colmap, kalibr, blender or npz (NumPy).
    #[arg(long, value_name = "FORMAT", value_parser = choice::<ExchangeFormat>(ExchangeFormat::NAMES), ignore_case = true, help_heading = OUTPUT)]
    pub(crate) to: ExchangeFormat,
    /// The file; `-` for stdout. opencv: .yml, .xml or .json; ros: the camera's .yaml (the projector's goes beside it), or a folder;
    /// colmap: a folder; kalibr: .yaml; blender: .py; npz: .npz.
    #[arg(short, long, value_name = "FILE", help_heading = OUTPUT)]
    pub(crate) output: PathBuf,
    /// Leave out what the format has no place for even where it moves pixels, and say by how much.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) lossy: bool,
    /// Print the result as JSON instead of a summary.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// Replace files that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ImportArgs {
    /// The files, or the folder that they are in; `-` for stdin.
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Whose files they are: opencv, ros, colmap, kalibr, blender or npz [default: told by their content].
    #[arg(long, value_name = "FORMAT", value_parser = choice::<ExchangeFormat>(ExchangeFormat::NAMES), ignore_case = true, help_heading = INPUT)]
    pub(crate) from: Option<ExchangeFormat>,
    /// The rig; `-` for stdout.
    #[arg(short, long, value_name = "RIG.json", help_heading = OUTPUT)]
    pub(crate) output: PathBuf,
    /// Size of the camera's images, for files that do not say it.
    #[arg(long, value_name = "WxH", value_parser = parse_pair, help_heading = INPUT)]
    pub(crate) camera_size: Option<[u32; 2]>,
    /// Size of the projector's panel, for files that do not say it.
    #[arg(long, value_name = "WxH", value_parser = parse_pair, help_heading = INPUT)]
    pub(crate) projector_size: Option<[u32; 2]>,
    /// Print the result as JSON instead of a summary.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// Replace files that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
