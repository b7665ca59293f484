//! Where a side crosses a row or column: the light between the two plateaus, summed over whole pixels, is an integral over
//! their areas, so the position does not depend on where the side falls on the pixel grid, nor on blur that is
//! symmetric, nor on any interpolation.

use std::f64::consts::SQRT_2;

use super::crossing::{Crossing, median};
use super::scan::Scan;
use crate::photo::LinearPhoto;

/// Weakest step, as a part of the side's median step, that is still measured (an unlit part of the sheet).
const MIN_RELATIVE_STEP: f64 = 0.1;

/// The pixels of one line around the side, from dark to bright.
#[derive(Debug, Clone)]
pub(super) struct Profile {
    line: f64,
    /// Position of the boundary between the middle two pixels.
    base: f64,
    /// Light at base + toward·(k + ½ − n/2).
    light: Vec<f64>,
    /// Pixels in each plateau.
    plateau: usize,
}

impl Profile {
    pub(super) fn take(
        photo: &LinearPhoto<'_>,
        scan: Scan,
        line: usize,
        position: f64,
        transition: f64,
        plateau: f64,
    ) -> Option<Self> {
        let half = (transition + plateau).ceil() as isize;
        let base = position.round() - 0.5 * scan.toward;
        let light: Option<Vec<f64>> = (-half..half)
            .map(|k| scan.pixel(photo, line, (base + scan.toward * (k as f64 + 0.5)).round() as isize))
            .collect();
        Some(Self { line: line as f64, base, light: light?, plateau: plateau as usize })
    }

    fn levels(&self) -> (f64, f64) {
        let n = self.light.len();
        let mean = |s: &[f64]| s.iter().sum::<f64>() / s.len() as f64;
        (mean(&self.light[..self.plateau]), mean(&self.light[n - self.plateau..]))
    }
}

/// Slope of a plateau and scatter around it, both relative to the step.
#[derive(Debug, Clone, Copy)]
struct Plateau {
    slope: f64,
    scatter: f64,
}

/// Positions from the integrals of profiles.
pub(super) fn locate(scan: Scan, profiles: &[Profile]) -> Option<Vec<Crossing>> {
    let mut steps: Vec<f64> = profiles.iter().map(Profile::levels).map(|(low, high)| high - low).collect();
    let typical = median(&mut steps)?;
    let usable: Vec<&Profile> = profiles
        .iter()
        .filter(|p| {
            let (low, high) = p.levels();
            high - low > MIN_RELATIVE_STEP * typical && typical > 0.0
        })
        .collect();
    // The plateaus' slopes are those of the illumination, the same along the side: their medians carry little noise.
    let low = common_plateau(&usable, |p| &p.light[..p.plateau])?;
    let high = common_plateau(&usable, |p| &p.light[p.light.len() - p.plateau..])?;
    let scatter = low.scatter.hypot(high.scatter) / SQRT_2;
    let crossings = usable
        .iter()
        .map(|p| {
            let n = p.light.len() as f64;
            let inset = (p.plateau as f64) / 2.0;
            let (dark, bright) = p.levels();
            let step = bright - dark;
            // Levels at k (pixels from the start of the profile) extrapolated from the plateaus' middles.
            let dark_at = |k: f64| dark + low.slope * step * (k - inset);
            let bright_at = |k: f64| bright + high.slope * step * (k - (n - inset));
            let from = p.plateau;
            let to = p.light.len() - p.plateau;
            let excess: f64 = (from..to).map(|i| p.light[i] - dark_at(i as f64 + 0.5)).sum();
            // excess = ∫ from the crossing to `to` of bright − dark, both linear.
            let end = to as f64;
            let (d0, d1) = (bright_at(end) - dark_at(end), (high.slope - low.slope) * step);
            let mut length = excess / d0;
            for _ in 0..3 {
                length = excess / (d0 - 0.5 * d1 * length);
            }
            let transition = (to - from) as f64;
            // Noise of the summed pixels and of the two plateaus' means.
            let sigma = scatter * typical / step
                * (transition + transition * transition / (2.0 * p.plateau as f64)).sqrt();
            Crossing {
                line: p.line,
                position: p.base + scan.toward * (end - length - n / 2.0),
                sigma: sigma.max(1e-4),
            }
        })
        .filter(|c| c.position.is_finite())
        .collect();
    Some(crossings)
}

fn common_plateau<'a>(profiles: &[&'a Profile], part: impl Fn(&'a Profile) -> &'a [f64]) -> Option<Plateau> {
    let relative = |p: &'a Profile| {
        let (low, high) = p.levels();
        let samples = part(p);
        let n = samples.len() as f64;
        let mean = samples.iter().sum::<f64>() / n;
        let (mut sxy, mut sxx) = (0.0, 0.0);
        for (i, v) in samples.iter().enumerate() {
            let x = i as f64 - (n - 1.0) / 2.0;
            sxy += x * (v - mean);
            sxx += x * x;
        }
        let slope = sxy / sxx;
        let rest: f64 = samples
            .iter()
            .enumerate()
            .map(|(i, v)| (v - mean - slope * (i as f64 - (n - 1.0) / 2.0)).powi(2))
            .sum();
        (slope / (high - low), (rest / (n - 2.0).max(1.0)).sqrt() / (high - low))
    };
    let (mut slopes, mut scatters): (Vec<f64>, Vec<f64>) = profiles.iter().map(|p| relative(p)).unzip();
    Some(Plateau { slope: median(&mut slopes)?, scatter: median(&mut scatters)? })
}
