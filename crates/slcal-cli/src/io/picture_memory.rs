//! What it takes to decode a picture, known from its header and refused before its pixels are made.

use image::{ColorType, ImageDecoder, ImageFormat};

use super::jpeg_segments::segments;

/// Most memory that a picture may take until it is handed over, bytes: 250 megapixels of 16-bit RGB.
const MOST_BYTES: u64 = 1_500_000_000;

/// Lines of metadata beside the pixels: a colour profile has kilobytes, seldom megabytes.
const METADATA_BYTES: u64 = 16 << 20;
/// Bytes per pixel of the two lines that a PNG is filtered with.
const LINE_BYTES: u64 = 16;

/// A picture that is about to be decoded.
#[derive(Debug, Clone, Copy)]
pub(super) struct Picture<'a> {
    pub(super) file: &'a [u8],
    pub(super) format: ImageFormat,
    pub(super) color: ColorType,
    pub(super) pixels: u64,
    /// Four inks, which it takes a second picture to turn into light.
    pub(super) has_inks: bool,
    /// Whether its samples are converted to sRGB of 16 bit.
    pub(super) is_converted: bool,
    /// Whether it is turned by a quarter, for which a second picture is needed.
    pub(super) is_turned: bool,
}

impl Picture<'_> {
    /// Bytes that it takes at most, its file included.
    fn bytes(&self) -> u64 {
        let channels = u64::from(self.color.channel_count());
        let decoded = u64::from(self.color.bytes_per_pixel());
        // The decoder's own buffers, which hold the whole picture where its parts do not come in order.
        let decoder = match self.format {
            ImageFormat::Jpeg if is_progressive(self.file) => 2 * if self.has_inks { 4 } else { channels },
            ImageFormat::Jpeg if self.has_inks => 4,
            ImageFormat::Tiff => decoded,
            _ => 0,
        };
        // Alpha is dropped after decoding.
        let opaque = decoded / channels * (channels - u64::from(self.color.has_alpha()));
        // From 8 bit to 16.
        let is_widened = self.is_converted && decoded == channels;
        let (converted, last) = if is_widened { (3 * opaque, 2 * opaque) } else { (opaque, opaque) };
        let turned = if self.is_turned { 2 * last } else { last };
        self.file.len() as u64 + self.pixels * (decoder + decoded).max(converted).max(turned)
    }

    /// What it would take, in words, where that is too much.
    pub(super) fn excess(&self) -> Option<String> {
        let bytes = self.bytes();
        (bytes > MOST_BYTES).then(|| {
            let gb = |bytes: u64| bytes as f64 * 1e-9;
            format!(
                "one that takes {:.1} GB of memory to read; {:.1} GB are the most",
                gb(bytes),
                gb(MOST_BYTES)
            )
        })
    }
}

/// The limit of a decoder's own allocations. That of PNG counts metadata and a line, not the picture.
pub(super) fn decoder_limit(format: ImageFormat, file: &[u8]) -> u64 {
    match (format, file.get(16..20).and_then(|width| width.try_into().ok())) {
        (ImageFormat::Png, Some(width)) => METADATA_BYTES + LINE_BYTES * u64::from(u32::from_be_bytes(width)),
        _ => MOST_BYTES,
    }
}

/// Whether the parts of a JPEG come one after another, so that all of them are kept until the last.
fn is_progressive(jpeg: &[u8]) -> bool {
    segments(jpeg).any(|s| s.marker == 0xC2)
}

/// Whether the samples are four inks.
pub(super) fn has_inks(decoder: &impl ImageDecoder) -> bool {
    use image::ExtendedColorType::{Cmyk8, Cmyk16};
    matches!(decoder.original_color_type(), Cmyk8 | Cmyk16)
}

#[cfg(test)]
mod tests {
    use super::*;

    use ColorType::{L8, Rgb8, Rgb16, Rgba8, Rgba16};
    use ImageFormat::{Jpeg, Png, Tiff};

    #[test]
    fn what_a_picture_takes_follows_from_its_header() {
        let picture = |format, color, megapixels: u64| Picture {
            file: &[],
            format,
            color,
            pixels: megapixels * 1_000_000,
            has_inks: false,
            is_converted: false,
            is_turned: false,
        };
        let takes = |p: Picture<'_>| p.bytes() / p.pixels;
        for (format, color, bytes) in [(Png, Rgb8, 3), (Png, Rgba16, 8), (Tiff, Rgb16, 12), (Jpeg, L8, 1)] {
            assert_eq!(takes(picture(format, color, 1)), bytes, "{format:?} {color:?}");
        }
        let turned = Picture { is_turned: true, ..picture(Png, Rgb16, 1) };
        assert_eq!(takes(turned), 12);
        // RGBA16 is turned without its alpha.
        assert_eq!(takes(Picture { color: Rgba16, ..turned }), 12);
        // 8 bit to 16 bit, then turned.
        let converted = Picture { is_converted: true, ..picture(Png, Rgba8, 1) };
        assert_eq!((takes(converted), takes(Picture { is_turned: true, ..converted })), (9, 12));
        assert!(picture(Png, Rgb16, 249).excess().is_none());
        assert!(Picture { is_turned: true, ..picture(Png, Rgb16, 249) }.excess().unwrap().contains("3.0 GB"));
        // A frame header of a progressive JPEG.
        let progressive = Picture { file: b"\xFF\xD8\xFF\xC2\0\x02", ..picture(Jpeg, Rgb8, 1) };
        assert_eq!(takes(progressive), 9);
    }
}
