//! The `slcal` command.
