//! All printing: results to stdout, everything else to stderr.

mod progress;
mod style;
mod text_layout;

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};

use serde::Serialize;

pub(crate) use self::progress::{Progress, clear_on_interrupt};
pub(crate) use self::style::{BAD, BOLD, ColorArg, FAIR, GOOD, HELP, set_color, styled};
pub(crate) use self::text_layout::{
    MAX_WIDTH, Table, TextLayout, display_width, sanitized, unbroken, without_style, wrapped,
};
use crate::exit::{Exit, Failure, Outcome};

/// How much is printed on stderr.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Verbosity {
    /// Errors only.
    Quiet,
    /// Warnings and notes too.
    Normal,
    /// Details as well.
    Verbose,
}

/// Messages of parallel work, kept until it is their turn to be printed.
#[derive(Debug, Default)]
pub(crate) struct Remarks(Vec<(Verbosity, String)>);

impl Remarks {
    /// See [`Printer::note`].
    pub(crate) fn note(&mut self, message: impl Into<String>) {
        self.0.push((Verbosity::Normal, message.into()));
    }

    /// See [`Printer::detail`].
    pub(crate) fn detail(&mut self, message: impl Into<String>) {
        self.0.push((Verbosity::Verbose, message.into()));
    }
}

/// The one place that prints messages.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Printer {
    verbosity: Verbosity,
}

impl Printer {
    pub(crate) fn new(verbosity: Verbosity) -> Self {
        Self { verbosity }
    }

    /// Something worth knowing.
    pub(crate) fn note(self, message: impl Display) {
        self.to_stderr(Verbosity::Normal, "", &sanitized(&message.to_string()));
    }

    /// Something for those who asked for more.
    pub(crate) fn detail(self, message: impl Display) {
        self.to_stderr(Verbosity::Verbose, "", &sanitized(&message.to_string()));
    }

    /// Why the run failed; always printed.
    pub(crate) fn error(self, message: impl Display) {
        let label = format!("{} ", styled(BAD, "slcal:"));
        self.to_stderr(Verbosity::Quiet, &label, &sanitized(&message.to_string()));
    }

    /// A summary: on stdout, or on stderr when stdout carries another result.
    pub(crate) fn summary(self, text: &str, stdout_is_taken: bool) -> Outcome {
        if !stdout_is_taken {
            return print_result(text);
        }
        self.to_stderr(Verbosity::Normal, "", text.trim_end());
        Ok(())
    }

    /// Messages that were kept.
    pub(crate) fn remarks(self, remarks: &Remarks) {
        for (from, message) in &remarks.0 {
            self.to_stderr(*from, "", &sanitized(message));
        }
    }

    /// Progress over items ("frames"), with their number where it is known. Shown on a terminal after a moment, and cleared
    /// when dropped.
    pub(crate) fn progress(self, of: &str, count: Option<usize>) -> Progress {
        Progress::counting(self.is_quiet(), of, count)
    }

    /// Progress of one piece of work ("decoding a.jpg").
    pub(crate) fn busy(self, doing: impl Into<String>) -> Progress {
        Progress::busy(self.is_quiet(), doing.into())
    }

    fn is_quiet(self) -> bool {
        self.verbosity == Verbosity::Quiet
    }

    fn to_stderr(self, from: Verbosity, label: &str, message: &str) {
        if self.verbosity >= from {
            let text = text_layout::for_stderr(label, message);
            // A closed stderr is no reason to fail.
            progress::suspended(|| {
                let _ = writeln!(anstream::stderr().lock(), "{text}");
            });
        }
    }
}

/// A result for people, on stdout.
pub(crate) fn print_result(text: &str) -> Outcome {
    progress::suspended(|| {
        let mut out = anstream::stdout().lock();
        writeln!(out, "{}", text.trim_end()).and_then(|()| out.flush()).map_err(|e| unprinted(&e))
    })
}

/// A result for programs, on stdout: one JSON object. A program that does not read it to its end has not got the result, so that
/// a closed pipe is an error here.
pub(crate) fn print_json(value: &impl Serialize) -> Outcome {
    let text = serde_json::to_string_pretty(value)
        .map_err(|e| Failure::new(Exit::Other, format!("cannot write the result as JSON: {e}")))?;
    to_stdout(|out| writeln!(out, "{text}")).map_err(|failure| match failure {
        Failure::ClosedPipe => {
            let why = "expected stdout to be read until the end of the JSON, but its reader has closed it";
            Failure::new(Exit::Other, why)
        }
        other => other,
    })
}

/// Writes bytes to stdout; a closed pipe ends the run quietly.
pub(crate) fn to_stdout(write: impl FnOnce(&mut io::StdoutLock<'_>) -> io::Result<()>) -> Outcome {
    progress::suspended(|| {
        let mut out = io::stdout().lock();
        write(&mut out).and_then(|()| out.flush()).map_err(|e| unprinted(&e))
    })
}

fn unprinted(e: &io::Error) -> Failure {
    match e.kind() {
        ErrorKind::BrokenPipe => Failure::ClosedPipe,
        _ => Failure::new(Exit::Other, format!("cannot write to stdout: {e}")),
    }
}
