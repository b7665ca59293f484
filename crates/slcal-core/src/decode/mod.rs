//! Photograph of stripes → [`crate::Matches`]: which slit lights which pixel.
//!
//! Lines across the stripes are read one by one (`lines`); a second-derivative filter whose width is measured
//! (`width`) finds the stripes on them and their edges give the centre to sub-pixel (`peaks`); hues are learned from
//! the photograph (`color`); dynamic programming assigns slits along each line (`align`); peaks linked from line to
//! line into curves vote (`curves`).

mod align;
mod color;
mod config;
mod curves;
mod lines;
mod noise;
mod peaks;
mod recognise;
mod stages;
#[cfg(test)]
mod tests;
mod width;

pub use config::{DecodeConfig, DecodeInput, DecodeReport, Decoding, Dropped};

use crate::error::Result;
use crate::pattern::StripePattern;
use crate::photo::PhotoView;

/// Finds the stripes of a photograph and says which slit each is.
///
/// # Errors
/// [`crate::Error::Invalid`] for a greyscale photograph, frames of different sizes or a configuration out of range;
/// [`crate::Error::NotFound`] when there are no stripes, when they have no colour, or when their colours follow the
/// pattern no better than chance would.
pub fn decode(photo: PhotoView<'_>, pattern: &StripePattern, config: &DecodeConfig) -> Result<Decoding> {
    decode_frames(&DecodeInput { photo, black: None, white: None }, pattern, config)
}

/// As [`decode`], with a photograph of the dark projector (ambient light is taken off) and one of the plain white
/// projector (the surface's own colour is divided out), where there are any.
///
/// # Errors
/// As [`decode`].
pub fn decode_frames(
    input: &DecodeInput<'_>,
    pattern: &StripePattern,
    config: &DecodeConfig,
) -> Result<Decoding> {
    config.validate()?;
    pattern.validate()?;
    stages::run(input, pattern, config)
}
