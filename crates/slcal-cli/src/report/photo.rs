//! A photograph within the page.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use image::DynamicImage;
use image::imageops::FilterType;
use maud::{Markup, PreEscaped};

use crate::exit::Outcome;
use crate::io::jpeg_bytes;
use crate::picture::Drawing;

/// Longer side of a photograph that stands alone, and of one among others, px: sharp on a large screen, and small enough to
/// send.
const ALONE_PX: u32 = 1600;
const AMONG_OTHERS_PX: u32 = 1000;
/// Quality of the JPEG: what is drawn on it is not part of it.
const QUALITY: u8 = 80;

/// A photograph as the page carries it.
pub(crate) struct Photo {
    uri: String,
}

impl Photo {
    /// One of `count` photographs.
    pub(crate) fn new(picture: &DynamicImage, count: usize) -> Outcome<Self> {
        let longest = if count > 1 { AMONG_OTHERS_PX } else { ALONE_PX };
        let smaller = (picture.width().max(picture.height()) > longest)
            .then(|| picture.resize(longest, longest, FilterType::Triangle).to_rgb8());
        let pixels = smaller.unwrap_or_else(|| picture.to_rgb8());
        let bytes = jpeg_bytes(&pixels, QUALITY)?;
        Ok(Self { uri: format!("data:image/jpeg;base64,{}", STANDARD.encode(bytes)) })
    }

    /// With a drawing upon it.
    pub(super) fn under(&self, drawing: &Drawing) -> Markup {
        // The writer of the drawing escapes its texts.
        PreEscaped(drawing.svg(Some(&self.uri)))
    }
}
