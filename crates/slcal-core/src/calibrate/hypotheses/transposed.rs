//! Whether the sheet's width and height were given the wrong way round.

use crate::calibrate::config::CalibrateConfig;
use crate::calibrate::maximum_likelihood::{solve, solve_camera};
use crate::error::Error;
use crate::estimate::Solution;
use crate::observations::Observations;
use crate::rig::Warning;

/// By how much χ² must fall, and to which part, before the other way round counts as clearly better.
const CLEARLY_LESS: f64 = 16.0;
const CLEAR_SHARE: f64 = 0.25;
/// Beyond this the ratio of residuals is no longer of interest.
const MANY_TIMES: f64 = 1000.0;

/// A suggestion to swap width and height when that fits the camera's view of the sheet clearly better than `given`, the
/// solution of the camera alone; nothing is swapped. Without a misfit that noise does not explain nothing is tried.
pub(crate) fn hint(
    observations: &Observations,
    config: &CalibrateConfig,
    given: Option<&Solution>,
) -> Option<Warning> {
    let mut sheet_alone = observations.clone();
    sheet_alone.projector = None;
    let cost = given.map_or(f64::INFINITY, |s| s.fit.cost);
    if given.is_some_and(|s| cost < freedom(s) + CLEARLY_LESS * (1.0 + freedom(s).sqrt() / 2.0)) {
        return None;
    }
    for view in &mut sheet_alone.views {
        view.size = view.size.transposed();
    }
    let other = solve(&sheet_alone, config).ok()?;
    let outliers = |s: &Solution| s.measured().filter(|(.., keep)| !keep).count();
    (other.fit.cost < CLEAR_SHARE * cost
        && cost - other.fit.cost > CLEARLY_LESS
        && given.is_none_or(|s| outliers(&other) <= outliers(s)))
    .then(|| {
        let size = observations.views[0].size;
        let against = if cost.is_finite() {
            format!(
                "fits far better than the one given (its residuals are over {:.0} times smaller)",
                (cost / other.fit.cost).sqrt().min(MANY_TIMES).floor()
            )
        } else {
            "has a real solution, the one given has none".into()
        };
        Warning::new(
            "size-transposed",
            format!(
                "width and height may be swapped: a sheet {}x{} mm {against}",
                size.height_mm, size.width_mm
            ),
            format!(
                "if the sheet's side along the image's x axis is {} mm, swap width and height",
                size.height_mm
            ),
        )
    })
}

/// The error of a calibration that failed, with the suggestion to swap where that would have made it succeed.
pub(crate) fn explain(error: Error, observations: &Observations, config: &CalibrateConfig) -> Error {
    let geometric = matches!(error, Error::Degenerate { .. } | Error::ImaginaryFocal { .. });
    let Some(hint) = geometric
        .then(|| hint(observations, config, solve_camera(observations, config).ok().as_ref()))
        .flatten()
    else {
        return error;
    };
    let advice = format!("{}: {}", hint.message, hint.advice);
    match error {
        Error::Degenerate { what, measure, limit, .. } => Error::Degenerate { what, measure, limit, advice },
        Error::ImaginaryFocal { device, f_squared, .. } => {
            Error::ImaginaryFocal { device, f_squared, advice }
        }
        other => other,
    }
}

/// Residuals beyond those that the unknowns take up.
fn freedom(s: &Solution) -> f64 {
    s.problem.rows().saturating_sub(s.problem.unknowns.len()) as f64
}
