//! Triangle meshes with a tree of bounding boxes, so that a ray tests a few triangles only.

use nalgebra::{Point3, Vector3};

use super::hit::Hit;
use crate::error::{Error, Result};
use crate::geometry::{Pose, Ray};

/// Triangles in a leaf of the tree: below, boxes cost more than triangles.
const LEAF: usize = 4;
/// Deeper than any tree of halves over 2³² triangles.
const DEPTH: usize = 64;
/// Rays through an edge hit both triangles rather than none.
const EDGE: f64 = 1e-12;

/// Largest coordinate, mm: beyond anything that a projector lights, and far from where squares of areas overflow.
const FARTHEST_MM: f64 = 1e9;

/// A mesh in the camera's frame, mm.
#[derive(Debug, Clone, PartialEq)]
pub struct TriangleMesh {
    pub(super) vertices: Vec<Point3<f64>>,
    /// In the order of the tree's leaves.
    pub(super) triangles: Vec<[u32; 3]>,
    nodes: Vec<Node>,
}

/// A bounding box of the triangles from `start` on. It is a leaf when `count` is not zero; else its children are the
/// next node and the one at `start`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Node {
    least: Point3<f64>,
    most: Point3<f64>,
    start: u32,
    count: u32,
}

impl TriangleMesh {
    /// A mesh of vertices and triples of their indices. Triangles without area are left out.
    ///
    /// # Errors
    /// [`Error::Invalid`] for indices out of range, coordinates that are not finite or beyond 10⁹ mm, and when no
    /// triangle is left.
    pub fn new(vertices: Vec<Point3<f64>>, mut triangles: Vec<[u32; 3]>) -> Result<Self> {
        if let Some(x) =
            vertices.iter().flat_map(|v| v.iter()).find(|x| !(-FARTHEST_MM..=FARTHEST_MM).contains(*x))
        {
            let expected = format!("finite coordinates of at most {FARTHEST_MM:e} mm");
            return Err(Error::invalid("mesh", expected, format!("a vertex with {x:e}")));
        }
        if let Some(i) = triangles.as_flattened().iter().find(|&&i| i as usize >= vertices.len()) {
            let expected = format!("triangles of its {} vertices", vertices.len());
            return Err(Error::invalid("mesh", expected, format!("one with vertex {i}")));
        }
        triangles.retain(|t| {
            let [a, b, c] = t.map(|i| vertices[i as usize]);
            (b - a).cross(&(c - a)).norm_squared() > 0.0
        });
        if triangles.is_empty() {
            return Err(Error::invalid(
                "mesh",
                "triangles (a cloud of points alone has no surface: reconstruct it as a mesh)",
                format!("{} vertices and no triangle with an area", vertices.len()),
            ));
        }
        let mut mesh = Self { vertices, triangles, nodes: Vec::new() };
        let mut triangles = std::mem::take(&mut mesh.triangles);
        mesh.build(&mut triangles, 0);
        mesh.triangles = triangles;
        Ok(mesh)
    }

    /// Number of triangles.
    #[must_use]
    pub fn triangles(&self) -> usize {
        self.triangles.len()
    }

    /// Opposite corners of the smallest upright box around the mesh.
    #[must_use]
    pub fn bounds(&self) -> [Point3<f64>; 2] {
        self.nodes.first().map_or([Point3::origin(); 2], |n| [n.least, n.most])
    }

    /// The same mesh, its coordinates multiplied by `scale` and then transformed.
    ///
    /// # Errors
    /// [`Error::Invalid`] when no triangle is left.
    pub fn placed(&self, scale: f64, camera_from_mesh: &Pose) -> Result<Self> {
        let vertices = self.vertices.iter().map(|v| camera_from_mesh.transform(&(v * scale))).collect();
        Self::new(vertices, self.triangles.clone())
    }

    /// Sorts `triangles` (from index `start` on) into a subtree.
    fn build(&mut self, triangles: &mut [[u32; 3]], start: usize) {
        let corner = |t: &[u32; 3], k: usize| self.vertices[t[k] as usize];
        let mut least = Point3::from(Vector3::repeat(f64::INFINITY));
        let mut most = Point3::from(Vector3::repeat(f64::NEG_INFINITY));
        for t in triangles.iter() {
            for k in 0..3 {
                least = least.inf(&corner(t, k));
                most = most.sup(&corner(t, k));
            }
        }
        let triangles = self.distinct(triangles);
        let here = self.nodes.len();
        let leaf = Node { least, most, start: start as u32, count: triangles.len() as u32 };
        if triangles.len() <= LEAF {
            self.nodes.push(leaf);
            return;
        }
        let axis = (most - least).imax();
        let middle = |t: &[u32; 3]| (0..3).map(|k| corner(t, k)[axis]).sum::<f64>();
        let half = triangles.len() / 2;
        triangles.select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)));
        self.nodes.push(Node { count: 0, ..leaf });
        let (left, right) = triangles.split_at_mut(half);
        self.build(left, start);
        self.nodes[here].start = self.nodes.len() as u32;
        self.build(right, start + half);
    }

    /// The triangles without those that repeat another one, where all have the same middle: no box divides them, and every ray
    /// would test all of them.
    fn distinct<'t>(&self, triangles: &'t mut [[u32; 3]]) -> &'t mut [[u32; 3]] {
        let corners = |t: &[u32; 3]| t.map(|i| self.vertices[i as usize]);
        let middle = |t: &[u32; 3]| corners(t).iter().fold(Vector3::zeros(), |sum, c| sum + c.coords);
        let Some(first) = triangles.first().map(middle).filter(|_| triangles.len() > LEAF) else {
            return triangles;
        };
        if triangles.iter().any(|t| middle(t) != first) {
            return triangles;
        }
        triangles.sort_unstable_by_key(|t| corners(t).map(|c| [c.x, c.y, c.z].map(f64::to_bits)));
        let mut kept = 1;
        for i in 1..triangles.len() {
            if corners(&triangles[i]) != corners(&triangles[kept - 1]) {
                triangles.swap(i, kept);
                kept += 1;
            }
        }
        &mut triangles[..kept]
    }

    /// Triangles in the largest leaf.
    #[cfg(test)]
    pub(super) fn largest_leaf(&self) -> u32 {
        self.nodes.iter().map(|node| node.count).max().unwrap_or(0)
    }

    /// The nearest triangle on a ray.
    pub(super) fn meet(&self, ray: &Ray, [after, before]: [f64; 2]) -> Option<Hit> {
        let inverse = ray.direction.map(f64::recip);
        let mut best: Option<Hit> = None;
        let mut limit = before;
        let (mut stack, mut height) = ([0_u32; DEPTH], 1);
        while height > 0 {
            height -= 1;
            let index = stack[height];
            let Some(node) = self.nodes.get(index as usize) else { continue };
            if !node.crosses(ray, &inverse, [after, limit]) {
                continue;
            }
            if node.count == 0 && height + 2 <= DEPTH {
                stack[height] = node.start;
                stack[height + 1] = index + 1;
                height += 2;
                continue;
            }
            let leaf = node.start as usize..(node.start + node.count) as usize;
            for t in self.triangles.get(leaf).unwrap_or_default() {
                if let Some(hit) = self.triangle(t, ray, [after, limit]) {
                    limit = hit.distance;
                    best = Some(hit);
                }
            }
        }
        best
    }

    /// T. Möller, B. Trumbore, "Fast, minimum storage ray/triangle intersection", J. Graphics Tools 2:21-28 (1997).
    fn triangle(&self, t: &[u32; 3], ray: &Ray, [after, before]: [f64; 2]) -> Option<Hit> {
        let [a, b, c] = t.map(|i| self.vertices[i as usize]);
        let (ab, ac) = (b - a, c - a);
        let across = ray.direction.cross(&ac);
        let volume = ab.dot(&across);
        let from = ray.origin - a;
        let u = from.dot(&across) / volume;
        let turned = from.cross(&ab);
        let v = ray.direction.dot(&turned) / volume;
        let distance = ac.dot(&turned) / volume;
        let hit = u >= -EDGE && v >= -EDGE && u + v <= 1.0 + EDGE && distance > after && distance < before;
        hit.then(|| Hit { distance, normal: ab.cross(&ac) })
    }
}

impl Node {
    /// Whether the ray passes the box. Where a direction is zero, the infinities of its inverse give the right
    /// comparisons.
    fn crosses(&self, ray: &Ray, inverse: &Vector3<f64>, [after, before]: [f64; 2]) -> bool {
        let (mut enter, mut leave) = (after, before);
        for k in 0..3 {
            let a = (self.least[k] - ray.origin[k]) * inverse[k];
            let b = (self.most[k] - ray.origin[k]) * inverse[k];
            // min and max ignore the NaN of a ray within the box's side.
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        enter <= leave * (1.0 + 4.0 * f64::EPSILON)
    }
}
