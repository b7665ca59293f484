//! Whether observations can be calibrated from under a configuration.

use crate::calibrate::config::CalibrateConfig;
use crate::error::{Error, ErrorSubject, Result};
use crate::estimate;
use crate::observations::Observations;

/// Checks the configuration for these observations, and the observations themselves.
///
/// # Errors
/// [`Error::Invalid`] naming what is wrong.
pub(crate) fn check(observations: &Observations, config: &CalibrateConfig) -> Result<()> {
    config.validate_for(observations.views.len(), observations.projector.is_some())?;
    if let Some(known) = &config.known_camera
        && [known.width, known.height] != observations.camera
    {
        return Err(Error::invalid(
            ErrorSubject::KnownCamera,
            format!("one for the photograph's {}x{} px", observations.camera[0], observations.camera[1]),
            format!("{}x{} px", known.width, known.height),
        ));
    }
    estimate::validate::validate(observations)
}
