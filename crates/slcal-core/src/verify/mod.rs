//! Rig + photograph of a projected checkerboard → how square it is on the sheet, and whether the rig has moved.
//!
//! [`verify`] fits the photograph under the rig, with the rig's own covariance as what is known beforehand (`fit`), so that
//! an uncertain rig does not cry wolf; once with the rig as it is and once with the projector free. What that gains is χ²
//! distributed when nothing has moved (`moved`). `keystone` measures the projected rectangle on the sheet.

mod change_test;
mod chi_squared_sf;
mod keystone;
mod posterior_fit;
mod report_json;
#[cfg(test)]
mod tests;

use nalgebra::{DMatrix, Point2};
use serde::{Deserialize, Serialize};

use crate::advise::outlook_of;
use crate::advise::shared::{PROJECTOR, SHARED, STEREO, covariance_of, model, root};
use crate::calibrate::CalibrateConfig;
use crate::calibrate::camera_from_sheet as sheet_homography;
use crate::calibrate::{check, pose_from_homography};
use crate::error::{Error, ErrorSubject, Result};
use crate::estimate::measurements;
use crate::estimate::model::Model;
use crate::estimate::residual::lit_point;
use crate::geometry::{Pose, RectangleSize};
use crate::observations::{Observations, ViewObservation};
use crate::rig::{Projector, Rig};

use posterior_fit::{Past, Scene, Weights};

pub use change_test::{Change, RigCheck, SheetCheck};
pub use keystone::{Keystone, Measured};

/// Parameters of [`verify`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct VerifyConfig {
    /// How often a rig that has not moved may be said to have: the level of both tests; default 0.001.
    pub significance: f64,
}

impl Default for VerifyConfig {
    fn default() -> Self {
        Self { significance: 0.001 }
    }
}

impl VerifyConfig {
    /// Checks the values.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the field.
    pub fn validate(&self) -> Result<()> {
        if self.significance > 0.0 && self.significance < 1.0 {
            return Ok(());
        }
        Err(Error::invalid("significance", "a probability between 0 and 1, such as 0.001", self.significance))
    }
}

/// What a photograph says of a rig.
#[derive(Debug, Clone, PartialEq)]
pub struct Verification {
    /// The projected rectangle on the sheet.
    pub keystone: Keystone,
    /// Projector against camera.
    pub rig: RigCheck,
    /// The sheet against the rig's first view; `None` for a rig without views, or another sheet.
    pub sheet: Option<SheetCheck>,
    /// Where the sheet is now: X_camera = R · X_sheet + t.
    pub camera_from_sheet: Pose,
    /// The level of the tests.
    pub significance: f64,
    /// Whether the rig's own uncertainty is part of the tests; else, for want of a covariance, only the noise is.
    pub with_covariance: bool,
    /// Projected corners seen.
    pub corners: usize,
    /// Projected corners and edge points that did not fit and were left out.
    pub left_out: usize,
    /// By how much the scatter of edge points and of corners exceeds their own σ (at least 1): the tests count with it.
    pub widened: [f64; 2],
}

/// So many of a rig's views stand for themselves; with more of them it is certain enough for its covariance to do.
const VIEWS: usize = 2;

/// The projector's unknowns that are set free: where it stands and all of its lens that one view of a plane shows.
const FREE: [usize; 9] = [
    STEREO,
    STEREO + 1,
    STEREO + 2,
    STEREO + 3,
    STEREO + 4,
    STEREO + 5,
    PROJECTOR,
    PROJECTOR + 1,
    PROJECTOR + 2,
];

/// Compares a rig with one photograph: `seen` with the panel's pixels in its pairs; `outline_px` are the corners TL, TR, BR,
/// BL on the panel of the rectangle whose keystone is wanted, `aspect` its width over its height as it should appear.
///
/// # Errors
/// [`Error::Invalid`] for a rig without projector, fewer than four projected corners or numbers that are not finite;
/// [`Error::Degenerate`] when the photograph and the rig do not go together at all.
pub fn verify(
    rig: &Rig,
    seen: &ViewObservation,
    outline_px: &[Point2<f64>; 4],
    aspect: f64,
    config: &VerifyConfig,
) -> Result<Verification> {
    config.validate()?;
    let projector = rig.require_projector()?.device.model;
    if !(aspect.is_finite() && aspect > 0.0 && outline_px.iter().all(|p| p.x.is_finite() && p.y.is_finite()))
    {
        return Err(Error::invalid("outline", "four finite corners and a positive aspect", aspect));
    }
    let camera = rig.camera.model;
    let observations = Observations {
        camera: [camera.width, camera.height],
        projector: Some([projector.width, projector.height]),
        views: vec![seen.clone()],
    };
    check(&observations, &CalibrateConfig::default())?;
    let inconsistent = || {
        Error::Degenerate {
        what: ErrorSubject::RigComparison,
        measure: 0.0,
        limit: 0.0,
        advice: "the photograph and the rig do not go together at all: is it the rig of this camera and projector, and \
                 the right pattern?"
            .into(),
    }
    };
    let scene = scene(rig, seen, &observations).ok_or_else(inconsistent)?;
    let weights = scene.weigh(&FREE).ok_or_else(inconsistent)?;
    let free = scene.fit(&FREE, &weights.each).ok_or_else(inconsistent)?;
    let keystone = keystone::keystone(&scene, &free, &FREE, outline_px, aspect).ok_or_else(inconsistent)?;
    let (rig_check, accepted) = change_test::rig_check(&scene, &weights, &free, &FREE, config.significance)
        .ok_or_else(inconsistent)?;
    let sheet = rig.views.first().filter(|v| v.size == seen.size).and_then(|_| {
        let fit = accepted.as_ref().unwrap_or(&free);
        change_test::sheet_check(&scene, fit, config.significance)
    });
    let camera_from_sheet = *free.model.views.first().ok_or_else(inconsistent)?;
    Ok(Verification {
        keystone,
        camera_from_sheet,
        rig: rig_check,
        sheet,
        significance: config.significance,
        with_covariance: scene.root.ncols() > 0,
        corners: seen.pairs.len(),
        left_out: Weights::left_out(&weights),
        widened: weights.widened,
    })
}

fn scene(rig: &Rig, seen: &ViewObservation, observations: &Observations) -> Option<Scene> {
    let camera = rig.camera.model;
    let homography = sheet_homography(seen, Some(&camera)).ok()?;
    let centre = Point2::new(seen.size.width_mm / 2.0, seen.size.height_mm / 2.0);
    let pose: Pose = pose_from_homography(&homography, &camera.intrinsics, centre)?;
    let base = model(rig, pose);
    let mut units = vec![1.0; SHARED];
    for (at, device) in [(0, Some(camera)), (PROJECTOR, base.projector)] {
        let width = device.map_or(1.0, |d| f64::from(d.width));
        units[at + 1..at + 3].fill(width);
    }
    units[STEREO + 3..STEREO + 6].fill(pose.translation.norm());
    let counted = rig.views.len().min(VIEWS);
    let n = SHARED + 6 * counted;
    let root = root(&covariance_of(rig, counted).unwrap_or_else(|| DMatrix::zeros(n, n)));
    let past = past(rig, counted, &root, seen.size);
    Some(Scene { size: seen.size, measurements: measurements(observations), root, past, base, units })
}

/// The rig's first views as they are expected, with the noise that its covariance tells of; where it tells none, y alone.
fn past(rig: &Rig, counted: usize, root: &DMatrix<f64>, seen: RectangleSize) -> Past {
    let poses: Vec<Pose> = rig.views[..counted].iter().map(|v| v.camera_from_sheet).collect();
    let was = Model { views: poses, ..model(rig, Pose::identity()) };
    let size = rig.views.first().map_or(seen, |v| v.size);
    let linear = || Past::linear(was.clone(), size, root.ncols());
    let views = || {
        let mut outlook = outlook_of(rig, None).ok()?;
        if rig.views[..counted].iter().any(|v| v.size != size) {
            return None;
        }
        [outlook.sheet_sigma_px, outlook.pattern_sigma_px] = outlook.noise_of(rig)?;
        let seen = was.views.iter().map(|v| outlook.measurements(v)).collect::<Option<Vec<_>>>()?;
        Past::with_views(was.clone(), seen, size, root)
    };
    views().unwrap_or_else(linear)
}

/// The corners of a whole pattern where they are drawn on the panel, and the aspect of the pattern: what [`verify`] takes.
#[must_use]
pub fn outline(
    pattern: &crate::pattern::CheckerPattern,
    panel_from_pattern: Option<&crate::geometry::Warp>,
) -> Option<([Point2<f64>; 4], f64)> {
    let mut corners = pattern.outline();
    let size = corners[2] - corners[0];
    for c in &mut corners {
        *c = panel_from_pattern.map_or(Some(*c), |h| h.map(*c))?;
    }
    Some((corners, size.x / size.y))
}

/// Where the rig, as it is, would have the camera see what the projector throws at `projector_px` onto a sheet; `None` where
/// it does not fall on the sheet's plane or in front of the camera.
#[must_use]
pub fn expected_corner(
    rig: &Rig,
    camera_from_sheet: &Pose,
    projector_px: Point2<f64>,
) -> Option<Point2<f64>> {
    let Projector { device, from_camera } = rig.projector.as_ref()?;
    let lit = lit_point(&device.model, &from_camera.pose, camera_from_sheet, projector_px)?;
    rig.camera.model.project(&lit)
}
