//! Tests across the crates: the real binary, the rendered scenes.
