//! Correspondences of every camera pixel with the projector's panel: the result of decoding a sequence.

use std::fmt;

use nalgebra::Point2;

use crate::matches::{Match, Matches};

/// The projector coordinates of every camera pixel, row by row; NaN where a pixel has none.
#[derive(Clone, PartialEq, Default)]
pub struct DenseMatches {
    /// Width of the camera's image, px.
    pub width: usize,
    /// Its height, px.
    pub height: usize,
    /// Projector column of each pixel, px; empty when columns are not coded.
    pub column: Vec<f32>,
    /// 1σ of it, panel px.
    pub sigma_column: Vec<f32>,
    /// Projector row of each pixel, px; empty when rows are not coded.
    pub row: Vec<f32>,
    /// 1σ of it, panel px.
    pub sigma_row: Vec<f32>,
    /// Between 0 and 1 for each pixel.
    pub confidence: Vec<f32>,
    /// Colour of each pixel under white light, sRGB; empty when no white picture was shown.
    pub color: Vec<[u8; 3]>,
}

/// The size and how much is known; millions of numbers help nobody.
impl fmt::Debug for DenseMatches {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = f.debug_struct("DenseMatches");
        shown.field("width", &self.width).field("height", &self.height).field("known", &self.known());
        shown.finish_non_exhaustive()
    }
}

impl DenseMatches {
    /// Whether a pixel has a column, a row, or both.
    #[must_use]
    pub fn is_known(&self, pixel: usize) -> bool {
        let known = |of: &[f32]| of.get(pixel).is_some_and(|x| x.is_finite());
        known(&self.column) || known(&self.row)
    }

    /// Number of pixels with a column, a row, or both.
    #[must_use]
    pub fn known(&self) -> usize {
        match (self.column.is_empty(), self.row.is_empty()) {
            (_, true) => self.column.iter().filter(|c| c.is_finite()).count(),
            (true, _) => self.row.iter().filter(|r| r.is_finite()).count(),
            _ => self.column.iter().zip(&self.row).filter(|(c, r)| c.is_finite() | r.is_finite()).count(),
        }
    }

    /// The same as a list without gaps. `sigma_px` of a [`Match`] is in camera px; here it is that of the panel's coordinate, as if camera and
    /// projector had the same resolution on the surface. [`cloud_from_dense_matches`](crate::cloud_from_dense_matches) uses the σ of each
    /// coordinate instead.
    #[must_use]
    pub fn to_matches(&self) -> Matches {
        let value = |of: &[f32], i: usize| of.get(i).copied().filter(|x| x.is_finite()).map(f64::from);
        let items = (0..self.width * self.height).filter(|i| self.is_known(*i)).map(|i| Match {
            camera: Point2::new((i % self.width) as f64, (i / self.width) as f64),
            projector_column: value(&self.column, i),
            projector_row: value(&self.row, i),
            slit: None,
            confidence: self.confidence.get(i).map_or(1.0, |c| f64::from(*c)),
            sigma_px: value(&self.sigma_column, i)
                .or(value(&self.sigma_row, i))
                .unwrap_or(Match::DEFAULT_SIGMA_PX),
            color: self.color.get(i).copied().unwrap_or([255; 3]),
        });
        Matches { items: items.collect() }
    }
}
