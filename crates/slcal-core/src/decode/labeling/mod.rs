//! Which slit each crossing is: lines are aligned with the pattern, the lines of a curve vote, and the colours of the hues
//! and of the surfaces are learned from what was decoded, in turn.

use crate::decode::color_classes::{Hues, NO_HUE, Sample};
use crate::decode::rgb::{Rgb, over, plus, scaled, times, total, unit};
use crate::decode::sequence_alignment::{Aligner, NONE, Node};
use crate::decode::tracks::Curves;

/// Lines that are aligned, per width of a stripe: colours are averaged along curves, so that neighbouring lines say the
/// same.
const LINES_PER_WIDTH: f32 = 2.0;
/// Votes are counted over this many stripe widths along a curve to either side: what holds along a stripe about as far
/// as across two. Colours are averaged over half of it.
const REACH_WIDTHS: f32 = 4.0;
/// Rounds in which hues are learned anew from what was decoded, and votes are heard.
const LEARNING_PASSES: usize = 2;
/// Hues are learned, and while they are, votes cast, on lines with about so many crossings.
const TEACHERS: usize = 2000;
/// Votes of this support teach hues and surfaces.
const SURE: f32 = 0.8;
/// Share of the votes cast that the winner must have, and share of all about that must have voted for it.
const MIN_SHARE: f32 = 0.6;
const MIN_SUPPORT: f32 = 0.4;
/// A surface's colour is learned from this many neighbouring stripes to either side, if at least as many as a window of
/// the code and some more are there; all channels must have been lit for this share of their light.
const SURFACE_REACH: usize = 6;
const MIN_SURFACE: usize = 6;
const MIN_CHANNEL: f32 = 0.08;
/// It is sought for every so many stripes.
const SURFACE_STEP: usize = 3;
/// Rounds in which it is sought, and the change of a channel at which it is found.
const SURFACE_ROUNDS: usize = 5;
const SURFACE_TOLERANCE: f32 = 0.05;

/// The lines that are aligned with the pattern; crossings on them are painted, in the same order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct AlignedLines {
    step: usize,
}

impl AlignedLines {
    pub(super) fn for_width(width_px: f32) -> Self {
        Self { step: ((width_px / LINES_PER_WIDTH).round() as usize).max(1) }
    }

    pub(super) fn contain(self, line: usize) -> bool {
        line % self.step == self.step / 2
    }
}

/// A slit number for a crossing and how sure it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Vote {
    /// Position in the order of slits; [`NONE`] when undecided.
    pub(super) label: u16,
    /// Share of the aligned lines about that agree, 0–1.
    pub(super) support: f32,
}

const UNDECIDED: Vote = Vote { label: NONE, support: 0.0 };

/// The pattern as lines meet it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Code<'a> {
    /// Hue of the slits, in the order in which a line meets them.
    pub(super) slits: &'a [u8],
    /// Period over width of the slits.
    pub(super) period_per_width: f32,
}

/// The crossings on the lines that are aligned, and what is known of them.
#[derive(Debug, Clone, Default)]
pub(super) struct Numbers {
    pub(super) hues: Hues,
    /// One per crossing of the photograph.
    pub(super) votes: Vec<Vote>,
    /// Crossings on aligned lines, by index, line after line; and where each such line starts.
    chosen: Vec<u32>,
    starts: Vec<u32>,
    /// The aligned line that each of them lies on.
    line_of: Vec<u32>,
    /// Their colours as seen, and with the surface's own colour taken off.
    seen: Vec<Sample>,
    samples: Vec<Sample>,
    hue_labels: Vec<u8>,
    teachers: Vec<Sample>,
    teachers_hues: Vec<u8>,
    labels: Vec<u16>,
    reach: usize,
    /// Every so many of the lines teach hues.
    teaching: usize,
    aligner: Aligner,
    nodes: Vec<Node>,
    odds: Vec<f32>,
    smooth: Vec<Rgb>,
    /// Where on a curve the lines that vote cross it, and for which slit.
    ballots: Vec<(usize, u16)>,
    counts: Vec<(u16, u32)>,
    /// Position in `chosen` of a crossing on an aligned line, by crossing; `u32::MAX` elsewhere.
    place: Vec<u32>,
}

impl Numbers {
    /// Takes the crossings of the lines to be aligned and averages their colours along curves.
    pub(super) fn choose(&mut self, curves: &mut Curves, aligned: AlignedLines, width_px: f32) {
        self.reach = ((REACH_WIDTHS * width_px).ceil() as usize).max(3);
        self.chosen.clear();
        self.starts.clear();
        self.starts.push(0);
        self.line_of.clear();
        self.place.clear();
        self.place.resize(curves.crossings.len(), u32::MAX);
        for line in (0..curves.line_count()).filter(|&y| aligned.contain(y)) {
            for i in curves.of(line) {
                self.place[i] = self.chosen.len() as u32;
                self.chosen.push(i as u32);
                self.line_of.push(self.starts.len() as u32 - 1);
            }
            self.starts.push(self.chosen.len() as u32);
        }
        curves.smooth_units(&self.place, self.reach / 2, &mut self.smooth);
        self.seen.clear();
        self.seen.extend(curves.paints.iter().zip(&self.smooth).map(|(p, &unit)| Sample {
            unit,
            sigma: p.sigma,
            light: p.light,
            log_light: p.light.max(1e-9).ln(),
        }));
        self.samples.clone_from(&self.seen);
        self.votes.clear();
        self.votes.resize(curves.crossings.len(), UNDECIDED);
        self.labels.clear();
        self.labels.resize(self.chosen.len(), NONE);
        self.hue_labels.clear();
        self.hue_labels.resize(self.chosen.len(), NO_HUE);
        self.teaching = (self.chosen.len() / TEACHERS).max(1);
    }

    /// Learns the hues without knowing any number.
    pub(super) fn learn_hues(&mut self, palette: &[Rgb], sequence: &[u8], balanced: bool) {
        self.gather_teachers();
        self.hues.seed(palette, sequence, &self.teachers, balanced);
        self.hues.learn(&self.teachers, None);
    }

    /// How well each code fits on about `scanlines` of the lines, into `scores`, nats; and the number of crossings on them.
    pub(super) fn score(
        &mut self,
        curves: &Curves,
        codes: &[Vec<u8>],
        period_per_width: f32,
        lines: usize,
        scores: &mut Vec<f32>,
    ) -> usize {
        let all = self.starts.len() - 1;
        let mut tried = 0;
        scores.clear();
        scores.resize(codes.len(), 0.0);
        for k in 0..lines.min(all) {
            let line = (2 * k + 1) * all / (2 * lines.min(all));
            let range = self.starts[line] as usize..self.starts[line + 1] as usize;
            tried += range.len();
            self.prepare(curves, range.clone());
            for (slits, score) in codes.iter().zip(scores.iter_mut()) {
                *score += self.align(Code { slits, period_per_width }, range.clone(), true);
            }
        }
        tried
    }

    /// How many lines are aligned.
    pub(super) fn line_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The crossings of an aligned line as alignment sees them, and the slits that they were given.
    pub(super) fn numbered_line(&mut self, curves: &Curves, line: usize) -> (&[Node], impl Fn(usize) -> u16) {
        let range = self.starts[line] as usize..self.starts[line + 1] as usize;
        self.nodes.clear();
        for at in range.clone() {
            let hue = self.hues.nearest(self.samples[at].unit);
            self.nodes.push(self.node(curves, at, hue));
        }
        let Self { nodes, votes, chosen, .. } = self;
        (nodes, move |at| votes[chosen[range.start + at] as usize].label)
    }

    /// Numbers all crossings.
    pub(super) fn number(&mut self, curves: &Curves, code: Code<'_>) {
        for pass in 0..=LEARNING_PASSES {
            let stride = self.stride(pass);
            for line in (0..self.starts.len() - 1).step_by(stride) {
                let range = self.starts[line] as usize..self.starts[line + 1] as usize;
                self.prepare(curves, range.clone());
                self.align(code, range, pass < LEARNING_PASSES);
            }
            self.vote(curves, stride);
            if pass < LEARNING_PASSES {
                self.learn_from_votes(code, self.stride(pass + 1));
            }
        }
    }

    /// Every so many of the lines are aligned in a pass.
    fn stride(&self, pass: usize) -> usize {
        if pass < LEARNING_PASSES { self.teaching } else { 1 }
    }

    /// What alignment looks at on a line.
    fn prepare(&mut self, curves: &Curves, range: std::ops::Range<usize>) {
        let hues = self.hues.directions.len();
        self.odds.clear();
        self.odds.resize(range.len() * hues, 0.0);
        self.nodes.clear();
        let mut odds = std::mem::take(&mut self.odds);
        for (at, odds) in range.zip(odds.chunks_exact_mut(hues)) {
            let nearest = self.hues.log_odds(&self.samples[at], odds);
            self.nodes.push(self.node(curves, at, nearest));
        }
        self.odds = odds;
    }

    fn node(&self, curves: &Curves, at: usize, hue: u8) -> Node {
        let i = self.chosen[at] as usize;
        let (c, vote) = (&curves.crossings[i], self.votes[i]);
        let usual = self.hues.brightness.get(usize::from(hue)).copied().unwrap_or(1.0);
        Node {
            u: c.middle(),
            width: c.width(),
            light: self.samples[at].light / usual,
            hint: (vote.label, vote.support),
        }
    }

    fn align(&mut self, code: Code<'_>, range: std::ops::Range<usize>, lenient: bool) -> f32 {
        let labels = &mut self.labels[range];
        self.aligner.align(code.slits, code.period_per_width, &self.nodes, &self.odds, lenient, labels)
    }

    /// The winner among the aligned lines within reach of each crossing along its curve, of those that are a multiple of
    /// `stride`.
    fn vote(&mut self, curves: &Curves, stride: usize) {
        let Self { place, line_of, labels, votes, ballots, counts, reach, .. } = self;
        for curve in curves.iter() {
            ballots.clear();
            for (at, &i) in curve.iter().enumerate() {
                let place = place[i as usize] as usize;
                if line_of.get(place).is_some_and(|line| line.is_multiple_of(stride as u32)) {
                    ballots.push((at, labels[place]));
                }
            }
            counts.clear();
            // Those in the window about a crossing, whether they chose a slit or not.
            let (mut from, mut to) = (0, 0);
            let mut vote = UNDECIDED;
            for (at, &i) in curve.iter().enumerate() {
                let seated = to - from;
                while to < ballots.len() && ballots[to].0 <= at + *reach {
                    change(counts, ballots[to].1, 1);
                    to += 1;
                }
                let joined = to - from > seated;
                let first = from;
                while from < to && ballots[from].0 + *reach < at {
                    change(counts, ballots[from].1, -1);
                    from += 1;
                }
                // Counted again when the window has changed, which it seldom has.
                if joined || from > first {
                    vote = winner(counts, (to - from) as u32);
                }
                votes[i as usize] = vote;
            }
        }
    }

    /// Learns the colours of surfaces and hues, for every `stride`-th line to be aligned next.
    fn learn_from_votes(&mut self, code: Code<'_>, stride: usize) {
        self.hue_labels.clear();
        self.hue_labels.extend(self.chosen.iter().map(|&i| {
            let vote = self.votes[i as usize];
            let hue = code.slits.get(usize::from(vote.label)).copied();
            hue.filter(|_| vote.support > SURE).unwrap_or(NO_HUE)
        }));
        for line in (0..self.starts.len() - 1).step_by(stride) {
            self.take_off_surface(self.starts[line] as usize..self.starts[line + 1] as usize);
        }
        self.gather_teachers();
        self.hues.learn(&self.teachers, Some(&self.teachers_hues));
    }

    /// The crossings that teach hues, and the hues that they are known to have.
    fn gather_teachers(&mut self) {
        self.teachers.clear();
        self.teachers_hues.clear();
        for line in (0..self.starts.len() - 1).step_by(self.teaching) {
            let range = self.starts[line] as usize..self.starts[line + 1] as usize;
            self.teachers.extend_from_slice(&self.samples[range.clone()]);
            self.teachers_hues.extend_from_slice(&self.hue_labels[range]);
        }
    }

    /// Divides out the colour of the surface: what neighbouring stripes on it have in common beyond their hues.
    fn take_off_surface(&mut self, line: std::ops::Range<usize>) {
        let number = |at: usize| self.votes[self.chosen[at] as usize].label;
        let hue = |at: usize| self.hue_labels[at];
        let joined = |at: usize| number(at) != NONE && number(at).wrapping_add(1) == number(at + 1);
        // What was found for a stripe, which does for its next neighbours on the surface.
        let (mut known, mut found) = (0, None);
        for at in line.clone() {
            self.samples[at] = self.seen[at];
            if at > line.start && !joined(at - 1) {
                known = at;
            }
            if hue(at) == NO_HUE {
                continue;
            }
            if at >= known {
                let (mut from, mut to) = (at, at);
                while from > line.start && at - from < SURFACE_REACH && joined(from - 1) {
                    from -= 1;
                }
                while to + 1 < line.end && to - at < SURFACE_REACH && joined(to) {
                    to += 1;
                }
                (known, found) = (at + SURFACE_STEP, self.surface_gain(from..=to));
            }
            if let Some(gain) = found
                && let Some(direction) = self.hues.directions.get(usize::from(hue(at)))
            {
                let own = self.seen[at];
                let lit = total(times(*direction, gain)) / total(*direction);
                self.samples[at].unit = divided(own.unit, gain);
                self.samples[at].light = own.light / lit;
                self.samples[at].log_light = own.log_light - lit.ln();
            }
        }
    }

    /// What a surface reflects of each channel, up to a factor, from neighbouring stripes on it: with it taken off, the
    /// directions of their colours have the sum that those of their hues have.
    fn surface_gain(&self, stripes: std::ops::RangeInclusive<usize>) -> Option<Rgb> {
        let hue = |at: &usize| self.hues.directions.get(usize::from(self.hue_labels[*at]));
        let (mut expected, mut n) = ([0.0_f32; 3], 0);
        for &direction in stripes.clone().filter_map(|at| hue(&at)) {
            n += 1;
            expected = plus(expected, direction);
        }
        let least = MIN_CHANNEL * n as f32;
        let mut gain = [1.0_f32; 3];
        for _ in 0..SURFACE_ROUNDS {
            let mut seen = [0.0_f32; 3];
            for at in stripes.clone().filter(|at| hue(at).is_some()) {
                let own = self.seen[at].unit;
                let unit = if gain == [1.0; 3] { own } else { divided(own, gain) };
                seen = plus(seen, unit);
            }
            if n < MIN_SURFACE || expected.iter().chain(&seen).any(|&x| x < least) {
                return None;
            }
            let change = over(seen, expected);
            gain = times(gain, change);
            if change.iter().all(|c| (c - 1.0).abs() < SURFACE_TOLERANCE) {
                break;
            }
        }
        Some(scaled(gain, 3.0 / total(gain)))
    }
}

fn divided(color: Rgb, gain: Rgb) -> Rgb {
    unit(over(color, gain)).unwrap_or(color)
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

fn winner(counts: &[(u16, u32)], seats: u32) -> Vote {
    let cast: u32 = counts.iter().map(|c| c.1).sum();
    let Some(first) = counts.iter().max_by_key(|c| c.1).filter(|c| c.1 > 0) else { return UNDECIDED };
    let (share, support) = (first.1 as f32 / cast as f32, first.1 as f32 / seats.max(1) as f32);
    let sure = share >= MIN_SHARE && support >= MIN_SUPPORT;
    Vote { label: if sure { first.0 } else { NONE }, support }
}
