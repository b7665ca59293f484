//! Observations → rig.
//!
//! Closed forms (`initial_guess`) begin a maximum-likelihood refinement of everything that was seen (`estimate`). Other
//! explanations of the data are tried (`hypotheses`), and the result is assessed by its covariance and its residuals (`diagnostics`).
//! `variance_components` measures what observations from elsewhere do not state. `two_vp` is the method of R. Orghidan, J. Salvi, M. Gordan, C. Florea,
//! J. Batlle, "Structured light self-calibration with vanishing points", Machine Vision and Applications 25:489-500 (2014),
//! kept as it was published.

mod build_rig;
mod calibration;
mod channel_registration;
mod config;
mod diagnostics;
mod hypotheses;
mod initial_guess;
mod maximum_likelihood;
mod repeated;
mod report;
mod sensitivity;
mod two_vp;
mod validate;
mod variance_components;

pub use crate::estimate::assumptions::{DistortionModel, FocalPrior, PixelAspect, PrincipalPointRule};
pub use crate::estimate::flatness::Flatness;
pub use calibration::calibrate_observations;
pub use config::{CalibrateConfig, Method};
public_with! { "report": pub use diagnostics::residuals::{PairResidual, PointResidual, ViewResiduals, residuals}; }
pub(crate) use hypotheses::either_way::{SheetLies, orient};
pub(crate) use hypotheses::together::misfit_per_residual;
pub use report::Calibration;
public_with! { "report": pub use report::CalibrationReport; }
public_with! { "report": pub use variance_components::NoiseFound; }

#[cfg(test)]
pub(crate) mod tests;
