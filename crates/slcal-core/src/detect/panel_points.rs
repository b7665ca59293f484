//! What shows where the panel ends: the border of the projector's light on the sheet, and marks.

use super::board::Board;
use super::light_border::{self, LightBorder, PanelSide};
use super::marks;
use super::panel_view::PanelView;
use super::projector_footprint::ProjectorFootprint;
use crate::observations::{PanelPoint, SheetObservation};
use crate::pattern::CheckerPattern;
use crate::photo::LinearPhoto;

/// A border further from its expected place than this part of the panel's side is elsewhere: the board's homography predicts it
/// better.
const MOVED: f64 = 0.005;

/// What was found of the panel's border.
#[derive(Debug, Clone, Default)]
pub(super) struct PanelBorder {
    pub(super) borders: Vec<LightBorder>,
    pub(super) points: Vec<PanelPoint>,
}

impl PanelBorder {
    /// In a photograph with the pattern, on the sheet that was found.
    pub(super) fn find(
        photo: &LinearPhoto<'_>,
        board: &Board,
        pattern: &CheckerPattern,
        sheet: &SheetObservation,
    ) -> Self {
        let Some(view) = sheet.corners().and_then(|corners| PanelView::new(photo, board, corners)) else {
            return Self::default();
        };
        let borders = light_border::find(&view, pattern);
        let mut points: Vec<PanelPoint> = borders.iter().flat_map(|b| of_border(b, pattern)).collect();
        points.extend(marks::find(&view, pattern, &borders));
        Self { borders, points }
    }

    /// The footprint that ends at the borders that were seen, if any of them is not where it was expected.
    pub(super) fn moved_footprint(
        &self,
        board: &Board,
        pattern: &CheckerPattern,
    ) -> Option<ProjectorFootprint> {
        let mut coordinates = PanelSide::ALL.map(|side| side.coordinate(pattern.projector));
        let mut moved = false;
        for (coordinate, side) in coordinates.iter_mut().zip(PanelSide::ALL) {
            if let Some(border) = self.borders.iter().find(|b| b.side == side) {
                let limit = MOVED * f64::from(pattern.projector[side.axis]);
                moved |= (border.coordinate - *coordinate).abs() > limit;
                *coordinate = border.coordinate;
            }
        }
        moved.then(|| ProjectorFootprint::between(&board.undistorted_from_projector, coordinates))
    }
}

fn of_border(border: &LightBorder, pattern: &CheckerPattern) -> impl Iterator<Item = PanelPoint> {
    let mut expected = [None; 2];
    expected[border.side.axis] = Some(border.side.coordinate(pattern.projector));
    let sigma_px = Some(border.sigma_px);
    border.points.iter().map(move |&camera| PanelPoint { camera, expected, sigma_px })
}
