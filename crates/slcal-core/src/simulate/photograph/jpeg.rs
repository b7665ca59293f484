//! JPEG files as cameras write them: colour at half the resolution.

use image::{ImageFormat, RgbImage};
use jpeg_encoder::{ChromaSubsamplingMethod, ColorType, Encoder, SamplingFactor};

use crate::error::{Error, ErrorSubject, Result};

/// Longest side of a JPEG file, px.
pub(super) const MOST_SIDE_PX: u32 = 65_535;

/// A JPEG file of this quality (1–100) with 4:2:0 chroma, and the picture that is read from it.
pub(super) fn through_jpeg(picture: &RgbImage, quality: u8) -> Result<(Vec<u8>, RgbImage)> {
    let wrong = |why: &dyn std::fmt::Display| {
        Error::invalid(ErrorSubject::Photograph, "pixels that fit into a JPEG file", why)
    };
    let [width, height] = [picture.width(), picture.height()].map(u16::try_from);
    let (width, height) = (width.map_err(|e| wrong(&e))?, height.map_err(|e| wrong(&e))?);
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, quality);
    encoder.set_sampling_factor(SamplingFactor::F_2_2);
    encoder.set_chroma_subsampling_method(ChromaSubsamplingMethod::Average);
    encoder.encode(picture.as_raw(), width, height, ColorType::Rgb).map_err(|e| wrong(&e))?;
    let read = image::load_from_memory_with_format(&file, ImageFormat::Jpeg).map_err(|e| wrong(&e))?;
    Ok((file, read.into_rgb8()))
}
