//! What `detect` measures in photographs, and `calibrate` estimates from.

use nalgebra::{Point2, Vector2};

use crate::channel_registration::RedBlue;
use crate::geometry::{Line, RectangleSize};

/// Stands for a σ that is not known where only the ratios of weights matter.
pub(crate) const UNKNOWN_SIGMA_PX: f64 = 1.0;

/// A sub-pixel point on the image of one side of the sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgePoint {
    /// Position in the camera image, px.
    pub position: Point2<f64>,
    /// 1σ across the side, px; `None` where it is not known. The points of a side are treated as independent: the σ of
    /// correlated points must be widened accordingly.
    pub sigma_px: Option<f64>,
}

impl EdgePoint {
    /// The position with its weight 1/σ²; points of unknown σ weigh alike.
    pub(crate) fn weighted(&self) -> (Point2<f64>, f64) {
        (self.position, self.sigma_px.unwrap_or(UNKNOWN_SIGMA_PX).powi(-2))
    }
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
        /// 1σ per coordinate, px; `None` where it is not known.
        sigma_px: Option<f64>,
    },
}

impl SheetObservation {
    /// The corners TL, TR, BR, BL: given, or the intersections of the lines fitted to the edges. `None` when a side has too
    /// few points for a line or neighbouring sides are parallel.
    #[must_use]
    pub fn corners(&self) -> Option<[Point2<f64>; 4]> {
        match self {
            Self::Corners { corners, .. } => Some(*corners),
            Self::Edges(sides) => {
                let mut lines = [Line(nalgebra::Vector3::zeros()); 4];
                for (line, points) in lines.iter_mut().zip(sides) {
                    *line = Line::fit(points.iter().map(EdgePoint::weighted))?;
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

/// A point of the projected pattern: its projector pixel is known exactly, its camera pixel was measured. Of a sequence it is the other way
/// round, and the uncertainty of the projector pixel is stated as that of the camera pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerPair {
    /// Measured in the camera image, px.
    pub camera: Point2<f64>,
    /// Drawn in the projector image, px; exact.
    pub projector: Point2<f64>,
    /// 1σ of each camera coordinate, px; `None` where it is not known.
    pub sigma_px: Option<f64>,
}

impl Observations {
    /// What the camera alone is calibrated from.
    pub(crate) fn of_camera(&self) -> Self {
        Self { projector: None, ..self.clone() }
    }
}

/// Where something is seen whose place on the panel is known when the picture is shown pixel for pixel and full screen: a point
/// on the border of the projector's light, which is the panel's own, or the middle of a mark.
///
/// A calibration is not computed from these points. They test whether the picture was shown as it was drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PanelPoint {
    /// Measured in the camera image, px.
    pub camera: Point2<f64>,
    /// Where it is expected on the panel, px: both coordinates of a mark; the x of a left or right border, the y of an upper
    /// or lower one.
    pub expected: [Option<f64>; 2],
    /// 1σ in the camera image, px: of each coordinate of a mark, across a border; `None` where it is not known.
    pub sigma_px: Option<f64>,
}

impl PanelPoint {
    /// Whether the point can be used: a finite place in the camera image, a place on the panel, and a σ in
    /// [`ViewObservation::SIGMA_RANGE_PX`] if any.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let limit = ViewObservation::MAX_COORDINATE_PX;
        let mut known = self.expected.iter().flatten().peekable();
        known.peek().is_some()
            && known.chain(self.camera.iter()).all(|x| x.abs() <= limit)
            && self.sigma_px.is_none_or(|s| ViewObservation::SIGMA_RANGE_PX.contains(&s))
    }
}

/// How far the red and the blue light of a corner of the projected checkerboard lie from its green light in the photograph.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelOffset {
    /// The corner in the camera image, px.
    pub camera: Point2<f64>,
    /// The corner on the panel, px.
    pub projector: Point2<f64>,
    /// From green, px of the camera image.
    pub offset_px: RedBlue<Vector2<f64>>,
    /// 1σ of each of its coordinates, px.
    pub sigma_px: RedBlue<f64>,
}

impl ChannelOffset {
    /// Whether it can be used: coordinates that are finite, and σ in [`ViewObservation::SIGMA_RANGE_PX`].
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let RedBlue { red, blue } = self.offset_px;
        let numbers = [self.camera.coords, self.projector.coords, red, blue];
        numbers.iter().flat_map(|v| v.iter()).all(|x| x.abs() <= ViewObservation::MAX_COORDINATE_PX)
            && [self.sigma_px.red, self.sigma_px.blue]
                .iter()
                .all(|s| ViewObservation::SIGMA_RANGE_PX.contains(s))
    }
}

/// One pose of the sheet. Its sheet and its pairs each state their σ for all points or for none.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewObservation {
    /// Name of the photograph, where it has one.
    pub photo: Option<String>,
    /// Size of the sheet.
    pub size: RectangleSize,
    /// Its outline in the camera image.
    pub sheet: SheetObservation,
    /// The projected points seen on it; empty when nothing was projected.
    pub pairs: Vec<CornerPair>,
    /// What is seen on it of the border of the projector's light and of marks; usually nothing.
    pub panel_points: Vec<PanelPoint>,
    /// How red and blue are displaced against green at the projected points; empty where the photograph has no colour.
    pub channel_offsets: Vec<ChannelOffset>,
}

impl ViewObservation {
    /// Largest coordinate, px: beyond it products would overflow.
    pub const MAX_COORDINATE_PX: f64 = 1e9;
    /// Valid σ, px: outside of it squares would overflow.
    pub const SIGMA_RANGE_PX: std::ops::RangeInclusive<f64> = 1e-9..=1e6;
    /// Valid sides of a sheet, mm.
    pub const SIDE_RANGE_MM: std::ops::RangeInclusive<f64> = RectangleSize::SIDE_RANGE_MM;

    /// 1σ of every point of the sheet.
    pub(crate) fn sheet_sigmas(&self) -> impl Iterator<Item = Option<f64>> {
        let (sides, corners) = match &self.sheet {
            SheetObservation::Edges(sides) => (Some(sides), None),
            SheetObservation::Corners { sigma_px, .. } => (None, Some(*sigma_px)),
        };
        sides.into_iter().flatten().flatten().map(|p| p.sigma_px).chain(corners)
    }

    /// Replaces every σ of the sheet and of the pairs.
    pub(crate) fn map_sigma(
        &mut self,
        sheet: impl Fn(Option<f64>) -> Option<f64>,
        pairs: impl Fn(Option<f64>) -> Option<f64>,
    ) {
        match &mut self.sheet {
            SheetObservation::Edges(sides) => {
                sides.iter_mut().flatten().for_each(|p| p.sigma_px = sheet(p.sigma_px));
            }
            SheetObservation::Corners { sigma_px, .. } => *sigma_px = sheet(*sigma_px),
        }
        self.pairs.iter_mut().for_each(|p| p.sigma_px = pairs(p.sigma_px));
    }

    /// Whether the σ of the sheet's points is known.
    #[must_use]
    pub fn states_sheet_sigma(&self) -> bool {
        self.sheet_sigmas().all(|s| s.is_some())
    }

    /// Whether the σ of the pairs is known.
    #[must_use]
    pub fn states_pair_sigma(&self) -> bool {
        self.pairs.iter().all(|p| p.sigma_px.is_some())
    }
}

/// Everything that a calibration is computed from.
#[derive(Debug, Clone, PartialEq)]
pub struct Observations {
    /// Width and height of the camera image, px.
    pub camera: [u32; 2],
    /// Width and height of the projector panel, px; `None` to calibrate the camera alone.
    pub projector: Option<[u32; 2]>,
    /// Whether pictures appear with left and right exchanged. Projector px are those of the panel, where column c of a picture counts
    /// as width − 1 − c.
    pub mirrored: bool,
    /// One entry per pose.
    pub views: Vec<ViewObservation>,
}
