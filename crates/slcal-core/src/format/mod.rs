//! Rigs, patterns, matches and clouds as text and binary files, on any `Read` and `Write`.

mod matches_csv;
mod pattern_json;
mod ply;
mod rig_json;

pub use matches_csv::{read_matches, write_matches};
pub use pattern_json::{read_pattern, write_pattern};
pub use ply::{read_ply, write_ply};
pub use rig_json::{read_rig, write_rig};
