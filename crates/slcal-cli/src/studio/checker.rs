//! The checkerboard that the studio projects.

use slcal_core::{CheckerConfig, CheckerPattern, Result};

/// With marks, and squares of this share of the usual side.
///
/// # Errors
/// As [`CheckerPattern::new`].
pub(super) fn checker(panel: [u32; 2], scale: f64) -> Result<CheckerPattern> {
    let usual = CheckerPattern::new(panel, &CheckerConfig::default())?.square_px;
    let config =
        CheckerConfig { square_px: Some((usual * scale).round()), marks: true, ..CheckerConfig::default() };
    CheckerPattern::new(panel, &config)
}
