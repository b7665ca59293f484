//! Triangulation of every pixel, and the triangles between neighbouring pixels.

use nalgebra::{Point2, Point3, Vector3};

use super::camera_ray::{CameraRay, CameraRays};
use super::cull::{CullReport, CullRule, Culler};
use super::light_plane::{Hit, ProjectorLight, Rejection};
use super::point_covariance::RigSigma;
use super::sampled_median::sampled_median;
use super::triangulate_config::{TriangulateConfig, TriangulateReport};
use crate::cloud::{CloudPoint, Frame, PointCloud};
use crate::dense_matches::DenseMatches;
use crate::error::Result;
use crate::rig::{Projector, Rig};

/// The rig's share of σ is computed once for a square of this share of the image's longer side…
const BLOCK_SHARE: f64 = 1.0 / 128.0;
/// …and for each depth in it, which may differ by this share.
const SAME_DEPTH: f64 = 0.02;
/// No point.
const NONE: u32 = u32::MAX;

/// The matches of a regular grid → points with one rig.
#[derive(Debug, Clone)]
pub struct DenseTriangulator {
    config: TriangulateConfig,
    rays: CameraRays,
    light: ProjectorLight,
    rig: Option<RigSigma>,
    block_px: usize,
    /// Which point each pixel has.
    point_of: Vec<u32>,
}

/// The rig's share where it was last computed.
#[derive(Clone, Copy)]
struct Share {
    inverse_depth: f64,
    /// Over depth squared.
    scaled: f64,
}

impl DenseTriangulator {
    /// Precomputes what does not change from scan to scan.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for a rig without a projector or a configuration out of range.
    pub fn new(rig: &Rig, config: TriangulateConfig) -> Result<Self> {
        config.validate()?;
        let Projector { device, from_camera, .. } = rig.require_projector()?;
        let camera = rig.camera.model;
        let pose = from_camera.pose;
        let light = ProjectorLight::new(device.model, pose, config.min_angle_rad, config.panel_margin);
        let block_px = (BLOCK_SHARE * f64::from(camera.width.max(camera.height))).ceil().max(1.0) as usize;
        let (rays, rig) = (CameraRays::new(camera), RigSigma::of(rig));
        Ok(Self { config, rays, light, rig, block_px, point_of: Vec::new() })
    }

    /// Replaces the content of `cloud` by the points of the pixels, in the camera's frame, row by row.
    ///
    /// A pixel's ray meets the light of its column, of its row, or of both, as in [`Triangulator`](super::Triangulator). σ has two parts:
    /// that of the panel's coordinate, which is independent from pixel to pixel, and that of the rig.
    pub fn triangulate(&mut self, matches: &DenseMatches, cloud: &mut PointCloud) -> TriangulateReport {
        let mut points = std::mem::take(&mut cloud.points);
        points.clear();
        *cloud = PointCloud {
            points,
            frame: Frame::Camera,
            camera_centre: Point3::origin(),
            ..PointCloud::default()
        };
        cloud.points.reserve(matches.known());
        let mut report = TriangulateReport::default();
        self.point_of.clear();
        self.point_of.resize(matches.width * matches.height, NONE);
        let nowhere = Share { inverse_depth: f64::NAN, scaled: f64::NAN };
        let mut shares = vec![nowhere; matches.width.div_ceil(self.block_px)];
        for v in 0..matches.height {
            if v % self.block_px == 0 {
                shares.fill(nowhere);
            }
            for u in 0..matches.width {
                let pixel = v * matches.width + u;
                if !matches.is_known(pixel) {
                    continue;
                }
                match self.point(matches, [u, v], &mut shares[u / self.block_px]) {
                    Ok(point) => {
                        self.point_of[pixel] = cloud.points.len() as u32;
                        cloud.points.push(point);
                    }
                    Err(rejection) => report.count(rejection),
                }
            }
        }
        report.points = cloud.points.len();
        report.rig_sigma_known = self.rig.is_some();
        let mut sample = Vec::new();
        report.median_sigma_mm = sampled_median(&cloud.points, &mut sample, |p| p.sigma_mm);
        report.median_noise_mm = sampled_median(&cloud.points, &mut sample, |p| p.noise_mm);
        report
    }

    fn point(
        &self,
        matches: &DenseMatches,
        [u, v]: [usize; 2],
        share: &mut Share,
    ) -> std::result::Result<CloudPoint, Rejection> {
        let pixel = v * matches.width + u;
        let known = |of: &[f32]| of.get(pixel).filter(|x| x.is_finite()).map(|x| f64::from(*x));
        let wanted = [known(&matches.column), known(&matches.row)];
        let sigmas = [known(&matches.sigma_column), known(&matches.sigma_row)];
        let at = Point2::new(u as f64, v as f64);
        let ray = self.rays.of(at, &self.light.pose.rotation).ok_or(Rejection::Invalid)?;
        let hit = self.light.meet(&ray.in_projector, wanted)?;
        let z = 1.0 / hit.inverse_depth;
        if !self.config.depth_mm().contains(&z) {
            return Err(Rejection::OutsideDepth);
        }
        let variance: f64 = hit
            .coordinates()
            .map(|c| {
                let on_panel =
                    sigmas[c.axis].unwrap_or(f64::NAN).powi(2) + self.config.projector_sigma_px.powi(2);
                on_panel * c.gain.powi(2)
            })
            .sum();
        let noise_mm = (variance * ray.squared_length).sqrt() * z * z;
        let of_rig = self.rig_share(&ray, &hit, share) * z * z;
        let sigma_mm = noise_mm.hypot(of_rig);
        if !(sigma_mm.is_finite() && z.is_finite()) {
            return Err(Rejection::Grazing);
        }
        Ok(CloudPoint {
            position: Point3::from(ray.bearing * z),
            pixel: at,
            color: matches.color.get(pixel).copied().unwrap_or([255; 3]),
            sigma_mm,
            noise_mm,
            slit: None,
            confidence: matches.confidence.get(pixel).map_or(1.0, |c| f64::from(*c)),
        })
    }

    /// 1σ along the ray from the rig over the square of the depth, 1/mm.
    fn rig_share(&self, ray: &CameraRay, hit: &Hit, share: &mut Share) -> f64 {
        let Some(rig) = &self.rig else { return 0.0 };
        let is_same = (hit.inverse_depth - share.inverse_depth).abs() <= SAME_DEPTH * hit.inverse_depth;
        if !is_same {
            let along = rig.along_ray(&self.rays.camera, &self.light, ray, hit);
            *share = Share {
                inverse_depth: hit.inverse_depth,
                scaled: along * hit.inverse_depth * hit.inverse_depth,
            };
        }
        share.scaled
    }

    /// Connects neighbouring pixels to triangles, removes triangles and points by `rule`, and gives the points normals. With
    /// [`CullRule::Off`] all points and triangles stay. The cloud must be that of the last [triangulation](Self::triangulate), of an image
    /// that is `width` px wide.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for an area that is not a positive number.
    pub fn connect(
        &self,
        width: usize,
        cloud: &mut PointCloud,
        rule: CullRule,
        culler: &mut Culler,
    ) -> Result<CullReport> {
        let border = self.mesh(width, cloud);
        let report = culler.cull_mesh(cloud, rule, border.into_iter())?;
        cloud.normals = normals(cloud);
        Ok(report)
    }

    /// Fills the cloud's triangles with those between neighbouring pixels, and returns the points that have a side without one. The cloud
    /// must be that of the last [triangulation](Self::triangulate).
    fn mesh(&self, width: usize, cloud: &mut PointCloud) -> Vec<u32> {
        cloud.triangles.clear();
        if width < 2 || self.point_of.len() < 2 * width {
            return (0..cloud.points.len() as u32).collect();
        }
        // Each triangle fills part of the angle about its corners.
        let mut angle = vec![0_u8; cloud.points.len()];
        for (above, below) in
            self.point_of.chunks_exact(width).zip(self.point_of[width..].chunks_exact(width))
        {
            for (a, b) in above.windows(2).zip(below.windows(2)) {
                // Counter-clockwise as the camera sees it: left, down, right, up.
                let corners = [a[0], b[0], b[1], a[1]];
                let mut add = |[i, j, k]: [usize; 3]| {
                    cloud.triangles.push([i, j, k].map(|i| corners[i]));
                    // The right angle is at the middle one.
                    for (corner, eighths) in [(i, 1), (j, 2), (k, 1)] {
                        angle[corners[corner] as usize] += eighths;
                    }
                };
                match corners.map(|c| c == NONE) {
                    [false, false, false, false] => {
                        let depth = |i: usize| cloud.points[corners[i] as usize].position.z;
                        if (depth(0) - depth(2)).abs() <= (depth(1) - depth(3)).abs() {
                            add([0, 1, 2]);
                            add([2, 3, 0]);
                        } else {
                            add([3, 0, 1]);
                            add([1, 2, 3]);
                        }
                    }
                    [false, false, false, true] => add([0, 1, 2]),
                    [false, false, true, false] => add([3, 0, 1]),
                    [false, true, false, false] => add([2, 3, 0]),
                    [true, false, false, false] => add([1, 2, 3]),
                    _ => {}
                }
            }
        }
        angle.iter().enumerate().filter(|(_, a)| **a < 8).map(|(i, _)| i as u32).collect()
    }
}

/// The normals of a cloud's points, towards the camera: the sum of those of their triangles, each as long as its area. Zero for points
/// without triangles.
fn normals(cloud: &PointCloud) -> Vec<Vector3<f32>> {
    let mut sums = vec![Vector3::<f32>::zeros(); cloud.points.len()];
    for triangle in &cloud.triangles {
        let [a, b, c] = triangle.map(|i| cloud.points[i as usize].position);
        let normal = (b - a).cross(&(c - a)).cast::<f32>();
        for i in triangle {
            sums[*i as usize] += normal;
        }
    }
    for sum in &mut sums {
        *sum = sum.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
    }
    sums
}
