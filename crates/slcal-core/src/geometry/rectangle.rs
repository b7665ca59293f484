//! The sheet: a rectangle of known size.

use std::fmt;
use std::ops::RangeInclusive;

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

    /// Shorter and longer side, mm.
    pub(crate) fn short_and_long_mm(&self) -> [f64; 2] {
        [self.width_mm.min(self.height_mm), self.width_mm.max(self.height_mm)]
    }

    /// Longer side over shorter side.
    pub(crate) fn elongation(&self) -> f64 {
        let [short, long] = self.short_and_long_mm();
        long / short
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_named_as_they_are_seen() {
        let sheet = RectangleSize { width_mm: 300.0, height_mm: 200.0 };
        let named = |x: f64, y: f64| sheet.place_in_words(Point2::new(x, y));
        assert_eq!(
            [named(0.0, 0.0), named(150.0, 100.0), named(300.0, 100.0), named(150.0, 200.0)],
            ["top left", "middle", "right", "bottom"]
        );
    }
}
