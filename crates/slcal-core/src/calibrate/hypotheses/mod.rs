//! Other explanations of the observations. Each is tried, and reported where it fits better.

pub(crate) mod aspect;
pub(crate) mod centimetres;
pub(crate) mod contradiction;
mod misfit;
pub(crate) mod transposed;
