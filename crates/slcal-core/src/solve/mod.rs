//! Numerics without vision: conditioning, null spaces, nonlinear least squares, covariance.

mod block_arrow_qr;
mod dlt;
mod lm;
mod nullspace;
mod polynomial;
mod robust;

pub(crate) use block_arrow_qr::{Structure, covariance};
pub(crate) use dlt::homography_from_points;
pub(crate) use lm::{Block, Linearised, Problem, minimise, polish};
pub(crate) use nullspace::null_vector;
pub(crate) use polynomial::Polynomial;
pub(crate) use robust::{Loss, median, median_f32, rms, robust_scale};
