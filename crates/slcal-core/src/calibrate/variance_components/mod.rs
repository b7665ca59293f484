//! The noise of observations that do not state it, measured by what they leave unexplained.
//!
//! Edge points, corners and pairs each have one unknown variance, pooled over the views. It is the sum of squared residuals
//! over their redundancy: their number less the unknowns that they themselves determine, which is the trace of their part
//! of the hat matrix (W. Förstner, "Ein Verfahren zur Schätzung von Varianz- und Kovarianzkomponenten", Allgemeine
//! Vermessungs-Nachrichten 86:446-453, 1979). The fit depends on the variances in turn, so that the two alternate.

pub(crate) mod neighbours;

use crate::calibrate::config::{CalibrateConfig, Method};
use crate::calibrate::maximum_likelihood::solve;
use crate::estimate::assumptions::DistortionModel;
use crate::estimate::covariance::{correlations, posterior};
use crate::estimate::{BundleAdjustment, Kind, Solution};
use crate::observations::{Observations, SheetObservation, ViewObservation};
use crate::rig::Warning;

/// σ that is assumed where it cannot be measured, as a part of the image's diagonal: 0.5 px at 1280×960. Detectors that
/// look at pixels come to between a tenth and the whole of it, corners pointed at by hand to several times as much.
const ASSUMED: f64 = 3e-4;
/// Beyond this part of the diagonal even hands do better, so that something else is wrong.
const LARGE: f64 = 2e-3;
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
pub(crate) enum NoiseOf {
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

    /// Whether a view has measurements of this kind whose σ is not stated.
    fn is_unstated_in(self, view: &ViewObservation) -> bool {
        match (self, &view.sheet) {
            (Self::SheetEdges, SheetObservation::Edges(_))
            | (Self::SheetCorners, SheetObservation::Corners { .. }) => !view.states_sheet_sigma(),
            (Self::Pairs, _) => !view.states_pair_sigma(),
            _ => false,
        }
    }

    /// For each view, whether it has measurements of this kind whose σ is not stated.
    pub(crate) fn unstated(self, observations: &Observations) -> Vec<bool> {
        let used = self != Self::Pairs || observations.projector.is_some();
        observations.views.iter().map(|view| used && self.is_unstated_in(view)).collect()
    }
}

/// A σ that was not stated.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct NoiseFound {
    /// What it is of.
    pub(crate) of: NoiseOf,
    /// 1σ, px; for edge points widened by what neighbours have in common.
    pub sigma_px: f64,
    /// By how many numbers it was measured; `None` when there are too few and it was assumed.
    pub redundancy: Option<f64>,
}

impl NoiseFound {
    /// What it is of, in words.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self.of {
            NoiseOf::SheetEdges => "the sheet's edge points",
            NoiseOf::SheetCorners => "the sheet's corners",
            NoiseOf::Pairs => "the pairs",
        }
    }
}

pub(crate) fn diagonal(observations: &Observations) -> f64 {
    let [w, h] = observations.camera.map(f64::from);
    w.hypot(h)
}

/// The observations with every σ filled in, and those that were not stated.
pub(crate) fn measure_noise(
    given: &Observations,
    config: &CalibrateConfig,
) -> (Observations, Vec<NoiseFound>) {
    let mut noise = assumed(given);
    let all = thinned(given, MOST_POINTS);
    let few = thinned(&all, ENOUGH_FOR_NOISE);
    let flexible = flexible(config);
    for _ in 0..if noise.is_empty() { 0 } else { MAX_ROUNDS } {
        // What cannot be solved is refused by the calibration itself, with its reason.
        let Ok(mut solved) = solve(&filled(&few, &noise), &flexible) else { break };
        let before = noise.clone();
        for found in &mut noise {
            *found = measured(&mut solved, given, found.of);
        }
        if noise.iter().zip(&before).all(|(a, b)| (a.sigma_px / b.sigma_px).ln().abs() < SETTLED) {
            for found in noise.iter_mut().filter(|n| n.of == NoiseOf::SheetEdges && n.redundancy.is_some()) {
                let wanted = found.of.unstated(given);
                found.sigma_px *= neighbours::widening(&all, &wanted, solved.model(), found.sigma_px);
            }
            break;
        }
    }
    (filled(&all, &noise), noise)
}

/// What is not stated, before anything is known of it.
pub(crate) fn assumed(observations: &Observations) -> Vec<NoiseFound> {
    let sigma_px = ASSUMED * diagonal(observations);
    let wanted = NoiseOf::ALL.into_iter().filter(|of| of.unstated(observations).contains(&true));
    wanted.map(|of| NoiseFound { of, sigma_px, redundancy: None }).collect()
}

/// What a user should know about a σ that was not stated.
pub(crate) fn warning(found: &NoiseFound, observations: &Observations) -> Option<Warning> {
    let (name, sigma) = (found.name(), found.sigma_px);
    if found.redundancy.is_none() {
        let field = if found.of == NoiseOf::Pairs { "pair_sigma_px" } else { "sheet_sigma_px" };
        return Some(Warning::new(
            "noise-assumed",
            format!(
                "the noise of {name} is not stated and there are too few of them to measure it: {sigma:.2} px (1σ) was assumed, \
                 and σ of the results rests on that"
            ),
            format!("state it ({field}), or give more of them"),
        ));
    }
    (sigma > LARGE * diagonal(observations)).then(|| {
        Warning::new(
            "noise-large",
            format!(
                "{name} scatter by {sigma:.1} px (1σ) about the model, more than corners pointed at by hand"
            ),
            "check their order, the sheet's size, and whether the lens distorts more than k1 and k2 can model",
        )
    })
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

/// The observations with the σ found so far where none is stated.
pub(crate) fn filled(observations: &Observations, noise: &[NoiseFound]) -> Observations {
    let sigma = |of: NoiseOf| noise.iter().find(|n| n.of == of).map(|n| n.sigma_px);
    let mut all = observations.clone();
    for view in &mut all.views {
        let sheet = match &view.sheet {
            SheetObservation::Edges(_) => sigma(NoiseOf::SheetEdges),
            SheetObservation::Corners { .. } => sigma(NoiseOf::SheetCorners),
        };
        view.map_sigma(|s| s.or(sheet), |s| s.or(sigma(NoiseOf::Pairs)));
    }
    all
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
fn measured(solution: &mut Solution, given: &Observations, of: NoiseOf) -> NoiseFound {
    let (diagonal, unstated) = (diagonal(given), of.unstated(given));
    let is_wanted = |view: usize, kind| kind == of.kind() && unstated[view];
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
