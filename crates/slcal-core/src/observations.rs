//! What was seen of the sheet and the pattern: the hand-over from `detect` to `calibrate`.

use nalgebra::Point2;

use crate::geometry::{Line, RectangleSize};

/// A sub-pixel point on the image of one side of the sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgePoint {
    /// Position in the camera image, px.
    pub position: Point2<f64>,
    /// Standard deviation across the side, px, such that the points of a side may be treated as independent:
    /// whoever measures correlated points widens their σ accordingly.
    pub sigma_px: f64,
}

/// How the sheet was observed.
#[derive(Debug, Clone, PartialEq)]
pub enum SheetObservation {
    /// Edge points on the top, right, bottom and left side (any number ≥ 2 per side; corners need not be visible).
    Edges([Vec<EdgePoint>; 4]),
    /// The corners TL, TR, BR, BL, px, each with the same standard deviation along x and y.
    Corners {
        /// TL, TR, BR, BL, px; may lie outside the frame.
        corners: [Point2<f64>; 4],
        /// 1σ per coordinate, px.
        sigma_px: f64,
    },
}

impl SheetObservation {
    /// The corners TL, TR, BR, BL: given, or the meets of the lines fitted to the edges. `None` when a side has too
    /// few points for a line or neighbouring sides are parallel.
    #[must_use]
    pub fn corners(&self) -> Option<[Point2<f64>; 4]> {
        match self {
            Self::Corners { corners, .. } => Some(*corners),
            Self::Edges(sides) => {
                let mut lines = [Line(nalgebra::Vector3::zeros()); 4];
                for (line, points) in lines.iter_mut().zip(sides) {
                    *line = Line::fit(points.iter().map(|p| (p.position, p.sigma_px.powi(-2))))?;
                }
                let [top, right, bottom, left] = lines;
                Some([
                    left.meet(top).pixel()?,
                    top.meet(right).pixel()?,
                    right.meet(bottom).pixel()?,
                    bottom.meet(left).pixel()?,
                ])
            }
        }
    }
}

/// A point of the projected pattern: its projector pixel is known exactly, its camera pixel was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerPair {
    /// Measured in the camera image, px.
    pub camera: Point2<f64>,
    /// Drawn in the projector image, px; exact.
    pub projector: Point2<f64>,
    /// 1σ of each camera coordinate, px.
    pub sigma_px: f64,
}

/// One pose of the sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewObservation {
    /// Size of the sheet.
    pub size: RectangleSize,
    /// Its outline in the camera image.
    pub sheet: SheetObservation,
    /// The projected points seen on it; empty when nothing was projected.
    pub pairs: Vec<CornerPair>,
}

/// Everything that a calibration is computed from.
#[derive(Debug, Clone, PartialEq)]
pub struct Observations {
    /// Width and height of the camera image, px.
    pub camera: [u32; 2],
    /// Width and height of the projector panel, px; `None` to calibrate the camera alone.
    pub projector: Option<[u32; 2]>,
    /// One entry per pose.
    pub views: Vec<ViewObservation>,
}
