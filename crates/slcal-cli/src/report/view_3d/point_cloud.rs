//! The cloud in the camera's frame, thinned where the page would become too large.

use std::collections::HashMap;
use std::fmt::Write as _;

use nalgebra::Point3;
use slcal_core::geometry::Pose;
use slcal_core::{CloudPoint, PointCloud, Rig};

use crate::cloud_view::packed;
use crate::picture::stripes::thousands;
use crate::quantile::Sorted;

/// More points than this are thinned: with their surface they make a page of about 6 MB, which can still be sent.
const MAX_SHOWN: usize = 200_000;
/// Coordinates are rounded to about this share of the depth, which no screen shows. A power of two leaves zeros, which pack well.
const KEPT: f64 = 1.0 / 65_536.0;

/// Points as they are shown.
pub(super) struct ShownPoints {
    cloud: PointCloud,
    total: usize,
    total_triangles: usize,
}

impl ShownPoints {
    /// The points that are shown: one per cell of the camera's image, so that every part of the surface keeps its share.
    pub(super) fn new(rig: &Rig, cloud: &PointCloud) -> Self {
        let camera_from_cloud = camera_from_cloud(rig, cloud.frame);
        let positions: Vec<Point3<f64>> =
            cloud.points.iter().map(|p| camera_from_cloud.transform(&p.position)).collect();
        let (kept, place) = few_enough(rig, &positions);
        let point = |&i: &usize| CloudPoint { position: positions[i], ..cloud.points[i] };
        let shown = PointCloud {
            points: kept.iter().map(point).collect(),
            triangles: thinned(&cloud.triangles, &place),
            ..PointCloud::default()
        };
        Self { cloud: shown, total: cloud.points.len(), total_triangles: cloud.triangles.len() }
    }

    /// Half of the points are nearer than this.
    pub(super) fn median_depth_mm(&self) -> Option<f64> {
        Sorted::new(self.cloud.points.iter().map(|p| p.position.z)).at(0.5)
    }

    /// As the view takes them.
    pub(super) fn packed(&self) -> Vec<u8> {
        let mut cloud = self.cloud.clone();
        let step = (KEPT * self.median_depth_mm().unwrap_or(1.0).abs().max(1.0)).log2().floor().exp2();
        for point in &mut cloud.points {
            point.position = point.position.map(|x| (x / step).round() * step);
            point.sigma_mm = f64::from(shortened(point.sigma_mm));
        }
        packed(&cloud)
    }

    /// The noise of each point, f32, mm; NaN where it is not known.
    pub(super) fn noise(&self) -> Vec<u8> {
        let known = |p: &CloudPoint| if p.noise_mm > 0.0 { shortened(p.noise_mm) } else { f32::NAN };
        self.cloud.points.iter().flat_map(|p| known(p).to_le_bytes()).collect()
    }

    /// How much of the cloud is shown.
    pub(super) fn note(&self, name: &str) -> String {
        let (points, triangles) = (self.cloud.points.len(), self.cloud.triangles.len());
        let mut note = if points < self.total {
            let (points, total) = (thousands(points), thousands(self.total));
            format!("{points} of the {total} points of {name} are shown, spread evenly over the image")
        } else {
            format!("All {} points of {name} are shown", thousands(self.total))
        };
        if self.total_triangles > triangles {
            let (shown, total) = (thousands(triangles), thousands(self.total_triangles));
            let _ = write!(note, "; the surface has {shown} of {total} triangles");
        }
        note + ". σ is the expected error along the line of sight, most of it common to all points; noise is the part that differs \
                from point to point."
    }
}

/// A number with three to four digits: the rest are zeros, which pack well.
fn shortened(x: f64) -> f32 {
    const DROPPED: u32 = 12;
    let bits = (x as f32).to_bits();
    f32::from_bits(bits >> DROPPED << DROPPED)
}

/// As many points as are shown, and which one stands for each point.
fn few_enough(rig: &Rig, positions: &[Point3<f64>]) -> (Vec<usize>, Vec<Option<u32>>) {
    let (mut kept, mut place) = every(positions);
    if kept.len() <= MAX_SHOWN {
        return (kept, place);
    }
    let model = &rig.camera.model;
    let seen = |p| model.project(p).map(|u| [u.x, u.y]).filter(|u| u.iter().all(|x| x.is_finite()));
    let pixels: Vec<Option<[f64; 2]>> = positions.iter().map(seen).collect();
    let area = f64::from(model.width) * f64::from(model.height);
    let mut cell = (area / positions.len() as f64).sqrt() * 0.25;
    while kept.len() > MAX_SHOWN {
        (kept, place) = one_per_cell(positions, &pixels, cell);
        cell *= 1.12;
    }
    (kept, place)
}

/// Where the cloud's points are in the camera's frame.
fn camera_from_cloud(rig: &Rig, frame: slcal_core::Frame) -> Pose {
    match (frame, rig.views.first()) {
        (slcal_core::Frame::Plane, Some(view)) => view.camera_from_sheet,
        _ => Pose::identity(),
    }
}

/// All points that are somewhere.
fn every(positions: &[Point3<f64>]) -> (Vec<usize>, Vec<Option<u32>>) {
    let (mut kept, mut place) = (Vec::new(), vec![None; positions.len()]);
    for (i, p) in positions.iter().enumerate() {
        if p.iter().all(|x| x.is_finite()) {
            place[i] = Some(kept.len() as u32);
            kept.push(i);
        }
    }
    (kept, place)
}

/// One point per cell of the image, and which one stands for each point. Points of one cell but of other depths stay apart,
/// so that outlines stay sharp.
fn one_per_cell(
    positions: &[Point3<f64>],
    pixels: &[Option<[f64; 2]>],
    cell: f64,
) -> (Vec<usize>, Vec<Option<u32>>) {
    /// Depths that differ by more than this share are of different surfaces.
    const DEPTH_STEP: f64 = 0.05;
    let (mut kept, mut place) = (Vec::new(), vec![None; positions.len()]);
    let mut of_cell: HashMap<[i64; 3], u32> = HashMap::new();
    for (i, pixel) in pixels.iter().enumerate() {
        let Some([u, v]) = pixel else { continue };
        let layer = (positions[i].z.ln() / DEPTH_STEP).floor() as i64;
        let key = [(u / cell).floor() as i64, (v / cell).floor() as i64, layer];
        let at = *of_cell.entry(key).or_insert_with(|| {
            kept.push(i);
            (kept.len() - 1) as u32
        });
        place[i] = Some(at);
    }
    (kept, place)
}

/// The triangles between the points that stand for their corners.
fn thinned(triangles: &[[u32; 3]], place: &[Option<u32>]) -> Vec<[u32; 3]> {
    let mut seen = std::collections::HashSet::new();
    let mut kept = Vec::new();
    for t in triangles {
        let corner = |k: usize| place.get(t[k] as usize).copied().flatten();
        let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else { continue };
        if a == b || b == c || c == a {
            continue;
        }
        let mut key = [a, b, c];
        key.sort_unstable();
        if seen.insert(key) {
            kept.push([a, b, c]);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_one_point_per_cell_and_depth() {
        let at = |x: f64, z: f64| Point3::new(x, 0.0, z);
        let positions = [at(0.0, 1000.0), at(1.0, 1001.0), at(0.5, 3000.0), at(90.0, 1000.0)];
        let pixels = [Some([0.1, 0.0]), Some([0.2, 0.0]), Some([0.15, 0.0]), Some([9.0, 0.0])];
        let (kept, place) = one_per_cell(&positions, &pixels, 1.0);
        assert_eq!(kept, [0, 2, 3]);
        assert_eq!(place, [Some(0), Some(0), Some(1), Some(2)]);
        // The first triangle has two corners in one cell; the last says the same as the second.
        assert_eq!(thinned(&[[0, 1, 3], [0, 2, 3], [1, 3, 2]], &place), [[0, 1, 2]]);
    }
}
