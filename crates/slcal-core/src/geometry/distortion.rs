//! Lens distortion: OpenCV's `plumb_bob` (Brown–Conrady) model.

use nalgebra::{Matrix2, SMatrix, Vector2};
use serde::{Deserialize, Serialize};

/// Radial (k1, k2, k3) and tangential (p1, p2) coefficients on normalized image coordinates (x/z, y/z).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Distortion {
    /// Radial, r².
    pub k1: f64,
    /// Radial, r⁴.
    pub k2: f64,
    /// Tangential.
    pub p1: f64,
    /// Tangential.
    pub p2: f64,
    /// Radial, r⁶.
    pub k3: f64,
}

/// Maximum number of Newton steps. Inside the model's range four or five suffice; with more the point has no preimage.
const MAX_NEWTON_STEPS: usize = 30;
/// Newton's convergence is quadratic: after a step of this size the error is rounding.
const LAST_NEWTON_STEP: f64 = 1e-9;

impl Distortion {
    /// No distortion.
    pub const NONE: Self = Self { k1: 0.0, k2: 0.0, p1: 0.0, p2: 0.0, k3: 0.0 };

    /// In the order of files: k1, k2, p1, p2, k3.
    #[must_use]
    pub fn to_array(self) -> [f64; 5] {
        [self.k1, self.k2, self.p1, self.p2, self.k3]
    }

    /// From the order of files: k1, k2, p1, p2, k3.
    #[must_use]
    pub fn from_array([k1, k2, p1, p2, k3]: [f64; 5]) -> Self {
        Self { k1, k2, p1, p2, k3 }
    }

    /// Whether all coefficients are zero.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.to_array().iter().all(|&k| k == 0.0)
    }

    /// The distorted position of an ideal normalized point.
    #[must_use]
    pub fn distort(&self, x: Vector2<f64>) -> Vector2<f64> {
        let r2 = x.norm_squared();
        let radial = 1.0 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3));
        let xy2 = 2.0 * x.x * x.y;
        Vector2::new(
            x.x * radial + self.p1 * xy2 + self.p2 * (r2 + 2.0 * x.x * x.x),
            x.y * radial + self.p1 * (r2 + 2.0 * x.y * x.y) + self.p2 * xy2,
        )
    }

    /// d(distorted)/d(ideal) at an ideal point.
    #[must_use]
    pub fn jacobian(&self, x: Vector2<f64>) -> Matrix2<f64> {
        let r2 = x.norm_squared();
        let radial = 1.0 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3));
        let slope = 2.0 * (self.k1 + r2 * (2.0 * self.k2 + 3.0 * r2 * self.k3));
        let cross = x.x * x.y * slope + 2.0 * self.p1 * x.x + 2.0 * self.p2 * x.y;
        Matrix2::new(
            radial + x.x * x.x * slope + 2.0 * self.p1 * x.y + 6.0 * self.p2 * x.x,
            cross,
            cross,
            radial + x.y * x.y * slope + 6.0 * self.p1 * x.y + 2.0 * self.p2 * x.x,
        )
    }

    /// d(distorted)/d(k1, k2, p1, p2, k3) at an ideal point; the model is linear in its coefficients.
    #[must_use]
    pub fn coefficient_jacobian(x: Vector2<f64>) -> SMatrix<f64, 2, 5> {
        let r2 = x.norm_squared();
        let xy2 = 2.0 * x.x * x.y;
        SMatrix::from_columns(&[
            x * r2,
            x * r2 * r2,
            Vector2::new(xy2, r2 + 2.0 * x.y * x.y),
            Vector2::new(r2 + 2.0 * x.x * x.x, xy2),
            x * r2 * r2 * r2,
        ])
    }

    /// The ideal position of a distorted normalized point, by Newton's method; `None` when there is none on the
    /// branch that contains the centre (the point lies beyond where the model folds over).
    #[must_use]
    pub fn undistort(&self, d: Vector2<f64>) -> Option<Vector2<f64>> {
        if self.is_none() {
            return Some(d);
        }
        self.undistort_with_jacobian(d).map(|(x, _)| x)
    }

    /// As [`Distortion::undistort`], with d(distorted)/d(ideal) there.
    #[must_use]
    pub fn undistort_with_jacobian(&self, d: Vector2<f64>) -> Option<(Vector2<f64>, Matrix2<f64>)> {
        let mut x = d;
        let mut jacobian = self.jacobian(x);
        for _ in 0..MAX_NEWTON_STEPS {
            let error = self.distort(x) - d;
            if jacobian.determinant() <= 0.0 {
                return None;
            }
            let step = jacobian.try_inverse()? * error;
            x -= step;
            jacobian = self.jacobian(x);
            if step.norm_squared() <= LAST_NEWTON_STEP * LAST_NEWTON_STEP * (1.0 + x.norm_squared()) {
                return (jacobian.determinant() > 0.0).then_some((x, jacobian));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const LENS: Distortion = Distortion { k1: -0.25, k2: 0.1, p1: 1e-3, p2: -2e-3, k3: 0.01 };

    #[test]
    fn undistort_inverts_distort() {
        for i in -4..=4 {
            for j in -4..=4 {
                let x = Vector2::new(f64::from(i), f64::from(j)) * 0.12;
                assert_relative_eq!(LENS.undistort(LENS.distort(x)).unwrap(), x, epsilon = 1e-13);
            }
        }
    }

    #[test]
    fn jacobian_agrees_with_finite_differences() {
        let (x, h) = (Vector2::new(0.3, -0.4), 1e-6);
        let numeric = Matrix2::from_columns(&[
            (LENS.distort(x + Vector2::x() * h) - LENS.distort(x - Vector2::x() * h)) / (2.0 * h),
            (LENS.distort(x + Vector2::y() * h) - LENS.distort(x - Vector2::y() * h)) / (2.0 * h),
        ]);
        assert_relative_eq!(LENS.jacobian(x), numeric, epsilon = 1e-9);
    }

    #[test]
    fn a_point_beyond_the_fold_has_no_preimage() {
        let barrel = Distortion { k1: -0.3, ..Distortion::NONE };
        assert!(barrel.undistort(Vector2::new(1.5, 0.0)).is_none());
        assert!(barrel.undistort(Vector2::new(f64::NAN, 0.0)).is_none());
    }
}
