//! `slcal simulate views`.

use std::path::PathBuf;

use clap::Args;
use nalgebra::Point2;

use super::rig::RigArgs;
use super::values::{Distortion, PoseArg, parse_distortion, parse_pose};
use crate::args::headings::{OUTPUT, SETTINGS};
use crate::args::value::parse_point;

#[derive(Debug, Args)]
pub(crate) struct ViewsArgs {
    /// Number of poses, tilted by 15° to 35° in all directions.
    #[arg(long, value_name = "N", default_value_t = 10, allow_hyphen_values = true, conflicts_with = "pose",
          help_heading = SETTINGS)]
    pub(crate) poses: usize,
    /// A pose of your own: tilt about the horizontal and vertical axis of the camera and, optionally, roll, degrees;
    /// repeatable.
    #[arg(long, value_name = "X,Y[,ROLL]", value_parser = parse_pose, allow_hyphen_values = true,
          help_heading = SETTINGS)]
    pub(crate) pose: Vec<PoseArg>,
    /// σ of the noise on each image coordinate, px.
    #[arg(long, value_name = "PX", default_value_t = 0.1, allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) noise: f64,
    /// Number of points on each edge of the sheet, instead of its corners.
    #[arg(long, value_name = "N", allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) edges: Option<usize>,
    /// Seed of poses and noise: the same seed gives the same output.
    #[arg(long, value_name = "N", default_value_t = 1, allow_hyphen_values = true, help_heading = SETTINGS)]
    pub(crate) seed: u64,
    #[command(flatten)]
    pub(crate) rig: RigArgs,
    /// Offset of the principal point of the camera from the image centre, px.
    #[arg(long, value_name = "X,Y", value_parser = parse_point, default_value = "0,0", help_heading = "Rig",
          allow_hyphen_values = true)]
    pub(crate) camera_offset: Point2<f64>,
    /// Distortion coefficients of the camera; missing ones are zero.
    #[arg(long, value_name = "k1,k2,p1,p2,k3", value_parser = parse_distortion, default_value = "0",
          help_heading = "Rig", allow_hyphen_values = true)]
    pub(crate) distortion: Distortion,
    /// File for the observations; `-` for stdout.
    #[arg(short, long, value_name = "FILE.json", help_heading = OUTPUT)]
    pub(crate) output: PathBuf,
    /// File for the true rig.
    #[arg(long, value_name = "RIG.json", help_heading = OUTPUT)]
    pub(crate) truth: Option<PathBuf>,
    /// Replace outputs that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
