//! A plane or a sphere that is fitted to a cloud, as `evaluate` and the report of `reconstruct` show it.

use slcal_core::PointCloud;
use slcal_core::evaluate::{FitConfig, FitReport, PlaneFit, SphereFit, fit_plane, fit_sphere};

use crate::args::ShapeArg;

/// A surface that was fitted to a cloud.
pub(crate) enum FittedSurface {
    Plane(PlaneFit),
    Sphere(SphereFit),
}

impl FittedSurface {
    pub(crate) fn new(shape: ShapeArg, cloud: &PointCloud, config: &FitConfig) -> slcal_core::Result<Self> {
        match shape {
            ShapeArg::Plane => fit_plane(cloud, config).map(Self::Plane),
            ShapeArg::Sphere => fit_sphere(cloud, config).map(Self::Sphere),
        }
    }

    /// What was fitted, and what distances below and above zero are called.
    pub(crate) fn in_words(&self) -> (&'static str, [&'static str; 2]) {
        match self {
            // The normal points to the camera: points nearer to it are positive.
            Self::Plane(_) => ("plane", ["behind it", "before it"]),
            Self::Sphere(_) => ("sphere", ["inside", "outside"]),
        }
    }

    /// The statistics of the inliers.
    pub(crate) fn report(&self) -> &FitReport {
        match self {
            Self::Plane(fit) => &fit.report,
            Self::Sphere(fit) => &fit.report,
        }
    }

    /// The signed distance of every point, mm.
    pub(crate) fn distances_mm(&self, cloud: &PointCloud) -> Vec<f64> {
        let positions = cloud.points.iter().map(|p| &p.position);
        match self {
            Self::Plane(fit) => positions.map(|p| fit.plane.signed_distance_mm(p)).collect(),
            Self::Sphere(fit) => positions.map(|p| (p - fit.centre).norm() - fit.radius_mm).collect(),
        }
    }
}
