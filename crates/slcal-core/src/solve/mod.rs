//! Numerics without vision: conditioning, null spaces, nonlinear least squares, covariance.

mod dlt;
mod nullspace;

pub use dlt::homography_from_points;
pub use nullspace::null_vector;
