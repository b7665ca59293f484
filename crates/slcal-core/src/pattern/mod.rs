//! Projected patterns: checkerboards, De Bruijn stripes, sequences of Gray code and sinusoids, and their rendering.

mod checker;
mod de_bruijn;
mod draw;
mod frame_order;
mod marks;
mod panel;
mod sequence;
mod stripes;

use image::{DynamicImage, RgbImage};
use serde::Serialize;

use crate::error::Result;

pub use checker::{CheckerConfig, CheckerPattern, SquareColor};
public_with! { "stages": pub use de_bruijn::{de_bruijn, unique_window}; }
pub(crate) use draw::warp_image;
pub use frame_order::natural_order;
pub use marks::PanelMarks;
#[cfg(test)]
pub(crate) use sequence::gray_code;
pub use sequence::{
    AxisCode, FrameLight, SequenceAxes, SequenceConfig, SequenceFrame, SequencePattern, SequencePreset,
    SinusoidConfig,
};
pub use stripes::{Axis, StripeConfig, StripePattern};

/// A pattern of any kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Pattern {
    /// A checkerboard, for calibration.
    Checker(CheckerPattern),
    /// Stripes, for reconstruction.
    Stripes(StripePattern),
    /// Pictures that are shown one after another, for both.
    Sequence(SequencePattern),
}

impl Pattern {
    /// Width and height of the panel, px.
    #[must_use]
    pub fn projector(&self) -> [u32; 2] {
        match self {
            Self::Checker(p) => p.projector,
            Self::Stripes(p) => p.projector,
            Self::Sequence(p) => p.projector,
        }
    }

    /// Its kind, as files name it.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Checker(_) => "checker",
            Self::Stripes(_) => "stripes",
            Self::Sequence(_) => "sequence",
        }
    }

    /// The picture to project; of a sequence, the first one.
    ///
    /// # Errors
    /// As [`CheckerPattern::image`], [`StripePattern::image`] and [`SequencePattern::image`].
    pub fn image(&self) -> Result<RgbImage> {
        match self {
            Self::Checker(p) => p.image(),
            Self::Stripes(p) => p.image(),
            Self::Sequence(p) => Ok(DynamicImage::ImageLuma8(p.image(0)?).into_rgb8()),
        }
    }
}
