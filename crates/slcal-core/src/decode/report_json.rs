//! `slcal-decode/1`: the report of decoding.

use serde::Serialize;

use super::DecodeReport;

#[derive(Serialize)]
struct Tagged<'a> {
    schema: &'static str,
    #[serde(flatten)]
    report: &'a DecodeReport,
}

impl DecodeReport {
    /// The record with its schema.
    #[must_use]
    pub fn to_json(&self) -> impl Serialize {
        Tagged { schema: "slcal-decode/1", report: self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_record_is_the_report_with_a_schema() {
        let decode = DecodeReport { crossings: 12, decoded: 7, ..DecodeReport::default() };
        let mut printed = serde_json::to_value(decode.to_json()).unwrap();
        assert_eq!(printed["schema"].take(), json!("slcal-decode/1"));
        printed.as_object_mut().unwrap().remove("schema");
        assert_eq!(printed, serde_json::to_value(&decode).unwrap());
    }
}
