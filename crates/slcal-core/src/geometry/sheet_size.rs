//! The size of a sheet as somebody states it: width and height with a unit, or the name of a paper.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::length_unit::{LengthUnit, with_unit};
use super::paper;
use super::rectangle::RectangleSize;
use crate::error::{Error, ErrorSubject, Result};

impl FromStr for RectangleSize {
    type Err = Error;

    /// Width and height with a unit (`594x420mm`, `59.4x42cm`, `0.594x0.42m`, `11x8.5in`), or a paper: `A0` to `A6`, `B0` to
    /// `B6`, `letter`, `legal`, `tabloid`, `ANSI-C` to `ANSI-E` upright, `A4-landscape` turned.
    ///
    /// # Errors
    /// [`Error::Invalid`] that lists these, for sides outside [`SIDE_RANGE_MM`](Self::SIDE_RANGE_MM) as well.
    fn from_str(text: &str) -> Result<Self> {
        let text = text.trim();
        let wrong = |why: &str| {
            let expected = "a width and a height with a unit (594x420mm, 59.4x42cm, 11x8.5in), each side from 1 mm to \
                            100 m, or a paper (A0 to A6, B0 to B6, letter, legal, tabloid; A4-landscape or A4-portrait where \
                            the sheet may not be turned)";
            let shown: String = text.chars().take(40).collect();
            Error::invalid(ErrorSubject::SheetSize, expected, format!("\"{shown}\"{why}"))
        };
        let lower = text.to_lowercase();
        let landscape = lower.strip_suffix("-landscape");
        let name = landscape.or_else(|| lower.strip_suffix("-portrait")).unwrap_or(&lower);
        if let Some(paper) = paper::named(name) {
            return Ok(if landscape.is_some() { paper.size.transposed() } else { paper.size });
        }
        let Some((numbers, unit)) = with_unit(&lower) else {
            let why = Self::unit_that_is_missing(&lower);
            return Err(wrong(&why.map_or(String::new(), |unit| format!(" without a unit; {lower}{unit}?"))));
        };
        let [width, height] = two_numbers(numbers).ok_or_else(|| wrong(""))?.map(|side| side * unit.mm);
        let size = Self { width_mm: width, height_mm: height };
        if ![width, height].iter().all(|side| Self::SIDE_RANGE_MM.contains(side)) {
            let likely = size.likely_units();
            let hint = likely.first().map(|(unit, size)| format!(", {size} if those are {unit}"));
            return Err(wrong(&hint.unwrap_or_default()));
        }
        Self::new(width, height)
    }
}

impl RectangleSize {
    /// The unit that two numbers without one were probably meant in, as it is typed; `None` where the text is no size.
    #[must_use]
    pub fn unit_that_is_missing(text: &str) -> Option<&'static str> {
        let [width_mm, height_mm] = two_numbers(&text.to_lowercase())?;
        let size = Self::new(width_mm, height_mm).ok()?;
        Some(size.likely_units().first().map_or("mm", |(unit, _)| LengthUnit::symbol_of(unit)))
    }
}

/// The numbers of `594x420`.
fn two_numbers(text: &str) -> Option<[f64; 2]> {
    let sides = text.split(['x', '×']).map(|side| side.trim().parse::<f64>());
    <[f64; 2]>::try_from(sides.collect::<std::result::Result<Vec<_>, _>>().ok()?).ok()
}

/// A size as it was stated. A paper by its name alone (`A4`) may lie either way round in each photograph; of numbers and of
/// `A4-landscape` it is known which side is the width.
///
/// # Examples
/// ```
/// use slcal_core::{RectangleSize, SheetSize};
///
/// let named: SheetSize = "A4".parse()?;
/// assert!(named.is_either_way() && named.to_string() == "A4");
/// assert_eq!(named.upright(), RectangleSize::new(210.0, 297.0)?);
/// assert!(!"A4-landscape".parse::<SheetSize>()?.is_either_way());
/// assert_eq!(SheetSize::from(RectangleSize::new(300.0, 200.0)?).to_string(), "300x200mm");
/// # Ok::<(), slcal_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SheetSize {
    #[serde(flatten)]
    size: RectangleSize,
    #[serde(default)]
    either_way: bool,
}

impl SheetSize {
    /// The size as it was stated; of a paper by its name alone, upright.
    #[must_use]
    pub fn upright(&self) -> RectangleSize {
        self.size
    }

    /// Whether the photographs must tell which side is the width.
    #[must_use]
    pub fn is_either_way(&self) -> bool {
        self.either_way
    }
}

impl From<RectangleSize> for SheetSize {
    /// Of width and height.
    fn from(size: RectangleSize) -> Self {
        Self { size, either_way: false }
    }
}

impl FromStr for SheetSize {
    type Err = Error;

    /// What [`RectangleSize`] is parsed from.
    ///
    /// # Errors
    /// As [`RectangleSize::from_str`].
    fn from_str(text: &str) -> Result<Self> {
        let either_way = paper::named(text.trim()).is_some();
        Ok(Self { size: text.parse()?, either_way })
    }
}

impl fmt::Display for SheetSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.size.paper().filter(|_| self.either_way) {
            Some(name) => f.pad(name),
            None => self.size.fmt(f),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mm(text: &str) -> (f64, f64) {
        let size: RectangleSize = text.parse().unwrap();
        (size.width_mm, size.height_mm)
    }

    #[test]
    fn sizes_have_units_or_are_papers() {
        assert_eq!(mm("594x420mm"), (594.0, 420.0));
        assert_eq!(mm("59.4 x 42 cm"), (594.0, 420.0));
        assert_eq!(mm("10×20in"), (254.0, 508.0));
        assert_eq!(mm("A4"), (210.0, 297.0));
        assert_eq!(mm("a2-landscape"), (594.0, 420.0));
        assert_eq!(mm("A2-portrait"), (420.0, 594.0));
        assert_eq!(mm("Letter-Landscape"), (279.4, 215.9));
        for name in RectangleSize::paper_names() {
            assert!(name.parse::<RectangleSize>().is_ok(), "{name}");
        }
    }

    #[test]
    fn what_is_no_size_is_refused_with_what_is_expected() {
        let texts = [
            "0x420mm",
            "NaNx420mm",
            "-594x420mm",
            "594x420",
            "594mm",
            "1x2x3mm",
            "infx1mm",
            "A7",
            "",
            "1e9x1e9mm",
        ];
        for text in texts {
            let message = text.parse::<RectangleSize>().unwrap_err().to_string();
            assert!(message.contains("594x420mm") && message.contains(text), "{message}");
        }
    }

    #[test]
    fn the_unit_that_is_missing_is_named() {
        for (text, unit) in
            [("594x420", "mm"), ("21x29.7", "cm"), ("59.4X42", "cm"), ("8.5x11", "in"), ("0.594 x 0.42", "m")]
        {
            assert_eq!(RectangleSize::unit_that_is_missing(text), Some(unit), "{text}");
            let message = text.parse::<RectangleSize>().unwrap_err().to_string();
            assert!(message.contains("without a unit") && message.contains(&format!("{unit}?")), "{message}");
        }
        assert_eq!(RectangleSize::unit_that_is_missing("A4x"), None);
        let message = "0.594x0.42mm".parse::<RectangleSize>().unwrap_err().to_string();
        assert!(message.contains("594x420mm if those are metres"), "{message}");
        assert_eq!(mm("0.594x0.42m"), (594.0, 420.0));
    }

    #[test]
    fn only_a_bare_name_may_lie_either_way() {
        for name in RectangleSize::paper_names() {
            let parsed: SheetSize = name.to_lowercase().parse().unwrap();
            assert!(
                parsed.is_either_way() && parsed.upright().width_mm < parsed.upright().height_mm,
                "{name}"
            );
            assert_eq!(parsed.to_string(), name);
            for turned in ["portrait", "landscape"] {
                let parsed: SheetSize = format!("{name}-{turned}").parse().unwrap();
                assert!(!parsed.is_either_way(), "{name}-{turned}");
            }
        }
        assert!(!"210x297mm".parse::<SheetSize>().unwrap().is_either_way());
        assert!("A7".parse::<SheetSize>().is_err());
    }

    #[test]
    fn configurations_hold_sizes_that_were_stored_before_names() {
        let old: SheetSize = serde_json::from_str(r#"{"width_mm": 300.0, "height_mm": 200.0}"#).unwrap();
        assert_eq!(old, RectangleSize::new(300.0, 200.0).unwrap().into());
    }
}
