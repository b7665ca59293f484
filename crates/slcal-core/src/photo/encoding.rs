//! From code values to linear light.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::named::unnamed;

/// The transfer curve of a photograph.
///
/// # Examples
/// ```
/// use slcal_core::Encoding;
///
/// assert_eq!("srgb".parse::<Encoding>()?, Encoding::default());
/// assert!((Encoding::Srgb.to_linear(0.5) - 0.214).abs() < 1e-3);
/// assert_eq!("2.2".parse::<Encoding>()?, Encoding::Gamma(2.2));
/// # Ok::<(), slcal_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Encoding {
    /// IEC 61966-2-1, what cameras and PNG files use unless they say otherwise.
    #[default]
    Srgb,
    /// Code values are proportional to light (raw conversions, many 16-bit files).
    Linear,
    /// Light = value^γ.
    Gamma(f64),
}

impl fmt::Display for Encoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Srgb => f.pad("srgb"),
            Self::Linear => f.pad("linear"),
            Self::Gamma(gamma) => write!(f, "{gamma}"),
        }
    }
}

impl FromStr for Encoding {
    type Err = Error;

    /// `srgb`, `linear`, or γ as a number from 0.1 to 10.
    ///
    /// # Errors
    /// [`Error::Invalid`] that lists these.
    fn from_str(text: &str) -> Result<Self> {
        let encoding = match text.to_ascii_lowercase().as_str() {
            "srgb" => Some(Self::Srgb),
            "linear" => Some(Self::Linear),
            number => number.parse().ok().map(Self::Gamma).filter(|gamma| gamma.validate().is_ok()),
        };
        encoding.ok_or_else(|| unnamed("gamma", Self::NAMES, " or a number from 0.1 to 10", text))
    }
}

impl Encoding {
    /// The names of the curves; a number has none.
    pub const NAMES: &'static [&'static str] = &["srgb", "linear"];

    /// Checks the parameter.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a γ that is not between 0.1 and 10.
    pub fn validate(self) -> Result<()> {
        match self {
            Self::Gamma(g) if !(0.1..=10.0).contains(&g) => {
                Err(Error::invalid("gamma", "srgb, linear or a number from 0.1 to 10", g))
            }
            _ => Ok(()),
        }
    }

    /// Linear light (0–1) of a code value (0–1).
    #[must_use]
    pub fn to_linear(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Gamma(g) => value.powf(g),
            Self::Srgb if value <= 0.040_45 => value / 12.92,
            Self::Srgb => ((value + 0.055) / 1.055).powf(2.4),
        }
    }

    /// Code value (0–1) of linear light (0–1).
    #[must_use]
    pub fn from_linear(self, light: f64) -> f64 {
        let light = light.clamp(0.0, 1.0);
        match self {
            Self::Linear => light,
            Self::Gamma(g) => light.powf(g.recip()),
            Self::Srgb if light <= 0.003_130_8 => light * 12.92,
            Self::Srgb => 1.055 * light.powf(1.0 / 2.4) - 0.055,
        }
    }

    /// The curve tabulated for `count` code values.
    pub(super) fn table(self, count: u32) -> LinearTable {
        let top = f64::from(count - 1);
        LinearTable((0..count).map(|i| self.to_linear(f64::from(i) / top) as f32).collect())
    }
}

/// Linear light (0–1) by code value.
#[derive(Debug, Clone)]
pub(crate) struct LinearTable(Vec<f32>);

impl LinearTable {
    /// Light of a code value; the caller guarantees that the table was made for this sample type.
    #[inline]
    #[must_use]
    pub(crate) fn light(&self, code: usize) -> f32 {
        self.0[code]
    }

    /// Light of a code value; `None` beyond the last one.
    #[inline]
    #[must_use]
    pub(super) fn get(&self, code: usize) -> Option<f32> {
        self.0.get(code).copied()
    }

    /// The light of all 256 codes of 8 bit.
    pub(super) fn of_bytes(&self) -> Option<&[f32; 256]> {
        self.0.first_chunk()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_invert_and_hold_known_values() {
        for curve in [Encoding::Srgb, Encoding::Linear, Encoding::Gamma(2.2)] {
            for i in 0..=100 {
                let v = f64::from(i) / 100.0;
                assert!((curve.from_linear(curve.to_linear(v)) - v).abs() < 1e-6);
            }
        }
        // IEC 61966-2-1: code 128 of 255 is 21.586 % of the light.
        assert!((Encoding::Srgb.to_linear(128.0 / 255.0) - 0.215_86).abs() < 1e-5);
    }

    #[test]
    fn gamma_is_checked() {
        assert!(Encoding::Gamma(f64::NAN).validate().is_err());
        assert!(Encoding::Gamma(0.0).validate().is_err());
        assert!(Encoding::Gamma(2.2).validate().is_ok());
    }
}
