//! The command line as a user meets it: exit codes, messages and files of the real binary.

mod advise;
mod bad_input;
mod bug_report;
mod calibrate;
mod calibrate_sequence;
mod earlier_files;
mod evaluate;
mod exchange;
mod general;
mod help;
mod known_lens;
mod mirrored;
mod mistakes;
mod observations;
mod pattern;
mod photo_tags;
mod reconstruct;
mod rendered;
mod report;
mod sequence;
mod simulate;
mod sizes;
mod snapshots;
mod studio;
mod terminal;
mod trust;
mod verify;

use slcal_tests::Bench;

fn bench() -> Bench {
    Bench::new(env!("CARGO_BIN_EXE_slcal-under-test"))
}
