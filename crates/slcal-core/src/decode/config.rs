//! Input, configuration and report of decoding.

use serde::{Deserialize, Serialize};

use crate::channel_registration::ChannelRegistration;
use crate::error::{Result, within};
use crate::matches::Matches;
use crate::photo::{Encoding, PhotoView};

/// Configuration of the decoder.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DecodeConfig {
    /// Transfer curve of the photographs.
    pub encoding: Encoding,
    /// Matches of lower confidence are rejected and counted, 0–1.
    pub min_confidence: f64,
    /// Scanlines are searched on the threads of the caller's rayon pool (the cargo feature `rayon`; without it on one
    /// thread). The result is the same, bit for bit.
    pub parallel: bool,
    /// Whether the picture appears with left and right exchanged, as in rear projection: column c of the pattern counts as
    /// width − 1 − c. Slits keep the numbers that the pattern gives them.
    pub mirrored: bool,
    /// How red and blue are displaced against green, from a calibration; `None`: it is estimated from the stripes where they show
    /// it.
    #[serde(skip)]
    pub registration: Option<ChannelRegistration>,
}

impl Default for DecodeConfig {
    fn default() -> Self {
        Self {
            encoding: Encoding::Srgb,
            min_confidence: 0.4,
            parallel: false,
            mirrored: false,
            registration: None,
        }
    }
}

impl DecodeConfig {
    /// Checks the ranges of the fields.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] naming the field.
    pub fn validate(&self) -> Result<()> {
        self.encoding.validate()?;
        within("min_confidence", self.min_confidence, [0.0, 1.0], "")
    }
}

/// The photographs of one scene, all of one size.
#[derive(Debug, Clone, Copy)]
pub struct DecodeInput<'a> {
    /// With the stripes projected.
    pub photo: PhotoView<'a>,
    /// With a dark projector.
    pub black: Option<PhotoView<'a>>,
    /// With a plain white projection.
    pub white: Option<PhotoView<'a>>,
}

impl<'a> From<PhotoView<'a>> for DecodeInput<'a> {
    fn from(photo: PhotoView<'a>) -> Self {
        Self { photo, black: None, white: None }
    }
}

/// Stripe crossings that were detected and rejected, by reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Rejected {
    /// The contrast is too low for the noise, or the band lacks one of its two edges.
    #[serde(rename = "weak")]
    pub low_contrast: usize,
    /// The scanlines of its track do not agree on a slit, or too few of them were decoded.
    pub ambiguous: usize,
    /// The neighbour on the same scanline has the same slit, with at least as much support.
    #[serde(rename = "inconsistent")]
    pub duplicate: usize,
    /// Its width differs from what its neighbours predict: an outline or a shadow truncates the stripe, so that the centre
    /// of its slit is unknown.
    #[serde(rename = "cut")]
    pub truncated: usize,
    /// The confidence is below [`DecodeConfig::min_confidence`].
    #[serde(rename = "unsure")]
    pub low_confidence: usize,
}

impl Rejected {
    /// Number of rejected crossings.
    #[must_use]
    pub fn total(&self) -> usize {
        self.reasons().iter().map(|(_, count)| count).sum()
    }

    /// The reasons in words, each with its number of crossings.
    #[must_use]
    pub fn reasons(&self) -> [(&'static str, usize); 5] {
        [
            ("low contrast", self.low_contrast),
            ("ambiguous", self.ambiguous),
            ("duplicate", self.duplicate),
            ("truncated", self.truncated),
            ("low confidence", self.low_confidence),
        ]
    }
}

/// Direction of the scanlines, which run across the stripes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ScanDirection {
    /// Along image rows: the stripes run down the image.
    #[default]
    Rows,
    /// Along image columns: the stripes run across the image.
    Columns,
}

/// Displacement of red and blue light against green along the pattern's axis, projector px.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ChannelShift {
    /// Of red.
    pub red_px: f64,
    /// Of blue.
    pub blue_px: f64,
    /// 1σ of red and blue.
    pub sigma_px: [f64; 2],
    /// Magnification of red and blue by the camera's lens beyond that of green (lateral colour).
    pub radial: [f64; 2],
    /// Whether it was removed: it came from a calibration, or is beyond 3σ.
    pub used: bool,
}

/// Counts and measures of one photograph.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct DecodeReport {
    /// Detected stripe crossings on all scanlines: decoded and rejected ones.
    pub crossings: usize,
    /// Crossings that became matches.
    pub decoded: usize,
    /// Different slits among them.
    pub slits: usize,
    /// Rejected crossings, by reason.
    #[serde(rename = "dropped")]
    pub rejected: Rejected,
    /// Direction of the scanlines.
    pub lines: ScanDirection,
    /// Median width of the stripes, px.
    pub stripe_width_px: f64,
    /// Width of the stripes as photographed over that of the slits as drawn. Light that spills over makes it more than
    /// 1.
    pub width_ratio: f64,
    /// Noise of a pixel, 1σ in 8-bit grey levels.
    pub noise_levels: f64,
    /// Measured colours of the hues (linear light, unit length), in the order of the palette.
    pub hues_seen: Vec<[f64; 3]>,
    /// Crosstalk: the response of the camera's channels (rows) to the projector's primaries (columns), from the
    /// measured hues. Each column has its largest entry 1. `None` where the palette does not distinguish three
    /// primaries.
    pub crosstalk: Option<[[f64; 3]; 3]>,
    /// Spread of the colours of one hue, 1σ, rad.
    pub hue_spread_rad: f64,
    /// Share of the crossings whose core is clipped in some channel.
    pub saturated: f64,
    /// How far red and blue were seen beside green. `None` where too few slits stand side by side to tell.
    #[serde(default)]
    pub channel_shift: Option<ChannelShift>,
    /// Whether the stripes' edges alternated from scanline to scanline, as a demosaiced photograph's do, and were averaged over
    /// three.
    #[serde(default)]
    pub demosaiced: bool,
    /// How much better than chance the colours follow the pattern, nats per crossing. Below about a third of the
    /// maximum ln(hues) + 1 the pattern is another one.
    pub code_fit: f64,
    /// Whether slits ascend against the image's axis (a projector upside down or behind a mirror).
    pub reversed: bool,
    /// Whether the stripes run across the direction that the pattern's axis has in the projector's image: the camera or
    /// the projector is rotated by 90°, or another pattern was projected.
    pub turned: bool,
}

/// Matches and the report of decoding.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Decoding {
    /// One per slit and scanline.
    pub matches: Matches,
    /// Counts and measures.
    pub report: DecodeReport,
}
