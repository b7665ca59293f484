//! `slcal reconstruct`.

use std::path::PathBuf;

use clap::Args;
use slcal_core::format::CloudFormat;
use slcal_core::reconstruct::CullRule;

use super::cloud::CloudArgs;
use super::decode::DecodeInput;
use super::evaluate::ShapeArg;
use super::headings::{GENERAL, INPUT, MODEL, OUTPUT};
use super::value::{choice, parse_cull};
use crate::io::RawFormat;

#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("place").required(true))]
pub(crate) struct ReconstructArgs {
    /// Photographs of the object under the stripes; `-` for one on stdin.
    #[arg(required_unless_present = "raw", value_name = "IMAGE")]
    pub(crate) images: Vec<PathBuf>,
    /// The calibrated rig.
    #[arg(long, value_name = "RIG.json", help_heading = INPUT)]
    pub(crate) rig: PathBuf,
    #[command(flatten)]
    pub(crate) input: DecodeInput,
    #[command(flatten)]
    pub(crate) shape: CloudArgs,
    /// Which triangles, and with them lone points, are removed: auto, off, or those above an area in mm².
    #[arg(long, value_name = "auto|off|MM2", value_parser = parse_cull, default_value_t, allow_hyphen_values = true, help_heading = MODEL)]
    pub(crate) cull: CullRule,
    /// Where to write the cloud of one IMAGE: .ply, .pcd, .xyz, .obj or .glb by the name; `-` for a PLY on stdout.
    #[arg(short, long, value_name = "CLOUD.ply", group = "place", help_heading = OUTPUT)]
    pub(crate) output: Option<PathBuf>,
    /// Where to write the clouds, each named after its IMAGE; made when it does not exist.
    #[arg(long, value_name = "DIR", group = "place", help_heading = OUTPUT)]
    pub(crate) out_dir: Option<PathBuf>,
    /// What the clouds in DIR are.
    #[arg(long, value_parser = choice::<CloudFormat>(CloudFormat::NAMES), ignore_case = true, default_value_t,
          conflicts_with = "output",
          help_heading = OUTPUT)]
    pub(crate) format: CloudFormat,
    /// Read frames without a file format from stdin, pixels as rgb24, bgr24 or rgb48le; the clouds are frame_000000 and on.
    #[arg(long, value_name = "WxH:rgb24", value_parser = RawFormat::parse, conflicts_with = "output",
          allow_hyphen_values = true,
          help_heading = INPUT)]
    pub(crate) raw: Option<RawFormat>,
    /// How many frames are worked on at a time; as many as the machine has cores when not given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=256), help_heading = GENERAL)]
    pub(crate) jobs: Option<u16>,
    /// Leave out frames whose cloud is in DIR already, complete.
    #[arg(long, conflicts_with_all = ["force", "output", "report"], help_heading = OUTPUT)]
    pub(crate) resume: bool,
    /// Draw the points on the photograph, coloured by their distance (one IMAGE only).
    #[arg(long, value_name = "FILE.png", help_heading = OUTPUT)]
    pub(crate) overlay: Option<PathBuf>,
    /// Write a report to look at: one HTML file with the photograph, the cloud in space and how it was decoded (one IMAGE only).
    #[arg(long, value_name = "FILE.html", help_heading = OUTPUT)]
    pub(crate) report: Option<PathBuf>,
    /// Fit a plane or a sphere to the cloud, for the report.
    #[arg(long, value_enum, requires = "report", help_heading = OUTPUT)]
    pub(crate) fit: Option<ShapeArg>,
    /// Print the report as JSON instead of a summary.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// Replace files that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
