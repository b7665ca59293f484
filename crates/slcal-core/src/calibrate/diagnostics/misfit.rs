//! How badly a fit misses what was seen, in the measurements' own σ: a measure that may be compared between fits.

use crate::calibrate::maximum_likelihood::Solved;
use crate::estimate::Kind;
use crate::estimate::model::prior_squares;
use crate::solve::Loss;

/// Residuals beyond this many σ count linearly: a few outliers cannot decide, and a view that does not fit still tells.
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
pub(crate) fn misfit(solved: &Solved) -> Misfit {
    let loss = Loss::Huber(LINEAR_BEYOND);
    let mut of = Misfit { chi2: prior_squares(&solved.joint.priors, &solved.fit.model).sum(), rows: 0 };
    for (m, norm) in solved.joint.measurements.iter().zip(&solved.fit.norms_px) {
        of.chi2 += loss.cost((norm / m.sigma_px).powi(2));
        of.rows += if m.kind() == Kind::Edge { 1 } else { 2 };
    }
    of
}
