//! Rigs, patterns, matches and clouds as text and binary files, on any `Read` and `Write`.

mod pattern_json;

pub use pattern_json::{read_pattern, write_pattern};
