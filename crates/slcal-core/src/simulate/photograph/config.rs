//! Configuration of a photograph: light, lens blur, sensor.

use serde::{Deserialize, Serialize};

use super::demosaic::Demosaic;
use super::flicker::Flicker;
use super::sharpen::Sharpen;
use crate::error::{Error, Result, within};
use crate::photo::Encoding;

/// Largest blur, px: beyond it no pattern is visible.
const MOST_BLUR_PX: f64 = 50.0;
/// Largest noise, grey levels of 255: the whole range.
const MOST_NOISE_LEVELS: f64 = 255.0;
/// Largest exposure and ambient light: beyond them everything saturates, or nothing shows, in any scene.
const MOST_LIGHT: f64 = 1000.0;
/// Largest number of samples per side of a pixel: more change nothing in 16 bits.
const MOST_SAMPLES: u32 = 16;

/// Largest distance between the panels of a projector, px: real ones come to one or two; beyond this the colours of the
/// usual patterns no longer overlap.
const MOST_CHANNEL_SHIFT_PX: f64 = 20.0;
/// Largest lateral colour: ten times that of the worst lenses.
const MOST_LATERAL_COLOUR: f64 = 0.02;
/// Exponents of a projector's curve, as those of a photograph.
const GAMMAS: [f64; 2] = [0.1, 10.0];
/// Qualities of JPEG files.
const QUALITIES: [u8; 2] = [1, 100];

/// Light, lens and sensor. The default is a good photograph: sharp to a pixel, a grey level of noise.
///
/// Linear light of a pixel before the lens's blur: exposure · crosstalk · (albedo ∘ (ambient + E · (black + (1 − black) · P))),
/// where P is what the projector shows (0–1), and E the cosine of the angle at which its light falls in, times the
/// square of (reference distance / distance from the projector). One is full scale.
///
/// What real devices do besides is off unless it is given. It is applied in this order: the projector's curve, its falloff and
/// the places of its panels; the camera's lateral colour, blur and vignetting; flicker; noise; mosaic and demosaicing; the
/// transfer curve and the tone curve; sharpening; code values; JPEG. The geometry of green is the rig's: ground truth and
/// matches are those of green.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RenderConfig {
    /// Linear light, as a share of full scale, of a white surface that faces the projector at the reference distance under
    /// full light; default 0.8.
    pub exposure: f64,
    /// Distance from the projector at which its light is one, mm; default `None`: the median distance of all lit pixels.
    pub reference_mm: Option<f64>,
    /// Light that falls on everything from everywhere, red, green, blue, as a share of the projector's; default 0.03.
    pub ambient: [f64; 3],
    /// Light of pixels that see no surface, on the scale of albedo · (light), red, green, blue; default 0.01.
    pub background: [f64; 3],
    /// What the projector sends out where it shows black, as a share of full light; default 0.
    pub projector_black: f64,
    /// σ of the projector's Gaussian blur, panel px; default 0: its pixels are sharp squares.
    pub projector_blur_px: f64,
    /// Light of a panel is value^γ; default `None`: sRGB's curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub projector_gamma: Option<f64>,
    /// Share of its light (black included) that the panel loses in its corners, with the square of the distance from its
    /// middle; default 0.
    #[serde(skip_serializing_if = "is_zero")]
    pub projector_falloff: f64,
    /// Columns and rows by which the red and the blue panel lie beside the green one, panel px: red light of panel position p
    /// falls where green light of p + shift falls. Default none.
    #[serde(skip_serializing_if = "are_zero")]
    pub channel_shift_px: [[f64; 2]; 2],
    /// Lateral colour of the camera's lens, red and blue: what green shows at u, red shows at c + (u − c)·(1 + r), with c the
    /// principal point. Default none.
    #[serde(skip_serializing_if = "are_none")]
    pub lateral_colour: [f64; 2],
    /// Response of each channel of the camera (rows) to each channel of the light (columns); default the identity.
    pub crosstalk: [[f64; 3]; 3],
    /// σ of the camera's Gaussian blur, px, on top of the square pixels themselves; default 0.6.
    pub blur_px: f64,
    /// Share of the light that the camera loses in the corners of the picture, with the square of the distance from its
    /// middle; default 0.
    #[serde(skip_serializing_if = "is_zero")]
    pub vignetting: f64,
    /// Rows darkened by mains flicker; default `None`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flicker: Option<Flicker>,
    /// σ of the Gaussian noise of every sample of the sensor, in grey levels (of 255, also with 16 bit) of the encoded picture
    /// before its tone curve; default 1.
    pub noise_levels: f64,
    /// The sensor has a Bayer mosaic (RGGB), which is filled in like this; default `None`: three samples per pixel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub demosaic: Option<Demosaic>,
    /// Strength S of an S-shaped tone curve, 0 to 1: v + S·(3v² − 2v³ − v) of an encoded value v. Default 0: none.
    #[serde(skip_serializing_if = "is_zero")]
    pub tone: f64,
    /// Sharpening of the encoded picture; default `None`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sharpen: Option<Sharpen>,
    /// The camera writes JPEG of this quality (1–100) with chroma at half the resolution (4:2:0), 8 bit only; default `None`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jpeg_quality: Option<u8>,
    /// Seed of the noise; default 1.
    pub seed: u64,
    /// Transfer curve of the picture; default sRGB.
    pub encoding: Encoding,
    /// 8 or 16 bit per sample; default 8.
    pub bits: u8,
    /// Rays per side of pixels that contain an edge; smooth ones are averaged exactly. Default 4.
    pub samples: u32,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

fn are_none(values: &[f64; 2]) -> bool {
    values.iter().all(is_zero)
}

fn are_zero(values: &[[f64; 2]; 2]) -> bool {
    values.iter().all(are_none)
}

impl Default for RenderConfig {
    fn default() -> Self {
        Self {
            exposure: 0.8,
            reference_mm: None,
            ambient: [0.03; 3],
            background: [0.01; 3],
            projector_black: 0.0,
            projector_blur_px: 0.0,
            projector_gamma: None,
            projector_falloff: 0.0,
            channel_shift_px: [[0.0; 2]; 2],
            lateral_colour: [0.0; 2],
            crosstalk: Self::neighbour_crosstalk(0.0),
            blur_px: 0.6,
            vignetting: 0.0,
            flicker: None,
            noise_levels: 1.0,
            demosaic: None,
            tone: 0.0,
            sharpen: None,
            jpeg_quality: None,
            seed: 1,
            encoding: Encoding::Srgb,
            bits: 8,
            samples: 4,
        }
    }
}

impl RenderConfig {
    /// No blur, no noise, no crosstalk, 16 bit: geometry alone.
    #[must_use]
    pub fn exact() -> Self {
        Self { blur_px: 0.0, noise_levels: 0.0, bits: 16, ..Self::default() }
    }

    /// The crosstalk matrix in which each channel gets `share` of the light of each channel next to it in the order red,
    /// green, blue. Its rows are normalised: white stays white.
    #[must_use]
    pub fn neighbour_crosstalk(share: f64) -> [[f64; 3]; 3] {
        let row = |r: [f64; 3]| r.map(|c| c / r.iter().sum::<f64>());
        [row([1.0, share, 0.0]), row([share, 1.0, share]), row([0.0, share, 1.0])]
    }

    /// Checks the values.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the value, its range and what was given.
    pub fn validate(&self) -> Result<()> {
        let light = [0.0, MOST_LIGHT];
        if !(self.exposure > 0.0 && self.exposure <= MOST_LIGHT) {
            return Err(Error::invalid(
                "exposure",
                format!("more than 0, at most {MOST_LIGHT}"),
                self.exposure,
            ));
        }
        if let Some(d) = self.reference_mm.filter(|d| !(d.is_finite() && *d > 0.0)) {
            return Err(Error::invalid("reference distance", "a positive length", format!("{d} mm")));
        }
        for channel in 0..3 {
            within("ambient light", self.ambient[channel], light, "")?;
            within("background", self.background[channel], light, "")?;
        }
        for m in self.crosstalk.as_flattened() {
            within("crosstalk", *m, [0.0, 1.0], "")?;
        }
        self.validate_projector()?;
        within("blur", self.blur_px, [0.0, MOST_BLUR_PX], " px")?;
        within("noise", self.noise_levels, [0.0, MOST_NOISE_LEVELS], " grey levels")?;
        if ![8, 16].contains(&self.bits) {
            return Err(Error::invalid("bits per sample", "8 or 16", self.bits));
        }
        within("samples per side", self.samples, [1, MOST_SAMPLES], "")?;
        self.validate_pipeline()?;
        self.encoding.validate()
    }

    fn validate_projector(&self) -> Result<()> {
        within("the projector's black", self.projector_black, [0.0, 1.0], "")?;
        within("the projector's blur", self.projector_blur_px, [0.0, MOST_BLUR_PX], " px")?;
        if let Some(gamma) = self.projector_gamma {
            within("the projector's gamma", gamma, GAMMAS, "")?;
        }
        within("the projector's falloff", self.projector_falloff, [0.0, 1.0], "")?;
        for shift in self.channel_shift_px.as_flattened() {
            let range = [-MOST_CHANNEL_SHIFT_PX, MOST_CHANNEL_SHIFT_PX];
            within("channel shift", *shift, range, " px")?;
        }
        Ok(())
    }

    fn validate_pipeline(&self) -> Result<()> {
        for radial in self.lateral_colour {
            within("lateral colour", radial, [-MOST_LATERAL_COLOUR, MOST_LATERAL_COLOUR], "")?;
        }
        within("vignetting", self.vignetting, [0.0, 1.0], "")?;
        self.flicker.as_ref().map_or(Ok(()), Flicker::validate)?;
        within("tone", self.tone, [0.0, 1.0], "")?;
        self.sharpen.as_ref().map_or(Ok(()), Sharpen::validate)?;
        if let Some(quality) = self.jpeg_quality {
            within("JPEG quality", quality, QUALITIES, "")?;
            if self.bits != 8 {
                return Err(Error::invalid("bits per sample", "8 with JPEG", self.bits));
            }
        }
        Ok(())
    }
}
