//! Triangles between points that are neighbours in the image, less those that span a jump of depth; a point that no
//! triangle wants is an outlier.

use serde::{Deserialize, Serialize};
use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation};

use crate::cloud::{CloudPoint, PointCloud};
use crate::error::{Error, Result};
use crate::solve::median;

/// Which triangles go.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CullRule {
    /// Those that are far more slanted than their neighbourhood, or far longer in the image.
    #[default]
    Auto,
    /// None.
    Off,
    /// Those of more than this area, mm².
    MaxAreaMm2(f64),
}

/// What was taken away.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct CullReport {
    /// Triangles between the points.
    pub triangles: usize,
    /// Of these, removed.
    pub triangles_removed: usize,
    /// Points left without a triangle, or in an island too small to be a surface.
    pub outliers: usize,
}

/// A triangle is removed when its area in space over its area in the image is more than this many times what is usual
/// about it: at a jump of depth the ratio is ten and more, on a curved surface it changes by less than two from one
/// stripe to the next.
const MAX_SLANT_RATIO: f64 = 3.0;
/// Longest side of a triangle in the image over the median of all: it bridges a part without light.
const MAX_LENGTH_RATIO: f64 = 2.5;
/// Side of the cells that make up a neighbourhood, in median sides of triangles: some five stripes.
const CELL_SIDES: f64 = 5.0;
/// Islands of fewer points than this share of all (and than [`MIN_ISLAND`]) are chance matches.
const MIN_ISLAND_SHARE: f64 = 1e-3;
/// Three rows of three stripes make a surface.
const MIN_ISLAND: usize = 9;

struct Vertex {
    at: Point2<f64>,
    index: usize,
}

impl HasPosition for Vertex {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.at
    }
}

/// Triangulates the points in the image (Delaunay), removes triangles by `rule` and points without a triangle. The
/// triangles that stay are the cloud's mesh, counter-clockwise as the camera sees them. With [`CullRule::Off`] all points
/// and triangles stay.
///
/// # Errors
/// [`Error::Invalid`] for an area that is not a positive number.
pub fn cull(cloud: &mut PointCloud, rule: CullRule) -> Result<CullReport> {
    if let CullRule::MaxAreaMm2(a) = rule
        && !(a.is_finite() && a > 0.0)
    {
        return Err(Error::invalid("largest area of a triangle", "a positive number of mm²", a));
    }
    let triangles = delaunay(&cloud.points)?;
    let mut report = CullReport { triangles: triangles.len(), ..CullReport::default() };
    let kept: Vec<[u32; 3]> = match rule {
        CullRule::Off => {
            cloud.triangles = triangles;
            return Ok(report);
        }
        CullRule::MaxAreaMm2(most) => {
            triangles.into_iter().filter(|t| area_mm2(&cloud.points, t) <= most).collect()
        }
        CullRule::Auto => smooth(cloud, triangles),
    };
    report.triangles_removed = report.triangles - kept.len();
    report.outliers = compact(cloud, kept);
    Ok(report)
}

fn delaunay(points: &[CloudPoint]) -> Result<Vec<[u32; 3]>> {
    let vertices = points
        .iter()
        .enumerate()
        .filter(|(_, p)| {
            p.pixel.x.is_finite() && p.pixel.y.is_finite() && p.position.iter().all(|x| x.is_finite())
        })
        .map(|(index, p)| Vertex { at: Point2::new(p.pixel.x, p.pixel.y), index })
        .collect();
    let net = DelaunayTriangulation::<Vertex>::bulk_load(vertices)
        .map_err(|e| Error::invalid("pixels of the points", "finite coordinates", e))?;
    // Spade's triangles are counter-clockwise with y up; the image's y points down.
    let triangles = net.inner_faces().map(|f| {
        let [a, b, c] = f.vertices().map(|v| v.data().index as u32);
        [a, c, b]
    });
    Ok(triangles.collect())
}

fn corners<'a>(points: &'a [CloudPoint], t: &[u32; 3]) -> [&'a CloudPoint; 3] {
    t.map(|i| &points[i as usize])
}

fn area_mm2(points: &[CloudPoint], t: &[u32; 3]) -> f64 {
    let [a, b, c] = corners(points, t).map(|p| p.position);
    0.5 * (b - a).cross(&(c - a)).norm()
}

/// Area in space over the area in the image at the triangle's own distance; one over the cosine of the slant, up to a
/// factor that is the same for all.
fn slant(cloud: &PointCloud, t: &[u32; 3]) -> f64 {
    let [a, b, c] = corners(&cloud.points, t).map(|p| p.pixel);
    let in_image = 0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)).abs();
    let distance = |p: &CloudPoint| (p.position - cloud.camera_centre).norm();
    let near = corners(&cloud.points, t).map(distance).into_iter().fold(f64::INFINITY, f64::min);
    area_mm2(&cloud.points, t) / (in_image * near * near)
}

fn longest_px(points: &[CloudPoint], t: &[u32; 3]) -> f64 {
    let [a, b, c] = corners(points, t).map(|p| p.pixel);
    (b - a).norm().max((c - b).norm()).max((a - c).norm())
}

/// The triangles that are about as slanted and as long as those around them.
fn smooth(cloud: &PointCloud, triangles: Vec<[u32; 3]>) -> Vec<[u32; 3]> {
    let points = &cloud.points;
    let mut lengths: Vec<f64> = triangles.iter().map(|t| longest_px(points, t)).collect();
    let usual = median(&mut lengths).unwrap_or(0.0);
    let cell = (CELL_SIDES * usual).max(1.0);
    let key = |t: &[u32; 3]| {
        let [a, b, c] = corners(points, t).map(|p| p.pixel.coords);
        let m = (a + b + c) / (3.0 * cell);
        (m.x.floor() as i64, m.y.floor() as i64)
    };
    let mut by_cell: std::collections::HashMap<(i64, i64), Vec<f64>> = std::collections::HashMap::new();
    let mut all = Vec::with_capacity(triangles.len());
    for t in &triangles {
        let s = slant(cloud, t);
        if s.is_finite() && longest_px(points, t) <= MAX_LENGTH_RATIO * usual {
            by_cell.entry(key(t)).or_default().push(s);
            all.push(s);
        }
    }
    let least = quantile(&mut all, 0.1);
    let local: std::collections::HashMap<_, f64> =
        by_cell.into_iter().map(|(k, mut s)| (k, median(&mut s).unwrap_or(0.0))).collect();
    triangles
        .into_iter()
        .filter(|t| {
            // No neighbourhood is less slanted than a surface can be: a cell of a single odd triangle judges nothing.
            let usual_slant = local.get(&key(t)).copied().unwrap_or(least).clamp(least, 4.0 * least);
            longest_px(points, t) <= MAX_LENGTH_RATIO * usual
                && slant(cloud, t) <= MAX_SLANT_RATIO * usual_slant
        })
        .collect()
}

/// Keeps the points of triangles in islands that are large enough, renumbers, and returns how many points went.
fn compact(cloud: &mut PointCloud, triangles: Vec<[u32; 3]>) -> usize {
    let n = cloud.points.len();
    let mut parent: Vec<u32> = (0..n as u32).collect();
    for t in &triangles {
        let a = root(&mut parent, t[0]);
        for &v in &t[1..] {
            let b = root(&mut parent, v);
            parent[b as usize] = a;
        }
    }
    let mut sizes = vec![0_usize; n];
    for i in 0..n as u32 {
        sizes[root(&mut parent, i) as usize] += 1;
    }
    let least = MIN_ISLAND.max((MIN_ISLAND_SHARE * n as f64) as usize);
    let mut number = vec![u32::MAX; n];
    let mut kept = Vec::new();
    for (i, p) in cloud.points.iter().enumerate() {
        if sizes[root(&mut parent, i as u32) as usize] >= least {
            number[i] = kept.len() as u32;
            kept.push(*p);
        }
    }
    let outliers = n - kept.len();
    cloud.points = kept;
    cloud.triangles = triangles
        .into_iter()
        .map(|t| t.map(|v| number[v as usize]))
        .filter(|t| !t.contains(&u32::MAX))
        .collect();
    outliers
}

/// The representative of an island; halves the path on the way.
fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        let up = parent[parent[i as usize] as usize];
        parent[i as usize] = up;
        i = up;
    }
    i
}

fn quantile(values: &mut [f64], q: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let at = ((values.len() - 1) as f64 * q) as usize;
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    /// A camera of f = 1000 px looks at stripes every 12 px on a surface of the given depth.
    fn cloud(depth: impl Fn(f64, f64) -> f64) -> PointCloud {
        let mut points = Vec::new();
        for v in 0..60 {
            for k in 0..30 {
                let (x, y) = (f64::from(k) * 12.0, f64::from(v));
                let z = depth(x, y);
                points.push(CloudPoint {
                    position: Point3::new(x / 1000.0 * z, y / 1000.0 * z, z),
                    pixel: nalgebra::Point2::new(x, y),
                    color: [0; 3],
                    sigma_mm: 0.1,
                    noise_mm: 0.1,
                    slit: k as u16,
                    confidence: 1.0,
                });
            }
        }
        PointCloud { points, ..PointCloud::default() }
    }

    #[test]
    fn a_smooth_surface_stays_whole_and_faces_the_camera() {
        let mut c = cloud(|x, _| 1000.0 + 0.5 * x + 30.0 * (x / 60.0).sin());
        let report = cull(&mut c, CullRule::Auto).unwrap();
        assert_eq!((report.outliers, report.triangles_removed), (0, 0));
        for t in &c.triangles {
            let [a, b, d] = corners(&c.points, t).map(|p| p.position);
            assert!((b - a).cross(&(d - a)).dot(&a.coords) < 0.0, "the normal points to the camera");
        }
    }

    #[test]
    fn a_step_is_cut_and_its_points_stay() {
        let mut c = cloud(|x, _| if x < 180.0 { 1000.0 } else { 1300.0 });
        let report = cull(&mut c, CullRule::Auto).unwrap();
        assert_eq!(report.outliers, 0);
        for t in &c.triangles {
            let z = corners(&c.points, t).map(|p| p.position.z);
            assert!((z[0] - z[1]).abs() < 1.0 && (z[0] - z[2]).abs() < 1.0);
        }
    }

    #[test]
    fn wrong_points_go() {
        let mut c =
            cloud(|x, y| if (x as u32) / 12 == 14 && (20.0..31.0).contains(&y) { 1250.0 } else { 1000.0 });
        let report = cull(&mut c, CullRule::Auto).unwrap();
        assert_eq!(report.outliers, 11);
        assert!(c.points.iter().all(|p| (p.position.z - 1000.0).abs() < 1e-9));
    }

    #[test]
    fn what_is_culled_does_not_depend_on_the_frame() {
        let surface = |x: f64, y: f64| {
            let step = if x < 180.0 { 1000.0 + y } else { 1300.0 - 0.7 * x };
            if (x as u32) / 12 == 7 && (20.0..31.0).contains(&y) { 1250.0 } else { step }
        };
        for rule in [CullRule::Auto, CullRule::MaxAreaMm2(9.0), CullRule::Off] {
            let mut here = cloud(surface);
            let report = cull(&mut here, rule).unwrap();
            for i in 1..12 {
                let i = f64::from(i);
                let turn = nalgebra::Rotation3::from_euler_angles(i, 0.7 * i * i, -1.3 * i);
                let shift = nalgebra::Vector3::new(300.0 * i, -50.0, -700.0);
                let mut there = cloud(surface);
                for p in &mut there.points {
                    p.position = turn * p.position + shift;
                }
                there.camera_centre = turn * there.camera_centre + shift;
                assert_eq!(cull(&mut there, rule).unwrap(), report);
                assert_eq!(there.triangles, here.triangles);
                let pixels = |c: &PointCloud| c.points.iter().map(|p| p.pixel).collect::<Vec<_>>();
                assert_eq!(pixels(&there), pixels(&here));
            }
        }
    }

    #[test]
    fn an_area_may_be_given_and_odd_clouds_do_no_harm() {
        let mut c = cloud(|_, _| 1000.0);
        // Triangles of 12 mm × 1 mm / 2.
        assert_eq!(cull(&mut c.clone(), CullRule::MaxAreaMm2(7.0)).unwrap().outliers, 0);
        assert_eq!(cull(&mut c, CullRule::MaxAreaMm2(5.0)).unwrap().outliers, 1800);
        assert!(cull(&mut c, CullRule::MaxAreaMm2(f64::NAN)).is_err());
        let mut same = cloud(|_, _| 1000.0);
        same.points.truncate(3);
        same.points[1].pixel = same.points[0].pixel;
        same.points[2].position.z = f64::NAN;
        assert_eq!(cull(&mut same, CullRule::Auto).unwrap().outliers, 3);
        assert!(cull(&mut PointCloud::default(), CullRule::Auto).is_ok());
    }
}
