//! The checkerboard that calibration needs.

use nalgebra::Point2;
use serde::{Deserialize, Serialize};

/// Colour of a square or of the background.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SquareColor {
    /// No light.
    Black,
    /// Full light.
    White,
}

/// A checkerboard on a projector's panel.
///
/// Columns + rows is odd in every pattern that slcal draws, so that a half-turn changes the colour of the first
/// square and the pattern is not ambiguous.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckerPattern {
    /// Width and height of the panel, px.
    pub projector: [u32; 2],
    /// Columns and rows of squares.
    pub squares: [u32; 2],
    /// Side of a square, px.
    pub square_px: f64,
    /// Projector coordinate of the outer top-left corner of the top-left square, px.
    pub origin_px: Point2<f64>,
    /// Colour of the top-left square.
    pub first_square: SquareColor,
    /// Colour around the squares.
    pub background: SquareColor,
}

impl CheckerPattern {
    /// The inner corner in column `i` and row `j` (0-based), projector px.
    #[must_use]
    pub fn inner_corner(&self, i: u32, j: u32) -> Point2<f64> {
        self.origin_px + nalgebra::Vector2::new(f64::from(i + 1), f64::from(j + 1)) * self.square_px
    }

    /// The outer corners TL, TR, BR, BL of the board, projector px.
    #[must_use]
    pub fn outline(&self) -> [Point2<f64>; 4] {
        let [w, h] = self.squares.map(|n| f64::from(n) * self.square_px);
        let o = self.origin_px;
        [o, Point2::new(o.x + w, o.y), Point2::new(o.x + w, o.y + h), Point2::new(o.x, o.y + h)]
    }
}
