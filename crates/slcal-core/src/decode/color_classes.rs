//! Classification of stripe colours into the hues of the palette; the classes are learned from the photograph.

use super::rgb::{Rgb, dot, minus, over, plus, times, total, unit};
use crate::solve::median_f32;

/// Smallest spread of a class, rad: what shading, interreflections and surfaces leave when noise is small.
const MIN_SPREAD_RAD: f32 = 0.08;
/// Beyond this spread the classes overlap so much that they carry no information.
const MAX_SPREAD_RAD: f32 = 0.35;
/// Share of crossings whose colour is an outlier (reflections, two stripes in one, coloured surfaces).
const OUTLIERS: f32 = 0.03;
/// Odds below this are negligible beside [`OUTLIERS`].
const NEGLIGIBLE: f32 = 1e-9;
/// Rounds of expectation and maximisation; the means converge in three or four.
const ROUNDS: usize = 5;
/// A class is learned from at least this many crossings.
const MIN_MEMBERS: f32 = 20.0;
/// Rounds of the estimate of the colour balance, and its largest gain. A larger gain is no balance, but a pattern of
/// which only some hues are visible.
const BALANCE_ROUNDS: usize = 5;
const MAX_BALANCE: f32 = 3.0;
/// Rounds in which the brightness of hues is compared between neighbours. Neighbours lie on different surfaces when
/// their light, corrected by what is known, differs by more than a factor of 2.5 (in logarithms).
const BRIGHTNESS_ROUNDS: usize = 6;
const SAME_SURFACE_LN: f32 = 0.92;

/// No class.
pub(super) const NO_CLASS: u8 = u8::MAX;

/// The colour of a crossing, for classification.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ColorSample {
    /// Direction in linear RGB; zero where there is none.
    pub(super) unit: Rgb,
    /// 1σ of the direction from noise, rad.
    pub(super) sigma: f32,
    /// Light, and its logarithm.
    pub(super) light: f32,
    pub(super) log_light: f32,
}

/// Directions of the hues in the camera's linear RGB: the primaries of projector and camera, crosstalk and white
/// balance in one.
#[derive(Debug, Clone, Default)]
pub(super) struct ColorClasses {
    pub(super) directions: Vec<Rgb>,
    pub(super) spread_rad: f32,
    /// Light of each hue on the same surface, relative to the mean.
    pub(super) brightness: Vec<f32>,
    sums: Vec<Sums>,
    deviations: Vec<f32>,
    assigned: Vec<u8>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    direction: Rgb,
    weight: f32,
}

/// Squared chord between two directions: (2 sin(angle/2))², without the loss of digits of an arc cosine.
fn squared_angle(a: Rgb, b: Rgb) -> f32 {
    let d = minus(a, b);
    dot(d, d)
}

impl ColorClasses {
    /// Initialises the classes with the palette's directions. When `balanced`, the camera's colour balance is matched
    /// to the samples: over all of them, the channels must have the shares that they have over the pattern. This fails
    /// where only a part of the pattern is visible in which one hue prevails.
    pub(super) fn seed(&mut self, palette: &[Rgb], sequence: &[u8], samples: &[ColorSample], balanced: bool) {
        let grey = [1.0 / 3.0_f32.sqrt(); 3];
        self.directions.clear();
        self.directions.extend(palette.iter().map(|&c| unit(c).unwrap_or(grey)));
        self.brightness.clear();
        self.brightness.extend(palette.iter().map(|&c| total(c).max(1e-3)));
        self.spread_rad = MAX_SPREAD_RAD;
        let mut sum = [1e-6_f32; 3];
        for &s in sequence {
            sum = plus(sum, self.directions.get(usize::from(s)).copied().unwrap_or(grey));
        }
        let expected = unit(sum).unwrap_or(grey);
        let mut gain = [1.0_f32; 3];
        for _ in 0..if balanced { BALANCE_ROUNDS } else { 0 } {
            let mut sum = [1e-6_f32; 3];
            for s in samples {
                sum = plus(sum, unit(times(s.unit, gain)).unwrap_or([0.0; 3]));
            }
            let seen = unit(sum).unwrap_or(grey);
            gain = std::array::from_fn(|k| {
                (gain[k] * expected[k] / seen[k].max(1e-3)).clamp(1.0 / MAX_BALANCE, MAX_BALANCE)
            });
        }
        for d in &mut self.directions {
            *d = unit(over(*d, gain)).unwrap_or(grey);
        }
    }

    /// Moves the directions to the means of the samples nearest to them, or of those that `labels` assigns to them (one
    /// per sample, [`NO_CLASS`] for none).
    pub(super) fn learn(&mut self, samples: &[ColorSample], labels: Option<&[u8]>) {
        for _ in 0..if labels.is_some() { 2 } else { ROUNDS } {
            self.sums.clear();
            self.sums.resize(self.directions.len(), Sums::default());
            self.deviations.clear();
            self.assigned.clear();
            for (i, s) in samples.iter().enumerate() {
                let hue = labels.map_or_else(|| self.nearest(s.unit), |l| l[i]);
                let mean = self.directions.get(usize::from(hue));
                let distance = mean.map_or(f32::INFINITY, |&mean| squared_angle(s.unit, mean));
                if distance.is_finite() {
                    self.deviations.push(distance);
                }
                // Redescending: samples beyond three spreads do not move the mean.
                let near = distance < 9.0 * (self.spread_rad * self.spread_rad + s.sigma * s.sigma);
                self.assigned.push(if near { hue } else { NO_CLASS });
                if near {
                    let sums = &mut self.sums[usize::from(hue)];
                    sums.weight += 1.0;
                    sums.direction = plus(sums.direction, s.unit);
                }
            }
            self.take_means();
        }
        self.learn_brightness(samples);
    }

    /// Compares neighbours: hues are distributed unevenly over near and far surfaces, so that an average over the
    /// photograph would be biased.
    fn learn_brightness(&mut self, samples: &[ColorSample]) {
        for b in &mut self.brightness {
            *b = b.ln();
        }
        for _ in 0..BRIGHTNESS_ROUNDS {
            // The weight counts pairs; the first entry sums their differences beyond the current estimate.
            self.sums.clear();
            self.sums.resize(self.directions.len(), Sums::default());
            for (w, hue) in samples.windows(2).zip(self.assigned.windows(2)) {
                let [a, b] = [usize::from(hue[0]), usize::from(hue[1])];
                let (Some(&x), Some(&y)) = (self.brightness.get(a), self.brightness.get(b)) else { continue };
                let e = w[0].log_light - x - (w[1].log_light - y);
                if a != b && e.abs() < SAME_SURFACE_LN {
                    for (h, e) in [(a, e), (b, -e)] {
                        self.sums[h].weight += 1.0;
                        self.sums[h].direction[0] += e;
                    }
                }
            }
            for (b, s) in self.brightness.iter_mut().zip(&self.sums) {
                // Half of it, since the other hue moves as well.
                *b += 0.5 * s.direction[0] / s.weight.max(1.0);
            }
        }
        for b in &mut self.brightness {
            *b = b.exp();
        }
        let mean = self.brightness.iter().sum::<f32>() / self.brightness.len().max(1) as f32;
        for b in &mut self.brightness {
            *b /= mean;
        }
    }

    fn take_means(&mut self) {
        for (h, s) in self.sums.iter().enumerate() {
            if s.weight >= MIN_MEMBERS
                && let Some(mean) = unit(s.direction)
            {
                self.directions[h] = mean;
            }
        }
        if let Some(m) = median_f32(&mut self.deviations) {
            // The median of a squared deviation with two degrees of freedom is 1.39 σ².
            self.spread_rad = (m / 1.386).sqrt().clamp(MIN_SPREAD_RAD, MAX_SPREAD_RAD);
        }
    }

    /// The class nearest to a colour.
    pub(super) fn nearest(&self, unit: Rgb) -> u8 {
        let mut best = (f32::INFINITY, NO_CLASS);
        for (h, d) in self.directions.iter().enumerate() {
            let distance = squared_angle(unit, *d);
            if distance < best.0 {
                best = (distance, h as u8);
            }
        }
        best.1
    }

    /// Writes the log-odds of each class against chance into `out` (one entry per class): at most ln(hues), at least ln
    /// 0.03. Returns the nearest class.
    pub(super) fn log_odds(&self, s: &ColorSample, out: &mut [f32]) -> u8 {
        let n = self.directions.len() as f32;
        let scale = -0.5 / (self.spread_rad * self.spread_rad + s.sigma * s.sigma);
        let (mut sum, mut nearest) = (1e-9, (f32::INFINITY, NO_CLASS));
        for (h, (o, d)) in out.iter_mut().zip(&self.directions).enumerate() {
            let distance = squared_angle(s.unit, *d);
            if distance < nearest.0 {
                nearest = (distance, h as u8);
            }
            *o = (distance * scale).exp();
            sum += *o;
        }
        for o in out {
            let odds = (1.0 - OUTLIERS) * *o / sum * n;
            // Most classes are far away.
            *o = if odds > NEGLIGIBLE { (odds + OUTLIERS).ln() } else { OUTLIERS.ln() };
        }
        nearest.1
    }
}
