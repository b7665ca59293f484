//! Map between pictures for a device with lens distortion.

use nalgebra::{Matrix2, Point2};
use serde::{Deserialize, Serialize};

use super::{Camera, Homography};

/// A homography to the undistorted pixels of a device, followed by its lens distortion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Warp {
    /// To the pixels of a device without distortion.
    pub homography: Homography,
    /// The device; `None` without distortion.
    pub lens: Option<Camera>,
}

impl From<Homography> for Warp {
    fn from(homography: Homography) -> Self {
        Self { homography, lens: None }
    }
}

impl Warp {
    /// The homography to the undistorted pixels of `device`, followed by its lens distortion.
    #[must_use]
    pub fn onto(device: &Camera, homography: Homography) -> Self {
        Self { homography, lens: (!device.distortion.is_none()).then_some(*device) }
    }

    /// The image of a point; `None` at infinity.
    #[must_use]
    pub fn map(&self, p: Point2<f64>) -> Option<Point2<f64>> {
        let ideal = self.homography.map(p)?;
        let Some(lens) = &self.lens else { return Some(ideal) };
        let k = &lens.intrinsics;
        let seen = k.pixel(lens.distortion.distort(k.normalized(ideal)));
        (seen.x.is_finite() && seen.y.is_finite()).then_some(seen)
    }

    /// The undistorted pixel of a pixel of the device, and the Jacobian; `None` where the distortion has no inverse.
    #[must_use]
    pub fn ideal(&self, p: Point2<f64>) -> Option<(Point2<f64>, Matrix2<f64>)> {
        let Some(lens) = &self.lens else { return Some((p, Matrix2::identity())) };
        let x = lens.undistort(p)?;
        let k = &lens.intrinsics;
        let k2 = Matrix2::new(k.fx, k.skew, 0.0, k.fy);
        let slope = k2 * lens.distortion.jacobian(x).try_inverse()? * k2.try_inverse()?;
        Some((k.pixel(x), slope))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Distortion, Intrinsics};
    use nalgebra::{Matrix3, Vector2};

    #[test]
    fn ideal_inverts_the_distortion_and_its_jacobian_is_that_of_finite_differences() {
        let lens = Camera {
            width: 1024,
            height: 768,
            intrinsics: Intrinsics { fx: 1700.0, fy: 1690.0, skew: 2.0, cx: 511.5, cy: 700.0 },
            distortion: Distortion { k1: -0.1, k2: 0.03, p1: 1e-3, p2: -2e-3, k3: 0.0 },
        };
        let h = Homography(Matrix3::new(1.1, 0.1, 20.0, -0.05, 0.9, 30.0, 1e-5, 2e-5, 1.0));
        let warp = Warp::onto(&lens, h);
        for p in [Point2::new(10.0, 20.0), Point2::new(600.0, 300.0)] {
            let seen = warp.map(p).unwrap();
            let (ideal, slope) = warp.ideal(seen).unwrap();
            assert!((ideal - h.map(p).unwrap()).norm() < 1e-9 && (seen - ideal).norm() > 1.0);
            for d in [Vector2::x(), Vector2::y()] {
                let numeric = (warp.ideal(seen + d).unwrap().0 - warp.ideal(seen - d).unwrap().0) / 2.0;
                assert!((numeric - slope * d).norm() < 1e-5);
            }
        }
        let straight = Camera { distortion: Distortion::NONE, ..lens };
        assert_eq!(Warp::onto(&straight, h), Warp::from(h));
    }
}
