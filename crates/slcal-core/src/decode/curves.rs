//! Stripes are curves: crossings linked from line to line.

use super::stripes::{Crossing, total};

/// A crossing continues a curve when it lies within this share of the stripe's width of where the curve points.
const LINK_SHARE: f32 = 0.5;
/// Cosine of the angle between the colours of linked crossings.
const MIN_COLOR_COSINE: f32 = 0.88;
/// Ratio of the strengths and of the widths of linked crossings.
const MAX_RATIO: f32 = 2.0;
/// Weight of the newest step in a curve's direction.
const SLOPE_GAIN: f32 = 0.3;

const END: u32 = u32::MAX;

/// All crossings of a photograph, line after line, and the curves that they form.
#[derive(Debug, Clone, Default)]
pub(super) struct Curves {
    pub(super) crossings: Vec<Crossing>,
    /// Crossings of line y: `lines[y]..lines[y + 1]`.
    pub(super) lines: Vec<u32>,
    /// Directions of the colours.
    pub(super) units: Vec<[f32; 3]>,
    next: Vec<u32>,
    has_previous: Vec<bool>,
    slope: Vec<f32>,
    /// Indices of crossings, curve after curve, each from its first line to its last.
    order: Vec<u32>,
    /// Where each curve starts in `order`, and the end.
    starts: Vec<u32>,
    sums: Vec<[f64; 3]>,
}

pub(super) fn unit(c: [f32; 3]) -> Option<[f32; 3]> {
    let c = c.map(|x| x.max(0.0));
    let norm = (c[0] * c[0] + c[1] * c[1] + c[2] * c[2]).sqrt();
    (norm > 0.0 && norm.is_finite()).then(|| c.map(|x| x / norm))
}

impl Curves {
    pub(super) fn clear(&mut self) {
        self.crossings.clear();
        self.lines.clear();
        self.lines.push(0);
    }

    /// Number of lines.
    pub(super) fn line_count(&self) -> usize {
        self.lines.len().saturating_sub(1)
    }

    /// The crossings of a line.
    pub(super) fn of(&self, line: usize) -> std::ops::Range<usize> {
        self.lines[line] as usize..self.lines[line + 1] as usize
    }

    /// Indices of crossings, curve by curve.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[u32]> {
        self.starts.windows(2).map(|w| &self.order[w[0] as usize..w[1] as usize])
    }

    /// Links crossings of neighbouring lines.
    pub(super) fn link(&mut self) {
        let n = self.crossings.len();
        self.units.clear();
        self.units.extend(self.crossings.iter().map(|c| unit(c.color).unwrap_or([0.0; 3])));
        self.next.clear();
        self.next.resize(n, END);
        self.has_previous.clear();
        self.has_previous.resize(n, false);
        self.slope.clear();
        self.slope.resize(n, 0.0);
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
            let expected = |i: usize| self.crossings[i].middle() + self.slope[i];
            let miss = |i: usize, j: usize| (self.crossings[j].middle() - expected(i)).abs();
            // The nearest one below; both lines ascend, so that the search goes on from the last place.
            while j > below.start && miss(i, j - 1) <= miss(i, j.min(below.end - 1)) {
                j -= 1;
            }
            while j + 1 < below.end && miss(i, j + 1) < miss(i, j) {
                j += 1;
            }
            if j >= below.end {
                return;
            }
            // Mutual: nobody else above points closer to j.
            let own = miss(i, j);
            let rival =
                (i > above.start && miss(i - 1, j) < own) || (i + 1 < above.end && miss(i + 1, j) < own);
            if rival || self.has_previous[j] || !self.alike(i, j, own) {
                continue;
            }
            self.next[i] = j as u32;
            self.has_previous[j] = true;
            let step = self.crossings[j].middle() - self.crossings[i].middle();
            self.slope[j] = self.slope[i] + SLOPE_GAIN * (step - self.slope[i]);
        }
    }

    fn alike(&self, i: usize, j: usize, miss: f32) -> bool {
        let (a, b) = (&self.crossings[i], &self.crossings[j]);
        let within = |x: f32, y: f32| x <= MAX_RATIO * y && y <= MAX_RATIO * x;
        let (p, q) = (self.units[i], self.units[j]);
        let cosine = p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
        miss <= (LINK_SHARE * a.width().min(b.width())).max(1.0)
            && cosine >= MIN_COLOR_COSINE
            && within(total(a.color), total(b.color))
            && within(a.width(), b.width())
    }

    /// The mean direction of colour over ± `reach` lines along the curve, for every crossing.
    pub(super) fn smooth_units(&mut self, reach: usize, out: &mut Vec<[f32; 3]>) {
        out.clear();
        out.resize(self.crossings.len(), [0.0; 3]);
        for w in self.starts.windows(2) {
            let curve = &self.order[w[0] as usize..w[1] as usize];
            self.sums.clear();
            let mut sum = [0.0_f64; 3];
            self.sums.push(sum);
            for &i in curve {
                let c = self.units[i as usize];
                sum = std::array::from_fn(|k| sum[k] + f64::from(c[k]));
                self.sums.push(sum);
            }
            for (at, &i) in curve.iter().enumerate() {
                let (a, b) = (at.saturating_sub(reach), (at + reach + 1).min(curve.len()));
                let mean = std::array::from_fn(|k| (self.sums[b][k] - self.sums[a][k]) as f32);
                out[i as usize] = unit(mean).unwrap_or([0.0; 3]);
            }
        }
    }
}
