//! Whether the sheet's width and height were given the wrong way round.

use super::other_size;
use super::outline_fit::Outlines;
use super::plausible::is_ordinary;
use crate::calibrate::config::CalibrateConfig;
use crate::calibrate::maximum_likelihood::{solve, solve_camera};
use crate::error::Error;
use crate::estimate::Solution;
use crate::observations::Observations;
use crate::rig::Warning;

/// By how much χ² must fall, and to which part, before the other way round counts as clearly better.
const CLEARLY_LESS: f64 = 16.0;
const CLEAR_SHARE: f64 = 0.25;
/// By how much it must fall instead where the other way round fits, with a χ² per degree of freedom below this: no lens and no
/// paper is that far from what is expected of them.
const FAR_LESS: f64 = 100.0;
const FITS: f64 = 2.0;
/// Beyond this the ratio of residuals is no longer of interest.
const MANY_TIMES: f64 = 1000.0;

/// A suggestion to swap width and height when that fits the camera's view of the sheet clearly better than `given`, the
/// solution of the camera alone; nothing is swapped. Without a misfit that noise does not explain, and with the focal length of
/// an ordinary lens, nothing is tried.
pub(crate) fn hint(
    observations: &Observations,
    config: &CalibrateConfig,
    given: Option<&Solution>,
) -> Option<Warning> {
    let mut sheet_alone = observations.of_camera();
    let cost = given.map_or(f64::INFINITY, |s| s.fit.cost);
    let implausible = given.is_some_and(|s| !is_ordinary(s));
    let fits_well = |s: &Solution| cost < freedom(s) + CLEARLY_LESS * (1.0 + freedom(s).sqrt() / 2.0);
    if !implausible && given.is_some_and(fits_well) {
        return None;
    }
    let sizes = |o: &Observations| o.views.iter().map(|v| v.size).collect::<Vec<_>>();
    let outlines = Outlines::new(&sheet_alone, config);
    let as_given = sizes(&sheet_alone);
    for view in &mut sheet_alone.views {
        view.size = view.size.transposed();
    }
    // A fit of a size that is wrong in another way may end anywhere; the outlines themselves tell the two ways apart.
    if outlines.is_some_and(|o| o.chi2(&sizes(&sheet_alone)) > o.chi2(&as_given)) {
        return None;
    }
    let other = solve(&sheet_alone, config).ok()?;
    let outliers = |s: &Solution| s.measured().filter(|(.., keep)| !keep).count();
    // A bend and a lens far from their priors can explain a wrong size: what is left of χ² is then no small part, but far less.
    let fits = other.fit.cost < FITS * freedom(&other).max(1.0);
    let clearly = other.fit.cost < CLEAR_SHARE * cost || fits && cost - other.fit.cost > FAR_LESS;
    let less = clearly && cost - other.fit.cost > CLEARLY_LESS;
    let plausible = implausible && fits && is_ordinary(&other);
    ((less || plausible) && given.is_none_or(|s| outliers(&other) <= outliers(s))).then(|| {
        let size = observations.views[0].size;
        let times = (cost / other.fit.cost).sqrt().min(MANY_TIMES).floor();
        let against = if !less {
            "has a focal length of an ordinary lens, the one given has none".into()
        } else if cost.is_finite() && times < 2.0 {
            format!("fits far better than the one given (χ² falls from {cost:.0} to {:.0})", other.fit.cost)
        } else if cost.is_finite() {
            format!("fits far better than the one given (its residuals are over {times:.0} times smaller)")
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

/// The error of a calibration that failed, with the size that would have made it succeed.
pub(crate) fn explain(error: Error, observations: &Observations, config: &CalibrateConfig) -> Error {
    let geometric = matches!(error, Error::Degenerate { .. } | Error::ImaginaryFocal { .. });
    let found = || {
        let given = solve_camera(observations, config).ok();
        hint(observations, config, given.as_ref())
            .or_else(|| other_size::hint(observations, config, given.as_ref()))
    };
    let Some(hint) = geometric.then(found).flatten() else { return error };
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
