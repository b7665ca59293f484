//! `slcal-calibration-report/1`: how a calibration went, beyond the rig.

use serde::Serialize;

use crate::calibrate::CalibrationReport;

#[derive(Serialize)]
struct Report<'a> {
    schema: &'static str,
    #[serde(flatten)]
    report: &'a CalibrationReport,
}

/// How a calibration went: iterations, shares of inliers, the cause of the verdict and the advice.
#[must_use]
pub fn calibration(report: &CalibrationReport) -> impl Serialize {
    Report { schema: "slcal-calibration-report/1", report }
}
