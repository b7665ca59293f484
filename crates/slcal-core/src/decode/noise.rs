//! How much a pixel's light differs from its neighbours' by chance.

use crate::photo::Encoding;

/// Samples kept; plenty for a quartile.
const MAX_SAMPLES: usize = 1 << 18;
/// The lower quartile of |x|, x ~ N(0, 1): the quartile, since many pixels lie on a stripe's edge.
const QUARTILE_OF_NORMAL: f32 = 0.318_6;
/// Variance of a second difference x₀ − (x₋ + x₊)/2 over that of x.
const SECOND_DIFFERENCE_GAIN: f32 = 1.5;
/// Rounding to 8 bits, 1/255/√12, in code values: noise is taken to be no less.
const FLOOR: f32 = 1.1e-3;
/// Entries of the table of slopes over the light's logarithm: quarter octaves from 2⁻¹⁶ to 1.
const TABLE: usize = 64;

/// 1σ of a pixel's light. Measured in code values, where it depends little on the light, and carried to linear light.
#[derive(Debug, Clone)]
pub(super) struct Noise {
    encoding: Encoding,
    samples: Vec<f32>,
    sigma_code: f32,
    sigma_by_light: [f32; TABLE],
}

impl Noise {
    pub(super) fn new(encoding: Encoding) -> Self {
        Self { encoding, samples: Vec::new(), sigma_code: FLOOR, sigma_by_light: [FLOOR; TABLE] }
    }

    /// Takes the second differences of a line into account.
    pub(super) fn add(&mut self, line: &[[f32; 3]]) {
        for k in 0..3 {
            let code = |x: usize| self.encoding.from_linear(f64::from(line[x][k])) as f32;
            for x in (1..line.len().saturating_sub(1)).step_by(3) {
                if self.samples.len() < MAX_SAMPLES {
                    let d = code(x) - 0.5 * (code(x - 1) + code(x + 1));
                    self.samples.push(d.abs());
                }
            }
        }
    }

    /// Turns what was added into σ.
    pub(super) fn finish(&mut self) {
        if !self.samples.is_empty() {
            let quarter = self.samples.len() / 4;
            let (_, q, _) = self.samples.select_nth_unstable_by(quarter, f32::total_cmp);
            self.sigma_code = (*q / QUARTILE_OF_NORMAL / SECOND_DIFFERENCE_GAIN.sqrt()).max(FLOOR);
        }
        self.samples = Vec::new();
        for (i, sigma) in self.sigma_by_light.iter_mut().enumerate() {
            let light = (0.25 * (i as f64 - (TABLE as f64 - 1.0))).exp2();
            let code = self.encoding.from_linear(light);
            let step = f64::from(self.sigma_code).min(0.1);
            let (low, high) = ((code - 0.5 * step).max(0.0), code + 0.5 * step);
            *sigma = (self.encoding.to_linear(high) - self.encoding.to_linear(low)) as f32;
        }
    }

    /// 1σ of the sum of the channels of a pixel with this light.
    pub(super) fn sigma(&self, rgb: [f32; 3]) -> f32 {
        let top = TABLE as f32 - 1.0;
        let one = |light: f32| {
            let at = (top + 4.0 * light.max(1e-9).log2()).clamp(0.0, top);
            self.sigma_by_light[at as usize]
        };
        rgb.iter().map(|&c| one(c).powi(2)).sum::<f32>().sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};

    #[test]
    fn finds_the_noise_of_two_levels_between_edges() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let mut noise = Noise::new(Encoding::Srgb);
        let sigma = 3.0 / 255.0;
        for _ in 0..40 {
            let line: Vec<[f32; 3]> = (0..400)
                .map(|x| {
                    let level = if x / 10 % 2 == 0 { 0.7 } else { 0.2 };
                    [(); 3].map(|()| {
                        let code = level + Normal::new(0.0, sigma).unwrap().sample(&mut rng);
                        Encoding::Srgb.to_linear(code) as f32
                    })
                })
                .collect();
            noise.add(&line);
        }
        noise.finish();
        for level in [0.7, 0.2_f64] {
            let light = Encoding::Srgb.to_linear(level);
            let slope = (Encoding::Srgb.to_linear(level + 1e-4) - light) / 1e-4;
            let truth = (slope * sigma * 3.0_f64.sqrt()) as f32;
            let found = noise.sigma([light as f32; 3]);
            assert!((found / truth - 1.0).abs() < 0.35, "{found} for {truth}");
        }
    }
}
