//! Numerics without vision: conditioning, null spaces, nonlinear least squares, covariance.

mod dlt;
mod lm;
mod nullspace;
mod polynomial;
mod robust;

pub use dlt::homography_from_points;
pub use lm::{Block, CONVERGED_DECREASE, Minimum, Problem, covariance, minimise, robust_cost};
pub use nullspace::null_vector;
pub use polynomial::Polynomial;
pub use robust::{Loss, robust_scale};
