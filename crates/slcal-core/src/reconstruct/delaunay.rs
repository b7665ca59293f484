//! Delaunay triangulation of points in an image, in buffers that are used again.
//!
//! Points are inserted in the order of a line that sweeps over the image: each lies outside of all before, is joined to the
//! sides of their hull that it sees (they begin at the last point), and edges are flipped until no circle about a triangle
//! holds a point (C. L. Lawson, "Software for C1 surface interpolation", 1977). Matches come in the order of lines, so that
//! nothing needs sorting. The predicates are exact: on the grid of a photograph four points on a circle are common.

use robust::{Coord, incircle, orient2d};

const NONE: u32 = u32::MAX;

/// A triangulation; keeps its buffers.
#[derive(Debug, Clone, Default)]
pub(super) struct Delaunay {
    at: Vec<Coord<f64>>,
    order: Vec<u32>,
    /// Half-edge 3t + k of triangle t begins at this point and ends where the next one of the triangle begins.
    from: Vec<u32>,
    /// The same edge in the triangle beyond, or none.
    twin: Vec<u32>,
    /// The hull, anticlockwise in mathematical axes (y up): following and preceding point.
    next: Vec<u32>,
    prev: Vec<u32>,
    /// The half-edge from a point of the hull to the following one.
    outer: Vec<u32>,
    doubtful: Vec<u32>,
}

fn following(e: u32) -> u32 {
    if e % 3 == 2 { e - 2 } else { e + 1 }
}

fn preceding(e: u32) -> u32 {
    if e.is_multiple_of(3) { e + 2 } else { e - 1 }
}

impl Delaunay {
    /// Triangulates; points that are not finite, or repeat another one, stay without a triangle.
    pub(super) fn triangulate(&mut self, points: impl Iterator<Item = [f64; 2]>) {
        self.at.clear();
        self.at.extend(points.map(|[x, y]| Coord { x, y }));
        let (at, n) = (&self.at, self.at.len());
        self.order.clear();
        self.order
            .extend((0..n as u32).filter(|i| at[*i as usize].x.is_finite() && at[*i as usize].y.is_finite()));
        self.order.sort_unstable_by(|a, b| {
            let (p, q) = (at[*a as usize], at[*b as usize]);
            p.y.total_cmp(&q.y).then(p.x.total_cmp(&q.x)).then(a.cmp(b))
        });
        self.order.dedup_by(|b, a| at[*a as usize] == at[*b as usize]);
        self.from.clear();
        self.twin.clear();
        for of_points in [&mut self.next, &mut self.prev, &mut self.outer] {
            of_points.clear();
            of_points.resize(n, NONE);
        }
        // There are never more edges than three per point; frames of one size then ask for no more memory.
        self.doubtful.reserve(n);
        let Some(start) = self.start() else { return };
        for i in start..self.order.len() {
            self.insert(self.order[i], self.order[i - 1]);
        }
    }

    /// Three points each, anticlockwise in mathematical axes.
    pub(super) fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        self.from.as_chunks::<3>().0.iter().copied()
    }

    /// The points of the outer border.
    pub(super) fn hull(&self) -> impl Iterator<Item = u32> {
        (0..self.next.len() as u32).filter(|i| self.next[*i as usize] != NONE)
    }

    fn turn(&self, a: u32, b: u32, c: u32) -> f64 {
        orient2d(self.at[a as usize], self.at[b as usize], self.at[c as usize])
    }

    /// Joins the first points, which lie on one straight line, with the first one beside it; how many are done then.
    fn start(&mut self) -> Option<usize> {
        let &[first, second, ..] = self.order.as_slice() else { return None };
        let apex = self.order.iter().position(|p| self.turn(first, second, *p) != 0.0)?;
        let p = self.order[apex];
        let left = self.turn(first, second, p) > 0.0;
        let mut before = NONE;
        for k in 1..apex {
            // Along the line with p to its left.
            let (a, b) = if left {
                (self.order[k - 1], self.order[k])
            } else {
                (self.order[apex - k], self.order[apex - k - 1])
            };
            let e = self.add([a, b, p]);
            self.outer[a as usize] = e;
            self.join_hull(a, b);
            if before == NONE {
                self.outer[p as usize] = e + 2;
                self.join_hull(p, a);
            } else {
                self.link(before + 1, e + 2);
            }
            before = e;
            self.outer[b as usize] = e + 1;
            self.join_hull(b, p);
        }
        Some(apex + 1)
    }

    /// Joins a point that lies outside of all others to the sides that it sees; `last` was inserted before.
    fn insert(&mut self, p: u32, last: u32) {
        let (mut low, mut high) = (last, last);
        while self.turn(self.prev[low as usize], low, p) < 0.0 {
            low = self.prev[low as usize];
        }
        while self.turn(high, self.next[high as usize], p) < 0.0 {
            high = self.next[high as usize];
        }
        let (mut v, mut before) = (low, NONE);
        while v != high {
            let w = self.next[v as usize];
            let e = self.add([w, v, p]);
            self.link(e, self.outer[v as usize]);
            if before == NONE {
                self.outer[low as usize] = e + 1;
            } else {
                self.link(before + 2, e + 1);
            }
            self.doubtful.push(e);
            self.next[v as usize] = NONE;
            before = e;
            v = w;
        }
        if before != NONE {
            self.outer[p as usize] = before + 2;
            self.join_hull(low, p);
            self.join_hull(p, high);
        }
        self.flip();
    }

    fn add(&mut self, corners: [u32; 3]) -> u32 {
        let e = self.from.len() as u32;
        self.from.extend(corners);
        self.twin.extend([NONE; 3]);
        e
    }

    fn link(&mut self, a: u32, b: u32) {
        self.twin[a as usize] = b;
        self.twin[b as usize] = a;
    }

    fn join_hull(&mut self, a: u32, b: u32) {
        self.next[a as usize] = b;
        self.prev[b as usize] = a;
    }

    /// Flips doubtful edges, each of a triangle whose third point is the new one, until all circles are empty.
    fn flip(&mut self) {
        while let Some(a) = self.doubtful.pop() {
            let b = self.twin[a as usize];
            if b == NONE {
                continue;
            }
            let (a_last, b_next, b_last) = (preceding(a), following(b), preceding(b));
            let corner = |e: u32| self.from[e as usize];
            let (c, d) = (corner(a_last), corner(b_last));
            let point = |i: u32| self.at[i as usize];
            if incircle(point(corner(a)), point(corner(b)), point(c), point(d)) <= 0.0 {
                continue;
            }
            // The edge from A to B becomes the one from C to D: half-edge a from D to B, b from C to A.
            let (beyond_b, beyond_a) = (self.twin[b_last as usize], self.twin[a_last as usize]);
            self.from[a as usize] = d;
            self.from[b as usize] = c;
            self.border(a, d, beyond_b);
            self.border(b, c, beyond_a);
            self.link(a_last, b_last);
            self.doubtful.extend([a, b_next]);
        }
    }

    /// Half-edge `e`, which begins at `from`, gets its twin, or becomes one of the hull.
    fn border(&mut self, e: u32, from: u32, twin: u32) {
        if twin == NONE {
            self.twin[e as usize] = NONE;
            self.outer[from as usize] = e;
        } else {
            self.link(e, twin);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use spade::{DelaunayTriangulation, Point2, Triangulation};

    fn area(at: &[[f64; 2]], t: [u32; 3]) -> f64 {
        let [a, b, c] = t.map(|i| at[i as usize]);
        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]))
    }

    /// As many triangles and as long a border as another program finds, the same area, and no point within any circle of
    /// neighbours: a Delaunay triangulation, whichever way squares are cut.
    fn check(points: &[[f64; 2]]) {
        let mut net = Delaunay::default();
        // A second time in used buffers.
        net.triangulate([[0.0, 0.0], [3.0, 1.0], [1.0, 4.0], [7.0, 7.0]].into_iter());
        net.triangulate(points.iter().copied());
        let other = DelaunayTriangulation::<Point2<f64>>::bulk_load(
            points
                .iter()
                .filter(|p| p[0].is_finite() && p[1].is_finite())
                .map(|p| Point2::new(p[0], p[1]))
                .collect(),
        )
        .unwrap();
        assert_eq!(net.triangles().count(), other.num_inner_faces());
        if other.num_inner_faces() > 0 {
            assert_eq!(net.hull().count(), other.convex_hull_size());
        }
        let whole: f64 = other.inner_faces().map(|f| f.area()).sum();
        let found: f64 = net.triangles().map(|t| area(points, t)).sum();
        assert!((whole - found).abs() <= 1e-9 * (1.0 + whole));
        for (e, twin) in net.twin.iter().enumerate() {
            let e = e as u32;
            let corner = |e: u32| net.at[net.from[e as usize] as usize];
            assert!(orient2d(corner(e), corner(following(e)), corner(preceding(e))) > 0.0);
            if *twin != NONE {
                assert_eq!(net.twin[*twin as usize], e);
                let beyond = corner(preceding(*twin));
                assert!(incircle(corner(e), corner(following(e)), corner(preceding(e)), beyond) <= 0.0);
            }
        }
    }

    #[test]
    fn circles_are_empty_for_stripes_grids_clouds_and_odd_points() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(2);
        let stripes = (0..40).flat_map(|v| (0..20).map(move |s| (v, s)));
        let stripes: Vec<[f64; 2]> = stripes
            .map(|(v, s)| {
                let (v, s) = (f64::from(v), f64::from(s));
                [14.0 * s + 3.0 * (0.3 * v + s).sin(), v]
            })
            .collect();
        check(&stripes);
        check(&stripes.iter().map(|[x, y]| [*y, *x]).collect::<Vec<_>>());
        check(&stripes.iter().rev().copied().collect::<Vec<_>>());
        let grid = |step: f64| (0..400).map(move |i| [f64::from(i % 20) * step, f64::from(i / 20)]);
        check(&grid(1.0).collect::<Vec<_>>());
        check(&grid(12.0).collect::<Vec<_>>());
        for n in [0, 1, 2, 3, 4, 10, 500] {
            check(&(0..n).map(|_| [rng.random(), rng.random()]).collect::<Vec<[f64; 2]>>());
            check(
                &(0..n)
                    .map(|_| [f64::from(rng.random_range(0..9)), f64::from(rng.random_range(0..9))])
                    .collect::<Vec<_>>(),
            );
            check(&(0..n).map(|i| [f64::from(i), 3.0]).collect::<Vec<_>>());
            check(&(0..n).map(|i| [3.0, f64::from(i)]).collect::<Vec<_>>());
        }
        check(&[[0.0, 0.0], [f64::NAN, 1.0], [1.0, 0.0], [0.0, 1.0], [0.0, f64::INFINITY], [1.0, 0.0]]);
    }
}
