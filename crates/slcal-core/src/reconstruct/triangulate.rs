//! Triangulation: the intersection of camera rays with light planes of the projector.

// Inlined from match to point; otherwise the compiler passes every intersection through memory.
#![allow(clippy::inline_always)]

use nalgebra::{Point3, Vector2};

use super::camera_ray::{CameraRay, CameraRays};
use super::light_plane::{Hit, ProjectorLight, Rejection};
use super::point_covariance::RigSigma;
use super::sampled_median::{SAMPLE, sampled_median};
use super::triangulate_config::{TriangulateConfig, TriangulateReport};
use crate::cloud::{CloudPoint, Frame, PointCloud};
use crate::error::Result;
use crate::matches::{Match, Matches};
use crate::rig::{Projector, Rig};

/// Matches that are processed together. What is carried from match to match never crosses the end of such a part, so
/// that the result does not depend on threads.
const PART: usize = 4096;
/// The rig's share of σ is recomputed for a slit once its crossing has moved by this share of the image's longer side.
const SAME_SHARE: f64 = 1.0 / 128.0;
/// Slits whose last share is cached; patterns have fewer, and others only recompute it more often.
const REMEMBERED: usize = 128;
/// The surface's slope follows from neighbouring slits when those to the left and to the right of a crossing agree to
/// this factor. Otherwise one of them lies on another surface.
const SAME_SLOPE: f64 = 1.5;

/// Intersects every match's camera ray with the light plane of its projector column, row, or both, in the camera's
/// frame. See [`Triangulator`] for many frames.
///
/// # Errors
/// As [`Triangulator::new`].
pub fn triangulate(
    rig: &Rig,
    matches: &Matches,
    config: &TriangulateConfig,
) -> Result<(PointCloud, TriangulateReport)> {
    let mut cloud = PointCloud::default();
    let report = Triangulator::new(rig, *config)?.triangulate(matches, &mut cloud);
    Ok((cloud, report))
}

/// Matches → points with one rig; keeps its buffers.
#[derive(Debug, Clone)]
pub struct Triangulator {
    config: TriangulateConfig,
    rays: CameraRays,
    light: ProjectorLight,
    depth_mm: std::ops::RangeInclusive<f64>,
    rig: Option<RigSigma>,
    /// Whether matches were detected on scanlines, see [`across`].
    on_lines: bool,
    same_px: f64,
    sample: Vec<f64>,
    #[cfg(feature = "rayon")]
    parts: Vec<(Vec<CloudPoint>, TriangulateReport)>,
}

/// The rig's share of a slit's σ where it was last computed.
#[derive(Clone, Copy)]
struct Share {
    at: Vector2<f64>,
    coordinate: f64,
    /// Over depth squared.
    scaled: f64,
}

impl Triangulator {
    /// Precomputes what does not change from frame to frame.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for a rig without a projector or a configuration out of range.
    pub fn new(rig: &Rig, config: TriangulateConfig) -> Result<Self> {
        config.validate()?;
        let Projector { device, from_camera, .. } = rig.require_projector()?;
        let camera = rig.camera.model;
        Ok(Self {
            config,
            rays: CameraRays::new(camera),
            light: ProjectorLight::new(
                device.model,
                from_camera.pose,
                config.min_angle_rad,
                config.panel_margin,
            ),
            depth_mm: config.depth_mm(),
            rig: RigSigma::of(rig),
            on_lines: true,
            same_px: SAME_SHARE * f64::from(camera.width.max(camera.height)),
            sample: Vec::with_capacity(2 * SAMPLE),
            #[cfg(feature = "rayon")]
            parts: Vec::new(),
        })
    }

    /// The same for matches that were not detected on scanlines, whose integer coordinates have no meaning.
    pub(super) fn off_lines(rig: &Rig, config: TriangulateConfig) -> Result<Self> {
        Ok(Self { on_lines: false, ..Self::new(rig, config)? })
    }

    /// Replaces the content of `cloud` by the points of the matches, in the camera's frame and in their order.
    ///
    /// The camera's two equations and the projector's one form a 3×3 linear system per point (paper, eq. 17–19), which
    /// is solved on the ray: a point at depth z on it satisfies the first two. Lens distortion is removed first. That
    /// of the projector takes Newton's method, since it depends on the unknown coordinate. With column and row, the
    /// result is the point on the ray whose projection is nearest to both in projector pixels.
    ///
    /// σ of a point has two parts. The first is the noise of the camera position. It is propagated to the panel by the
    /// derivative of the projector's coordinate along the image, and from there along the ray. The derivative is
    /// measured between neighbouring slits of a scanline; where there are none, it is that of a surface at constant
    /// depth. The second follows from the covariance of the rig's parameters to first order. Without a covariance it is
    /// left out and [`TriangulateReport::rig_sigma_known`] is false.
    pub fn triangulate(&mut self, matches: &Matches, cloud: &mut PointCloud) -> TriangulateReport {
        cloud.frame = Frame::Camera;
        cloud.camera_centre = Point3::origin();
        cloud.triangles.clear();
        cloud.points.clear();
        cloud.points.reserve(matches.items.len());
        let mut report = TriangulateReport::default();
        self.all(&matches.items, &mut cloud.points, &mut report);
        report.points = cloud.points.len();
        report.rig_sigma_known = self.rig.is_some();
        report.median_sigma_mm = sampled_median(&cloud.points, &mut self.sample, |p| p.sigma_mm);
        report.median_noise_mm = sampled_median(&cloud.points, &mut self.sample, |p| p.noise_mm);
        report
    }

    fn all(&mut self, matches: &[Match], points: &mut Vec<CloudPoint>, report: &mut TriangulateReport) {
        #[cfg(feature = "rayon")]
        if self.config.parallel {
            return self.in_threads(matches, points, report);
        }
        for start in (0..matches.len()).step_by(PART) {
            self.part(matches, start, points, report);
        }
    }

    #[cfg(feature = "rayon")]
    fn in_threads(
        &mut self,
        matches: &[Match],
        points: &mut Vec<CloudPoint>,
        report: &mut TriangulateReport,
    ) {
        use rayon::prelude::*;
        let mut parts = std::mem::take(&mut self.parts);
        parts.resize_with(matches.len().div_ceil(PART), Default::default);
        parts.par_iter_mut().enumerate().for_each(|(i, (points, report))| {
            points.clear();
            *report = TriangulateReport::default();
            self.part(matches, i * PART, points, report);
        });
        for (of_part, count) in &parts {
            points.extend_from_slice(of_part);
            report.add(count);
        }
        self.parts = parts;
    }

    /// Appends the points of the matches from `start` on, [`PART`] at most.
    fn part(
        &self,
        matches: &[Match],
        start: usize,
        points: &mut Vec<CloudPoint>,
        report: &mut TriangulateReport,
    ) {
        let nowhere = Share { at: Vector2::new(f64::INFINITY, 0.0), coordinate: f64::NAN, scaled: f64::NAN };
        let mut shares = [nowhere; REMEMBERED];
        for i in start..matches.len().min(start + PART) {
            match self.point(matches, i, &mut shares) {
                Ok(p) => points.push(p),
                Err(rejection) => report.count(rejection),
            }
        }
    }

    #[inline(always)]
    fn point(
        &self,
        matches: &[Match],
        i: usize,
        shares: &mut [Share; REMEMBERED],
    ) -> std::result::Result<CloudPoint, Rejection> {
        let m = &matches[i];
        let wanted = [m.projector_column, m.projector_row];
        let known = wanted.iter().flatten();
        if !(m.camera.x.is_finite() && m.camera.y.is_finite() && known.clone().all(|c| c.is_finite()))
            || known.count() == 0
            || !(m.sigma_px.is_finite() && m.sigma_px >= 0.0)
        {
            return Err(Rejection::Invalid);
        }
        let ray = self.rays.of(m.camera, &self.light.pose.rotation).ok_or(Rejection::Invalid)?;
        let hit = self.light.meet(&ray.in_projector, wanted)?;
        let z = 1.0 / hit.inverse_depth;
        if !self.depth_mm.contains(&z) {
            return Err(Rejection::OutsideDepth);
        }
        let noise_mm = self.noise(matches, i, &ray, &hit) * z * z;
        let of_rig = self.rig_share(m, &ray, &hit, shares) * z * z;
        let sigma_mm = (noise_mm * noise_mm + of_rig * of_rig).sqrt();
        let position = Point3::from(ray.bearing * z);
        if !(sigma_mm.is_finite() && z.is_finite()) {
            return Err(Rejection::Grazing);
        }
        let confidence = if m.confidence.is_finite() { m.confidence } else { 0.0 };
        Ok(CloudPoint {
            position,
            pixel: m.camera,
            color: m.color,
            sigma_mm,
            noise_mm,
            slit: m.slit,
            confidence,
        })
    }

    /// 1σ along the ray from the noise of the match over the square of the depth, 1/mm.
    #[inline(always)]
    fn noise(&self, matches: &[Match], i: usize, ray: &CameraRay, hit: &Hit) -> f64 {
        let m = &matches[i];
        let rotation = self.light.pose.rotation.matrix();
        let mut variance = 0.0;
        for c in hit.coordinates() {
            // At constant depth, by either image coordinate, px per px.
            let facing = |k: usize| {
                let step = ray.by_pixel.column(k);
                c.h.dot(&(rotation.column(0) * step.x + rotation.column(1) * step.y)) / hit.depth_ratio
            };
            let across = if self.on_lines { across(m, facing) } else { faster(facing) };
            let slope = surface_slope(matches, i, c.axis, across).unwrap_or_else(|| facing(across));
            let on_panel = (slope * m.sigma_px).powi(2) + self.config.projector_sigma_px.powi(2);
            variance += on_panel * c.gain.powi(2);
        }
        (variance * ray.squared_length).sqrt()
    }

    /// 1σ along the ray from the rig over the square of the depth, 1/mm. It changes little along a slit, whose light is
    /// (nearly) a plane: the last value is used where it was computed close by.
    #[inline(always)]
    fn rig_share(&self, m: &Match, ray: &CameraRay, hit: &Hit, shares: &mut [Share; REMEMBERED]) -> f64 {
        let Some(rig) = &self.rig else { return 0.0 };
        let exact = || {
            rig.along_ray(&self.rays.camera, &self.light, ray, hit) * (hit.inverse_depth * hit.inverse_depth)
        };
        let (Some(slit), Some(coordinate), 1) =
            (m.slit, m.projector_column.or(m.projector_row), hit.coordinates().count())
        else {
            return exact();
        };
        let last = &mut shares[usize::from(slit) % REMEMBERED];
        let moved = (m.camera.coords - last.at).amax();
        if last.coordinate.to_bits() != coordinate.to_bits() || moved > self.same_px {
            *last = Share { at: m.camera.coords, coordinate, scaled: exact() };
        }
        last.scaled
    }
}

/// The image coordinate that was measured. Stripes are detected on scanlines, so that the other one is an integer.
/// Where both are or neither is, it is the one by which the panel's coordinate changes faster.
#[inline(always)]
fn across(m: &Match, facing: impl Fn(usize) -> f64) -> usize {
    // By casts, which need no library call where `fract` does.
    let whole = |x: f64| x as i64 as f64 == x;
    match (whole(m.camera.x), whole(m.camera.y)) {
        (false, true) => 0,
        (true, false) => 1,
        _ => faster(facing),
    }
}

/// The image coordinate by which the panel's coordinate changes faster.
#[inline(always)]
fn faster(facing: impl Fn(usize) -> f64) -> usize {
    usize::from(facing(1).abs() > facing(0).abs())
}

/// Derivative of the panel's coordinate along a scanline, px per px, from the neighbouring slits on it.
#[inline(always)]
fn surface_slope(matches: &[Match], i: usize, axis: usize, across: usize) -> Option<f64> {
    let m = &matches[i];
    let coordinate = |m: &Match| if axis == 0 { m.projector_column } else { m.projector_row };
    let (slit, here) = (m.slit?, coordinate(m)?);
    let to = |other: &Match| {
        let same_line = other.camera[1 - across].to_bits() == m.camera[1 - across].to_bits();
        if !(same_line && other.slit?.abs_diff(slit) == 1) {
            return None;
        }
        let step = other.camera[across] - m.camera[across];
        let slope = (coordinate(other)? - here) / step;
        (slope.is_finite() && slope != 0.0).then_some((slope, step.abs()))
    };
    let before = if i > 0 { to(&matches[i - 1]) } else { None };
    let after = if i + 1 < matches.len() { to(&matches[i + 1]) } else { None };
    match (before, after) {
        (Some((a, da)), Some((b, db)))
            if a * b > 0.0 && a * a <= SAME_SLOPE * a * b && b * b <= SAME_SLOPE * a * b =>
        {
            // The derivative of the parabola through all three at the middle one.
            Some((a * db + b * da) / (da + db))
        }
        (Some(_), Some(_)) => None,
        (one, other) => one.or(other).map(|(slope, _)| slope),
    }
}
