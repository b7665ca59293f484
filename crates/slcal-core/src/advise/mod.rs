//! Which photograph to take next: σ of the focal lengths over a grid of tilts, and the pose that lowers it most.

pub(crate) mod advice;
pub(crate) mod outlook;
pub(crate) mod predict;
mod report_json;
pub(crate) mod shared;

use nalgebra::{DMatrix, Point2, Point3, Rotation3, Unit, Vector3};
use serde::{Deserialize, Serialize};

pub use self::outlook::Predicted;
use self::outlook::{Outlook, centre};
use self::shared::{PROJECTOR, SHARED, STEREO};
use crate::calibrate::config::CalibrateConfig;
use crate::error::{Error, ErrorSubject, Result};
use crate::estimate::model::{Layout, Model, priors};
use crate::estimate::residual::LENS;
use crate::geometry::{Camera, Pose, RectangleSize};
use crate::pattern::{CheckerConfig, CheckerPattern};
use crate::rig::Rig;

/// Tilts of the table about either axis, degrees: beyond 40° squares shrink and sheets leave the frame.
const TILTS_DEG: [f64; 9] = [-40.0, -30.0, -20.0, -10.0, 0.0, 10.0, 20.0, 30.0, 40.0];
/// The best tilt of the table is refined by steps of this size, degrees; nobody turns a sheet more exactly.
const FINE_DEG: f64 = 5.0;
/// Distances that are tried, relative to the sheet's.
const DISTANCES: [f64; 3] = [1.0, 0.8, 1.25];
/// Places that are tried, in parts of the sheet's width and height by which its middle moves away from the pattern's, or,
/// with the camera alone, by which the sheet moves across the frame.
const OFFSETS: [f64; 3] = [0.0, -0.15, 0.15];
/// A pose that differs in more than its tilt must bring σ below this part of what tilt alone does.
const WORTH_THE_TROUBLE: f64 = 0.85;
/// Another photograph is worth it when it brings the worst σ below this part of itself.
const WORTH_ANOTHER: f64 = 0.8;
/// σ of the focal lengths below which nothing more is worth it: a millimetre in a metre.
const GOOD_ENOUGH: f64 = 0.001;
/// 1σ that stands in for "no information", in natural units, as in the calibration itself.
const VAGUE: f64 = 10.0;
/// The pattern takes at most this part of the sheet when it is planned without a rig.
const PATTERN_SHARE: f64 = 0.7;
/// The projector's distance from the camera when it is planned without a rig, in distances of the sheet.
const BASELINE_SHARE: f64 = 0.25;
/// Share of the frame's width or height that the sheet fills when no distance is given.
const FILLED: f64 = 0.6;

/// A tilt with what a photograph under it would bring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TiltForecast {
    /// Turn about the camera's horizontal axis, rad; positive: the top side is nearer to the camera than the bottom.
    pub tilt_x_rad: f64,
    /// Turn about its vertical axis, rad; positive: the right side is nearer to the camera than the left.
    pub tilt_y_rad: f64,
    /// σ after one photograph; `None` where the sheet would leave the frame or the pattern the sheet, or be seen too flat.
    pub one: Option<Predicted>,
    /// σ after a second one with the tilt reversed as well.
    pub pair: Option<Predicted>,
}

/// A pose of the sheet to photograph.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NextView {
    /// X_camera = R · X_sheet + t.
    pub camera_from_sheet: Pose,
    /// As in [`TiltForecast`].
    pub tilt_x_rad: f64,
    /// As in [`TiltForecast`].
    pub tilt_y_rad: f64,
    /// From the camera to the sheet's middle, mm.
    pub distance_mm: f64,
    /// Where the sheet's middle is seen, px.
    pub centre_px: Point2<f64>,
    /// What is known after it (with a second photograph, its tilt reversed, when it is the first one).
    pub after: Predicted,
}

impl NextView {
    /// How to hold the sheet, for a person: which side is nearer to the camera, by what angle and by how much. Sides are as
    /// the photograph shows them.
    #[must_use]
    pub fn in_words(&self, size: RectangleSize) -> String {
        let part = |angle: f64, positive: [&str; 2], length: f64, axis: &str| {
            let degrees = angle.to_degrees().round();
            if degrees == 0.0 {
                return None;
            }
            let [near, far] = if degrees > 0.0 { positive } else { [positive[1], positive[0]] };
            Some(format!(
                "its {near} side nearer to the camera than its {far} side by {:.0} mm (a tilt of {:.0}° about its {axis} axis)",
                length * angle.sin().abs(),
                degrees.abs()
            ))
        };
        let parts: Vec<String> = [
            part(self.tilt_y_rad, ["right", "left"], size.width_mm * self.tilt_x_rad.cos(), "vertical"),
            part(self.tilt_x_rad, ["top", "bottom"], size.height_mm, "horizontal"),
        ]
        .into_iter()
        .flatten()
        .collect();
        let held =
            if parts.is_empty() { "face-on".to_owned() } else { format!("with {}", parts.join(" and ")) };
        format!(
            "hold the sheet {held}, its middle {:.0} mm from the camera and at ({:.0}, {:.0}) px of the photograph",
            self.distance_mm, self.centre_px.x, self.centre_px.y
        )
    }
}

/// What to do next.
#[derive(Debug, Clone, PartialEq)]
pub struct Advice {
    /// What is known now; `None` before the first photograph.
    pub now: Option<Predicted>,
    /// The sheet.
    pub size: RectangleSize,
    /// From the camera to its middle in the table, mm.
    pub distance_mm: f64,
    /// σ of the sheet's measurement (per corner, or per eighth of a side) and of a projected corner that was counted with, px.
    pub noise_px: [f64; 2],
    /// Row by row: one tilt about the horizontal axis each, all tilts about the vertical axis in it.
    pub table: Vec<TiltForecast>,
    /// The best pose that is possible; `None` when no pose is.
    pub next: Option<NextView>,
    /// Whether it is worth taking.
    pub worth_it: bool,
}

/// A camera (and projector) as it is roughly known before anything was photographed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CameraPlan {
    /// Size of its image, and its focal length, roughly.
    pub camera: Camera,
    /// The panel and focal length of the projector, roughly; `None` for the camera alone.
    pub projector: Option<Camera>,
    /// The sheet.
    pub size: RectangleSize,
    /// To its middle, mm; `None`: so that it fills 60 % of the frame.
    pub distance_mm: Option<f64>,
    /// σ of each corner of the sheet and of the pattern, px.
    pub noise_px: [f64; 2],
    /// What the calibration will be told.
    pub config: CalibrateConfig,
}

/// R = Rx(a)·Ry(b)·Rz(roll) with the sheet's middle at a point of the camera's frame.
fn posed(middle: Point3<f64>, size: RectangleSize, [a, b, roll]: [f64; 3]) -> Pose {
    let turn = |axis: Unit<Vector3<f64>>, angle| Rotation3::from_axis_angle(&axis, angle);
    let rotation = turn(Vector3::x_axis(), a) * turn(Vector3::y_axis(), b) * turn(Vector3::z_axis(), roll);
    let half = Vector3::new(size.width_mm / 2.0, size.height_mm / 2.0, 0.0);
    Pose { rotation, translation: middle.coords - rotation * half }
}

/// The angles of [`posed`].
fn angles(pose: &Pose) -> [f64; 3] {
    let n = pose.rotation * Vector3::z();
    let (a, b) = ((-n.y).atan2(n.z), n.x.clamp(-1.0, 1.0).asin());
    let rest = (Rotation3::from_axis_angle(&Vector3::x_axis(), a)
        * Rotation3::from_axis_angle(&Vector3::y_axis(), b))
    .inverse()
        * pose.rotation;
    [a, b, rest[(1, 0)].atan2(rest[(0, 0)])]
}

/// Where the sheet stands but for its tilt.
#[derive(Clone, Copy)]
struct Stand {
    distance_mm: f64,
    roll: f64,
    /// In parts of the sheet's width and height.
    offset: [f64; 2],
    /// The direction of its middle, without a projector.
    towards: Vector3<f64>,
}

impl Outlook {
    /// The pose with a tilt. With a projector the pattern stays where it is thrown, and the sheet comes under it.
    fn pose(&self, stand: &Stand, tilt: [f64; 2]) -> Option<Pose> {
        let angles = [tilt[0], tilt[1], stand.roll];
        let place = [stand.offset[0] * self.size.width_mm, stand.offset[1] * self.size.height_mm];
        let (middle, along) = match &self.model.projector {
            Some(projector) => {
                let stereo = &self.model.projector_from_camera;
                let n = self.pattern.len() as f64;
                let q = self.pattern.iter().map(|q| q.coords).sum::<nalgebra::Vector2<f64>>() / n;
                let ray = stereo.rotation.inverse() * projector.bearing(q.into())?.normalize();
                let eye = stereo.centre().coords;
                // |eye + s·ray| = distance, on the far side.
                let (b, c) = (eye.dot(&ray), eye.norm_squared() - stand.distance_mm.powi(2));
                let root = b * b - c;
                if root.is_nan() || root < 0.0 {
                    return None;
                }
                (Point3::from(eye + ray * (root.sqrt() - b)), posed(Point3::origin(), self.size, angles))
            }
            None => (Point3::from(stand.towards * stand.distance_mm), Pose::identity()),
        };
        let shift = along.rotation * Vector3::new(place[0], place[1], 0.0);
        Some(posed(middle + shift, self.size, angles))
    }

    /// The best feasible tilt in a stand, and its σ.
    fn best(&self, stand: &Stand, pair: bool) -> Option<(Pose, Predicted)> {
        let tilts = TILTS_DEG.iter().flat_map(|&a| TILTS_DEG.iter().map(move |&b| [a, b]));
        let coarse = self.best_of(stand, pair, tilts)?;
        let [a, b, _] = angles(&coarse.0).map(f64::to_degrees);
        let near = [-FINE_DEG, 0.0, FINE_DEG];
        let fine = near.iter().flat_map(|&i| near.iter().map(move |&j| [a + i, b + j]));
        self.best_of(stand, pair, fine)
    }

    fn best_of(
        &self,
        stand: &Stand,
        pair: bool,
        tilts: impl Iterator<Item = [f64; 2]>,
    ) -> Option<(Pose, Predicted)> {
        let tried = tilts.filter_map(|tilt| {
            let (pose, one, both) = self.forecast(stand, tilt.map(f64::to_radians))?;
            Some((pose, if pair { both? } else { one }))
        });
        tried.min_by(|a, b| a.1.worst_focal().total_cmp(&b.1.worst_focal()))
    }

    /// A feasible pose with σ after it, and after it and its reverse (when that is feasible).
    fn forecast(&self, stand: &Stand, tilt: [f64; 2]) -> Option<(Pose, Predicted, Option<Predicted>)> {
        let pose = self.pose(stand, tilt).filter(|p| self.feasible(p))?;
        let one = self.predict(&[pose])?;
        let reversed = self.pose(stand, tilt.map(|t| -t)).filter(|p| self.feasible(p));
        Some((pose, one, reversed.and_then(|r| self.predict(&[pose, r]))))
    }

    fn table(&self, stand: &Stand) -> Vec<TiltForecast> {
        let tilts =
            TILTS_DEG.iter().flat_map(|&a| TILTS_DEG.iter().map(move |&b| [a, b].map(f64::to_radians)));
        tilts
            .map(|tilt| {
                let found = self.forecast(stand, tilt);
                TiltForecast {
                    tilt_x_rad: tilt[0],
                    tilt_y_rad: tilt[1],
                    one: found.map(|f| f.1),
                    pair: found.and_then(|f| f.2),
                }
            })
            .collect()
    }

    fn advise(&self, stand: &Stand, now: Option<Predicted>) -> Advice {
        let pair = now.is_none();
        let mut best = self.best(stand, pair);
        for distance in DISTANCES {
            for x in OFFSETS {
                for y in OFFSETS {
                    let moved = Stand { distance_mm: stand.distance_mm * distance, offset: [x, y], ..*stand };
                    let found = self.best(&moved, pair);
                    let sigma =
                        |b: &Option<(Pose, Predicted)>| b.map_or(f64::INFINITY, |b| b.1.worst_focal());
                    if sigma(&found) < WORTH_THE_TROUBLE * sigma(&best) {
                        best = found;
                    }
                }
            }
        }
        let next = best.and_then(|(pose, after)| {
            let [tilt_x_rad, tilt_y_rad, _] = angles(&pose);
            let middle = centre(&pose, self.size);
            let (distance_mm, centre_px) = (middle.coords.norm(), self.model.camera.project(&middle)?);
            let camera_from_sheet = pose;
            Some(NextView { camera_from_sheet, tilt_x_rad, tilt_y_rad, distance_mm, centre_px, after })
        });
        let worth_it = next.is_some_and(|n| {
            now.is_none_or(|now| {
                let worst = now.worst_focal();
                worst > GOOD_ENOUGH && n.after.worst_focal() < WORTH_ANOTHER * worst
            })
        });
        Advice {
            now,
            size: self.size,
            distance_mm: stand.distance_mm,
            noise_px: [self.sheet_sigma_px, self.pattern_sigma_px],
            table: self.table(stand),
            next,
            worth_it,
        }
    }
}

/// What one more photograph would bring to a rig, and which: the rig's covariance is what is known, the sheet is that of its
/// first view, and the noise is taken from what its views told it. `pattern` is the checkerboard that will be projected
/// (default: the one that `slcal pattern checker` draws); the projector stays as it is, so that the sheet is moved under
/// its pattern.
///
/// # Errors
/// [`Error::Invalid`] for a rig without views or covariance, or a pattern for another panel.
pub fn advise_next(rig: &Rig, pattern: Option<&CheckerPattern>) -> Result<Advice> {
    let view = rig.views.first().ok_or_else(|| {
        Error::invalid(ErrorSubject::Rig, "one with the views that it was calibrated from", "none of them")
    })?;
    let mut outlook = outlook_of(rig, pattern)?;
    outlook.learn_noise(rig);
    let middle = centre(&view.camera_from_sheet, view.size);
    let stand = Stand {
        distance_mm: middle.coords.norm(),
        roll: angles(&view.camera_from_sheet)[2],
        offset: [0.0; 2],
        towards: middle.coords.normalize(),
    };
    let covariance = &outlook.root * outlook.root.transpose();
    let now = outlook.predicted(&covariance, &view.camera_from_sheet);
    Ok(outlook.advise(&stand, Some(now)))
}

/// What a rig knows, and what a view of its sheet shows at 1 px of noise.
pub(crate) fn outlook_of(rig: &Rig, pattern: Option<&CheckerPattern>) -> Result<Outlook> {
    let view = rig.views.first().ok_or_else(|| {
        Error::invalid(ErrorSubject::Rig, "one with the views that it was calibrated from", "none of them")
    })?;
    let covariance = shared::covariance_of(rig, 0).ok_or_else(|| {
        let advice =
            "one with a covariance, as calibrate writes it (for a camera from elsewhere give the camera itself)";
        Error::invalid(ErrorSubject::Rig, advice, "none")
    })?;
    let root = shared::root(&covariance);
    let model = Model {
        views: rig.views.iter().map(|v| v.camera_from_sheet).collect(),
        ..shared::model(rig, view.camera_from_sheet)
    };
    let mut outlook = Outlook {
        root,
        size: view.size,
        corners_only: false,
        sheet_sigma_px: 1.0,
        pattern: pattern_of(&model, pattern)?,
        pattern_sigma_px: 1.0,
        model,
    };
    // A default board that is not the one that was projected is made to fit the sheets that held it.
    while pattern.is_none() && !outlook.model.views.iter().all(|v| outlook.holds_pattern(v)) {
        if !shrink(&mut outlook.pattern) {
            break;
        }
    }
    Ok(outlook)
}

/// σ against tilt before anything was photographed, for one photograph and for two with opposite tilts, and the best such
/// pair. The projector, when there is one, is taken to stand a quarter of the distance to the camera's right and to throw
/// a pattern onto the middle of the sheet.
///
/// # Errors
/// [`Error::Invalid`] for numbers that are not finite and positive.
pub fn advise_first(plan: &CameraPlan) -> Result<Advice> {
    plan.config.validate()?;
    RectangleSize::new(plan.size.width_mm, plan.size.height_mm)?;
    let devices = [Some(plan.camera), plan.projector];
    let focal = devices.into_iter().flatten().map(|d| d.intrinsics.fx);
    let given = focal.chain(plan.distance_mm).chain(plan.noise_px);
    for value in given {
        if !(value.is_finite() && value > 0.0) {
            return Err(Error::invalid("focal length, distance or noise", "a positive number", value));
        }
    }
    let f = plan.camera.intrinsics.fx;
    let [w, h] = [plan.camera.width, plan.camera.height].map(f64::from);
    let fill = (f * plan.size.width_mm / (FILLED * w)).max(f * plan.size.height_mm / (FILLED * h));
    let distance_mm = plan.distance_mm.unwrap_or(fill);
    let middle = Point3::new(0.0, 0.0, distance_mm);
    let model = Model {
        camera: plan.camera,
        projector: plan.projector,
        projector_from_camera: beside(plan.projector.as_ref(), distance_mm),
        views: vec![posed(middle, plan.size, [0.0; 3])],
    };
    let pattern = pattern_of(&model, None)?;
    let mut outlook = Outlook {
        root: known_beforehand(&model, &plan.config, distance_mm),
        size: plan.size,
        corners_only: true,
        sheet_sigma_px: plan.noise_px[0],
        pattern,
        pattern_sigma_px: plan.noise_px[1],
        model,
    };
    let inner = RectangleSize {
        width_mm: plan.size.width_mm * PATTERN_SHARE,
        height_mm: plan.size.height_mm * PATTERN_SHARE,
    };
    let smaller =
        |o: &Outlook| Outlook { size: inner, ..o.clone() }.holds_pattern(&posed(middle, inner, [0.0; 3]));
    while plan.projector.is_some() && !smaller(&outlook) {
        if !shrink(&mut outlook.pattern) {
            break;
        }
    }
    let stand = Stand { distance_mm, roll: 0.0, offset: [0.0; 2], towards: Vector3::z() };
    Ok(outlook.advise(&stand, None))
}

/// The inner corners of a checkerboard for a model's projector.
fn pattern_of(model: &Model, pattern: Option<&CheckerPattern>) -> Result<Vec<Point2<f64>>> {
    let Some(projector) = &model.projector else { return Ok(Vec::new()) };
    let panel = [projector.width, projector.height];
    match pattern {
        Some(p) if p.projector != panel => Err(Error::invalid(
            ErrorSubject::Pattern,
            format!("one for the panel of {}x{} px", panel[0], panel[1]),
            format!("one for {}x{} px", p.projector[0], p.projector[1]),
        )),
        Some(p) => Ok(p.inner_corners()),
        None => Ok(CheckerPattern::new(panel, &CheckerConfig::default())?.inner_corners()),
    }
}

/// Brings a board's corners nearer together; false when there is nothing left of it.
fn shrink(pattern: &mut [Point2<f64>]) -> bool {
    let n = pattern.len() as f64;
    let middle = Point2::from(pattern.iter().map(|p| p.coords).sum::<nalgebra::Vector2<f64>>() / n);
    for p in pattern.iter_mut() {
        *p = middle + (*p - middle) * 0.9;
    }
    pattern.iter().any(|p| (p - middle).norm() > 1.0)
}

/// A projector to the camera's right, turned so that the middle of its panel's light falls a distance in front of the camera.
fn beside(projector: Option<&Camera>, distance_mm: f64) -> Pose {
    let Some(projector) = projector else { return Pose::identity() };
    let panel = Camera::image_centre(projector.width, projector.height);
    let eye = Vector3::new(BASELINE_SHARE * distance_mm, 0.0, 0.0);
    let wanted = (Vector3::new(0.0, 0.0, distance_mm) - eye).normalize();
    let thrown = projector.bearing(panel).unwrap_or(Vector3::z());
    let rotation = Rotation3::rotation_between(&wanted, &thrown).unwrap_or_else(Rotation3::identity);
    Pose { rotation, translation: -(rotation * eye) }
}

/// The root of what a configuration knows before any photograph: its priors, and next to nothing of the rest.
fn known_beforehand(model: &Model, config: &CalibrateConfig, distance_mm: f64) -> DMatrix<f64> {
    let with_projector = model.projector.is_some();
    let layout = Layout::new(config, with_projector, 0);
    let mut sigma = [0.0; SHARED];
    for (from, places) in [(0, &layout.camera), (PROJECTOR, &layout.projector)] {
        let width = if from == 0 { model.camera.width } else { model.projector.map_or(1, |p| p.width) };
        for i in (0..LENS).filter(|&i| places[i].is_some()) {
            sigma[from + i] = if i == 1 || i == 2 { VAGUE * f64::from(width) } else { VAGUE };
        }
    }
    for p in priors(config, &layout, model) {
        sigma[if p.of_projector { PROJECTOR } else { 0 } + p.index] = p.sigma;
    }
    if with_projector {
        sigma[STEREO..STEREO + 3].fill(VAGUE);
        sigma[STEREO + 3..].fill(VAGUE * distance_mm);
    }
    let used: Vec<usize> = (0..SHARED).filter(|&i| sigma[i] > 0.0).collect();
    DMatrix::from_fn(SHARED, used.len(), |i, k| if used[k] == i { sigma[i] } else { 0.0 })
}

#[cfg(test)]
mod tests;
