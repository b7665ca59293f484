//! How well photographs fit together under a configuration.

use super::misfit::misfit;
use crate::calibrate::config::CalibrateConfig;
use crate::calibrate::maximum_likelihood::solve;
use crate::observations::Observations;

/// χ² per residual in the measurements' own σ, of everything together; infinite where nothing explains the observations.
pub(crate) fn misfit_per_residual(observations: &Observations, config: &CalibrateConfig) -> f64 {
    solve(observations, config).map_or(f64::INFINITY, |solution| misfit(&solution).per_row())
}
