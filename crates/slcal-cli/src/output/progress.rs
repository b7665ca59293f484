//! Progress on a terminal.

use std::io::{IsTerminal as _, Write as _};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::text_layout::sanitized;

/// Shorter work shows nothing, so that nothing flickers.
const PATIENCE: Duration = Duration::from_millis(400);
/// Interval of redrawing.
const TICK: Duration = Duration::from_millis(120);

/// Greatest length of a message, characters; the rest of the 80 columns is for the bar.
const LONGEST: usize = 36;
/// Returns to the start of the line and clears it.
const CLEAR_LINE: &[u8] = b"\r\x1b[2K";

/// The bar that is shown; other output goes above it.
static SHOWN: Mutex<Option<ProgressBar>> = Mutex::new(None);

/// Prints while the bar is hidden.
pub(super) fn suspended<T>(print: impl FnOnce() -> T) -> T {
    let shown = SHOWN.lock().unwrap_or_else(PoisonError::into_inner).clone();
    match shown {
        Some(bar) => bar.suspend(print),
        None => print(),
    }
}

/// Clears the bar before the process ends.
pub(crate) fn clear_on_interrupt() {
    // No waiting for the lock: the run may end while a line is being printed.
    if SHOWN.try_lock().is_ok_and(|shown| shown.is_some()) {
        // Not through the bar: its lock may be held by a print into a full pipe.
        let _ = std::io::stderr().write_all(CLEAR_LINE);
    }
}

/// Work in progress. Cleared when dropped.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
    /// Dropped to end the wait.
    done: Option<Sender<()>>,
    waiting: Option<JoinHandle<bool>>,
}

impl Progress {
    pub(super) fn counting(quiet: bool, of: &str, count: Option<usize>) -> Self {
        match count {
            Some(0 | 1) => Self::new(quiet, ProgressBar::hidden(), "{spinner} {msg}"),
            Some(n) => Self::new(
                quiet,
                ProgressBar::with_draw_target(Some(n as u64), ProgressDrawTarget::hidden()),
                &format!("{{bar:20}} {{pos}} of {{len}} {of}, {{eta}} left {{msg}}"),
            ),
            None => Self::new(
                quiet,
                ProgressBar::hidden(),
                &format!("{{spinner}} {{pos}} {of} in {{elapsed}} {{msg}}"),
            ),
        }
    }

    pub(super) fn busy(quiet: bool, doing: String) -> Self {
        let progress = Self::new(quiet, ProgressBar::hidden(), "{spinner} {msg}");
        progress.say(doing);
        progress
    }

    fn new(quiet: bool, bar: ProgressBar, template: &str) -> Self {
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        if quiet || !terminal() {
            return Self { bar, done: None, waiting: None };
        }
        let (done, wait) = channel();
        let shown = bar.clone();
        let waiting = thread::Builder::new().spawn(move || show_later(&shown, &wait)).ok();
        Self { bar, done: Some(done), waiting }
    }

    /// Sets the message.
    pub(crate) fn say(&self, doing: impl Into<String>) {
        self.bar.set_message(shortened(&doing.into()));
    }

    /// Counts one item.
    pub(crate) fn step(&self) {
        self.bar.inc(1);
    }

    /// Sets the number of items done.
    pub(crate) fn reached(&self, done: usize) {
        self.bar.set_position(done as u64);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        drop(self.done.take());
        if let Some(waiting) = self.waiting.take() {
            // The thread does not panic; if it did, the work itself would be unaffected.
            if waiting.join().unwrap_or(false) {
                SHOWN.lock().unwrap_or_else(PoisonError::into_inner).take();
            }
            self.bar.finish_and_clear();
        }
    }
}

/// Shows the bar if the work is not done after [`PATIENCE`]; returns whether it was shown.
fn show_later(bar: &ProgressBar, wait: &Receiver<()>) -> bool {
    if wait.recv_timeout(PATIENCE) != Err(RecvTimeoutError::Timeout) {
        return false;
    }
    let mut shown = SHOWN.lock().unwrap_or_else(PoisonError::into_inner);
    // Nested work is not shown.
    let first = shown.is_none();
    if first {
        bar.set_draw_target(ProgressDrawTarget::stderr());
        bar.enable_steady_tick(TICK);
        *shown = Some(bar.clone());
    }
    first
}

/// A message that is shortened in the middle, so that the line does not wrap.
fn shortened(message: &str) -> String {
    let letters: Vec<char> = sanitized(message).chars().collect();
    if letters.len() <= LONGEST {
        return letters.into_iter().collect();
    }
    let half = LONGEST / 2;
    let ends = [&letters[..half], &letters[letters.len() - half + 1..]];
    ends.map(|part| part.iter().collect::<String>()).join("…")
}

/// Whether stderr is a terminal that can redraw a line.
fn terminal() -> bool {
    std::io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|t| t != "dumb")
}
