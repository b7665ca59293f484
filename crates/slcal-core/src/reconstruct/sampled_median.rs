//! Medians over the points of a cloud.

use crate::cloud::CloudPoint;
use crate::solve::median;

/// The median is that of about this many points, spread evenly.
pub(super) const SAMPLE: usize = 1024;

/// The median of a quantity over a sample of the points; 0 for none. `buffer` is used for the sample.
pub(super) fn sampled_median(
    points: &[CloudPoint],
    buffer: &mut Vec<f64>,
    what: impl Fn(&CloudPoint) -> f64,
) -> f64 {
    buffer.clear();
    buffer.extend(points.iter().step_by(points.len().div_ceil(SAMPLE).max(1)).map(what));
    median(buffer).unwrap_or(0.0)
}
