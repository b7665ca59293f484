//! Correspondence along one line: peaks × slits by dynamic programming.
//!
//! After L. Zhang, B. Curless, S. M. Seitz, "Rapid shape acquisition using color structured light and multi-pass dynamic
//! programming", 3DPVT 2002, with costs that are log-probabilities. A single ordered pass threads chance matches between the
//! right ones on a line that an occlusion has put out of order; here a run may start at any slit, at a higher price
//! behind the last one. A slit may be met twice: a line of the image need not be an epipolar line, and crosses the same
//! slit on the object and again on the wall.

use super::color::Hues;
use super::peaks::{Peak, total};

/// ln of the odds that a peak is a slit at all: what a peak gains by being matched with an uninformative colour.
const MATCH_GAIN: f32 = 1.0;
/// Starting a run of slits anywhere: as many nats as there are places to start (about 60), and some for the surfaces
/// that end. Two peaks alone do not pay for it, three neighbours with the right colours (the window of three) do.
const JUMP: f32 = 6.0;
/// The same, when the run starts at an earlier slit than the last one ended with: a near surface has hidden a part and
/// moved another.
const JUMP_BACK: f32 = 8.0;
/// One slit that was not seen.
const MISSED_SLIT: f32 = 2.5;
/// One peak between two slits that is none.
const EXTRA_PEAK: f32 = 1.0;
/// Going on with the next slit where the surface seems to have changed: the peaks are more than `FAR` times as far
/// apart as their widths suggest, or one is more than `BRIGHTER` times as bright as the other.
const BREAK: f32 = 2.5;
const FAR: f32 = 1.7;
/// A gap of one slit is this many periods wide, to one more.
const NEAR_TWO: f32 = 1.5;
const BRIGHTER: f32 = 2.0;
/// Fewer neighbouring peaks on neighbouring slits than this are no evidence: two colours occur in many places.
const MIN_RUN: usize = 3;
/// What all votes for a slit along the curve of a peak are worth, in nats.
const VOTE_GAIN: f32 = 4.0;

/// Marks a slit or peak that is not matched.
pub(super) const NONE: u16 = u16::MAX;

const END: u32 = u32::MAX;

/// What earlier rounds think of a peak: the slit and the share of the votes along its curve.
pub(super) type Hint = (u16, f32);

/// Aligns lines with the pattern; keeps its tables.
pub(super) struct Aligner {
    /// Hue of the slits in the order in which they are met along the line.
    slits: Vec<u8>,
    /// Period over width of the slits.
    period_per_width: f32,
    score: Vec<f32>,
    from: Vec<u32>,
    best: Vec<(f32, u32)>,
    path: Vec<(usize, u16)>,
}

impl Aligner {
    pub(super) fn new(slits: Vec<u8>, period_per_width: f32) -> Self {
        let (score, from, best, path) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { slits, period_per_width, score, from, best, path }
    }

    /// Gives each peak of a line the position of its slit in the order of the slits, or [`NONE`], and returns the score
    /// in nats. `odds` holds the log-odds of the hues, peak by peak; `hints` may be empty.
    pub(super) fn align(
        &mut self,
        peaks: &[Peak],
        odds: &[f32],
        hints: &[Hint],
        hues: &Hues,
        labels: &mut [u16],
    ) -> f32 {
        let (n, k) = (peaks.len(), self.slits.len());
        let colors = hues.directions.len();
        self.score.clear();
        self.score.resize(n * k, f32::NEG_INFINITY);
        self.from.clear();
        self.from.resize(n * k, END);
        // best[j]: the best end of a path among the peaks before, at a slit before j.
        self.best.clear();
        self.best.resize(k + 1, (0.0, END));
        let mut top = (0.0, END);
        for i in 0..n {
            let (step, missed) = self.costs(peaks, i, 1, hues);
            let (extra, _) = self.costs(peaks, i, 2, hues);
            let anywhere = (top.0 - JUMP_BACK, top.1);
            let (hinted, weight) = hints.get(i).copied().unwrap_or((NONE, 0.0));
            for j in 0..k {
                let mut gain = MATCH_GAIN + odds[i * colors + usize::from(self.slits[j])];
                if usize::from(hinted) == j {
                    gain += VOTE_GAIN * weight;
                }
                let (score, end) = self.best[j];
                let mut best = if score - JUMP > anywhere.0 { (score - JUMP, end) } else { anywhere };
                let mut consider = |peaks_back: usize, slits_back: usize, cost: f32| {
                    if i >= peaks_back && j >= slits_back {
                        let at = (i - peaks_back) * k + j - slits_back;
                        let s = self.score[at] - cost;
                        if s > best.0 {
                            best = (s, at as u32);
                        }
                    }
                };
                consider(1, 1, step);
                consider(1, 2, MISSED_SLIT + missed);
                consider(2, 1, EXTRA_PEAK + extra);
                self.score[i * k + j] = best.0 + gain;
                self.from[i * k + j] = best.1;
            }
            let mut running = (f32::NEG_INFINITY, END);
            for j in 0..k {
                let at = i * k + j;
                if self.score[at] > running.0 {
                    running = (self.score[at], at as u32);
                }
                if running.0 > self.best[j + 1].0 {
                    self.best[j + 1] = running;
                }
            }
            if running.0 > top.0 {
                top = running;
            }
        }
        self.trace(top.1, hints, labels);
        top.0
    }

    /// What it costs to go on from the peak `back` before peak `i` with the next slit, and with the one after that.
    fn costs(&self, peaks: &[Peak], i: usize, back: usize, hues: &Hues) -> (f32, f32) {
        let Some(a) = i.checked_sub(back).map(|i| &peaks[i]) else { return (0.0, 0.0) };
        let b = &peaks[i];
        let periods = (b.u - a.u) / (0.5 * (a.width + b.width) * self.period_per_width);
        let bright = |p: &Peak| total(p.color) / hues.brightness_of(p.color);
        let ratio = bright(a) / bright(b);
        let lit = if ratio > BRIGHTER || ratio < BRIGHTER.recip() { BREAK } else { 0.0 };
        let spaced = |fits: bool| if fits { lit } else { BREAK };
        (spaced(periods < FAR), spaced((NEAR_TWO..NEAR_TWO + 1.0).contains(&periods)))
    }

    /// Follows the best path back and keeps its runs of neighbouring slits that are long enough.
    fn trace(&mut self, end: u32, hints: &[Hint], labels: &mut [u16]) {
        labels.fill(NONE);
        let k = self.slits.len();
        self.path.clear();
        let mut at = end;
        while at != END {
            self.path.push((at as usize / k, (at as usize % k) as u16));
            at = self.from[at as usize];
        }
        let mut start = 0;
        for p in 1..=self.path.len() {
            let goes_on = p < self.path.len() && {
                let ((i, j), (i_next, j_next)) = (self.path[p], self.path[p - 1]);
                i + 1 == i_next && j + 1 == j_next
            };
            if goes_on {
                continue;
            }
            for &(i, j) in &self.path[start..p] {
                let hinted = hints.get(i).is_some_and(|h| h.0 == j && h.1 > 0.5);
                if p - start >= MIN_RUN || hinted {
                    labels[i] = j;
                }
            }
            start = p;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HUES: [u8; 12] = [0, 0, 0, 1, 0, 0, 2, 0, 1, 1, 0, 2];

    fn align(seen: &[(f32, u8)]) -> Vec<i32> {
        let peak = |u| Peak { u, width: 4.0, color: [1.0; 3], contrast: 9.0, sigma: 0.1, saturated: false };
        let peaks: Vec<Peak> = seen.iter().map(|s| peak(s.0)).collect();
        let odds: Vec<f32> =
            seen.iter().flat_map(|s| (0..3).map(move |h| if h == s.1 { 1.0 } else { -3.0 })).collect();
        let mut labels = vec![NONE; peaks.len()];
        let hues = Hues { directions: vec![[1.0, 0.0, 0.0]; 3], spread_rad: 0.1, brightness: vec![1.0; 3] };
        Aligner::new(HUES.to_vec(), 2.0).align(&peaks, &odds, &[], &hues, &mut labels);
        labels.into_iter().map(|l| if l == NONE { -1 } else { i32::from(l) }).collect()
    }

    fn slits(range: impl Iterator<Item = usize>, from: f32) -> Vec<(f32, u8)> {
        range.enumerate().map(|(i, s)| (from + 8.0 * i as f32, HUES[s])).collect()
    }

    #[test]
    fn a_part_of_the_pattern_is_found_where_it_is() {
        assert_eq!(align(&slits(3..9, 0.0)), [3, 4, 5, 6, 7, 8]);
        assert!(align(&[]).is_empty());
    }

    #[test]
    fn a_missing_and_a_spurious_stripe_do_not_shift_the_rest() {
        let mut seen = slits(0..12, 0.0);
        seen.remove(5);
        assert_eq!(align(&seen), [0, 1, 2, 3, 4, 6, 7, 8, 9, 10, 11]);
        let mut seen = slits(0..12, 0.0);
        seen.insert(4, (27.0, 2));
        assert_eq!(align(&seen), [0, 1, 2, 3, -1, 4, 5, 6, 7, 8, 9, 10, 11]);
    }

    #[test]
    fn a_part_that_an_occlusion_put_out_of_order_is_found() {
        let mut seen = slits(6..12, 0.0);
        seen.extend(slits(0..5, 48.0));
        assert_eq!(align(&seen), [6, 7, 8, 9, 10, 11, 0, 1, 2, 3, 4]);
        let mut twice = slits(3..9, 0.0);
        twice.extend(slits(3..9, 60.0));
        assert_eq!(align(&twice), [3, 4, 5, 6, 7, 8, 3, 4, 5, 6, 7, 8]);
    }
}
