//! How far a calibration can be trusted: the verdict, and what does not fit.

pub(crate) mod aspect;
pub(crate) mod contradiction;
pub(crate) mod misfit;
pub(crate) mod repeated;
pub(crate) mod transposed;
pub(crate) mod verdict;
