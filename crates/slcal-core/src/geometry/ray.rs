//! Half-lines in space.

use nalgebra::{Point3, Vector3};

use super::Plane;

/// A half-line; `direction` need not be of unit length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts, mm.
    pub origin: Point3<f64>,
    /// Where it goes.
    pub direction: Vector3<f64>,
}

impl Ray {
    /// The point where the ray meets a plane, in front of its origin; `None` when it is parallel or behind.
    #[must_use]
    pub fn meet(&self, plane: &Plane) -> Option<Point3<f64>> {
        let along = plane.normal.dot(&self.direction);
        let s = -plane.signed_distance_mm(&self.origin) / along;
        (s.is_finite() && s > 0.0).then(|| self.origin + self.direction * s)
    }
}
