//! Whether the sheet's width and height were given the wrong way round.

use super::config::CalibrateConfig;
use super::ml::{Solved, solve};
use super::verdict::warning;
use crate::observations::Observations;
use crate::rig::Warning;

/// By how much χ² must fall, and to which part, before the other way round counts as clearly better.
const CLEARLY_LESS: f64 = 16.0;
const CLEAR_SHARE: f64 = 0.25;

/// A suggestion to swap width and height when that fits the camera's view clearly better; nothing is swapped.
pub(crate) fn hint(
    observations: &Observations,
    config: &CalibrateConfig,
    solved: &Solved,
) -> Option<Warning> {
    let cost = solved.fit.cost;
    if cost < CLEARLY_LESS {
        return None;
    }
    let mut turned = observations.clone();
    for view in &mut turned.views {
        view.size = view.size.transposed();
    }
    let other = solve(&turned, config).ok()?;
    let outliers = |s: &Solved| s.fit.inliers.iter().filter(|k| !**k).count();
    (other.fit.cost < CLEAR_SHARE * cost
        && cost - other.fit.cost > CLEARLY_LESS
        && outliers(&other) <= outliers(solved))
    .then(|| {
        let size = observations.views[0].size;
        warning(
            "size-transposed",
            format!(
                "a sheet of {0}x{1} mm fits far better than one of {1}x{0} mm (χ² {2:.0} against {3:.0})",
                size.height_mm, size.width_mm, other.fit.cost, cost
            ),
            format!(
                "if the sheet's side along the image's x axis is {} mm, swap width and height",
                size.height_mm
            ),
        )
    })
}
