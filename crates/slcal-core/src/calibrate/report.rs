//! What a calibration hands back.

use serde::{Deserialize, Serialize};

use super::variance_components::NoiseFound;
use crate::observations::Observations;
use crate::rig::{Rig, Verdict, Warning};

/// How a calibration went, beyond the rig itself.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[non_exhaustive]
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
#[non_exhaustive]
pub struct Calibration {
    /// The result.
    pub rig: Rig,
    pub(super) report: CalibrationReport,
    /// What it was computed from: every σ is filled in, and at most 4000 points of a side and pairs of a view are left,
    /// spread evenly. Calibrating from these gives the same rig.
    pub observations: Observations,
    pub(super) noise: Vec<NoiseFound>,
}

impl Calibration {
    /// Adds, before all else, a warning about an error larger than σ: the verdict is weak at best then, for this reason.
    pub(crate) fn doubt(&mut self, warning: Warning) {
        let Some(quality) = &mut self.rig.quality else { return };
        if quality.verdict < Verdict::Weak {
            quality.verdict = Verdict::Weak;
            quality.cause.clone_from(&warning.message);
            quality.advice.clone_from(&warning.advice);
            self.report.cause.clone_from(&warning.message);
            self.report.advice.clone_from(&warning.advice);
        }
        quality.warnings.insert(0, warning);
    }
}

/// How it went in detail.
#[cfg(feature = "report")]
impl Calibration {
    /// The record of the calibration.
    #[must_use]
    pub fn report(&self) -> &CalibrationReport {
        &self.report
    }

    /// The σ that were not stated.
    #[must_use]
    pub fn noise(&self) -> &[NoiseFound] {
        &self.noise
    }
}

/// `slcal-calibration-report/1`.
#[derive(Serialize)]
struct Tagged<'a> {
    schema: &'static str,
    #[serde(flatten)]
    report: &'a CalibrationReport,
}

impl CalibrationReport {
    /// The record with its schema: iterations, shares of inliers, the cause of the verdict and the advice.
    #[must_use]
    pub fn to_json(&self) -> impl Serialize {
        Tagged { schema: "slcal-calibration-report/1", report: self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_record_is_the_report_with_a_schema() {
        let report = CalibrationReport {
            iterations: 9,
            edge_inliers: 0.875,
            corner_inliers: 1.0,
            cause: "seen flat".into(),
            advice: "tilt it".into(),
        };
        assert_eq!(
            serde_json::to_string(&report.to_json()).unwrap(),
            r#"{"schema":"slcal-calibration-report/1","iterations":9,"edge_inliers":0.875,"corner_inliers":1.0,"cause":"seen flat","advice":"tilt it"}"#
        );
    }
}
