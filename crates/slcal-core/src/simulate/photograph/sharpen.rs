//! Sharpening as cameras do it: an unsharp mask on luma.

use serde::{Deserialize, Serialize};

use super::blur::{Border, blur};
use crate::error::{Result, within};

/// Largest amount: beyond it every edge is clipped.
const MOST_AMOUNT: f64 = 10.0;
/// Radii, px: a smaller Gaussian changes no pixel, a larger one is contrast, not sharpness.
const RADII_PX: [f64; 2] = [0.1, 50.0];
/// Share of red, green and blue in luma (ITU-R BT.601, as in JPEG).
const LUMA: [f64; 3] = [0.299, 0.587, 0.114];

/// Adds amount · (Y − Gaussian of Y) to all channels of the encoded picture, Y being its luma, and clips. Colour differences
/// stay as they are, as in cameras, which sharpen luma so that the noise of colour does not grow.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sharpen {
    /// Factor of what the Gaussian takes away.
    pub amount: f64,
    /// σ of the Gaussian, px.
    pub radius_px: f64,
}

impl Sharpen {
    /// Checks the values.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for an amount that is not from 0 to 10, and a radius that is not from 0.1 to
    /// 50 px.
    pub fn validate(&self) -> Result<()> {
        within("amount of sharpening", self.amount, [0.0, MOST_AMOUNT], "")?;
        within("radius of sharpening", self.radius_px, RADII_PX, " px")
    }

    /// Sharpens encoded values (0–1) of a picture that is `width` wide.
    pub(super) fn apply(&self, values: &mut [[f64; 3]], width: usize) {
        let luma = |v: &[f64; 3]| LUMA[0] * v[0] + LUMA[1] * v[1] + LUMA[2] * v[2];
        let mut soft: Vec<[f64; 1]> = values.iter().map(|v| [luma(v)]).collect();
        blur(&mut soft, width, self.radius_px, Border::Repeat);
        for (value, [soft]) in values.iter_mut().zip(soft) {
            let detail = self.amount * (luma(value) - soft);
            *value = value.map(|v| (v + detail).clamp(0.0, 1.0));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_overshoots_by_the_gaussian_and_colour_differences_stay() {
        let (width, mask) = (64, Sharpen { amount: 0.6, radius_px: 1.5 });
        let edge = |x: usize| if x < 32 { [0.2, 0.3, 0.4] } else { [0.6, 0.7, 0.8] };
        let mut values: Vec<[f64; 3]> = (0..width * 16).map(|i| edge(i % width)).collect();
        mask.apply(&mut values, width);
        // A step of 0.4 in luma under a sampled Gaussian: what lies beyond the edge is mixed in.
        let weight = |i: i32| libm::exp(-0.5 * (f64::from(i) / mask.radius_px).powi(2));
        let total: f64 = (-12..=12).map(weight).sum();
        let row = &values[8 * width..9 * width];
        for (x, value) in row.iter().enumerate() {
            let first = x as i32 - 31;
            let beyond = if x < 32 {
                (1 - first..=12).map(weight).sum::<f64>() / total
            } else {
                -(first..=12).map(weight).sum::<f64>() / total
            };
            let expected = edge(x).map(|v| v - 0.6 * 0.4 * beyond);
            assert!((0..3).all(|c| (value[c] - expected[c]).abs() < 1e-4), "{x}: {value:?} {expected:?}");
            assert!((value[1] - value[0] - 0.1).abs() < 1e-12 && (value[2] - value[1] - 0.1).abs() < 1e-12);
        }
        assert!(row[31][0] < 0.13 && row[32][2] > 0.87);
        Sharpen { amount: 10.0, ..mask }.apply(&mut values, width);
        assert!(values.as_flattened().iter().all(|v| (0.0..=1.0).contains(v)));
    }
}
