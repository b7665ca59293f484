//! Whether the photographs show the camera's distortion: the data decide.

use super::config::{CalibrateConfig, DistortionModel};
use super::joint::Kind;
use super::ml::{Solved, solve};
use crate::error::Result;
use crate::observations::Observations;

/// Distortion is estimated when it lowers χ², in units of what remains, by more than this. For two coefficients and
/// independent noise chance reaches 14 once in a thousand; twice that leaves room for what neighbours have in common.
const LEAST_GAIN: f64 = 30.0;
/// Residuals count up to this many times the typical one, so that outliers of either fit do not decide.
const CAP: f64 = 5.0;

/// The fit under `config`, with [`DistortionModel::Auto`] resolved to `None` or `K1K2`.
///
/// k2 goes with k1: on real lenses k1 alone is misspecified, and its prior keeps k2 small where nothing shows it.
pub(crate) fn solve_choosing(
    observations: &Observations,
    config: &CalibrateConfig,
) -> Result<(Solved, CalibrateConfig)> {
    let with = |distortion| CalibrateConfig { distortion, ..config.clone() };
    if config.distortion != DistortionModel::Auto {
        return Ok((solve(observations, config)?, config.clone()));
    }
    let (straight_config, bent_config) = (with(DistortionModel::None), with(DistortionModel::K1K2));
    let straight = solve(observations, &straight_config);
    if config.known_camera.is_some() {
        return Ok((straight?, straight_config));
    }
    match (straight, solve(observations, &bent_config)) {
        (Ok(straight), Ok(bent)) if gain(&straight, &bent) <= LEAST_GAIN => Ok((straight, straight_config)),
        (Err(_) | Ok(_), Ok(bent)) => Ok((bent, bent_config)),
        (straight, Err(_)) => Ok((straight?, straight_config)),
    }
}

/// The fall of χ² from the straight to the bent fit, in units of the bent fit's mean square, summed over edges and pairs.
fn gain(straight: &Solved, bent: &Solved) -> f64 {
    [Kind::Edge, Kind::SheetCorner, Kind::Pair]
        .into_iter()
        .map(|kind| {
            let squares = |s: &Solved| -> Vec<f64> {
                let of_kind =
                    s.joint.measurements.iter().zip(&s.fit.norms_px).filter(|(m, _)| m.kind() == kind);
                of_kind.map(|(m, norm)| (norm / m.sigma_px).powi(2)).collect()
            };
            let (before, after) = (squares(straight), squares(bent));
            let mut sorted = after.clone();
            sorted.sort_by(f64::total_cmp);
            // The median of χ²₁ is 0.455 of its mean. Below a scale of one the claimed σ stands.
            let unit = sorted.get(sorted.len() / 2).map_or(1.0, |m| (m / 0.455).max(MIN_UNIT));
            let capped = |v: &[f64]| v.iter().map(|x| (x / unit).min(CAP * CAP)).sum::<f64>();
            capped(&before) - capped(&after)
        })
        .sum()
}

/// Claimed σ are trusted down to a quarter of themselves: correlated points scatter less than their σ.
const MIN_UNIT: f64 = 1.0 / 16.0;
