//! The robust fit: outliers lose their influence.
//!
//! The loss starts convex (Huber) and ends redescending (Tukey), with the cutoff at a multiple of the inliers' own scale.

use super::measurement::{Kind, Measurement};
use crate::solve::{
    Block, CONVERGED_DECREASE, INITIAL_DAMPING, Loss, Minimum, Problem, minimise_from, polish, robust_scale,
};

/// Cutoff of the convex first round, in the measurements' own σ.
const FIRST_CUTOFF: f64 = 3.0;
/// What is measured often enough to detect outliers.
const KINDS: [Kind; 2] = [Kind::Edge, Kind::Pair];
/// Tukey's constants for 98 % efficiency on normal noise, for residuals of one coordinate (edges) and of two (pairs): clean
/// data lose 1 % of σ. (The usual 95 % would be 4.685 and 5.12.)
const CUTOFFS: [f64; 2] = [5.92, 6.43];
/// See [`CUTOFFS`].
pub(crate) const EFFICIENCY: f64 = 0.98;
/// The inliers' scale is never taken for smaller than this part of the σ that was claimed: residuals of exact data are
/// rounding, and correlated edge points have σ three to four times their scatter.
const SMALLEST_SCALE: f64 = 0.25;
/// With fewer measurements of a kind than this, outliers cannot be distinguished from what the fit needs.
const FEWEST_FOR_ROBUST: usize = 12;
const MAX_ROUNDS: usize = 8;
/// Residuals that scatter by more than this many σ mean a start that is far off; as long as they fall by this factor, the cutoff of
/// the first round follows them.
const FAR: f64 = 2.0;
/// Rounds end when the scales change by less than this part.
const SCALE_CHANGE: f64 = 0.02;
/// Until the scales are found, χ² is minimised to this: the parameters are then within a thirtieth of their σ.
const COARSE_DECREASE: f64 = 1e-3;
/// Damping where the minimum is near.
const NEAR_DAMPING: f64 = 1e-9;

/// A problem whose first blocks are measurements, some of which may be outliers.
pub(crate) trait RobustProblem: Problem {
    /// The measurements, and the blocks that begin with theirs.
    fn measured(&mut self) -> (&[Measurement], &mut [Block]);
    /// Residual norm of each measurement, px.
    fn norms_px(&self, state: &Self::State) -> Option<Vec<f64>>;
    /// Removes the drift from orthonormality that products of rotations collect.
    fn renormalise(state: &mut Self::State);
}

/// Where a robust fit ended.
#[derive(Debug, Clone)]
pub(crate) struct RobustFit<S> {
    pub(crate) state: S,
    pub(crate) cost: f64,
    pub(crate) iterations: usize,
    /// Whether each measurement was kept.
    pub(crate) inliers: Vec<bool>,
    /// Residual norm of each measurement, px.
    pub(crate) norms_px: Vec<f64>,
    /// By how much the σ of edges and pairs are to be widened (≥ 1).
    pub(crate) widened: [f64; 2],
}

/// A residual's norm in σ, brought to one degree of freedom where it has two (a Rayleigh median is 1.746 times the normal
/// one).
pub(crate) fn whitened(m: &Measurement, norm_px: f64) -> f64 {
    const RAYLEIGH_TO_NORMAL: f64 = 1.745_6;
    let correction = if m.kind() == Kind::Edge { 1.0 } else { RAYLEIGH_TO_NORMAL };
    norm_px / m.sigma_px / correction
}

/// How widely the residuals of edges and of pairs scatter, in σ.
fn scales(measurements: &[Measurement], norms_px: &[f64]) -> [f64; 2] {
    KINDS.map(|kind| {
        let of_kind = measurements.iter().zip(norms_px).filter(|(m, _)| m.kind() == kind);
        robust_scale(of_kind.map(|(m, n)| whitened(m, *n))).max(SMALLEST_SCALE)
    })
}

/// Losses that bound the influence of edges and of pairs, where there are enough of them.
fn bounded(measurements: &[Measurement], losses: [Loss; 2]) -> impl Fn(&Measurement) -> Loss + use<> {
    let of_kind = |i: usize| {
        let count = measurements.iter().filter(|m| m.kind() == KINDS[i]).count();
        if count >= FEWEST_FOR_ROBUST { losses[i] } else { Loss::Square }
    };
    let losses = [of_kind(0), of_kind(1)];
    move |m| KINDS.iter().position(|k| *k == m.kind()).map_or(Loss::Square, |i| losses[i])
}

fn redescending(scales: [f64; 2]) -> [Loss; 2] {
    [0, 1].map(|i| Loss::Tukey(CUTOFFS[i] * scales[i]))
}

fn set_losses<P: RobustProblem>(problem: &mut P, losses: [Loss; 2]) {
    let (measurements, blocks) = problem.measured();
    let loss = bounded(measurements, losses);
    measurements.iter().zip(blocks).for_each(|(m, block)| block.loss = loss(m));
}

fn is_within(loss: Loss, m: &Measurement, norm_px: f64) -> bool {
    match loss {
        Loss::Tukey(cutoff) => norm_px / m.sigma_px < cutoff,
        _ => true,
    }
}

/// The measurements that a fit with these residuals keeps: those within the cutoff of their kind.
pub(crate) fn kept(measurements: &[Measurement], norms_px: &[f64]) -> Vec<bool> {
    let loss = bounded(measurements, redescending(scales(measurements, norms_px)));
    measurements.iter().zip(norms_px).map(|(m, n)| is_within(loss(m), m, *n)).collect()
}

/// The minimum of the convex loss. A search that ends where little fits is repeated with a cutoff that comes down.
fn first_minimum<P: RobustProblem>(problem: &mut P, start: P::State) -> Option<Minimum<P::State>> {
    set_losses(problem, [Loss::Huber(FIRST_CUTOFF); 2]);
    let direct = minimise_from(problem, start.clone(), INITIAL_DAMPING, COARSE_DECREASE);
    let norms = direct.as_ref().and_then(|m| problem.norms_px(&m.state));
    if norms.is_some_and(|norms| scales(problem.measured().0, &norms).iter().all(|s| *s < FAR)) {
        return direct;
    }
    let followed = approach(problem, start);
    direct.into_iter().chain(followed).min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// The same by way of wider cutoffs. Where the start is far off, every residual lies beyond the cutoff, and the sum of their absolute
/// values that is left has slow valleys: the cutoff follows the residuals down.
fn approach<P: RobustProblem>(problem: &mut P, mut state: P::State) -> Option<Minimum<P::State>> {
    let (mut widths, mut iterations) = ([f64::MAX; 2], 0);
    loop {
        let norms = problem.norms_px(&state)?;
        let now = scales(problem.measured().0, &norms);
        let falls = now.iter().zip(&widths).any(|(now, before)| *now > FAR && *now < before / FAR);
        widths = if falls { now.map(|s| s.max(1.0)) } else { [1.0; 2] };
        set_losses(problem, widths.map(|w| Loss::Huber(FIRST_CUTOFF * w)));
        let enough = COARSE_DECREASE * widths[0].min(widths[1]).powi(2);
        let mut minimum = minimise_from(problem, state, INITIAL_DAMPING, enough)?;
        iterations += minimum.iterations;
        if !falls {
            minimum.iterations = iterations;
            return Some(minimum);
        }
        state = minimum.state;
    }
}

/// Minimises from `start`; `None` when the model is not defined there or the numbers break down. `spent` is how many degrees
/// of freedom the fit takes from the residuals of edges and of pairs, for the widening of σ.
pub(crate) fn fit<P: RobustProblem>(
    problem: &mut P,
    start: P::State,
    spent: [usize; 2],
) -> Option<RobustFit<P::State>> {
    let mut minimum = first_minimum(problem, start)?;
    let mut iterations = minimum.iterations;
    let mut before = [f64::MAX; 2];
    for _ in 0..MAX_ROUNDS {
        P::renormalise(&mut minimum.state);
        let norms = problem.norms_px(&minimum.state)?;
        let now = scales(problem.measured().0, &norms);
        if now.iter().zip(&before).all(|(a, b)| (a - b).abs() <= SCALE_CHANGE * b) {
            break;
        }
        before = now;
        set_losses(problem, redescending(now));
        minimum = minimise_from(problem, minimum.state, NEAR_DAMPING, COARSE_DECREASE)?;
        iterations += minimum.iterations;
    }
    minimum = minimise_from(problem, minimum.state, NEAR_DAMPING, CONVERGED_DECREASE)?;
    iterations += minimum.iterations;
    // What damping left of the way would depend on the order of the views.
    minimum = polish(problem, minimum);
    P::renormalise(&mut minimum.state);
    let norms_px = problem.norms_px(&minimum.state)?;
    let (measurements, blocks) = problem.measured();
    let measured = measurements.iter().zip(&norms_px).zip(blocks);
    let inliers: Vec<bool> = measured.map(|((m, n), block)| is_within(block.loss, m, *n)).collect();
    let widened = [0, 1].map(|i| widening(measurements, &norms_px, &inliers, KINDS[i], spent[i]));
    Some(RobustFit { state: minimum.state, cost: minimum.cost, iterations, inliers, norms_px, widened })
}

/// The rms of the whitened inliers when it exceeds one; few measurements do not determine their own noise.
fn widening(
    measurements: &[Measurement],
    norms_px: &[f64],
    inliers: &[bool],
    kind: Kind,
    spent: usize,
) -> f64 {
    let (mut sum, mut rows) = (0.0, 0);
    for ((m, n), keep) in measurements.iter().zip(norms_px).zip(inliers) {
        if *keep && m.kind() == kind {
            sum += (n / m.sigma_px).powi(2);
            rows += m.rows();
        }
    }
    if rows < 2 * FEWEST_FOR_ROBUST { 1.0 } else { (sum / (rows - spent) as f64).sqrt().max(1.0) }
}
