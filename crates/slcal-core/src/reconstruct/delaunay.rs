//! Delaunay triangulation of a cloud's points in the image, by `spade`.
//!
//! The cost of an incremental triangulation, in time and memory, is the number of edges that every point flips. Points
//! in the order of scanlines flip many: each takes over a fan of edges that spans the previous line. So a few points
//! come first, in random rounds (N. Amenta, S. Choi, G. Rote, "Incremental constructions con BRIO", 2003): one in 256,
//! and both ends of every run of a stripe, which have the most neighbours across the gaps. Then come, for example,
//! every 512th line and every 256th between them, and so on. A point then lies between two of its own stripe and flips
//! a handful of edges.

use spade::{DelaunayTriangulation, Point2, Triangulation as _};

use crate::cloud::CloudPoint;

/// Rounds in descending order: levels of lines, and above them the random ones.
const ROUNDS: usize = 32;
const LOTS: usize = 16;
/// One point in this many is in a random round.
const ONE_IN: u32 = 256;
const NEVER: u32 = u32::MAX;

/// A triangulation and its order of insertion; keeps its buffers.
#[derive(Debug, Clone, Default)]
pub(super) struct Delaunay {
    spade: DelaunayTriangulation<Point2<f64>>,
    /// The point of each vertex; of points at the same place the first.
    point_of: Vec<u32>,
    order: Vec<u32>,
    /// Index of the first point of each scanline, and the number of points.
    lines: Vec<u32>,
    rounds: Vec<u8>,
    /// The last point of every slit, and its scanline.
    last: Vec<[u32; 2]>,
}

impl Delaunay {
    /// Triangulates. Points that are not finite, or repeat another one, have no triangle.
    pub(super) fn triangulate(&mut self, points: &[CloudPoint]) {
        self.spade.clear();
        self.point_of.clear();
        self.put_in_order(points);
        let order = std::mem::take(&mut self.order);
        if self.begin(points, &order) {
            for i in &order {
                self.insert(points, *i);
            }
        }
        self.order = order;
    }

    /// Three points each, anticlockwise in mathematical axes (y up).
    pub(super) fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        self.spade.inner_faces().map(|f| f.vertices().map(|v| self.point_of[v.index()]))
    }

    /// The points of the convex hull.
    pub(super) fn hull(&self) -> impl Iterator<Item = u32> {
        // `spade` must not be asked for the hull of a cleared triangulation.
        let inner = (self.spade.num_inner_faces() > 0).then_some(&self.spade);
        inner.into_iter().flat_map(|n| n.convex_hull()).map(|e| self.point_of[e.from().index()])
    }

    /// Inserts three points that make a triangle; false where there are none. (As long as all points lie on one line,
    /// every insertion would sort them.)
    fn begin(&mut self, points: &[CloudPoint], order: &[u32]) -> bool {
        for i in order {
            if self.spade.num_vertices() == 2 {
                break;
            }
            self.insert(points, *i);
        }
        let Some(edge) = self.spade.directed_edges().next() else { return false };
        let beside =
            |i: &&u32| place(&points[**i as usize]).is_some_and(|p| !edge.side_query(p).is_on_line());
        let Some(third) = order.iter().find(beside) else {
            self.spade.clear();
            return false;
        };
        self.insert(points, *third);
        true
    }

    fn insert(&mut self, points: &[CloudPoint], i: u32) {
        // Coordinates beyond the range of `spade` are no pixels of an image.
        let Some(Ok(vertex)) = place(&points[i as usize]).map(|p| self.spade.insert(p)) else { return };
        match self.point_of.get_mut(vertex.index()) {
            Some(first) => *first = i.min(*first),
            None => self.point_of.push(i),
        }
    }

    /// Sorts the points by rounds; within a round, scanline by scanline in alternating direction.
    fn put_in_order(&mut self, points: &[CloudPoint]) {
        self.find_lines(points);
        self.choose_rounds(points);
        let mut starts = [0; ROUNDS];
        for round in &self.rounds {
            starts[usize::from(*round)] += 1;
        }
        let mut sum = 0;
        for start in starts.iter_mut().rev() {
            sum += *start;
            *start = sum - *start;
        }
        self.order.clear();
        self.order.resize(points.len(), 0);
        for (line, range) in self.lines.windows(2).enumerate() {
            let back = line >> (level(line) + 1) & 1 == 1;
            for k in range[0]..range[1] {
                let i = if back { range[0] + range[1] - 1 - k } else { k };
                let start = &mut starts[usize::from(self.rounds[i as usize])];
                self.order[*start] = i;
                *start += 1;
            }
        }
    }

    /// Consecutive points are on one scanline while a coordinate stays the same.
    fn find_lines(&mut self, points: &[CloudPoint]) {
        self.lines.clear();
        self.lines.push(0);
        for (i, pair) in points.windows(2).enumerate() {
            let same = |k: usize| pair[0].pixel[k].to_bits() == pair[1].pixel[k].to_bits();
            if !same(0) && !same(1) {
                self.lines.push(i as u32 + 1);
            }
        }
        self.lines.push(points.len() as u32);
    }

    fn choose_rounds(&mut self, points: &[CloudPoint]) {
        self.rounds.clear();
        self.last.clear();
        for (line, range) in self.lines.windows(2).enumerate() {
            for i in range[0]..range[1] {
                let slit = usize::from(points[i as usize].slit.unwrap_or(0));
                if slit >= self.last.len() {
                    self.last.resize(slit + 1, [NEVER; 2]);
                }
                let [last, last_line] = std::mem::replace(&mut self.last[slit], [i, line as u32]);
                let begins = last == NEVER || line as u32 > last_line + 1;
                if begins && last != NEVER {
                    self.rounds[last as usize] = lot(last);
                }
                let first = begins || scramble(i ^ NEVER).is_multiple_of(ONE_IN);
                self.rounds.push(if first { lot(i) } else { level(line) });
            }
        }
        for [last, _] in self.last.iter().filter(|l| l[0] != NEVER) {
            self.rounds[*last as usize] = lot(*last);
        }
    }
}

fn place(p: &CloudPoint) -> Option<Point2<f64>> {
    p.position.iter().all(|x| x.is_finite()).then(|| Point2::new(p.pixel.x, p.pixel.y))
}

/// The number of times that a line's index can be halved.
fn level(line: usize) -> u8 {
    line.trailing_zeros().min(LOTS as u32 - 1) as u8
}

/// A random round: each has a quarter of the points of the following one.
fn lot(i: u32) -> u8 {
    LOTS as u8 + (scramble(i).trailing_zeros() / 2).min(15) as u8
}

/// A hash of an index (the finaliser of `MurmurHash3`).
fn scramble(i: u32) -> u32 {
    let x = i.wrapping_add(1);
    let x = (x ^ x >> 16).wrapping_mul(0x85eb_ca6b);
    let x = (x ^ x >> 13).wrapping_mul(0xc2b2_ae35);
    x ^ x >> 16
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    fn cloud(at: &[[f64; 2]]) -> Vec<CloudPoint> {
        let point = |p: &[f64; 2]| CloudPoint {
            position: Point3::new(p[0], p[1], 1000.0),
            pixel: nalgebra::Point2::new(p[0], p[1]),
            color: [0; 3],
            sigma_mm: 0.1,
            noise_mm: 0.1,
            slit: Some((p[0] / 14.0) as u16),
            confidence: 1.0,
        };
        at.iter().map(point).collect()
    }

    fn stripes() -> Vec<[f64; 2]> {
        let all = (0..90).flat_map(|v| (0..40).map(move |s| (f64::from(v), f64::from(s))));
        // With a hole.
        let kept = all.filter(|(v, s)| !((30.0..60.0).contains(v) && (10.0..14.0).contains(s)));
        kept.map(|(v, s)| [14.0 * s + 3.0 * (0.3 * v + s).sin() + 5.0, v]).collect()
    }

    /// Every point is inserted once, for any order of scanlines; triangles fill the hull (Euler: 2n − 2 − h).
    #[test]
    fn every_point_is_a_vertex_once() {
        let at = stripes();
        let turned: Vec<[f64; 2]> = at.iter().map(|[x, y]| [*y, *x]).collect();
        let reversed: Vec<[f64; 2]> = at.iter().rev().copied().collect();
        let grid: Vec<[f64; 2]> = (0..400).map(|i| [f64::from(i % 20), f64::from(i / 20)]).collect();
        let mut delaunay = Delaunay::default();
        for at in [at, turned, reversed, grid] {
            delaunay.triangulate(&cloud(&at));
            let mut order = delaunay.order.clone();
            order.sort_unstable();
            assert!(order.iter().copied().eq(0..at.len() as u32));
            let mut seen = vec![false; at.len()];
            delaunay.triangles().flatten().for_each(|i| seen[i as usize] = true);
            assert!(seen.iter().all(|s| *s));
            assert_eq!(delaunay.triangles().count(), 2 * at.len() - 2 - delaunay.hull().count());
        }
    }

    #[test]
    fn reused_buffers_give_the_same_triangles() {
        let points = cloud(&stripes());
        let (mut fresh, mut used) = (Delaunay::default(), Delaunay::default());
        fresh.triangulate(&points);
        used.triangulate(&cloud(&[[0.0, 0.0], [90.0, 1.0], [1.0, 4.0], [7.0, 7.0]]));
        used.triangulate(&points);
        assert!(fresh.triangles().eq(used.triangles()));
        assert!(fresh.hull().eq(used.hull()));
    }

    #[test]
    fn of_coincident_points_the_first_is_kept_and_invalid_ones_are_left_out() {
        let mut delaunay = Delaunay::default();
        let corners =
            [[0.0, 0.0], [0.0, 0.0], [9.0, 0.0], [f64::NAN, 1.0], [0.0, 9.0], [9.0, 0.0], [1e300, 0.0]];
        delaunay.triangulate(&cloud(&corners));
        let mut found: Vec<u32> = delaunay.triangles().flatten().collect();
        found.sort_unstable();
        assert_eq!(found, [0, 2, 4]);
        assert_eq!(delaunay.hull().count(), 3);
    }

    #[test]
    fn points_on_one_line_make_no_triangle_and_cost_no_time() {
        let mut delaunay = Delaunay::default();
        for n in [0, 1, 2, 3, 100_000] {
            for down in [0.0, 1.0] {
                let at: Vec<[f64; 2]> = (0..n).map(|i| [f64::from(i), 3.0 + down * f64::from(i)]).collect();
                delaunay.triangulate(&cloud(&at));
                assert_eq!((delaunay.triangles().count(), delaunay.hull().count()), (0, 0));
            }
        }
        delaunay.triangulate(&cloud(&[[4.0, 4.0]; 5]));
        assert_eq!(delaunay.triangles().count(), 0);
        // Nearly all points on one line.
        let mut at: Vec<[f64; 2]> = (0..10_000).map(|i| [f64::from(i), 3.0]).collect();
        at.push([5.0, 4.0]);
        delaunay.triangulate(&cloud(&at));
        assert_eq!(delaunay.triangles().count(), 9999);
    }
}
