//! Maps of the projective plane.

use nalgebra::{Matrix3, Point2, Vector3};
use serde::{Deserialize, Serialize};

use super::{Line, ProjectivePoint, VanishingPoints};

/// An invertible 3×3 map between planes, named `a_from_b`; its scale carries no meaning.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Homography(pub Matrix3<f64>);

impl Homography {
    /// The identity.
    #[must_use]
    pub fn identity() -> Self {
        Self(Matrix3::identity())
    }

    /// The image of a homogeneous point.
    #[must_use]
    pub fn apply(&self, p: ProjectivePoint) -> ProjectivePoint {
        ProjectivePoint(self.0 * p.0)
    }

    /// The image of a finite point; `None` when it goes to infinity.
    #[must_use]
    pub fn map(&self, p: Point2<f64>) -> Option<Point2<f64>> {
        self.apply(ProjectivePoint::from_pixel(p)).pixel()
    }

    /// The image of a line: l' = H⁻ᵀ l. `None` when the map is singular.
    #[must_use]
    pub fn map_line(&self, l: Line) -> Option<Line> {
        Some(Line(self.0.try_inverse()?.transpose() * l.0))
    }

    /// `b_from_a`; `None` when singular.
    #[must_use]
    pub fn inverse(&self) -> Option<Self> {
        // The scale is free: bring it to one before the test for singularity, so that it does not depend on units.
        let m = self.0 / self.0.norm();
        m.try_inverse().filter(|i| i.iter().all(|x| x.is_finite())).map(Self)
    }

    /// `a_from_c` from `a_from_b` (self) and `b_from_c`.
    #[must_use]
    pub fn compose(&self, b_from_c: &Self) -> Self {
        Self(self.0 * b_from_c.0)
    }

    /// Columns h1, h2, h3.
    #[must_use]
    pub fn columns(&self) -> [Vector3<f64>; 3] {
        std::array::from_fn(|i| self.0.column(i).into_owned())
    }

    /// The images of the plane's x and y directions: the first two columns (paper, section 2.1).
    #[must_use]
    pub fn vanishing_points(&self) -> VanishingPoints {
        let [h1, h2, _] = self.columns();
        VanishingPoints { x: ProjectivePoint(h1), y: ProjectivePoint(h2) }
    }

    /// The Jacobian d(image)/d(point) at a finite point with a finite image.
    #[must_use]
    pub fn jacobian(&self, p: Point2<f64>) -> nalgebra::Matrix2<f64> {
        let q = self.0 * Vector3::new(p.x, p.y, 1.0);
        let m = &self.0;
        let row = |i: usize, j: usize| (m[(i, j)] - q[i] / q.z * m[(2, j)]) / q.z;
        nalgebra::Matrix2::new(row(0, 0), row(0, 1), row(1, 0), row(1, 1))
    }
}
