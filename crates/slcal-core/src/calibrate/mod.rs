//! Observations → rig.

mod config;

pub use config::{CalibrateConfig, DistortionModel, Method, PrincipalPointRule};

use crate::error::{Error, Result};
use crate::observations::Observations;
use crate::rig::Rig;

/// How a calibration went, beyond the rig itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CalibrationReport {
    /// Iterations of the refinement.
    pub iterations: usize,
    /// Share of the sheet's edge points that the robust loss kept, over all views; 1 when corners were given.
    pub edge_inliers: f64,
    /// Share of the projected corners that the robust loss kept; 1 without a pattern.
    pub corner_inliers: f64,
    /// What another photograph would bring, in one sentence with predicted numbers; computed from the Jacobian.
    pub advice: String,
}

/// A calibrated rig and how it came about.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The result.
    pub rig: Rig,
    /// How it went.
    pub report: CalibrationReport,
}

/// Calibrates camera and projector (the camera alone when `observations.projector` is `None`) from what was seen in one
/// photograph or several.
///
/// # Errors
/// [`Error::Invalid`] for inconsistent observations (no view, NaN, σ not positive, collinear or mirrored corners, fewer
/// than four pairs with a projector); [`Error::ImaginaryFocal`] when no real focal length explains the view;
/// [`Error::Degenerate`] when the predicted σ of a focal length is 25 % or more and `config.allow_degenerate` is not set.
pub fn calibrate_observations(observations: &Observations, config: &CalibrateConfig) -> Result<Calibration> {
    config.validate()?;
    let _ = observations;
    Err(Error::invalid("calibration", "an estimator", "none yet"))
}
