//! `slcal advise`.

use std::path::PathBuf;

use clap::Args;
use slcal_core::geometry::RectangleSize;
use slcal_core::{DistortionModel, Flatness, PrincipalPointRule};

use super::headings::{INPUT, MODEL, OUTPUT, SETTINGS};
use super::value::{
    choice, parse_camera_pp, parse_flatness, parse_length, parse_pair, parse_projector_pp, parse_size,
};

#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("known").required(true))]
pub(crate) struct AdviseArgs {
    /// Rig to improve: what would one more photograph add?
    #[arg(long, value_name = "RIG.json", group = "known", help_heading = INPUT)]
    pub(crate) rig: Option<PathBuf>,
    /// Approximate intrinsics of the camera, before any photograph: an OpenCV or ROS file, or a rig JSON.
    #[arg(long, value_name = "FILE", group = "known", help_heading = INPUT)]
    pub(crate) camera: Option<PathBuf>,
    /// Size of the photographs, with --focal, --fov or --focal-35mm.
    #[arg(long, value_name = "WxH", value_parser = parse_pair, group = "known", requires = "lens",
          help_heading = INPUT)]
    pub(crate) image: Option<[u32; 2]>,
    /// Approximate focal length of the camera in pixels.
    #[arg(long, value_name = "PX", group = "lens", allow_hyphen_values = true, requires = "image",
          help_heading = SETTINGS)]
    pub(crate) focal: Option<f64>,
    /// Approximate horizontal angle of view of the camera in degrees.
    #[arg(long, value_name = "DEG", group = "lens", allow_hyphen_values = true, requires = "image",
          help_heading = SETTINGS)]
    pub(crate) fov: Option<f64>,
    /// Approximate focal length of the camera as its 35 mm equivalent (EXIF has it), mm.
    #[arg(long = "focal-35mm", value_name = "MM", group = "lens", allow_hyphen_values = true,
          requires = "image", help_heading = SETTINGS)]
    pub(crate) focal_35mm: Option<f64>,
    /// Checkerboard that will be projected [default: the one that `slcal pattern checker` draws].
    #[arg(long, value_name = "FILE.json", requires = "rig", help_heading = INPUT)]
    pub(crate) pattern: Option<PathBuf>,
    /// Size of the sheet (594x420mm, A4-landscape ...); required without --rig.
    #[arg(long, value_name = "SIZE", value_parser = parse_size, allow_hyphen_values = true,
          conflicts_with = "rig", required_unless_present = "rig", help_heading = INPUT)]
    pub(crate) size: Option<RectangleSize>,
    /// Distance from the camera to the middle of the sheet (1100mm, 1.1m, 40in) [default: the sheet fills 60 % of the
    /// frame].
    #[arg(long, value_name = "LENGTH", value_parser = parse_length, allow_hyphen_values = true,
          conflicts_with = "rig", help_heading = SETTINGS)]
    pub(crate) distance: Option<f64>,
    /// Size of the projector panel; without it, only the camera is planned.
    #[arg(long, value_name = "WxH", value_parser = parse_pair, conflicts_with = "rig", requires = "throw_of",
          help_heading = INPUT)]
    pub(crate) projector: Option<[u32; 2]>,
    /// Throw ratio of the projector: distance over width of its picture.
    #[arg(long, value_name = "RATIO", group = "throw_of", allow_hyphen_values = true, requires = "projector",
          help_heading = SETTINGS)]
    pub(crate) throw: Option<f64>,
    /// Approximate focal length of the projector in pixels.
    #[arg(long, value_name = "PX", group = "throw_of", allow_hyphen_values = true, requires = "projector",
          help_heading = SETTINGS)]
    pub(crate) projector_focal: Option<f64>,
    /// σ of a corner of the sheet and of the pattern in the photograph, px.
    ///
    /// Sharp photographs reach 0.02, soft ones 0.2.
    #[arg(long, value_name = "PX", default_value_t = 0.05, allow_hyphen_values = true, conflicts_with = "rig",
          help_heading = SETTINGS)]
    pub(crate) noise: f64,
    /// Prior of the principal point of the camera: prior, centre, free or X,Y (as for `slcal calibrate`).
    #[arg(long, value_name = "prior|centre|free|X,Y", value_parser = parse_camera_pp,
          default_value_t = PrincipalPointRule::Prior, allow_hyphen_values = true, conflicts_with = "rig",
          help_heading = MODEL)]
    pub(crate) camera_pp: PrincipalPointRule,
    /// Prior of the principal point of the projector: shift, prior, centre, free or X,Y.
    #[arg(long, value_name = "shift|prior|centre|free|X,Y", value_parser = parse_projector_pp,
          default_value_t = PrincipalPointRule::Shift, allow_hyphen_values = true, conflicts_with = "rig",
          help_heading = MODEL)]
    pub(crate) projector_pp: PrincipalPointRule,
    /// Distortion of the camera that will be estimated, as for `slcal calibrate`.
    #[arg(long, value_parser = choice::<DistortionModel>(DistortionModel::NAMES), default_value_t,
          conflicts_with = "rig", help_heading = MODEL)]
    pub(crate) distortion: DistortionModel,
    /// How flat the sheet is: paper, board, flat, or a length (as for `slcal calibrate`); a rig knows it.
    #[arg(long, value_name = "paper|board|flat|LENGTH", value_parser = parse_flatness,
          default_value_t = Flatness::Paper, allow_hyphen_values = true, conflicts_with = "rig", help_heading = MODEL)]
    pub(crate) flatness: Flatness,
    /// Print the result as JSON instead of tables.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
}
