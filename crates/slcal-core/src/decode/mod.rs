//! Photograph of stripes → [`crate::Matches`]: which slit lights which pixel.
//!
//! A look at a few lines tells which way the stripes run, how wide and how sharp they are (`scale`, `noise`). Lines across
//! the stripes are read one by one (`lines`) and cut into bright hills (`hills`), whose edges are measured to sub-pixel
//! (`stripes`). Crossings linked from line to line are curves (`curves`). Hues are learned from the photograph (`hues`,
//! `crosstalk`); once the pattern is recognised (`recognise`), dynamic programming assigns slits along lines (`align`) and
//! curves vote (`number`), unless neighbours contradict each other (`contradict`). The edges of a stripe and its neighbours
//! give its slit's centre (`centres`, by what `spacing` knows of the pattern). [`Decoder`] runs the stages.

mod align;
mod centres;
mod config;
mod contradict;
mod crosstalk;
mod curves;
mod decoder;
mod hills;
mod hues;
mod lines;
mod noise;
mod number;
mod recognise;
mod rgb;
mod scale;
mod spacing;
mod stripes;
#[cfg(test)]
mod tests;

pub use config::{DecodeConfig, DecodeInput, DecodeReport, Decoding, Dropped, Lines};
pub use decoder::Decoder;

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
    let mut decoder = Decoder::new(pattern, *config)?;
    decoder.decode(input)?;
    Ok(decoder.into_last())
}
