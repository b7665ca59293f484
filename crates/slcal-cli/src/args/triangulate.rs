//! `slcal triangulate`.

use std::path::PathBuf;

use clap::Args;

use slcal_core::reconstruct::CullRule;

use super::cloud::CloudArgs;
use super::headings::{INPUT, MODEL, OUTPUT};
use super::value::parse_cull;

#[derive(Debug, Args)]
pub(crate) struct TriangulateArgs {
    /// Table of matches, CSV, or the .npz of a sequence; `-` for CSV on stdin.
    ///
    /// It needs the columns u, v and projector_column or projector_row, or both.
    pub(crate) matches: PathBuf,
    /// Calibrated rig.
    #[arg(long, value_name = "RIG.json", help_heading = INPUT)]
    pub(crate) rig: PathBuf,
    #[command(flatten)]
    pub(crate) shape: CloudArgs,
    /// Triangles to remove, and with them isolated points: auto, off, or those above an area in mm².
    #[arg(long, value_name = "auto|off|MM2", value_parser = parse_cull, default_value_t = CullRule::Off,
          allow_hyphen_values = true, help_heading = MODEL)]
    pub(crate) cull: CullRule,
    /// File for the cloud: .ply, .pcd, .xyz, .obj or .glb; `-` for a PLY on stdout.
    #[arg(short, long, value_name = "CLOUD.ply", help_heading = OUTPUT)]
    pub(crate) output: PathBuf,
    /// Replace outputs that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
