//! The noise of a pixel's light.

use super::rgb::{minus, plus, scaled};
use super::scanlines::ScanlineReader;
use super::unlit_noise::UnlitNoise;
use crate::photo::Encoding;

/// Scanlines and samples in all; enough for a quartile.
const LINES: usize = 32;
const SAMPLES: usize = 6_000;
/// The lower quartile of |x|, x ~ N(0, 1). The quartile, since many pixels lie on a stripe's edge.
const QUARTILE_OF_NORMAL: f32 = 0.318_6;
/// Variance of a second difference x₀ − (x₋ + x₊)/2 over that of x.
const SECOND_DIFFERENCE_GAIN: f32 = 1.5;
/// Rounding to 8 bits, 1/255/√12, in code values: the lower limit of the noise.
const FLOOR: f32 = 1.1e-3;
/// Entries of the tables of σ, per unit of light.
const TABLE: usize = 1024;
/// For the sum over the channels, 0–3.
const TOTAL_TABLE: usize = 3 * TABLE;

/// 1σ of a pixel's light. It is measured in code values, where it depends little on the light, and converted to linear
/// light.
#[derive(Debug, Clone)]
pub(super) struct Noise {
    encoding: Encoding,
    samples: Vec<f32>,
    /// 1σ in code values, 0–1.
    pub(super) sigma_code: f32,
    variance_by_light: Vec<f32>,
    sigma_by_total: Vec<f32>,
    /// What is seen beside the stripes.
    pub(super) unlit: UnlitNoise,
}

impl Noise {
    pub(super) fn new(encoding: Encoding) -> Self {
        Self {
            encoding,
            samples: Vec::new(),
            sigma_code: -1.0,
            variance_by_light: Vec::new(),
            sigma_by_total: Vec::new(),
            unlit: UnlitNoise::default(),
        }
    }

    /// Measures the noise of a photograph.
    pub(super) fn measure(&mut self, reader: &ScanlineReader<'_>) {
        self.unlit.clear();
        self.samples.clear();
        let lines = LINES.min(reader.count());
        let stride = (3 * lines * reader.length() / SAMPLES).max(1);
        for k in 0..lines {
            let y = reader.spread(k, lines);
            for x in (1..reader.length().saturating_sub(1)).step_by(stride) {
                let beside = plus(reader.code(y, x - 1), reader.code(y, x + 1));
                let miss = minus(reader.code(y, x), scaled(beside, 0.5));
                self.samples.extend_from_slice(&[miss[0].abs(), miss[1].abs(), miss[2].abs()]);
            }
        }
        let mut sigma = FLOOR;
        if !self.samples.is_empty() {
            let quarter = self.samples.len() / 4;
            let (_, q, _) = self.samples.select_nth_unstable_by(quarter, f32::total_cmp);
            sigma = (*q / QUARTILE_OF_NORMAL / SECOND_DIFFERENCE_GAIN.sqrt()).max(FLOOR);
        }
        if reader.has_companion() {
            sigma *= std::f32::consts::SQRT_2;
        }
        if sigma.total_cmp(&self.sigma_code).is_ne() {
            self.sigma_code = sigma;
            self.tabulate();
        }
    }

    /// Sets σ in code values.
    #[cfg(test)]
    pub(super) fn set(&mut self, sigma_code: f32) {
        self.sigma_code = sigma_code;
        self.tabulate();
    }

    fn tabulate(&mut self) {
        self.variance_by_light.clear();
        let step = f64::from(self.sigma_code).min(0.1);
        self.variance_by_light.extend((0..TABLE).map(|i| {
            let code = self.encoding.from_linear((i as f64 + 0.5) / TABLE as f64);
            let (low, high) = ((code - 0.5 * step).max(0.0), code + 0.5 * step);
            (self.encoding.to_linear(high) - self.encoding.to_linear(low)).powi(2) as f32
        }));
        self.sigma_by_total.clear();
        let variance = |light: f32| self.variance_by_light[((light * TABLE as f32) as usize).min(TABLE - 1)];
        // Light concentrated in as few channels as possible, where noise is largest.
        self.sigma_by_total.extend((0..TOTAL_TABLE).map(|i| {
            let total = (i as f32 + 0.5) / TABLE as f32;
            (variance(total) * total.max(1.0) + 2.0 * variance(0.0)).sqrt()
        }));
    }

    fn variance(&self, light: f32) -> f32 {
        let at = ((light * TABLE as f32) as usize).min(TABLE - 1);
        self.variance_by_light.get(at).copied().unwrap_or(0.0)
    }

    /// 1σ of the sum of the channels of a pixel with this light.
    pub(super) fn sigma(&self, rgb: [f32; 3]) -> f32 {
        (self.variance(rgb[0]) + self.variance(rgb[1]) + self.variance(rgb[2])).sqrt()
    }

    /// An approximation when only the sum is known.
    #[inline]
    pub(super) fn sigma_of_total(&self, total: f32) -> f32 {
        // Casts to integers saturate: negative light has the σ of darkness.
        let at = ((total * TABLE as f32) as usize).min(TOTAL_TABLE - 1);
        self.sigma_by_total.get(at).copied().unwrap_or(0.0)
    }
}
