//! The noise of observations that do not state it, measured by what they leave unexplained.
//!
//! Edge points, corners and pairs each have one unknown variance, pooled over the views. It is the sum of squared residuals
//! over their redundancy: their number less the unknowns that they themselves determine, which is the trace of their part
//! of the hat matrix (W. Förstner, "Ein Verfahren zur Schätzung von Varianz- und Kovarianzkomponenten", Allgemeine
//! Vermessungs-Nachrichten 86:446-453, 1979). The fit depends on the variances in turn, so that the two alternate.

pub(crate) mod neighbours;

use crate::calibrate::config::{CalibrateConfig, DistortionModel, Method};
use crate::calibrate::diagnostics::verdict::warning;
use crate::calibrate::maximum_likelihood::{Solved, solve};
use crate::calibrate::{Calibration, ViewResiduals, calibrate_observations, check, residuals};
use crate::error::Result;
use crate::estimate::refine::covariance_at;
use crate::estimate::{Joint, Kind};
use crate::observations::{ExternalObservations, Observations, SheetObservation, Unstated};
use crate::rig::{Rig, Warning};
use crate::solve::median;

/// σ that is assumed where it cannot be measured, as a part of the image's diagonal: 0.5 px at 1280×960. Detectors that
/// look at pixels come to between a tenth and the whole of it, corners pointed at by hand to several times as much.
const ASSUMED: f64 = 3e-4;
/// Beyond this part of the diagonal even hands do better, so that something else is wrong.
const LARGE: f64 = 2e-3;
/// Nobody measures better than this part of the diagonal: residuals of made-up numbers are rounding.
const SMALLEST: f64 = 1e-6;
/// With less redundancy than this, σ would itself be known to no better than a quarter.
const LEAST_REDUNDANCY: f64 = 8.0;
/// Alternations between fit and σ; three or four settle it.
const MAX_ROUNDS: usize = 8;
/// They end when no σ changes by more than this part.
const SETTLED: f64 = 0.02;
/// So many points of a side or of a pattern tell its noise to 2 %.
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

/// A calibration from observations of one's own.
#[derive(Debug, Clone, PartialEq)]
pub struct ExternalCalibration {
    /// The calibration; its warnings include what was assumed about noise.
    pub calibration: Calibration,
    /// The observations with every σ filled in, and at most 4000 points of a side and pairs of a view, spread evenly:
    /// calibrating from these gives the same rig.
    pub observations: Observations,
    /// The σ that were not stated.
    pub noise: Vec<NoiseFound>,
}

/// Calibrates from the observations of any detector. A σ that is not stated is measured by the residuals where there are
/// enough of them, pooled over the views, and assumed otherwise (with the warning `noise-assumed`). Of more than 4000
/// points of a side or pairs of a view an evenly spread part is used.
///
/// # Errors
/// As [`calibrate_observations`].
pub fn calibrate_external(
    external: &ExternalObservations,
    config: &CalibrateConfig,
) -> Result<ExternalCalibration> {
    let (observations, noise) = measure_noise(external, config)?;
    let mut calibration = calibrate_observations(&observations, config)?;
    if let Some(quality) = &mut calibration.rig.quality {
        quality.warnings.extend(noise.iter().filter_map(|n| told(n, diagonal(&observations))));
    }
    Ok(ExternalCalibration { calibration, observations, noise })
}

fn told(found: &NoiseFound, diagonal: f64) -> Option<Warning> {
    let (name, sigma) = (found.of.name(), found.sigma_px);
    if found.redundancy.is_none() {
        let field = if found.of == NoiseOf::Pairs { "pair_sigma_px" } else { "sheet_sigma_px" };
        return Some(warning(
            "noise-assumed",
            format!(
                "the noise of {name} is not stated and there are too few of them to measure it: {sigma:.2} px (1σ) was assumed, \
                 and σ of the results rests on that"
            ),
            format!("state it ({field}), or give more of them"),
        ));
    }
    (sigma > LARGE * diagonal).then(|| {
        warning(
            "noise-large",
            format!(
                "{name} scatter by {sigma:.1} px (1σ) about the model, more than corners pointed at by hand"
            ),
            "check their order, the sheet's size, and whether the lens distorts more than k1 and k2 can say",
        )
    })
}

fn diagonal(observations: &Observations) -> f64 {
    let [w, h] = observations.camera.map(f64::from);
    w.hypot(h)
}

/// The observations with every σ filled in, and those that were not stated.
fn measure_noise(
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
                found.sigma_px *= neighbours::widening(&all, wanted, &solved.fit.model, found.sigma_px);
            }
            break;
        }
    }
    fill(&mut all, external, &noise);
    Ok((all, noise))
}

/// What is not stated, before anything is known of it.
fn assumed(external: &ExternalObservations) -> Vec<NoiseFound> {
    let sigma_px = ASSUMED * diagonal(&external.observations);
    let views = 0..external.observations.views.len();
    let wanted = NoiseOf::ALL.into_iter().filter(|of| views.clone().any(|i| is_wanted(external, i, *of)));
    wanted.map(|of| NoiseFound { of, sigma_px, redundancy: None }).collect()
}

/// Whether view `i` has measurements of this kind whose σ is not stated.
fn is_wanted(external: &ExternalObservations, i: usize, of: NoiseOf) -> bool {
    let view = &external.observations.views[i];
    let there = match of {
        NoiseOf::SheetEdges => matches!(view.sheet, SheetObservation::Edges(_)),
        NoiseOf::SheetCorners => matches!(view.sheet, SheetObservation::Corners { .. }),
        NoiseOf::Pairs => external.observations.projector.is_some() && !view.pairs.is_empty(),
    };
    there && of.is_unstated(external.unstated(i))
}

/// The residuals of observations of one's own against the rig that was calibrated from them, and these observations with every
/// σ filled in: one that is not stated is how widely the residuals themselves scatter, pooled over the views (their median).
///
/// # Errors
/// As [`residuals`].
pub fn external_residuals(
    rig: &Rig,
    external: &ExternalObservations,
) -> Result<(Observations, Vec<ViewResiduals>)> {
    /// Outliers are told by σ: the first, which is assumed, may be far off.
    const ROUNDS: usize = 3;
    let mut observations = external.observations.clone();
    let mut noise = assumed(external);
    let smallest = SMALLEST * diagonal(&observations);
    for _ in 0..if noise.is_empty() { 0 } else { ROUNDS } {
        fill(&mut observations, external, &noise);
        let views = residuals(rig, &observations)?;
        // The pose of a view takes up nearly all that its four corners could tell.
        for found in noise.iter_mut().filter(|n| n.of != NoiseOf::SheetCorners) {
            let scatter = |(i, view): (usize, &ViewResiduals)| {
                let scatter =
                    if found.of == NoiseOf::Pairs { view.pair_scatter } else { Some(view.sheet_scatter) };
                scatter.filter(|_| is_wanted(external, i, found.of))
            };
            let typical = median(&mut views.iter().enumerate().filter_map(scatter).collect::<Vec<_>>());
            found.sigma_px = typical.map_or(found.sigma_px, |s| (s * found.sigma_px).max(smallest));
        }
    }
    fill(&mut observations, external, &noise);
    let views = residuals(rig, &observations)?;
    Ok((observations, views))
}

/// The model that leaves least of itself in the residuals: with distortion, unless that is told or known.
fn flexible(config: &CalibrateConfig) -> CalibrateConfig {
    let distortion = match config.distortion {
        DistortionModel::Auto if config.method == Method::Ml && config.known_camera.is_none() => {
            DistortionModel::K1K2
        }
        DistortionModel::Auto => DistortionModel::None,
        told => told,
    };
    CalibrateConfig { distortion, method: Method::Ml, ..config.clone() }
}

/// Puts the σ found so far where none was stated.
fn fill(observations: &mut Observations, external: &ExternalObservations, noise: &[NoiseFound]) {
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

/// σ of one kind by the residuals of a fit.
fn measured(solved: &mut Solved, external: &ExternalObservations, of: NoiseOf, diagonal: f64) -> NoiseFound {
    let wanted: Vec<bool> = solved
        .joint
        .measurements
        .iter()
        .map(|m| m.kind() == of.kind() && of.is_unstated(external.unstated(m.view)))
        .collect();
    let per_point = if of == NoiseOf::SheetEdges { 1.0 } else { 2.0 };
    let (mut squares, mut count) = (0.0, 0.0);
    let kept = solved.fit.norms_px.iter().zip(&solved.fit.inliers).zip(&wanted);
    for ((norm, _), _) in kept.filter(|((_, inlier), wanted)| **inlier && **wanted) {
        squares += norm * norm;
        count += per_point;
    }
    let redundancy = taken(solved, &wanted).map_or(0.0, |taken| count - taken);
    if redundancy < LEAST_REDUNDANCY {
        return NoiseFound { of, sigma_px: ASSUMED * diagonal, redundancy: None };
    }
    let sigma_px = (squares / redundancy).sqrt().max(SMALLEST * diagonal);
    NoiseFound { of, sigma_px, redundancy: Some(redundancy) }
}

/// How many unknowns the wanted measurements determine: the trace of their part of the hat matrix, as
/// d ln det(covariance) / d ln σ².
fn taken(solved: &mut Solved, wanted: &[bool]) -> Option<f64> {
    let Solved { joint, fit } = solved;
    let mut log_det = |step: f64| {
        scale(joint, wanted, step.exp());
        let covariance = covariance_at(joint, &fit.model, &fit.inliers, [1.0; 2]);
        scale(joint, wanted, (-step).exp());
        log_determinant(&covariance?)
    };
    Some((log_det(STEP)? - log_det(-STEP)?) / (4.0 * STEP))
}

fn scale(joint: &mut Joint, wanted: &[bool], factor: f64) {
    for (m, _) in joint.measurements.iter_mut().zip(wanted).filter(|(_, wanted)| **wanted) {
        m.sigma_px *= factor;
    }
}

/// ln det of a positive definite matrix, by the Cholesky factor of its correlations.
fn log_determinant(c: &nalgebra::DMatrix<f64>) -> Option<f64> {
    let sigma = c.diagonal().map(f64::sqrt);
    let correlation =
        nalgebra::DMatrix::from_fn(c.nrows(), c.ncols(), |i, j| c[(i, j)] / (sigma[i] * sigma[j]));
    let factor = correlation.cholesky()?;
    let of_factor: f64 = factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum();
    let all = 2.0 * (of_factor + sigma.iter().map(|s| s.ln()).sum::<f64>());
    all.is_finite().then_some(all)
}

#[cfg(test)]
mod tests;
