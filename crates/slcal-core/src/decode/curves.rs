//! Stripes are curves: peaks linked from line to line, whose lines vote on the number of their slit.

use super::align::NONE;
use super::color::unit;
use super::peaks::{Peak, total};

/// A peak continues a curve when it lies within this share of the stripe's width of where the curve points.
const LINK_SHARE: f32 = 0.5;
/// Cosine of the angle between the colours of linked peaks.
const MIN_COLOR_COSINE: f32 = 0.88;
/// Ratio of the strengths and of the widths of linked peaks.
const MAX_RATIO: f32 = 2.0;
/// Weight of the newest step in a curve's direction.
const SLOPE_GAIN: f32 = 0.3;
/// Share of the votes cast that the winner must have.
const MIN_SHARE: f32 = 0.6;
/// Share of all peaks about that must have voted for the winner.
const MIN_SUPPORT: f32 = 0.4;

/// Blur reaches no further than this many stripe widths: with more, there would be no stripes.
const FADE_WIDTHS: f32 = 1.0;

const END: u32 = u32::MAX;

/// Peaks of all lines, and the curves that they form.
pub(super) struct Curves {
    /// Indices of peaks, curve after curve, each from its first line to its last.
    order: Vec<u32>,
    /// Where each curve starts in `order`, and the end.
    starts: Vec<u32>,
}

/// A slit number for a peak and how sure it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Vote {
    /// Position in the order of slits; [`NONE`] when undecided.
    pub(super) label: u16,
    /// Share of the peaks about that agree, 0–1.
    pub(super) support: f32,
    /// Why it is undecided.
    pub(super) ambiguous: bool,
}

impl Curves {
    /// Links peaks of neighbouring lines; `lines[y]..lines[y + 1]` are the peaks of line y, ascending.
    pub(super) fn link(peaks: &[Peak], lines: &[u32]) -> Self {
        let mut next = vec![END; peaks.len()];
        let mut has_previous = vec![false; peaks.len()];
        let mut slope = vec![0.0_f32; peaks.len()];
        for w in lines.windows(3) {
            let (a, b, c) = (w[0] as usize, w[1] as usize, w[2] as usize);
            for i in a..b {
                let Some(j) = nearest(peaks, b..c, peaks[i].u + slope[i]) else { continue };
                // Mutual: nobody else on the upper line points closer to j.
                let miss = |i: usize| (peaks[j].u - peaks[i].u - slope[i]).abs();
                let rival = (i > a && miss(i - 1) < miss(i)) || (i + 1 < b && miss(i + 1) < miss(i));
                if rival || has_previous[j] || !alike(&peaks[i], &peaks[j], miss(i)) {
                    continue;
                }
                next[i] = j as u32;
                has_previous[j] = true;
                slope[j] = slope[i] + SLOPE_GAIN * (peaks[j].u - peaks[i].u - slope[i]);
            }
        }
        let mut order = Vec::with_capacity(peaks.len());
        let mut starts = vec![0];
        for first in (0..peaks.len()).filter(|&i| !has_previous[i]) {
            let mut i = first as u32;
            while i != END {
                order.push(i);
                i = next[i as usize];
            }
            starts.push(order.len() as u32);
        }
        Self { order, starts }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &[u32]> {
        self.starts.windows(2).map(|w| &self.order[w[0] as usize..w[1] as usize])
    }

    /// Averages rows of `values` (`columns` per peak) along each curve over ± `reach` lines.
    pub(super) fn smooth(&self, values: &mut [f32], columns: usize, reach: usize) {
        let mut sums = Vec::new();
        for curve in self.iter() {
            for c in 0..columns {
                sums.clear();
                sums.push(0.0_f64);
                let mut sum = 0.0;
                for &i in curve {
                    sum += f64::from(values[i as usize * columns + c]);
                    sums.push(sum);
                }
                for (at, &i) in curve.iter().enumerate() {
                    let (a, b) = (at.saturating_sub(reach), (at + reach + 1).min(curve.len()));
                    values[i as usize * columns + c] = ((sums[b] - sums[a]) / (b - a) as f64) as f32;
                }
            }
        }
    }

    /// Crossings at the ends of curves that lie beyond where the stripe has half its light: what blur makes of the border
    /// of the light, or of the surface.
    pub(super) fn fading(&self, peaks: &[Peak]) -> Vec<bool> {
        let mut fading = vec![false; peaks.len()];
        let mut lights = Vec::new();
        for curve in self.iter() {
            let mut trim = |from: &mut dyn Iterator<Item = u32>| {
                let near: Vec<u32> = from.collect();
                let Some(&end) = near.first() else { return };
                let blurred = (FADE_WIDTHS * peaks[end as usize].width).ceil() as usize;
                let light = |i: &u32| total(peaks[*i as usize].color);
                lights.clear();
                lights.extend(near.iter().skip(blurred).take(blurred).map(light));
                if lights.len() < blurred {
                    return;
                }
                let middle = lights.len() / 2;
                let half = 0.5 * *lights.select_nth_unstable_by(middle, f32::total_cmp).1;
                for i in near.iter().take(blurred).take_while(|i| light(i) < half) {
                    fading[*i as usize] = true;
                }
            };
            let reach = curve.first().map_or(0, |&i| (8.0 * peaks[i as usize].width).ceil() as usize);
            trim(&mut curve.iter().copied().take(reach));
            trim(&mut curve.iter().rev().copied().take(reach));
        }
        fading
    }

    /// The winner among the lines within ± `reach` of each peak along its curve.
    pub(super) fn vote(&self, labels: &[u16], reach: usize) -> Vec<Vote> {
        let mut votes = vec![Vote { label: NONE, support: 0.0, ambiguous: false }; labels.len()];
        let mut counts: Vec<(u16, u32)> = Vec::new();
        for curve in self.iter() {
            counts.clear();
            let label = |at: usize| labels[curve[at] as usize];
            for ahead in 0..reach.min(curve.len()) {
                change(&mut counts, label(ahead), 1);
            }
            for at in 0..curve.len() {
                if at + reach < curve.len() {
                    change(&mut counts, label(at + reach), 1);
                }
                if at > reach {
                    change(&mut counts, label(at - reach - 1), -1);
                }
                let window = (at + reach + 1).min(curve.len()) - at.saturating_sub(reach);
                let cast: u32 = counts.iter().map(|c| c.1).sum();
                let Some(winner) = counts.iter().max_by_key(|c| c.1).filter(|c| c.1 > 0) else { continue };
                let (share, support) = (winner.1 as f32 / cast as f32, winner.1 as f32 / window as f32);
                let sure = share >= MIN_SHARE && support >= MIN_SUPPORT;
                votes[curve[at] as usize] =
                    Vote { label: if sure { winner.0 } else { NONE }, support, ambiguous: !sure };
            }
        }
        votes
    }
}

fn change(counts: &mut Vec<(u16, u32)>, label: u16, by: i32) {
    if label == NONE {
        return;
    }
    match counts.iter_mut().find(|c| c.0 == label) {
        Some(c) => c.1 = c.1.saturating_add_signed(by),
        None if by > 0 => counts.push((label, 1)),
        None => {}
    }
}

fn nearest(peaks: &[Peak], range: std::ops::Range<usize>, u: f32) -> Option<usize> {
    let line = &peaks[range.clone()];
    let after = line.partition_point(|p| p.u < u);
    let distance = |i: usize| (line[i].u - u).abs();
    let near = match (after.checked_sub(1), (after < line.len()).then_some(after)) {
        (Some(a), Some(b)) => Some(if distance(a) <= distance(b) { a } else { b }),
        (a, b) => a.or(b),
    };
    near.map(|i| i + range.start)
}

fn alike(a: &Peak, b: &Peak, miss: f32) -> bool {
    let ratio = |x: f32, y: f32| (x / y).max(y / x);
    let cosine = match (unit(a.color), unit(b.color)) {
        (Some(a), Some(b)) => a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>(),
        _ => 0.0,
    };
    miss <= (LINK_SHARE * a.width.min(b.width)).max(1.0)
        && cosine >= MIN_COLOR_COSINE
        && ratio(a.contrast, b.contrast) <= MAX_RATIO
        && ratio(a.width, b.width) <= MAX_RATIO
}
