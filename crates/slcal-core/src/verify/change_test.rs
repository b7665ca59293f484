//! Tests whether projector and camera have moved against each other, and the sheet against the first view.

use nalgebra::{DMatrix, DVector};

use super::chi_squared_sf::chi_squared_sf;
use super::keystone::Measured;
use super::posterior_fit::{Posterior, PosteriorFit};
use crate::estimate::covariance::correlations;
use crate::estimate::residual::POSE;
use crate::estimate::unknowns::SHARED;
use crate::estimate::{Kind, Target};
use crate::geometry::RectangleSize;
use crate::parameter::{LensParameter, Parameter, PoseParameter};
use crate::solve::rms;

/// What a map of the sheet to the panel has: the freedom of the projector in one view of a plane.
const PROJECTOR_FREEDOM: usize = 8;
/// A simpler change is taken for the cause when it explains all but this part of what has changed.
const UNEXPLAINED: f64 = 0.05;

/// What seems to have changed between projector and camera: the simplest change that explains the photograph.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// The projector stands elsewhere as the camera sees it (or the other way round).
    Moved {
        /// By what angle it has turned, rad.
        turn_rad: Measured,
        /// How far its centre has moved, mm.
        shift_mm: Measured,
    },
    /// The projector's focal length; its zoom, or its focus, was turned. Relative change.
    ProjectorFocal(Measured),
    /// The camera's focal length, relative change.
    CameraFocal(Measured),
    /// None of these alone.
    Several,
}

/// Projector against camera.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RigCheck {
    /// Whether the p-value is below the significance level.
    pub moved: bool,
    /// p-value: probability of at least this χ² when nothing has moved.
    pub p_value: f64,
    /// By how much χ² falls when the projector is free.
    pub chi_squared: f64,
    /// Degrees of freedom.
    pub freedom: usize,
    /// Rms distance of the pattern on the sheet from where the rig puts it, mm.
    pub pattern_off_mm: f64,
    /// Rms residual of the projected corners under the rig as it is and with the projector free, camera px.
    pub corner_rms_px: [f64; 2],
    /// What has changed, when it has.
    pub change: Option<Change>,
}

/// The sheet against the rig's first view.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SheetCheck {
    /// Whether the p-value is below the significance level.
    pub moved: bool,
    /// p-value: probability of at least this χ² when the sheet has not moved.
    pub p_value: f64,
    /// Squared distance of the poses in their own covariance.
    pub chi_squared: f64,
    /// By what angle it has turned, rad.
    pub turn_rad: f64,
    /// How far its centre has moved, mm.
    pub shift_mm: f64,
    /// How far the corner that moved most has, mm.
    pub largest_mm: f64,
}

/// Tests the rig; the second value is the fit with the rig as it is, when that is accepted.
pub(super) fn rig_check(
    posterior: &Posterior,
    free: &PosteriorFit,
    freed: &[Parameter],
    significance: f64,
) -> Option<(RigCheck, Option<PosteriorFit>)> {
    let bound = posterior.fit(&[])?;
    let chi_squared = (bound.chi_squared - free.chi_squared).max(0.0);
    let p_value = chi_squared_sf(chi_squared, PROJECTOR_FREEDOM);
    let moved = p_value < significance;
    let check = RigCheck {
        moved,
        p_value,
        chi_squared,
        freedom: PROJECTOR_FREEDOM,
        pattern_off_mm: pattern_off(posterior, free)?,
        corner_rms_px: [&bound, free].map(|f| corner_rms(posterior, f)),
        change: if moved { Some(change(posterior, &bound, freed, significance)?) } else { None },
    };
    Some((check, (!moved).then_some(bound)))
}

/// Rms residual of the projected corners, px.
fn corner_rms(posterior: &Posterior, fit: &PosteriorFit) -> f64 {
    let measured = posterior.measurements().iter().zip(&fit.norms_px);
    rms(measured.filter(|(m, _)| m.kind() == Kind::Pair).map(|(_, norm)| *norm)).unwrap_or(0.0)
}

/// Rms distance on the sheet between the corners as seen and where the rig, as it was, would throw them.
fn pattern_off(posterior: &Posterior, fit: &PosteriorFit) -> Option<f64> {
    let sheet = fit.model.views.first()?;
    // The rig may not even light the sheet there.
    let distance =
        |seen, q| Some(nalgebra::distance(&fit.past.on_sheet(sheet, seen)?, &fit.past.lit(sheet, q)?));
    let distances = posterior.measurements().iter().filter_map(|m| match m.of {
        Target::Pair(q) => distance(m.seen, q),
        _ => None,
    });
    Some(rms(distances).unwrap_or(0.0))
}

/// The simplest change that explains what is seen.
fn change(
    posterior: &Posterior,
    bound: &PosteriorFit,
    freed: &[Parameter],
    significance: f64,
) -> Option<Change> {
    // Everything that is considered, at once.
    let [projector, camera] = [Parameter::Projector, Parameter::Camera].map(|of| of(LensParameter::Focal));
    let all = [freed, std::slice::from_ref(&camera)].concat();
    let most = posterior.fit(&all)?.chi_squared;
    let gained = (bound.chi_squared - most).max(0.0);
    for free in [
        std::slice::from_ref(&projector),
        std::slice::from_ref(&camera),
        &PoseParameter::ALL.map(Parameter::ProjectorFromCamera),
    ] {
        let Some(fit) = posterior.fit(free) else { continue };
        let left = (fit.chi_squared - most).max(0.0);
        let enough = chi_squared_sf(left, PROJECTOR_FREEDOM + 1 - free.len()) >= significance;
        if !(enough || left <= UNEXPLAINED * gained) {
            continue;
        }
        let at = posterior.bound();
        let focal = || Measured { value: fit.freed[0].exp_m1(), sigma: fit.covariance[(at, at)].sqrt() };
        return match free {
            [only] if *only == projector => Some(Change::ProjectorFocal(focal())),
            [_] => Some(Change::CameraFocal(focal())),
            _ => Some(transform(posterior, &fit)),
        };
    }
    Some(Change::Several)
}

/// How the projector stands against how the rig has it.
fn transform(posterior: &Posterior, fit: &PosteriorFit) -> Change {
    let at = posterior.bound();
    let before = fit.past.projector_from_camera;
    let now = fit.model.projector_from_camera;
    let turn = now.rotation_vector_from(&before).norm();
    let shift = nalgebra::distance(&now.centre(), &before.centre());
    // Of what was set free alone: the rig's own uncertainty is part of it through the correlations.
    let unit: Vec<f64> = fit.free.iter().map(|&i| posterior.units[i]).collect();
    let c = DMatrix::from_fn(6, 6, |i, j| fit.covariance[(at + i, at + j)] * unit[i] * unit[j]);
    let mean = |from: usize| ((0..3).map(|i| c[(from + i, from + i)]).sum::<f64>() / 3.0).sqrt();
    Change::Moved {
        turn_rad: Measured { value: turn, sigma: mean(0) },
        shift_mm: Measured { value: shift, sigma: mean(3) },
    }
}

/// Tests the sheet's pose against the rig's first view; both are correlated through the rig.
pub(super) fn sheet_check(
    posterior: &Posterior,
    fit: &PosteriorFit,
    size: RectangleSize,
    significance: f64,
) -> Option<SheetCheck> {
    let k = posterior.bound();
    let of_view = posterior.factor.rows(SHARED, POSE);
    let (was, now) = (&fit.past.views.first()?.pose, &fit.model.views.first()?.pose);
    let mut off = DVector::zeros(6);
    off.rows_mut(0, 3).copy_from(&now.rotation_vector_from(was));
    off.rows_mut(3, 3).copy_from(&(now.translation - was.translation));
    let at = k + fit.free.len();
    let mut by = DMatrix::zeros(6, fit.covariance.nrows());
    by.view_mut((0, 0), (6, k)).copy_from(&-of_view);
    by.view_mut((0, at), (6, 6)).fill_with_identity();
    let covariance = &by * &fit.covariance * by.transpose();
    let chi_squared = distance(&off, &covariance)?;
    let p_value = chi_squared_sf(chi_squared, 6);
    let moved_by = |p| nalgebra::distance(&now.lift(p), &was.lift(p));
    Some(SheetCheck {
        moved: p_value < significance,
        p_value,
        chi_squared,
        turn_rad: now.rotation_vector_from(was).norm(),
        shift_mm: moved_by(size.centre()),
        largest_mm: size.corners().map(moved_by).into_iter().fold(0.0, f64::max),
    })
}

/// dᵀC⁻¹d, on correlations: the units differ by orders of magnitude.
fn distance(d: &DVector<f64>, c: &DMatrix<f64>) -> Option<f64> {
    let (sigma, correlations) = correlations(c);
    let scaled = d.component_div(&sigma);
    let value = scaled.dot(&correlations.cholesky()?.solve(&scaled));
    value.is_finite().then_some(value.max(0.0))
}
