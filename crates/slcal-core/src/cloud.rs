//! Points in space: the result of `reconstruct`.

use nalgebra::{Point2, Point3, Vector3};
use serde::{Deserialize, Serialize};

use crate::named::named;

/// The coordinate frame of a cloud.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Frame {
    /// x right, y down, z forward from the camera's centre.
    #[default]
    Camera,
    /// The sheet of the rig's first view.
    Plane,
}

named!(Frame, "frame", { Camera => "camera", Plane => "plane" });

/// A reconstructed point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CloudPoint {
    /// Position, mm.
    pub position: Point3<f64>,
    /// The camera pixel in which it was seen.
    pub pixel: Point2<f64>,
    /// sRGB.
    pub color: [u8; 3],
    /// 1σ along the camera's ray, mm: of the match and of the rig together.
    pub sigma_mm: f64,
    /// The part of `sigma_mm` that is independent from point to point, mm: the noise of the match. The rest is common to the
    /// whole cloud.
    pub noise_mm: f64,
    /// Index of the slit; `None` when the match did not come from stripes.
    pub slit: Option<u16>,
    /// Between 0 and 1.
    pub confidence: f64,
}

impl CloudPoint {
    /// A point of which only the position is known.
    #[must_use]
    pub fn at(position: Point3<f64>) -> Self {
        Self {
            position,
            pixel: Point2::new(f64::NAN, f64::NAN),
            color: [0; 3],
            sigma_mm: 0.0,
            noise_mm: 0.0,
            slit: None,
            confidence: 1.0,
        }
    }
}

/// Points, and the triangles between them if a mesh was requested.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PointCloud {
    /// The points.
    pub points: Vec<CloudPoint>,
    /// Indices into `points`, counter-clockwise as the camera sees them.
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals of the points, towards the camera; empty where they are not known, zero for a point without neighbours.
    pub normals: Vec<Vector3<f32>>,
    /// The coordinate frame.
    pub frame: Frame,
    /// The camera's centre in these coordinates, mm.
    pub camera_centre: Point3<f64>,
}

impl PointCloud {
    /// A normal for each point; `None` where they are not known.
    #[must_use]
    pub fn known_normals(&self) -> Option<&[Vector3<f32>]> {
        (!self.points.is_empty() && self.normals.len() == self.points.len()).then_some(&self.normals)
    }

    /// The points' distances from the camera, mm.
    pub fn distances_mm(&self) -> impl Iterator<Item = f64> {
        self.points.iter().map(|p| (p.position - self.camera_centre).norm())
    }
}
