//! Whether projector and camera still stand as the rig says, and the sheet as in its first view.

use nalgebra::{DMatrix, DVector, Point3, Vector3};

use super::chi_squared_sf::exceeded_by_chance;
use super::keystone::Measured;
use super::posterior_fit::{Fit, Scene, Weights};
use crate::advise::shared::{PROJECTOR, SHARED, STEREO};
use crate::estimate::residual::lit_point;
use crate::estimate::{Kind, Target};
use crate::geometry::{Plane, Ray};

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
pub struct RigCheck {
    /// Whether the test says so.
    pub moved: bool,
    /// How often an unmoved rig would look at least as odd.
    pub p_value: f64,
    /// What setting the projector free gains.
    pub chi_squared: f64,
    /// Its degrees of freedom.
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
pub struct SheetCheck {
    /// Whether the test says so.
    pub moved: bool,
    /// How often an unmoved sheet would look at least as odd.
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
    scene: &Scene,
    weights: &Weights,
    free: &Fit,
    freed: &[usize],
    significance: f64,
) -> Option<(RigCheck, Option<Fit>)> {
    let bound = scene.fit(&[], &weights.each)?;
    let chi_squared = (bound.chi_squared - free.chi_squared).max(0.0);
    let p_value = exceeded_by_chance(chi_squared, PROJECTOR_FREEDOM);
    let moved = p_value < significance;
    let check = RigCheck {
        moved,
        p_value,
        chi_squared,
        freedom: PROJECTOR_FREEDOM,
        pattern_off_mm: pattern_off(scene, free, weights)?,
        corner_rms_px: [&bound, free].map(|f| corner_rms(scene, f, weights)),
        change: if moved { Some(change(scene, weights, &bound, freed, significance)?) } else { None },
    };
    Some((check, (!moved).then_some(bound)))
}

/// Rms of the corners' residuals per coordinate's pair, px.
fn corner_rms(scene: &Scene, fit: &Fit, weights: &Weights) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for ((m, n), w) in scene.measurements.iter().zip(&fit.norms).zip(&weights.each) {
        if m.kind() == Kind::Pair && *w > 0.0 {
            sum += (n * m.sigma_px).powi(2);
            count += 1.0;
        }
    }
    if count > 0.0 { (sum / count).sqrt() } else { 0.0 }
}

/// Rms distance on the sheet between the corners as seen and as the rig, as it was, would throw them.
fn pattern_off(scene: &Scene, fit: &Fit, weights: &Weights) -> Option<f64> {
    let rig = crate::estimate::model::Model { views: fit.model.views.clone(), ..fit.past.clone() };
    let pose = rig.views.first()?;
    let plane = Plane::from_point_normal(&pose.translation.into(), pose.rotation * Vector3::z())?;
    let (mut sum, mut count) = (0.0, 0.0);
    for (m, _) in scene.measurements.iter().zip(&weights.each).filter(|(_, w)| **w > 0.0) {
        let Target::Pair(q) = m.of else { continue };
        let ray = Ray { origin: Point3::origin(), direction: rig.camera.bearing(m.seen)? };
        let expected = lit_point(rig.projector.as_ref()?, &rig.projector_from_camera, pose, q);
        // The rig may not even light the sheet there.
        if let (Some(a), Some(b)) = (ray.meet(&plane), expected) {
            sum += nalgebra::distance_squared(&a, &b);
            count += 1.0;
        }
    }
    Some(if count > 0.0 { (sum / count).sqrt() } else { 0.0 })
}

/// The simplest change that explains what is seen.
fn change(
    scene: &Scene,
    weights: &Weights,
    bound: &Fit,
    freed: &[usize],
    significance: f64,
) -> Option<Change> {
    // Everything that is considered, at once.
    let all: Vec<usize> = freed.iter().copied().chain([0]).collect();
    let most = scene.fit(&all, &weights.each)?.chi_squared;
    let gained = (bound.chi_squared - most).max(0.0);
    let stereo: [usize; 6] = std::array::from_fn(|i| STEREO + i);
    for free in [&[PROJECTOR][..], &[0], &stereo] {
        let Some(fit) = scene.fit(free, &weights.each) else { continue };
        let left = (fit.chi_squared - most).max(0.0);
        let enough = exceeded_by_chance(left, PROJECTOR_FREEDOM + 1 - free.len()) >= significance;
        if !(enough || left <= UNEXPLAINED * gained) {
            continue;
        }
        let at = scene.root.ncols();
        let focal = || Measured { value: fit.freed[0].exp_m1(), sigma: fit.covariance[(at, at)].sqrt() };
        return match free {
            [PROJECTOR] => Some(Change::ProjectorFocal(focal())),
            [0] => Some(Change::CameraFocal(focal())),
            _ => Some(transform(scene, &fit, free)),
        };
    }
    Some(Change::Several)
}

/// How the projector stands against how the rig has it.
fn transform(scene: &Scene, fit: &Fit, free: &[usize]) -> Change {
    let at = scene.root.ncols();
    let before = fit.past.projector_from_camera;
    let now = fit.model.projector_from_camera;
    let turn = now.turn_from(&before).norm();
    let shift = nalgebra::distance(&now.centre(), &before.centre());
    // Of what was set free alone: the rig's own uncertainty is part of it through the correlations.
    let unit: Vec<f64> = free.iter().map(|&i| scene.units[i]).collect();
    let c = DMatrix::from_fn(6, 6, |i, j| fit.covariance[(at + i, at + j)] * unit[i] * unit[j]);
    let mean = |from: usize| ((0..3).map(|i| c[(from + i, from + i)]).sum::<f64>() / 3.0).sqrt();
    Change::Moved {
        turn_rad: Measured { value: turn, sigma: mean(0) },
        shift_mm: Measured { value: shift, sigma: mean(3) },
    }
}

/// Tests the sheet's pose against the rig's first view; both are correlated through the rig.
pub(super) fn sheet_check(scene: &Scene, fit: &Fit, significance: f64) -> Option<SheetCheck> {
    let k = scene.root.ncols();
    let of_view = scene.root.rows(SHARED, 6);
    let (was, now) = (fit.past.views.first()?, fit.model.views.first()?);
    let mut off = DVector::zeros(6);
    off.rows_mut(0, 3).copy_from(&now.turn_from(was));
    off.rows_mut(3, 3).copy_from(&(now.translation - was.translation));
    let n = fit.covariance.nrows();
    let mut by = DMatrix::zeros(6, n);
    by.view_mut((0, 0), (6, k)).copy_from(&-of_view);
    by.view_mut((0, n - 6), (6, 6)).fill_with_identity();
    let covariance = &by * &fit.covariance * by.transpose();
    let chi_squared = distance(&off, &covariance)?;
    let p_value = exceeded_by_chance(chi_squared, 6);
    let centre = Point3::new(scene.size.width_mm / 2.0, scene.size.height_mm / 2.0, 0.0);
    let far = |p: Point3<f64>| nalgebra::distance(&now.transform(&p), &was.transform(&p));
    let corners = scene.size.corners().map(|c| far(Point3::new(c.x, c.y, 0.0)));
    Some(SheetCheck {
        moved: p_value < significance,
        p_value,
        chi_squared,
        turn_rad: now.turn_from(was).norm(),
        shift_mm: far(centre),
        largest_mm: corners.into_iter().fold(0.0, f64::max),
    })
}

/// dᵀC⁻¹d, on correlations: the units differ by orders of magnitude.
fn distance(d: &DVector<f64>, c: &DMatrix<f64>) -> Option<f64> {
    let sigma: Vec<f64> = c.diagonal().iter().map(|v| v.max(f64::MIN_POSITIVE).sqrt()).collect();
    let scaled = DVector::from_fn(d.len(), |i, _| d[i] / sigma[i]);
    let correlation = DMatrix::from_fn(d.len(), d.len(), |i, j| c[(i, j)] / (sigma[i] * sigma[j]));
    let value = scaled.dot(&correlation.cholesky()?.solve(&scaled));
    value.is_finite().then_some(value.max(0.0))
}
