//! What the fit itself tells about its weights: how noisy and how correlated edge points are, and how far the sheets bend.
//!
//! Both are found by the marginal (restricted) likelihood of the linearised problem, in which all unknowns are integrated
//! out (H. D. Patterson, R. Thompson, "Recovery of inter-block information when block sizes are unequal", Biometrika 58
//! (1971)): residuals alone would say too little, since bends and distortion have already taken the slow part of them.

use nalgebra::{DMatrix, DVector};

use super::measurement::{Kind, Measurement, Target};
use super::model::Model;
use super::problem::BundleAdjustment;
use super::residual::{BEND, POSE};
use crate::geometry::SheetBend;
use crate::solve::{MarginalLikelihood, Problem, median};

/// With fewer edge points than this in all, their own σ stands.
const FEWEST_EDGES: usize = 40;
/// Correlation lengths that are tried, in the typical distance of neighbours; zero is none.
const LENGTHS: [f64; 9] = [0.0, 0.35, 0.6, 1.0, 1.6, 2.5, 4.0, 6.0, 9.0];
/// The independent model stands unless another one is this much more likely (ln): chance gains as much once in 20 times.
const LEAST_GAIN: f64 = 1.9;
/// Longer lengths are not tried when one is less likely than the best by this (ln).
const PAST_THE_BEST: f64 = 4.0;
/// Most rounds towards the scale of the noise; two suffice unless it is far off.
const SCALE_ROUNDS: usize = 6;
/// Widths of the priors on bends that are tried, in those expected: of order 2, which may only be widened, and of
/// orders 3 and 4. (A pure curl has nine zero terms of the higher orders, which would narrow a common width.)
pub(crate) const WIDEST: f64 = 3.0;
const WIDTHS_OF_2: [f64; 6] = [1.0, 1.25, 1.55, 1.95, 2.4, WIDEST];
const WIDTHS_OF_3: [f64; 11] = [1.0 / WIDEST, 0.42, 0.53, 0.66, 0.81, 1.0, 1.25, 1.55, 1.95, 2.4, WIDEST];
/// 1σ of ln(width): widths that nothing tells stay one.
const WIDTH_SIGMA: f64 = 0.7;

/// The linearised problem, outliers left out.
struct Linear<'a> {
    problem: &'a BundleAdjustment,
    jacobian: DMatrix<f64>,
    residuals: DVector<f64>,
    keep: &'a [bool],
}

impl<'a> Linear<'a> {
    fn new(problem: &'a BundleAdjustment, model: &Model, keep: &'a [bool]) -> Option<Self> {
        let at = problem.at(model)?;
        Some(Self { problem, jacobian: at.jacobian, residuals: at.residuals, keep })
    }

    /// First rows of the measurements that are kept.
    fn kept(&self) -> impl Iterator<Item = (&Measurement, usize)> {
        let starts = self.problem.measurements.iter().scan(0, |at, m| {
            *at += m.rows();
            Some(*at - m.rows())
        });
        let all = self.problem.measurements.iter().zip(starts);
        all.zip(self.keep).filter(|(_, keep)| **keep).map(|(m, _)| m)
    }

    /// Weights of all rows: one, and none for outliers.
    fn weights(&self) -> Vec<f64> {
        self.problem.row_weights(self.keep.iter().map(|keep| f64::from(*keep)))
    }
}

/// Edge points that follow each other on a side: the row of the one before, the row, and how far they are apart, px.
fn neighbours(linear: &Linear) -> Vec<(usize, usize, f64)> {
    let mut edges: Vec<(usize, usize, &Measurement, usize)> = Vec::new();
    for (m, row) in linear.kept() {
        if let Target::Edge(side) = m.of {
            edges.push((m.view, side as usize, m, row));
        }
    }
    let mut pairs = Vec::new();
    for side in edges.chunk_by_mut(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let ends = [side[0].2.seen, side[side.len() - 1].2.seen];
        let along = ends[1] - ends[0];
        side.sort_by(|a, b| a.2.seen.coords.dot(&along).total_cmp(&b.2.seen.coords.dot(&along)));
        pairs.extend(side.windows(2).map(|w| (w[0].3, w[1].3, (w[1].2.seen - w[0].2.seen).norm())));
    }
    pairs
}

/// By what the σ of edge points is to be multiplied so that they may count as independent, from the variance and the correlation
/// length of their noise by restricted maximum likelihood, pooled over all sides; `None` where there are too few. The noise is that of a first-order autoregressive sequence along each side, whose inverse covariance has a
/// bidiagonal root.
pub(crate) fn edge_inflation(problem: &BundleAdjustment, model: &Model, keep: &[bool]) -> Option<f64> {
    let linear = Linear::new(problem, model, keep)?;
    let rows: Vec<usize> =
        linear.kept().filter(|(m, _)| m.kind() == Kind::Edge).map(|(_, row)| row).collect();
    if rows.len() < FEWEST_EDGES {
        return None;
    }
    let pairs = neighbours(&linear);
    let spacing = median(&mut pairs.iter().map(|p| p.2).collect::<Vec<_>>()).filter(|s| *s > 0.0)?;
    let structure = problem.structure();
    // Everything else, whose weights stay.
    let mut others = linear.weights();
    let mut edges = vec![0.0; others.len()];
    for &row in &rows {
        (others[row], edges[row]) = (0.0, 1.0);
    }
    let others = MarginalLikelihood::new(&structure, &linear.jacobian, linear.residuals.as_slice(), &others)?;
    let mut best: Option<(f64, f64)> = None;
    for length in LENGTHS {
        let correlation =
            |distance: f64| if length > 0.0 { (-distance / (length * spacing)).exp() } else { 0.0 };
        let (jacobian, residuals, determinant) = whitened(&linear, &pairs, correlation);
        let edges = others.of(&structure, &jacobian, residuals.as_slice(), &edges)?;
        let Some((scale, likelihood)) =
            best_scale(rows.len(), |scale| others.with(&structure, &edges, 1.0 / scale).ln(&structure))
        else {
            continue;
        };
        let rho = correlation(spacing);
        let inflation = scale * ((1.0 + rho) / (1.0 - rho)).sqrt();
        let likelihood = likelihood + determinant - if length > 0.0 { LEAST_GAIN } else { 0.0 };
        if inflation.is_finite() && best.is_none_or(|(most, _)| likelihood > most) {
            best = Some((likelihood, inflation));
        } else if best.is_some_and(|(most, _)| likelihood < most - PAST_THE_BEST) {
            break;
        }
    }
    best.map(|(_, inflation)| inflation)
}

/// Rows of edge points made independent: each less what the one before tells, with ln of the determinant of that.
fn whitened(
    linear: &Linear,
    pairs: &[(usize, usize, f64)],
    correlation: impl Fn(f64) -> f64,
) -> (DMatrix<f64>, DVector<f64>, f64) {
    let (mut jacobian, mut residuals, mut determinant) =
        (linear.jacobian.clone(), linear.residuals.clone(), 0.0);
    for &(before, row, distance) in pairs {
        let rho = correlation(distance);
        if rho > 0.0 {
            let root = (1.0 - rho * rho).sqrt();
            for (mut to, from) in jacobian.column_iter_mut().zip(linear.jacobian.column_iter()) {
                to[row] = (from[row] - rho * from[before]) / root;
            }
            residuals[row] = (linear.residuals[row] - rho * linear.residuals[before]) / root;
            determinant -= root.ln();
        }
    }
    (jacobian, residuals, determinant)
}

/// The scale of the noise of `count` rows of the greatest likelihood, and that likelihood. In ln s it has very nearly the form
/// −ν·ln s − q/(2s²), with ν the degrees of freedom that the unknowns leave: three scales determine it.
fn best_scale(count: usize, ln: impl Fn(f64) -> Option<f64>) -> Option<(f64, f64)> {
    const STEP: f64 = 1.3;
    let at = |s: f64| Some(ln(s)? - count as f64 * s.ln());
    let mut scale: f64 = 1.0;
    for _ in 0..SCALE_ROUNDS {
        let [less, here, more] = [at(scale / STEP)?, at(scale)?, at(scale * STEP)?];
        // Differences in units of this scale: less − here = ν·L − (q/2)(S − 1), more − here = −ν·L − (q/2)(1/S − 1).
        let (l, s) = (STEP.ln(), STEP * STEP);
        let half_q = -((less - here) + (more - here)) / ((s - 1.0) + (1.0 / s - 1.0));
        let nu = ((less - here) + half_q * (s - 1.0)) / l;
        let next = scale * (2.0 * half_q / nu).sqrt().clamp(0.2, 5.0);
        if !next.is_finite() {
            return None;
        }
        let done = (next / scale).ln().abs() < 0.1 * l;
        scale = next;
        if done {
            break;
        }
    }
    Some((scale, at(scale)?))
}

/// By how much the priors on bends of order 2, and of orders 3 and 4, are to be wider, pooled over the views.
pub(crate) fn bend_widths(problem: &BundleAdjustment, model: &Model, keep: &[bool]) -> Option<[f64; 2]> {
    let linear = Linear::new(problem, model, keep)?;
    let (structure, mut weights) = (problem.structure(), linear.weights());
    let views = problem.priors.bends.len();
    let first = problem.measurements.iter().map(Measurement::rows).sum::<usize>();
    weights[first..first + views * BEND].fill(0.0);
    let base = MarginalLikelihood::new(&structure, &linear.jacobian, linear.residuals.as_slice(), &weights)?;
    let counts = [0, 1].map(|i| (0..BEND).filter(|k| usize::from(SheetBend::order(*k) > 2) == i).count());
    let mut best = (f64::NEG_INFINITY, [1.0; 2]);
    for of_2 in WIDTHS_OF_2 {
        for of_3 in WIDTHS_OF_3 {
            let widths: [f64; 2] = [of_2, of_3];
            let width = |k: usize| widths[usize::from(SheetBend::order(k) > 2)];
            let marginal = base.with_own_rows(&structure, |view, column| {
                let k = column.checked_sub(POSE)?;
                let sigma = problem.priors.bends[view][k] * width(k);
                Some((1.0 / sigma, model.views[view].bend.0[k] / sigma))
            });
            let likelihood = marginal.ln(&structure)?
                - (0..2).map(|i| (views * counts[i]) as f64 * widths[i].ln()).sum::<f64>()
                - widths.iter().map(|w| (w.ln() / WIDTH_SIGMA).powi(2) / 2.0).sum::<f64>();
            if likelihood > best.0 {
                best = (likelihood, widths);
            }
        }
    }
    best.0.is_finite().then_some(best.1)
}
