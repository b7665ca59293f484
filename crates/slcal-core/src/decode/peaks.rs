//! Stripes on one line: found by a second-derivative filter of matched width, refined between their edges.

use super::noise::Noise;

/// A stripe crossed by a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Peak {
    /// Sub-pixel position along the line, px.
    pub(super) u: f32,
    /// Distance of its edges, px.
    pub(super) width: f32,
    /// Light of its core above the dark bands beside it.
    pub(super) color: [f32; 3],
    /// Height over the noise of a pixel.
    pub(super) contrast: f32,
    /// Predicted 1σ of `u`, px.
    pub(super) sigma: f32,
    /// Whether the core is clipped in some channel.
    pub(super) saturated: bool,
}

/// What was found on a line and not kept.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Rejects {
    /// Too little contrast over the noise.
    pub(super) weak: usize,
    /// No two edges about the maximum.
    pub(super) shapeless: usize,
}

/// Ratio of neighbouring filter widths: at a width wrong by 2^¼ the response is still 0.9 of its maximum.
const WIDTH_STEP: f64 = std::f64::consts::SQRT_2;
/// Two maxima closer than this share of the sum of their widths are one stripe; neighbours are about 1.0 apart.
const MERGE_SHARE: f32 = 0.55;
/// Response in units of its own noise below which nothing is looked at.
const MIN_RESPONSE_SIGMA: f32 = 5.0;
/// Contrast in units of a pixel's noise below which a stripe is dropped.
const MIN_CONTRAST: f32 = 3.0;
/// An edge must carry this share of the stripe's height.
const MIN_EDGE_SHARE: f32 = 0.35;
/// Code values above this share of full light are clipped.
const SATURATED: f32 = 0.98;

/// Geometric ladder of filter widths that covers a range, px.
pub(super) fn ladder(from: f64, to: f64) -> Vec<f64> {
    let steps = ((to / from).ln() / WIDTH_STEP.ln()).ceil().max(0.0) as usize;
    (0..=steps).map(|k| from * WIDTH_STEP.powf(k as f64)).collect()
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    pub(super) u: usize,
    pub(super) width: f32,
    pub(super) response: f32,
}

/// Finds stripes line by line; keeps its buffers.
pub(super) struct PeakFinder {
    widths: Vec<f64>,
    pad: usize,
    signal: Vec<f32>,
    prefix: Vec<f64>,
    best: Vec<f32>,
    best_width: Vec<f32>,
    candidates: Vec<Candidate>,
    local: Vec<f32>,
    pub(super) rejects: Rejects,
}

/// The scalar in which stripes of all hues stand out.
pub(super) fn total(rgb: [f32; 3]) -> f32 {
    rgb[0] + rgb[1] + rgb[2]
}

impl PeakFinder {
    pub(super) fn new(widths: Vec<f64>) -> Self {
        let widest = widths.iter().copied().fold(1.0, f64::max);
        Self {
            widths,
            pad: (1.5 * widest).ceil() as usize + 2,
            signal: Vec::new(),
            prefix: Vec::new(),
            best: Vec::new(),
            best_width: Vec::new(),
            candidates: Vec::new(),
            local: Vec::new(),
            rejects: Rejects::default(),
        }
    }

    /// Maxima of the filter over position and width, in ascending position. `merge_ratio`: maxima whose widths differ by
    /// more than this factor do not compete.
    pub(super) fn candidates(&mut self, line: &[[f32; 3]], noise: &Noise, merge_ratio: f32) -> &[Candidate] {
        self.filter(line);
        self.candidates.clear();
        for (u, &pixel) in line.iter().enumerate().take(line.len().saturating_sub(1)).skip(1) {
            let r = self.best[u];
            if r > self.best[u - 1] && r >= self.best[u + 1] {
                let width = self.best_width[u];
                let sigma = noise.sigma(pixel) * (1.5 / width.max(1.0)).sqrt();
                if r > MIN_RESPONSE_SIGMA * sigma {
                    self.candidates.push(Candidate { u, width, response: r });
                }
            }
        }
        suppress(&mut self.candidates, merge_ratio);
        &self.candidates
    }

    /// The stripes of a line, in ascending position, appended to `peaks`.
    pub(super) fn find(&mut self, line: &[[f32; 3]], noise: &Noise, peaks: &mut Vec<Peak>) {
        self.candidates(line, noise, f32::INFINITY);
        let first = peaks.len();
        for k in 0..self.candidates.len() {
            let candidate = self.candidates[k];
            match refine(line, candidate, noise, &mut self.local) {
                Some(p) if p.contrast < MIN_CONTRAST => self.rejects.weak += 1,
                Some(p) => {
                    // Two maxima can slide onto the same edges.
                    let merged = peaks.len() > first
                        && peaks.last().is_some_and(|q| p.u - q.u < 0.5 * (p.width + q.width) * 0.5);
                    if !merged {
                        peaks.push(p);
                    }
                }
                None => self.rejects.shapeless += 1,
            }
        }
    }

    /// Centre minus surround, `B(u) − ½(B(u − w) + B(u + w))` with `B` the mean over `w` pixels: the second derivative
    /// matched to a slit between dark bands of its own width, computed from running sums for every width.
    fn filter(&mut self, line: &[[f32; 3]]) {
        let (n, pad) = (line.len(), self.pad);
        self.signal.clear();
        self.signal.extend((0..n + 2 * pad).map(|i| total(line[i.saturating_sub(pad).min(n - 1)])));
        self.prefix.clear();
        self.prefix.push(0.0);
        let mut sum = 0.0;
        for &s in &self.signal {
            sum += f64::from(s);
            self.prefix.push(sum);
        }
        self.best.clear();
        self.best.resize(n, f32::NEG_INFINITY);
        self.best_width.clear();
        self.best_width.resize(n, 1.0);
        for &w in &self.widths {
            // Pixel i covers [i − ½, i + ½]: the integral up to x is the running sum at x + ½, interpolated.
            let offset = |x: f64| {
                let at = x + 0.5 + pad as f64;
                (at.floor() as usize, at.fract())
            };
            let cuts = [-1.5 * w, -0.5 * w, 0.5 * w, 1.5 * w].map(offset);
            let scale = 1.0 / w;
            for u in 0..n {
                let p = cuts.map(|(i, f)| {
                    let a = self.prefix[i + u];
                    a + f * (self.prefix[i + u + 1] - a)
                });
                let centre = p[2] - p[1];
                let r = ((1.5 * centre - 0.5 * (p[3] - p[0])) * scale) as f32;
                if r > self.best[u] {
                    self.best[u] = r;
                    self.best_width[u] = w as f32;
                }
            }
        }
    }
}

/// Keeps the strongest of maxima that are too close to be two stripes.
fn suppress(candidates: &mut Vec<Candidate>, merge_ratio: f32) {
    let mut i = 0;
    // Repeatedly drop what a stronger neighbour covers; lists are short and nearly clean.
    while i < candidates.len() {
        let c = candidates[i];
        let covered = |d: &Candidate| {
            let ratio = (d.width / c.width).max(c.width / d.width);
            let close = (d.u.abs_diff(c.u) as f32) < MERGE_SHARE * (d.width + c.width);
            close && ratio <= merge_ratio && d.response > c.response
        };
        let reach = |d: &Candidate| (d.u.abs_diff(c.u) as f32) < 16.0 * c.width;
        let before = candidates[..i].iter().rev().take_while(|d| reach(d)).any(covered);
        let after = candidates[i + 1..].iter().take_while(|d| reach(d)).any(covered);
        if before || after {
            candidates.remove(i);
            i = i.saturating_sub(1);
        } else {
            i += 1;
        }
    }
}

fn mean(line: &[[f32; 3]], from: f32, to: f32) -> [f32; 3] {
    let last = line.len() - 1;
    let a = (from.round().max(0.0) as usize).min(last);
    let b = (to.round().max(0.0) as usize).clamp(a, last);
    let mut sum = [0.0; 3];
    for p in &line[a..=b] {
        for (s, c) in sum.iter_mut().zip(p) {
            *s += c;
        }
    }
    sum.map(|s| s / (b - a + 1) as f32)
}

/// Core colour above the dark bands, and the light of the core itself.
fn color(line: &[[f32; 3]], u: f32, width: f32) -> ([f32; 3], [f32; 3]) {
    let core = mean(line, u - 0.25 * width, u + 0.25 * width);
    let left = mean(line, u - 1.15 * width, u - 0.9 * width);
    let right = mean(line, u + 0.9 * width, u + 1.15 * width);
    // A side that is as bright as the stripe is no dark band (an outline, or a neighbour that is too close).
    let half = 0.5 * total(core);
    let dark: [f32; 3] = match (total(left) < half, total(right) < half) {
        (true, false) => left,
        (false, true) => right,
        _ => std::array::from_fn(|k| 0.5 * (left[k] + right[k])),
    };
    (std::array::from_fn(|k| core[k] - dark[k]), core)
}

/// Sub-pixel centre between the two edges, each the centroid of the light's derivative close about it: exact for a
/// stripe integrated over pixels, whatever the blur, and indifferent to the surface's shading but for what changes
/// within the edge.
fn refine(line: &[[f32; 3]], candidate: Candidate, noise: &Noise, local: &mut Vec<f32>) -> Option<Peak> {
    let n = line.len();
    let (u0, w0) = (candidate.u as f32, candidate.width);
    let (rgb, _) = color(line, u0, w0);
    let positive = rgb.map(|c| c.max(0.0));
    let norm = positive.iter().map(|c| c * c).sum::<f32>().sqrt();
    if norm.is_nan() || norm <= 0.0 {
        return None;
    }
    let weights = positive.map(|c| c / norm);
    let reach = 1.6 * w0 + 3.0;
    let from = (u0 - reach).floor().max(0.0) as usize;
    let to = ((u0 + reach).ceil() as usize).min(n - 1);
    local.clear();
    local.extend(line[from..=to].iter().map(|p| p[0] * weights[0] + p[1] * weights[1] + p[2] * weights[2]));
    let (mut u, mut width) = (u0, w0);
    let mut height = norm;
    for _ in 0..3 {
        let half_window = 1.0 + 0.2 * width;
        let lag = (width / 8.0).round().max(1.0) as usize;
        let edge = |at: f32, sign: f32| {
            edge(local, at - from as f32, half_window, lag, sign, height).map(|x| x + from as f32)
        };
        let (left, right) = (edge(u - 0.5 * width, 1.0)?, edge(u + 0.5 * width, -1.0)?);
        (u, width) = (0.5 * (left + right), right - left);
        if !(width > 0.35 * w0 && width < 2.2 * w0 && (u - u0).abs() < 0.6 * w0) {
            return None;
        }
        let at = |x: f32| local[((x - from as f32).round().max(0.0) as usize).min(local.len() - 1)];
        height = (at(u) - 0.5 * (at(u - width) + at(u + width))).max(0.25 * norm);
    }
    let (rgb, core) = color(line, u, width);
    let pixel = noise.sigma(core);
    let strength = total(rgb);
    let window = 1.0 + 0.2 * width;
    Some(Peak {
        u,
        width,
        color: rgb,
        contrast: strength / pixel,
        // Centroid of a derivative over ±δ: the noise of 2δ pixels within, and of the two ends at distance δ; two edges.
        sigma: pixel / strength * (window + window * window).sqrt(),
        saturated: core.iter().any(|&c| c > SATURATED),
    })
}

/// Centroid of the rising (sign 1) or falling (−1) derivative within a window that settles about it.
fn edge(local: &[f32], start: f32, half_window: f32, lag: usize, sign: f32, height: f32) -> Option<f32> {
    let mut at = start;
    let centre = 0.5 * lag as f32;
    let scale = sign / lag as f32;
    for _ in 0..4 {
        let low = (at - half_window - 0.5 - centre).ceil().max(0.0) as usize;
        let high = (at + half_window + 0.5 - centre).floor();
        if high < 0.0 {
            return None;
        }
        let (mut sum, mut moment) = (0.0, 0.0);
        for i in low..=high as usize {
            let Some(&next) = local.get(i + lag) else { break };
            let offset = i as f32 + centre - at;
            // The ends of the window are soft, so that the answer moves smoothly with the edge.
            let weight = (half_window + 0.5 - offset.abs()).clamp(0.0, 1.0);
            let d = (next - local[i]) * scale * weight;
            sum += d;
            moment += d * offset;
        }
        if sum.is_nan() || sum < MIN_EDGE_SHARE * height {
            return None;
        }
        let step = (moment / sum).clamp(-half_window, half_window);
        at += step;
        if step.abs() < 1e-3 {
            break;
        }
    }
    Some(at)
}
