//! σ of the method of two vanishing points: the noise of what was measured, propagated through the closed form by
//! differences, the method's own assumptions taken as exact.

use nalgebra::{DMatrix, Point2, Vector2, Vector3};

use super::closed_form::{Input, Output, Quad, closed_form};
use crate::geometry::Line;
use crate::observations::{EdgePoint, SheetObservation, UNKNOWN_SIGMA_PX, ViewObservation};
use crate::solve::{Structure, covariance, homography_from_points};

/// σ of what a small change of the measurements already makes imaginary (1000 %).
const NO_KNOWLEDGE: f64 = 10.0;
/// Part of a mode's σ by which it is displaced to differentiate.
const STEP: f64 = 0.05;
/// Where [`difference`] lists the rotation and the translation between the devices.
pub(crate) const TURN: usize = 2;
pub(crate) const SHIFT: usize = 5;

/// A displacement of four corners.
type Mode = [Vector2<f64>; 4];

/// Independent displacements of the four corners, each of one σ.
pub(crate) fn corner_modes(view: &ViewObservation, corners: &Quad) -> Vec<Mode> {
    let mut modes = Vec::new();
    match &view.sheet {
        SheetObservation::Corners { sigma_px, .. } => {
            for i in 0..8 {
                let mut mode = [Vector2::zeros(); 4];
                mode[i / 2][i % 2] = sigma_px.unwrap_or(UNKNOWN_SIGMA_PX);
                modes.push(mode);
            }
        }
        SheetObservation::Edges(sides) => {
            for (i, points) in sides.iter().enumerate() {
                modes.extend(side_modes(i, points, corners));
            }
        }
    }
    modes
}

/// The offset and the slope of one side, as displacements of its two corners along the neighbouring sides.
fn side_modes(side: usize, points: &[EdgePoint], corners: &Quad) -> Vec<Mode> {
    let (from, to) = (side, (side + 1) % 4);
    let along = corners[to] - corners[from];
    let place = |p: &Point2<f64>| (p - corners[from]).dot(&along) / along.norm_squared();
    let weight: f64 = points.iter().map(|p| p.weighted().1).sum();
    let mean = points.iter().map(|p| p.weighted().1 * place(&p.position)).sum::<f64>() / weight;
    let spread: f64 = points.iter().map(|p| p.weighted().1 * (place(&p.position) - mean).powi(2)).sum();
    let line = |a, b| Line::through_pixels(a, b);
    let normal = Vector2::new(-along.y, along.x).normalize();
    let moved = |at_from: f64, at_to: f64| -> Option<Mode> {
        let shifted = line(corners[from] + normal * at_from, corners[to] + normal * at_to);
        let before = line(corners[(side + 3) % 4], corners[from]);
        let after = line(corners[to], corners[(side + 2) % 4]);
        let mut mode = [Vector2::zeros(); 4];
        mode[from] = before.meet(shifted).pixel()? - corners[from];
        mode[to] = shifted.meet(after).pixel()? - corners[to];
        Some(mode)
    };
    let (offset, slope) = (weight.sqrt().recip(), spread.sqrt().recip());
    let modes = [moved(offset, offset), moved(-mean * slope, (1.0 - mean) * slope)];
    modes.into_iter().flatten().collect()
}

/// Independent displacements of the outline's corners that stand for the noise of all pairs.
fn outline_modes(view: &ViewObservation, seen: &Quad, drawn: &Quad) -> Option<Vec<Mode>> {
    let map =
        |seen: &Quad| homography_from_points(&drawn.iter().copied().zip(*seen).collect::<Vec<_>>()).ok();
    let n = view.pairs.len();
    let mut j = DMatrix::zeros(2 * n, 8);
    let h = 1e-3;
    for c in 0..8 {
        let at = |s: f64| {
            let mut moved = *seen;
            moved[c / 2][c % 2] += s * h;
            map(&moved)
        };
        let (up, down) = (at(1.0)?, at(-1.0)?);
        for (i, p) in view.pairs.iter().enumerate() {
            let d = (up.map(p.projector)? - down.map(p.projector)?)
                / (2.0 * h * p.sigma_px.unwrap_or(UNKNOWN_SIGMA_PX));
            j[(2 * i, c)] = d.x;
            j[(2 * i + 1, c)] = d.y;
        }
    }
    let factor = covariance(&Structure::dense(8), &j, &[])?.cholesky()?.l();
    let modes = factor.column_iter().map(|l| std::array::from_fn(|k| Vector2::new(l[2 * k], l[2 * k + 1])));
    Some(modes.collect())
}

/// ln f of both devices, then rotation and translation between them, as displacements from `base`.
fn difference(a: &Output, base: &Output) -> [f64; 8] {
    let mut d = [0.0; 8];
    d[0] = (a.camera.intrinsics.fx / base.camera.intrinsics.fx).ln();
    if let (Some((k, pose)), Some((k0, pose0))) = (&a.projector, &base.projector) {
        d[1] = (k.intrinsics.fx / k0.intrinsics.fx).ln();
        let turn = pose.rotation_vector_from(pose0);
        let shift: Vector3<f64> = pose.translation - pose0.translation;
        d[TURN..SHIFT].copy_from_slice(turn.as_slice());
        d[SHIFT..].copy_from_slice(shift.as_slice());
    }
    d
}

/// 1σ of what [`difference`] lists.
pub(crate) fn sigmas(input: &Input, base: &Output, view: &ViewObservation) -> [f64; 8] {
    let mut inputs = Vec::new();
    let displaced = |q: &Quad, mode: &Mode, s: f64| -> Quad { std::array::from_fn(|i| q[i] + mode[i] * s) };
    for mode in corner_modes(view, &input.corners) {
        inputs.push(
            [STEP, -STEP].map(|s| Input { corners: displaced(&input.corners, &mode, s), ..input.clone() }),
        );
    }
    if let Some((seen, drawn)) = &input.outline {
        for mode in outline_modes(view, seen, drawn).unwrap_or_default() {
            inputs.push(
                [STEP, -STEP]
                    .map(|s| Input { outline: Some((displaced(seen, &mode, s), *drawn)), ..input.clone() }),
            );
        }
    }
    let mut variance = [0.0; 8];
    for [up, down] in inputs {
        match (closed_form(&up), closed_form(&down)) {
            (Ok(up), Ok(down)) => {
                let (a, b) = (difference(&up, base), difference(&down, base));
                for k in 0..8 {
                    variance[k] += ((a[k] - b[k]) / (2.0 * STEP)).powi(2);
                }
            }
            _ => variance = [f64::INFINITY; 8],
        }
    }
    // Lengths are unknown by that part of the distance, everything else by itself.
    let distance = base.sheet.translation.norm();
    std::array::from_fn(|k| {
        let most = NO_KNOWLEDGE * if k < SHIFT { 1.0 } else { distance };
        let sigma = variance[k].sqrt();
        if sigma.is_finite() { sigma.min(most) } else { most }
    })
}
