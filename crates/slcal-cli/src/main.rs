//! The `slcal` binary.

fn main() {}
