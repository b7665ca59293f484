//! Photographs that do not belong together: another sheet, another pattern, a rig that was moved between them.

use super::misfit::misfit;
use crate::calibrate::config::CalibrateConfig;
use crate::calibrate::maximum_likelihood::solve;
use crate::estimate::Solution;
use crate::observations::Observations;
use crate::rig::Warning;

/// χ² per residual of all views together from which they are looked at one by one; noise stays within a few per cent of one.
const SUSPICIOUS: f64 = 2.0;
/// The other views agree when they fit as well as this, or this much better than all together.
const AGREE: f64 = 1.5;
const AGREE_SHARE: f64 = 0.25;
/// A view is named when leaving it out leaves this many times less than leaving out any other.
const CLEARLY: f64 = 2.0;

/// The view that contradicts the others, or the two that contradict each other; nothing when the views agree, or when they
/// misfit together, which is not one view's fault.
pub(crate) fn hint(
    observations: &Observations,
    config: &CalibrateConfig,
    solution: &Solution,
) -> Option<Warning> {
    let views = observations.views.len();
    let together = misfit(solution).per_row();
    if views < 2 || together < SUSPICIOUS {
        return None;
    }
    // A view whose absence leaves something that cannot be solved is not the odd one.
    let without: Vec<f64> = (0..views)
        .map(|i| {
            let mut others = observations.clone();
            others.views.remove(i);
            solve(&others, config).map_or(f64::INFINITY, |s| misfit(&s).per_row())
        })
        .collect();
    let odd = (0..views).min_by(|&i, &j| without[i].total_cmp(&without[j]))?;
    if without[odd] > AGREE.max(AGREE_SHARE * together) {
        return None;
    }
    let next = (0..views).filter(|&i| i != odd).map(|i| without[i]).fold(f64::INFINITY, f64::min);
    let times = (together / without[odd].max(f64::MIN_POSITIVE)).sqrt();
    let (who, what) = if next > CLEARLY * without[odd].max(1.0) {
        (format!("photograph {} contradicts the others", odd + 1), "it")
    } else if views == 2 {
        ("photographs 1 and 2 contradict each other".into(), "one of them")
    } else {
        return None;
    };
    Some(Warning::new(
        "view-contradicts",
        format!("{who}: without {what} the residuals are {times:.1} times smaller"),
        "check that it shows the same sheet and the same pattern, with the size that was given, and that neither camera nor \
         projector was moved, zoomed or refocused in between; or leave it out",
    ))
}
