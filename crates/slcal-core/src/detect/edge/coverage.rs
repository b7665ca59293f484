//! Parts of a side that do not show the sheet's edge: something covers them, or the sheet bends away there.

use std::ops::RangeInclusive;

use super::crossing::{Crossing, FLOOR_SIGMA_PX};
use crate::solve::{Polynomial, median};

/// Shortest part that is told, as a part of the side. Single outliers are noise.
const MIN_GAP: f64 = 0.03;
/// The same at an end of the side. An edge behind the sheet that meets its corner can spoil a hundredth.
const MIN_END_GAP: f64 = 0.02;
/// An outlier that is nearer to the side than this part of its blur is noise, too: nothing covers the side there.
const MIN_OFF_BLURS: f64 = 0.1;
/// A gap at the end of a side is widened by its own length, up to this part of the side: a sheet that curls there leaves
/// the line gradually.
const MOST_WIDENED: f64 = 0.05;
/// Zones that a side is divided into to judge its ends, and how many of them at each end are judged.
const ZONES: usize = 25;
const END_ZONES: usize = 2;
/// An end is off when it is further from the curve of the rest than this many robust deviations of the other zones. Of
/// these 1.8 are the σ of the extrapolation. The image of a sheet that bends as a whole (a quartic) reaches six.
const MIN_DEPARTURE: f64 = 10.0;
/// Least deviation of the zones, as a part of the blur of the side: light that changes along the side moves it by as much.
const MIN_SCATTER_BLURS: f64 = 0.01;
/// Zones that are further away than this many are left out with such an end.
const MIN_OFF: f64 = 3.0;

/// What was seen of a side.
#[derive(Debug, Clone, Default)]
pub(super) struct Coverage {
    /// Lines that are left out.
    pub(super) left_out: Vec<RangeInclusive<f64>>,
    /// The covered part of the side.
    pub(super) covered: f64,
    /// The part of the side at an end that bends away.
    pub(super) bent: f64,
}

impl Coverage {
    /// Compares the lines on which the side should be seen with those on which it was: by the crossings that lie on the
    /// curve, and those of all `located` ones that are next to it. Each stands for lines up to `span` away. `blur_px` is the blur of the side, `reach_px` how far whatever covers a part is blurred.
    pub(super) fn of(
        expected: &[f64],
        [crossings, located]: [&[Crossing]; 2],
        curve: &Polynomial,
        span: f64,
        [blur_px, reach_px]: [f64; 2],
    ) -> Self {
        let mut coverage = Self::default();
        let (Some(&first), Some(&last)) = (expected.first(), expected.last()) else { return coverage };
        let length = last - first;
        let near = |c: &&Crossing| (c.position - curve.value(c.line)).abs() <= MIN_OFF_BLURS * blur_px;
        let mut seen: Vec<f64> =
            crossings.iter().chain(located.iter().filter(near)).map(|c| c.line).collect();
        seen.sort_by(f64::total_cmp);
        for (from, to) in gaps(expected, &seen, span, MIN_GAP * length) {
            let margin = |at_end: bool| {
                if at_end { (to - from).min(MOST_WIDENED * length).max(reach_px) } else { reach_px }
            };
            let at_end = from <= first || to >= last;
            coverage.covered += (to - from) / length;
            coverage.left_out.push(from - margin(at_end)..=to + margin(at_end));
        }
        for end in bent_ends(crossings, curve, blur_px) {
            coverage.bent += (end.end() - end.start()) / length;
            coverage.left_out.push(end);
        }
        coverage
    }

    /// Whether a part between two crossings is left out.
    pub(super) fn separates(&self, before: &Crossing, after: &Crossing) -> bool {
        self.left_out.iter().any(|part| before.line < *part.start() && after.line > *part.end())
    }

    pub(super) fn leaves(&self, line: f64) -> bool {
        !self.left_out.iter().any(|part| part.contains(&line))
    }
}

/// Runs of at least `least` lines without anything seen nearby. Runs that are closer to each other than that are one.
fn gaps(expected: &[f64], seen: &[f64], span: f64, least: f64) -> Vec<(f64, f64)> {
    let mut runs: Vec<(f64, f64)> = Vec::new();
    let mut open = false;
    for &line in expected {
        let next = seen.partition_point(|&s| s < line);
        let near =
            seen[next.saturating_sub(1)..(next + 1).min(seen.len())].iter().any(|s| (s - line).abs() <= span);
        match runs.last_mut() {
            Some(run) if !near && open => run.1 = line,
            _ if !near => runs.push((line, line)),
            _ => {}
        }
        open = !near;
    }
    let mut merged: Vec<(f64, f64)> = Vec::new();
    // Single outliers do not join others.
    for run in runs.into_iter().filter(|r| r.1 - r.0 >= 0.25 * least) {
        match merged.last_mut() {
            Some(before) if run.0 - before.1 < least => before.1 = run.1,
            _ => merged.push(run),
        }
    }
    let at_end = |r: &(f64, f64)| Some(&r.0) == expected.first() || Some(&r.1) == expected.last();
    let least_at_end = least * MIN_END_GAP / MIN_GAP;
    merged.retain(|r| r.1 - r.0 >= if at_end(r) { least_at_end.max(2.0 * span) } else { least });
    merged
}

/// The ends of a side that leave the curve through the rest.
fn bent_ends(crossings: &[Crossing], curve: &Polynomial, blur_px: f64) -> Vec<RangeInclusive<f64>> {
    let (Some(first), Some(last)) = (crossings.first(), crossings.last()) else { return Vec::new() };
    let size = (last.line - first.line) / ZONES as f64;
    let mut sums = [[0.0; 3]; ZONES];
    for c in crossings {
        let zone = (((c.line - first.line) / size) as usize).min(ZONES - 1);
        let weight = c.sigma.powi(-2);
        let offset = c.position - curve.value(c.line);
        for (sum, value) in sums[zone].iter_mut().zip([1.0, c.line, offset]) {
            *sum += weight * value;
        }
    }
    let zones: Vec<Option<(f64, f64)>> =
        sums.iter().map(|s| (s[0] > 0.0).then(|| (s[1] / s[0], s[2] / s[0]))).collect();
    let rest: Vec<(f64, f64, f64)> = zones[END_ZONES..ZONES - END_ZONES]
        .iter()
        .flatten()
        .map(|&(line, offset)| (line, offset, 1.0))
        .collect();
    if rest.len() < ZONES / 2 {
        return Vec::new();
    }
    let least = FLOOR_SIGMA_PX.max(MIN_SCATTER_BLURS * blur_px);
    let departure = |zone: usize| -> Option<f64> {
        let through = Polynomial::fit(&rest, super::CURVE_DEGREE)?;
        let mut residuals: Vec<f64> = rest.iter().map(|z| (z.1 - through.value(z.0)).abs()).collect();
        let scale = 1.4826 * median(&mut residuals)?;
        let (line, offset) = zones[zone]?;
        Some((offset - through.value(line)).abs() / scale.max(least))
    };
    let mut ends = Vec::new();
    for at_first in [true, false] {
        let zone = |k: usize| if at_first { k } else { ZONES - 1 - k };
        let outermost = (0..END_ZONES).find(|&k| zones[zone(k)].is_some());
        let Some(k) = outermost else { continue };
        if departure(zone(k)).is_none_or(|d| d < MIN_DEPARTURE) {
            continue;
        }
        let off = (k..END_ZONES).take_while(|&k| departure(zone(k)).is_some_and(|d| d > MIN_OFF)).count();
        let length = size * (k + off) as f64;
        ends.push(if at_first { first.line..=first.line + length } else { last.line - length..=last.line });
    }
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    fn crossing(line: f64, position: f64) -> Crossing {
        Crossing { line, position, sigma: 0.02 }
    }

    fn flat() -> Polynomial {
        Polynomial::fit(&[(0.0, 0.0, 1.0), (500.0, 0.0, 1.0)], 1).unwrap()
    }

    /// A scatter of ±0.02 px without a pattern that a cubic could follow.
    fn scatter(line: usize) -> f64 {
        0.02 * ((line * 7919 % 101) as f64 / 50.0 - 1.0)
    }

    #[test]
    fn single_outliers_are_no_gap_and_a_run_is_one() {
        let expected: Vec<f64> = (0..500).map(f64::from).collect();
        let some = |keep: &dyn Fn(usize) -> bool| {
            let crossings: Vec<_> =
                (0..500).filter(|&i| keep(i)).map(|i| crossing(i as f64, scatter(i))).collect();
            Coverage::of(&expected, [&crossings, &[]], &flat(), 0.6, [0.6, 3.0])
        };
        assert!(some(&|_| true).left_out.is_empty());
        assert!(some(&|i| i % 17 != 0).left_out.is_empty());
        // Two chance hits inside the covered part go with it.
        let covered = some(&|i| !(200..275).contains(&i) || i == 230 || i == 240);
        assert_eq!(covered.left_out, [197.0..=277.0]);
        assert!((covered.covered - 0.148).abs() < 1e-3 && covered.bent == 0.0, "{covered:?}");
        assert!(!covered.leaves(230.0) && covered.leaves(300.0));
    }

    #[test]
    fn an_end_that_bends_away_is_left_out_and_a_side_that_bends_as_a_whole_is_not() {
        let expected: Vec<f64> = (0..500).map(f64::from).collect();
        let of = |shape: &dyn Fn(f64) -> f64| {
            let crossings: Vec<_> =
                (0..500).map(|i| crossing(i as f64, scatter(i) + shape(f64::from(i as u32)))).collect();
            Coverage::of(&expected, [&crossings, &[]], &flat(), 0.6, [0.6, 3.0])
        };
        let bent = of(&|line| ((line - 480.0).max(0.0) / 20.0).powi(2) * 1.5);
        assert_eq!(bent.left_out.len(), 1);
        assert!(!bent.leaves(490.0) && bent.leaves(450.0) && bent.leaves(3.0), "{bent:?}");
        let quartic = of(&|line| ((line - 250.0) / 250.0).powi(4));
        assert!(quartic.left_out.is_empty(), "{quartic:?}");
    }
}
