//! `slcal calibrate`.

use std::path::PathBuf;

use clap::{ArgAction, Args};
use slcal_core::geometry::SheetSize;
use slcal_core::{DistortionModel, Flatness, Method, PixelAspect, PrincipalPointRule};

use super::headings::{INPUT, MODEL, OUTPUT};
use super::photo::{GammaArg, MirrorArg};
use super::value::{
    Corners, choice, parse_camera_pp, parse_corners, parse_flatness, parse_pixel_aspect, parse_projector_pp,
    parse_sheet_size,
};

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "a command line is made of switches")]
pub(crate) struct CalibrateArgs {
    /// Photographs of the sheet, one per pose, in files or folders; `-` for one on stdin.
    ///
    /// A folder stands for its photographs in natural order (img2 before img10), as does a name with * or ? that the
    /// shell has not expanded. Under a sequence (--pattern sequence.json) every folder is one pose: it holds a photograph of each
    /// picture, by the names in the sequence or in natural order.
    #[arg(required_unless_present = "observations", value_name = "PHOTO")]
    pub(crate) photos: Vec<PathBuf>,
    /// Size of the sheet: 594x420mm, 59.4x42cm, 11x8.5in, A4, A4-landscape, letter, legal, tabloid.
    ///
    /// The width is the side that runs most nearly along the x axis of the image. A name alone (A4) is tried both ways round in
    /// every photograph, and the one that fits is taken; numbers, A4-landscape and A4-portrait are never turned.
    #[arg(long, value_name = "SIZE", value_parser = parse_sheet_size, allow_hyphen_values = true,
          required_unless_present = "observations", help_heading = INPUT)]
    pub(crate) size: Option<SheetSize>,
    /// Checkerboard or sequence that was projected; without it, only the camera is calibrated.
    ///
    /// `slcal pattern checker` writes this JSON beside the picture, `slcal pattern gray --axis both` and `slcal pattern phase --axis both`
    /// write sequence.json. The sheet is found in the photograph under white.
    #[arg(long, value_name = "FILE.json", help_heading = INPUT)]
    pub(crate) pattern: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) mirror: MirrorArg,
    /// Photograph of the same pose without the pattern (projector dark, or all white), for better edges; once per
    /// PHOTO, in the same order.
    #[arg(long, alias = "screen", value_name = "PHOTO", action = ArgAction::Append, help_heading = INPUT)]
    pub(crate) plain: Vec<PathBuf>,
    /// Corners of the sheet by hand as "x,y x,y x,y x,y" (TL TR BR BL); once per PHOTO, in the same order.
    ///
    /// They may lie outside the frame.
    #[arg(long, value_name = "CORNERS", value_parser = parse_corners, allow_hyphen_values = true,
          action = ArgAction::Append, help_heading = INPUT)]
    pub(crate) corners: Vec<Corners>,
    /// Measurements of your own detector instead of photographs; `-` for stdin.
    #[arg(long, value_name = "FILE.json",
          conflicts_with_all = ["photos", "size", "pattern", "plain", "corners", "mirror", "gamma", "overlay"],
          help_heading = INPUT)]
    pub(crate) observations: Option<PathBuf>,
    /// Known camera intrinsics, which are held fixed: OpenCV YAML, XML or JSON, ROS `camera_info` YAML, or a rig JSON.
    #[arg(long, value_name = "FILE", help_heading = INPUT)]
    pub(crate) camera: Option<PathBuf>,
    /// Use the focal length in the EXIF tags as a prior with σ of about 5 %.
    ///
    /// It helps views that hardly determine the focal length. It is taken from the 35 mm equivalent, or else from the
    /// lens's own focal length and the size of the sensor: by the tags, or that of a common camera.
    #[arg(long, conflicts_with_all = ["camera", "observations"], help_heading = INPUT)]
    pub(crate) exif: bool,
    /// Principal point of the camera: prior, centre, free or X,Y.
    ///
    /// prior: the centre with σ of 2 % of the width. centre and X,Y: exact. free: unknown; only several well-spread
    /// views determine it.
    #[arg(long, value_name = "prior|centre|free|X,Y", value_parser = parse_camera_pp,
          default_value_t = PrincipalPointRule::Prior, allow_hyphen_values = true, conflicts_with = "camera",
          help_heading = MODEL)]
    pub(crate) camera_pp: PrincipalPointRule,
    /// Principal point of the projector: shift, prior, centre, free or X,Y.
    ///
    /// shift: horizontally as prior, vertically unknown, as for a projector with lens shift. The others are as for
    /// --camera-pp.
    #[arg(long, value_name = "shift|prior|centre|free|X,Y", value_parser = parse_projector_pp,
          default_value_t = PrincipalPointRule::Shift, allow_hyphen_values = true, help_heading = MODEL)]
    pub(crate) projector_pp: PrincipalPointRule,
    /// Distortion of the camera lens to estimate.
    ///
    /// auto: all five coefficients and the ratio of fy to fx, near what ordinary lenses have. full: k1, k2, p1, p2, k3,
    /// uncertain by far more, with square pixels.
    #[arg(long, value_parser = choice::<DistortionModel>(DistortionModel::NAMES), default_value_t,
          conflicts_with = "camera", help_heading = MODEL)]
    pub(crate) distortion: DistortionModel,
    /// Distortion of the projector lens to estimate; a model by name needs three photographs or more.
    ///
    /// auto: as for the camera, within a tenth of it.
    #[arg(long, value_parser = choice::<DistortionModel>(DistortionModel::NAMES), default_value_t,
          help_heading = MODEL)]
    pub(crate) projector_distortion: DistortionModel,
    /// Width of a pixel of the projector over its height: auto, square, or a ratio.
    ///
    /// auto: 2 for the panels of diamond pixels 912x1140 and 608x684, else 1 within 0.2 %; two photographs show another one. A
    /// picture of 4:3 that is stretched over a panel of 16:10 has 1.2.
    #[arg(long, value_name = "auto|square|R", value_parser = parse_pixel_aspect, default_value_t = PixelAspect::Auto,
          help_heading = MODEL)]
    pub(crate) projector_pixel_aspect: PixelAspect,
    /// How flat the sheet is: paper, board, flat, or a length.
    ///
    /// paper bends out of its plane by 0.2 % of its diagonal (1σ), a board by 0.02 %. flat takes the sheet for exactly flat; a
    /// length such as 0.5mm is 1σ itself. The bend is estimated from the sheet's outline and the projected corners.
    #[arg(long, value_name = "paper|board|flat|LENGTH", value_parser = parse_flatness,
          default_value_t = Flatness::Paper, allow_hyphen_values = true, help_heading = MODEL)]
    pub(crate) flatness: Flatness,
    /// Estimator: ml (maximum likelihood of all measurements) or two-vp (two vanishing points alone, as published).
    #[arg(long, value_parser = choice::<Method>(Method::NAMES), default_value_t, help_heading = MODEL)]
    pub(crate) method: Method,
    #[command(flatten)]
    pub(crate) gamma: GammaArg,
    /// Write the rig even when the views do not determine it.
    #[arg(long, help_heading = MODEL)]
    pub(crate) allow_degenerate: bool,
    /// File for the rig; `-` for stdout.
    #[arg(short, long, value_name = "RIG.json", required_unless_present = "json", help_heading = OUTPUT)]
    pub(crate) output: Option<PathBuf>,
    /// Draw on the photographs what was found and how well it fits, also when something was not found.
    ///
    /// Several photographs are drawn on one sheet.
    #[arg(long, value_name = "FILE.png", help_heading = OUTPUT)]
    pub(crate) overlay: Option<PathBuf>,
    /// Write an HTML report with the verdict, the photographs and a 3D view.
    #[arg(long, value_name = "FILE.html", help_heading = OUTPUT)]
    pub(crate) report: Option<PathBuf>,
    /// Write the measurements, to inspect, to edit and to calibrate from with --observations.
    ///
    /// They give the same rig, bit for bit. The file is written even when the calibration then fails.
    #[arg(long, value_name = "FILE.json", conflicts_with = "observations", help_heading = OUTPUT)]
    pub(crate) save_observations: Option<PathBuf>,
    /// Print the rig as JSON instead of a summary; -o may then be left out.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// Replace outputs that exist.
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
}
