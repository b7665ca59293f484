//! Whether the photographs show that the camera or the projector distorts: the data decide.

use crate::calibrate::config::{CalibrateConfig, VIEWS_FOR_PROJECTOR_DISTORTION};
use crate::calibrate::maximum_likelihood::{add_projector, solve_camera};
use crate::error::{Error, Result};
use crate::estimate::assumptions::DistortionModel;
use crate::estimate::{Kind, Solution, prior};
use crate::observations::Observations;
use crate::solve::median;

/// A lens's distortion is estimated when it lowers χ² by more than this. Distortion that stays hidden moves everything
/// else without a trace in σ, while coefficients that a straight lens does not need cost next to nothing, as their own σ is
/// counted: so the limit is what chance reaches once in a hundred for two coefficients. (With the priors on k1 and k2, even
/// odds between a straight lens and a bent one lie at 5 to 8.) At 30, 95 % intervals of two photographs with corners alone
/// were seen to hold the truth in 78 % of draws with k1 of 0.02.
const LEAST_GAIN: f64 = 9.2;
/// Residuals count up to this many times the typical one, so that outliers of either fit do not decide.
const CAP: f64 = 5.0;

/// Claimed σ are never taken for too large: correlated points scatter less than their σ without carrying more information.
const MIN_UNIT: f64 = 1.0;

/// What `Auto` stands for: none, or k1 with k2.
///
/// k2 goes with k1: on real lenses k1 alone is misspecified, and its prior keeps k2 small where nothing shows it.
const CHOICE: [DistortionModel; 2] = [DistortionModel::None, DistortionModel::K1K2];

fn choices(asked: DistortionModel, open: bool) -> Vec<DistortionModel> {
    match asked {
        DistortionModel::Auto if open => CHOICE.to_vec(),
        DistortionModel::Auto => vec![DistortionModel::None],
        given => vec![given],
    }
}

/// The fit under `config`, with [`DistortionModel::Auto`] of either device resolved to `None` or `K1K2`.
///
/// Every combination is fitted, since either lens can take up part of what the other one does.
pub(crate) fn solve_choosing(
    observations: &Observations,
    config: &CalibrateConfig,
) -> Result<(Solution, CalibrateConfig)> {
    let enough =
        observations.projector.is_some() && observations.views.len() >= VIEWS_FOR_PROJECTOR_DISTORTION;
    let mut fits = Vec::new();
    let mut complaint = None;
    for distortion in choices(config.distortion, config.known_camera.is_none()) {
        let camera = solve_camera(observations, &CalibrateConfig { distortion, ..config.clone() });
        for projector_distortion in choices(config.projector_distortion, enough) {
            let config = CalibrateConfig { distortion, projector_distortion, ..config.clone() };
            let solved =
                camera.as_ref().map_err(Clone::clone).and_then(|c| add_projector(observations, &config, c));
            match solved {
                Ok(solved) => fits.push((solved, config)),
                Err(e) => complaint = complaint.or(Some(e)),
            }
        }
    }
    choose(fits).ok_or_else(|| complaint.unwrap_or_else(nothing_fitted))
}

/// Only where no model was tried at all, which the configuration does not allow.
fn nothing_fitted() -> Error {
    Error::invalid("distortion", "a model of the lens", "none")
}

/// The fit of the smallest χ², in units of what remains under the freest model, where every distorted lens has to lower χ²
/// by [`LEAST_GAIN`].
fn choose(fits: Vec<(Solution, CalibrateConfig)>) -> Option<(Solution, CalibrateConfig)> {
    let units = units(&fits.last()?.0);
    let price = |config: &CalibrateConfig| {
        let bent = [config.distortion, config.projector_distortion];
        bent.iter().filter(|d| **d != DistortionModel::None).count() as f64 * LEAST_GAIN
    };
    let scored =
        fits.into_iter().map(|(solved, config)| (remains(&solved, units) + price(&config), solved, config));
    // Of those that tie, the first one, which is the simplest.
    let (_, solved, config) = scored.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((solved, config))
}

const KINDS: [Kind; 3] = [Kind::Edge, Kind::SheetCorner, Kind::Pair];

fn squares(s: &Solution, kind: Kind) -> impl Iterator<Item = f64> {
    s.measured().filter(move |(m, ..)| m.kind() == kind).map(|(m, norm, _)| (norm / m.sigma_px).powi(2))
}

/// The typical square of a measurement of each kind.
fn units(s: &Solution) -> [f64; 3] {
    KINDS.map(|kind| {
        // The medians of χ² with one and with two degrees of freedom, whose squares' scale is one.
        let expected = if kind == Kind::Edge { 0.455 } else { 1.386 };
        median(&mut squares(s, kind).collect::<Vec<_>>()).map_or(1.0, |m| (m / expected).max(MIN_UNIT))
    })
}

/// χ² in units of the typical square, outliers counted as far as [`CAP`], and that of the priors: a principal point that is
/// pulled away to stand in for distortion is a misfit as well.
fn remains(s: &Solution, units: [f64; 3]) -> f64 {
    let of_kinds = KINDS.iter().zip(units);
    let seen: f64 =
        of_kinds.map(|(&kind, unit)| squares(s, kind).map(|x| (x / unit).min(CAP * CAP)).sum::<f64>()).sum();
    seen + prior::chi_squared(&s.problem.priors, s.model())
}
