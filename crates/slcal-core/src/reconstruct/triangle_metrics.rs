//! Measures of a triangle of a cloud: its size in space and in the image, and its slant.

use crate::cloud::{CloudPoint, PointCloud};

/// Measures of a triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct TriangleMetrics {
    /// Area in space over the area in the image, normalised by the distance: one over the cosine of the slant, up to a
    /// factor that is the same for all.
    pub(super) slant: f64,
    /// Longest side in the image, px.
    pub(super) longest_px: f64,
    /// Centroid in the image, px.
    pub(super) middle: nalgebra::Point2<f64>,
}

impl TriangleMetrics {
    /// Measures a triangle of a cloud.
    pub(super) fn of(cloud: &PointCloud, t: &[u32; 3]) -> Self {
        let [a, b, c] = corners(&cloud.points, t).map(|p| p.pixel);
        let distance2 = |p: &CloudPoint| (p.position - cloud.camera_centre).norm_squared();
        let near2 = corners(&cloud.points, t).map(distance2).into_iter().fold(f64::INFINITY, f64::min);
        let longest2 = (b - a).norm_squared().max((c - b).norm_squared()).max((a - c).norm_squared());
        Self {
            slant: 2.0 * area_mm2(&cloud.points, t) / (doubled_area_px(&cloud.points, t) * near2),
            longest_px: longest2.sqrt(),
            middle: nalgebra::Point2::from((a.coords + b.coords + c.coords) / 3.0),
        }
    }
}

/// The corners of a triangle.
pub(super) fn corners<'a>(points: &'a [CloudPoint], t: &[u32; 3]) -> [&'a CloudPoint; 3] {
    t.map(|i| &points[i as usize])
}

/// Area in space, mm².
pub(super) fn area_mm2(points: &[CloudPoint], t: &[u32; 3]) -> f64 {
    let [a, b, c] = corners(points, t).map(|p| p.position);
    0.5 * (b - a).cross(&(c - a)).norm()
}

/// Twice the area in the image, px².
pub(super) fn doubled_area_px(points: &[CloudPoint], t: &[u32; 3]) -> f64 {
    let [a, b, c] = corners(points, t).map(|p| p.pixel);
    ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)).abs()
}
