//! What is known beforehand: about the lenses, one residual for each parameter, and about how far sheets bend, one for each
//! coefficient.

use super::assumptions::{Assumptions, Lens};
use super::model::{Model, lens_values};
use super::residual::BEND;
use super::unknowns::Unknowns;
use crate::parameter::LensParameter;

/// From this many σ on a principal point contradicts its prior (draws from the prior do so once in 400), as with a lens that is
/// shifted by more than was expected; beyond the second the photographs themselves do not fit, and the prior stands.
const CONTRADICTED: f64 = 3.0;
const ABSURD: f64 = 6.0;

/// χ² per prior that ordinary lenses and sheets stay far below.
const ORDINARY: f64 = 3.0;

/// A lens parameter that is known to be `mean` ± `sigma` (the focal length and the aspect as logarithms).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LensPrior {
    pub(crate) lens: Lens,
    pub(crate) parameter: LensParameter,
    pub(crate) mean: f64,
    pub(crate) sigma: f64,
    /// By how much `sigma` was widened because the photographs contradict what was stated.
    pub(crate) widened: f64,
}

impl LensPrior {
    /// The parameter's value in a model.
    pub(crate) fn value(&self, model: &Model) -> Option<f64> {
        model.lens(self.lens).map(|lens| lens_values(lens)[self.parameter as usize])
    }

    /// How far the parameter lies from its mean, in the σ that was stated.
    pub(crate) fn stated_residual(&self, model: &Model) -> Option<f64> {
        Some(self.residual(model)? * self.widened)
    }

    /// The same where a principal point of a device that is shifted or cropped is so far from its mean that the prior would
    /// only pull at everything else: it becomes as wide as the distance.
    pub(crate) fn reconciled(&self, model: &Model) -> Self {
        let principal_point = matches!(self.parameter, LensParameter::Cx | LensParameter::Cy);
        let off = self.stated_residual(model).map_or(0.0, f64::abs);
        let shifted = off > CONTRADICTED && (off < ABSURD || self.widened > 1.0);
        let widened = if principal_point && shifted { off } else { 1.0 };
        Self { sigma: self.sigma / self.widened * widened, widened, ..*self }
    }

    /// How far the parameter lies from its mean, in σ.
    pub(crate) fn residual(&self, model: &Model) -> Option<f64> {
        Some((self.value(model)? - self.mean) / self.sigma)
    }
}

/// What is known beforehand about the unknowns.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Priors {
    pub(crate) lenses: Vec<LensPrior>,
    /// 1σ of each coefficient of each view's bend around zero, mm; empty for flat sheets.
    pub(crate) bends: Vec<[f64; BEND]>,
}

impl Priors {
    /// Of the unknowns of a model under assumptions.
    pub(crate) fn new(assumptions: &Assumptions, unknowns: &Unknowns, model: &Model) -> Self {
        let all =
            Lens::ALL.into_iter().flat_map(|lens| LensParameter::ALL.map(|parameter| (lens, parameter)));
        let lenses = all.filter_map(|(lens, parameter)| {
            unknowns.lens(lens, parameter)?;
            let device = model.lens(lens)?;
            let (mean, sigma) = assumptions.prior(lens, parameter, [device.width, device.height])?;
            Some(LensPrior { lens, parameter, mean, sigma, widened: 1.0 })
        });
        let bends = model.views.iter().filter(|_| !assumptions.flatness.is_flat());
        Self {
            lenses: lenses.collect(),
            bends: bends.map(|v| assumptions.flatness.sigmas_mm(v.size)).collect(),
        }
    }

    /// Whether a model is anywhere near what is known, or lenses and sheets had to be bent until something fitted.
    pub(crate) fn hold(&self, model: &Model) -> bool {
        let count = self.lenses.len() + self.bends.iter().flatten().count();
        self.chi_squared(model) <= ORDINARY * count as f64
    }

    /// χ² of a model.
    pub(crate) fn chi_squared(&self, model: &Model) -> f64 {
        let lenses = self.lenses.iter().filter_map(|p| Some(p.residual(model)?.powi(2)));
        let bends =
            self.bends.iter().zip(&model.views).flat_map(|(sigmas, view)| {
                sigmas.iter().zip(view.bend.0).map(|(sigma, c)| (c / sigma).powi(2))
            });
        lenses.chain(bends).sum()
    }
}
