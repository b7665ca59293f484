//! How far a calibration can be trusted: the verdict, and what does not fit.

pub(crate) mod advice;
pub(crate) mod residuals;
pub(crate) mod verdict;
