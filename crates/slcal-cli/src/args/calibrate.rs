//! `slcal calibrate`.

use std::path::PathBuf;

use clap::{ArgAction, Args};
use slcal_core::geometry::RectangleSize;
use slcal_core::{DistortionModel, Method, PrincipalPointRule};

use super::headings::{INPUT, MODEL, OUTPUT};
use super::photo::GammaArg;
use super::value::{Corners, choice, parse_camera_pp, parse_corners, parse_projector_pp, parse_size};

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "a command line is made of switches")]
pub(crate) struct CalibrateArgs {
    /// Photographs of the sheet, one per pose; `-` for stdin.
    #[arg(required_unless_present = "observations", value_name = "PHOTO")]
    pub(crate) photos: Vec<PathBuf>,
    /// Size of the sheet: 594x420mm, 59.4x42cm, 11x8.5in, A4, A4-landscape, letter, legal …
    #[arg(long, value_name = "SIZE", value_parser = parse_size, allow_hyphen_values = true,
          required_unless_present = "observations",
          help_heading = INPUT)]
    pub(crate) size: Option<RectangleSize>,
    /// The checkerboard that was projected.
    #[arg(long, value_name = "FILE.json", help_heading = INPUT)]
    pub(crate) pattern: Option<PathBuf>,
    /// A photograph of the same pose without the pattern (projector dark, or plain white), for better edges; repeat it once
    /// per PHOTO, in the same order.
    #[arg(long, alias = "screen", value_name = "PHOTO", action = ArgAction::Append, help_heading = INPUT)]
    pub(crate) plain: Vec<PathBuf>,
    /// The sheet's corners "x,y x,y x,y x,y" (TL TR BR BL) by hand; repeat it once per PHOTO, in the same order.
    #[arg(long, value_name = "CORNERS", value_parser = parse_corners, allow_hyphen_values = true,
          action = ArgAction::Append,
          help_heading = INPUT)]
    pub(crate) corners: Vec<Corners>,
    /// Corners and pairs from a detector of your own instead of photographs; `-` for stdin.
    #[arg(long, value_name = "FILE.json",
          conflicts_with_all = ["photos", "size", "pattern", "plain", "corners", "gamma", "overlay"],
          help_heading = INPUT)]
    pub(crate) observations: Option<PathBuf>,
    /// Camera intrinsics that are known already: OpenCV YAML or XML, ROS `camera_info` YAML, or a rig JSON. They are held
    /// fixed, and the rest is solved.
    #[arg(long, value_name = "FILE", help_heading = INPUT)]
    pub(crate) camera: Option<PathBuf>,
    /// Expect the focal length that the photographs' EXIF tags state (the 35 mm equivalent, with σ of 5 %): for views that
    /// hardly determine it.
    #[arg(long, conflicts_with_all = ["camera", "observations"], help_heading = INPUT)]
    pub(crate) exif: bool,
    /// The camera's principal point: prior (the centre, uncertain), centre, free, or X,Y exactly.
    #[arg(long, value_name = "prior|centre|free|X,Y", value_parser = parse_camera_pp, default_value_t = PrincipalPointRule::Prior,
          allow_hyphen_values = true, conflicts_with = "camera",
          help_heading = MODEL)]
    pub(crate) camera_pp: PrincipalPointRule,
    /// The projector's principal point: shift (horizontally near the centre, vertically anywhere), or as for the camera.
    #[arg(long, value_name = "shift|prior|centre|free|X,Y", value_parser = parse_projector_pp,
          default_value_t = PrincipalPointRule::Shift, allow_hyphen_values = true,
          help_heading = MODEL)]
    pub(crate) projector_pp: PrincipalPointRule,
    /// Lens distortion of the camera.
    #[arg(long, value_parser = choice::<DistortionModel>(DistortionModel::NAMES), default_value_t,
          conflicts_with = "camera",
          help_heading = MODEL)]
    pub(crate) distortion: DistortionModel,
    /// Lens distortion of the projector; coefficients need three photographs or more.
    #[arg(long, value_parser = choice::<DistortionModel>(DistortionModel::NAMES), default_value_t, help_heading = MODEL)]
    pub(crate) projector_distortion: DistortionModel,
    /// Which estimator.
    #[arg(long, value_parser = choice::<Method>(Method::NAMES), default_value_t, help_heading = MODEL)]
    pub(crate) method: Method,
    #[command(flatten)]
    pub(crate) gamma: GammaArg,
    /// Write the rig even when the view does not determine it.
    #[arg(long, help_heading = MODEL)]
    pub(crate) allow_degenerate: bool,
    /// Where to write the rig; `-` for stdout.
    #[arg(short, long, value_name = "RIG.json", required_unless_present = "json", help_heading = OUTPUT)]
    pub(crate) output: Option<PathBuf>,
    /// Draw what was found on the photographs and how well it fits, also when something was not found.
    #[arg(long, value_name = "FILE.png", help_heading = OUTPUT)]
    pub(crate) overlay: Option<PathBuf>,
    /// Write a report to look at: one HTML file with the verdict, the photographs and everything in space.
    #[arg(long, value_name = "FILE.html", help_heading = OUTPUT)]
    pub(crate) report: Option<PathBuf>,
    /// Write what was found in the photographs, to look at, to edit and to calibrate from with --observations.
    #[arg(long, value_name = "FILE.json", conflicts_with = "observations", help_heading = OUTPUT)]
    pub(crate) save_observations: Option<PathBuf>,
    /// Print the rig as JSON instead of a summary.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// Replace files that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
