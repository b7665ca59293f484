//! `slcal triangulate`.

use std::path::PathBuf;

use clap::Args;

use slcal_core::reconstruct::CullRule;

use super::cloud::CloudArgs;
use super::headings::{INPUT, MODEL, OUTPUT};
use super::value::parse_cull;

#[derive(Debug, Args)]
pub(crate) struct TriangulateArgs {
    /// The matches, a CSV table; `-` for stdin.
    pub(crate) matches: PathBuf,
    /// The calibrated rig.
    #[arg(long, value_name = "RIG.json", help_heading = INPUT)]
    pub(crate) rig: PathBuf,
    #[command(flatten)]
    pub(crate) shape: CloudArgs,
    /// Which triangles, and with them lone points, are removed: auto, off, or those above an area in mm².
    #[arg(long, value_name = "auto|off|MM2", value_parser = parse_cull, default_value_t = CullRule::Off,
          allow_hyphen_values = true,
          help_heading = MODEL)]
    pub(crate) cull: CullRule,
    /// Where to write the cloud: .ply, .pcd, .xyz, .obj or .glb by the name; `-` for a PLY on stdout.
    #[arg(short, long, value_name = "CLOUD.ply", help_heading = OUTPUT)]
    pub(crate) output: PathBuf,
    /// Replace files that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
