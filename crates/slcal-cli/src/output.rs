//! All printing: results to stdout, everything else to stderr.

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
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

/// How often a progress bar is drawn anew while nothing happens.
const TICK: Duration = Duration::from_millis(200);

/// Messages of work that is done beside other work: kept until it is their turn to be printed.
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

/// How far many frames have come.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// One frame more is done.
    pub(crate) fn step(&self) {
        self.bar.inc(1);
    }

    /// Runs what prints, with the bar out of its way.
    pub(crate) fn around<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
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

    /// What was kept for later.
    pub(crate) fn remarks(self, remarks: &Remarks) {
        for (from, message) in &remarks.0 {
            self.to_stderr(*from, "", message);
        }
    }

    /// A progress bar on stderr, for `frames` frames where their number is known; invisible where stderr is no terminal.
    pub(crate) fn progress(self, frames: Option<usize>) -> Progress {
        let bar = match frames {
            _ if self.verbosity == Verbosity::Quiet => ProgressBar::hidden(),
            Some(0 | 1) => ProgressBar::hidden(),
            Some(n) => ProgressBar::new(n as u64).with_style(
                ProgressStyle::with_template("{bar:30} {pos} of {len} frames, {eta} left")
                    .unwrap_or_else(|_| ProgressStyle::default_bar()),
            ),
            None => ProgressBar::no_length().with_style(
                ProgressStyle::with_template("{spinner} {pos} frames in {elapsed}")
                    .unwrap_or_else(|_| ProgressStyle::default_spinner()),
            ),
        };
        if !bar.is_hidden() {
            bar.enable_steady_tick(TICK);
        }
        Progress { bar }
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
