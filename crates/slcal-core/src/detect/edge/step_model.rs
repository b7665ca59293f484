//! The least squares of a blurred step: D + S·(B + a·d·(1 − B) + b·d·B), see [`super::profile`].
//!
//! Along the side face of a board a second step F·B(d + w) is added, where w is the width of the face. Its height F is a
//! fourth unknown of the crossing.

use nalgebra::{Matrix3, RowVector3, SMatrix, SVector, Vector3};

use crate::detect::erf::ErfTable;
use crate::solve::median;

/// Sharper sides than this cannot be told from perfect ones, px.
pub(super) const MIN_BLUR_PX: f64 = 0.12;
/// Crossings whose residuals exceed this many times the median do not contribute to the common parameters.
const MAX_CHI: f64 = 2.0;

/// The light profile across a side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Profile<'a> {
    /// From dark to bright, pixel by pixel.
    pub(super) light: &'a [f64],
    /// Number of pixels before the boundary that positions are counted from.
    pub(super) middle: f64,
    /// Where the side is expected, from there, px.
    pub(super) expected: f64,
    /// Width of the side face of the board beside it, px; zero without.
    pub(super) face_px: f64,
}

/// The common parameters of a side's crossings.
#[derive(Debug, Clone, Copy)]
pub(super) struct Common {
    pub(super) blur: f64,
    pub(super) slopes: [f64; 2],
}

/// A crossing: its offset from where it is expected, towards the sheet; dark level; step; the step of the side face.
#[derive(Debug, Clone, Copy)]
pub(super) struct State {
    pub(super) offset: f64,
    pub(super) dark: f64,
    pub(super) step: f64,
    pub(super) face: f64,
}

/// Variance of a pixel in the dark and beside the typical step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Noise {
    pub(super) dark: f64,
    pub(super) bright: f64,
    pub(super) typical_step: f64,
}

impl Common {
    /// A guess from half the width of the transition, px.
    pub(super) fn start(half_transition_px: f64) -> Self {
        Self { blur: (half_transition_px / 4.0).max(MIN_BLUR_PX), slopes: [0.0; 2] }
    }
}

impl Noise {
    /// Variance of a bright pixel beside a step of this height.
    fn beside(&self, step: f64) -> f64 {
        let bright = self.dark + (self.bright - self.dark) * (step / self.typical_step).clamp(0.0, 4.0);
        bright.max(0.25 * self.bright.min(self.dark))
    }
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

/// Normal equations of one crossing: its own N unknowns (offset, dark, step; the step of the side face, if N is 4), the
/// common ones (blur, slopes), and both.
#[derive(Debug, Clone, Copy)]
pub(super) struct Equations<const N: usize> {
    pub(super) own: SMatrix<f64, N, N>,
    pub(super) cross: SMatrix<f64, N, 3>,
    common: Matrix3<f64>,
    pub(super) own_gradient: SVector<f64, N>,
    pub(super) common_gradient: Vector3<f64>,
    pub(super) own_inverse: Option<SMatrix<f64, N, N>>,
    /// Σ variance·J·Jᵀ of its own unknowns.
    scatter: SMatrix<f64, N, N>,
    /// Root of χ² per degree of freedom.
    chi: f64,
}

impl<const N: usize> Default for Equations<N> {
    fn default() -> Self {
        Self {
            own: SMatrix::zeros(),
            cross: SMatrix::zeros(),
            common: Matrix3::zeros(),
            own_gradient: SVector::zeros(),
            common_gradient: Vector3::zeros(),
            own_inverse: None,
            scatter: SMatrix::zeros(),
            chi: 0.0,
        }
    }
}

impl<const N: usize> Equations<N> {
    /// The least squares of one crossing. All pixels have equal weights although bright ones are noisier: then a
    /// symmetric difference between the true blur and the model does not bias the crossing.
    pub(super) fn of<'a>(
        erf: &ErfTable,
        profiles: impl Iterator<Item = Profile<'a>>,
        state: &State,
        shared: &Common,
        noise: &Noise,
    ) -> Self {
        let bright = noise.beside(state.step + state.face);
        let mut e = Self::default();
        let (mut cost, mut count) = (0.0, 0.0);
        for profile in profiles {
            let side = profile.middle + state.offset + profile.expected;
            let boundary = |k: usize| Boundary::at(erf, k as f64 - side, shared.blur);
            let outer = |k: usize| Boundary::at(erf, k as f64 - side + profile.face_px, shared.blur);
            let mut before = boundary(0);
            let mut outer_before = (N > 3).then(|| outer(0));
            for (k, light) in profile.light.iter().enumerate() {
                let after = boundary(k + 1);
                let (b, slope) = (after.integral - before.integral, after.value - before.value);
                let by_blur = after.by_blur - before.by_blur;
                before = after;
                let d = k as f64 + 0.5 - side;
                let [low, high] = shared.slopes;
                let shape = b + d * (low * (1.0 - b) + high * b);
                let variance = noise.dark + (bright - noise.dark) * b;
                let mut residual = state.dark + state.step * shape - light;
                let bend = 1.0 + d * (high - low);
                let by_side = -state.step * (slope * bend + low * (1.0 - b) + high * b);
                let mut own = SVector::<f64, N>::zeros();
                (own[0], own[1], own[2]) = (by_side, 1.0, shape);
                let mut common =
                    Vector3::new(state.step * by_blur * bend, state.step * d * (1.0 - b), state.step * d * b);
                if let Some(before) = &mut outer_before {
                    let after = outer(k + 1);
                    own[3] = after.integral - before.integral;
                    residual += state.face * own[3];
                    own[0] -= state.face * (after.value - before.value);
                    common.x += state.face * (after.by_blur - before.by_blur);
                    *before = after;
                }
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
        e.chi = (cost / (count - N as f64).max(1.0)).sqrt();
        e.own_inverse = e.own.try_inverse();
        e
    }

    /// Variance of the offset by the noise of its pixels.
    pub(super) fn offset_variance(&self) -> Option<f64> {
        let inverse = self.own_inverse?;
        Some((inverse * self.scatter * inverse)[(0, 0)])
    }
}

/// The step of the common unknowns, and the effect of their uncertainty on all crossings.
#[derive(Debug, Default)]
pub(super) struct Summary {
    pub(super) step: Vector3<f64>,
    pub(super) common_sigma: f64,
}

impl Summary {
    pub(super) fn of<const N: usize>(all: &[Equations<N>]) -> Option<Self> {
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
