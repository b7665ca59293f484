//! The report on each frame, as JSON and in words.

use serde::Serialize;
use slcal_core::Reconstruction;

use crate::exit::{Failure, Outcome};
use crate::output::print_json;
use crate::summary;

/// One object with all clouds.
#[derive(Serialize)]
struct Reports<'a> {
    schema: &'static str,
    clouds: &'a [Report],
}

pub(in crate::verbs) fn print_reports(clouds: &[Report]) -> Outcome {
    print_json(&Reports { schema: "slcal-reconstruct/1", clouds })
}

/// The outcome of one frame.
#[derive(Debug, Serialize)]
pub(in crate::verbs) struct Report {
    /// Its name; bytes that are not Unicode are replaced.
    pub(in crate::verbs) image: String,
    /// Which frame of a stream.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(in crate::verbs) frame: Option<usize>,
    /// The cloud, when there is one.
    pub(in crate::verbs) output: Option<String>,
    #[serde(flatten)]
    pub(in crate::verbs) result: FrameResult,
}

#[derive(Debug, Serialize)]
#[serde(untagged)]
pub(in crate::verbs) enum FrameResult {
    Cloud(Box<CloudReport>),
    Resumed { resumed: bool },
    Failed { error: ErrorReport },
}

#[derive(Debug, Serialize)]
pub(in crate::verbs) struct ErrorReport {
    pub(in crate::verbs) exit_code: u8,
    message: String,
}

impl ErrorReport {
    pub(in crate::verbs) fn of(failure: &Failure) -> Self {
        Self { exit_code: failure.code(), message: failure.to_string() }
    }
}

/// A cloud that was written.
#[derive(Debug, Serialize)]
pub(in crate::verbs) struct CloudReport {
    #[serde(flatten)]
    numbers: slcal_core::CloudReport,
    /// The summary, for a single frame.
    #[serde(skip)]
    pub(in crate::verbs) text: String,
    /// A line, for one frame of many.
    #[serde(skip)]
    pub(in crate::verbs) line: String,
}

impl CloudReport {
    pub(in crate::verbs) fn of(result: &Reconstruction) -> Self {
        let text = summary::reconstruction(result);
        Self { numbers: result.report(), text, line: summary::cloud_in_a_line(result) }
    }
}
