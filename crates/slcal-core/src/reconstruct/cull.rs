//! Removal of outliers: triangles between neighbours in the image, without those that span a jump of depth. A point
//! without a triangle, or in a small component, is an outlier.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::components::Components;
use super::delaunay::Delaunay;
use super::local_slant::LocalSlant;
use super::triangle_metrics::{TriangleMetrics, area_mm2};
use crate::cloud::PointCloud;
use crate::error::{Error, Result};
use crate::named::unnamed;
use crate::solve::median;

/// Which triangles are removed.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum CullRule {
    /// Triangles that are far more slanted than their neighbourhood, or far longer in the image.
    #[default]
    Auto,
    /// None.
    Off,
    /// Triangles of more than this area, mm².
    MaxAreaMm2(f64),
}

impl CullRule {
    /// The names of the rules; an area has none.
    pub const NAMES: &'static [&'static str] = &["auto", "off"];
}

impl fmt::Display for CullRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.pad("auto"),
            Self::Off => f.pad("off"),
            Self::MaxAreaMm2(area) => write!(f, "{area}"),
        }
    }
}

impl FromStr for CullRule {
    type Err = Error;

    /// `auto`, `off`, or the largest area in mm².
    ///
    /// # Errors
    /// [`Error::Invalid`] that lists these.
    fn from_str(text: &str) -> Result<Self> {
        match text.to_ascii_lowercase().as_str() {
            "auto" => Ok(Self::Auto),
            "off" => Ok(Self::Off),
            number => match number.parse::<f64>() {
                Ok(area) if area.is_finite() && area > 0.0 => Ok(Self::MaxAreaMm2(area)),
                _ => Err(unnamed("cull", Self::NAMES, " or an area above zero in mm²", text)),
            },
        }
    }
}

/// Counts of removed triangles and points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[non_exhaustive]
pub struct CullReport {
    /// Triangles between the points.
    pub triangles: usize,
    /// Removed triangles.
    pub triangles_removed: usize,
    /// Removed points: without a triangle, or in a component too small to be a surface.
    pub outliers: usize,
}

/// A triangle is removed when its area in space over its area in the image exceeds the local median by this factor. At
/// a jump of depth the ratio is ten and more; on a curved surface it changes by less than two from one stripe to the
/// next.
const MAX_SLANT_RATIO: f64 = 3.0;
/// Longest side of a triangle in the image over the median of all; beyond, it bridges a part without light.
const MAX_LENGTH_RATIO: f64 = 2.5;
/// The median length is that of about this many triangles, spread evenly.
const SAMPLE: usize = 8192;

/// Culls one cloud after another and keeps its buffers.
#[derive(Debug, Clone, Default)]
pub struct Culler {
    delaunay: Delaunay,
    /// One per triangle.
    metrics: Vec<TriangleMetrics>,
    lengths: Vec<f64>,
    local_slant: LocalSlant,
    components: Components,
}

impl Culler {
    /// Triangulates the points in the image (Delaunay), removes triangles by `rule` and points without a triangle. The
    /// remaining triangles are the cloud's mesh, counter-clockwise as seen by the camera. With [`CullRule::Off`] all points
    /// and triangles stay.
    ///
    /// # Errors
    /// [`Error::Invalid`] for an area that is not a positive number.
    pub fn cull(&mut self, cloud: &mut PointCloud, rule: CullRule) -> Result<CullReport> {
        check(rule)?;
        self.triangulate(cloud);
        let usual_px = self.measure(cloud);
        self.components.before(cloud.points.len(), &cloud.triangles, self.delaunay.hull());
        Ok(self.remove(cloud, rule, usual_px))
    }

    /// The same for a cloud whose triangles are known. `border` are the points that have a side without triangles.
    ///
    /// # Errors
    /// As [`cull`](Self::cull).
    pub(super) fn cull_mesh(
        &mut self,
        cloud: &mut PointCloud,
        rule: CullRule,
        border: impl Iterator<Item = u32>,
    ) -> Result<CullReport> {
        check(rule)?;
        let usual_px = self.measure(cloud);
        self.components.before(cloud.points.len(), &cloud.triangles, border);
        Ok(self.remove(cloud, rule, usual_px))
    }

    /// Removes triangles by the rule, then points without triangles.
    fn remove(&mut self, cloud: &mut PointCloud, rule: CullRule, usual_px: f64) -> CullReport {
        let mut report = CullReport { triangles: cloud.triangles.len(), ..CullReport::default() };
        match rule {
            CullRule::Off => return report,
            CullRule::MaxAreaMm2(most) => {
                let points = &cloud.points;
                cloud.triangles.retain(|t| area_mm2(points, t) <= most);
            }
            CullRule::Auto => self.keep_smooth(cloud, usual_px),
        }
        report.triangles_removed = report.triangles - cloud.triangles.len();
        let least = if rule == CullRule::Auto { usual_px } else { 0.0 };
        report.outliers = self.components.keep_surfaces(cloud, least);
        report
    }

    /// Fills the cloud's triangles with all triangles between its points.
    fn triangulate(&mut self, cloud: &mut PointCloud) {
        self.delaunay.triangulate(&cloud.points);
        cloud.triangles.clear();
        // Anticlockwise with y up; the image's y points down.
        cloud.triangles.extend(self.delaunay.triangles().map(|[a, b, c]| [a, c, b]));
    }

    /// Measures every triangle. Returns the median of their longest sides in the image.
    fn measure(&mut self, cloud: &PointCloud) -> f64 {
        self.metrics.clear();
        self.metrics.extend(cloud.triangles.iter().map(|t| TriangleMetrics::of(cloud, t)));
        self.lengths.clear();
        let step = self.metrics.len().div_ceil(SAMPLE).max(1);
        self.lengths.extend(self.metrics.iter().step_by(step).map(|s| s.longest_px));
        median(&mut self.lengths).unwrap_or(0.0)
    }

    /// Keeps the triangles that are about as slanted and as long as those around them.
    fn keep_smooth(&mut self, cloud: &mut PointCloud, usual_px: f64) {
        let longest = MAX_LENGTH_RATIO * usual_px;
        self.local_slant.learn(&self.metrics, usual_px, longest);
        let mut metrics = self.metrics.iter();
        cloud.triangles.retain(|_| {
            metrics.next().is_some_and(|s| {
                s.longest_px <= longest && s.slant <= MAX_SLANT_RATIO * self.local_slant.usual_slant(s)
            })
        });
    }
}

/// Refuses an area that is not a positive number.
fn check(rule: CullRule) -> Result<()> {
    if let CullRule::MaxAreaMm2(a) = rule
        && !(a.is_finite() && a > 0.0)
    {
        return Err(Error::invalid("largest area of a triangle", "a positive number of mm²", a));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::super::triangle_metrics::corners;
    use super::*;
    use crate::cloud::CloudPoint;

    /// A camera of f = 1000 px and stripes every 12 px on a surface of the given depth.
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
                    slit: Some(k as u16),
                    confidence: 1.0,
                });
            }
        }
        PointCloud { points, ..PointCloud::default() }
    }

    fn cull(cloud: &mut PointCloud, rule: CullRule) -> Result<CullReport> {
        Culler::default().cull(cloud, rule)
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
    fn triangles_across_a_step_are_removed_and_its_points_stay() {
        let mut c = cloud(|x, _| if x < 180.0 { 1000.0 } else { 1300.0 });
        let report = cull(&mut c, CullRule::Auto).unwrap();
        assert_eq!(report.outliers, 0);
        for t in &c.triangles {
            let z = corners(&c.points, t).map(|p| p.position.z);
            assert!((z[0] - z[1]).abs() < 1.0 && (z[0] - z[2]).abs() < 1.0);
        }
    }

    #[test]
    fn wrong_points_are_removed() {
        let mut c =
            cloud(|x, y| if (x as u32) / 12 == 14 && (20.0..31.0).contains(&y) { 1250.0 } else { 1000.0 });
        let report = cull(&mut c, CullRule::Auto).unwrap();
        assert_eq!(report.outliers, 11);
        assert!(c.points.iter().all(|p| (p.position.z - 1000.0).abs() < 1e-9));
    }

    /// Two wrong stripes beside each other, over three of their distances, without a third one that confirms them. At
    /// twice and half the resolution the same share of the points is removed.
    #[test]
    fn two_wrong_stripes_are_removed_at_any_resolution() {
        for scale in [1_u32, 2, 4] {
            let (step, lines) = (6 * scale, 30 * scale);
            let mut c = PointCloud::default();
            for line in 0..lines {
                for k in 0..30 {
                    let wrong = (14..16).contains(&k) && (5 * scale..25 * scale).contains(&line);
                    let z = if wrong { 1250.0 } else { 1000.0 };
                    let (x, y) = (f64::from(k * step), f64::from(line));
                    c.points.push(CloudPoint {
                        position: Point3::new(x, y, 500.0 * f64::from(scale))
                            * (z / 500.0 / f64::from(scale)),
                        pixel: nalgebra::Point2::new(x, y),
                        color: [0; 3],
                        sigma_mm: 0.1,
                        noise_mm: 0.1,
                        slit: Some(k as u16),
                        confidence: 1.0,
                    });
                }
            }
            let report = cull(&mut c, CullRule::Auto).unwrap();
            assert_eq!(report.outliers, 40 * scale as usize, "scale {scale}");
            assert!(c.points.iter().all(|p| (p.position.z - 1000.0).abs() < 1e-9));
        }
    }

    #[test]
    fn culling_does_not_depend_on_the_frame() {
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
    fn an_area_limit_works_and_unusual_clouds_do_no_harm() {
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
