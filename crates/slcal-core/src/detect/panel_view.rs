//! The photograph as the projector's panel sees it: the light of the sheet at a position of the panel.

use nalgebra::{Point2, Vector3};

use super::board::Board;
use crate::geometry::{Homography, Line};
use crate::pattern::{CheckerPattern, SquareColor};
use crate::photo::LinearPhoto;

/// What is nearer to a side of the sheet than this part of the frame's diagonal is left out: the side's blur, and how far a side
/// that a lens or a bend has curved may lie from the line between its corners.
const MARGIN: f64 = 0.006;

/// A photograph of the sheet with the pattern on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct PanelView<'a> {
    photo: &'a LinearPhoto<'a>,
    board: &'a Board,
    /// The sides of the sheet, undistorted, positive inside, shifted inwards by the margin.
    sides: [Line; 4],
}

impl<'a> PanelView<'a> {
    /// `None` where a side of the sheet has no length.
    pub(super) fn new(
        photo: &'a LinearPhoto<'a>,
        board: &'a Board,
        corners: [Point2<f64>; 4],
    ) -> Option<Self> {
        let corners = corners.map(|c| board.lens.undistort(c));
        let margin = MARGIN * (photo.width() as f64).hypot(photo.height() as f64);
        let mut sides = [Line(Vector3::zeros()); 4];
        for (i, side) in sides.iter_mut().enumerate() {
            let line = Line::through_pixels(corners[i], corners[(i + 1) % 4]).normalized()?;
            let inside = line.signed_distance_px(corners[(i + 2) % 4]).signum();
            *side = Line(line.0 * inside - Vector3::new(0.0, 0.0, margin));
        }
        Some(Self { photo, board, sides })
    }

    /// Where a position of the panel falls in the photograph; `None` beside the sheet.
    pub(super) fn camera(&self, panel: Point2<f64>) -> Option<Point2<f64>> {
        let Homography(h) = self.board.undistorted_from_projector;
        let seen = h * Vector3::new(panel.x, panel.y, 1.0);
        let seen = Point2::from(seen.xy() / Some(seen.z).filter(|z| *z > 0.0)?);
        let on_sheet = self.sides.iter().all(|side| side.signed_distance_px(seen) > 0.0);
        on_sheet.then(|| self.board.lens.distort(seen))
    }

    /// The light there; `None` beside the sheet or the frame.
    pub(super) fn light(&self, panel: Point2<f64>) -> Option<f64> {
        self.photo.bilinear(self.camera(panel)?)
    }

    /// Camera px per panel px at a position, along x and along y.
    pub(super) fn scale(&self, panel: Point2<f64>) -> [f64; 2] {
        let jacobian = self.board.undistorted_from_projector.jacobian(panel);
        [0, 1].map(|k| jacobian.column(k).norm())
    }

    /// The light of the sheet under black and under white squares: medians over those that are seen.
    pub(super) fn levels(&self, pattern: &CheckerPattern) -> Option<[f64; 2]> {
        let [columns, rows] = pattern.squares;
        let mut levels = [Vec::new(), Vec::new()];
        for (i, j) in (0..columns).flat_map(|i| (0..rows).map(move |j| (i, j))) {
            let white = (i + j).is_multiple_of(2) == (pattern.first_square == SquareColor::White);
            let middle = pattern.inner_corner(i, j) - nalgebra::Vector2::repeat(0.5 * pattern.square_px);
            levels[usize::from(white)].extend(self.light(middle));
        }
        let [mut black, mut white] = levels;
        Some([crate::solve::median(&mut black)?, crate::solve::median(&mut white)?])
    }
}
