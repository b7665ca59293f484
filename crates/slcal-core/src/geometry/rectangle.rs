//! The sheet: a rectangle of known size.

use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

use nalgebra::Point2;
use serde::{Deserialize, Serialize};

use crate::error::{Error, ErrorSubject, Result};

/// Width (along the image's x axis as the camera sees it) and height of a rectangle, mm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RectangleSize {
    /// Length of the top side, mm.
    pub width_mm: f64,
    /// Length of the left side, mm.
    pub height_mm: f64,
}

/// Paper sizes upright, mm.
const PAPERS: [(&str, f64, f64); 9] = [
    ("A0", 841.0, 1189.0),
    ("A1", 594.0, 841.0),
    ("A2", 420.0, 594.0),
    ("A3", 297.0, 420.0),
    ("A4", 210.0, 297.0),
    ("A5", 148.0, 210.0),
    ("A6", 105.0, 148.0),
    ("letter", 215.9, 279.4),
    ("legal", 215.9, 355.6),
];

/// Diagonal of a bank card, mm, rounded down. Paper that is smaller was probably measured in centimetres.
const CARD_DIAGONAL_MM: f64 = 100.0;
/// How far the sides of a sheet may be off those of the paper that it is, as a share.
const PAPER_TOLERANCE: f64 = 0.01;

/// The sides of the sheet, in the order of all lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Side {
    /// TL–TR.
    Top,
    /// TR–BR.
    Right,
    /// BR–BL.
    Bottom,
    /// BL–TL.
    Left,
}

impl Side {
    /// All four, in order.
    pub(crate) const ALL: [Self; 4] = [Self::Top, Self::Right, Self::Bottom, Self::Left];
}

impl RectangleSize {
    /// Sides that a sheet may have, mm. Beyond them a unit was mistaken: no sheet of a millimetre is calibrated from, and
    /// no projector lights a hundred metres.
    pub const SIDE_RANGE_MM: RangeInclusive<f64> = 1.0..=100_000.0;

    /// A rectangle of positive, finite size.
    ///
    /// # Errors
    /// [`Error::Invalid`] for zero, negative or non-finite lengths.
    ///
    /// # Examples
    /// ```
    /// use slcal_core::RectangleSize;
    ///
    /// assert_eq!(RectangleSize::new(594.0, 420.0)?, "A2-landscape".parse()?);
    /// assert_eq!("59.4x42cm".parse::<RectangleSize>()?, "594x420mm".parse()?);
    /// # Ok::<(), slcal_core::Error>(())
    /// ```
    pub fn new(width_mm: f64, height_mm: f64) -> Result<Self> {
        let fine = |x: f64| x.is_finite() && x > 0.0;
        if !(fine(width_mm) && fine(height_mm)) {
            return Err(Error::invalid(
                ErrorSubject::SheetSize,
                "two positive lengths, such as 594x420mm",
                format!("{width_mm}x{height_mm}mm"),
            ));
        }
        Ok(Self { width_mm, height_mm })
    }

    /// Corners on the sheet, mm: TL (the origin), TR, BR, BL.
    #[must_use]
    pub fn corners(&self) -> [Point2<f64>; 4] {
        let (w, h) = (self.width_mm, self.height_mm);
        [Point2::new(0.0, 0.0), Point2::new(w, 0.0), Point2::new(w, h), Point2::new(0.0, h)]
    }

    /// The middle, mm.
    #[must_use]
    pub fn centre(&self) -> Point2<f64> {
        Point2::new(self.width_mm / 2.0, self.height_mm / 2.0)
    }

    /// The part of the sheet in which a point (mm from its top left corner) lies: "top left", "middle", "right".
    #[must_use]
    pub fn place_in_words(&self, at: Point2<f64>) -> &'static str {
        const PLACES: [[&str; 3]; 3] = [
            ["top left", "top", "top right"],
            ["left", "middle", "right"],
            ["bottom left", "bottom", "bottom right"],
        ];
        let third = |x: f64, length: f64| ((3.0 * x / length) as usize).min(2);
        PLACES[third(at.y, self.height_mm)][third(at.x, self.width_mm)]
    }

    /// The names of papers that [`FromStr`] knows; each of them may be followed by `-landscape` or `-portrait`.
    pub fn paper_names() -> impl Iterator<Item = &'static str> {
        PAPERS.iter().map(|paper| paper.0)
    }

    /// Ten times this size when it was probably given in centimetres: the larger sheet is a common paper, or this one is
    /// smaller than a bank card.
    #[must_use]
    pub fn in_centimetres(&self) -> Option<Self> {
        let larger = Self { width_mm: 10.0 * self.width_mm, height_mm: 10.0 * self.height_mm };
        let sides = |s: &Self| [s.width_mm.min(s.height_mm), s.width_mm.max(s.height_mm)];
        let [short, long] = sides(&larger);
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < PAPER_TOLERANCE;
        let paper = PAPERS.iter().any(|&(_, w, h)| near(short, w) && near(long, h));
        (paper || self.width_mm.hypot(self.height_mm) < CARD_DIAGONAL_MM).then_some(larger)
    }

    /// The same sheet rotated by 90°.
    #[must_use]
    pub fn transposed(&self) -> Self {
        Self { width_mm: self.height_mm, height_mm: self.width_mm }
    }
}

impl fmt::Display for RectangleSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}mm", self.width_mm, self.height_mm)
    }
}

impl FromStr for RectangleSize {
    type Err = Error;

    /// Width and height with a unit (`594x420mm`, `59.4x42cm`, `11x8.5in`), or a paper: `A0` to `A6`, `letter`, `legal`
    /// upright, `A4-landscape` turned.
    ///
    /// # Errors
    /// [`Error::Invalid`] that lists these, for sides outside [`SIDE_RANGE_MM`](Self::SIDE_RANGE_MM) as well.
    fn from_str(text: &str) -> Result<Self> {
        let text = text.trim();
        let wrong = |why: &str| {
            let expected = "a width and a height with a unit (594x420mm, 59.4x42cm, 11x8.5in), each side from 1 mm to \
                            100 m, or a paper (A0 to A6, letter, legal, upright; A4-landscape for the paper turned)";
            let shown: String = text.chars().take(40).collect();
            Error::invalid(ErrorSubject::SheetSize, expected, format!("\"{shown}\"{why}"))
        };
        let lower = text.to_lowercase();
        let landscape = lower.strip_suffix("-landscape");
        let name = landscape.or_else(|| lower.strip_suffix("-portrait")).unwrap_or(&lower);
        if let Some(&(_, width, height)) = PAPERS.iter().find(|p| p.0.eq_ignore_ascii_case(name)) {
            let upright = Self::new(width, height)?;
            return Ok(if landscape.is_some() { upright.transposed() } else { upright });
        }
        let sides = |numbers: &str| {
            let sides = numbers.split(['x', '×']).map(|side| side.trim().parse::<f64>());
            sides.collect::<std::result::Result<Vec<_>, _>>().ok().and_then(|s| <[f64; 2]>::try_from(s).ok())
        };
        let Some((numbers, mm)) = with_unit(&lower) else {
            let why = if sides(&lower).is_some() { " without a unit" } else { "" };
            return Err(wrong(why));
        };
        let [width, height] = sides(numbers).ok_or_else(|| wrong(""))?.map(|side| side * mm);
        if ![width, height].iter().all(|side| Self::SIDE_RANGE_MM.contains(side)) {
            return Err(wrong(""));
        }
        Self::new(width, height)
    }
}

/// A text without the unit of length that it ends with, and that unit in mm.
fn with_unit(text: &str) -> Option<(&str, f64)> {
    let units = [("mm", 1.0), ("cm", 10.0), ("in", 25.4)];
    units.iter().find_map(|&(unit, mm)| Some((text.strip_suffix(unit)?, mm)))
}

/// A length with a unit, such as `0.5mm`, in mm.
pub(crate) fn length_mm(text: &str) -> Option<f64> {
    let (number, mm) = with_unit(text)?;
    number.trim().parse().ok().map(|n: f64| n * mm).filter(|l| l.is_finite())
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
        assert!("594x420".parse::<RectangleSize>().unwrap_err().to_string().ends_with("without a unit"));
    }

    #[test]
    fn places_are_named_as_they_are_seen() {
        let sheet = RectangleSize { width_mm: 300.0, height_mm: 200.0 };
        let named = |x: f64, y: f64| sheet.place_in_words(Point2::new(x, y));
        assert_eq!(
            [named(0.0, 0.0), named(150.0, 100.0), named(300.0, 100.0), named(150.0, 200.0)],
            ["top left", "middle", "right", "bottom"]
        );
    }

    #[test]
    fn centimetres_are_recognised() {
        let asked = |w, h| RectangleSize { width_mm: w, height_mm: h }.in_centimetres();
        assert_eq!(asked(59.4, 42.0), Some(RectangleSize { width_mm: 594.0, height_mm: 420.0 }));
        assert!(asked(21.59, 27.94).is_some() && asked(84.1, 118.9).is_some() && asked(60.0, 40.0).is_some());
        assert!(
            asked(594.0, 420.0).is_none() && asked(105.0, 148.0).is_none() && asked(200.0, 100.0).is_none()
        );
    }
}
