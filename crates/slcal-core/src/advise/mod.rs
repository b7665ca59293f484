//! Which photograph to take next: σ of the focal lengths over a grid of tilts, and the pose that lowers it most.

mod advice;
mod pose_search;
mod predicted_covariance;
mod report_json;

use nalgebra::{DMatrix, Point3, Rotation3, Vector3};
use serde::{Deserialize, Serialize};

use self::pose_search::{Stand, angles, posed};
use self::predicted_covariance::Knowledge;
use crate::calibrate::CalibrateConfig;
use crate::error::{Error, Result};
use crate::estimate::covariance::UNINFORMATIVE;
use crate::estimate::expected_view::ExpectedSheet;
use crate::estimate::unknowns::SHARED;
use crate::estimate::{ExpectedView, Model, Priors, Sheet, Unknowns};
use crate::geometry::{Camera, Pose, RectangleSize};
use crate::pattern::CheckerPattern;
use crate::rig::Rig;

pub use self::advice::{Advice, NextView, TiltPrediction};
pub use self::predicted_covariance::Predicted;

/// The pattern takes at most this part of the sheet when it is planned without a rig.
const PATTERN_SHARE: f64 = 0.7;
/// The projector's distance from the camera when it is planned without a rig, in distances of the sheet.
const BASELINE_SHARE: f64 = 0.25;
/// Share of the frame's width or height that the sheet fills when no distance is given.
const FILLED: f64 = 0.6;

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
    /// The configuration of the calibration.
    pub config: CalibrateConfig,
}

/// What one more photograph would bring to a rig, and which: the rig's covariance is what is known, the sheet is that of its
/// first view, and the noise is that of its views. `pattern` is the checkerboard that will be projected
/// (default: the one that `slcal pattern checker` draws); the projector stays as it is, so that the sheet is moved under
/// its pattern.
///
/// # Errors
/// [`Error::Invalid`] for a rig without views or covariance, or a pattern for another panel.
///
/// # Examples
/// ```
/// # let checker = slcal_core::CheckerPattern::new([1024, 768], &Default::default())?;
/// # let sheet = image::open(concat!(env!("CARGO_MANIFEST_DIR"), "/../slcal-cli/demo/sheet.jpg"))?;
/// # let mut calibrator = slcal_core::Calibrator::new("594x420mm".parse()?).with_pattern(&checker);
/// # calibrator.add(slcal_core::PhotoView::try_from(&sheet)?)?;
/// # let rig = calibrator.calibrate()?.rig;
/// use slcal_core::advise::advise_next;
///
/// let advice = advise_next(&rig, None)?;
/// let (now, next) = (advice.now.unwrap(), advice.next.unwrap());
/// // A second photograph in the advised pose makes the rig far better.
/// assert!(next.after.worst_focal() < 0.7 * now.worst_focal());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn advise_next(rig: &Rig, pattern: Option<&CheckerPattern>) -> Result<Advice> {
    let knowledge = Knowledge::of_rig(rig, pattern)?;
    let pose = &knowledge.model.views[0].pose;
    let middle = pose.lift(knowledge.view.size.centre());
    let stand = Stand {
        distance_mm: middle.coords.norm(),
        roll: angles(pose)[2],
        offset: [0.0; 2],
        towards: middle.coords.normalize(),
    };
    Ok(knowledge.advise(&stand, Some(knowledge.now(pose))))
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
    let [w, h] = plan.camera.size().map(f64::from);
    let fill = (f * plan.size.width_mm / (FILLED * w)).max(f * plan.size.height_mm / (FILLED * h));
    let distance_mm = plan.distance_mm.unwrap_or(fill);
    let middle = Point3::new(0.0, 0.0, distance_mm);
    let model = Model {
        camera: plan.camera,
        projector: plan.projector,
        projector_from_camera: beside(plan.projector.as_ref(), distance_mm),
        views: vec![Sheet::flat(posed(middle, plan.size, [0.0; 3]), plan.size)],
    };
    let inner = RectangleSize {
        width_mm: plan.size.width_mm * PATTERN_SHARE,
        height_mm: plan.size.height_mm * PATTERN_SHARE,
    };
    let within = |view: &ExpectedView, model: &Model| {
        let smaller = ExpectedView { size: inner, ..view.clone() };
        smaller.holds_pattern(model, &Sheet::flat(posed(middle, inner, [0.0; 3]), inner))
    };
    let factor = known_beforehand(&model, &plan.config);
    let sheet = (plan.size, ExpectedSheet::Corners(1.0));
    let flatness = plan.config.flatness;
    let bend = (!flatness.is_flat()).then(|| flatness.sigmas_mm(plan.size));
    let knowledge = Knowledge::new(model, factor, sheet, bend, None, plan.noise_px, within)?;
    let stand = Stand { distance_mm, roll: 0.0, offset: [0.0; 2], towards: Vector3::z() };
    Ok(knowledge.advise(&stand, None))
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

/// The factor of what a configuration knows before any photograph: its priors, and next to nothing of the rest.
fn known_beforehand(model: &Model, config: &CalibrateConfig) -> DMatrix<f64> {
    let assumptions = config.assumptions();
    let unknowns = Unknowns::new(&assumptions, model.projector.is_some(), 0);
    let all = Unknowns::all(0, false);
    let units = model.units(&all);
    let mut sigma = [0.0; SHARED];
    for i in unknowns.parameters().iter().filter_map(|p| all.position(p)) {
        sigma[i] = UNINFORMATIVE * units[i];
    }
    for p in Priors::new(&assumptions, &unknowns, model).lenses {
        if let Some(i) = all.lens(p.lens, p.parameter) {
            sigma[i] = p.sigma;
        }
    }
    let used: Vec<usize> = (0..SHARED).filter(|&i| sigma[i] > 0.0).collect();
    DMatrix::from_fn(SHARED, used.len(), |i, k| if used[k] == i { sigma[i] } else { 0.0 })
}

#[cfg(test)]
mod tests;
