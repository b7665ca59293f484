//! Rows that get less light than others: mains flicker under a rolling shutter.

use serde::{Deserialize, Serialize};

use crate::error::{Result, within};

/// Periods, rows: shorter bands would be sampled too coarsely to be bands; longer ones change nothing in any picture.
const PERIODS_PX: [f64; 2] = [2.0, 1e6];

/// Row y gets 1 − amount/2 + amount/2 · sin(2π y / period) of its linear light.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flicker {
    /// What the darkest rows lose, as a share of the brightest.
    pub amount: f64,
    /// Rows from one dark band to the next.
    pub period_px: f64,
}

impl Flicker {
    /// Checks the values.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for an amount that is not from 0 to 1, and for a period under two rows.
    pub fn validate(&self) -> Result<()> {
        within("amount of flicker", self.amount, [0.0, 1.0], "")?;
        within("period of flicker", self.period_px, PERIODS_PX, " px")
    }

    /// The share of its light that row `y` gets.
    pub(super) fn at(&self, y: usize) -> f64 {
        let phase = 2.0 * std::f64::consts::PI * y as f64 / self.period_px;
        1.0 - self.amount / 2.0 + self.amount / 2.0 * libm::sin(phase)
    }
}
