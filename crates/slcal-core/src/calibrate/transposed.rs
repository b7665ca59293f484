//! Whether the sheet's width and height were given the wrong way round.

use super::config::CalibrateConfig;
use super::ml::{Solved, solve};
use super::verdict::warning;
use crate::observations::Observations;
use crate::rig::Warning;

/// By how much χ² must fall, and to which part, before the other way round counts as clearly better.
const CLEARLY_LESS: f64 = 16.0;
const CLEAR_SHARE: f64 = 0.25;

/// A suggestion to swap width and height when that fits the camera's view of the sheet clearly better; nothing is
/// swapped. Without a misfit that noise does not explain nothing is tried.
pub(crate) fn hint(observations: &Observations, config: &CalibrateConfig) -> Option<Warning> {
    let mut sheet_alone = observations.clone();
    sheet_alone.projector = None;
    let given = solve(&sheet_alone, config).ok();
    let cost = given.as_ref().map_or(f64::INFINITY, |s| s.fit.cost);
    if given.as_ref().is_some_and(|s| cost < freedom(s) + CLEARLY_LESS * (1.0 + freedom(s).sqrt() / 2.0)) {
        return None;
    }
    for view in &mut sheet_alone.views {
        view.size = view.size.transposed();
    }
    let other = solve(&sheet_alone, config).ok()?;
    let outliers = |s: &Solved| s.fit.inliers.iter().filter(|k| !**k).count();
    (other.fit.cost < CLEAR_SHARE * cost
        && cost - other.fit.cost > CLEARLY_LESS
        && given.as_ref().is_none_or(|s| outliers(&other) <= outliers(s)))
    .then(|| {
        let size = observations.views[0].size;
        let against = if cost.is_finite() { format!("{cost:.0}") } else { "no real solution".into() };
        warning(
            "size-transposed",
            format!(
                "a sheet of {0}x{1} mm fits far better than one of {1}x{0} mm (χ² {2:.0} against {3})",
                size.height_mm, size.width_mm, other.fit.cost, against
            ),
            format!(
                "if the sheet's side along the image's x axis is {} mm, swap width and height",
                size.height_mm
            ),
        )
    })
}

/// Residuals beyond those that the unknowns take up.
fn freedom(s: &Solved) -> f64 {
    s.joint.rows().saturating_sub(s.joint.layout.len) as f64
}
