//! Ray tracing of a rig and its surfaces: what a camera's ray meets, and which light of the projector falls there.

use std::sync::Arc;

use nalgebra::{Point2, Point3, Vector2, Vector3};

use super::channel_offset::ChannelOffset;
use super::surface::Surface;
use super::truth::{StoredTruth, Truth};
use crate::error::Result;
use crate::geometry::{Camera, Plane, Pose, Ray};
use crate::rig::{Projector, Rig};

/// A shadow ray ends this share of its length before the point, which would otherwise shade itself by rounding.
const OWN_SHADOW: f64 = 1e-7;
/// Largest error of undistorting and distorting again, normalised coordinates: far below any pixel, far above rounding.
/// Beyond the fold of the lens's model the result is elsewhere.
const SAME_RAY: f64 = 1e-6;

/// Camera, projector and surfaces, for one channel of the light.
#[derive(Clone)]
pub(super) struct RayTracer {
    pub(super) camera: Camera,
    pub(super) projector: Camera,
    pub(super) projector_from_camera: Pose,
    /// The projector's centre in the camera's frame.
    pub(super) lamp: Point3<f64>,
    pub(super) surfaces: Arc<[Surface]>,
    /// Where the channel lies; `None`: where the rig has it.
    offset: Option<ChannelOffset>,
}

/// The intersection of a camera's ray with a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct CameraHit {
    pub(super) point: Point3<f64>,
    /// Not normalised, of either sign.
    pub(super) normal: Vector3<f64>,
    pub(super) surface: usize,
    /// The panel position whose light falls there.
    pub(super) panel: Option<Point2<f64>>,
}

impl RayTracer {
    pub(super) fn new(rig: &Rig, surfaces: &[Surface]) -> Result<Self> {
        let Projector { device, from_camera, .. } = rig.require_projector()?;
        surfaces.iter().try_for_each(Surface::validate)?;
        let projector_from_camera = from_camera.pose;
        Ok(Self {
            camera: rig.camera.model,
            projector: device.model,
            projector_from_camera,
            lamp: projector_from_camera.centre(),
            surfaces: surfaces.into(),
            offset: None,
        })
    }

    /// The same for a channel that lies elsewhere.
    pub(super) fn shifted(&self, offset: ChannelOffset) -> Self {
        Self { offset: Some(offset), ..self.clone() }
    }

    /// The direction of a pixel position's ray.
    fn bearing(&self, p: Point2<f64>) -> Option<Vector3<f64>> {
        let centre = self.camera.intrinsics.principal_point();
        self.camera.bearing(self.offset.map_or(p, |o| o.green_position(p, centre)))
    }

    /// The nearest surface on a ray: its index, the distance in lengths of the direction, the normal.
    pub(super) fn nearest(&self, ray: &Ray) -> Option<(usize, f64, Vector3<f64>)> {
        let mut best: Option<(usize, f64, Vector3<f64>)> = None;
        for (i, surface) in self.surfaces.iter().enumerate() {
            let limit = best.map_or(f64::INFINITY, |b| b.1);
            if let Some(hit) = surface.meet(ray, [0.0, limit]) {
                best = Some((i, hit.distance, hit.normal));
            }
        }
        best
    }

    /// The intersection of the ray of a pixel position.
    pub(super) fn trace(&self, p: Point2<f64>) -> Option<CameraHit> {
        let ray = Ray { origin: Point3::origin(), direction: self.bearing(p)? };
        let (surface, distance, normal) = self.nearest(&ray)?;
        let point = ray.origin + ray.direction * distance;
        let same_side = normal.dot(&(self.lamp - point)) * normal.dot(&-point.coords) > 0.0;
        let panel = if same_side { self.panel(&point).filter(|_| !self.shaded(&point)) } else { None };
        Some(CameraHit { point, normal, surface, panel })
    }

    /// The panel position whose light reaches a point; `None` outside the panel.
    pub(super) fn panel(&self, point: &Point3<f64>) -> Option<Point2<f64>> {
        let local = self.projector_from_camera.transform(point);
        let q = self.projector.project(&local)?;
        let shown = self.offset.map_or(q, |o| o.panel_position(q));
        let inside = |v: f64, n: u32| v >= -0.5 && v <= f64::from(n) - 0.5;
        if !(inside(shown.x, self.projector.width) && inside(shown.y, self.projector.height)) {
            return None;
        }
        if !self.projector.distortion.is_none() {
            let back = self.projector.undistort(q)?;
            let ideal = Vector2::new(local.x / local.z, local.y / local.z);
            return ((back - ideal).norm() <= SAME_RAY * (1.0 + ideal.norm())).then_some(shown);
        }
        Some(shown)
    }

    fn shaded(&self, point: &Point3<f64>) -> bool {
        let ray = Ray { origin: self.lamp, direction: point - self.lamp };
        self.surfaces.iter().any(|s| s.meet(&ray, [0.0, 1.0 - OWN_SHADOW]).is_some())
    }

    /// Cosine of the angle at which the projector's light falls in over the square of its way, 1/mm².
    pub(super) fn irradiance(&self, hit: &CameraHit) -> f64 {
        let way = self.lamp - hit.point;
        let (d2, n) = (way.norm_squared(), hit.normal.norm());
        let e = hit.normal.dot(&way).abs() / (n * d2 * d2.sqrt());
        if e.is_finite() { e } else { 0.0 }
    }

    /// Change of the panel position for a step of `step` camera pixels along x and along y on the surface's tangent
    /// plane.
    pub(super) fn slope(&self, p: Point2<f64>, hit: &CameraHit, step: f64) -> Option<[Vector2<f64>; 2]> {
        let tangent = Plane::from_point_normal(&hit.point, hit.normal)?;
        let at = |offset: Vector2<f64>| {
            let ray = Ray { origin: Point3::origin(), direction: self.bearing(p + offset)? };
            self.projector.project(&self.projector_from_camera.transform(&ray.meet(&tangent)?))
        };
        let half = step / 2.0;
        let [x, y] = [Vector2::new(half, 0.0), Vector2::new(0.0, half)];
        Some([at(x)? - at(-x)?, at(y)? - at(-y)?])
    }

    /// The truth of all pixels.
    pub(super) fn picture(&self) -> Truth {
        let (width, height) = (self.camera.width as usize, self.camera.height as usize);
        let mut pixels = Vec::with_capacity(width * height);
        for y in 0..height {
            pixels.extend((0..width).map(|x| self.pixel(x, y)));
        }
        Truth { width, height, pixels }
    }

    /// The truth of a pixel.
    fn pixel(&self, x: usize, y: usize) -> StoredTruth {
        let Some(hit) = self.trace(Point2::new(x as f64, y as f64)) else { return StoredTruth::EMPTY };
        StoredTruth {
            point: hit.point.into(),
            panel: hit.panel.map_or([f64::NAN; 2], Into::into),
            irradiance: if hit.panel.is_some() { self.irradiance(&hit) as f32 } else { 0.0 },
            surface: hit.surface as u32,
        }
    }
}
