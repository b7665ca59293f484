//! Maximum likelihood of everything that was seen, from a start that is near, robustly.
//!
//! The loss starts convex (Huber) and ends redescending (Tukey), with the cutoff at a multiple of the inliers' own
//! scale; the covariance is (JᵀWJ + priors)⁻¹ over the inliers, widened when they scatter more than their σ says.

use nalgebra::DMatrix;

use super::model::Model;
use super::{Joint, Kind, Measurement};
use crate::solve::{Block, Loss, Minimum, Problem, covariance, minimise, polish, robust_scale};

/// Cutoff of the convex first round, in the measurements' own σ.
const FIRST_CUTOFF: f64 = 3.0;
/// Tukey's constants for 98 % efficiency on normal noise, for residuals of one coordinate (edges) and of two (pairs): clean
/// data lose 1 % of σ. (The usual 95 % would be 4.685 and 5.12.)
const CUTOFFS: [f64; 2] = [5.92, 6.43];
const EFFICIENCY: f64 = 0.98;
/// The inliers' scale is never taken for smaller than this part of the σ that was claimed: residuals of exact data are
/// rounding, and correlated edge points have σ three to four times their scatter.
const SMALLEST_SCALE: f64 = 0.25;
/// With fewer measurements of a kind than this, outliers cannot be told from what the fit needs.
const FEWEST_FOR_ROBUST: usize = 12;
const MAX_ROUNDS: usize = 8;
/// Rounds end when the scales change by less than this part.
const SCALE_CHANGE: f64 = 0.02;
/// 1σ that stands in for "no information" in the covariance (1000 % of a focal length, 10 widths, ten times the distance).
const VAGUE: f64 = 10.0;

/// An estimate with everything that is known about it.
#[derive(Debug, Clone)]
pub(crate) struct Fit {
    pub(crate) model: Model,
    pub(crate) cost: f64,
    pub(crate) iterations: usize,
    /// Whether each measurement was kept.
    pub(crate) inliers: Vec<bool>,
    /// Residual norm of each measurement, px.
    pub(crate) norms_px: Vec<f64>,
    /// By how much the σ of edges and pairs were widened (≥ 1).
    pub(crate) widened: [f64; 2],
    /// In the layout's order, focal lengths as ln f.
    pub(crate) covariance: DMatrix<f64>,
}

/// A residual's norm in σ, brought to one degree of freedom where it has two (a Rayleigh median is 1.746 times the normal
/// one).
pub(crate) fn whitened(m: &Measurement, norm_px: f64) -> f64 {
    const RAYLEIGH_TO_NORMAL: f64 = 1.745_6;
    let correction = if m.kind() == Kind::Edge { 1.0 } else { RAYLEIGH_TO_NORMAL };
    norm_px / m.sigma_px / correction
}

/// How widely the residuals of one kind scatter, in σ.
fn scale_of(joint: &Joint, norms_px: &[f64], kind: Kind) -> f64 {
    let of_kind = joint.measurements.iter().zip(norms_px).filter(|(m, _)| m.kind() == kind);
    robust_scale(of_kind.map(|(m, n)| whitened(m, *n))).max(SMALLEST_SCALE)
}

/// That of edges and of pairs.
fn scales_of(joint: &Joint, norms_px: &[f64]) -> [f64; 2] {
    [Kind::Edge, Kind::Pair].map(|k| scale_of(joint, norms_px, k))
}

fn redescending(scales: &[f64; 2], kind: Kind) -> Loss {
    let of = usize::from(kind == Kind::Pair);
    Loss::Tukey(CUTOFFS[of] * scales[of])
}

/// Which residuals the loss of their block does not cut off.
fn within_cutoffs(joint: &Joint, norms_px: &[f64]) -> Vec<bool> {
    let measured = joint.measurements.iter().zip(norms_px).zip(&joint.blocks);
    let within = |((m, n), block): ((&Measurement, &f64), &Block)| match block.loss {
        Loss::Tukey(c) => n / m.sigma_px < c,
        _ => true,
    };
    measured.map(within).collect()
}

/// The measurements that a fit with these residuals keeps: those within the cutoff of their kind.
pub(crate) fn kept(joint: &Joint, norms_px: &[f64]) -> Vec<bool> {
    let scales = scales_of(joint, norms_px);
    let mut joint = joint.clone();
    set_cutoffs(&mut joint, |kind| redescending(&scales, kind));
    within_cutoffs(&joint, norms_px)
}

fn set_cutoffs(joint: &mut Joint, loss: impl Fn(Kind) -> Loss) {
    for kind in [Kind::Edge, Kind::Pair] {
        let count = joint.measurements.iter().filter(|m| m.kind() == kind).count();
        if count >= FEWEST_FOR_ROBUST {
            joint.set_loss(kind, loss(kind));
        }
    }
}

/// Minimises from `start`; `None` when the model is not defined there or the numbers break down.
pub(crate) fn refine(joint: &mut Joint, start: Model) -> Option<Fit> {
    set_cutoffs(joint, |_| Loss::Huber(FIRST_CUTOFF));
    let mut minimum: Minimum<Model> = minimise(joint, start)?;
    let mut iterations = minimum.iterations;
    let mut scales = [f64::MAX; 2];
    for _ in 0..MAX_ROUNDS {
        minimum.state.renormalise();
        let norms = joint.norms_px(&minimum.state)?;
        let new = scales_of(joint, &norms);
        let settled = new.iter().zip(&scales).all(|(a, b)| (a - b).abs() <= SCALE_CHANGE * b);
        if settled {
            break;
        }
        scales = new;
        set_cutoffs(joint, |kind| redescending(&new, kind));
        minimum = minimise(joint, minimum.state)?;
        iterations += minimum.iterations;
    }
    // What damping left of the way would depend on the order of the views.
    minimum = polish(joint, minimum);
    minimum.state.renormalise();
    summarise(joint, minimum.state, minimum.cost, iterations)
}

fn summarise(joint: &Joint, model: Model, cost: f64, iterations: usize) -> Option<Fit> {
    let norms_px = joint.norms_px(&model)?;
    let inliers = within_cutoffs(joint, &norms_px);
    let widened = [Kind::Edge, Kind::Pair].map(|kind| widening(joint, &norms_px, &inliers, kind));
    let covariance = covariance_at(joint, &model, &inliers, widened)?;
    Some(Fit { model, cost, iterations, inliers, norms_px, widened, covariance })
}

/// The rms of the whitened inliers when it exceeds one; few measurements say nothing about their own noise.
fn widening(joint: &Joint, norms_px: &[f64], inliers: &[bool], kind: Kind) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for ((m, n), keep) in joint.measurements.iter().zip(norms_px).zip(inliers) {
        if *keep && m.kind() == kind {
            sum += (n / m.sigma_px).powi(2);
            count += if kind == Kind::Edge { 1 } else { 2 };
        }
    }
    if count < 2 * FEWEST_FOR_ROBUST { 1.0 } else { (sum / count as f64).sqrt().max(1.0) }
}

/// (JᵀWJ + priors)⁻¹ with outliers left out; directions that nothing determines get a σ that says so, never infinity.
pub(crate) fn covariance_at(
    joint: &Joint,
    model: &Model,
    inliers: &[bool],
    widened: [f64; 2],
) -> Option<DMatrix<f64>> {
    let mut j = joint.at(model)?.jacobian;
    let mut at = 0;
    for ((m, block), keep) in joint.measurements.iter().zip(&joint.blocks).zip(inliers) {
        let weight = match (m.kind(), block.loss) {
            _ if !keep => 0.0,
            (Kind::Edge | Kind::Pair, loss) => {
                let share = if matches!(loss, Loss::Tukey(_)) { EFFICIENCY.sqrt() } else { 1.0 };
                share / widened[usize::from(m.kind() == Kind::Pair)]
            }
            _ => 1.0,
        };
        j.rows_mut(at, block.len).scale_mut(weight);
        at += block.len;
    }
    let vague: Vec<f64> = units(joint, model).into_iter().map(|unit| 1.0 / (VAGUE * unit)).collect();
    covariance(&joint.structure(), &j, &vague)
}

/// The natural unit of each unknown: 1 for ln f, angles and coefficients, the width for pixels, the distance for lengths.
fn units(joint: &Joint, model: &Model) -> Vec<f64> {
    let layout = &joint.layout;
    // The furthest sheet's, whatever the order of the views.
    let distance = model.views.iter().map(|v| v.translation.norm()).fold(f64::MIN_POSITIVE, f64::max);
    let mut units = vec![1.0; layout.len];
    let lenses = [Some((&layout.camera, model.camera)), model.projector.map(|p| (&layout.projector, p))];
    for (places, lens) in lenses.into_iter().flatten() {
        for i in [1, 2].into_iter().filter_map(|k| places[k]) {
            units[i] = f64::from(lens.width);
        }
    }
    let poses = layout.stereo.into_iter().chain((0..model.views.len()).map(|i| layout.view(i)));
    for at in poses {
        units[at + 3..at + 6].fill(distance);
    }
    units
}
