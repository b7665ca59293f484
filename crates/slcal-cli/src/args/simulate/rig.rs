//! The rig that `slcal simulate` simulates.

use clap::Args;
use slcal_core::geometry::RectangleSize;
use slcal_core::simulate::RigConfig;

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
    /// Size of the projector panel.
    #[arg(long, value_name = "WxH", value_parser = parse_pair, default_value = "1024x768")]
    pub(crate) projector: [u32; 2],
    /// Focal length of the projector.
    #[arg(long, value_name = "PX", default_value_t = 1700.0, allow_hyphen_values = true)]
    pub(crate) projector_focal: f64,
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
            lens_shift: self.lens_shift,
            baseline_mm: self.baseline,
            size: self.size,
            distance_mm: self.distance,
            ..RigConfig::default()
        }
    }
}
