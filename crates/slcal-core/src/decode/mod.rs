//! Photograph of stripes → [`crate::Matches`]: which slit illuminates which pixel. Photographs of a sequence →
//! [`crate::DenseMatches`]: which panel pixel does (`sequence`).
//!
//! A few scanlines give the direction of the stripes, their width and their sharpness (`stripe_scale`, `noise`), and what
//! looks like stripes in the dark (`unlit_noise`).
//! Scanlines across the stripes are read one by one (`scanlines`) and segmented into peaks (`peaks`), whose two edges
//! are located to sub-pixel (`stripe_edges`). A stripe on one scanline is a crossing; crossings linked from scanline to
//! scanline form a track (`tracks`). The colour classes of the hues are learned from the photograph (`color_classes`,
//! `crosstalk`). Once the code is recognised (`code_check`), dynamic programming assigns slits along scanlines
//! (`sequence_alignment`, `crossing_features`) and the scanlines vote along tracks (`labeling`). Labels that contradict
//! each other are refused (`consistency`). The edges of a stripe and of its neighbours give the centre of its slit and
//! its σ (`stripe_centers`, `center_sigma`), with the geometry of the pattern (`slit_layout`). `decoder` runs the
//! stages.

mod center_sigma;
mod code_check;
mod color_classes;
mod config;
mod consistency;
mod crossing_features;
mod crosstalk;
mod decoder;
mod hue_shift;
mod in_threads;
mod labeling;
mod noise;
mod peaks;
mod registration;
mod report_json;
mod rgb;
mod row_parity;
mod running_mean;
mod scanlines;
mod sequence;
mod sequence_alignment;
mod slit_layout;
mod stripe_centers;
mod stripe_edges;
mod stripe_scale;
#[cfg(test)]
mod tests;
mod touching_stripes;
mod tracks;
mod unlit_noise;
mod zigzag;

pub use config::{DecodeConfig, DecodeInput};
public_with! { "report": pub use config::{ChannelShift, DecodeReport, Rejected, ScanDirection}; }
public_with! { "stages": pub use config::Decoding; }
public_with! { "stages": pub use decoder::{Decoder, decode}; }
pub use sequence::{SequenceDecodeConfig, SequenceDecodeReport, SequenceDecoder, SequenceDecoding};
