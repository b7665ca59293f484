//! The sphere that most points of a cloud lie on.

use nalgebra::{Matrix3, Matrix4, Point3, Vector3, Vector4};

use super::ransac::{FitModel, fit};
use super::report::{FitConfig, FitReport, finite_points, report};
use crate::cloud::PointCloud;
use crate::error::{Error, ErrorSubject, Result};

/// A sphere and how well it fits.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SphereFit {
    /// Its centre, in the cloud's frame, mm.
    pub centre: Point3<f64>,
    /// Its radius, mm.
    pub radius_mm: f64,
    /// Statistics over the inliers.
    pub report: FitReport,
}

/// Fits the sphere that most points lie on, among those that the camera sees from outside and whose radius is at most
/// half of their distance. (A wall is also a sphere, of any sufficiently large radius.)
///
/// # Errors
/// [`Error::Invalid`] for fewer than four finite points or a configuration out of range; [`Error::NotFound`] when no
/// such sphere has points on it.
pub fn fit_sphere(cloud: &PointCloud, config: &FitConfig) -> Result<SphereFit> {
    config.validate()?;
    let points = finite_points(cloud, "sphere", 4)?;
    let camera = cloud.camera_centre;
    let (sphere, limit) = fit::<Sphere>(&points, &camera, config).ok_or_else(|| Error::NotFound {
        what: ErrorSubject::Sphere,
        seen: format!("{} points, and no four of them define a sphere that fits others", points.len()),
        advice: "evaluate a cloud that holds a sphere in front of the camera".into(),
    })?;
    let report = report(&points, &camera, limit, |p| sphere.distance(p, &camera));
    Ok(SphereFit { centre: sphere.centre, radius_mm: sphere.radius, report })
}

#[derive(Clone, Copy)]
struct Sphere {
    centre: Point3<f64>,
    radius: f64,
}

/// Largest radius over the distance of the centre from the camera.
const MAX_RADIUS_SHARE: f64 = 0.5;
/// Gauss–Newton steps; the start is close and convergence quadratic.
const STEPS: usize = 20;

impl Sphere {
    fn sensible(self, camera: &Point3<f64>) -> Option<Self> {
        let far = (self.centre - camera).norm();
        (far.is_finite() && self.radius > 0.0 && self.radius <= MAX_RADIUS_SHARE * far).then_some(self)
    }
}

impl FitModel for Sphere {
    const SAMPLE: usize = 4;

    fn through(sample: &[Point3<f64>], camera: &Point3<f64>) -> Option<Self> {
        let &[a, b, c, d] = sample else { return None };
        let rows = [b - a, c - a, d - a];
        let m = Matrix3::from_rows(&rows.map(|r| r.transpose()));
        let right = Vector3::from_iterator(rows.iter().map(|r| 0.5 * r.norm_squared()));
        let offset = m.lu().solve(&right)?;
        Self { centre: a + offset, radius: offset.norm() }.sensible(camera)
    }

    fn distance(&self, p: &Point3<f64>, camera: &Point3<f64>) -> f64 {
        let out = p - self.centre;
        // The far side of a sphere cannot be seen.
        if out.dot(&(camera - p)) < 0.0 { f64::INFINITY } else { (out.norm() - self.radius).abs() }
    }

    /// Gauss–Newton on the distances.
    fn refined(&self, points: &[Point3<f64>], camera: &Point3<f64>) -> Option<Self> {
        let mut s = *self;
        for _ in 0..STEPS {
            let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
            for p in points {
                let out = p - s.centre;
                let r = out.norm();
                if r <= 0.0 {
                    continue;
                }
                let row = Vector4::new(-out.x / r, -out.y / r, -out.z / r, -1.0);
                normal += row * row.transpose();
                right -= row * (r - s.radius);
            }
            let step = normal.cholesky()?.solve(&right);
            s.centre += step.xyz();
            s.radius += step.w;
            if step.norm() <= 1e-12 * s.radius.abs() {
                break;
            }
        }
        s.sensible(camera)
    }
}

#[cfg(test)]
mod tests {
    use super::super::plane::tests::cloud;
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_distr::{Distribution, Normal, UnitSphere};

    #[test]
    fn finds_a_noisy_sphere_before_a_larger_wall() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(8);
        let (centre, radius, sigma) = (Point3::new(30.0, -20.0, 1100.0), 150.0, 0.3);
        let noise = Normal::new(0.0, sigma).unwrap();
        let mut points = Vec::new();
        while points.len() < 2000 {
            let d = Vector3::from(UnitSphere.sample(&mut rng));
            // The half that faces the camera.
            if d.z < -0.25 {
                points.push(centre + d * (radius + noise.sample(&mut rng)));
            }
        }
        for _ in 0..3000 {
            points.push(Point3::new(
                rng.random_range(-500.0..500.0),
                rng.random_range(-400.0..400.0),
                1500.0,
            ));
        }
        let fitted = fit_sphere(&cloud(points.clone()), &FitConfig::default()).unwrap();
        assert!((fitted.radius_mm - radius).abs() < 0.1, "{fitted:?}");
        assert!((fitted.centre - centre).norm() < 0.1, "{fitted:?}");
        assert!((fitted.report.outlier_share - 0.6).abs() < 0.01);
        assert!((fitted.report.rms_mm / sigma - 1.0).abs() < 0.05, "{fitted:?}");
        assert_eq!(fitted, fit_sphere(&cloud(points), &FitConfig::default()).unwrap());
    }

    #[test]
    fn a_flat_cloud_and_too_few_points_hold_no_sphere() {
        let wall = (0..400).map(|i| Point3::new(f64::from(i % 20) * 20.0, f64::from(i / 20) * 20.0, 1500.0));
        assert!(fit_sphere(&cloud(wall), &FitConfig::default()).is_err());
        assert!(fit_sphere(&cloud([Point3::origin(); 3]), &FitConfig::default()).is_err());
        assert!(fit_sphere(&cloud([Point3::new(0.0, 0.0, 1.0); 8]), &FitConfig::default()).is_err());
    }
}
