//! The ground truth of every pixel of a simulated photograph.

use nalgebra::{Point2, Point3};

/// The ground truth at the centre of a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelTruth {
    /// The point, camera frame, mm.
    pub point: Point3<f64>,
    /// The panel position whose light falls there, projector px; `None` in shadow and outside the projector footprint.
    pub panel: Option<Point2<f64>>,
    /// Index of the surface, from zero.
    pub surface: usize,
}

/// The ground truth of a photograph, pixel by pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Row-major.
    pub(super) pixels: Vec<StoredTruth>,
}

/// [`PixelTruth`] in less memory, and with the irradiance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StoredTruth {
    pub(super) point: [f64; 3],
    /// NaN where no light of the projector falls.
    pub(super) panel: [f64; 2],
    /// Cosine of the angle at which the projector's light falls in over the square of its way, 1/mm².
    pub(super) irradiance: f32,
    /// [`NOTHING`] where no surface is seen.
    pub(super) surface: u32,
}

/// The index of no surface.
pub(super) const NOTHING: u32 = u32::MAX;

impl StoredTruth {
    pub(super) const EMPTY: Self =
        Self { point: [f64::NAN; 3], panel: [f64::NAN; 2], irradiance: 0.0, surface: NOTHING };

    pub(super) fn is_lit(&self) -> bool {
        !self.panel[0].is_nan()
    }

    fn seen(&self) -> Option<PixelTruth> {
        (self.surface != NOTHING).then(|| PixelTruth {
            point: Point3::from(self.point),
            panel: self.is_lit().then(|| Point2::from(self.panel)),
            surface: self.surface as usize,
        })
    }
}

impl Truth {
    /// Width of the photograph, px.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height of the photograph, px.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// The ground truth at the centre of a pixel; `None` where there is no surface, and outside the photograph.
    #[must_use]
    pub fn at(&self, x: usize, y: usize) -> Option<PixelTruth> {
        self.pixel(x, y).and_then(StoredTruth::seen)
    }

    /// The same for all pixels, row by row.
    pub fn pixels(&self) -> impl Iterator<Item = Option<PixelTruth>> + '_ {
        self.pixels.iter().map(StoredTruth::seen)
    }

    /// How many pixels the projector's light reaches.
    #[must_use]
    pub fn lit(&self) -> usize {
        self.pixels.iter().filter(|p| p.is_lit()).count()
    }

    pub(super) fn pixel(&self, x: usize, y: usize) -> Option<&StoredTruth> {
        if x < self.width { self.pixels.get(y * self.width + x) } else { None }
    }
}
