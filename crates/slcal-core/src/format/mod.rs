//! Rigs, patterns, matches and clouds as text and binary files, on any `Read` and `Write`.

mod pattern_json;
mod rig_json;

pub use pattern_json::{read_pattern, write_pattern};
pub use rig_json::{read_rig, write_rig};
