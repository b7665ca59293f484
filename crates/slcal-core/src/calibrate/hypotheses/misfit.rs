//! χ² of a solution in the measurements' own σ, which may be compared between solutions.

use crate::estimate::robust::RobustProblem as _;
use crate::estimate::{BundleAdjustment, Model, Solution};
use crate::solve::Loss;

/// Residuals beyond this many σ count linearly: a few outliers cannot decide, and a view that does not fit still shows.
const LINEAR_BEYOND: f64 = 3.0;

/// χ² and the number of residuals in it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Misfit {
    pub(crate) chi2: f64,
    pub(crate) rows: usize,
}

impl Misfit {
    /// χ² per residual: near one, and below where the points are correlated.
    pub(crate) fn per_row(&self) -> f64 {
        self.chi2 / self.rows.max(1) as f64
    }
}

/// Of all measurements, outliers too, and of the priors.
pub(crate) fn misfit(solution: &Solution) -> Misfit {
    let loss = Loss::Huber(LINEAR_BEYOND);
    let mut of = Misfit { chi2: solution.problem.priors.chi_squared(solution.model()), rows: 0 };
    for (m, norm, _) in solution.measured() {
        of.chi2 += loss.cost((norm / m.sigma_px).powi(2));
        of.rows += m.rows();
    }
    of
}

/// Square roots of the same loss's weights, one for each row of a problem; those of priors are one.
pub(super) fn weights(problem: &BundleAdjustment, model: &Model) -> Option<Vec<f64>> {
    let norms = problem.norms_px(model)?;
    let in_sigma = problem.measurements.iter().zip(norms).map(|(m, norm)| norm / m.sigma_px);
    Some(problem.row_weights(in_sigma.map(|s| Loss::Huber(LINEAR_BEYOND).weight(s * s).sqrt())))
}
