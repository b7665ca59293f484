//! Consistency of the labels of neighbouring stripes: a wrong pattern may share windows with the right one.

use super::code_check::another_pattern;
use super::crossing_features::{BRIGHTER, CrossingFeatures, NONE, differ_by_factor, differ_in_light};
use super::labeling::{Labeling, VotedLabel};
use super::tracks::Tracks;
use crate::error::{ErrorSubject, Result};
use crate::solve::median_f32;

/// Every further slit fits by chance with the probability of one over the number of hues.
const BEYOND_WINDOW: usize = 2;
/// Labels are compared on about this many scanlines.
const EVIDENCE_LINES: usize = 120;
/// Neighbours belong to one regular run of stripes when consecutive distances agree within this factor, and widths
/// within the second one. Across a step of depth they seldom do.
const EVEN: f32 = 1.15;
const ALIKE: f32 = 1.5;
/// Share of the neighbours in regular runs whose labels are not consecutive, above which the code is another one. The
/// right one leaves up to 3 % on planes, spheres, heads and blocks, however blurred, noisy or coloured. It leaves up to
/// 12 % on shelves of upright boards whose edges run along the stripes. Other codes mostly leave 17 % to 92 %, but as
/// little as 4 % where they lack or repeat only a few words of it; most of those have other hues or another end.
const MAX_BROKEN: f64 = 0.15;
/// Share of the runs through the code's first or last slit that continue beyond it, above which the pattern is another
/// one with the same beginning. It is up to 3 % with the right one, and from 57 % when the end of a shortened one is in
/// view.
const MAX_BEYOND: f64 = 0.13;
/// An end is in view when it is found on this share of the scanlines with regular runs, and at least this many
/// scanlines and pairs are needed.
const END_SHARE: f64 = 0.2;
const MIN_LINES: usize = 5;
const MIN_LINKS: usize = 50;

/// Refuses labels whose runs are no longer than by chance. On scanlines under another code, windows that occur in this
/// one are found in many places, but they do not continue. With the right code, half the labelled crossings stand in
/// runs as long as the code's window and [`BEYOND_WINDOW`] together.
pub(super) fn check_runs(
    tracks: &Tracks,
    votes: &[VotedLabel],
    window: usize,
    scratch: &mut Vec<f32>,
) -> Result<()> {
    scratch.clear();
    for y in 0..tracks.line_count() {
        let line = &votes[tracks.of(y)];
        for run in line.chunk_by(|a, b| a.label != NONE && a.label + 1 == b.label) {
            if run[0].label != NONE {
                scratch.extend(run.iter().map(|_| run.len() as f32));
            }
        }
    }
    let usual = median_f32(scratch).unwrap_or(0.0);
    if usual < (window + BEYOND_WINDOW) as f32 {
        return Err(another_pattern(
            ErrorSubject::PatternCode,
            format!(
                "{} stripe crossings; those that fit the code form runs of {usual} slits, where {window} fit by chance",
                tracks.crossings.len()
            ),
        ));
    }
    Ok(())
}

/// Counts over regular runs of stripes, where every slit is followed by the next.
#[derive(Debug, Clone, Copy, Default)]
struct Evidence {
    /// Scanlines with regular runs.
    lines: usize,
    /// Pairs of neighbours on them, and the pairs whose labels are consecutive.
    links: usize,
    follow: usize,
    /// Occurrences of the first and the last slit, and those beyond which the run continues.
    ends: [usize; 2],
    beyond: [usize; 2],
}

impl Evidence {
    fn add_run(&mut self, labels: impl ExactSizeIterator<Item = u16>, last: u16) {
        self.links += labels.len().saturating_sub(1);
        let mut previous = None;
        for label in labels {
            if let Some(before) = previous {
                self.follow += usize::from(label != NONE && before != NONE && before + 1 == label);
                self.beyond[0] += usize::from(label == 0);
                self.beyond[1] += usize::from(before == last);
            }
            self.ends[0] += usize::from(label == 0);
            self.ends[1] += usize::from(label == last);
            previous = Some(label);
        }
    }

    fn broken(&self) -> f64 {
        if self.links < MIN_LINKS {
            return 0.0;
        }
        1.0 - self.follow as f64 / self.links as f64
    }

    /// The larger share of the two ends.
    fn beyond(&self) -> f64 {
        let enough = (END_SHARE * self.lines as f64).max(MIN_LINES as f64);
        let shares = self.ends.iter().zip(self.beyond).filter(|(seen, _)| **seen as f64 >= enough);
        shares.map(|(&seen, beyond)| beyond as f64 / seen as f64).fold(0.0, f64::max)
    }
}

/// Whether crossing `i` continues the regular run that starts at `from`.
fn continues(features: &[CrossingFeatures], from: usize, i: usize) -> bool {
    let (a, b) = (&features[i - 1], &features[i]);
    let even = i < from + 2 || !differ_by_factor(b.u - a.u, a.u - features[i - 2].u, EVEN);
    even && !differ_by_factor(a.width, b.width, ALIKE) && !differ_in_light(a, b, BRIGHTER)
}

/// Refuses labels that contradict each other on one surface, and a code beyond whose end the stripes continue: a
/// pattern may share windows, or its beginning, with the one that was projected.
///
/// Crossings outside regular runs of more slits than the code's window do not count: they may be clutter.
pub(super) fn check_neighbors(
    labeling: &mut Labeling,
    tracks: &Tracks,
    slits: usize,
    window: usize,
) -> Result<()> {
    let (count, last) = (labeling.line_count(), slits.saturating_sub(1) as u16);
    let mut evidence = Evidence::default();
    for line in (0..count).step_by((count / EVIDENCE_LINES).max(1)) {
        let (features, label) = labeling.labeled_line(tracks, line);
        let before = evidence.links;
        let mut from = 0;
        for i in 1..=features.len() {
            if i < features.len() && continues(features, from, i) {
                continue;
            }
            if i - from >= window + BEYOND_WINDOW {
                evidence.add_run((from..i).map(&label), last);
            }
            from = i;
        }
        evidence.lines += usize::from(evidence.links > before);
    }
    let (broken, beyond) = (evidence.broken(), evidence.beyond());
    let seen = if broken > MAX_BROKEN {
        format!(
            "{} pairs of evenly spaced neighbours; in {:.0} % of them the second does not follow the first in the code",
            evidence.links,
            100.0 * broken
        )
    } else if beyond > MAX_BEYOND {
        format!(
            "evenly spaced stripes that continue beyond an end of the code, on {:.0} % of the lines that show it",
            100.0 * beyond
        )
    } else {
        return Ok(());
    };
    Err(another_pattern(ErrorSubject::PatternCode, seen))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_count_consecutive_labels_and_those_beyond_the_ends() {
        let mut evidence = Evidence::default();
        evidence.add_run([0, 1, 2, 3, NONE, NONE].into_iter(), 3);
        evidence.add_run([NONE, 0, 1, 1, 3].into_iter(), 3);
        assert_eq!((evidence.links, evidence.follow), (9, 4));
        assert_eq!((evidence.ends, evidence.beyond), ([2, 2], [1, 1]));
        assert!(evidence.broken() < f64::EPSILON, "too few to judge");
    }
}
