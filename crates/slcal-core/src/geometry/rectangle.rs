//! The sheet: a rectangle of known size.

use nalgebra::Point2;
use serde::{Deserialize, Serialize};

use super::Line;
use crate::error::{Error, ErrorSubject, Result};

/// Width (along the image's x axis as the camera sees it) and height of a rectangle, mm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RectangleSize {
    /// Length of the top side, mm.
    pub width_mm: f64,
    /// Length of the left side, mm.
    pub height_mm: f64,
}

/// The sides of the sheet in the order in which they are listed everywhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
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
    pub const ALL: [Self; 4] = [Self::Top, Self::Right, Self::Bottom, Self::Left];
}

impl RectangleSize {
    /// A rectangle of positive, finite size.
    ///
    /// # Errors
    /// [`Error::Invalid`] for zero, negative or non-finite lengths.
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

    /// The sides as lines on the sheet, in the order of [`Side::ALL`].
    #[must_use]
    pub fn sides(&self) -> [Line; 4] {
        let c = self.corners();
        std::array::from_fn(|i| Line::through_pixels(c[i], c[(i + 1) % 4]))
    }

    /// The same sheet turned by a quarter.
    #[must_use]
    pub fn transposed(&self) -> Self {
        Self { width_mm: self.height_mm, height_mm: self.width_mm }
    }
}
