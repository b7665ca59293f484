//! Matches + [`Rig`](crate::Rig) → [`PointCloud`](crate::PointCloud): triangulation, removal of outliers, mesh.

mod camera_ray;
mod components;
mod cull;
mod delaunay;
mod dense;
mod expected_uncertainty;
mod frame;
mod length_uncertainty;
mod light_plane;
mod local_slant;
mod point_covariance;
mod rig_check;
mod sampled_median;
mod synthetic_match;
mod triangle_metrics;
mod triangulate;
mod triangulate_config;
#[cfg(test)]
mod triangulate_tests;

pub use cull::CullRule;
public_with! { "report": pub use cull::CullReport; }
public_with! { "stages": pub use cull::Culler; }
public_with! { "stages": pub use dense::DenseTriangulator; }
public_with! { "report": pub use expected_uncertainty::{ExpectedSigma, ExpectedUncertainty}; }
public_with! { "stages": pub use frame::in_frame; }
pub(crate) use frame::{first_view, turn};
public_with! { "report": pub use length_uncertainty::{LengthSigma, length_sigma}; }
pub(crate) use rig_check::RigChecker;
public_with! { "report": pub use rig_check::{RigCheckReport, SlitCount}; }
public_with! { "stages": pub use triangulate::{Triangulator, triangulate}; }
pub use triangulate_config::TriangulateConfig;
public_with! { "report": pub use triangulate_config::TriangulateReport; }
