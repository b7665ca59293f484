//! How far a calibration can be trusted: the verdict, and what does not fit.

pub(crate) mod advice;
mod far_from_prior;
pub(crate) mod residuals;
pub(crate) mod verdict;
