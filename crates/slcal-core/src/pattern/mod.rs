//! Projected patterns: checkerboards and De Bruijn stripes, and their rendering.

mod checker;
mod de_bruijn;
mod draw;
mod marks;
mod panel;
mod stripes;

use image::RgbImage;
use serde::Serialize;

use crate::error::Result;

pub use checker::{CheckerConfig, CheckerPattern, SquareColor};
public_with! { "stages": pub use de_bruijn::{de_bruijn, unique_window}; }
pub(crate) use draw::warp_image;
pub use marks::PanelMarks;
pub use stripes::{Axis, StripeConfig, StripePattern};

/// Either kind of pattern.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Pattern {
    /// A checkerboard, for calibration.
    Checker(CheckerPattern),
    /// Stripes, for reconstruction.
    Stripes(StripePattern),
}

impl Pattern {
    /// Width and height of the panel, px.
    #[must_use]
    pub fn projector(&self) -> [u32; 2] {
        match self {
            Self::Checker(p) => p.projector,
            Self::Stripes(p) => p.projector,
        }
    }

    /// The picture to project.
    ///
    /// # Errors
    /// As [`CheckerPattern::image`] and [`StripePattern::image`].
    pub fn image(&self) -> Result<RgbImage> {
        match self {
            Self::Checker(p) => p.image(),
            Self::Stripes(p) => p.image(),
        }
    }
}
