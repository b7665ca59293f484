//! Stripes on one scanline: peaks whose two edges are located to sub-pixel.

use super::noise::Noise;
use super::peaks::{self, Peak};
use super::rgb::{Rgb, mean, minus, plus, positive, scaled, total, unit};
use super::running_mean::smooth;
use super::scanlines::Scanline;

/// A crossing: one stripe on one scanline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StripeEdges {
    /// Sub-pixel positions of its two edges along the scanline, px.
    pub(super) left: f32,
    pub(super) right: f32,
    /// Light above the dark bands beside it, summed over the channels.
    pub(super) height: f32,
    /// Predicted 1σ of an edge, px.
    pub(super) edge_sigma: f32,
    /// Approximate colour, from one pixel of the stripe and one beside it. It is good enough to tell neighbouring
    /// stripes apart.
    pub(super) approximate_color: Rgb,
}

/// The measured colour of a crossing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StripeColor {
    /// Direction of the core's light above the dark bands beside it, in linear RGB; zero where it has none.
    pub(super) unit: Rgb,
    /// Its sum over the channels.
    pub(super) light: f32,
    /// 1σ of the direction from pixel noise, rad.
    pub(super) sigma: f32,
    /// Whether the core is clipped in some channel.
    pub(super) saturated: bool,
}

impl StripeEdges {
    /// The midpoint between the edges, px.
    pub(super) fn middle(&self) -> f32 {
        0.5 * (self.left + self.right)
    }

    /// Distance between the edges, px.
    pub(super) fn width(&self) -> f32 {
        self.right - self.left
    }
}

/// Half-widths of the filters, which depend on the photograph, px.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct FilterRadii {
    /// The scanline is averaged over this many pixels to either side before peaks are detected.
    pub(super) smoothing: usize,
    /// An edge is located over this many pixels to either side.
    pub(super) edge: usize,
}

/// An edge must have this share of the peak's height.
const MIN_EDGE_SHARE: f32 = 0.4;
/// The top of a peak is level where it has this share of the maximum: rounding to 8 bits takes as much.
const LEVEL: f32 = 0.99;
/// The edges of a clipped stripe show its hue where they have this share of its light.
const MIN_FLANK: f32 = 0.15;
/// Edges closer than this are one edge.
const MIN_WIDTH_PX: f32 = 0.5;
/// Ratio of height to pixel noise below which a stripe is rejected.
const MIN_CONTRAST: f32 = 3.0;

/// Working memory of [`find`].
#[derive(Debug, Clone, Default)]
pub(super) struct Scratch {
    smooth: Vec<f32>,
    turns: Vec<u8>,
    peaks: Vec<Peak>,
}

/// The peaks of a scanline, smoothed as requested.
pub(super) fn peaks_of<'s>(
    light: &[f32],
    smoothing: usize,
    noise: &Noise,
    scratch: &'s mut Scratch,
) -> &'s [Peak] {
    if smoothing > 0 {
        smooth(light, smoothing, &mut scratch.smooth);
        let share = ((2 * smoothing + 1) as f32).sqrt().recip();
        peaks::find(&scratch.smooth, noise, share, &mut scratch.turns, &mut scratch.peaks);
    } else {
        peaks::find(light, noise, 1.0, &mut scratch.turns, &mut scratch.peaks);
    }
    &scratch.peaks
}

/// Appends the stripes of a scanline to `crossings`, in ascending position, and their colours to `colors` if given.
/// Returns the number of peaks that were rejected.
pub(super) fn find(
    line: &Scanline,
    radii: FilterRadii,
    noise: &Noise,
    scratch: &mut Scratch,
    light_at: impl Fn(usize) -> Rgb,
    crossings: &mut Vec<StripeEdges>,
    mut colors: Option<&mut Vec<StripeColor>>,
) -> usize {
    let first = crossings.len();
    peaks_of(&line.total, radii.smoothing, noise, scratch);
    let mut rejected = 0;
    for &peak in &scratch.peaks {
        let refined = peak.refined(&line.total, radii.smoothing);
        match measure(&line.total, refined, radii, noise, &light_at) {
            Some(c) if crossings.len() == first || crossings[crossings.len() - 1].right <= c.left => {
                crossings.push(c);
                if let Some(colors) = &mut colors {
                    colors.push(color_of(line, peak, &c, noise));
                }
            }
            _ => rejected += 1,
        }
    }
    rejected
}

fn measure(
    light: &[f32],
    peak: Peak,
    radii: FilterRadii,
    noise: &Noise,
    light_at: impl Fn(usize) -> Rgb,
) -> Option<StripeEdges> {
    let (before, top, after) = (peak.before as usize, peak.top as usize, peak.after as usize);
    let (towards, away) =
        (|i: isize| light[top.wrapping_add_signed(-i)], |i: isize| light[top.wrapping_add_signed(i)]);
    let below = [below_half(top - before, towards)?, below_half(after - top, away)?];
    // Either edge has half the pixels that lie between them.
    let inner = usize::midpoint(below[0], below[1]);
    let rising = edge(below[0], top - before, inner, radii.edge, towards)?;
    let falling = edge(below[1], after - top, inner, radii.edge, away)?;
    let (left, right) = (top as f32 - rising.from_top, top as f32 + falling.from_top);
    let height = rising.height.min(falling.height);
    let sigma = noise.sigma_of_total(light[top]);
    if right - left <= MIN_WIDTH_PX || height <= MIN_CONTRAST * sigma {
        return None;
    }
    // The darker side is more likely to be the dark band.
    let dark = if light[before] < light[after] { before } else { after };
    let lit = ((left + right) * 0.5 + 0.5) as usize;
    Some(StripeEdges {
        approximate_color: positive(minus(light_at(lit), light_at(dark))),
        left,
        right,
        height,
        edge_sigma: sigma / height * rising.variance.max(falling.variance).sqrt(),
    })
}

fn color_of(line: &Scanline, peak: Peak, c: &StripeEdges, noise: &Noise) -> StripeColor {
    let width = c.width();
    let core = mean_between(&line.rgb, c.left + 0.25 * width, c.right - 0.25 * width);
    // The gap is about as wide as the stripe: a narrow gap has a single dark pixel.
    let reach = (0.2 * width).min(1.0);
    let beside = |x: u32| mean_between(&line.rgb, x as f32 - reach, x as f32 + reach);
    let (left, right) = (beside(peak.before), beside(peak.after));
    // A side as bright as the stripe is no dark band (an outline, or a neighbour that is too close).
    let half = 0.5 * total(core);
    let dark = match (total(left) < half, total(right) < half) {
        (true, false) => left,
        (false, true) => right,
        _ => scaled(plus(left, right), 0.5),
    };
    let above = |light: Rgb| minus(light, dark);
    let color = above(core);
    let light = total(color).max(f32::MIN_POSITIVE);
    let saturated = line.is_clipped((c.middle() + 0.5).max(0.0) as usize);
    // A clipped core has lost its hue; the edges, where the light rises from the dark, still have it.
    let lit = |c: &Rgb| total(*c) > MIN_FLANK * light;
    let hue = if saturated { flanks(line, c.left, c.right).map(above).filter(lit) } else { None };
    let pixels = (0.5 * width).max(1.0);
    StripeColor {
        unit: unit(hue.unwrap_or(color)).unwrap_or([0.0; 3]),
        light,
        sigma: noise.sigma(core) / light * (1.0 / pixels + 0.25).sqrt(),
        saturated,
    }
}

/// The mean over the pixels of both edges that are not clipped.
fn flanks(line: &Scanline, left: f32, right: f32) -> Option<Rgb> {
    let (mut sum, mut n) = ([0.0; 3], 0.0);
    for edge in [left, right] {
        let from = (edge - 0.5).round().max(0.0) as usize;
        for (_, p) in line.rgb.iter().enumerate().skip(from).take(2).filter(|(x, _)| !line.is_clipped(*x)) {
            sum = plus(sum, *p);
            n += 1.0;
        }
    }
    (n > 0.0).then(|| scaled(sum, 1.0 / n))
}

struct Edge {
    /// Distance from the top, px.
    from_top: f32,
    height: f32,
    /// (σ of the position over the relative σ of a pixel's light, as a share of the height)².
    variance: f32,
}

/// The first pixel, counted from the top of a peak, at which the light falls below half of its drop to the valley
/// `length` pixels away. `at` returns the light of a pixel.
#[inline]
fn below_half(length: usize, at: impl Fn(isize) -> f32) -> Option<usize> {
    let half = 0.5 * (at(0) + at(length as isize));
    (1..=length).find(|&i| at(i as isize) < half)
}

/// The edge of a peak whose light falls below half its height `below` pixels from the top, on the way to the valley
/// `length` pixels from it. The area under the light over `reach` pixels to either side gives the position of a sharp
/// step with the same area. This is exact for any blur within those pixels. On the side of the peak the pixels end at
/// its top or, where that is level, at most `inner` pixels from the edge.
#[inline]
fn edge(below: usize, length: usize, inner: usize, reach: usize, at: impl Fn(isize) -> f32) -> Option<Edge> {
    let (below, length) = (below as isize, length as isize);
    let last = (below + reach as isize - 1).min(length);
    // The window may extend beyond the top where it is level, since the top may then be anywhere.
    let (wanted, middle) = (below - reach as isize - 1, below - inner as isize);
    let mut innermost = 0;
    while innermost > wanted.max(middle) && at(innermost - 1) >= LEVEL * at(0) {
        innermost -= 1;
    }
    let first = (below - reach as isize).max(innermost);
    // The plateaus on either side, over two pixels where there are two.
    let high = 0.5 * (at(first) + at((first - 1).max(innermost)));
    let low = 0.5 * (at(last) + at((last + 1).min(length)));
    let height = high - low;
    if height.is_nan() || height <= MIN_EDGE_SHARE * (at(0) - at(length)) {
        return None;
    }
    let mut sum = 0.0;
    for i in first..=last {
        sum += at(i) - low;
    }
    let n = (last - first + 1) as f32;
    Some(Edge {
        from_top: first as f32 - 0.5 + sum / height,
        height,
        // n pixels of the sum, and n/2 times either plateau, which is the mean of two pixels.
        variance: n + 0.25 * n * n,
    })
}

fn mean_between(line: &[Rgb], from: f32, to: f32) -> Rgb {
    let last = line.len() - 1;
    // Adding half a pixel and truncating rounds without a library call.
    let a = ((from + 0.5).max(0.0) as usize).min(last);
    let b = ((to + 0.5).max(0.0) as usize).clamp(a, last);
    mean(&line[a..=b])
}
