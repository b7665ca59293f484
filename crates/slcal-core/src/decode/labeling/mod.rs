//! Labels every crossing with its slit: scanlines are aligned with the pattern and vote along tracks ([`votes`]). The
//! colours of the classes and of the surfaces are learned from the labels in turn ([`training`]).

mod training;
mod votes;

use std::ops::Range;

use self::training::KnownCrossings;
use self::votes::{UNDECIDED, VoteCounter};
use super::color_classes::{ColorClasses, ColorSample, NO_CLASS};
use super::crossing_features::{CrossingFeatures, NONE};
use super::rgb::Rgb;
use super::sequence_alignment::{Aligner, Code, Scanline};
use super::tracks::Tracks;

pub(super) use self::votes::VotedLabel;

/// Aligned scanlines per width of a stripe. Colours are averaged along tracks, so that neighbouring scanlines carry the same
/// information.
const LINES_PER_WIDTH: f32 = 2.0;
/// Votes are counted over this many stripe widths along a track to either side: surfaces change about as much over that
/// distance as across two stripes. Colours are averaged over half of it.
const REACH_WIDTHS: f32 = 4.0;
/// Passes in which colour classes are learned anew from the labels and votes enter the alignment.
const LEARNING_PASSES: usize = 2;
/// The learning passes use scanlines with about this many crossings in all.
const TRAINING_CROSSINGS: usize = 2000;
/// Labels with more support than this are training data for colour classes and surfaces.
const MIN_TRAINING_SUPPORT: f32 = 0.8;

/// The scanlines that are aligned with the pattern. The colours of their crossings are measured, in the same order.
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

/// The crossings on aligned scanlines and their labels; keeps its buffers.
#[derive(Debug, Clone, Default)]
pub(super) struct Labeling {
    pub(super) classes: ColorClasses,
    /// One per crossing of the photograph.
    pub(super) votes: Vec<VotedLabel>,
    /// Indices of the crossings on aligned scanlines, line after line, and where each such line starts.
    selected: Vec<u32>,
    starts: Vec<u32>,
    /// The aligned scanline of each of them.
    line_of: Vec<u32>,
    /// Their colours as measured, and with the colour of the surface divided out.
    raw_samples: Vec<ColorSample>,
    samples: Vec<ColorSample>,
    hue_labels: Vec<u8>,
    training: Vec<ColorSample>,
    training_hues: Vec<u8>,
    labels: Vec<u16>,
    reach: usize,
    /// Every `training_stride`-th aligned scanline is training data.
    training_stride: usize,
    aligner: Aligner,
    features: Vec<CrossingFeatures>,
    odds: Vec<f32>,
    smooth: Vec<Rgb>,
    counter: VoteCounter,
    /// Position in `selected` of each crossing on an aligned scanline; `u32::MAX` for the others.
    place: Vec<u32>,
}

impl Labeling {
    /// Selects the crossings on the scanlines to be aligned and averages their colours along tracks.
    pub(super) fn select(&mut self, tracks: &mut Tracks, aligned: AlignedLines, width_px: f32) {
        self.reach = ((REACH_WIDTHS * width_px).ceil() as usize).max(3);
        self.selected.clear();
        self.starts.clear();
        self.starts.push(0);
        self.line_of.clear();
        self.place.clear();
        self.place.resize(tracks.crossings.len(), u32::MAX);
        for line in (0..tracks.line_count()).filter(|&y| aligned.contain(y)) {
            for i in tracks.of(line) {
                self.place[i] = self.selected.len() as u32;
                self.selected.push(i as u32);
                self.line_of.push(self.starts.len() as u32 - 1);
            }
            self.starts.push(self.selected.len() as u32);
        }
        tracks.smooth_units(&self.place, self.reach / 2, &mut self.smooth);
        self.raw_samples.clear();
        self.raw_samples.extend(tracks.colors.iter().zip(&self.smooth).map(|(p, &unit)| ColorSample {
            unit,
            sigma: p.sigma,
            light: p.light,
            log_light: p.light.max(1e-9).ln(),
        }));
        self.samples.clone_from(&self.raw_samples);
        self.votes.clear();
        self.votes.resize(tracks.crossings.len(), UNDECIDED);
        self.labels.clear();
        self.labels.resize(self.selected.len(), NONE);
        self.hue_labels.clear();
        self.hue_labels.resize(self.selected.len(), NO_CLASS);
        self.training_stride = (self.selected.len() / TRAINING_CROSSINGS).max(1);
    }

    /// Learns the colour classes without any labels.
    pub(super) fn learn_classes(&mut self, palette: &[Rgb], sequence: &[u8], balanced: bool) {
        self.gather_training();
        self.classes.seed(palette, sequence, &self.training, balanced);
        self.classes.learn(&self.training, None);
    }

    /// Writes into `scores` how well each code fits on `lines` of the aligned scanlines, nats. Returns the number of crossings
    /// on them.
    pub(super) fn score(
        &mut self,
        tracks: &Tracks,
        codes: &[Vec<u8>],
        period_per_width: f32,
        lines: usize,
        scores: &mut Vec<f32>,
    ) -> usize {
        let all = self.line_count();
        let mut tried = 0;
        scores.clear();
        scores.resize(codes.len(), 0.0);
        for k in 0..lines.min(all) {
            let line = (2 * k + 1) * all / (2 * lines.min(all));
            let range = self.line(line);
            tried += range.len();
            self.prepare(tracks, range.clone());
            for (slits, score) in codes.iter().zip(scores.iter_mut()) {
                *score += self.align(Code { slits, period_per_width }, range.clone(), true);
            }
        }
        tried
    }

    /// Number of aligned scanlines.
    pub(super) fn line_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The crossings of an aligned scanline, as positions in `selected`.
    fn line(&self, line: usize) -> Range<usize> {
        self.starts[line] as usize..self.starts[line + 1] as usize
    }

    /// The features of the crossings on an aligned scanline, and their labels.
    pub(super) fn labeled_line(
        &mut self,
        tracks: &Tracks,
        line: usize,
    ) -> (&[CrossingFeatures], impl Fn(usize) -> u16) {
        let range = self.line(line);
        self.features.clear();
        for at in range.clone() {
            let hue = self.classes.nearest(self.samples[at].unit);
            self.features.push(self.features_of(tracks, at, hue));
        }
        let Self { features, votes, selected, .. } = self;
        (features, move |at| votes[selected[range.start + at] as usize].label)
    }

    /// Labels all crossings.
    pub(super) fn label_all(&mut self, tracks: &Tracks, code: Code<'_>) {
        for pass in 0..=LEARNING_PASSES {
            let stride = self.stride(pass);
            for line in (0..self.line_count()).step_by(stride) {
                let range = self.line(line);
                self.prepare(tracks, range.clone());
                self.align(code, range, pass < LEARNING_PASSES);
            }
            self.vote(tracks, stride);
            if pass < LEARNING_PASSES {
                self.learn_from_votes(code, self.stride(pass + 1));
            }
        }
    }

    /// Every `stride`-th of the aligned scanlines takes part in a pass.
    fn stride(&self, pass: usize) -> usize {
        if pass < LEARNING_PASSES { self.training_stride } else { 1 }
    }

    /// Computes the features and the log-odds of the crossings of a scanline.
    fn prepare(&mut self, tracks: &Tracks, range: Range<usize>) {
        let classes = self.classes.directions.len();
        self.odds.clear();
        self.odds.resize(range.len() * classes, 0.0);
        self.features.clear();
        let mut odds = std::mem::take(&mut self.odds);
        for (at, odds) in range.zip(odds.chunks_exact_mut(classes)) {
            let nearest = self.classes.log_odds(&self.samples[at], odds);
            self.features.push(self.features_of(tracks, at, nearest));
        }
        self.odds = odds;
    }

    fn features_of(&self, tracks: &Tracks, at: usize, hue: u8) -> CrossingFeatures {
        let i = self.selected[at] as usize;
        let (c, vote) = (&tracks.crossings[i], self.votes[i]);
        let usual = self.classes.brightness.get(usize::from(hue)).copied().unwrap_or(1.0);
        CrossingFeatures {
            u: c.middle(),
            width: c.width(),
            light: self.samples[at].light / usual,
            prior: (vote.label, vote.support),
        }
    }

    fn align(&mut self, code: Code<'_>, range: Range<usize>, lenient: bool) -> f32 {
        let scanline = Scanline { code, features: &self.features, odds: &self.odds };
        self.aligner.align(scanline, lenient, &mut self.labels[range])
    }

    /// Counts the votes of the aligned scanlines whose index is a multiple of `stride`.
    fn vote(&mut self, tracks: &Tracks, stride: usize) {
        let Self { place, line_of, labels, votes, counter, reach, .. } = self;
        let label_of = |i: usize| {
            let place = place[i] as usize;
            let line = line_of.get(place)?;
            line.is_multiple_of(stride as u32).then(|| labels[place])
        };
        counter.count(tracks, *reach, label_of, votes);
    }

    /// Learns the colours of the surfaces and of the classes, for the next pass over every `stride`-th scanline.
    fn learn_from_votes(&mut self, code: Code<'_>, stride: usize) {
        self.hue_labels.clear();
        self.hue_labels.extend(self.selected.iter().map(|&i| {
            let vote = self.votes[i as usize];
            let hue = code.slits.get(usize::from(vote.label)).copied();
            hue.filter(|_| vote.support > MIN_TRAINING_SUPPORT).unwrap_or(NO_CLASS)
        }));
        let known = KnownCrossings {
            label: |at: usize| self.votes[self.selected[at] as usize].label,
            hues: &self.hue_labels,
            raw: &self.raw_samples,
            directions: &self.classes.directions,
        };
        for line in self.starts.windows(2).step_by(stride) {
            known.remove_surface_color(line[0] as usize..line[1] as usize, &mut self.samples);
        }
        self.gather_training();
        self.classes.learn(&self.training, Some(&self.training_hues));
    }

    /// Collects the training data: colours of crossings and the classes of their slits, where known.
    fn gather_training(&mut self) {
        self.training.clear();
        self.training_hues.clear();
        for line in (0..self.line_count()).step_by(self.training_stride) {
            let range = self.line(line);
            self.training.extend_from_slice(&self.samples[range.clone()]);
            self.training_hues.extend_from_slice(&self.hue_labels[range]);
        }
    }
}
