//! Sequence alignment along one scanline: crossings × slits by dynamic programming.
//!
//! After L. Zhang, B. Curless, S. M. Seitz, "Rapid shape acquisition using color structured light and multi-pass
//! dynamic programming", 3DPVT 2002, with costs that are log-probabilities. On a scanline that an occlusion has put out
//! of order, a single ordered pass fills chance matches between the right ones. Here a run may start at any slit, at a
//! price that is higher behind the last one. A slit may occur twice: a scanline need not be an epipolar line, and
//! crosses the same slit on the object and again on the wall. Further passes use the votes of the neighbouring
//! scanlines (`labeling`).

use super::crossing_features::{Continuity, CrossingFeatures, NONE, StepCost, step};

/// Log-odds that a crossing is a slit at all: the gain of matching it with an uninformative colour.
const MATCH_GAIN: f32 = 1.0;
/// Cost of starting a run at any slit: the logarithm of the number of starts (about 60), and some for the surfaces that
/// end. Two crossings alone do not pay for it; three neighbours with the right colours (the window of three) do.
const JUMP_COST: f32 = 6.0;
/// The same, when the run starts at an earlier slit than the last one ended with: a near surface has hidden one part
/// and displaced another.
const JUMP_BACK_COST: f32 = 8.0;
/// Cost of one slit that was not detected.
const MISSING_SLIT: f32 = 2.5;
/// Cost of one crossing between two slits that is no slit.
const EXTRA_CROSSING: f32 = 1.0;
/// Fewer neighbouring crossings on neighbouring slits than this are no evidence: two colours occur in many places.
const MIN_RUN: usize = 3;
/// Share of the log-odds of perfect colours that a run must have: a run of three with one wrong colour fits elsewhere,
/// too. The second share holds for one or two crossings at the end of a run, behind a change of light.
const MIN_RUN_ODDS: f32 = 0.55;
const MIN_REST_ODDS: f32 = 0.9;
/// Gain of a unanimous vote for a slit along the track of a crossing, in nats.
const VOTE_GAIN: f32 = 4.0;

/// Every row of scores begins with as many entries of −∞ as steps reach back.
const PAD: usize = 2;

/// The pattern in the order of a scanline.
#[derive(Debug, Clone, Copy)]
pub(super) struct Code<'a> {
    /// Colour class of each slit.
    pub(super) slits: &'a [u8],
    /// Period over width of the slits.
    pub(super) period_per_width: f32,
}

/// What is aligned with what.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scanline<'a> {
    pub(super) code: Code<'a>,
    pub(super) features: &'a [CrossingFeatures],
    /// Log-odds of the classes, crossing by crossing.
    pub(super) odds: &'a [f32],
}

impl Scanline<'_> {
    /// Number of classes.
    fn hues(&self) -> usize {
        self.odds.len() / self.features.len().max(1)
    }

    /// Log-odds of crossing `i` having the class of slit `j`.
    fn odds_of(&self, i: usize, j: usize) -> f32 {
        self.odds[i * self.hues() + usize::from(self.code.slits[j])]
    }

    fn step(&self, i: usize, back: usize) -> StepCost {
        step(self.features, i, back, self.code.period_per_width)
    }
}

/// Aligns scanlines with the pattern; keeps its tables.
#[derive(Debug, Clone, Default)]
pub(super) struct Aligner {
    /// Best score of a path that ends with crossing i on slit j, row by row; two rows and [`PAD`] entries before each
    /// row are −∞.
    score: Vec<f32>,
    gain: Vec<f32>,
    /// Log-odds of a crossing's classes; one for each value of the index, so that no bounds check is needed.
    odds: ClassOdds,
    /// The best score among the crossings before, at a slit before each, and at any.
    best: Vec<f32>,
    steps: Vec<RowCosts>,
    /// The best score up to each row.
    tops: Vec<f32>,
    path: Vec<(u32, u16)>,
}

impl Aligner {
    /// Assigns each crossing of a scanline the position of its slit in the code, or [`NONE`], and returns the score in
    /// nats.
    pub(super) fn align(&mut self, scanline: Scanline<'_>, lenient: bool, labels: &mut [u16]) -> f32 {
        let top = self.fill(scanline);
        labels.fill(NONE);
        if top > 0.0 {
            self.trace(top, scanline);
            self.keep_runs(scanline, lenient, labels);
        }
        top
    }

    fn fill(&mut self, scanline: Scanline<'_>) -> f32 {
        let Scanline { code: Code { slits, .. }, features, odds } = scanline;
        let (n, k, hues) = (features.len(), slits.len(), scanline.hues());
        let row = k + PAD;
        // Values of an earlier scanline are overwritten row by row.
        let size = (n + 2) * row;
        self.score.resize(self.score.len().max(size), 0.0);
        self.score[..2 * row].fill(f32::NEG_INFINITY);
        self.gain.resize(k, 0.0);
        self.best.clear();
        self.best.resize(k + 1, 0.0);
        self.steps.clear();
        self.tops.clear();
        let mut top = 0.0_f32;
        for i in 0..n {
            let one = scanline.step(i, 1);
            let extra = EXTRA_CROSSING + scanline.step(i, 2).next;
            for (own, o) in self.odds.0.iter_mut().zip(&odds[i * hues..(i + 1) * hues]) {
                *own = MATCH_GAIN + o;
            }
            for (g, &s) in self.gain.iter_mut().zip(slits) {
                *g = self.odds.0[usize::from(s)];
            }
            let (hinted, weight) = features[i].prior;
            if let Some(g) = self.gain.get_mut(usize::from(hinted)) {
                *g += VOTE_GAIN * weight;
            }
            // Rows i and i + 1 of the table belong to the crossings before.
            let (before, current) = self.score.split_at_mut((i + 2) * row);
            let (second, last) = (&before[i * row..(i + 1) * row], &before[(i + 1) * row..]);
            let steps = RowCosts {
                back: top - JUMP_BACK_COST,
                next: one.next,
                missed: MISSING_SLIT + one.missed,
                extra,
            };
            let (pad, current) = current[..row].split_at_mut(PAD);
            pad.fill(f32::NEG_INFINITY);
            fill_row(&steps, (last, second), &self.best, &self.gain, current);
            raise_best(&mut self.best, current);
            self.steps.push(steps);
            top = self.best[k];
            self.tops.push(top);
        }
        top
    }

    /// Follows the best path back from the end, whose score is `top`. The step that led to a cell is not stored but
    /// recomputed for the few cells on the path.
    fn trace(&mut self, top: f32, scanline: Scanline<'_>) {
        let (features, k) = (scanline.features, scanline.code.slits.len());
        let row = k + PAD;
        self.path.clear();
        let mut at = self.best_cell(features.len(), k).filter(|c| c.0 >= top);
        while let Some((_, i, j)) = at {
            self.path.push((i as u32, j as u16));
            let (hinted, weight) = features[i].prior;
            let vote = if usize::from(hinted) == j { VOTE_GAIN * weight } else { 0.0 };
            let gain = MATCH_GAIN + scanline.odds_of(i, j) + vote;
            let RowCosts { back, next, missed, extra } = self.steps[i];
            let (last, second) = (&self.score[(i + 1) * row + j..], &self.score[i * row + j..]);
            let ways = [(last[1] - next, 1, 1), (last[0] - missed, 1, 2), (second[1] - extra, 2, 1)];
            let (best, rows, columns) = ways.into_iter().fold(ways[0], |a, b| if b.0 > a.0 { b } else { a });
            at = if best + gain >= self.score[(i + 2) * row + PAD + j] {
                Some((best, i - rows, j - columns))
            } else {
                let ahead = self.best_cell(i, j);
                let score = ahead.map_or(0.0, |c| c.0.max(0.0));
                let is_back = back > score - JUMP_COST;
                if is_back { self.best_cell(i, k) } else { ahead }.filter(|c| c.0 > 0.0)
            };
        }
    }

    /// The best cell among the first `n` crossings and `k` slits, with its score. It is searched for, not stored, since
    /// jumps are few.
    fn best_cell(&self, n: usize, k: usize) -> Option<(f32, usize, usize)> {
        let row = self.gain.len() + PAD;
        let mut best: Option<(f32, usize, usize)> = None;
        for i in (0..n).rev() {
            if best.is_some_and(|b| b.0 >= self.tops[i]) {
                break;
            }
            let scores = &self.score[(i + 2) * row + PAD..][..k];
            for (j, &s) in scores.iter().enumerate() {
                if best.is_none_or(|b| s > b.0) {
                    best = Some((s, i, j));
                }
            }
        }
        best
    }

    /// Labels the runs of neighbouring crossings on neighbouring slits that are long enough and whose colours fit, and
    /// the labels on which earlier passes have agreed. A run continues across a moderate change of light (a shadow or a
    /// fold), but the part behind it must fit by itself, since the next colours occur in other places, too.
    fn keep_runs(&self, scanline: Scanline<'_>, lenient: bool, labels: &mut [u16]) {
        let perfect = (scanline.hues() as f32).ln();
        let fits = |part: &[(u32, u16)], share: f32| {
            let odds = |&(i, j): &(u32, u16)| scanline.odds_of(i as usize, usize::from(j));
            part.iter().map(odds).sum::<f32>() >= share * perfect * part.len() as f32
        };
        // The path runs backwards.
        let link = |pair: &[(u32, u16)]| {
            let [(i_next, j_next), (i, j)] = [pair[0], pair[1]];
            let follows = i + 1 == i_next && j + 1 == j_next;
            if follows { scanline.step(i_next as usize, 1).continuity } else { Continuity::Broken }
        };
        for run in split(&self.path, |pair| link(pair) != Continuity::Broken) {
            let long = run.len() >= MIN_RUN && fits(run, MIN_RUN_ODDS);
            for part in split(run, |pair| link(pair) == Continuity::Continuous) {
                let rest = part.len() < MIN_RUN;
                let accepted =
                    long && (lenient || !rest) && fits(part, if rest { MIN_REST_ODDS } else { MIN_RUN_ODDS });
                for &(i, j) in part {
                    let prior = scanline.features[i as usize].prior;
                    if accepted || (lenient && prior.0 == j && prior.1 > 0.5) {
                        labels[i as usize] = j;
                    }
                }
            }
        }
    }
}

/// Splits a path wherever two neighbours on it do not belong together.
fn split(
    path: &[(u32, u16)],
    together: impl Fn(&[(u32, u16)]) -> bool,
) -> impl Iterator<Item = &[(u32, u16)]> {
    path.chunk_by(move |a, b| together(&[*a, *b]))
}

#[derive(Debug, Clone)]
struct ClassOdds([f32; 256]);

impl Default for ClassOdds {
    fn default() -> Self {
        Self([0.0; 256])
    }
}

/// Costs of the steps to the cells of a row.
#[derive(Debug, Clone, Copy)]
struct RowCosts {
    /// Score of a jump back to any slit.
    back: f32,
    next: f32,
    missed: f32,
    extra: f32,
}

/// One row of the table from the two before it. Plain loops over slices of one length, so that the compiler vectorises
/// them.
fn fill_row(steps: &RowCosts, rows: (&[f32], &[f32]), best_before: &[f32], gain: &[f32], score: &mut [f32]) {
    let k = gain.len();
    let (last, second) = rows;
    let (next, missed, skipped) = (&last[1..=k], &last[..k], &second[1..=k]);
    let (best_before, score) = (&best_before[..k], &mut score[..k]);
    for j in 0..k {
        let jump = larger(best_before[j] - JUMP_COST, steps.back);
        let one = larger(next[j] - steps.next, missed[j] - steps.missed);
        score[j] = larger(larger(jump, one), skipped[j] - steps.extra) + gain[j];
    }
}

/// Carries the scores of a row on to the slits behind each: `best[j + 1]` becomes the maximum of its value and of the
/// scores up to slit j. Few scores of a row exceed all before, so that most blocks are only compared.
fn raise_best(best: &mut [f32], scores: &[f32]) {
    const BLOCK: usize = 8;
    let best = &mut best[1..];
    let (blocks, rest) = scores.as_chunks::<BLOCK>();
    for (b, block) in blocks.iter().enumerate() {
        let Some(known) = best[b * BLOCK..].first_chunk::<BLOCK>() else { return };
        let mut above = false;
        for l in 0..BLOCK {
            above |= block[l] > known[l];
        }
        if above {
            carry(best, b * BLOCK, block);
        }
    }
    carry(best, blocks.len() * BLOCK, rest);
}

/// Scores from slit `from` on, to all behind them.
fn carry(best: &mut [f32], from: usize, scores: &[f32]) {
    for (j, &score) in scores.iter().enumerate() {
        let behind = &mut best[from + j..];
        if behind.first().is_some_and(|b| score > *b) {
            for b in behind {
                *b = larger(*b, score);
            }
        }
    }
}

/// The larger of two numbers: one instruction, where `f32::max` checks for NaN.
#[inline]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};

    const HUES: [u8; 12] = [0, 0, 0, 1, 0, 0, 2, 0, 1, 1, 0, 2];

    fn features_at(u: f32) -> CrossingFeatures {
        CrossingFeatures { u, width: 4.0, light: 1.0, prior: (NONE, 0.0) }
    }

    fn align(seen: &[(f32, u8)]) -> Vec<i32> {
        let features: Vec<CrossingFeatures> = seen.iter().map(|s| features_at(s.0)).collect();
        let odds: Vec<f32> =
            seen.iter().flat_map(|s| (0..3).map(move |h| if h == s.1 { 1.0 } else { -3.0 })).collect();
        let mut labels = vec![NONE; features.len()];
        let code = Code { slits: &HUES, period_per_width: 2.0 };
        Aligner::default().align(Scanline { code, features: &features, odds: &odds }, false, &mut labels);
        labels.into_iter().map(|l| if l == NONE { -1 } else { i32::from(l) }).collect()
    }

    fn slits(range: impl Iterator<Item = usize>, from: f32) -> Vec<(f32, u8)> {
        range.enumerate().map(|(i, s)| (from + 8.0 * i as f32, HUES[s])).collect()
    }

    #[test]
    fn a_part_of_the_pattern_is_found_at_its_place() {
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
    fn parts_put_out_of_order_by_an_occlusion_are_found() {
        let mut seen = slits(6..12, 0.0);
        seen.extend(slits(0..5, 48.0));
        assert_eq!(align(&seen), [6, 7, 8, 9, 10, 11, 0, 1, 2, 3, 4]);
        let mut twice = slits(3..9, 0.0);
        twice.extend(slits(3..9, 60.0));
        assert_eq!(align(&twice), [3, 4, 5, 6, 7, 8, 3, 4, 5, 6, 7, 8]);
    }

    /// The best score of any path, by brute force: every crossing is left out or given any slit.
    fn brute_force(slits: &[u8], features: &[CrossingFeatures], odds: &[f32]) -> f32 {
        fn go(
            slits: &[u8],
            features: &[CrossingFeatures],
            odds: &[f32],
            i: usize,
            last: Option<(usize, usize)>,
            score: f32,
        ) -> f32 {
            if i == features.len() {
                return score;
            }
            let hues = odds.len() / features.len();
            let mut best = go(slits, features, odds, i + 1, last, score);
            for j in 0..slits.len() {
                let (prior, weight) = features[i].prior;
                let vote = if usize::from(prior) == j { VOTE_GAIN * weight } else { 0.0 };
                let gain = MATCH_GAIN + odds[i * hues + usize::from(slits[j])] + vote;
                // A jump ahead is cheaper than one back; the first start counts as one ahead.
                let mut from =
                    score - if last.is_none_or(|(_, q)| q < j) { JUMP_COST } else { JUMP_BACK_COST };
                if let Some((p, q)) = last {
                    let (one, two) = (step(features, i, 1, 2.0), step(features, i, 2, 2.0));
                    if p + 1 == i && q + 1 == j {
                        from = from.max(score - one.next);
                    }
                    if p + 1 == i && q + 2 == j {
                        from = from.max(score - MISSING_SLIT - one.missed);
                    }
                    if p + 2 == i && q + 1 == j {
                        from = from.max(score - EXTRA_CROSSING - two.next);
                    }
                }
                best = best.max(go(slits, features, odds, i + 1, Some((i, j)), from + gain));
            }
            best
        }
        go(slits, features, odds, 0, None, 0.0)
    }

    #[test]
    fn dynamic_programming_agrees_with_brute_force() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        for _ in 0..60 {
            let (n, k) = (rng.random_range(1..6), rng.random_range(1..7));
            let slits: Vec<u8> = (0..k).map(|_| rng.random_range(0..3)).collect();
            let mut u = 0.0;
            let features: Vec<CrossingFeatures> = (0..n)
                .map(|_| {
                    u += rng.random_range(4.0..20.0_f32);
                    let prior = (rng.random_range(0..k as u16), rng.random_range(0.0..1.0));
                    CrossingFeatures {
                        u,
                        width: rng.random_range(3.0..6.0),
                        light: rng.random_range(0.2..2.0),
                        prior,
                    }
                })
                .collect();
            let odds: Vec<f32> = (0..3 * n).map(|_| rng.random_range(-3.0..6.0)).collect();
            let mut labels = vec![NONE; n];
            let code = Code { slits: &slits, period_per_width: 2.0 };
            let scanline = Scanline { code, features: &features, odds: &odds };
            let found = Aligner::default().align(scanline, false, &mut labels);
            let best = brute_force(&slits, &features, &odds);
            assert!((found - best).abs() < 1e-4, "{found} for {best}");
        }
    }
}
