//! Frames without a file format: a stream of pixels, as `ffmpeg -f rawvideo` writes it.

use std::io::{ErrorKind, Read};

use slcal_core::photo::{Layout, PhotoView, Samples};

use super::photo::MAX_PIXELS;
use crate::exit::{Exit, Failure, Outcome};

/// Pixel formats by their ffmpeg names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pixels {
    Rgb24,
    Bgr24,
    Rgb48Le,
}

/// The format of the frames of a stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct RawFormat {
    /// Width and height, px.
    pub(crate) size: [u32; 2],
    pixels: Pixels,
}

impl RawFormat {
    /// Parses `WxH:rgb24`.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let usual = || "expected WxH:rgb24, WxH:bgr24 or WxH:rgb48le, for example 1280x960:rgb24".to_owned();
        let (size, pixels) = text.split_once(':').ok_or_else(usual)?;
        let (width, height) = size.split_once('x').ok_or_else(usual)?;
        let side = |s: &str| s.parse::<u32>().ok().filter(|n| *n > 0).ok_or_else(usual);
        let size = [side(width)?, side(height)?];
        if u64::from(size[0]) * u64::from(size[1]) > MAX_PIXELS {
            return Err(format!("expected frames of at most {} megapixels", MAX_PIXELS / 1_000_000));
        }
        let pixels = match pixels {
            "rgb24" => Pixels::Rgb24,
            "bgr24" => Pixels::Bgr24,
            "rgb48le" => Pixels::Rgb48Le,
            grey if grey.starts_with("gray") || grey.starts_with("grey") => {
                return Err(
                    "the stripes are identified by their colours, which a grey picture does not have; \
                            record in colour, as rgb24, bgr24 or rgb48le"
                        .to_owned(),
                );
            }
            _ => return Err(format!("{}; convert with `ffmpeg ... -f rawvideo -pix_fmt rgb24 -`", usual())),
        };
        Ok(Self { size, pixels })
    }

    /// Bytes of one frame.
    fn length(self) -> usize {
        let bytes = if self.pixels == Pixels::Rgb48Le { 6 } else { 3 };
        self.size[0] as usize * self.size[1] as usize * bytes
    }
}

/// One frame of a stream.
#[derive(Debug)]
pub(crate) struct RawFrame {
    format: RawFormat,
    samples: RawSamples,
}

#[derive(Debug)]
enum RawSamples {
    U8(Vec<u8>),
    U16(Vec<u16>),
}

impl RawFrame {
    /// Reads the next frame; `name` is for messages. `None` at the end of the stream.
    pub(crate) fn read(input: &mut impl Read, format: RawFormat, name: &str) -> Outcome<Option<Self>> {
        let mut bytes = vec![0; format.length()];
        let mut filled = 0;
        while filled < bytes.len() {
            match input.read(&mut bytes[filled..]) {
                Ok(0) if filled == 0 => return Ok(None),
                Ok(0) => {
                    let [w, h] = format.size;
                    return Err(Failure::new(
                        Exit::Input,
                        format!(
                            "{name}: expected {} bytes for a frame of {w}x{h} pixels, found the end of the stream after \
                             {filled}; the recording is truncated, or its frames have another size or format",
                            bytes.len()
                        ),
                    ));
                }
                Ok(n) => filled += n,
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(e) => return Err(Failure::new(Exit::Input, format!("{name}: expected a frame: {e}"))),
            }
        }
        let samples = match format.pixels {
            Pixels::Rgb24 | Pixels::Bgr24 => RawSamples::U8(bytes),
            Pixels::Rgb48Le => {
                let (pairs, _) = bytes.as_chunks::<2>();
                RawSamples::U16(pairs.iter().map(|b| u16::from_le_bytes(*b)).collect())
            }
        };
        Ok(Some(Self { format, samples }))
    }

    /// The frame as a view.
    pub(crate) fn view(&self) -> slcal_core::Result<PhotoView<'_>> {
        let [width, height] = self.format.size.map(|n| n as usize);
        let samples = match &self.samples {
            RawSamples::U8(s) => Samples::U8(s),
            RawSamples::U16(s) => Samples::U16(s),
        };
        let layout = if self.format.pixels == Pixels::Bgr24 { Layout::Bgr } else { Layout::Rgb };
        PhotoView::new(samples, width, height, 3 * width, layout)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_pixels_in_every_format() {
        let frames = [
            ("2x1:rgb24", vec![10_u8, 20, 30, 40, 50, 60]),
            ("2x1:bgr24", vec![30, 20, 10, 60, 50, 40]),
            (
                "2x1:rgb48le",
                [10_u16, 20, 30, 40, 50, 60].iter().flat_map(|c| (c * 257).to_le_bytes()).collect(),
            ),
        ];
        for (format, bytes) in frames {
            let format = RawFormat::parse(format).unwrap();
            let mut stream = bytes.as_slice();
            let frame = RawFrame::read(&mut stream, format, "x").unwrap().unwrap();
            for (code, expected) in frame.view().unwrap().rgb_code(1, 0).iter().zip([40.0, 50.0, 60.0]) {
                assert!((code * 255.0 - expected).abs() < 1e-3, "{code} {expected}");
            }
            assert!(RawFrame::read(&mut stream, format, "x").unwrap().is_none());
            let failure = RawFrame::read(&mut &bytes[1..], format, "x").unwrap_err();
            assert!(failure.code() == 3 && failure.to_string().contains("truncated"), "{failure}");
        }
    }

    #[test]
    fn formats_that_are_none_say_why() {
        for (text, word) in [
            ("1280x960:gray", "colour"),
            ("1280x960:gray16le", "colour"),
            ("1280x960:yuv420p", "ffmpeg"),
            ("1280x960", "WxH:rgb24"),
            ("0x960:rgb24", "WxH:rgb24"),
            ("-5x960:rgb24", "WxH:rgb24"),
            ("99999x99999:rgb24", "megapixels"),
        ] {
            assert!(RawFormat::parse(text).unwrap_err().contains(word), "{text}");
        }
    }
}
