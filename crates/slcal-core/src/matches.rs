//! Correspondences between camera pixels and projector coordinates: the result of `decode` (or of any other decoder), and the
//! input of `reconstruct`.

use nalgebra::Point2;

/// One correspondence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Match {
    /// Camera pixel (u, v); sub-pixel across the stripe, integer along it.
    pub camera: Point2<f64>,
    /// Projector column, px, where it is known.
    pub projector_column: Option<f64>,
    /// Projector row, px, where it is known.
    pub projector_row: Option<f64>,
    /// Index of the slit, when the match comes from stripes.
    pub slit: Option<u16>,
    /// Between 0 and 1.
    pub confidence: f64,
    /// 1σ of the camera position across the stripe, px.
    pub sigma_px: f64,
    /// Colour of the photograph there, sRGB.
    pub color: [u8; 3],
}

impl Match {
    /// 1σ of the camera position, px, where it is not stated.
    pub const DEFAULT_SIGMA_PX: f64 = 0.1;

    /// The match of a pixel with a projector column, a row, or both, from no decoder.
    #[must_use]
    pub fn at(camera: Point2<f64>, projector_column: Option<f64>, projector_row: Option<f64>) -> Self {
        Self {
            camera,
            projector_column,
            projector_row,
            slit: None,
            confidence: 1.0,
            sigma_px: Self::DEFAULT_SIGMA_PX,
            color: [255; 3],
        }
    }
}

/// A set of correspondences, ordered by image row (column for row patterns), then by position.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Matches {
    /// The correspondences.
    pub items: Vec<Match>,
}
