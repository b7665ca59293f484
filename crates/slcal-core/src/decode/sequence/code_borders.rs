//! Positions on the panel from the Gray code alone: at the borders of its cells, which are seen between two pixels, and from border to
//! border in between.

use super::pixel_code::NO_CELL;
use super::planes::border_bit;

/// Neighbouring pixels whose cells differ by more see different surfaces, or the code is wrong.
pub(super) const MOST_CELLS: u16 = 4;
/// 1σ of a uniform distribution over its width: of a position of which the cell alone is known, and of a border of which it is known
/// between which pixels it lies.
const UNIFORM: f32 = 0.289;
/// The share of a cell by which a position may leave it: borders have noise, too.
const BEYOND: f32 = 0.25;
/// Larger shares of white less black are the noise's.
const MOST_SHARE: f32 = 0.97;
/// Where between a straight profile (0) and a normal one (1) borders are taken to be, and 1σ of that.
const NORMAL: f32 = 0.67;
const SPREAD: f32 = 0.33;
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
    /// White less black there, the contrast of a bit away from its borders; zero where it is not known.
    fn full_contrast(&self, i: usize) -> f32;
    /// Takes position and σ of a pixel, panel px.
    fn put(&mut self, i: usize, position: f32, sigma: f32);
}

/// Whether two neighbouring pixels see one surface.
#[inline]
pub(super) fn are_linked(a: u16, b: u16) -> bool {
    a != NO_CELL && b != NO_CELL && a.abs_diff(b) <= MOST_CELLS
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
    let (share, unknown) = border_share([one, other], [end - 1, end].map(|i| line.full_contrast(i)));
    Border { end, at: first + share, sigma: moved.hypot(unknown).min(UNIFORM), on_panel }
}

/// Where between two pixels a border lies, as the share of the way from one to the other, and how far that is unknown (1σ). `full` is white
/// less black at both.
///
/// How the contrast grows with the distance from the border is the profile of the blur. Of a wide, even blur it is a straight line, of a
/// normal one the error function; a narrow, even one (of the pixel alone) looks like the latter, as it has all contrast a pixel away.
/// Most lenses are nearer to the normal one.
#[inline]
fn border_share([one, other]: [f32; 2], full: [f32; 2]) -> (f32, f32) {
    let straight = one / (one + other);
    if full[0] <= 0.0 || full[1] <= 0.0 {
        return (straight, 0.0);
    }
    let [a, b] = [distance(one / full[0]), distance(other / full[1])];
    let between = a / (a + b) - straight;
    (straight + NORMAL * between, SPREAD * between.abs())
}

/// The distance from a border at which a normal blur gives this share of the contrast, in units that cancel: the inverse of the error
/// function to 2 %.
#[inline]
fn distance(share: f32) -> f32 {
    let share = share.min(MOST_SHARE);
    let square = share * share;
    share / (1.0 - square * (0.26 + square * (0.06 + 0.14 * square)))
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The error function by Simpson's rule.
    fn erf(x: f64) -> f64 {
        let n = 200;
        let h = x / f64::from(n);
        let sum: f64 = (0..=n)
            .map(|i| {
                let weight = if i == 0 || i == n { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
                weight * (-(f64::from(i) * h).powi(2)).exp()
            })
            .sum();
        sum * h / 3.0 * std::f64::consts::FRAC_2_SQRT_PI
    }

    #[test]
    fn borders_lie_within_what_their_blur_leaves_unknown() {
        let even = |width: f64, d: f64| (2.0 * d / width).min(1.0);
        let normal = |sigma: f64, d: f64| erf(d / (sigma * std::f64::consts::SQRT_2));
        let check = |name: &str, most: f32, contrast: &dyn Fn(f64) -> f64| {
            for k in 1..20 {
                let at = 0.05 * f64::from(k);
                let pair = [contrast(at), contrast(1.0 - at)].map(|c| c as f32);
                let (share, unknown) = border_share(pair, [1.0; 2]);
                let off = (share - at as f32).abs();
                assert!(off <= most, "{name}, {at}: {share} ± {unknown}");
                assert!(off <= 2.5 * unknown + 0.006, "{name}, {at}: {share} ± {unknown}");
            }
        };
        // 1 px is the pixel alone.
        for (width, most) in [(1.0, 0.05), (1.5, 0.055), (2.0, 0.03), (3.0, 0.03)] {
            check(&format!("even, {width} px"), most, &|d| even(width, d));
        }
        for (sigma, most) in [(0.3, 0.075), (0.4, 0.04), (0.6, 0.025), (0.8, 0.02), (1.5, 0.01)] {
            check(&format!("normal, {sigma} px"), most, &|d| normal(sigma, d));
        }
        assert_eq!(border_share([30.0, 90.0], [0.0; 2]), (0.25, 0.0));
    }
}
