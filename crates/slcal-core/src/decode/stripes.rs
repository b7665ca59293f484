//! Stripes on one line: hills whose two edges are measured to sub-pixel.

use super::curves::unit;
use super::hills::{self, Hill};
use super::lines::Line;
use super::noise::Noise;

/// A stripe crossed by a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crossing {
    /// Sub-pixel positions of its two edges along the line, px.
    pub(super) left: f32,
    pub(super) right: f32,
    /// Light of its core above the dark bands beside it.
    pub(super) color: [f32; 3],
    /// Predicted 1σ of an edge, px.
    pub(super) edge_sigma: f32,
    /// 1σ of the core's colour over its strength, rad.
    pub(super) color_sigma: f32,
    /// Whether the core is clipped in some channel.
    pub(super) saturated: bool,
}

impl Crossing {
    /// The middle between the edges, px.
    pub(super) fn middle(&self) -> f32 {
        0.5 * (self.left + self.right)
    }

    /// Distance of the edges, px.
    pub(super) fn width(&self) -> f32 {
        self.right - self.left
    }
}

/// The scalar in which stripes of all hues stand out.
pub(super) fn total(rgb: [f32; 3]) -> f32 {
    rgb[0] + rgb[1] + rgb[2]
}

/// Lengths that depend on the photograph, px.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Scale {
    /// The line is averaged over this many pixels to either side before hills are sought.
    pub(super) smoothing: usize,
    /// An edge is measured over this many pixels to either side.
    pub(super) edge: usize,
}

/// An edge must carry this share of the hill's height.
const MIN_EDGE_SHARE: f32 = 0.4;
/// Height over the noise of a pixel below which a stripe is dropped.
const MIN_CONTRAST: f32 = 3.0;

/// Working memory of [`find`].
#[derive(Debug, Clone, Default)]
pub(super) struct Scratch {
    smooth: Vec<f32>,
    hills: Vec<Hill>,
}

/// The hills of a line, smoothed as asked.
pub(super) fn hills_of<'s>(
    light: &[f32],
    smoothing: usize,
    noise: &Noise,
    scratch: &'s mut Scratch,
) -> &'s [Hill] {
    if smoothing > 0 {
        hills::smooth(light, smoothing, &mut scratch.smooth);
        let share = ((2 * smoothing + 1) as f32).sqrt().recip();
        hills::find(&scratch.smooth, noise, share, &mut scratch.hills);
    } else {
        hills::find(light, noise, 1.0, &mut scratch.hills);
    }
    &scratch.hills
}

/// Appends the stripes of a line to `crossings`, in ascending position, and returns how many hills were none.
pub(super) fn find(
    line: &Line,
    scale: Scale,
    noise: &Noise,
    scratch: &mut Scratch,
    crossings: &mut Vec<Crossing>,
) -> usize {
    let first = crossings.len();
    hills_of(&line.total, scale.smoothing, noise, scratch);
    let mut weak = 0;
    for &hill in &scratch.hills {
        match measure(line, hill, scale, noise) {
            Some(c) if crossings.len() == first || crossings[crossings.len() - 1].right <= c.left => {
                crossings.push(c);
            }
            _ => weak += 1,
        }
    }
    weak
}

fn measure(line: &Line, hill: Hill, scale: Scale, noise: &Noise) -> Option<Crossing> {
    let [before, top, after] = [hill.before, hill.top, hill.after].map(|x| x as usize);
    let left = edge(&line.total, top, before, scale)?;
    let right = edge(&line.total, top, after, scale)?;
    let width = right.at - left.at;
    if width.is_nan() || width <= 0.5 {
        return None;
    }
    let core = mean(&line.rgb, left.at + 0.25 * width, right.at - 0.25 * width);
    let [dark_left, dark_right] = [before, after].map(|x| mean(&line.rgb, x as f32 - 1.0, x as f32 + 1.0));
    // A side that is as bright as the stripe is no dark band (an outline, or a neighbour that is too close).
    let half = 0.5 * total(core);
    let dark: [f32; 3] = match (total(dark_left) < half, total(dark_right) < half) {
        (true, false) => dark_left,
        (false, true) => dark_right,
        _ => std::array::from_fn(|k| 0.5 * (dark_left[k] + dark_right[k])),
    };
    let saturated = line.is_clipped((0.5 * (left.at + right.at) + 0.5).max(0.0) as usize);
    // A clipped core has lost its hue; the edges, where the light comes up from the dark, still have it.
    let above = |light: [f32; 3]| -> [f32; 3] { std::array::from_fn(|k| light[k] - dark[k]) };
    let mut color = above(core);
    if saturated && let Some(hue) = flanks(line, left.at, right.at).and_then(|f| unit(above(f))) {
        let share = total(color) / total(hue);
        color = hue.map(|c| c * share);
    }
    let sigma = noise.sigma(core);
    let height = left.height.min(right.height);
    let strength = total(color);
    let strong = strength.min(height) > MIN_CONTRAST * sigma;
    if !strong {
        return None;
    }
    let pixels = (0.5 * width).max(1.0);
    Some(Crossing {
        left: left.at,
        right: right.at,
        color,
        edge_sigma: sigma / height * left.gain.max(right.gain),
        color_sigma: sigma / strength * (1.0 / pixels + 0.25).sqrt(),
        saturated,
    })
}

/// The mean over the pixels of both edges that are not clipped.
fn flanks(line: &Line, left: f32, right: f32) -> Option<[f32; 3]> {
    let (mut sum, mut n) = ([0.0; 3], 0.0);
    for edge in [left, right] {
        let from = (edge - 0.5).round().max(0.0) as usize;
        for (_, p) in line.rgb.iter().enumerate().skip(from).take(2).filter(|(x, _)| !line.is_clipped(*x)) {
            for (s, c) in sum.iter_mut().zip(p) {
                *s += c;
            }
            n += 1.0;
        }
    }
    (n > 0.0).then(|| sum.map(|s| s / n))
}

struct Edge {
    at: f32,
    height: f32,
    /// σ of the position over σ of a pixel's light as a share of the height.
    gain: f32,
}

/// The edge between a hill's top and a valley. Where the light passes half, the area under the light over a few pixels
/// about it gives the place at which a sharp step would have the same area: exact for any blur within those pixels.
fn edge(light: &[f32], top: usize, valley: usize, scale: Scale) -> Option<Edge> {
    let out = valley > top;
    // Index of the pixel `i` steps from the top towards the valley.
    let at = |i: usize| light[if out { top + i } else { top - i }];
    let length = top.abs_diff(valley);
    let half = 0.5 * (at(0) + at(length));
    let beyond = (1..=length).find(|&i| at(i) < half)?;
    let last = (beyond + scale.edge - 1).min(length);
    let first = beyond.saturating_sub(scale.edge);
    // The plateaus on either side, over two pixels where there are two.
    let high = 0.5 * (at(first) + at(first.saturating_sub(1)));
    let low = 0.5 * (at(last) + at((last + 1).min(length)));
    let height = high - low;
    if height.is_nan() || height <= MIN_EDGE_SHARE * (at(0) - at(length)) {
        return None;
    }
    let mut sum = 0.0;
    for i in first..=last {
        sum += at(i) - low;
    }
    let steps = first as f32 - 0.5 + sum / height;
    let n = (last - first + 1) as f32;
    Some(Edge {
        at: if out { top as f32 + steps } else { top as f32 - steps },
        height,
        // n pixels of the sum, and n/2 times either plateau, which is the mean of two pixels.
        gain: (n + 0.25 * n * n).sqrt(),
    })
}

fn mean(line: &[[f32; 3]], from: f32, to: f32) -> [f32; 3] {
    let last = line.len() - 1;
    // Half a pixel more and truncated: rounded, without a call of the system's library for each.
    let a = ((from + 0.5).max(0.0) as usize).min(last);
    let b = ((to + 0.5).max(0.0) as usize).clamp(a, last);
    let mut sum = [0.0; 3];
    for p in &line[a..=b] {
        for (s, c) in sum.iter_mut().zip(p) {
            *s += c;
        }
    }
    sum.map(|s| s / (b - a + 1) as f32)
}
