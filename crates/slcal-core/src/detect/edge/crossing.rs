//! Crossings of one side: a robust fit of a smooth curve, and the reduction to a few points.

use super::scan::Scan;
use crate::observations::EdgePoint;
use crate::solve::{Polynomial, median};

/// Degree of the curve of a side: the image of a straight line through an ordinary lens.
pub(super) const CURVE_DEGREE: usize = 3;
/// Crossings further from the curve than this many robust standard deviations are outliers.
const REJECT_SIGMAS: f64 = 3.5;
/// Points per side, each the mean over neighbouring crossings: more would add no information.
const MAX_POINTS: usize = 48;
/// Least standard deviation of a point, px: the effect of indirect light and shading on rendered sheets with exact ground
/// truth.
pub(super) const FLOOR_SIGMA_PX: f64 = 0.004;

/// One crossing of the side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    /// Row or column.
    pub(super) line: f64,
    /// Where on it, px.
    pub(super) position: f64,
    /// 1σ, px.
    pub(super) sigma: f64,
}

/// Fits the curve and removes the outliers from `crossings`.
pub(super) fn robust_curve(crossings: &mut Vec<Crossing>) -> Option<Polynomial> {
    let samples =
        |c: &[Crossing]| c.iter().map(|c| (c.line, c.position, c.sigma.powi(-2))).collect::<Vec<_>>();
    // A line through the medians of two parts is a robust start. The degree grows when outliers have been removed.
    let mut curve = median_line(crossings)?;
    let all = std::mem::take(crossings);
    let mut kept: Vec<Crossing> = Vec::new();
    for round in 0..8 {
        let mut residuals: Vec<f64> = all.iter().map(|c| (c.position - curve.value(c.line)).abs()).collect();
        let scale = 1.4826 * median(&mut residuals)?;
        let limit = (REJECT_SIGMAS * scale).max(0.02);
        kept = all.iter().copied().filter(|c| (c.position - curve.value(c.line)).abs() <= limit).collect();
        let degree = if round < 2 { 1 } else { CURVE_DEGREE };
        if kept.len() <= 2 * (degree + 1) {
            return None;
        }
        curve = Polynomial::fit(&samples(&kept), degree)?;
    }
    *crossings = kept;
    Some(curve)
}

/// A line through the medians of the first and the last third.
fn median_line(crossings: &[Crossing]) -> Option<Polynomial> {
    let third = crossings.len() / 3;
    if third == 0 {
        return None;
    }
    let middle = |part: &[Crossing]| {
        let mut lines: Vec<f64> = part.iter().map(|c| c.line).collect();
        let mut positions: Vec<f64> = part.iter().map(|c| c.position).collect();
        Some((median(&mut lines)?, median(&mut positions)?, 1.0))
    };
    Polynomial::fit(&[middle(&crossings[..third])?, middle(&crossings[crossings.len() - third..])?], 1)
}

/// Means over runs of neighbouring crossings, with a σ that includes the correlation of neighbours. No run holds
/// neighbours that are `separated`, by a part that was left out.
pub(super) fn condense(
    scan: Scan,
    crossings: &[Crossing],
    separated: impl Fn(&Crossing, &Crossing) -> bool,
    curve: &Polynomial,
    across: f64,
    common_sigma: f64,
) -> Vec<EdgePoint> {
    let run = crossings.len().div_ceil(MAX_POINTS);
    let means: Vec<(f64, f64, f64)> = crossings
        .chunks(run)
        .flat_map(|c| c.chunk_by(|a, b| !separated(a, b)))
        .map(|c| {
            let weight: f64 = c.iter().map(|c| c.sigma.powi(-2)).sum();
            let mean = |f: &dyn Fn(&Crossing) -> f64| {
                c.iter().map(|c| f(c) * c.sigma.powi(-2)).sum::<f64>() / weight
            };
            let line = mean(&|c| c.line);
            // Offsets from the curve are averaged, rather than positions: a run of a curved side is not biased towards its chord.
            let offset = mean(&|c| c.position - curve.value(c.line));
            (line, offset, weight.sqrt().recip())
        })
        .collect();
    let freedom = (means.len() as f64 - CURVE_DEGREE as f64 - 1.0).max(1.0);
    let chi = (means.iter().map(|m| (m.1 / m.2).powi(2)).sum::<f64>() / freedom).sqrt().max(1.0);
    let norm: f64 = means.iter().map(|m| (m.1 / m.2).powi(2)).sum();
    let lag: f64 = means.windows(2).map(|w| w[0].1 / w[0].2 * w[1].1 / w[1].2).sum();
    // A first-order autoregressive sequence of correlation ρ holds (1 − ρ)/(1 + ρ) as many independent points.
    let rho = if norm > 0.0 { (lag / norm).clamp(0.0, 0.9) } else { 0.0 };
    let inflation = chi * ((1.0 + rho) / (1.0 - rho)).sqrt();
    // The common part does not average out. Each point gets the share that leaves the mean with all of it.
    let shared = common_sigma * (means.len() as f64).sqrt();
    means
        .iter()
        .map(|&(line, offset, sigma)| EdgePoint {
            position: scan.join(line, curve.value(line) + offset),
            sigma_px: Some(((sigma * inflation).hypot(shared) * across).max(FLOOR_SIGMA_PX)),
        })
        .collect()
}
