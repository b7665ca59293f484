//! Messages and results while frames are processed, and at the end.

use super::frames::Frame;
use super::report::{ErrorReport, FrameResult, Report, print_reports};
use crate::args::ReconstructArgs;
use crate::exit::{Failure, Outcome};
use crate::io::{input_name, is_dash};
use crate::output::{Printer, Progress, Remarks, print_result, sanitized};

/// A processed frame.
pub(in crate::verbs) struct Done {
    pub(in crate::verbs) frame: Frame,
    pub(in crate::verbs) remarks: Remarks,
    pub(in crate::verbs) outcome: Outcome<FrameResult>,
}

/// Prints the result of each frame, and a report at the end.
pub(in crate::verbs) struct Reporter<'a> {
    args: &'a ReconstructArgs,
    printer: Printer,
    progress: Progress,
    /// For `--json` alone: a stream may be endless.
    reports: Vec<Report>,
    /// Numbers of clouds written, skipped and failed.
    written: usize,
    resumed: usize,
    failed: usize,
    /// The exit code of the first error.
    code: Option<u8>,
    /// Whether the reader of stdout has gone. The clouds are still written.
    stdout_closed: bool,
}

impl<'a> Reporter<'a> {
    pub(in crate::verbs) fn new(args: &'a ReconstructArgs, printer: Printer, count: Option<usize>) -> Self {
        let progress = printer.progress("frames", count);
        if let ([image], None) = (args.images.as_slice(), args.raw) {
            progress.say(format!("reconstructing {}", input_name(image)));
        }
        Self {
            args,
            printer,
            progress,
            reports: Vec::new(),
            written: 0,
            resumed: 0,
            failed: 0,
            code: None,
            stdout_closed: false,
        }
    }

    /// Takes the next frame, in order. A failure ends the run with `-o`; with a folder it is printed and the run continues.
    pub(in crate::verbs) fn take(&mut self, done: Done) -> Outcome {
        let Done { frame, remarks, outcome } = done;
        let output = frame.place.as_ref().ok().map(|p| p.name.clone());
        let heading = format!("{} -> {}", frame.name(), output.as_deref().unwrap_or_default());
        let result = match outcome {
            Err(failure) if self.args.output.is_some() => {
                self.printer.remarks(&remarks);
                return Err(failure);
            }
            Err(failure) => {
                self.printer.remarks(&remarks);
                self.printer.error(&failure);
                FrameResult::Failed { error: ErrorReport::of(&failure) }
            }
            Ok(result) => {
                self.printer.remarks(&remarks);
                match self.print(&heading, &result) {
                    Err(Failure::ClosedPipe) => self.stdout_closed = true,
                    printed => printed?,
                }
                result
            }
        };
        self.count(&result);
        self.progress.step();
        if self.args.json {
            let output = output.filter(|_| !matches!(result, FrameResult::Failed { .. }));
            let image = frame.image.display().to_string();
            self.reports.push(Report { image, frame: frame.number, output, result });
        }
        Ok(())
    }

    /// The result in words: a summary for a single photograph, a line for one of many.
    fn print(&self, heading: &str, result: &FrameResult) -> Outcome {
        match (result, &self.args.output) {
            (FrameResult::Cloud(_), _) if self.args.json || self.stdout_closed => Ok(()),
            (FrameResult::Cloud(report), None) => {
                print_result(&format!("{}: {}", sanitized(heading), report.line))
            }
            (FrameResult::Cloud(report), Some(output)) => self.printer.summary(&report.text, is_dash(output)),
            (FrameResult::Resumed { .. }, _) => {
                self.printer.note(format!("{heading}: skipped, its cloud is complete"));
                Ok(())
            }
            (FrameResult::Failed { .. }, _) => Ok(()),
        }
    }

    fn count(&mut self, result: &FrameResult) {
        match result {
            FrameResult::Cloud(_) => self.written += 1,
            FrameResult::Resumed { .. } => self.resumed += 1,
            FrameResult::Failed { error } => {
                self.failed += 1;
                self.code.get_or_insert(error.exit_code);
            }
        }
    }

    pub(in crate::verbs) fn finish(self) -> Outcome {
        drop(self.progress);
        let json = if self.args.json { print_reports(&self.reports) } else { Ok(()) };
        if self.written + self.resumed + self.failed > 1 {
            self.printer.note(format!(
                "{} clouds written, {} skipped, {} frames failed",
                self.written, self.resumed, self.failed
            ));
        }
        self.code.map_or(json, |code| Err(Failure::Reported(code)))
    }
}
