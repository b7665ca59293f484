//! Signals that ask the run to end: it ends between two files.

use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

use super::temporary::{none_exist, remove_waiting};
use crate::output::clear_on_interrupt;

/// Whether a signal is the usual end of this run.
static USUAL_END: AtomicBool = AtomicBool::new(false);

/// A signal is the usual end of this run: its exit code is 0.
#[cfg(feature = "studio")]
pub(crate) fn end_normally_on_signals() {
    USUAL_END.store(true, Ordering::Relaxed);
}

/// Makes Ctrl-C and requests to terminate end the run between two files, so that nothing unfinished is left behind. The exit
/// code is 128 plus the signal's number, as shells report it. Signals that are ignored, or handled by the embedding
/// program, stay so.
pub(crate) fn end_whole_on_signals() {
    static LISTENING: Once = Once::new();
    LISTENING.call_once(listen);
}

#[cfg_attr(not(any(unix, windows)), expect(dead_code))]
fn end(signal: i32) {
    let _alone = none_exist();
    remove_waiting();
    clear_on_interrupt();
    std::process::exit(if USUAL_END.load(Ordering::Relaxed) { 0 } else { 128 + signal });
}

/// Without a thread for signals, one that comes during writing may leave a hidden temporary file, which the next run removes. That
/// is no reason to refuse to run.
#[cfg(unix)]
fn listen() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;

    let ours = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| !is_taken(*signal));
    let Ok(mut signals) = Signals::new(ours) else { return };
    let _ = std::thread::Builder::new().name("signals".into()).spawn(move || signals.forever().for_each(end));
}

/// Whether a signal is ignored or handled already: by `nohup`, a shell's `&`, or an embedding program.
#[cfg(any(target_os = "linux", target_os = "android"))]
fn is_taken(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    ["SigIgn:", "SigCgt:"].into_iter().any(|field| has_signal(&status, field, signal))
}

/// Whether a mask of /proc/self/status has a signal.
#[cfg(any(target_os = "linux", target_os = "android"))]
fn has_signal(status: &str, field: &str, signal: i32) -> bool {
    let mask = status.lines().find_map(|line| line.strip_prefix(field));
    let mask = mask.and_then(|hex| u64::from_str_radix(hex.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

/// Elsewhere nothing safe tells. Ctrl-C comes from a terminal, and `nohup` and `&` leave none.
#[cfg(all(unix, not(any(target_os = "linux", target_os = "android"))))]
fn is_taken(signal: i32) -> bool {
    use std::io::IsTerminal as _;
    signal != signal_hook::consts::SIGTERM && !std::io::stderr().is_terminal()
}

#[cfg(windows)]
fn listen() {
    const SIGINT: i32 = 2;
    let _ = ctrlc::try_set_handler(|| end(SIGINT));
}

#[cfg(not(any(unix, windows)))]
fn listen() {}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::has_signal;

    #[test]
    fn masks_count_signals_from_one() {
        // SIGHUP (1) and SIGINT (2) ignored, SIGTERM (15) caught.
        let status =
            "Name:\tslcal\nSigBlk:\t0000000000000000\nSigIgn:\t0000000000000003\nSigCgt:\t0000000000004000\n";
        assert!(has_signal(status, "SigIgn:", 1) && has_signal(status, "SigIgn:", 2));
        assert!(!has_signal(status, "SigIgn:", 15) && has_signal(status, "SigCgt:", 15));
        assert!(!has_signal("", "SigIgn:", 2));
    }
}
