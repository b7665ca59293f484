//! How far sheets are expected to bend.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::residual::BEND;
use crate::error::{Error, Result};
use crate::geometry::{RectangleSize, SheetBend};
use crate::named::unnamed;

/// 1σ of each coefficient of the second order, as a share of the sheet's diagonal.
const PAPER: f64 = 0.002;
const BOARD: f64 = 0.0002;
/// Coefficients of order 3 and 4 have these parts of the σ of those of order 2.
const OF_ORDER: [f64; 3] = [1.0, 0.5, 0.25];

/// How flat the sheet is: the width of the prior on its [bend](SheetBend). σ is that of each coefficient of the second order; a
/// coefficient a raises the sheet by 1.5·a from valley to peak. Those of the third order have half of it, those of the fourth
/// a quarter.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Flatness {
    /// A sheet of paper, taped to a wall or a table: σ of 0.2 % of the diagonal.
    #[default]
    Paper,
    /// A board: 0.02 % of the diagonal.
    Board,
    /// Exactly flat.
    Flat,
    /// This σ, mm.
    Sigma(f64),
}

impl Flatness {
    /// The names; a length has none.
    pub const NAMES: &'static [&'static str] = &["paper", "board", "flat"];

    /// Whether the sheet is taken for exactly flat.
    #[must_use]
    pub fn is_flat(self) -> bool {
        matches!(self, Self::Flat) || self == Self::Sigma(0.0)
    }

    /// 1σ of the coefficients of the second order for a sheet of this size, mm.
    #[must_use]
    pub fn sigma_mm(self, size: RectangleSize) -> f64 {
        let diagonal = size.width_mm.hypot(size.height_mm);
        match self {
            Self::Paper => PAPER * diagonal,
            Self::Board => BOARD * diagonal,
            Self::Flat => 0.0,
            Self::Sigma(mm) => mm,
        }
    }

    /// 1σ of every coefficient, mm.
    pub(crate) fn sigmas_mm(self, size: RectangleSize) -> [f64; BEND] {
        std::array::from_fn(|k| self.sigma_mm(size) * OF_ORDER[SheetBend::order(k) - 2])
    }
}

impl fmt::Display for Flatness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Paper => f.pad("paper"),
            Self::Board => f.pad("board"),
            Self::Flat => f.pad("flat"),
            Self::Sigma(mm) => write!(f, "{mm}mm"),
        }
    }
}

impl FromStr for Flatness {
    type Err = Error;

    /// `paper`, `board`, `flat`, or σ as a length such as `0.5mm`.
    ///
    /// # Errors
    /// [`Error::Invalid`] that lists these.
    fn from_str(text: &str) -> Result<Self> {
        Ok(match text.trim().to_ascii_lowercase().as_str() {
            "paper" => Self::Paper,
            "board" => Self::Board,
            "flat" => Self::Flat,
            length => {
                let mm = crate::geometry::length_mm(length).filter(|mm| *mm >= 0.0);
                Self::Sigma(
                    mm.ok_or_else(|| unnamed("flatness", Self::NAMES, " or a length such as 0.5mm", text))?,
                )
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_parsed_and_printed_alike() {
        for (text, flatness) in [
            ("paper", Flatness::Paper),
            ("board", Flatness::Board),
            ("flat", Flatness::Flat),
            ("0.5mm", Flatness::Sigma(0.5)),
        ] {
            assert_eq!(text.parse::<Flatness>().unwrap(), flatness);
            assert_eq!(flatness.to_string(), text);
        }
        assert_eq!("0.1cm".parse::<Flatness>().unwrap(), Flatness::Sigma(1.0));
        for text in ["", "bent", "-1mm", "NaNmm", "infmm", "1px"] {
            assert!(text.parse::<Flatness>().is_err(), "{text}");
        }
    }

    #[test]
    fn higher_orders_are_narrower() {
        let a4 = RectangleSize { width_mm: 297.0, height_mm: 210.0 };
        let sigmas = Flatness::Paper.sigmas_mm(a4);
        assert!(
            (sigmas[1] - 0.7275).abs() < 1e-3
                && sigmas[3] == 0.5 * sigmas[0]
                && sigmas[11] == 0.25 * sigmas[0]
        );
    }
}
