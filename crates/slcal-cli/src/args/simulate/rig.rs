//! The rig that `slcal simulate` simulates.

use clap::Args;
use slcal_core::geometry::RectangleSize;
use slcal_core::simulate::{BendConfig, RigConfig};

use super::values::{Distortion, ProjectorOffset, parse_bend, parse_distortion, parse_projector_offset};
use crate::args::value::{parse_pair, parse_size};

/// The rig that is simulated.
#[derive(Debug, Args)]
#[command(next_help_heading = "Rig")]
pub(crate) struct RigArgs {
    /// Size of the camera image.
    #[arg(long, value_name = "WxH", value_parser = parse_pair, default_value = "1280x960")]
    pub(crate) camera: [u32; 2],
    /// Focal length of the camera.
    #[arg(long, value_name = "PX", default_value_t = 1500.0, allow_hyphen_values = true)]
    pub(crate) focal: f64,
    /// Focal length of the camera along y over that along x, which is --focal.
    #[arg(long, value_name = "R", default_value_t = 1.0, allow_hyphen_values = true)]
    pub(crate) pixel_aspect: f64,
    /// Size of the projector panel.
    #[arg(long, value_name = "WxH", value_parser = parse_pair, default_value = "1024x768")]
    pub(crate) projector: [u32; 2],
    /// Focal length of the projector.
    #[arg(long, value_name = "PX", default_value_t = 1700.0, allow_hyphen_values = true)]
    pub(crate) projector_focal: f64,
    /// Focal length of the projector along y over that along x, which is --projector-focal; 2 for diamond pixels such as
    /// 912x1140.
    #[arg(long, value_name = "R", default_value_t = 1.0, allow_hyphen_values = true)]
    pub(crate) projector_pixel_aspect: f64,
    /// Offset of the principal point of the projector to the right of the middle of the panel and, optionally, down (added to
    /// --lens-shift), px: a lens that is shifted sideways.
    #[arg(long, value_name = "PX[,PX]", value_parser = parse_projector_offset, default_value = "0",
          allow_hyphen_values = true)]
    pub(crate) projector_offset: ProjectorOffset,
    /// Distortion coefficients of the projector; missing ones are zero.
    #[arg(long, value_name = "k1,k2,p1,p2,k3", value_parser = parse_distortion, default_value = "0",
          allow_hyphen_values = true)]
    pub(crate) projector_distortion: Distortion,
    /// Distance of the principal point of the projector below the middle of the panel, in panel heights.
    #[arg(long, value_name = "HEIGHTS", default_value_t = 0.0, allow_hyphen_values = true)]
    pub(crate) lens_shift: f64,
    /// Horizontal distance between camera and projector.
    #[arg(long, value_name = "MM", default_value_t = 250.0, allow_hyphen_values = true)]
    pub(crate) baseline: f64,
    /// Size of the sheet.
    #[arg(long, value_name = "SIZE", value_parser = parse_size, default_value = "594x420mm",
          allow_hyphen_values = true)]
    pub(crate) size: RectangleSize,
    /// Bend of the sheet, without stretching it: sag, angle of the axis, and shape.
    ///
    /// SAG is a length (3mm) or a share of the width of the sheet (0.5%), at most a tenth of the shorter side; a negative sag
    /// bends to the other side. AXIS_DEG is the angle of the lines that stay straight from the height of the sheet, clockwise
    /// as the camera sees it: at 0 (the default) the width is bent, at 90 the height. curl (the default) is a circular cylinder,
    /// whose sag is the depth of the arc below its chord, the middle farther from the camera. wave is an S, whose sag is its
    /// largest distance from the chord to either side, the right half farther (the lower half at 90). twist lifts two opposite
    /// corners, its sag is the distance of the corners from the mean plane, top left and bottom right farther; its axis is 0 or
    /// 90. Sag and chord span the whole sheet across the axis, from corner to corner where it is oblique. The pose of the sheet
    /// in the true rig is that of its mean plane.
    #[arg(long, value_name = "SAG[,AXIS_DEG[,curl|wave|twist]]", value_parser = parse_bend, allow_hyphen_values = true)]
    pub(crate) bend: Option<BendConfig>,
    /// Distance from the camera to the middle of the sheet.
    #[arg(long, value_name = "MM", default_value_t = 1000.0, allow_hyphen_values = true)]
    pub(crate) distance: f64,
}

impl RigArgs {
    /// As the core takes it.
    pub(crate) fn config(&self) -> RigConfig {
        RigConfig {
            camera: self.camera,
            camera_focal_px: self.focal,
            projector: self.projector,
            projector_focal_px: self.projector_focal,
            camera_pixel_aspect: self.pixel_aspect,
            projector_pixel_aspect: self.projector_pixel_aspect,
            projector_distortion: self.projector_distortion.0,
            lens_shift: self.lens_shift,
            baseline_mm: self.baseline,
            size: self.size,
            bend: self.bend,
            distance_mm: self.distance,
            ..RigConfig::default()
        }
        .with_projector_offset(self.projector_offset.0)
    }
}
