//! JPEG files that contradict themselves: four components named C, M, Y and K, and an Adobe marker that says YCCK.
//!
//! Adobe and libjpeg number the components of YCCK from 1. Programs that hand Y, Cb, Cr and K to an encoder as if they were
//! inks, and set the marker afterwards, transform the light, where Adobe transforms the inks: read as Adobe's, such a file
//! is a negative.

use super::jpeg_segments::{Segment, segments};
use image::{DynamicImage, RgbImage};
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Whether this is such a file.
pub(super) fn are_inks_named(jpeg: &[u8]) -> bool {
    let mut is_ycck = false;
    for Segment { marker, content, .. } in segments(jpeg) {
        match marker {
            // Behind the name stand the version and two words of flags.
            0xEE if content.starts_with(b"Adobe") => is_ycck = content.get(11) == Some(&2),
            // Depth, height, width and the number of components stand before their names.
            0xC0..=0xC2 => {
                let names = [6, 9, 12, 15].map(|i| content.get(i).copied().unwrap_or_default());
                return is_ycck && names == *b"CMYK";
            }
            _ => {}
        }
    }
    false
}

/// Its picture; the error says why it cannot be decoded.
pub(super) fn decode_named_inks(jpeg: &[u8]) -> Result<DynamicImage, String> {
    let options = DecoderOptions::default()
        .set_strict_mode(false)
        .set_max_width(usize::MAX)
        .set_max_height(usize::MAX)
        .jpeg_set_out_colorspace(ColorSpace::YCCK);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(jpeg), options);
    let planes = decoder.decode().map_err(|e| e.to_string())?;
    let size = decoder.dimensions().and_then(|(w, h)| Some([u32::try_from(w).ok()?, u32::try_from(h).ok()?]));
    let inks = planes.as_chunks::<4>().0;
    let mut pixels = Vec::with_capacity(3 * inks.len());
    pixels.extend(inks.iter().flat_map(|pixel| light(*pixel)));
    size.and_then(|[width, height]| RgbImage::from_raw(width, height, pixels))
        .map(DynamicImage::ImageRgb8)
        .ok_or_else(|| "its size is unknown".to_owned())
}

/// By ITU-T T.871, less what the black ink covers.
fn light([y, cb, cr, k]: [u8; 4]) -> [u8; 3] {
    let [y, cb, cr] = [f32::from(y), f32::from(cb) - 128.0, f32::from(cr) - 128.0];
    let rgb = [y + 1.402 * cr, y - 0.344_136 * cb - 0.714_136 * cr, y + 1.772 * cb];
    rgb.map(|channel| (channel.clamp(0.0, 255.0) * f32::from(k) / 255.0).round() as u8)
}
