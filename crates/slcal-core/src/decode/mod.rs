//! Photograph of stripes → [`crate::Matches`]: which slit lights which pixel.
//!
//! A look at a few lines tells which way the stripes run, how wide and how sharp they are (`stripe_scale`, `noise`). Lines across
//! the stripes are read one by one (`scanlines`) and cut into bright hills (`peaks`), whose edges are measured to sub-pixel
//! (`stripe_edges`). Crossings linked from line to line are curves (`tracks`). Hues are learned from the photograph (`color_classes`,
//! `crosstalk`); once the pattern is recognised (`code_check`), dynamic programming assigns slits along lines (`sequence_alignment`) and
//! curves vote (`labeling`), unless neighbours contradict each other (`consistency`). The edges of a stripe and its neighbours
//! give its slit's centre (`stripe_centers`, by what `slit_layout` knows of the pattern). [`Decoder`] runs the stages.

mod code_check;
mod color_classes;
mod config;
mod consistency;
mod crosstalk;
mod decoder;
mod labeling;
mod noise;
mod peaks;
mod report_json;
mod rgb;
mod scanlines;
mod sequence_alignment;
mod slit_layout;
mod stripe_centers;
mod stripe_edges;
mod stripe_scale;
#[cfg(test)]
mod tests;
mod tracks;

pub use config::{DecodeConfig, DecodeInput, DecodeReport, Decoding, Rejected, ScanDirection};
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
