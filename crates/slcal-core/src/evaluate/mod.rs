//! How well a cloud fits a plane or a sphere; it may contain a wall as well.
//!
//! RANSAC (M. Fischler, R. Bolles, "Random sample consensus", CACM 24:381-395, 1981) proposes surfaces from random
//! samples. The one with the best consensus is refined by least squares over its inliers. The inlier limit follows the
//! measured scatter.

mod plane;
mod ransac;
mod report;
mod report_json;
mod sphere;

pub use plane::{PlaneFit, fit_plane};
pub use report::{FitConfig, FitReport};
pub use sphere::{SphereFit, fit_sphere};
