//! Positions on the panel from the Gray code alone: at the borders of its cells, which are seen between two pixels, and from border to
//! border in between.

use super::planes::{AxisPlanes, border_bit};

/// Neighbouring pixels whose cells differ by more see different surfaces.
const MOST_CELLS: u16 = 4;
/// 1σ of a uniform distribution over its width: of a position of which the cell alone is known, and of a border of which it is known
/// between which pixels it lies.
const UNIFORM: f32 = 0.289;
/// A position farther from the mean of its neighbourhood is wrong, cells.
const MOST_STRAY: f32 = 0.75;
/// Pixels on either side that make up a neighbourhood.
const NEIGHBOURS: usize = 3;
/// 1σ of the mean of a neighbourhood whose borders are in disorder, cells.
const DISORDER: f32 = 0.5;
/// The share of a cell by which a position may leave it: borders have noise, too.
const BEYOND: f32 = 0.25;

/// A border between two pixels of a line.
#[derive(Debug, Clone, Copy)]
struct Border {
    /// On the line, px.
    at: f32,
    sigma: f32,
    /// On the panel, px.
    on_panel: f32,
}

/// Finds the positions of the pixels of one line after another; keeps its buffers.
#[derive(Debug, Clone, Default)]
pub(super) struct CodeBorders {
    borders: Vec<Border>,
    positions: Vec<f32>,
}

impl CodeBorders {
    /// Writes position and σ of the pixels of a line, panel px. `cells` are those of the pixels, `u16::MAX` where there is none; pixel i of
    /// the line is pixel `index(i)` of the planes. `sigma(i)` is the noise of a level there.
    pub(super) fn line(
        &mut self,
        planes: &AxisPlanes,
        cells: &[u16],
        index: impl Fn(usize) -> usize,
        sigma: impl Fn(usize) -> f32,
        out: &mut [(f32, f32)],
    ) {
        out.fill((f32::NAN, f32::NAN));
        let mut start = 0;
        while start < cells.len() {
            if cells[start] == u16::MAX {
                start += 1;
                continue;
            }
            // A run of pixels that see one surface.
            let mut end = start + 1;
            self.borders.clear();
            while end < cells.len()
                && cells[end] != u16::MAX
                && cells[end].abs_diff(cells[end - 1]) <= MOST_CELLS
            {
                let pair = [cells[end - 1], cells[end]];
                if pair[0] != pair[1] {
                    self.borders.push(border(planes, pair, end, &index, &sigma));
                }
                end += 1;
            }
            self.run(planes.code.cell_px as f32, &cells[start..end], start, &mut out[start..end]);
            self.settle(planes.code.cell_px as f32, &mut out[start..end]);
            start = end;
        }
    }

    /// Where stripes are as fine as the blur, borders of the code come in disorder, and cells are off by one or two. Along a line positions
    /// rise or fall, so that the mean of a pixel's neighbourhood on a surface is its middle, however steep it is.
    fn settle(&mut self, cell_px: f32, out: &mut [(f32, f32)]) {
        self.positions.clear();
        self.positions.extend(out.iter().map(|o| o.0));
        for (i, out) in out.iter_mut().enumerate() {
            let reach = NEIGHBOURS.min(i).min(self.positions.len() - 1 - i);
            let near = &self.positions[i - reach..=i + reach];
            let mean = near.iter().sum::<f32>() / near.len() as f32;
            let is_stray = (out.0 - mean).abs() > MOST_STRAY * cell_px;
            if is_stray || out.1 >= cell_px {
                *out = (mean, DISORDER * cell_px);
            }
        }
    }

    /// The positions of a run of pixels, the first of which is `start`.
    fn run(&self, cell_px: f32, cells: &[u16], start: usize, out: &mut [(f32, f32)]) {
        let borders = &self.borders;
        let mut next = 0;
        for (i, (cell, out)) in cells.iter().zip(out).enumerate() {
            let at = (start + i) as f32;
            while next < borders.len() && borders[next].at <= at {
                next += 1;
            }
            let before = next.checked_sub(1).map(|k| borders[k]);
            let after = borders.get(next).copied();
            let middle = (f32::from(*cell) + 0.5) * cell_px - 0.5;
            let plateau = (middle, UNIFORM * cell_px);
            *out = match (before, after) {
                // The borders on both sides of the cell.
                (Some(a), Some(b)) if (b.on_panel - a.on_panel).abs() >= 0.5 * cell_px => between(a, b, at),
                (Some(a), None) => beyond(a, next.checked_sub(2).map(|k| borders[k]), at).unwrap_or(plateau),
                (None, Some(b)) => beyond(b, borders.get(next + 1).copied(), at).unwrap_or(plateau),
                // The same border on both sides: one of them is not where it seems to be.
                (Some(_), Some(_)) => (middle, cell_px),
                (None, None) => plateau,
            };
            let limit = (0.5 + BEYOND) * cell_px;
            if (out.0 - middle).abs() > limit {
                *out = (middle, cell_px);
            }
        }
    }
}

/// The border between pixels `end` − 1 and `end` of a line, whose cells differ.
fn border(
    planes: &AxisPlanes,
    [a, b]: [u16; 2],
    end: usize,
    index: &impl Fn(usize) -> usize,
    sigma: &impl Fn(usize) -> f32,
) -> Border {
    let cell_px = planes.code.cell_px as f32;
    let middle = 0.5 * (f32::from(a) + f32::from(b) + 1.0);
    let on_panel = middle * cell_px - 0.5;
    let first = end as f32 - 1.0;
    if a.abs_diff(b) > 1 {
        // Several borders between two pixels.
        return Border { at: first + 0.5, sigma: UNIFORM, on_panel };
    }
    let bit = border_bit(a.max(b));
    let contrast = |i: usize| f32::from(planes.contrast(index(i), bit));
    let (one, other) = (contrast(end - 1), contrast(end));
    let sum = one + other;
    if sum <= 0.0 {
        return Border { at: first + 0.5, sigma: UNIFORM, on_panel };
    }
    let share = one / sum;
    // Contrasts are halves of differences of two levels; that of a border moves by (1 − share) of the one and share of the other.
    let noise = 0.5 * std::f32::consts::SQRT_2 * 0.5 * (sigma(end - 1) + sigma(end));
    let moved = noise * ((1.0 - share).powi(2) + share.powi(2)).sqrt() / sum;
    Border { at: first + share, sigma: moved.min(UNIFORM), on_panel }
}

/// On the straight line through two borders.
fn between(a: Border, b: Border, at: f32) -> (f32, f32) {
    let slope = (b.on_panel - a.on_panel) / (b.at - a.at);
    let t = (at - a.at) / (b.at - a.at);
    let sigma = slope.abs() * (((1.0 - t) * a.sigma).powi(2) + (t * b.sigma).powi(2)).sqrt();
    (a.on_panel + slope * (at - a.at), sigma)
}

/// Beyond the last border, with the slope between it and the last but one. It is a prediction: its σ grows with the distance.
fn beyond(last: Border, other: Option<Border>, at: f32) -> Option<(f32, f32)> {
    let other = other?;
    let slope = (last.on_panel - other.on_panel) / (last.at - other.at);
    if !slope.is_finite() {
        return None;
    }
    let predicted = last.on_panel + slope * (at - last.at);
    let sigma = slope.abs() * (last.sigma + 0.25 * (at - last.at).abs());
    Some((predicted, sigma))
}
