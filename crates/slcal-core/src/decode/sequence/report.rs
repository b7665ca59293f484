//! Configuration and result of the decoding of sequences.

use serde::{Deserialize, Serialize};

use crate::dense_matches::DenseMatches;
use crate::rig::Warning;

/// Configuration of the decoding of sequences.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct SequenceDecodeConfig {
    /// Whether the projector's pictures appear with left and right exchanged.
    pub mirrored: bool,
    /// Rows are read on the threads of the caller's rayon pool (the cargo feature `rayon`; without it on one thread). The result is the
    /// same, bit for bit.
    pub parallel: bool,
}

/// Counts of a sequence.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[non_exhaustive]
pub struct SequenceDecodeReport {
    /// Frames of the sequence.
    pub frames: usize,
    /// Pixels of the camera.
    pub pixels: usize,
    /// Pixels on which white differs from black, or any bit from its inverse.
    pub lit: usize,
    /// Pixels with a position.
    pub decoded: usize,
    /// Lit pixels of which too little is certain: bits without contrast, no amplitude, or the light of two surfaces.
    pub undecided: usize,
    /// Lit pixels whose bits mean no place on the panel, or contradict the sinusoid.
    pub contradicting: usize,
    /// 1σ of a pixel's level in a frame, as a share of white of the file (1/255 is a code value of 8 bit): the median of the lit pixels.
    pub noise: f64,
    /// White less black, as a share of white of the file: the median of the lit pixels; null when they are not shown.
    pub contrast: Option<f64>,
    /// Median 1σ of columns, panel px; null when they are not coded.
    pub median_sigma_column_px: Option<f64>,
    /// Median 1σ of rows, panel px; null when they are not coded.
    pub median_sigma_row_px: Option<f64>,
    /// What makes the result doubtful: `moved`, `saturated`.
    pub warnings: Vec<Warning>,
}

/// What a sequence says of every pixel.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct SequenceDecoding {
    /// Panel coordinates of every pixel.
    pub matches: DenseMatches,
    /// Counts.
    pub report: SequenceDecodeReport,
}
