//! What is known beforehand about the lenses, one residual for each parameter.

use super::assumptions::{Assumptions, Lens};
use super::model::{Model, lens_values};
use super::unknowns::Unknowns;
use crate::parameter::LensParameter;

/// A lens parameter that is known to be `mean` ± `sigma` (the focal length as ln f).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Prior {
    pub(crate) lens: Lens,
    pub(crate) parameter: LensParameter,
    pub(crate) mean: f64,
    pub(crate) sigma: f64,
}

impl Prior {
    /// The parameter's value in a model.
    pub(crate) fn value(&self, model: &Model) -> Option<f64> {
        model.lens(self.lens).map(|lens| lens_values(lens)[self.parameter as usize])
    }

    /// How far the parameter lies from its mean, in σ.
    pub(crate) fn residual(&self, model: &Model) -> Option<f64> {
        Some((self.value(model)? - self.mean) / self.sigma)
    }
}

/// What is known beforehand about the unknowns.
pub(crate) fn priors(assumptions: &Assumptions, unknowns: &Unknowns, model: &Model) -> Vec<Prior> {
    let all = Lens::ALL.into_iter().flat_map(|lens| LensParameter::ALL.map(|parameter| (lens, parameter)));
    all.filter_map(|(lens, parameter)| {
        unknowns.lens(lens, parameter)?;
        let device = model.lens(lens)?;
        let (mean, sigma) = assumptions.prior(lens, parameter, [device.width, device.height])?;
        Some(Prior { lens, parameter, mean, sigma })
    })
    .collect()
}

/// χ² of the priors.
pub(crate) fn chi_squared(priors: &[Prior], model: &Model) -> f64 {
    priors.iter().filter_map(|p| Some(p.residual(model)?.powi(2))).sum()
}
