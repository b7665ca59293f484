//! `slcal reconstruct`.

use std::path::PathBuf;
use std::time::Duration;

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
    /// Photographs of the object under the stripes, in files or folders; `-` for one on stdin.
    ///
    /// A folder stands for its photographs in natural order (img2 before img10), as does a name with * or ? that the
    /// shell has not expanded. Of a sequence, each folder is a scan with its own cloud; or all files together are one.
    #[arg(required_unless_present = "raw", value_name = "IMAGE")]
    pub(crate) images: Vec<PathBuf>,
    /// Calibrated rig.
    #[arg(long, value_name = "RIG.json", help_heading = INPUT)]
    pub(crate) rig: PathBuf,
    #[command(flatten)]
    pub(crate) input: DecodeInput,
    #[command(flatten)]
    pub(crate) shape: CloudArgs,
    /// Triangles to remove, and with them isolated points: auto, off, or those above an area in mm².
    ///
    /// auto removes triangles that are far more slanted than their neighbours, or far longer in the image.
    #[arg(long, value_name = "auto|off|MM2", value_parser = parse_cull, default_value_t,
          allow_hyphen_values = true, help_heading = MODEL)]
    pub(crate) cull: CullRule,
    /// File for the cloud of one IMAGE: .ply, .pcd, .xyz, .obj or .glb; `-` for a PLY on stdout.
    #[arg(short, long, value_name = "CLOUD.ply", group = "place", help_heading = OUTPUT)]
    pub(crate) output: Option<PathBuf>,
    /// Folder for the clouds, each named after its IMAGE; created when it does not exist.
    ///
    /// Two images of the same name are refused.
    #[arg(long, value_name = "DIR", group = "place", help_heading = OUTPUT)]
    pub(crate) out_dir: Option<PathBuf>,
    /// Format of the clouds in DIR.
    #[arg(long, value_parser = choice::<CloudFormat>(CloudFormat::NAMES), ignore_case = true, default_value_t,
          conflicts_with = "output", help_heading = OUTPUT)]
    pub(crate) format: CloudFormat,
    /// Read frames without a file format from stdin until it ends: rgb24, bgr24 (8 bit) or rgb48le (16 bit).
    ///
    /// The clouds are called frame_000000, frame_000001 and so on.
    #[arg(long, value_name = "WxH:rgb24", value_parser = RawFormat::parse, conflicts_with = "output",
          allow_hyphen_values = true, help_heading = INPUT)]
    pub(crate) raw: Option<RawFormat>,
    /// Seconds that the stream of --raw may take for a frame; without it, it is waited for as long as it takes.
    ///
    /// A stream that stalls is an error then. The clouds of the frames before it stay.
    #[arg(long, value_name = "SECONDS", requires = "raw", value_parser = parse_seconds, allow_hyphen_values = true,
          help_heading = GENERAL)]
    pub(crate) timeout: Option<Duration>,
    /// Number of frames that are processed at the same time [default: the number of cores].
    ///
    /// The results and their order do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=256),
          help_heading = GENERAL)]
    pub(crate) jobs: Option<u16>,
    /// Leave out frames whose complete cloud exists in DIR; incomplete clouds are computed again.
    ///
    /// The clouds are checked, not their inputs: after a change of rig or options, use --force.
    #[arg(long, conflicts_with_all = ["force", "output", "report"], help_heading = OUTPUT)]
    pub(crate) resume: bool,
    /// Write the depth of every pixel along the optical axis of the camera (one cloud only).
    ///
    /// .pfm: 32-bit numbers in mm, NaN where there is no point. .png: 16 bit, in 0.1 mm, 0 where there is none.
    #[arg(long, value_name = "FILE.pfm", help_heading = OUTPUT)]
    pub(crate) depth: Option<PathBuf>,
    /// Draw the points on the photograph, coloured by their distance from the camera (one IMAGE only).
    ///
    /// Of a sequence: the projector column of every pixel as its colour, lines at equal distances on the panel, and pixels that are lit
    /// and have no certain position.
    #[arg(long, value_name = "FILE.png", help_heading = OUTPUT)]
    pub(crate) overlay: Option<PathBuf>,
    /// Write an HTML report with the photograph, the cloud in 3D and the decoding (one IMAGE only).
    #[arg(long, value_name = "FILE.html", help_heading = OUTPUT)]
    pub(crate) report: Option<PathBuf>,
    /// Fit a plane or a sphere to the cloud, for the report.
    #[arg(long, value_enum, requires = "report", help_heading = OUTPUT)]
    pub(crate) fit: Option<ShapeArg>,
    /// Print the result as JSON instead of a summary.
    ///
    /// One object with a list `clouds`.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// Replace outputs that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}

/// Longest timeout: a day.
const MOST_SECONDS: f64 = 86_400.0;

fn parse_seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().filter(|s: &f64| *s > 0.0 && *s <= MOST_SECONDS);
    seconds
        .map(Duration::from_secs_f64)
        .ok_or_else(|| format!("expected seconds above 0 and up to {MOST_SECONDS}"))
}
