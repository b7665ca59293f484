//! A rig in given poses of its sheet, and the observations of its camera.

use nalgebra::{Point2, Point3, Vector3};
use serde::{Deserialize, Serialize};

use super::bent_sheet::BentSheet;
use super::draws::Draws;
use super::poses::PoseConfig;
use super::rig_config::RigConfig;
use crate::error::{Error, ErrorSubject, Result, within};
use crate::geometry::{Camera, Pose, Ray, RectangleSize};
use crate::observations::{CornerPair, EdgePoint, Observations, SheetObservation, ViewObservation};
use crate::rig::{Device, Projector, Rig, View};

/// Stated σ of observations without noise: small beside all real noise, large beside rounding.
const SMALLEST_SIGMA_PX: f64 = 1e-6;
/// Largest noise, px: beyond it nothing is measured.
const MOST_NOISE_PX: f64 = 1000.0;
/// Squares that do not fit on the sheet are reduced by this factor.
const SMALLER: f64 = 0.9;
/// Largest number of edge points per side.
const MOST_EDGE_POINTS: usize = 10_000;

/// Gaussian noise of the camera's observations; the projector's pixels are exact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NoiseModel {
    /// 1σ of the sheet's corners (each coordinate) or edge points, camera px; default 0.2.
    pub sheet_px: f64,
    /// 1σ of each coordinate of the projected corners, camera px; default 0.1.
    pub pattern_px: f64,
    /// Edge points per side instead of the four corners; default `None`.
    pub edge_points: Option<usize>,
}

impl Default for NoiseModel {
    fn default() -> Self {
        Self { sheet_px: 0.2, pattern_px: 0.1, edge_points: None }
    }
}

impl NoiseModel {
    /// The same noise on the sheet's corners and on the projected ones.
    #[must_use]
    pub fn uniform(sigma_px: f64) -> Self {
        Self { sheet_px: sigma_px, pattern_px: sigma_px, edge_points: None }
    }

    /// Checks the values.
    ///
    /// # Errors
    /// [`Error::Invalid`] for negative or implausibly large numbers.
    pub fn validate(&self) -> Result<()> {
        for (name, sigma) in
            [("noise of the sheet", self.sheet_px), ("noise of the pattern", self.pattern_px)]
        {
            within(name, sigma, [0.0, MOST_NOISE_PX], " px")?;
        }
        self.edge_points.map_or(Ok(()), |n| within("edge points per side", n, [2, MOST_EDGE_POINTS], ""))
    }

    fn stated(sigma_px: f64) -> f64 {
        sigma_px.max(SMALLEST_SIGMA_PX)
    }
}

/// The ground truth: a rig, its sheet, and the poses of the sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The camera.
    pub camera: Camera,
    /// The projector, with its distortion.
    pub projector: Camera,
    /// The pose between them.
    pub projector_from_camera: Pose,
    /// The sheet.
    pub size: RectangleSize,
    /// Its shape where it is bent.
    pub bent: Option<BentSheet>,
    /// Side of the pattern's squares, projector px.
    pub square_px: f64,
    /// The projected points, projector px.
    pub pattern: Vec<Point2<f64>>,
    /// camera ← sheet, one per view.
    pub views: Vec<Pose>,
}

/// The point of the sheet that projector pixel `q` illuminates, in the camera frame; `None` when its ray misses the
/// plane.
pub(super) fn lit_point(
    projector: &Camera,
    projector_from_camera: &Pose,
    camera_from_sheet: &Pose,
    q: Point2<f64>,
) -> Option<Point3<f64>> {
    let centre = projector_from_camera.centre();
    let ray = projector_from_camera.rotation.inverse() * projector.bearing(q)?;
    let normal = camera_from_sheet.rotation * Vector3::z();
    let s = normal.dot(&(camera_from_sheet.translation - centre.coords)) / normal.dot(&ray);
    (s > 0.0 && s.is_finite()).then(|| centre + ray * s)
}

impl Scene {
    /// Whether the sheet is flat, the lenses do not distort and pixels are square.
    pub(super) fn is_ideal(&self) -> bool {
        let devices = [&self.camera, &self.projector];
        self.bent.is_none()
            && devices.iter().all(|d| d.distortion.is_none() && d.intrinsics.fx == d.intrinsics.fy)
    }

    /// The rig with its sheet in these poses. Where the configuration leaves the size of the pattern's squares open,
    /// they are reduced until all corners fall on the sheet in all poses. The camera's picture may truncate the sheet,
    /// see [`outside_picture`](Self::outside_picture).
    ///
    /// # Errors
    /// [`Error::Invalid`] for values out of range, and where part of the sheet lies behind a device or the pattern
    /// beside the sheet.
    pub fn new(rig: &RigConfig, poses: &[PoseConfig]) -> Result<Self> {
        rig.validate()?;
        poses.iter().try_for_each(PoseConfig::validate)?;
        let mut rig = rig.clone();
        let largest = rig.pattern()?.square_px;
        let free = rig.checker.square_px.is_none();
        let mut squares = (0..).map(|i| (largest * SMALLER.powi(i)).floor()).skip(1);
        loop {
            let scene = Self::with_pattern(&rig, poses)?;
            let error = match scene.check_views() {
                Ok(()) => return Ok(scene),
                Err(error) => error,
            };
            rig.checker.square_px = squares.next();
            if !free || rig.pattern().is_err() {
                return Err(error);
            }
        }
    }

    fn with_pattern(rig: &RigConfig, poses: &[PoseConfig]) -> Result<Self> {
        let pattern = rig.pattern()?;
        Ok(Self {
            camera: rig.camera(),
            projector: rig.projector(),
            projector_from_camera: rig.projector_from_camera()?,
            size: rig.size,
            bent: rig.bend.as_ref().map(|b| BentSheet::new(b, rig.size)).transpose()?,
            square_px: pattern.square_px,
            pattern: pattern.inner_corners(),
            views: poses.iter().map(|p| p.camera_from_sheet(rig)).collect(),
        })
    }

    /// The pixel of a point of the sheet in a pose.
    pub(super) fn sheet_pixel(&self, view: &Pose, p: Point2<f64>) -> Option<Point2<f64>> {
        let point = match &self.bent {
            None => view.lift(p),
            Some(bent) => view.transform(&bent.point(p)),
        };
        self.camera.project(&point)
    }

    /// The point that projector pixel `q` illuminates, in the camera frame; `None` beside a bent sheet, and when its ray
    /// misses the plane of a flat one.
    pub(super) fn lit(&self, view: &Pose, q: Point2<f64>) -> Option<Point3<f64>> {
        let Some(bent) = &self.bent else {
            return lit_point(&self.projector, &self.projector_from_camera, view, q);
        };
        let projector_from_sheet = self.projector_from_camera.compose(view);
        let direction = projector_from_sheet.rotation.inverse() * self.projector.bearing(q)?;
        let ray = Ray { origin: projector_from_sheet.centre(), direction };
        let hit = bent.meet(&ray, [0.0, f64::INFINITY])?;
        Some(view.transform(&(ray.origin + ray.direction * hit.distance)))
    }

    /// Checks that every view has the sheet in front of the camera and the whole pattern on it.
    fn check_views(&self) -> Result<()> {
        for view in &self.views {
            if self.size.corners().iter().any(|c| self.sheet_pixel(view, *c).is_none()) {
                return Err(Error::invalid(
                    "the sheet",
                    "all of it in front of the camera (a smaller or more distant one, or less tilt)",
                    "a corner behind the camera",
                ));
            }
            let on_sheet = |q: &&Point2<f64>| {
                if self.bent.is_some() {
                    return self.lit(view, **q).is_some();
                }
                let place = self.lit(view, **q).map(|p| view.inverse().transform(&p));
                place.is_some_and(|p| {
                    (0.0..=self.size.width_mm).contains(&p.x) && (0.0..=self.size.height_mm).contains(&p.y)
                })
            };
            let missed = self.pattern.len() - self.pattern.iter().filter(on_sheet).count();
            if missed > 0 {
                return Err(Error::invalid(
                    "the projected pattern",
                    "all corners on the sheet (a larger or nearer sheet, less tilt, a longer focal length of the \
                     projector)",
                    format!(
                        "{missed} of {} beside it with squares of {} px",
                        self.pattern.len(),
                        self.square_px
                    ),
                ));
            }
        }
        Ok(())
    }

    /// Number of corners of the sheet and projected corners, over all views, outside the camera's picture. A photograph
    /// shows the former through the sides that meet there, and the latter not at all.
    #[must_use]
    pub fn outside_picture(&self) -> usize {
        let [w, h] = [self.camera.width, self.camera.height].map(f64::from);
        let inside = |p: &Point2<f64>| (-0.5..=w - 0.5).contains(&p.x) && (-0.5..=h - 0.5).contains(&p.y);
        let of_view = |view: &Pose| {
            let sheet = self.size.corners().map(|c| self.sheet_pixel(view, c));
            let pattern =
                self.pattern.iter().map(|q| self.lit(view, *q).and_then(|p| self.camera.project(&p)));
            sheet.into_iter().chain(pattern).filter(|p| !p.as_ref().is_some_and(inside)).count()
        };
        self.views.iter().map(of_view).sum()
    }

    /// The camera's observations with noise from `draws`; their photographs are called "simulated 1" and so on. Every point states its noise, or 1e-6 px where it is zero.
    ///
    /// # Errors
    /// [`Error::Invalid`] for noise out of range, or own poses that put something behind a device.
    pub fn observe(&self, noise: &NoiseModel, draws: &mut Draws) -> Result<Observations> {
        noise.validate()?;
        let behind = || {
            Error::invalid(
                ErrorSubject::Pose,
                "sheet and pattern in front of both devices",
                "a point behind one",
            )
        };
        let mut views = Vec::with_capacity(self.views.len());
        for (i, view) in self.views.iter().enumerate() {
            let sheet = self.observe_sheet(view, noise, draws).ok_or_else(behind)?;
            let mut pairs = Vec::with_capacity(self.pattern.len());
            for &q in &self.pattern {
                let seen = self.lit(view, q).and_then(|p| self.camera.project(&p)).ok_or_else(behind)?;
                pairs.push(CornerPair {
                    camera: seen + draws.jitter(noise.pattern_px),
                    projector: q,
                    sigma_px: Some(NoiseModel::stated(noise.pattern_px)),
                });
            }
            views.push(ViewObservation {
                photo: Some(format!("simulated {}", i + 1)),
                size: self.size,
                sheet,
                pairs,
                panel_points: Vec::new(),
                channel_offsets: Vec::new(),
            });
        }
        Ok(Observations {
            camera: [self.camera.width, self.camera.height],
            projector: Some([self.projector.width, self.projector.height]),
            mirrored: false,
            views,
        })
    }

    fn observe_sheet(&self, view: &Pose, noise: &NoiseModel, draws: &mut Draws) -> Option<SheetObservation> {
        let corners = self.size.corners();
        let sigma_px = Some(NoiseModel::stated(noise.sheet_px));
        let Some(n) = noise.edge_points else {
            let mut seen = corners;
            for c in &mut seen {
                *c = self.sheet_pixel(view, *c)? + draws.jitter(noise.sheet_px);
            }
            return Some(SheetObservation::Corners { corners: seen, sigma_px });
        };
        let mut sides: [Vec<EdgePoint>; 4] = Default::default();
        for (i, side) in sides.iter_mut().enumerate() {
            let (a, b) = (corners[i], corners[(i + 1) % 4]);
            for k in 0..n {
                let p = a + (b - a) * ((k as f64 + 0.5) / n as f64);
                let position = self.sheet_pixel(view, p)? + draws.jitter(noise.sheet_px);
                side.push(EdgePoint { position, sigma_px });
            }
        }
        Some(SheetObservation::Edges(sides))
    }

    /// The true rig, with the poses as its views.
    #[must_use]
    pub fn rig(&self) -> Rig {
        let device = |model| Device { model, sigma: None };
        let views = self.views.iter().map(|view| {
            let projector_from_sheet = self.projector_from_camera.compose(view);
            let corners = self.size.corners();
            View {
                photo: None,
                size: self.size,
                camera_from_sheet: *view,
                bend: None,
                projector_from_sheet: Some(projector_from_sheet),
                camera_vanishing_points: self.camera.vanishing_points(view),
                projector_vanishing_points: Some(self.projector.vanishing_points(&projector_from_sheet)),
                corners_px: corners.map(|c| self.sheet_pixel(view, c).unwrap_or(Point2::origin())),
                rms_px: None,
                clipped_percent: None,
            }
        });
        Rig {
            camera: device(self.camera),
            projector: Some(Projector {
                device: device(self.projector),
                from_camera: self.projector_from_camera.into(),
                mirrored: false,
            }),
            views: views.collect(),
            method: "truth".into(),
            quality: None,
            covariance: None,
            channel_registration: None,
        }
    }
}
