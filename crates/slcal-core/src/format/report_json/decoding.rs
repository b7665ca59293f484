//! `slcal-decode/1`: what decoding saw and why it left some of it out.

use serde::Serialize;

use crate::decode::DecodeReport;

#[derive(Serialize)]
struct Report<'a> {
    schema: &'static str,
    #[serde(flatten)]
    report: &'a DecodeReport,
}

/// What decoding reports of one photograph.
#[must_use]
pub fn decoding(report: &DecodeReport) -> impl Serialize {
    Report { schema: "slcal-decode/1", report }
}
