//! The sheet in space: its pose and how it bends.

use nalgebra::{Point2, Point3, Vector3};

use crate::geometry::{Pose, RectangleSize, SheetBend, Terms};

/// A ray meets the surface to this part of the sheet's diagonal.
const MEETS: f64 = 1e-12;
/// Most steps along a ray: the surface is almost flat, each one gains two digits or more.
const MAX_STEPS: usize = 12;

/// A sheet in one view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sheet {
    /// X_camera = R · X_sheet + t, of the sheet's mean plane.
    pub(crate) pose: Pose,
    pub(crate) size: RectangleSize,
    pub(crate) bend: SheetBend,
}

/// Where a ray meets the sheet.
pub(crate) struct Hit {
    pub(crate) point: Point3<f64>,
    /// In units of the ray's direction.
    pub(crate) along: f64,
    /// Not of unit length: its z in the sheet's frame is one.
    pub(crate) normal: Vector3<f64>,
    /// By how much the surface rises there with each coefficient of the bend.
    pub(crate) terms: Terms,
}

impl Sheet {
    /// A flat one.
    pub(crate) fn flat(pose: Pose, size: RectangleSize) -> Self {
        Self { pose, size, bend: SheetBend::FLAT }
    }

    /// A point over the sheet's plane (mm) on its surface, in the camera frame.
    pub(crate) fn lift(&self, at: Point2<f64>) -> Point3<f64> {
        let (z, _) = self.bend.height(self.size, at);
        self.pose.transform(&Point3::new(at.x, at.y, z))
    }

    /// A corner of the sheet, or any point that is fixed to it (mm), in the camera frame.
    pub(crate) fn lift_fixed(&self, at: Point2<f64>) -> Point3<f64> {
        self.pose.transform(&self.bend.point(self.size, at))
    }

    /// Where a ray meets the surface, continued beyond the sheet's border; `None` when it misses it.
    pub(crate) fn meet(&self, origin: Point3<f64>, direction: Vector3<f64>) -> Option<Hit> {
        let back = self.pose.rotation.inverse();
        let from = back * (origin.coords - self.pose.translation);
        let ray = back * direction;
        let mut along = -from.z / ray.z;
        let enough = MEETS * self.size.width_mm.hypot(self.size.height_mm);
        for _ in 0..MAX_STEPS {
            let at = from + ray * along;
            let over = Point2::new(at.x, at.y);
            let (z, slope) = self.bend.height(self.size, over);
            let normal = Vector3::new(-slope.x, -slope.y, 1.0);
            let off = at.z - z;
            if off.abs() <= enough {
                return (along > 0.0 && along.is_finite()).then(|| Hit {
                    point: origin + direction * along,
                    along,
                    normal: self.pose.rotation * normal,
                    terms: SheetBend::by_terms(self.size, over),
                });
            }
            along -= off / normal.dot(&ray);
        }
        None
    }
}
