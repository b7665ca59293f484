//! What goes into decoding and what is said about it.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::matches::Matches;
use crate::photo::{Encoding, PhotoView};

/// How to decode.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DecodeConfig {
    /// Transfer curve of the photographs.
    pub encoding: Encoding,
    /// Matches of lower confidence are dropped and counted, 0–1.
    pub min_confidence: f64,
}

impl Default for DecodeConfig {
    fn default() -> Self {
        Self { encoding: Encoding::Srgb, min_confidence: 0.4 }
    }
}

impl DecodeConfig {
    /// Checks the ranges of the fields.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the field.
    pub fn validate(&self) -> Result<()> {
        self.encoding.validate()?;
        if !(0.0..=1.0).contains(&self.min_confidence) {
            return Err(Error::invalid("min_confidence", "0 to 1", self.min_confidence));
        }
        Ok(())
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

/// Stripe crossings that were seen and not reported, by reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Dropped {
    /// Too little contrast over the noise, or no two edges.
    pub weak: usize,
    /// The lines of its curve do not agree on a slit, or too few of them decoded.
    pub ambiguous: usize,
    /// Much narrower than its neighbours: an outline or a shadow cuts it, so that its middle is not the slit's centre.
    pub cut: usize,
    /// Confidence below the one asked for.
    pub unsure: usize,
}

/// What was seen.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct DecodeReport {
    /// Stripe crossings seen, over all lines.
    pub crossings: usize,
    /// Reported as matches.
    pub decoded: usize,
    /// Different slits among them.
    pub slits: usize,
    /// Not reported, by reason.
    pub dropped: Dropped,
    /// Median width of the stripes, px.
    pub stripe_width_px: f64,
    /// Colours of the hues as seen (linear light, unit length), in the order of the palette.
    pub hues_seen: Vec<[f64; 3]>,
    /// Angle by which colours of one hue scatter, rad.
    pub hue_spread_rad: f64,
    /// Share of the crossings whose core is clipped in some channel.
    pub saturated: f64,
    /// How much better than chance the colours follow the pattern, nats per crossing; below about a third of the
    /// maximum ln(hues) + 1 the pattern is another one.
    pub code_fit: f64,
    /// Whether slits ascend against the image's axis (a projector upside down or behind a mirror).
    pub reversed: bool,
}

/// Matches and what was seen on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct Decoding {
    /// One per slit and line.
    pub matches: Matches,
    /// Counts and measures.
    pub report: DecodeReport,
}
