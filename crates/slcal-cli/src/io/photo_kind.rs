//! Kinds of photographs by their first bytes: those that are read, and those that must be converted.

use std::path::Path;

use image::ImageFormat;

use super::tiff_tag::tiff_tag;
use crate::name::has_extension;

/// Accepted photographs.
pub(super) const FORMATS: &str = "PNG, JPEG, TIFF, WebP or BMP, 8 or 16 bit, grey or RGB(A)";

/// Extensions of the files that a folder is searched for.
pub(super) const EXTENSIONS: [&str; 7] = ["png", "jpg", "jpeg", "tif", "tiff", "webp", "bmp"];

/// Extensions of camera raw files. Most are TIFF files whose thumbnail would be read instead.
const RAW_EXTENSIONS: [&str; 16] = [
    "dng", "cr2", "cr3", "crw", "nef", "nrw", "arw", "sr2", "raf", "orf", "rw2", "pef", "srw", "3fr", "iiq",
    "raw",
];

/// The tag that every DNG has.
const DNG_VERSION: u16 = 50706;

/// Extensions of photographs that must be converted, without those of raw files.
const HEIF_EXTENSIONS: [&str; 5] = ["heic", "heics", "heif", "hif", "avif"];

/// The format of a photograph that is read, by its content.
pub(crate) fn format_of(bytes: &[u8]) -> Option<ImageFormat> {
    use ImageFormat::{Bmp, Jpeg, Png, Tiff, WebP};
    image::guess_format(bytes).ok().filter(|format| matches!(format, Png | Jpeg | Tiff | WebP | Bmp))
}

/// The usual extension of a photograph's file by its content; `None` for what is not read.
#[cfg(feature = "studio")]
pub(crate) fn extension_of(bytes: &[u8]) -> Option<&'static str> {
    Some(match format_of(bytes)? {
        ImageFormat::Jpeg => "jpg",
        ImageFormat::Png => "png",
        ImageFormat::Tiff => "tif",
        ImageFormat::WebP => "webp",
        _ => "bmp",
    })
}

/// A photograph that must be converted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Foreign {
    Heic,
    Avif,
    Raw,
}

impl Foreign {
    /// By the content, and for raw files by the name.
    pub(crate) fn of(bytes: &[u8], name: &str) -> Option<Self> {
        let brand = (bytes.get(4..8) == Some(b"ftyp")).then(|| bytes.get(8..12)).flatten();
        match brand {
            Some(b"avif" | b"avis") => return Some(Self::Avif),
            // The general brands: the compatible ones tell.
            Some(b"mif1" | b"msf1" | b"miaf") => {
                let brands = bytes.get(16..).unwrap_or_default().as_chunks::<4>().0;
                let avif = brands.iter().take(8).any(|b| b == b"avif");
                return Some(if avif { Self::Avif } else { Self::Heic });
            }
            Some(b"heic" | b"heix" | b"hevc" | b"hevx" | b"heim" | b"heis" | b"hevm" | b"hevs") => {
                return Some(Self::Heic);
            }
            _ => {}
        }
        let raw = brand == Some(b"crx ")
            || [b"FUJIFILMCCD-RAW".as_slice(), b"IIRO", b"IIRS", b"IIU\0"]
                .iter()
                .any(|b| bytes.starts_with(b))
            || bytes.get(8..10) == Some(b"CR") && bytes.starts_with(b"II*\0")
            || tiff_tag(bytes, DNG_VERSION).is_some()
            || has_extension(Path::new(name), &RAW_EXTENSIONS);
        raw.then_some(Self::Raw)
    }

    /// Whether the name of a file says that it is such a photograph.
    pub(super) fn is_named_so(name: &Path) -> bool {
        has_extension(name, &RAW_EXTENSIONS) || has_extension(name, &HEIF_EXTENSIONS)
    }

    /// What it is.
    pub(crate) fn found(self) -> &'static str {
        match self {
            Self::Heic => "a HEIC picture",
            Self::Avif => "an AVIF picture",
            Self::Raw => "a camera raw file",
        }
    }

    /// What to do with it.
    pub(crate) fn advice(self) -> &'static str {
        match self {
            Self::Heic => {
                "convert it to JPEG first, for example with `heif-convert IN OUT.jpg`, or set the phone to write JPEG (iPhone: \
                 Settings, Camera, Formats, \"Most Compatible\"); Python reads it after `pip install slcal[heif]`"
            }
            Self::Avif => {
                "convert it to PNG or JPEG first, for example with `avifdec IN OUT.png`; Python reads it after \
                 `pip install slcal[heif]`"
            }
            Self::Raw => {
                "develop it to a 16-bit TIFF first, for example with `darktable-cli IN OUT.tif` or `dcraw -T -6 IN` \
                 (and say --gamma linear if the result is linear)"
            }
        }
    }
}

/// What bytes are that are no photograph.
pub(super) fn what_it_is(bytes: &[u8]) -> &'static str {
    let start = &bytes[..bytes.len().min(512)];
    if std::str::from_utf8(start).is_ok_and(|t| !t.contains('\0')) {
        "a text file"
    } else {
        "bytes of an unknown kind"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_must_be_converted_is_named_by_its_content() {
        for (bytes, name, expected) in [
            (b"\0\0\0\x18ftypheic\0\0\0\0mif1heic".as_slice(), "x.jpg", Some(Foreign::Heic)),
            (b"\0\0\0\x18ftypmif1\0\0\0\0mif1heic", "x.heif", Some(Foreign::Heic)),
            (b"\0\0\0\x18ftypmif1\0\0\0\0mif1avif", "x.jpg", Some(Foreign::Avif)),
            (b"\0\0\0\x1cftypavif\0\0\0\0", "x.jpg", Some(Foreign::Avif)),
            (b"\0\0\0\x18ftypcrx \0\0\0\x01crx isom", "x.jpg", Some(Foreign::Raw)),
            (b"II*\0\x10\0\0\0CR\x02\0", "x.tif", Some(Foreign::Raw)),
            (b"FUJIFILMCCD-RAW 0201", "x", Some(Foreign::Raw)),
            (b"MM\0*\0\0\0\x08", "x.NEF", Some(Foreign::Raw)),
            (b"MM\0*\0\0\0\x08\0\x01\xC6\x12\0\x01\0\0\0\x04\x01\x04\0\0", "x.tif", Some(Foreign::Raw)),
            (b"II*\0\x08\0\0\0\x01\0\x12\xC6\x01\0\x04\0\0\0\x01\x04\0\0", "x.tif", Some(Foreign::Raw)),
            (b"MM\0*\0\0\0\x08\0\x01\x01\0", "x.tif", None),
            (b"II*\0\xFF\xFF\xFF\xFF", "x.tif", None),
            (b"\x89PNG\r\n\x1a\n", "x.png", None),
            (b"", "", None),
        ] {
            assert_eq!(Foreign::of(bytes, name), expected, "{name} {bytes:?}");
        }
    }

    #[cfg(feature = "studio")]
    #[test]
    fn only_pictures_that_are_read_have_an_extension() {
        assert_eq!(extension_of(b"\xFF\xD8\xFF\xE0\0\x10JFIF"), Some("jpg"));
        assert_eq!(extension_of(b"\x89PNG\r\n\x1a\n"), Some("png"));
        assert_eq!(extension_of(b"RIFF\x24\0\0\0WEBPVP8 "), Some("webp"));
        assert_eq!(extension_of(b"BM\x36\0\0\0"), Some("bmp"));
        assert_eq!([extension_of(b"GIF89a"), extension_of(b"hello")], [None, None]);
    }
}
