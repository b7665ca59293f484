//! Planes in space.

use nalgebra::{Point3, Unit, Vector3};

/// The points X with normal · X + offset = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Unit normal.
    pub normal: Unit<Vector3<f64>>,
    /// Signed distance of the origin, mm.
    pub offset_mm: f64,
}

impl Plane {
    /// The plane through `point` with the given normal; `None` when the normal vanishes.
    #[must_use]
    pub fn from_point_normal(point: &Point3<f64>, normal: Vector3<f64>) -> Option<Self> {
        let normal = Unit::try_new(normal, f64::MIN_POSITIVE)?;
        Some(Self { normal, offset_mm: -normal.dot(&point.coords) })
    }

    /// Signed distance of a point, mm.
    #[must_use]
    pub fn signed_distance_mm(&self, p: &Point3<f64>) -> f64 {
        self.normal.dot(&p.coords) + self.offset_mm
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ray;

    #[test]
    fn a_ray_meets_the_plane_in_front_only() {
        let plane =
            Plane::from_point_normal(&Point3::new(0.0, 0.0, 5.0), Vector3::new(0.0, 0.0, 2.0)).unwrap();
        let ray = Ray { origin: Point3::origin(), direction: Vector3::new(1.0, 0.0, 2.0) };
        assert_eq!(ray.meet(&plane), Some(Point3::new(2.5, 0.0, 5.0)));
        assert!(Ray { direction: -ray.direction, ..ray }.meet(&plane).is_none());
        assert!(Ray { direction: Vector3::x(), ..ray }.meet(&plane).is_none());
    }
}
