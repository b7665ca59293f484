//! Configuration and report of a fit.

use nalgebra::Point3;
use serde::{Deserialize, Serialize};

use crate::cloud::PointCloud;
use crate::error::{Error, ErrorSubject, Result, within};

/// Configuration of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FitConfig {
    /// Number of random samples.
    pub samples: u32,
    /// Seed of the samples: the same seed gives the same fit.
    pub seed: u64,
    /// Distance within which points agree with a proposal, per cent of their median distance to the camera. The final
    /// limit follows the measured scatter and may be smaller or larger.
    pub consensus_percent: f64,
    /// The final limit in units of the inliers' robust σ (1.4826 × the median of |distance|).
    pub inlier_sigmas: f64,
}

impl Default for FitConfig {
    fn default() -> Self {
        Self { samples: 2000, seed: 1, consensus_percent: 0.5, inlier_sigmas: 4.0 }
    }
}

impl FitConfig {
    /// Checks the ranges of the fields.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the field.
    pub fn validate(&self) -> Result<()> {
        within("samples", self.samples, [1, 1_000_000], "")?;
        within("consensus_percent", self.consensus_percent, [1e-6, 50.0], "")?;
        within("inlier_sigmas", self.inlier_sigmas, [1.0, 100.0], "")
    }
}

/// Distances of the inliers from the fitted surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FitReport {
    /// Points of the cloud.
    pub points: usize,
    /// Points no further than `inlier_limit_mm` from the surface.
    pub inliers: usize,
    /// Share of the others, 0–1.
    pub outlier_share: f64,
    /// The limit for inliers, mm: `inlier_sigmas` times their robust σ.
    pub inlier_limit_mm: f64,
    /// Mean of |distance|, mm.
    pub mean_mm: f64,
    /// Standard deviation of |distance|, mm.
    pub std_mm: f64,
    /// Root mean square of the distance, mm.
    pub rms_mm: f64,
    /// Mean distance of the inliers from the camera, mm.
    pub camera_distance_mm: f64,
    /// `mean_mm` in per cent of the distance from the camera.
    pub mean_percent: f64,
    /// `std_mm` in per cent of the distance from the camera.
    pub std_percent: f64,
    /// `rms_mm` in per cent of the distance from the camera.
    pub rms_percent: f64,
}

/// The finite positions of a cloud; at least `least` of them.
pub(super) fn finite_points(cloud: &PointCloud, what: &str, least: usize) -> Result<Vec<Point3<f64>>> {
    let points: Vec<Point3<f64>> =
        cloud.points.iter().map(|p| p.position).filter(|p| p.iter().all(|x| x.is_finite())).collect();
    if points.len() < least {
        return Err(Error::invalid(
            ErrorSubject::Cloud,
            format!("at least {least} points to fit a {what}"),
            points.len(),
        ));
    }
    Ok(points)
}

/// Statistics over the points within `limit` of the surface.
pub(super) fn report(
    points: &[Point3<f64>],
    camera: &Point3<f64>,
    limit: f64,
    distance: impl Fn(&Point3<f64>) -> f64,
) -> FitReport {
    let (mut n, mut sum, mut squares, mut range) = (0_usize, 0.0, 0.0, 0.0);
    for p in points {
        let d = distance(p).abs();
        if d <= limit {
            n += 1;
            sum += d;
            squares += d * d;
            range += (p - camera).norm();
        }
    }
    let count = n.max(1) as f64;
    let (mean, rms, far) = (sum / count, (squares / count).sqrt(), range / count);
    let std = (squares / count - mean * mean).max(0.0).sqrt();
    let percent = |x: f64| if far > 0.0 { 100.0 * x / far } else { 0.0 };
    FitReport {
        points: points.len(),
        inliers: n,
        outlier_share: 1.0 - n as f64 / points.len().max(1) as f64,
        inlier_limit_mm: limit,
        mean_mm: mean,
        std_mm: std,
        rms_mm: rms,
        camera_distance_mm: far,
        mean_percent: percent(mean),
        std_percent: percent(std),
        rms_percent: percent(rms),
    }
}
