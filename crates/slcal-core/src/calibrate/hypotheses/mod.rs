//! Other explanations of the observations. Each is tried, and reported where it fits better.

pub(crate) mod aspect;
pub(crate) mod centimetres;
pub(crate) mod contradiction;
pub(crate) mod distortion_choice;
mod misfit;
pub(crate) mod repeated;
pub(crate) mod transposed;
