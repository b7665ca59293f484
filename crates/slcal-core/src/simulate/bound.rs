//! The Cramér–Rao bound: the smallest variance of any unbiased estimator. It comes from the scene's own equations by
//! central differences, independent of the estimators' Jacobians.

use nalgebra::{DMatrix, Point2, Rotation3, Vector3};
use serde::Serialize;

use super::scene::{NoiseModel, Scene};
use crate::error::{Error, Result};
use crate::geometry::{Camera, Pose};

/// Smallest standard deviations that the observations of a scene allow.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bound {
    /// Focal length of the camera, px.
    pub camera_focal_px: f64,
    /// Focal length of the projector, px.
    pub projector_focal_px: f64,
    /// Translation camera → projector: root of the summed variances of its components, mm.
    pub translation_mm: f64,
}

/// Prior σ of the principal points in px (camera x and y, projector x and y); zero: known exactly.
pub type PrincipalPointSigma = [f64; 4];

/// Step of the differences in the unknowns' natural units, at which rounding and truncation errors are both near 1e-10.
const STEP: f64 = 1e-5;
/// Singular values below this share of the largest count as zero: the unknown is not determined and its σ is infinite.
const SINGULAR: f64 = 1e-12;

/// The unknowns' displacement applied to a scene: ln f and principal point of both, stereo pose, then the views.
fn moved(scene: &Scene, free: &[usize], delta: &[f64], units: &[f64]) -> Scene {
    let mut all = vec![0.0; 12 + 6 * scene.views.len()];
    for ((&i, d), unit) in free.iter().zip(delta).zip(units) {
        all[i] = d * unit;
    }
    let lens = |c: &Camera, d: &[f64]| {
        let mut c = *c;
        let grow = d[0].exp();
        c.intrinsics.fx *= grow;
        c.intrinsics.fy *= grow;
        c.intrinsics.skew *= grow;
        c.intrinsics.cx += d[1];
        c.intrinsics.cy += d[2];
        c
    };
    let pose = |p: &Pose, d: &[f64]| Pose {
        rotation: Rotation3::new(Vector3::new(d[0], d[1], d[2])) * p.rotation,
        translation: p.translation + Vector3::new(d[3], d[4], d[5]),
    };
    Scene {
        camera: lens(&scene.camera, &all[..3]),
        projector: lens(&scene.projector, &all[3..6]),
        projector_from_camera: pose(&scene.projector_from_camera, &all[6..12]),
        views: scene.views.iter().zip(all[12..].chunks(6)).map(|(v, d)| pose(v, d)).collect(),
        ..scene.clone()
    }
}

/// All observations, each divided by its σ: corners of the sheet and projected corners.
fn whitened(scene: &Scene, noise: &NoiseModel) -> Option<Vec<f64>> {
    let mut all = Vec::new();
    for view in &scene.views {
        let mut put = |p: Point2<f64>, sigma: f64| all.extend([p.x / sigma, p.y / sigma]);
        for c in scene.size.corners() {
            put(scene.sheet_pixel(view, c)?, noise.sheet_px);
        }
        for &q in &scene.pattern {
            let lit = scene.lit(view, q)?;
            put(scene.camera.project(&lit)?, noise.pattern_px);
        }
    }
    Some(all)
}

/// The bound for observations of the sheet's corners and the projected ones with this noise. Distortion and bend are
/// known, and so is everything that `principal_points` has as zero.
///
/// # Errors
/// [`Error::Invalid`] for noise that is zero, edge points, or a scene of which part lies behind a device.
pub fn bound(scene: &Scene, noise: &NoiseModel, principal_points: PrincipalPointSigma) -> Result<Bound> {
    noise.validate()?;
    if noise.edge_points.is_some() || noise.sheet_px <= 0.0 || noise.pattern_px <= 0.0 {
        let found = format!("{noise:?}");
        return Err(Error::invalid("noise for the bound", "positive noise of corners", found));
    }
    let mut free = vec![0, 3];
    let places = [1, 2, 4, 5];
    free.extend(places.iter().zip(principal_points).filter(|(_, s)| *s > 0.0).map(|(p, _)| *p));
    free.extend(6..12 + 6 * scene.views.len());
    let distance = scene.views.first().map_or(1.0, |v| v.translation.norm());
    let unit = |i: usize| match i {
        1 | 2 => f64::from(scene.camera.width),
        4 | 5 => f64::from(scene.projector.width),
        i if i >= 6 && i % 6 >= 3 => distance,
        _ => 1.0,
    };
    let units: Vec<f64> = free.iter().map(|&i| unit(i)).collect();
    let jacobian = jacobian(scene, noise, (&free, &units), |i| {
        places.iter().position(|p| *p == i).map_or(0.0, |k| principal_points[k])
    })
    .ok_or_else(|| Error::invalid("scene", "sheet and pattern in front of both devices", "points behind"))?;
    let variances =
        inverse_diagonal(jacobian).ok_or_else(|| Error::invalid("scene", "finite derivatives", "none"))?;
    let sigma =
        |i: usize| free.iter().position(|&k| k == i).map_or(0.0, |at| variances[at].sqrt() * units[at]);
    Ok(Bound {
        camera_focal_px: sigma(0) * scene.camera.intrinsics.fx,
        projector_focal_px: sigma(3) * scene.projector.intrinsics.fx,
        translation_mm: (9..12).map(|i| sigma(i).powi(2)).sum::<f64>().sqrt(),
    })
}

/// Derivatives of the whitened observations by the unknowns in their units, with a row for every prior.
fn jacobian(
    scene: &Scene,
    noise: &NoiseModel,
    (free, units): (&[usize], &[f64]),
    prior: impl Fn(usize) -> f64,
) -> Option<DMatrix<f64>> {
    let n = free.len();
    let rows = whitened(scene, noise)?.len();
    let mut j = DMatrix::zeros(rows + n, n);
    for column in 0..n {
        let at = |step: f64| {
            let mut delta = vec![0.0; n];
            delta[column] = step;
            whitened(&moved(scene, free, &delta, units), noise)
        };
        for (i, (ahead, behind)) in at(STEP)?.into_iter().zip(at(-STEP)?).enumerate() {
            j[(i, column)] = (ahead - behind) / (2.0 * STEP);
        }
        let sigma = prior(free[column]);
        if sigma > 0.0 {
            j[(rows + column, column)] = units[column] / sigma;
        }
    }
    Some(j)
}

/// The diagonal of (JᵀJ)⁻¹, with columns scaled to one length for the numerics.
fn inverse_diagonal(mut j: DMatrix<f64>) -> Option<Vec<f64>> {
    let norms: Vec<f64> = j.column_iter().map(|c| c.norm()).collect();
    if !norms.iter().all(|n| n.is_finite() && *n > 0.0) {
        return None;
    }
    for (i, n) in norms.iter().enumerate() {
        j.column_mut(i).unscale_mut(*n);
    }
    let svd = j.try_svd(false, true, f64::EPSILON, 0)?;
    let (v_t, s) = (svd.v_t?, svd.singular_values);
    let least = SINGULAR * s.max();
    let of = |i: usize| v_t.column(i).iter().zip(&s).map(|(v, s)| (v / s.max(least)).powi(2)).sum::<f64>();
    Some(norms.iter().enumerate().map(|(i, n)| of(i) / (n * n)).collect())
}
