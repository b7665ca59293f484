//! The noise of observations that do not state it, measured by what they leave unexplained.
//!
//! Edge points, corners and pairs each have one unknown variance, pooled over the views. It is the sum of squared residuals
//! over their redundancy: their number less the unknowns that they themselves determine, which is the trace of their part
//! of the hat matrix (W. Förstner, "Ein Verfahren zur Schätzung von Varianz- und Kovarianzkomponenten", Allgemeine
//! Vermessungs-Nachrichten 86:446-453, 1979). The fit depends on the variances in turn, so that the two alternate.

pub(crate) mod neighbours;

use crate::calibrate::config::{CalibrateConfig, Method};
use crate::calibrate::maximum_likelihood::solve;
use crate::calibrate::validate::check;
use crate::error::Result;
use crate::estimate::assumptions::DistortionModel;
use crate::estimate::covariance::{correlations, posterior};
use crate::estimate::{BundleAdjustment, Kind, Solution};
use crate::observations::{ExternalObservations, Observations, SheetObservation, Unstated};

/// σ that is assumed where it cannot be measured, as a part of the image's diagonal: 0.5 px at 1280×960. Detectors that
/// look at pixels come to between a tenth and the whole of it, corners pointed at by hand to several times as much.
const ASSUMED: f64 = 3e-4;
/// Nobody measures better than this part of the diagonal: residuals of made-up numbers are rounding.
pub(crate) const SMALLEST: f64 = 1e-6;
/// With less redundancy than this, σ would itself be known to no better than a quarter.
const LEAST_REDUNDANCY: f64 = 8.0;
/// Alternations between fit and σ; three or four settle it.
const MAX_ROUNDS: usize = 8;
/// They end when no σ changes by more than this part.
const SETTLED: f64 = 0.02;
/// This many points of a side or of a pattern determine its noise to 2 %.
const ENOUGH_FOR_NOISE: usize = 1000;
/// Of more points than this on a side or in a pattern the noise that they average to is far below every model's error, and
/// only the time that they take grows.
const MOST_POINTS: usize = 4000;
/// Step in ln σ over which the covariance is differentiated.
const STEP: f64 = 0.05;

/// What a σ is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseOf {
    /// The points on the sheet's sides, across the side.
    SheetEdges,
    /// The sheet's corners, per coordinate.
    SheetCorners,
    /// The camera's pixel of the pairs, per coordinate.
    Pairs,
}

impl NoiseOf {
    const ALL: [Self; 3] = [Self::SheetEdges, Self::SheetCorners, Self::Pairs];

    fn kind(self) -> Kind {
        match self {
            Self::SheetEdges => Kind::Edge,
            Self::SheetCorners => Kind::SheetCorner,
            Self::Pairs => Kind::Pair,
        }
    }

    fn is_unstated(self, unstated: Unstated) -> bool {
        if self == Self::Pairs { unstated.pairs } else { unstated.sheet }
    }

    /// In words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::SheetEdges => "the sheet's edge points",
            Self::SheetCorners => "the sheet's corners",
            Self::Pairs => "the pairs",
        }
    }
}

/// A σ that was not stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseFound {
    /// What it is of.
    pub of: NoiseOf,
    /// 1σ, px; for edge points widened by what neighbours have in common.
    pub sigma_px: f64,
    /// By how many numbers it was measured; `None` when there are too few and it was assumed.
    pub redundancy: Option<f64>,
}

pub(crate) fn diagonal(observations: &Observations) -> f64 {
    let [w, h] = observations.camera.map(f64::from);
    w.hypot(h)
}

/// The observations with every σ filled in, and those that were not stated.
pub(crate) fn measure_noise(
    external: &ExternalObservations,
    config: &CalibrateConfig,
) -> Result<(Observations, Vec<NoiseFound>)> {
    let diagonal = diagonal(&external.observations);
    let mut noise = assumed(external);
    let mut all = external.observations.clone();
    fill(&mut all, external, &noise);
    check(&all, config)?;
    let mut all = thinned(&all, MOST_POINTS);
    if noise.is_empty() {
        return Ok((all, noise));
    }
    let mut few = thinned(&all, ENOUGH_FOR_NOISE);
    let flexible = flexible(config);
    for _ in 0..MAX_ROUNDS {
        fill(&mut few, external, &noise);
        // What cannot be solved is refused by the calibration itself, with its reason.
        let Ok(mut solved) = solve(&few, &flexible) else { break };
        let before = noise.clone();
        for found in &mut noise {
            *found = measured(&mut solved, external, found.of, diagonal);
        }
        if noise.iter().zip(&before).all(|(a, b)| (a.sigma_px / b.sigma_px).ln().abs() < SETTLED) {
            for found in noise.iter_mut().filter(|n| n.of == NoiseOf::SheetEdges && n.redundancy.is_some()) {
                let wanted = |view: usize| external.unstated(view).sheet;
                found.sigma_px *= neighbours::widening(&all, wanted, solved.model(), found.sigma_px);
            }
            break;
        }
    }
    fill(&mut all, external, &noise);
    Ok((all, noise))
}

/// What is not stated, before anything is known of it.
pub(crate) fn assumed(external: &ExternalObservations) -> Vec<NoiseFound> {
    let sigma_px = ASSUMED * diagonal(&external.observations);
    let views = 0..external.observations.views.len();
    let wanted = NoiseOf::ALL.into_iter().filter(|of| views.clone().any(|i| is_wanted(external, i, *of)));
    wanted.map(|of| NoiseFound { of, sigma_px, redundancy: None }).collect()
}

/// Whether view `i` has measurements of this kind whose σ is not stated.
pub(crate) fn is_wanted(external: &ExternalObservations, i: usize, of: NoiseOf) -> bool {
    let view = &external.observations.views[i];
    let there = match of {
        NoiseOf::SheetEdges => matches!(view.sheet, SheetObservation::Edges(_)),
        NoiseOf::SheetCorners => matches!(view.sheet, SheetObservation::Corners { .. }),
        NoiseOf::Pairs => external.observations.projector.is_some() && !view.pairs.is_empty(),
    };
    there && of.is_unstated(external.unstated(i))
}

/// The model that leaves least of itself in the residuals: with distortion, unless that is given or known.
fn flexible(config: &CalibrateConfig) -> CalibrateConfig {
    let distortion = match config.distortion {
        DistortionModel::Auto if config.method == Method::Ml && config.known_camera.is_none() => {
            DistortionModel::K1K2
        }
        DistortionModel::Auto => DistortionModel::None,
        given => given,
    };
    CalibrateConfig { distortion, method: Method::Ml, ..config.clone() }
}

/// Puts the σ found so far where none was stated.
pub(crate) fn fill(observations: &mut Observations, external: &ExternalObservations, noise: &[NoiseFound]) {
    let sigma = |of: NoiseOf| noise.iter().find(|n| n.of == of).map(|n| n.sigma_px);
    for (i, view) in observations.views.iter_mut().enumerate() {
        let unstated = external.unstated(i);
        match (&mut view.sheet, sigma(NoiseOf::SheetEdges), sigma(NoiseOf::SheetCorners)) {
            (SheetObservation::Edges(sides), Some(s), _) if unstated.sheet => {
                sides.iter_mut().flatten().for_each(|p| p.sigma_px = s);
            }
            (SheetObservation::Corners { sigma_px, .. }, _, Some(s)) if unstated.sheet => *sigma_px = s,
            _ => {}
        }
        if let (true, Some(s)) = (unstated.pairs, sigma(NoiseOf::Pairs)) {
            view.pairs.iter_mut().for_each(|p| p.sigma_px = s);
        }
    }
}

/// At most `most` of each side and of each view's pairs, spread evenly.
fn thinned(all: &Observations, most: usize) -> Observations {
    let mut few = all.clone();
    for view in &mut few.views {
        thin(&mut view.pairs, most);
        if let SheetObservation::Edges(sides) = &mut view.sheet {
            for side in sides {
                thin(side, most);
            }
        }
    }
    few
}

/// Keeps one of every `len / most` neighbours, each at another place among them: of a grid, whose rows are listed one after
/// the other, a fixed step may hit a single column.
fn thin<T: Copy>(points: &mut Vec<T>, most: usize) {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    if points.len() > most {
        let step = points.len() as f64 / most as f64;
        let place = |i: usize| (i as f64 + (i as f64 * GOLDEN).fract()) * step;
        *points = (0..most).map(|i| points[(place(i) as usize).min(points.len() - 1)]).collect();
    }
}

/// σ of one kind by the residuals of a solution.
fn measured(
    solution: &mut Solution,
    external: &ExternalObservations,
    of: NoiseOf,
    diagonal: f64,
) -> NoiseFound {
    let is_wanted = |view: usize, kind| kind == of.kind() && of.is_unstated(external.unstated(view));
    let wanted: Vec<bool> = solution.measured().map(|(m, ..)| is_wanted(m.view, m.kind())).collect();
    let (mut squares, mut count) = (0.0, 0);
    for ((m, norm, _), _) in solution.measured().zip(&wanted).filter(|((.., keep), wanted)| *keep && **wanted)
    {
        squares += norm * norm;
        count += m.rows();
    }
    let redundancy = taken(solution, &wanted).map_or(0.0, |taken| count as f64 - taken);
    if redundancy < LEAST_REDUNDANCY {
        return NoiseFound { of, sigma_px: ASSUMED * diagonal, redundancy: None };
    }
    let sigma_px = (squares / redundancy).sqrt().max(SMALLEST * diagonal);
    NoiseFound { of, sigma_px, redundancy: Some(redundancy) }
}

/// How many unknowns the wanted measurements determine: the trace of their part of the hat matrix, as
/// d ln det(covariance) / d ln σ².
fn taken(solution: &mut Solution, wanted: &[bool]) -> Option<f64> {
    let Solution { problem, fit, .. } = solution;
    let mut log_det = |step: f64| {
        scale(problem, wanted, step.exp());
        let covariance = posterior(problem, &fit.state, &fit.inliers, [1.0; 2]);
        scale(problem, wanted, (-step).exp());
        log_determinant(&covariance?)
    };
    Some((log_det(STEP)? - log_det(-STEP)?) / (4.0 * STEP))
}

fn scale(problem: &mut BundleAdjustment, wanted: &[bool], factor: f64) {
    for (m, _) in problem.measurements.iter_mut().zip(wanted).filter(|(_, wanted)| **wanted) {
        m.sigma_px *= factor;
    }
}

/// ln det of a positive definite matrix, by the Cholesky factor of its correlations.
fn log_determinant(c: &nalgebra::DMatrix<f64>) -> Option<f64> {
    let (sigma, correlations) = correlations(c);
    let factor = correlations.cholesky()?;
    let of_factor: f64 = factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum();
    let all = 2.0 * (of_factor + sigma.iter().map(|s| s.ln()).sum::<f64>());
    all.is_finite().then_some(all)
}

#[cfg(test)]
mod tests;
