//! A cloud.

use nalgebra::{Point2, Point3};

use crate::cloud::{CloudPoint, PointCloud};

/// Four points and two triangles for the tests of the cloud formats.
pub(crate) fn test_cloud() -> PointCloud {
    let point = |i: u16| CloudPoint {
        position: Point3::new(f64::from(i), -0.5, 1000.25),
        pixel: Point2::new(f64::NAN, f64::NAN),
        color: [i as u8, 2, 255],
        sigma_mm: 0.125,
        noise_mm: 0.0625,
        slit: Some(60_000 + i),
        confidence: 0.75,
    };
    PointCloud {
        points: (0..4).map(point).collect(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..PointCloud::default()
    }
}
