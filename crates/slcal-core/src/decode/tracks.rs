//! Tracks of stripes: crossings linked from scanline to scanline.

use super::rgb::{Rgb, dot, minus, plus, unit};
use super::stripe_edges::{StripeColor, StripeEdges};

/// A crossing continues a track when it lies within this share of the stripe's width of the predicted position.
const LINK_SHARE: f32 = 0.5;
/// Squared cosine of the largest angle between the colours of linked crossings.
const MIN_SQUARED_COSINE: f32 = 0.88 * 0.88;
/// Largest ratio of the heights and of the widths of linked crossings.
const MAX_RATIO: f32 = 2.0;
/// Weight of the newest step in a track's slope.
const SLOPE_GAIN: f32 = 0.3;

const END: u32 = u32::MAX;

/// All crossings of a photograph, scanline after scanline, and the tracks that they form.
#[derive(Debug, Clone, Default)]
pub(super) struct Tracks {
    pub(super) crossings: Vec<StripeEdges>,
    /// Crossings of scanline y: `lines[y]..lines[y + 1]`.
    pub(super) lines: Vec<u32>,
    /// Colours of the crossings on the aligned scanlines, line after line: a stripe has the same colour on the lines
    /// between.
    pub(super) colors: Vec<StripeColor>,
    next: Vec<u32>,
    has_previous: Vec<bool>,
    /// Midpoints of the crossings, and the predicted positions on the next scanline.
    middles: Vec<f32>,
    slope: Vec<f32>,
    expected: Vec<f32>,
    /// Indices of crossings, track after track, each from its first scanline to its last.
    order: Vec<u32>,
    /// Where each track starts in `order`, and the end.
    starts: Vec<u32>,
    sums: Vec<(usize, Rgb)>,
}

impl Tracks {
    pub(super) fn clear(&mut self) {
        self.crossings.clear();
        self.colors.clear();
        self.lines.clear();
        self.lines.push(0);
    }

    /// Number of scanlines.
    pub(super) fn line_count(&self) -> usize {
        self.lines.len().saturating_sub(1)
    }

    /// The crossings of a scanline.
    pub(super) fn of(&self, line: usize) -> std::ops::Range<usize> {
        self.lines[line] as usize..self.lines[line + 1] as usize
    }

    /// The scanline of a crossing.
    pub(super) fn line_of(&self, crossing: usize) -> usize {
        self.lines.partition_point(|first| *first as usize <= crossing) - 1
    }

    /// By how much the stripe of a crossing moves along the scanline from one to the next, px.
    pub(super) fn slope(&self, crossing: usize) -> f32 {
        self.slope[crossing]
    }

    /// Indices of crossings, track by track, and the crossings to change.
    pub(super) fn with_crossings(&mut self) -> (impl Iterator<Item = &[u32]>, &mut [StripeEdges]) {
        let Self { crossings, order, starts, .. } = self;
        (starts.windows(2).map(|w| &order[w[0] as usize..w[1] as usize]), crossings)
    }

    /// Indices of crossings, track by track.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[u32]> {
        self.starts.windows(2).map(|w| &self.order[w[0] as usize..w[1] as usize])
    }

    /// Links crossings of neighbouring scanlines.
    pub(super) fn link(&mut self) {
        let n = self.crossings.len();
        self.next.clear();
        self.next.resize(n, END);
        self.has_previous.clear();
        self.has_previous.resize(n, false);
        self.middles.clear();
        self.middles.extend(self.crossings.iter().map(StripeEdges::middle));
        self.slope.clear();
        self.slope.resize(n, 0.0);
        self.expected.clone_from(&self.middles);
        for line in 1..self.line_count() {
            self.link_lines(self.of(line - 1), self.of(line));
        }
        self.order.clear();
        self.starts.clear();
        self.starts.push(0);
        for first in 0..n {
            if self.has_previous[first] {
                continue;
            }
            let mut i = first as u32;
            while i != END {
                self.order.push(i);
                i = self.next[i as usize];
            }
            self.starts.push(self.order.len() as u32);
        }
    }

    fn link_lines(&mut self, above: std::ops::Range<usize>, below: std::ops::Range<usize>) {
        let mut j = below.start;
        for i in above.clone() {
            let miss = |i: usize, j: usize| (self.middles[j] - self.expected[i]).abs();
            // The nearest one below. Both scanlines ascend, so that the search continues from the last place.
            while j > below.start && miss(i, j - 1) <= miss(i, j.min(below.end - 1)) {
                j -= 1;
            }
            while j + 1 < below.end && miss(i, j + 1) < miss(i, j) {
                j += 1;
            }
            if j >= below.end {
                return;
            }
            // The choice must be mutual: no other prediction above is closer to j.
            let own = miss(i, j);
            let rival =
                (i > above.start && miss(i - 1, j) < own) || (i + 1 < above.end && miss(i + 1, j) < own);
            if rival || self.has_previous[j] || !self.alike(i, j, own) {
                continue;
            }
            self.next[i] = j as u32;
            self.has_previous[j] = true;
            let step = self.middles[j] - self.middles[i];
            self.slope[j] = self.slope[i] + SLOPE_GAIN * (step - self.slope[i]);
            self.expected[j] = self.middles[j] + self.slope[j];
        }
    }

    fn alike(&self, i: usize, j: usize, miss: f32) -> bool {
        let (a, b) = (&self.crossings[i], &self.crossings[j]);
        let within = |x: f32, y: f32| x <= MAX_RATIO * y && y <= MAX_RATIO * x;
        miss <= (LINK_SHARE * a.width().min(b.width())).max(1.0)
            && within(a.height, b.height)
            && same_hue(a.approximate_color, b.approximate_color)
            && within(a.width(), b.width())
    }

    /// Writes the mean direction of colour over ± `reach` scanlines along the track, for every crossing with a measured
    /// colour. `place` is the index of a crossing among these, `u32::MAX` for the others.
    pub(super) fn smooth_units(&mut self, place: &[u32], reach: usize, out: &mut Vec<Rgb>) {
        out.clear();
        out.resize(self.colors.len(), [0.0; 3]);
        for w in self.starts.windows(2) {
            let track = &self.order[w[0] as usize..w[1] as usize];
            let colored = |&(at, &i): &(usize, &u32)| {
                let place = place[i as usize];
                (place != u32::MAX).then_some((at, place as usize))
            };
            self.sums.clear();
            let mut sum = [0.0; 3];
            for (at, place) in track.iter().enumerate().filter_map(|x| colored(&x)) {
                self.sums.push((at, sum));
                sum = plus(sum, self.colors[place].unit);
            }
            self.sums.push((usize::MAX, sum));
            // The first and one past the last within reach: both only increase.
            let (mut from, mut to) = (0, 0);
            for (at, place) in track.iter().enumerate().filter_map(|x| colored(&x)) {
                while self.sums[from].0 + reach < at {
                    from += 1;
                }
                while self.sums[to].0 <= at + reach {
                    to += 1;
                }
                out[place] = unit(minus(self.sums[to].1, self.sums[from].1)).unwrap_or([0.0; 3]);
            }
        }
    }
}

/// Whether two colours are about the same, however bright.
pub(super) fn same_hue(a: Rgb, b: Rgb) -> bool {
    let along = dot(a, b);
    along > 0.0 && along * along >= MIN_SQUARED_COSINE * dot(a, a) * dot(b, b)
}
