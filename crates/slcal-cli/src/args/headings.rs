//! The headings of options in the help of every verb.

/// Files to read, and what is known of them.
pub(super) const INPUT: &str = "Input";
/// What the work is to do.
pub(super) const SETTINGS: &str = "Settings";
/// Assumptions and methods.
pub(super) const MODEL: &str = "Model";
/// Files to write, and their contents.
pub(super) const OUTPUT: &str = "Output";
/// What holds for every verb.
pub(super) const GENERAL: &str = "General";
