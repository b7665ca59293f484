//! `slcal reconstruct`.

use std::path::PathBuf;

use clap::Args;

use super::cloud::{CloudArgs, CullArg, parse_cull};
use super::decode::DecodeInput;

#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("place").required(true))]
pub(crate) struct ReconstructArgs {
    /// Photographs of the object under the stripes; `-` for stdin.
    #[arg(required = true, value_name = "IMAGE")]
    pub(crate) images: Vec<PathBuf>,
    /// The calibrated rig.
    #[arg(long, value_name = "RIG.json")]
    pub(crate) rig: PathBuf,
    #[command(flatten)]
    pub(crate) input: DecodeInput,
    #[command(flatten)]
    pub(crate) shape: CloudArgs,
    /// Which triangles, and with them lone points, are removed: auto, off, or those above an area in mm².
    #[arg(long, value_name = "auto|off|MM2", value_parser = parse_cull, default_value = "auto",
          allow_hyphen_values = true)]
    pub(crate) cull: CullArg,
    /// Where to write the cloud of one IMAGE: .ply, .pcd, .xyz, .obj or .glb by the name; `-` for a PLY on stdout.
    #[arg(short, long, value_name = "CLOUD.ply", group = "place")]
    pub(crate) output: Option<PathBuf>,
    /// Where to write the clouds, each named after its IMAGE; made when it does not exist.
    #[arg(long, value_name = "DIR", group = "place")]
    pub(crate) out_dir: Option<PathBuf>,
    /// Draw the stripes that were decoded on the photograph (one IMAGE only).
    #[arg(long, value_name = "FILE.png")]
    pub(crate) overlay: Option<PathBuf>,
    /// Print the report as JSON instead of a summary.
    #[arg(long)]
    pub(crate) json: bool,
    /// Replace files that exist.
    #[arg(long)]
    pub(crate) force: bool,
}
