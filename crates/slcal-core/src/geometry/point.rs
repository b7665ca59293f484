//! Points of the projective plane: pixels and vanishing points in one type.

use nalgebra::{Point2, Vector3};
use serde::{Deserialize, Serialize};

/// A homogeneous point (x, y, w) of an image; w = 0 is a direction, that is, a point at infinity.
///
/// Two points are the same when their vectors are proportional; scale and sign carry no meaning.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ProjectivePoint(pub Vector3<f64>);

impl ProjectivePoint {
    /// The finite point at pixel `p`.
    #[must_use]
    pub fn from_pixel(p: Point2<f64>) -> Self {
        Self(Vector3::new(p.x, p.y, 1.0))
    }

    /// The pixel coordinates, or `None` when the point lies at infinity (to within rounding).
    #[must_use]
    pub fn pixel(&self) -> Option<Point2<f64>> {
        let p = Point2::new(self.0.x / self.0.z, self.0.y / self.0.z);
        (p.x.is_finite() && p.y.is_finite() && self.0.z.abs() > f64::EPSILON * self.0.xy().norm())
            .then_some(p)
    }

    /// The same point in coordinates whose origin is the pixel `origin`.
    #[must_use]
    pub fn relative_to(&self, origin: Point2<f64>) -> Self {
        Self(Vector3::new(self.0.x - origin.x * self.0.z, self.0.y - origin.y * self.0.z, self.0.z))
    }
}

/// The images of the sheet's two directions in one device (paper, section 2.1: `V_x`, `V_y`).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct VanishingPoints {
    /// Image of the direction of the sheet's width.
    pub x: ProjectivePoint,
    /// Image of the direction of the sheet's height.
    pub y: ProjectivePoint,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_at_infinity_has_no_pixel() {
        let v = ProjectivePoint(Vector3::new(3.0, 4.0, 0.0));
        assert!(v.pixel().is_none());
    }

    #[test]
    fn moving_the_origin_moves_the_pixel() {
        let p = ProjectivePoint(Vector3::new(10.0, 20.0, 2.0)).relative_to(Point2::new(1.0, 1.0));
        assert_eq!(p.pixel(), Some(Point2::new(4.0, 9.0)));
    }
}
