//! Connected components of the mesh, and which of them are surfaces.

use super::triangle_metrics::doubled_area_px;
use crate::cloud::PointCloud;

/// Least area of a component in the image, in squares of the usual side of a triangle (the distance between two
/// stripes): three stripes over about one and a half of their distances. Smaller components are chance matches.
const LEAST_AREA: f64 = 3.0;

/// Below this area a strip two stripes wide is no surface. Runs of wrong stripes are about as long as the distance
/// between stripes, or a few times that. A longer track has been confirmed by all of its scanlines.
const LEAST_AREA_OF_STRIP: f64 = 12.0;

/// Finds connected components; keeps its buffers.
#[derive(Debug, Clone, Default)]
pub(super) struct Components {
    parent: Vec<u32>,
    /// Triangles about each point that have been removed.
    missing: Vec<u32>,
    area: Vec<f64>,
    /// Whether some point of the component has triangles all round.
    wide: Vec<bool>,
    number: Vec<u32>,
}

impl Components {
    /// Counts all triangles. `hull` are the points on the outer border, which have a side without triangles.
    pub(super) fn before(&mut self, points: usize, triangles: &[[u32; 3]], hull: impl Iterator<Item = u32>) {
        self.missing.clear();
        self.missing.resize(points, 0);
        for i in hull {
            self.missing[i as usize] += 1;
        }
        for v in triangles.iter().flatten() {
            self.missing[*v as usize] += 1;
        }
    }

    /// Keeps the points of triangles in components that are surfaces, renumbers them, and returns the number of removed
    /// points. `usual_px` is the usual side of a triangle in the image; where it is zero, every triangle is a surface.
    ///
    /// A strip two stripes wide has no point with triangles all round. Two wrong stripes beside each other agree by
    /// chance, or because one mistake displaced both. A third stripe confirms them, or the length of the strip.
    pub(super) fn keep_surfaces(&mut self, cloud: &mut PointCloud, usual_px: f64) -> usize {
        let n = cloud.points.len();
        self.join(n, &cloud.triangles);
        self.area.clear();
        self.area.resize(n, 0.0);
        self.wide.clear();
        self.wide.resize(n, false);
        for t in &cloud.triangles {
            let root = self.parent[t[0] as usize] as usize;
            self.area[root] += 0.5 * doubled_area_px(&cloud.points, t);
            for v in t {
                self.missing[*v as usize] -= 1;
                self.wide[root] |= self.missing[*v as usize] == 0;
            }
        }
        let square = usual_px * usual_px;
        let (least, least_of_strip) = (LEAST_AREA * square, LEAST_AREA_OF_STRIP * square);
        self.number.clear();
        let mut next = 0_u32;
        for i in 0..n {
            let root = self.parent[i] as usize;
            let stays = self.area[root] > 0.0
                && (usual_px == 0.0
                    || self.area[root] >= if self.wide[root] { least } else { least_of_strip });
            self.number.push(if stays { next } else { u32::MAX });
            next += u32::from(stays);
        }
        let mut numbers = self.number.iter();
        cloud.points.retain(|_| numbers.next().is_some_and(|k| *k != u32::MAX));
        cloud.triangles.retain_mut(|t| {
            *t = t.map(|v| self.number[v as usize]);
            !t.contains(&u32::MAX)
        });
        n - cloud.points.len()
    }

    /// Makes `parent` of every point the representative of its component.
    fn join(&mut self, points: usize, triangles: &[[u32; 3]]) {
        self.parent.clear();
        self.parent.extend(0..points as u32);
        for t in triangles {
            let a = root(&mut self.parent, t[0]);
            for &v in &t[1..] {
                let b = root(&mut self.parent, v);
                self.parent[b as usize] = a;
            }
        }
        for i in 0..points as u32 {
            self.parent[i as usize] = root(&mut self.parent, i);
        }
    }
}

/// The representative of a component; halves the path on the way.
fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        let up = parent[parent[i as usize] as usize];
        parent[i as usize] = up;
        i = up;
    }
    i
}
