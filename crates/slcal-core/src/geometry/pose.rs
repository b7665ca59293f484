//! Rigid transforms.

use nalgebra::{Isometry3, Matrix3, Point2, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};

use crate::error::{Error, Result};

/// A rigid transform `a_from_b`: X_a = R · X_b + t, lengths in mm.
///
/// # Examples
/// ```
/// use slcal_core::Pose;
/// use slcal_core::nalgebra::{Point3, Rotation3, Vector3};
///
/// // The sheet is a metre in front of the camera, rotated by 30° about its vertical axis.
/// let rotation = Rotation3::from_axis_angle(&Vector3::y_axis(), 30_f64.to_radians());
/// let camera_from_sheet = Pose { rotation, translation: Vector3::new(0.0, 0.0, 1000.0) };
/// let corner = camera_from_sheet.transform(&Point3::new(100.0, 0.0, 0.0));
/// assert!((corner.z - 950.0).abs() < 1e-9);
/// // The camera in the sheet's frame.
/// assert_eq!(camera_from_sheet.centre(), camera_from_sheet.inverse().transform(&Point3::origin()));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Rotation R.
    pub rotation: Rotation3<f64>,
    /// Translation t, mm.
    pub translation: Vector3<f64>,
}

/// Largest deviation of RᵀR from the identity for a rotation read from a file. Files written with four digits stay below
/// it.
const ROTATION_TOLERANCE: f64 = 1e-3;

impl Pose {
    /// The identity.
    #[must_use]
    pub fn identity() -> Self {
        Self { rotation: Rotation3::identity(), translation: Vector3::zeros() }
    }

    /// From a matrix that should be a rotation (as read from a file) and a translation; the matrix is replaced by the
    /// nearest rotation.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the matrix is not a rotation to within 1e-3, or not finite.
    pub fn from_matrix(r: &Matrix3<f64>, t: Vector3<f64>) -> Result<Self> {
        let deviation = (r.transpose() * r - Matrix3::identity()).abs().max();
        let proper = r.determinant() > 0.0;
        if !(deviation <= ROTATION_TOLERANCE && proper && t.iter().all(|x| x.is_finite())) {
            return Err(Error::invalid(
                "rotation matrix R and translation t",
                "an orthonormal 3x3 matrix of determinant +1 and three finite lengths",
                format!(
                    "|RᵀR − 1| = {deviation:.1e}, det R = {:.3}, t = {:?}",
                    r.determinant(),
                    t.as_slice()
                ),
            ));
        }
        let rotation = nearest_rotation(r)
            .ok_or_else(|| Error::invalid("rotation matrix R", "a matrix that the SVD converges for", r))?;
        Ok(Self { rotation, translation: t })
    }

    /// X_a from X_b.
    #[must_use]
    pub fn transform(&self, p: &Point3<f64>) -> Point3<f64> {
        self.rotation * p + self.translation
    }

    /// The point (x, y, 0) of b, in a: `a_from_b.lift(p)`.
    #[must_use]
    pub fn lift(&self, p: Point2<f64>) -> Point3<f64> {
        self.transform(&Point3::new(p.x, p.y, 0.0))
    }

    /// `b_from_a`.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// The rotation vector ω about a's axes with R = exp(ω) · R_other, rad. Computed from the quaternion: the trace alone
    /// gives small angles to 1e-8 only, or NaN where rounding makes its cosine larger than one.
    #[must_use]
    pub fn rotation_vector_from(&self, other: &Self) -> Vector3<f64> {
        UnitQuaternion::from_rotation_matrix(&(self.rotation * other.rotation.inverse())).scaled_axis()
    }

    /// `a_from_c` from `a_from_b` (self) and `b_from_c`.
    #[must_use]
    pub fn compose(&self, b_from_c: &Self) -> Self {
        Self {
            rotation: self.rotation * b_from_c.rotation,
            translation: self.rotation * b_from_c.translation + self.translation,
        }
    }

    /// The position of b's origin in a's frame is `translation`; this is the position of a's origin in b's frame.
    #[must_use]
    pub fn centre(&self) -> Point3<f64> {
        Point3::from(-(self.rotation.inverse() * self.translation))
    }

    /// As nalgebra's isometry.
    #[must_use]
    pub fn to_isometry(&self) -> Isometry3<f64> {
        Isometry3::from_parts(
            Translation3::from(self.translation),
            UnitQuaternion::from_rotation_matrix(&self.rotation),
        )
    }
}

/// The rotation nearest to `m` in the Frobenius norm (by SVD); `None` when the SVD does not converge.
#[must_use]
pub(crate) fn nearest_rotation(m: &Matrix3<f64>) -> Option<Rotation3<f64>> {
    let svd = m.try_svd(true, true, f64::EPSILON, 100)?;
    let (u, v_t) = (svd.u?, svd.v_t?);
    let sign = (u * v_t).determinant().signum();
    let r = u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v_t;
    r.iter().all(|x| x.is_finite()).then(|| Rotation3::from_matrix_unchecked(r))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_and_compose_cancel() {
        let a = Pose {
            rotation: Rotation3::from_euler_angles(0.1, -0.2, 0.3),
            translation: Vector3::new(1.0, 2.0, 3.0),
        };
        let e = a.compose(&a.inverse());
        assert!((e.rotation.matrix() - Matrix3::identity()).norm() < 1e-14);
        assert!(e.translation.norm() < 1e-14);
        assert!(a.transform(&a.centre()).coords.norm() < 1e-14);
    }

    #[test]
    fn a_reflection_and_a_scaled_matrix_are_refused() {
        let t = Vector3::zeros();
        assert!(Pose::from_matrix(&-Matrix3::identity(), t).is_err());
        assert!(Pose::from_matrix(&(Matrix3::identity() * 1.01), t).is_err());
        assert!(Pose::from_matrix(&Matrix3::identity(), Vector3::new(f64::NAN, 0.0, 0.0)).is_err());
        assert!(Pose::from_matrix(&(Matrix3::identity() * 1.000_01), t).is_ok());
    }

    #[test]
    fn a_small_rotation_is_found_to_full_precision() {
        for turn in [Vector3::new(1e-12, -2e-12, 3e-12), Vector3::new(0.3, -2.0, 0.4), Vector3::zeros()] {
            // A rotation with the rounding of many products.
            let mut base = Pose::identity();
            for _ in 0..100 {
                base.rotation = Rotation3::from_euler_angles(0.3, -0.2, 0.1) * base.rotation;
            }
            let turned = Pose { rotation: Rotation3::new(turn) * base.rotation, ..base };
            let found = turned.rotation_vector_from(&base);
            assert!((found - turn).norm() < 1e-13, "{found} {turn}");
        }
    }
}
