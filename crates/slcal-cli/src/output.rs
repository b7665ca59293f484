//! All printing: results to stdout, everything else to stderr.

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};

use serde::Serialize;

use crate::exit::{Exit, Failure, Outcome};

/// How much is said on stderr.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Verbosity {
    /// Errors only.
    Quiet,
    /// Warnings and notes too.
    Normal,
    /// Details as well.
    Verbose,
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
        self.to_stderr(Verbosity::Normal, "", message);
    }

    /// Something for those who asked for more.
    pub(crate) fn detail(self, message: impl Display) {
        self.to_stderr(Verbosity::Verbose, "", message);
    }

    /// Why the run ended; always said.
    pub(crate) fn error(self, message: impl Display) {
        self.to_stderr(Verbosity::Quiet, "slcal: ", message);
    }

    fn to_stderr(self, from: Verbosity, prefix: &str, message: impl Display) {
        if self.verbosity >= from {
            // A closed stderr is no reason to fail.
            let _ = writeln!(io::stderr().lock(), "{prefix}{message}");
        }
    }
}

/// A result for people, on stdout.
pub(crate) fn print_result(text: &str) -> Outcome {
    to_stdout(|out| writeln!(out, "{}", text.trim_end()))
}

/// A result for programs, on stdout: one JSON object.
pub(crate) fn print_json(value: &impl Serialize) -> Outcome {
    let text = serde_json::to_string_pretty(value)
        .map_err(|e| Failure::new(Exit::Other, format!("cannot write the result as JSON: {e}")))?;
    print_result(&text)
}

/// Writes to stdout; a reader that has gone away ends the run quietly.
pub(crate) fn to_stdout(write: impl FnOnce(&mut io::StdoutLock<'_>) -> io::Result<()>) -> Outcome {
    let mut out = io::stdout().lock();
    write(&mut out).and_then(|()| out.flush()).map_err(|e| match e.kind() {
        ErrorKind::BrokenPipe => Failure::ClosedPipe,
        _ => Failure::new(Exit::Other, format!("cannot write to stdout: {e}")),
    })
}
