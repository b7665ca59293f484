//! `slcal-calibration-report/1`: how a calibration went, beyond the rig.

use serde::Serialize;

use super::CalibrationReport;

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
