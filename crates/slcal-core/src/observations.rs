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

impl ViewObservation {
    /// Coordinates beyond this are no pixels; their products would overflow.
    pub const MAX_COORDINATE_PX: f64 = 1e9;
    /// σ outside of this range are mistakes; their squares would overflow.
    pub const SIGMA_RANGE_PX: std::ops::RangeInclusive<f64> = 1e-9..=1e6;
    /// Sides of a sheet, mm: outside of it a unit was mistaken.
    pub const SIDE_RANGE_MM: std::ops::RangeInclusive<f64> = RectangleSize::SIDE_RANGE_MM;
    /// Stands for a σ that is unstated.
    pub const UNSTATED_SIGMA_PX: f64 = 1.0;
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

/// Which σ of one view its source did not state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Unstated {
    /// That of the sheet's edge points or corners.
    pub sheet: bool,
    /// That of the pairs.
    pub pairs: bool,
}

/// Observations from a detector of one's own, which may not know its noise: see
/// [`calibrate_external`](crate::calibrate_external).
#[derive(Debug, Clone, PartialEq)]
pub struct ExternalObservations {
    /// What was seen. A σ that is unstated stands as any positive number, which nothing depends on.
    pub observations: Observations,
    /// One entry per view; missing entries mean that everything is stated.
    pub unstated: Vec<Unstated>,
    /// Name of each view's photograph, where it has one.
    pub photos: Vec<Option<String>>,
}

impl From<Observations> for ExternalObservations {
    /// Observations with every σ stated and no names.
    fn from(observations: Observations) -> Self {
        Self { observations, unstated: Vec::new(), photos: Vec::new() }
    }
}

impl ExternalObservations {
    /// What view `i` leaves unstated.
    #[must_use]
    pub fn unstated(&self, i: usize) -> Unstated {
        self.unstated.get(i).copied().unwrap_or_default()
    }
}
