//! Numerics without vision: conditioning, null spaces, nonlinear least squares, covariance.

mod block_arrow_qr;
mod dlt;
mod lm;
mod nullspace;
mod polynomial;
mod robust;

pub use block_arrow_qr::{Structure, covariance};
pub use dlt::homography_from_points;
pub use lm::{Block, CONVERGED_DECREASE, Linearised, Minimum, Problem, minimise, polish, robust_cost};
pub use nullspace::null_vector;
pub use polynomial::Polynomial;
pub use robust::{Loss, median, median_f32, rms, robust_scale};
