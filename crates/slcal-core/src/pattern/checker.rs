//! The checkerboard that calibration needs.

use nalgebra::Point2;
use serde::{Deserialize, Deserializer, Serialize};

use super::marks::PanelMarks;
use super::panel::check_panel;
use crate::error::{Error, ErrorSubject, Result};
use crate::named::named;

/// Colour of a square or of the background.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SquareColor {
    /// No light.
    Black,
    /// Full light.
    White,
}

impl SquareColor {
    fn other(self) -> Self {
        if self == Self::Black { Self::White } else { Self::Black }
    }
}

named!(SquareColor, "colour", { Black => "black", White => "white" });

/// A checkerboard on a projector's panel.
///
/// Columns + rows is odd in every pattern that slcal draws, so that a half-turn changes the colour of the first
/// square and the pattern is not ambiguous.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CheckerPattern {
    /// Width and height of the panel, px.
    pub projector: [u32; 2],
    /// Columns and rows of squares.
    pub squares: [u32; 2],
    /// Side of a square, px.
    pub square_px: f64,
    /// Projector coordinate of the outer top-left corner of the top-left square, px.
    #[serde(deserialize_with = "point")]
    pub origin_px: Point2<f64>,
    /// Colour of the top-left square.
    pub first_square: SquareColor,
    /// Colour around the squares.
    pub background: SquareColor,
    /// Marks at the border of the panel, if there are any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub marks: Option<PanelMarks>,
}

/// Layout of a checkerboard, which is centred on the panel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CheckerConfig {
    /// Columns and rows of squares; their sum must be odd.
    pub squares: [u32; 2],
    /// Side of a square, px; `None`: a sixteenth of the panel's height, or less where that leaves no square's width
    /// around the board.
    pub square_px: Option<f64>,
    /// Colour of the top-left square.
    pub first_square: SquareColor,
    /// Colour around the squares.
    pub background: SquareColor,
    /// Whether small marks stand at the corners of the panel and at the middles of its sides; default false.
    pub marks: bool,
}

impl Default for CheckerConfig {
    fn default() -> Self {
        Self {
            squares: [11, 8],
            square_px: None,
            first_square: SquareColor::Black,
            background: SquareColor::White,
            marks: false,
        }
    }
}

fn point<'de, D: Deserializer<'de>>(from: D) -> std::result::Result<Point2<f64>, D::Error> {
    <[f64; 2]>::deserialize(from).map(Point2::from)
}

/// Fewest squares per side: a homography needs two rows of inner corners.
const MIN_SQUARES: u32 = 3;
/// Smallest square, px: below, its corners cannot be distinguished from the projector's pixels.
const MIN_SQUARE_PX: f64 = 4.0;
/// Background around the board in squares: the outermost squares must be visible as squares.
const MARGIN_SQUARES: f64 = 0.5;

impl CheckerConfig {
    /// Checks what does not depend on the panel.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the field.
    pub fn validate(&self) -> Result<()> {
        let [c, r] = self.squares;
        if c < MIN_SQUARES || r < MIN_SQUARES || c > 1000 || r > 1000 {
            return Err(Error::invalid("squares", "3 to 1000 columns and rows", format!("{c}x{r}")));
        }
        if (c + r).is_multiple_of(2) {
            return Err(Error::invalid(
                "squares",
                "an odd sum of columns and rows (11x8, say): with an even sum the board looks the same after half a turn, \
                 and nobody can tell which corner is the first",
                format!("{c}x{r}"),
            ));
        }
        match self.square_px {
            Some(s) if !(s.is_finite() && s >= MIN_SQUARE_PX) => {
                Err(Error::invalid("square side", format!("at least {MIN_SQUARE_PX} px"), s))
            }
            _ => Ok(()),
        }
    }
}

impl CheckerPattern {
    /// A board in the middle of the panel, its edges on pixel boundaries.
    ///
    /// # Errors
    /// [`Error::Invalid`] for an even sum of columns and rows, a board that does not fit on the panel with half a
    /// square around it, or one that leaves no room for the marks that are asked for.
    ///
    /// # Examples
    /// ```
    /// use slcal_core::{CheckerConfig, CheckerPattern};
    ///
    /// let checker = CheckerPattern::new([1024, 768], &CheckerConfig::default())?;
    /// assert_eq!(checker.inner_corners().len(), 70);
    /// assert_eq!(checker.image()?.dimensions(), (1024, 768)); // what to project
    /// # Ok::<(), slcal_core::Error>(())
    /// ```
    pub fn new(projector: [u32; 2], config: &CheckerConfig) -> Result<Self> {
        check_panel(projector)?;
        config.validate()?;
        let [w, h] = projector.map(f64::from);
        let [columns, rows] = config.squares.map(f64::from);
        let side = config
            .square_px
            .unwrap_or_else(|| (h / 16.0).min(w / (columns + 2.0)).min(h / (rows + 2.0)).floor());
        let most = (w / (columns + 2.0 * MARGIN_SQUARES)).min(h / (rows + 2.0 * MARGIN_SQUARES));
        if side > most || side < MIN_SQUARE_PX {
            return Err(Error::invalid(
                ErrorSubject::Checkerboard,
                format!(
                    "{columns}x{rows} squares of {MIN_SQUARE_PX} to {most:.1} px, so that half a square stays free around them on a panel of {w}x{h} px"
                ),
                format!("squares of {side} px"),
            ));
        }
        let before = Point2::new(((w - columns * side) / 2.0).floor(), ((h - rows * side) / 2.0).floor());
        let marks = config.marks.then(|| PanelMarks::around(projector, before.x.min(before.y), side));
        Ok(Self {
            projector,
            squares: config.squares,
            square_px: side,
            origin_px: before - nalgebra::Vector2::repeat(0.5),
            first_square: config.first_square,
            background: config.background,
            marks: marks.transpose()?,
        })
    }

    /// The same picture with left and right exchanged, as a board of its own: where each of its squares and marks lies on the panel
    /// of a projector that shows pictures mirrored.
    ///
    /// # Examples
    /// ```
    /// use slcal_core::{CheckerConfig, CheckerPattern};
    ///
    /// let checker = CheckerPattern::new([1024, 768], &CheckerConfig { marks: true, ..CheckerConfig::default() })?;
    /// let flipped = image::imageops::flip_horizontal(&checker.image()?);
    /// assert_eq!(checker.mirrored().image()?, flipped);
    /// # Ok::<(), slcal_core::Error>(())
    /// ```
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let right = f64::from(self.projector[0]) - 1.0;
        let [top_left, top_right, ..] = self.outline();
        let last_differs = self.squares[0].is_multiple_of(2);
        Self {
            origin_px: Point2::new(right - top_right.x, top_left.y),
            first_square: if last_differs { self.first_square.other() } else { self.first_square },
            marks: self.marks.as_ref().map(|marks| marks.mirrored(right)),
            ..self.clone()
        }
    }

    /// The inner corner in column `i` and row `j` (0-based), projector px.
    #[must_use]
    pub fn inner_corner(&self, i: u32, j: u32) -> Point2<f64> {
        self.origin_px + nalgebra::Vector2::new(f64::from(i + 1), f64::from(j + 1)) * self.square_px
    }

    /// All inner corners, row-major, projector px: (columns − 1)·(rows − 1) of them.
    #[must_use]
    pub fn inner_corners(&self) -> Vec<Point2<f64>> {
        let [c, r] = self.squares.map(|n| n.saturating_sub(1));
        (0..r).flat_map(|j| (0..c).map(move |i| self.inner_corner(i, j))).collect()
    }

    /// The outer corners TL, TR, BR, BL of the board, projector px.
    #[must_use]
    pub fn outline(&self) -> [Point2<f64>; 4] {
        let [w, h] = self.squares.map(|n| f64::from(n) * self.square_px);
        let o = self.origin_px;
        [o, Point2::new(o.x + w, o.y), Point2::new(o.x + w, o.y + h), Point2::new(o.x, o.y + h)]
    }

    /// Whether the board looks the same after half a turn (columns + rows is even): patterns from elsewhere may.
    #[must_use]
    pub fn half_turn_ambiguous(&self) -> bool {
        (self.squares[0] ^ self.squares[1]).is_multiple_of(2)
    }

    /// Checks that the fields agree with each other. Boards from elsewhere may be ambiguous and lie anywhere on the
    /// panel.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the field, what it holds and what it should.
    pub fn validate(&self) -> Result<()> {
        check_panel(self.projector)?;
        let [c, r] = self.squares;
        if c < 2 || r < 2 || c > 1000 || r > 1000 {
            return Err(Error::invalid("squares", "2 to 1000 columns and rows", format!("{c}x{r}")));
        }
        if !(self.square_px.is_finite() && self.square_px > 0.0) {
            return Err(Error::invalid("square_px", "a positive length", self.square_px));
        }
        let [w, h] = self.projector.map(f64::from);
        let [tl, _, br, _] = self.outline();
        // Tolerance for rounding in other generators, such as 0.1 + 0.2.
        let slack = 1e-6 * (w + h) - 0.5;
        if !(tl.x >= -1.0 - slack && tl.y >= -1.0 - slack && br.x <= w + slack && br.y <= h + slack) {
            return Err(Error::invalid(
                "origin_px",
                format!("a board inside the panel of {w}x{h} px"),
                format!("corners from ({}, {}) to ({}, {})", tl.x, tl.y, br.x, br.y),
            ));
        }
        self.marks.as_ref().map_or(Ok(()), |marks| marks.validate(self.projector))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_the_board_of_the_rendered_scenes() {
        let p = CheckerPattern::new([1024, 768], &CheckerConfig::default()).unwrap();
        assert_eq!((p.squares, p.square_px), ([11, 8], 48.0));
        assert_eq!(p.origin_px, Point2::new(247.5, 191.5));
        assert_eq!((p.first_square, p.background), (SquareColor::Black, SquareColor::White));
        assert_eq!(p.inner_corner(0, 0), Point2::new(295.5, 239.5));
        assert_eq!(p.inner_corners().len(), 70);
        assert_eq!(p.inner_corners()[10], p.inner_corner(0, 1));
        assert!(!p.half_turn_ambiguous());
        p.validate().unwrap();
    }

    #[test]
    fn common_panels_get_a_board_on_whole_pixels_with_room_around_it() {
        for panel in
            [[640, 360], [854, 480], [1280, 800], [1920, 1080], [3840, 2160], [912, 1140], [480, 854]]
        {
            let p = CheckerPattern::new(panel, &CheckerConfig::default()).unwrap();
            p.validate().unwrap();
            assert_eq!((p.origin_px.x + 0.5).fract(), 0.0);
            let [tl, _, br, _] = p.outline();
            let room = tl.x.min(tl.y).min(f64::from(panel[0]) - br.x).min(f64::from(panel[1]) - br.y);
            assert!(room >= p.square_px / 2.0 - 1.0, "{panel:?}: {room}");
        }
    }

    #[test]
    fn impossible_boards_are_refused_with_a_reason() {
        let with = |squares, square_px| {
            let config = CheckerConfig { squares, square_px, ..CheckerConfig::default() };
            CheckerPattern::new([1024, 768], &config).map_err(|e| e.to_string())
        };
        assert!(with([10, 8], None).unwrap_err().contains("half a turn"));
        assert!(with([11, 8], Some(100.0)).unwrap_err().contains("85.3"));
        assert!(with([11, 8], Some(f64::NAN)).is_err());
        assert!(with([0, 7], None).is_err());
        assert!(with([501, 400], None).is_err());
        assert!(CheckerPattern::new([0, 0], &CheckerConfig::default()).is_err());
    }
}
