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
pub use decoder::{Decoder, decode, decode_frames};
