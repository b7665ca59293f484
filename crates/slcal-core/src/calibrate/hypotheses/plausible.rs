//! What an ordinary camera sees.

use crate::calibrate::config::CalibrateConfig;
use crate::estimate::Solution;
use crate::estimate::assumptions::FocalPrior;
use crate::estimate::model::ORDINARY_FOCAL;

/// Focal length that lenses have most often, in units of the longer side of the image, and by which factor (its logarithm)
/// they differ, 1σ: telephones have 0.75, tele lenses 3.
const USUAL_FOCAL: f64 = 1.2;
const FOCAL_SPREAD: f64 = 0.8;

/// Whether the camera's focal length is that of an ordinary lens.
pub(super) fn is_ordinary(solution: &Solution) -> bool {
    let camera = solution.model().camera;
    let in_sides = camera.intrinsics.fx / f64::from(camera.width.max(camera.height));
    (ORDINARY_FOCAL[0]..ORDINARY_FOCAL[1]).contains(&in_sides)
}

/// What is known of the camera's focal length: what was given, or what lenses have.
pub(super) fn usual_focal(config: &CalibrateConfig, [width, height]: [u32; 2]) -> FocalPrior {
    let focal_px = USUAL_FOCAL * f64::from(width.max(height));
    config.focal_prior.unwrap_or(FocalPrior { focal_px, sigma_share: FOCAL_SPREAD })
}

/// The configuration with that as a prior: explanations that need a lens of 60 image widths are less likely, and sheets that
/// are seen face-on have a solution.
pub(super) fn with_usual_focal(config: &CalibrateConfig, size: [u32; 2]) -> CalibrateConfig {
    CalibrateConfig { focal_prior: Some(usual_focal(config, size)), ..config.clone() }
}
