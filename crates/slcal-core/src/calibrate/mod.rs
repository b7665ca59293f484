//! Observations → rig.
//!
//! Closed forms (`initial_guess`) begin a maximum-likelihood refinement of everything that was seen (`estimate`). Other
//! explanations of the data are tried (`hypotheses`), and the covariance and the residuals judge the result (`diagnostics`).
//! `variance_components` measures what observations from elsewhere do not state. `two_vp` is the method of R. Orghidan, J. Salvi, M. Gordan, C. Florea,
//! J. Batlle, "Structured light self-calibration with vanishing points", Machine Vision and Applications 25:489-500 (2014),
//! kept as it was published.

mod build_rig;
pub(crate) mod config;
mod diagnostics;
mod hypotheses;
mod initial_guess;
mod maximum_likelihood;
mod report_json;
mod two_vp;
mod validate;
mod variance_components;

pub use config::{CalibrateConfig, DistortionModel, FocalPrior, Method, PrincipalPointRule};
pub use diagnostics::residuals::{PairResidual, PointResidual, ViewResiduals, residuals};
pub use variance_components::{
    ExternalCalibration, NoiseFound, NoiseOf, calibrate_external, external_residuals,
};

pub(crate) use build_rig::depth_on_column;
pub(crate) use initial_guess::camera_from_sheet;
pub(crate) use initial_guess::metric::pose_from_homography;
pub(crate) use validate::check;

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::observations::Observations;
use crate::rig::{Rig, Verdict};

/// How a calibration went, beyond the rig itself.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CalibrationReport {
    /// Iterations of the refinement.
    pub iterations: usize,
    /// Share of the sheet's edge points that the robust loss kept, over all views; 1 when corners were given.
    pub edge_inliers: f64,
    /// Share of the projected corners that the robust loss kept; 1 without a pattern.
    pub corner_inliers: f64,
    /// Why the verdict is what it is, in one sentence: how the sheet is seen and how well the focal length is known from it,
    /// or what does not fit, where that made the verdict worse.
    pub cause: String,
    /// What to do: what more tilt or another photograph would bring, with predicted numbers computed from the Jacobian, or how
    /// to mend what does not fit.
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
/// [`Error::Invalid`](crate::Error::Invalid) for inconsistent observations (no view, NaN, σ not positive, collinear or
/// mirrored corners, fewer than four pairs with a projector, projector pixels off the panel);
/// [`Error::ImaginaryFocal`](crate::Error::ImaginaryFocal) when no real focal length explains the view;
/// [`Error::Degenerate`](crate::Error::Degenerate) when the predicted σ of a focal length is 25 % or more and
/// `config.allow_degenerate` is not set.
pub fn calibrate_observations(observations: &Observations, config: &CalibrateConfig) -> Result<Calibration> {
    check(observations, config)?;
    match config.method {
        Method::Ml => maximum_likelihood(observations, config),
        Method::TwoVp => two_vp::rig::calibrate(observations, config),
    }
}

fn maximum_likelihood(observations: &Observations, config: &CalibrateConfig) -> Result<Calibration> {
    let (observations, repetition) = hypotheses::repeated::counted_once(observations);
    let (solved, config) = &match hypotheses::distortion_choice::solve_choosing(&observations, config) {
        Ok(solved) => solved,
        Err(error) => return Err(hypotheses::transposed::explain(error, &observations, config)),
    };
    let mut judgement = diagnostics::verdict::judge(solved, config);
    judgement.warnings.extend(repetition);
    let doubt = hypotheses::transposed::hint(&observations, config)
        .or_else(|| hypotheses::contradiction::hint(&observations, config, solved))
        .or_else(|| hypotheses::aspect::hint(&observations, config, solved));
    if let Some(doubt) = doubt {
        judgement.doubt(doubt);
    }
    if judgement.verdict == Verdict::Degenerate && !config.allow_degenerate {
        return Err(judgement.refusal());
    }
    let rig = build_rig::rig(&solved.joint, &solved.fit, &judgement);
    let share = |kind: crate::estimate::Kind| {
        let kept =
            solved.joint.measurements.iter().zip(&solved.fit.inliers).filter(|(m, _)| m.kind() == kind);
        let (kept, all) = kept.fold((0usize, 0usize), |(k, n), (_, keep)| (k + usize::from(*keep), n + 1));
        if all == 0 { 1.0 } else { kept as f64 / all as f64 }
    };
    let (cause, advice) = judgement.why();
    let report = CalibrationReport {
        iterations: solved.fit.iterations,
        edge_inliers: share(crate::estimate::Kind::Edge),
        corner_inliers: share(crate::estimate::Kind::Pair),
        cause: cause.to_owned(),
        advice: advice.to_owned(),
    };
    Ok(Calibration { rig, report })
}

#[cfg(test)]
pub(crate) mod tests;
