//! How well a cloud fits a plane or a sphere, though it may hold a wall as well.
//!
//! Random samples propose surfaces (M. Fischler, R. Bolles, "Random sample consensus", CACM 24:381-395, 1981), the one with
//! the best consensus is refined by least squares over its inliers, and the limit for inliers follows the scatter that
//! is measured about it.

mod plane;
mod ransac;
mod report;
mod report_json;
mod sphere;

pub use plane::{PlaneFit, fit_plane};
pub use report::{FitConfig, FitReport};
pub use sphere::{SphereFit, fit_sphere};
