//! Positions on the panel from the Gray code alone: at the borders of its cells, which are seen between two pixels, and from border to
//! border in between.

use super::pixel_code::NO_CELL;
use super::planes::border_bit;

/// Neighbouring pixels whose cells differ by more see different surfaces.
const MOST_CELLS: u16 = 4;
/// 1σ of a uniform distribution over its width: of a position of which the cell alone is known, and of a border of which it is known
/// between which pixels it lies.
const UNIFORM: f32 = 0.289;
/// The share of a cell by which a position may leave it: borders have noise, too.
const BEYOND: f32 = 0.25;
/// Borders are no closer to each other, px.
const CLOSEST: f32 = 1e-3;

/// What is seen along a line of the image, and where its positions go.
pub(super) trait Line {
    /// The cell of a pixel of the line.
    fn cell(&self, i: usize) -> u16;
    /// The contrast of a bit there, whatever its sign.
    fn contrast(&self, i: usize, bit: u32) -> i16;
    /// 1σ of that contrast, from noise.
    fn sigma(&self, i: usize) -> f32;
    /// Takes position and σ of a pixel, panel px.
    fn put(&mut self, i: usize, position: f32, sigma: f32);
}

/// Whether two neighbouring pixels see one surface.
#[inline]
pub(super) fn are_linked(a: u16, b: u16) -> bool {
    (a != NO_CELL) & (b != NO_CELL) & (a.abs_diff(b) <= MOST_CELLS)
}

/// A border between two pixels of a line.
#[derive(Debug, Clone, Copy, Default)]
struct Border {
    /// The pixel behind it.
    end: usize,
    /// On the line, px.
    at: f32,
    sigma: f32,
    /// On the panel, px.
    on_panel: f32,
}

/// Pixels of a line, one after another, that see one surface. Their positions are known when the next border comes.
#[derive(Debug, Clone, Copy)]
pub(super) struct LineRun {
    /// That of the last pixel.
    cell: u16,
    /// Borders so far; from two on, two.
    borders: u8,
    start: usize,
    last: Border,
    before: Border,
}

impl Default for LineRun {
    fn default() -> Self {
        Self { cell: NO_CELL, borders: 0, start: 0, last: Border::default(), before: Border::default() }
    }
}

impl LineRun {
    /// Takes the cell of the next pixel; cells are `cell_px` wide.
    #[inline]
    pub(super) fn next(&mut self, line: &mut impl Line, cell_px: f32, i: usize, cell: u16) {
        if cell == self.cell {
            return;
        }
        if are_linked(self.cell, cell) {
            let border = border(line, cell_px, [self.cell, cell], i);
            self.pass(line, cell_px, border);
            self.cell = cell;
            return;
        }
        self.end(line, cell_px, i);
        (self.cell, self.borders, self.start) = (cell, 0, i);
    }

    /// Ends the run before pixel `end`.
    #[inline]
    pub(super) fn end(&mut self, line: &mut impl Line, cell_px: f32, end: usize) {
        if self.cell == NO_CELL {
            return;
        }
        if self.borders < 2 {
            // The cell alone is known.
            for i in self.start..end {
                put(line, cell_px, i, middle(line, cell_px, i), UNIFORM * cell_px);
            }
        } else {
            beyond(line, cell_px, [self.last, self.before], self.last.end..end);
        }
        *self = Self::default();
    }

    #[inline]
    fn pass(&mut self, line: &mut impl Line, cell_px: f32, border: Border) {
        if self.borders == 1 {
            beyond(line, cell_px, [self.last, border], self.start..self.last.end);
        }
        if self.borders > 0 {
            between(line, cell_px, [self.last, border]);
        }
        (self.before, self.last) = (self.last, border);
        self.borders = (self.borders + 1).min(2);
    }
}

/// The middle of a pixel's cell.
#[inline]
fn middle(line: &impl Line, cell_px: f32, i: usize) -> f32 {
    (f32::from(line.cell(i)) + 0.5) * cell_px - 0.5
}

/// Puts a position that lies in the pixel's cell, or the cell's middle.
#[inline]
fn put(line: &mut impl Line, cell_px: f32, i: usize, at: f32, sigma: f32) {
    let middle = middle(line, cell_px, i);
    let is_here = (at - middle).abs() <= (0.5 + BEYOND) * cell_px;
    let (at, sigma) = if is_here { (at, sigma) } else { (middle, cell_px) };
    line.put(i, at, sigma);
}

/// The border between pixels `end` − 1 and `end` of a line, whose cells differ.
#[inline]
fn border(line: &impl Line, cell_px: f32, [a, b]: [u16; 2], end: usize) -> Border {
    let on_panel = 0.5 * (f32::from(a) + f32::from(b) + 1.0) * cell_px - 0.5;
    let first = end as f32 - 1.0;
    let unknown = Border { end, at: first + 0.5, sigma: UNIFORM, on_panel };
    if a.abs_diff(b) > 1 {
        // Several borders between two pixels.
        return unknown;
    }
    let bit = border_bit(a.max(b));
    let [one, other] = [end - 1, end].map(|i| f32::from(line.contrast(i, bit)));
    let sum = one + other;
    if sum <= 0.0 {
        return unknown;
    }
    // A border moves by (1 − share) of the noise of the one contrast and share of that of the other.
    let per_sum = 1.0 / sum;
    let noise = 0.5 * (line.sigma(end - 1) + line.sigma(end));
    let moved = noise * (one * one + other * other).sqrt() * per_sum * per_sum;
    Border { end, at: first + one * per_sum, sigma: moved.min(UNIFORM), on_panel }
}

/// The pixels between two borders: on the straight line through both.
#[inline]
fn between(line: &mut impl Line, cell_px: f32, [a, b]: [Border; 2]) {
    let step = b.on_panel - a.on_panel;
    if step.abs() < 0.5 * cell_px {
        // The same border twice: one of them is not where it seems to be.
        for i in a.end..b.end {
            let middle = middle(line, cell_px, i);
            line.put(i, middle, cell_px);
        }
        return;
    }
    let per_px = 1.0 / (b.at - a.at).max(CLOSEST);
    for i in a.end..b.end {
        let t = (i as f32 - a.at) * per_px;
        let (of_a, of_b) = ((1.0 - t) * a.sigma, t * b.sigma);
        let sigma = (step * per_px).abs() * (of_a * of_a + of_b * of_b).sqrt();
        put(line, cell_px, i, a.on_panel + step * t, sigma);
    }
}

/// Pixels beyond the last border, with the slope between it and the last but one. It is a prediction: its σ grows with the distance.
#[inline]
fn beyond(line: &mut impl Line, cell_px: f32, [last, before]: [Border; 2], pixels: std::ops::Range<usize>) {
    let slope = (last.on_panel - before.on_panel) / (last.at - before.at);
    for i in pixels {
        if slope.is_finite() {
            let away = i as f32 - last.at;
            let sigma = slope.abs() * (last.sigma + 0.25 * away.abs());
            put(line, cell_px, i, last.on_panel + slope * away, sigma);
        } else {
            put(line, cell_px, i, middle(line, cell_px, i), UNIFORM * cell_px);
        }
    }
}
