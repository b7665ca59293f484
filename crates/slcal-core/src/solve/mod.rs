//! Numerics without vision: conditioning, null spaces, nonlinear least squares, covariance.

mod block_arrow_qr;
mod dlt;
mod lm;
mod marginal_likelihood;
mod nullspace;
mod polynomial;
mod robust;

pub(crate) use block_arrow_qr::{Structure, covariance, predicted_decrease};
pub(crate) use dlt::homography_from_points;
pub(crate) use lm::{
    Block, CONVERGED_DECREASE, INITIAL_DAMPING, Linearised, Minimum, Problem, minimise, minimise_from,
    polish, undamped,
};
pub(crate) use marginal_likelihood::MarginalLikelihood;
pub(crate) use nullspace::null_vector;
pub(crate) use polynomial::Polynomial;
pub(crate) use robust::{Loss, median, median_f32, rms, robust_scale};
