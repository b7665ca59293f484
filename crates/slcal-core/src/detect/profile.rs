//! Where a side crosses rows or columns: a blurred step, integrated over the pixels, fitted to the light across the side.
//!
//! At distance d from the side towards the sheet the light is D + S·(B + a·d·(1 − B) + b·d·B): D and S, the dark level and
//! the step, belong to each crossing; the blur s of B = Φ(d/s) averaged over the pixel and the relative slopes a and b of
//! the light on either side belong to the whole side. A symmetric blur of another shape does not move the crossing.

use nalgebra::{Matrix3, RowVector3, Vector3};

use super::crossing::Crossing;
use super::erf::ErfTable;
use super::scan::Scan;
use crate::photo::LinearPhoto;
use crate::solve::{Polynomial, median};

/// Weakest step, as a part of the side's median step, that is still measured (an unlit part of the sheet).
const MIN_RELATIVE_STEP: f64 = 0.1;
/// Sharper sides than this cannot be told from perfect ones, px.
const MIN_BLUR_PX: f64 = 0.12;
/// Lines are taken together until a crossing is known to this part of the blur: beyond it the fit is not linear in the
/// noise, and noise that differs between dark and bright would pull it.
const LINEAR_PART: f64 = 0.25;
/// Fewest crossings that bundling leaves of a side.
const MIN_BUNDLES: usize = 48;
/// Crossings whose residuals exceed this many times the median have no say in what the side has in common.
const MAX_CHI: f64 = 2.0;
/// Noise is never taken for less than this, linear light: a thousandth of the range of a dark photograph.
const MIN_NOISE: f64 = 1e-5;

/// The light across a side, along lines of pixels from dark to bright.
#[derive(Debug)]
pub(super) struct Profiles {
    scan: Scan,
    /// Pixels before and behind the side.
    half: usize,
    /// Pixels at each end that are beyond the transition.
    plateau: usize,
    /// Row or column, position of the boundary between the middle two pixels, position expected of the side.
    lines: Vec<[f64; 3]>,
    /// 2·half values per line.
    light: Vec<f64>,
}

/// What a side's crossings have in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct Common {
    blur: f64,
    slopes: [f64; 2],
}

/// A crossing: its offset from where it is expected, towards the sheet; dark level; step.
#[derive(Debug, Clone, Copy)]
struct State {
    offset: f64,
    dark: f64,
    step: f64,
}

/// Variance of a pixel in the dark and beside the typical step.
#[derive(Debug, Clone, Copy)]
struct Noise {
    dark: f64,
    bright: f64,
    typical_step: f64,
}

/// Crossings of a side.
pub(super) struct Located {
    pub(super) crossings: Vec<Crossing>,
    /// Number of crossings tried.
    pub(super) tried: usize,
    /// What the crossings have in common.
    pub(super) common: Common,
    /// 1σ that all crossings have in common, px: what blur and slopes leave open.
    pub(super) common_sigma: f64,
}

impl Common {
    /// A guess from half the width of the transition, px.
    pub(super) fn start(half_transition_px: f64) -> Self {
        Self { blur: (half_transition_px / 4.0).max(MIN_BLUR_PX), slopes: [0.0; 2] }
    }
}

impl Profiles {
    /// Reads the lines whose numbers and expected positions are given, as far as they lie in the photograph.
    pub(super) fn take(
        photo: &LinearPhoto<'_>,
        scan: Scan,
        lines: impl Iterator<Item = (usize, f64)>,
        transition: f64,
        plateau: f64,
    ) -> Self {
        let half = (transition + plateau).ceil() as usize;
        let reach = half as isize;
        let mut all = Self { scan, half, plateau: plateau as usize, lines: Vec::new(), light: Vec::new() };
        for (line, position) in lines {
            let base = position.round() - 0.5 * scan.toward;
            let start = all.light.len();
            let at = |k: isize| (base + scan.toward * (k as f64 + 0.5)).round() as isize;
            all.light.extend((-reach..reach).map_while(|k| scan.pixel(photo, line, at(k))));
            if all.light.len() == start + 2 * half {
                all.lines.push([line as f64, base, position]);
            } else {
                all.light.truncate(start);
            }
        }
        all
    }

    fn light(&self, i: usize) -> &[f64] {
        &self.light[2 * self.half * i..2 * self.half * (i + 1)]
    }

    fn levels(&self, i: usize) -> (f64, f64) {
        let light = self.light(i);
        let mean = |s: &[f64]| s.iter().sum::<f64>() / s.len() as f64;
        (mean(&light[..self.plateau]), mean(&light[light.len() - self.plateau..]))
    }

    /// Fits all crossings in some rounds from what is thought common to them; `curve` is what the expected positions were
    /// taken from. `None` when nothing is seen.
    pub(super) fn locate(
        &self,
        erf: &ErfTable,
        curve: &Polynomial,
        start: Common,
        rounds: usize,
    ) -> Option<Located> {
        let mut steps: Vec<f64> =
            (0..self.lines.len()).map(|i| self.levels(i)).map(|(low, high)| high - low).collect();
        let typical_step = median(&mut steps)?;
        if typical_step.is_nan() || typical_step <= 0.0 {
            return None;
        }
        let usable: Vec<usize> = (0..self.lines.len())
            .filter(|&i| {
                let (low, high) = self.levels(i);
                high - low > MIN_RELATIVE_STEP * typical_step
            })
            .collect();
        let noise = self.noise(&usable, typical_step)?;
        let mut shared = start;
        let bundles: Vec<&[usize]> = usable.chunks(bundle_size(&noise, shared.blur, usable.len())).collect();
        let mut states: Vec<State> = bundles
            .iter()
            .map(|b| {
                let mean = |f: &dyn Fn(usize) -> f64| b.iter().map(|&i| f(i)).sum::<f64>() / b.len() as f64;
                let dark = mean(&|i| self.levels(i).0);
                State { offset: 0.0, dark, step: mean(&|i| self.levels(i).1) - dark }
            })
            .collect();
        let mut own = vec![Equations::default(); bundles.len()];
        let mut summary = Summary::default();
        for _ in 0..rounds {
            for ((equations, state), bundle) in own.iter_mut().zip(&states).zip(&bundles) {
                *equations = self.equations(erf, bundle, state, &shared, &noise);
            }
            summary = Summary::of(&own)?;
            self.update(&mut shared, &mut states, &own, &summary);
        }
        let crossings = (bundles.iter().zip(&states).zip(&own))
            .filter_map(|((bundle, state), equations)| {
                let line = bundle.iter().map(|&i| self.lines[i][0]).sum::<f64>() / bundle.len() as f64;
                let position = curve.value(line) + self.scan.toward * state.offset;
                let sigma = equations.offset_variance()?.sqrt();
                (position.is_finite() && sigma.is_finite()).then_some(Crossing {
                    line,
                    position,
                    sigma: sigma.max(1e-4),
                })
            })
            .collect();
        Some(Located {
            crossings,
            tried: self.lines.len().min(bundles.len()),
            common: shared,
            common_sigma: summary.common_sigma,
        })
    }

    /// Scatter of the light on either side around its own slope: medians, which a clip or a shadow does not move.
    fn noise(&self, usable: &[usize], typical_step: f64) -> Option<Noise> {
        let scatter = |samples: &[f64]| {
            let n = samples.len() as f64;
            let mean = samples.iter().sum::<f64>() / n;
            let (mut sxy, mut sxx, mut syy) = (0.0, 0.0, 0.0);
            for (i, v) in samples.iter().enumerate() {
                let x = i as f64 - (n - 1.0) / 2.0;
                sxy += x * (v - mean);
                sxx += x * x;
                syy += (v - mean).powi(2);
            }
            (syy - sxy * sxy / sxx).max(0.0) / (n - 2.0).max(1.0)
        };
        let plateau = self.plateau;
        let mut dark: Vec<f64> = usable.iter().map(|&i| scatter(&self.light(i)[..plateau])).collect();
        let mut bright: Vec<f64> =
            usable.iter().map(|&i| scatter(&self.light(i)[2 * self.half - plateau..])).collect();
        // The median of χ² of a few degrees of freedom lies below its mean.
        let freedom = (plateau as f64 - 2.0).max(1.0);
        let to_mean = (1.0 - 2.0 / (9.0 * freedom)).powi(-3);
        let least = MIN_NOISE * MIN_NOISE;
        let variance = |v: &mut [f64]| Some((median(v)? * to_mean).max(least));
        Some(Noise { dark: variance(&mut dark)?, bright: variance(&mut bright)?, typical_step })
    }

    /// The least squares of one crossing. All pixels count alike although bright ones are noisier: with even weights,
    /// what the true blur differs from the model in has no side to pull to.
    fn equations(
        &self,
        erf: &ErfTable,
        bundle: &[usize],
        state: &State,
        shared: &Common,
        noise: &Noise,
    ) -> Equations {
        let bright =
            noise.dark + (noise.bright - noise.dark) * (state.step / noise.typical_step).clamp(0.0, 4.0);
        let bright = bright.max(0.25 * noise.bright.min(noise.dark));
        let mut e = Equations::default();
        let (mut cost, mut count) = (0.0, 0.0);
        for &i in bundle {
            let [_, base, expected] = self.lines[i];
            let side = state.offset + self.scan.toward * (expected - base);
            let boundary = |k: usize| Boundary::at(erf, k as f64 - self.half as f64 - side, shared.blur);
            let mut before = boundary(0);
            for (k, light) in self.light(i).iter().enumerate() {
                let after = boundary(k + 1);
                let (b, slope) = (after.integral - before.integral, after.value - before.value);
                let by_blur = after.by_blur - before.by_blur;
                before = after;
                let d = k as f64 + 0.5 - self.half as f64 - side;
                let [low, high] = shared.slopes;
                let shape = b + d * (low * (1.0 - b) + high * b);
                let variance = noise.dark + (bright - noise.dark) * b;
                let residual = state.dark + state.step * shape - light;
                let bend = 1.0 + d * (high - low);
                let by_side = -state.step * (slope * bend + low * (1.0 - b) + high * b);
                let own = Vector3::new(by_side, 1.0, shape);
                let common =
                    Vector3::new(state.step * by_blur * bend, state.step * d * (1.0 - b), state.step * d * b);
                e.own += own * own.transpose();
                e.scatter += own * own.transpose() * variance;
                e.cross += own * common.transpose();
                e.common += common * common.transpose();
                e.own_gradient += own * residual;
                e.common_gradient += common * residual;
                cost += residual * residual / variance;
                count += 1.0;
            }
        }
        e.chi = (cost / (count - 3.0_f64).max(1.0)).sqrt();
        e.own_inverse = e.own.try_inverse();
        e
    }

    fn update(&self, shared: &mut Common, states: &mut [State], own: &[Equations], summary: &Summary) {
        let step = summary.step;
        let reach = (self.half - self.plateau) as f64;
        shared.blur = (shared.blur + step.x)
            .clamp((0.5 * shared.blur).max(MIN_BLUR_PX), 2.0 * shared.blur + MIN_BLUR_PX);
        shared.slopes = [shared.slopes[0] + step.y, shared.slopes[1] + step.z];
        for (state, e) in states.iter_mut().zip(own) {
            let Some(inverse) = e.own_inverse else { continue };
            let change = -(inverse * (e.own_gradient + e.cross * step));
            if change.iter().all(|x| x.is_finite()) {
                state.offset = (state.offset + change.x.clamp(-shared.blur - 0.5, shared.blur + 0.5))
                    .clamp(-reach, reach);
                state.dark += change.y;
                state.step += change.z;
            }
        }
    }
}

/// How many lines to take together.
fn bundle_size(noise: &Noise, blur: f64, lines: usize) -> usize {
    // A step of height S seen through a blur s is located to √(2√π·s)·noise/S.
    let single = f64::midpoint(noise.dark, noise.bright).sqrt() / noise.typical_step
        * (2.0 * std::f64::consts::PI.sqrt() * blur.max(0.5)).sqrt();
    let wanted = (single / (LINEAR_PART * blur.max(0.5))).powi(2).ceil().min(1e6);
    (wanted as usize).clamp(1, (lines / MIN_BUNDLES).max(1))
}

/// The step's distribution function F and its integral at a boundary between pixels.
struct Boundary {
    value: f64,
    integral: f64,
    by_blur: f64,
}

impl Boundary {
    fn at(erf: &ErfTable, u: f64, blur: f64) -> Self {
        let root = 1.0 / (std::f64::consts::SQRT_2 * blur);
        let (e, slope) = erf.at(u * root);
        let (value, density) = (0.5 * (1.0 + e), 0.5 * slope * root);
        Self { value, integral: u * value + blur * blur * density, by_blur: blur * density }
    }
}

/// Normal equations of one crossing: its own unknowns (offset, dark, step), the common ones (blur, slopes), and both.
#[derive(Debug, Clone, Copy, Default)]
struct Equations {
    own: Matrix3<f64>,
    cross: Matrix3<f64>,
    common: Matrix3<f64>,
    own_gradient: Vector3<f64>,
    common_gradient: Vector3<f64>,
    own_inverse: Option<Matrix3<f64>>,
    /// Σ variance·J·Jᵀ of its own unknowns.
    scatter: Matrix3<f64>,
    /// Root of χ² per degree of freedom.
    chi: f64,
}

impl Equations {
    /// Variance of the offset by the noise of its pixels.
    fn offset_variance(&self) -> Option<f64> {
        let inverse = self.own_inverse?;
        Some((inverse * self.scatter * inverse)[(0, 0)])
    }
}

/// The common unknowns' step, and what their uncertainty does to all crossings.
#[derive(Debug, Default)]
struct Summary {
    step: Vector3<f64>,
    common_sigma: f64,
}

impl Summary {
    fn of(all: &[Equations]) -> Option<Self> {
        let mut chis: Vec<f64> = all.iter().map(|e| e.chi).collect();
        let limit = MAX_CHI * median(&mut chis)?;
        let (mut normal, mut gradient) = (Matrix3::zeros(), Vector3::zeros());
        let (mut lever, mut scatter, mut weights) = (RowVector3::zeros(), 0.0, 0.0);
        for e in all.iter().filter(|e| e.chi <= limit) {
            let Some(inverse) = e.own_inverse else { continue };
            let through = e.cross.transpose() * inverse;
            normal += e.common - through * e.cross;
            gradient += e.common_gradient - through * e.own_gradient;
            let weight = e.offset_variance().unwrap_or(f64::INFINITY).recip();
            scatter += e.scatter.trace() / e.own.trace() * weight;
            lever += (inverse * e.cross).row(0) * weight;
            weights += weight;
        }
        let covariance = normal.try_inverse()?;
        let lever = lever / weights;
        let common_sigma = ((lever * covariance * lever.transpose())[0] * scatter / weights).max(0.0).sqrt();
        let step = -(covariance * gradient);
        (step.iter().all(|x| x.is_finite()) && common_sigma.is_finite())
            .then_some(Self { step, common_sigma })
    }
}
