//! The plane that most of a cloud lies on.

use nalgebra::{Matrix3, Point3, SymmetricEigen, Vector3};

use super::ransac::{FitModel, fit};
use super::report::{FitConfig, FitReport, finite_points, report};
use crate::cloud::PointCloud;
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::Plane;

/// A plane and how well it fits.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PlaneFit {
    /// The plane; its normal points to the camera.
    pub plane: Plane,
    /// Statistics over the inliers.
    pub report: FitReport,
}

/// Fits the plane that most points lie on.
///
/// # Errors
/// [`Error::Invalid`] for fewer than three finite points or a configuration out of range; [`Error::Degenerate`] when all
/// points lie on one line.
///
/// # Examples
/// ```
/// use slcal_core::evaluate::{FitConfig, fit_plane};
/// use slcal_core::nalgebra::Point3;
/// use slcal_core::{CloudPoint, PointCloud};
///
/// # let point = |i: u32| CloudPoint {
/// #     position: Point3::new(f64::from(i % 20), f64::from(i / 20), 1000.0 + f64::from(i % 20)),
/// #     pixel: slcal_core::nalgebra::Point2::origin(),
/// #     color: [0; 3],
/// #     sigma_mm: 0.1,
/// #     noise_mm: 0.1,
/// #     slit: None,
/// #     confidence: 1.0,
/// # };
/// let cloud = PointCloud { points: (0..400).map(point).collect(), ..PointCloud::default() };
/// let fit = fit_plane(&cloud, &FitConfig::default())?;
/// assert!(fit.report.rms_mm < 1e-9 && (fit.plane.normal.z.abs() - 0.5_f64.sqrt()).abs() < 1e-9);
/// # Ok::<(), slcal_core::Error>(())
/// ```
pub fn fit_plane(cloud: &PointCloud, config: &FitConfig) -> Result<PlaneFit> {
    config.validate()?;
    let points = finite_points(cloud, "plane", 3)?;
    let camera = cloud.camera_centre;
    let (FoundPlane(plane), limit) = fit(&points, &camera, config).ok_or_else(|| Error::Degenerate {
        what: ErrorSubject::Plane,
        measure: spread_across(&points),
        limit: MIN_SHAPE,
        advice: "the points coincide or lie on one line (the number is their spread across it over that along it): \
                 evaluate the cloud of a surface"
            .into(),
    })?;
    Ok(PlaneFit { plane, report: report(&points, &camera, limit, |p| plane.signed_distance_mm(p)) })
}

struct FoundPlane(Plane);

/// Flattest triangle that is accepted as a proposal: twice its area over its longest side squared.
const MIN_SHAPE: f64 = 1e-3;

/// Second-largest over largest standard deviation along the principal axes; 0 for points that coincide.
fn spread_across(points: &[Point3<f64>]) -> f64 {
    let n = points.len().max(1) as f64;
    let mean = points.iter().fold(Vector3::zeros(), |s, p| s + p.coords / n);
    let scatter =
        points.iter().fold(Matrix3::zeros(), |s, p| s + (p.coords - mean) * (p.coords - mean).transpose());
    let Some(eigen) = SymmetricEigen::try_new(scatter, f64::EPSILON, 100) else { return 0.0 };
    let mut values = eigen.eigenvalues;
    values.as_mut_slice().sort_by(f64::total_cmp);
    let ratio = (values[1] / values[2]).max(0.0).sqrt();
    if ratio.is_finite() { ratio } else { 0.0 }
}

fn facing(point: &Point3<f64>, normal: Vector3<f64>, camera: &Point3<f64>) -> Option<FoundPlane> {
    let towards = if normal.dot(&(camera - point)) < 0.0 { -normal } else { normal };
    Plane::from_point_normal(point, towards).map(FoundPlane)
}

impl FitModel for FoundPlane {
    const SAMPLE: usize = 3;

    fn through(sample: &[Point3<f64>], camera: &Point3<f64>) -> Option<Self> {
        let &[a, b, c] = sample else { return None };
        let normal = (b - a).cross(&(c - a));
        let longest = (b - a).norm_squared().max((c - a).norm_squared()).max((c - b).norm_squared());
        (normal.norm() > MIN_SHAPE * longest).then(|| facing(&a, normal, camera))?
    }

    fn distance(&self, p: &Point3<f64>, _: &Point3<f64>) -> f64 {
        self.0.signed_distance_mm(p).abs()
    }

    /// Total least squares: the normal is the direction of least scatter about the mean.
    fn refined(&self, points: &[Point3<f64>], camera: &Point3<f64>) -> Option<Self> {
        let n = points.len() as f64;
        let mean = Point3::from(points.iter().fold(Vector3::zeros(), |s, p| s + p.coords) / n);
        let mut scatter = Matrix3::zeros();
        for p in points {
            let d = p - mean;
            scatter += d * d.transpose();
        }
        let eigen = SymmetricEigen::try_new(scatter / n, f64::EPSILON, 100)?;
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| eigen.eigenvalues[i].total_cmp(&eigen.eigenvalues[j]));
        // Points on one line scatter in one direction only.
        (eigen.eigenvalues[order[1]] > 1e-12 * eigen.eigenvalues[order[2]])
            .then(|| facing(&mean, eigen.eigenvectors.column(order[0]).into_owned(), camera))?
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::cloud::CloudPoint;
    use rand::{Rng, SeedableRng};
    use rand_distr::{Distribution, Normal};

    pub(in crate::evaluate) fn cloud(positions: impl IntoIterator<Item = Point3<f64>>) -> PointCloud {
        let point = |position| CloudPoint {
            position,
            pixel: nalgebra::Point2::origin(),
            color: [0; 3],
            sigma_mm: 0.0,
            noise_mm: 0.0,
            slit: None,
            confidence: 1.0,
        };
        PointCloud { points: positions.into_iter().map(point).collect(), ..PointCloud::default() }
    }

    #[test]
    fn finds_a_noisy_plane_before_a_wall_and_reports_its_noise() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let truth =
            Plane::from_point_normal(&Point3::new(0.0, 0.0, 1000.0), Vector3::new(0.3, -0.2, -1.0)).unwrap();
        for sigma in [0.0, 0.4, 20.0] {
            let noise = Normal::new(0.0, sigma).unwrap();
            let mut points = Vec::new();
            for i in 0..4000 {
                let (x, y) = (rng.random_range(-300.0..300.0), rng.random_range(-200.0..200.0));
                let z = -(truth.offset_mm + truth.normal.x * x + truth.normal.y * y) / truth.normal.z;
                let p = Point3::new(x, y, z) + truth.normal.into_inner() * noise.sample(&mut rng);
                points.push(if i % 10 < 7 {
                    p
                } else {
                    Point3::new(x * 2.0, y, 1600.0 + noise.sample(&mut rng))
                });
            }
            points.push(Point3::new(f64::NAN, 0.0, 0.0));
            let fitted = fit_plane(&cloud(points), &FitConfig::default()).unwrap();
            let (r, n) = (fitted.report, fitted.plane.normal);
            // 2800 points that spread by 115 mm (1σ) along the shorter side; four times the σ of the tilt.
            let tilt_sigma = sigma / 2800.0_f64.sqrt() / 115.0;
            assert!(
                n.angle(&truth.normal) < 1e-7 + 4.0 * tilt_sigma,
                "σ = {sigma}: {}",
                n.angle(&truth.normal)
            );
            assert_eq!(r.points, 4000);
            assert!((r.outlier_share - 0.3).abs() < 0.01, "σ = {sigma}: {r:?}");
            // The mean of |x| of a normal variable is 0.798 σ, its deviation 0.603 σ.
            assert!((r.mean_mm - 0.798 * sigma).abs() < 0.05 * sigma + 1e-9, "{r:?}");
            assert!((r.std_mm - 0.603 * sigma).abs() < 0.05 * sigma + 1e-6, "{r:?}");
            assert!((r.mean_percent - 100.0 * r.mean_mm / r.camera_distance_mm).abs() < 1e-12);
        }
    }

    #[test]
    fn too_few_points_and_a_line_are_refused() {
        let line = (0..50).map(|i| Point3::new(f64::from(i), 2.0, 100.0));
        assert!(fit_plane(&cloud(line), &FitConfig::default()).is_err());
        assert!(fit_plane(&cloud([Point3::origin(); 2]), &FitConfig::default()).is_err());
        assert!(fit_plane(&cloud([Point3::new(1.0, 1.0, 1.0); 9]), &FitConfig::default()).is_err());
        let bad = FitConfig { consensus_percent: f64::NAN, ..FitConfig::default() };
        assert!(fit_plane(&cloud([]), &bad).is_err());
    }
}
