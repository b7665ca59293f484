//! Rig + photograph of a projected checkerboard → how square it is on the sheet, and whether the rig has moved.
//!
//! `verify` fits the photograph under the rig, with the rig's own covariance as prior (`posterior_fit`), so that an
//! uncertain rig raises no false alarms; once with the rig as it is and once with the projector free. The difference is χ²
//! distributed when nothing has moved (`change_test`). `keystone` measures the projected rectangle on the sheet.

mod change_test;
mod chi_squared_sf;
mod keystone;
mod posterior_fit;
mod report_json;
mod rig_views;
#[cfg(test)]
mod tests;

use nalgebra::Point2;

use self::posterior_fit::Posterior;
use crate::error::{Error, ErrorSubject, Result};
use crate::estimate::validate::validate;
use crate::estimate::{Model, Sheet};
use crate::geometry::{Pose, Warp};
use crate::observations::{Observations, ViewObservation};
use crate::parameter::{LensParameter, Parameter, PoseParameter};
use crate::pattern::CheckerPattern;
use crate::rig::Rig;

public_with! { "report": pub use change_test::{Change, RigCheck, SheetCheck}; }
public_with! { "report": pub use keystone::{Keystone, Measured}; }

/// Parameters of [`verify`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct VerifyConfig {
    /// False-alarm rate of both tests: how often a rig that has not moved is said to have moved; default 0.001.
    pub(crate) significance: f64,
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
    pub(crate) fn validate(self) -> Result<()> {
        if self.significance > 0.0 && self.significance < 1.0 {
            return Ok(());
        }
        Err(Error::invalid("significance", "a probability between 0 and 1, such as 0.001", self.significance))
    }
}

/// The comparison of a rig with a photograph.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Verification {
    pub(crate) keystone: Keystone,
    pub(crate) rig: RigCheck,
    pub(crate) sheet: Option<SheetCheck>,
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

impl Verification {
    /// Whether the projector has moved against the camera, or one of them has changed its focal length.
    #[must_use]
    pub fn rig_moved(&self) -> bool {
        self.rig.moved
    }

    /// Whether the sheet has moved since the rig's first view; `None` for a rig without views, or another sheet.
    #[must_use]
    pub fn sheet_moved(&self) -> Option<bool> {
        self.sheet.as_ref().map(|s| s.moved)
    }

    /// Rms distance of the pattern on the sheet from where the rig puts it, mm.
    #[must_use]
    pub fn pattern_off_mm(&self) -> f64 {
        self.rig.pattern_off_mm
    }

    /// The keystone that is left, rad, and its σ: the largest angle between a side of the projected rectangle and the
    /// sheet's.
    #[must_use]
    pub fn worst_keystone_rad(&self) -> (f64, f64) {
        (self.keystone.worst_rad.value, self.keystone.worst_rad.sigma)
    }
}

/// All figures.
#[cfg(feature = "report")]
impl Verification {
    /// The projected rectangle on the sheet.
    #[must_use]
    pub fn keystone(&self) -> &Keystone {
        &self.keystone
    }

    /// Projector against camera.
    #[must_use]
    pub fn rig(&self) -> &RigCheck {
        &self.rig
    }

    /// The sheet against the rig's first view; `None` for a rig without views, or another sheet.
    #[must_use]
    pub fn sheet(&self) -> Option<&SheetCheck> {
        self.sheet.as_ref()
    }
}

/// What is free when the projector is: where it stands and all of its lens that one view of a plane shows.
const FREE: [Parameter; 9] = [
    Parameter::ProjectorFromCamera(PoseParameter::Rx),
    Parameter::ProjectorFromCamera(PoseParameter::Ry),
    Parameter::ProjectorFromCamera(PoseParameter::Rz),
    Parameter::ProjectorFromCamera(PoseParameter::Tx),
    Parameter::ProjectorFromCamera(PoseParameter::Ty),
    Parameter::ProjectorFromCamera(PoseParameter::Tz),
    Parameter::Projector(LensParameter::Focal),
    Parameter::Projector(LensParameter::Cx),
    Parameter::Projector(LensParameter::Cy),
];

/// Compares a rig with one photograph: `seen` with the panel's pixels in its pairs; `outline_px` are the corners TL, TR, BR,
/// BL on the panel of the rectangle whose keystone is wanted, `aspect` its width over its height as it should appear.
///
/// # Errors
/// [`Error::Invalid`] for a rig without projector, fewer than four projected corners or numbers that are not finite;
/// [`Error::Degenerate`] when the photograph and the rig do not go together at all.
pub(crate) fn verify(
    rig: &Rig,
    seen: &ViewObservation,
    outline_px: &[Point2<f64>; 4],
    aspect: f64,
    config: VerifyConfig,
) -> Result<Verification> {
    config.validate()?;
    let projector = rig.require_projector()?.device.model;
    if !(aspect.is_finite() && aspect > 0.0 && outline_px.iter().all(|p| p.x.is_finite() && p.y.is_finite()))
    {
        return Err(Error::invalid("outline", "four finite corners and a positive aspect", aspect));
    }
    let camera = rig.camera.model;
    let observations = Observations {
        camera: camera.size(),
        projector: Some(projector.size()),
        mirrored: rig.is_mirrored(),
        views: vec![seen.clone()],
    };
    validate(&observations)?;
    let inconsistent = || {
        let advice = "the photograph and the rig do not go together at all: is it the rig of this camera and projector, and the \
                      right pattern?";
        Error::undetermined(ErrorSubject::RigComparison, advice)
    };
    let posterior = Posterior::new(rig, &observations).ok_or_else(inconsistent)?;
    let robust = posterior.fit_robustly(&FREE).ok_or_else(inconsistent)?;
    let posterior = posterior.with_inliers(&robust);
    let free = posterior.fit(&FREE).ok_or_else(inconsistent)?;
    let keystone = keystone::keystone(&posterior, &free, outline_px, aspect).ok_or_else(inconsistent)?;
    let (rig_check, accepted) =
        change_test::rig_check(&posterior, &free, &FREE, config.significance).ok_or_else(inconsistent)?;
    let sheet = rig.views.first().filter(|v| v.size == seen.size).and_then(|_| {
        let fit = accepted.as_ref().unwrap_or(&free);
        change_test::sheet_check(&posterior, fit, seen.size, config.significance)
    });
    let camera_from_sheet = free.model.views.first().ok_or_else(inconsistent)?.pose;
    Ok(Verification {
        keystone,
        camera_from_sheet,
        rig: rig_check,
        sheet,
        significance: config.significance,
        with_covariance: posterior.bound() > 0,
        corners: seen.pairs.len(),
        left_out: robust.inliers.iter().filter(|keep| !**keep).count(),
        widened: robust.widened,
    })
}

/// The corners of a whole pattern where they are drawn on the panel, and the aspect of the pattern: what [`verify`] takes.
#[must_use]
pub(crate) fn outline(
    pattern: &CheckerPattern,
    panel_from_pattern: Option<&Warp>,
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
#[cfg(feature = "report")]
#[must_use]
pub fn expected_corner(
    rig: &Rig,
    camera_from_sheet: &Pose,
    projector_px: Point2<f64>,
) -> Option<Point2<f64>> {
    let size = rig.views.first()?.size;
    rig.camera.model.project(&Model::of_rig(rig).lit(&Sheet::flat(*camera_from_sheet, size), projector_px)?)
}
