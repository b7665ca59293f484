//! Calibration from the observations of any detector, whose σ may not be stated.

use super::calibration::calibrate_observations;
use super::config::CalibrateConfig;
use super::diagnostics::residuals::{ViewResiduals, residuals};
use super::report::Calibration;
use super::variance_components::{
    NoiseFound, NoiseOf, SMALLEST, assumed, diagonal, fill, is_wanted, measure_noise,
};
use crate::error::Result;
use crate::observations::{ExternalObservations, Observations};
use crate::rig::{Rig, Warning};
use crate::solve::median;

/// Beyond this part of the diagonal even hands do better, so that something else is wrong.
const LARGE: f64 = 2e-3;

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
        quality.warnings.extend(noise.iter().filter_map(|n| warning(n, diagonal(&observations))));
    }
    Ok(ExternalCalibration { calibration, observations, noise })
}

fn warning(found: &NoiseFound, diagonal: f64) -> Option<Warning> {
    let (name, sigma) = (found.of.name(), found.sigma_px);
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
    (sigma > LARGE * diagonal).then(|| {
        Warning::new(
            "noise-large",
            format!(
                "{name} scatter by {sigma:.1} px (1σ) about the model, more than corners pointed at by hand"
            ),
            "check their order, the sheet's size, and whether the lens distorts more than k1 and k2 can model",
        )
    })
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
    /// Outliers are detected by σ: the first, which is assumed, may be far off.
    const ROUNDS: usize = 3;
    let mut observations = external.observations.clone();
    let mut noise = assumed(external);
    let smallest = SMALLEST * diagonal(&observations);
    for _ in 0..if noise.is_empty() { 0 } else { ROUNDS } {
        fill(&mut observations, external, &noise);
        let views = residuals(rig, &observations)?;
        // The pose of a view takes up nearly all information of its four corners.
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
