//! Other explanations of what was seen: each is tried, and said where it explains more.

pub(crate) mod aspect;
pub(crate) mod contradiction;
pub(crate) mod distortion_choice;
pub(crate) mod repeated;
pub(crate) mod transposed;
