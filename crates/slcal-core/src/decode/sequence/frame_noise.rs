//! The noise of the frames, from what they say twice: a bit and its inverse add up to white and black.

use super::frame_plan::FramePlan;
use super::levels::LevelScale;
use super::sample_lines::SampleLines;
use crate::pattern::FrameLight;
use crate::solve::median;

/// Parts of the range of levels, each with a noise of its own: shot noise grows with the light.
const BINS: usize = 32;
/// A part has a noise of its own when so many samples lie in it.
const ENOUGH: usize = 100;
/// Sums of two levels that are told apart, so that their noise lies in the processor's cache.
const MOST_SUMS: u32 = 2048;
/// Deviations beyond are not noise: pixels that a border of a stripe runs through.
const MOST_SIGMAS: f64 = 4.0;
/// Median absolute deviation over σ of a normal distribution.
const MAD: f64 = 0.674_489_75;

/// Of about this many sums the noise is measured, spread evenly.
const SUMS: usize = 1 << 16;

/// 1σ of a level, by level.
#[derive(Debug, Clone)]
pub(super) struct FrameNoise {
    sigma: [f32; BINS],
    per_level: f32,
}

impl FrameNoise {
    /// Of the samples of all frames. What is rounded to whole code values has at least the noise of rounding.
    pub(super) fn of(samples: &SampleLines, plan: &FramePlan, scale: LevelScale) -> Self {
        let per_level = BINS as f32 / (f32::from(scale.full) + 1.0);
        let mut parts: Vec<Vec<f64>> = vec![Vec::new(); BINS];
        let white = plan.position(FrameLight::White).map(|i| samples.levels(i));
        let black = plan.position(FrameLight::Black).map(|i| samples.levels(i));
        let step = (samples.len() * plan.lights.len()).div_ceil(SUMS).max(1);
        for (i, light) in plan.lights.iter().enumerate() {
            let FrameLight::Bit { inverted, .. } = light else { continue };
            let own = samples.levels(i);
            let level = |levels: &[u16], s: usize| f64::from(levels[s]);
            // Other samples of every frame.
            for s in (i % step..samples.len()).step_by(step) {
                let levels = (white.map(|w| level(w, s)), black.map(|b| level(b, s)));
                let (sum, sigmas, middle) = match (levels, plan.partners[i]) {
                    _ if plan.partners[i].is_some() && *inverted => continue,
                    ((Some(w), Some(b)), Some(other)) => {
                        (level(own, s) + level(samples.levels(other), s) - w - b, 2.0, 0.5 * (w + b))
                    }
                    ((Some(w), Some(b)), None) => {
                        let at = level(own, s);
                        let nearest = if at > 0.5 * (w + b) { w } else { b };
                        (at - nearest, std::f64::consts::SQRT_2, nearest)
                    }
                    // Against the first pair.
                    (_, Some(other)) => {
                        let Some(first) = first_pair(plan).filter(|(first, _)| *first != i) else { continue };
                        let pair = level(samples.levels(first.0), s) + level(samples.levels(first.1), s);
                        (level(own, s) + level(samples.levels(other), s) - pair, 2.0, 0.5 * pair)
                    }
                    _ => continue,
                };
                let part = (middle as f32 * per_level) as usize;
                parts[part.min(BINS - 1)].push(sum.abs() / sigmas);
            }
        }
        let least = f64::from(scale.step) / 12.0_f64.sqrt();
        let mut known: Vec<Option<f64>> =
            parts.iter_mut().map(|part| (part.len() >= ENOUGH).then(|| spread(part).max(least))).collect();
        if known.iter().all(Option::is_none) {
            known[0] = Some(least);
        }
        let nearest = |bin: usize| {
            let distance = |other: &usize| other.abs_diff(bin);
            let bins = (0..BINS).filter(|other| known[*other].is_some());
            bins.min_by_key(distance).and_then(|other| known[other]).unwrap_or(least)
        };
        let mut sigma = [0.0; BINS];
        for (bin, sigma) in sigma.iter_mut().enumerate() {
            *sigma = nearest(bin) as f32;
        }
        Self { sigma, per_level }
    }

    /// 1σ at a level.
    #[inline]
    pub(super) fn at(&self, level: f32) -> f32 {
        self.sigma[((level * self.per_level) as usize).min(BINS - 1)]
    }
}

/// 1σ by the sum of two levels, a value for each sum: the noise at their mean.
#[derive(Debug, Clone)]
pub(super) struct NoiseOfSums {
    sigma: Vec<f32>,
    /// Sums are told apart without their last bits.
    shift: u32,
}

impl NoiseOfSums {
    pub(super) fn of(noise: &FrameNoise, scale: LevelScale) -> Self {
        let most = 2 * u32::from(scale.full);
        let shift = (most / MOST_SUMS).checked_ilog2().map_or(0, |bits| bits + 1);
        let middle = |i: u32| ((i << shift) + (1 << shift) / 2) as f32;
        let sigma = (0..=most >> shift).map(|i| noise.at(0.5 * middle(i))).collect();
        Self { sigma, shift }
    }

    /// 1σ of a level at half of a sum.
    #[inline]
    pub(super) fn at(&self, sum: u16) -> f32 {
        self.sigma[usize::from(sum >> self.shift).min(self.sigma.len() - 1)]
    }
}

/// 1σ of most of these deviations. The median alone would be a whole number of code values.
fn spread(deviations: &mut [f64]) -> f64 {
    let mut sigma = median(deviations).unwrap_or(0.0) / MAD;
    for _ in 0..3 {
        let most = MOST_SIGMAS * sigma;
        let inside = deviations.iter().filter(|d| **d <= most);
        let (n, sum) = inside.fold((0_u32, 0.0), |(n, sum), d| (n + 1, sum + d * d));
        if n == 0 {
            break;
        }
        sigma = (sum / f64::from(n)).sqrt();
    }
    sigma
}

fn first_pair(plan: &FramePlan) -> Option<(usize, usize)> {
    plan.partners.iter().enumerate().find_map(|(i, partner)| Some((i, (*partner)?)))
}
