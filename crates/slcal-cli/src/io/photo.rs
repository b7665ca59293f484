//! Photographs: PNG, JPEG and TIFF, turned upright by their EXIF orientation.

use std::io::Cursor;
use std::path::Path;

use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use slcal_core::PhotoTags;
use slcal_core::format::recognise;

use super::exif::read_tags;
use super::read::read_bytes;
use crate::exit::{Exit, Failure, Outcome};
use crate::name::input_name;
use crate::output::{Printer, Remarks};

/// Accepted photographs.
const FORMATS: &str = "PNG, JPEG or TIFF, 8 or 16 bit, grey or RGB(A)";

/// Limit of the size of photographs, checked before decoding: above any camera, below a file that is made
/// to exhaust the memory.
pub(super) const MAX_PIXELS: u64 = 250_000_000;

/// Limit of the memory of decoding: 16-bit RGB of [`MAX_PIXELS`].
const MAX_DECODED_BYTES: u64 = MAX_PIXELS * 6;

/// Extensions of camera raw files. Most are TIFF files whose thumbnail would be read instead.
const RAW_EXTENSIONS: [&str; 14] =
    ["dng", "cr2", "cr3", "crw", "nef", "nrw", "arw", "sr2", "raf", "orf", "rw2", "pef", "srw", "raw"];

/// Reads a photograph, from stdin for `-`.
pub(crate) fn load_photo(path: &Path, printer: Printer) -> Outcome<DynamicImage> {
    let mut remarks = Remarks::default();
    let loaded = read_photo(path, &mut remarks);
    printer.remarks(&remarks);
    loaded
}

/// A photograph and its EXIF tags, or why there are none that can be read.
pub(crate) type TaggedPhoto = (DynamicImage, Result<PhotoTags, String>);

/// Reads a photograph with its tags.
pub(crate) fn load_tagged_photo(path: &Path, printer: Printer) -> Outcome<TaggedPhoto> {
    let mut remarks = Remarks::default();
    let loaded = read_photo_and_file(path, &mut remarks);
    printer.remarks(&remarks);
    loaded.map(|(photo, bytes, orientation)| {
        let mut tags = read_tags(&bytes);
        if let Ok(tags) = &mut tags {
            // What was done counts.
            tags.orientation = slcal_core::Orientation::of_tag(orientation.to_exif().into());
        }
        (photo, tags)
    })
}

/// Reads a photograph without printing.
pub(crate) fn read_photo(path: &Path, remarks: &mut Remarks) -> Outcome<DynamicImage> {
    read_photo_and_file(path, remarks).map(|(photo, ..)| photo)
}

fn read_photo_and_file(path: &Path, remarks: &mut Remarks) -> Outcome<(DynamicImage, Vec<u8>, Orientation)> {
    let name = input_name(path);
    let bytes = read_bytes(path, "a photograph")?;
    let (photo, orientation) = decode_photo(&bytes, &name)?;
    if orientation != Orientation::NoTransforms {
        remarks.note(format!(
            "{name}: rotated according to its EXIF orientation ({orientation:?}): {}x{} pixels",
            photo.width(),
            photo.height()
        ));
    }
    remarks.detail(format!("{name}: {}x{} {:?}", photo.width(), photo.height(), photo.color()));
    Ok((photo, bytes, orientation))
}

/// Decodes a photograph. `name` is for messages; its extension identifies camera raw files.
pub(crate) fn decode_photo(bytes: &[u8], name: &str) -> Outcome<(DynamicImage, Orientation)> {
    let extension =
        Path::new(name).extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if RAW_EXTENSIONS.contains(&extension.as_str()) {
        return Err(refused(
            name,
            "a camera raw file",
            "develop it to a 16-bit TIFF first, for example with `darktable-cli IN OUT.tif` or `dcraw -T -6 IN` \
             (and say --gamma linear if the result is linear)",
        ));
    }
    if is_heic(bytes) {
        return Err(refused(
            name,
            "a HEIC/AVIF picture",
            "convert it to JPEG or PNG first, for example with `heif-convert IN OUT.png` or by setting the phone to \
             \"most compatible\"",
        ));
    }
    let format = image::guess_format(bytes).map_err(|_| {
        refused(
            name,
            &recognise(bytes).unwrap_or_else(|| what_it_is(bytes).to_owned()),
            "the content decides, not the name; give the photograph itself",
        )
    })?;
    if !matches!(format, ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::Tiff) {
        return Err(refused(name, &format!("{format:?}"), "convert it to PNG first"));
    }
    let broken = |e: &dyn std::fmt::Display| {
        refused(
            name,
            &format!("a {format:?} that cannot be decoded ({e})"),
            "it is damaged or truncated; copy it again",
        )
    };
    let undecoded = |e: &ImageError| match e {
        ImageError::Unsupported(_) => {
            let found = format!("a {format:?} of an unsupported kind ({e})");
            refused(name, &found, "convert it to an RGB PNG or TIFF with 8 or 16 bit first")
        }
        e => broken(e),
    };
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(MAX_DECODED_BYTES);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits);
    let mut decoder = reader.into_decoder().map_err(|e| undecoded(&e))?;
    let (width, height) = decoder.dimensions();
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(refused(
            name,
            &format!("{width}x{height} pixels, more than 250 megapixels"),
            "reduce the picture",
        ));
    }
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    if format == ImageFormat::Jpeg && !jpeg_is_complete(bytes) {
        // The decoder fills missing data with grey.
        return Err(broken(&"the data ends before the picture does"));
    }
    let mut photo = DynamicImage::from_decoder(decoder).map_err(|e| undecoded(&e))?;
    photo.apply_orientation(orientation);
    Ok((photo, orientation))
}

fn refused(name: &str, found: &str, advice: &str) -> Failure {
    Failure::new(Exit::Input, format!("{name}: expected a photograph ({FORMATS}), found {found}; {advice}"))
}

/// Whether this is an ISO base media file with the brand of a still picture.
fn is_heic(bytes: &[u8]) -> bool {
    bytes.get(4..8) == Some(b"ftyp")
        && bytes.get(8..12).is_some_and(|brand| {
            [b"heic", b"heix", b"hevc", b"heim", b"heis", b"mif1", b"msf1", b"avif"]
                .iter()
                .any(|b| b.as_slice() == brand)
        })
}

fn what_it_is(bytes: &[u8]) -> &'static str {
    let start = &bytes[..bytes.len().min(512)];
    if std::str::from_utf8(start).is_ok_and(|t| !t.contains('\0')) {
        "a text file"
    } else {
        "bytes of an unknown kind"
    }
}

/// Whether the end-of-image marker follows the first scan (the marker of an embedded thumbnail comes before it).
fn jpeg_is_complete(bytes: &[u8]) -> bool {
    const START_OF_SCAN: u8 = 0xDA;
    const END_OF_IMAGE: [u8; 2] = [0xFF, 0xD9];
    let mut at = 2;
    while let Some(&[0xFF, marker, high, low]) = bytes.get(at..at + 4) {
        if marker == START_OF_SCAN {
            return bytes[at..].windows(2).any(|w| w == END_OF_IMAGE);
        }
        at += match marker {
            0xFF => 1,
            _ => 2 + usize::from(u16::from_be_bytes([high, low])),
        };
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    fn jpeg() -> Vec<u8> {
        let picture = image::RgbImage::from_fn(64, 48, |x, y| image::Rgb([x as u8 * 3, y as u8 * 5, 90]));
        let mut bytes = Vec::new();
        picture.write_to(&mut Cursor::new(&mut bytes), ImageFormat::Jpeg).unwrap();
        bytes
    }

    #[test]
    fn a_truncated_jpeg_is_not_taken_for_a_grey_one() {
        let bytes = jpeg();
        assert!(decode_photo(&bytes, "x.jpg").is_ok());
        let failure = decode_photo(&bytes[..bytes.len() / 2], "x.jpg").unwrap_err();
        assert_eq!(failure.code(), 3);
        assert!(failure.to_string().contains("truncated"), "{failure}");
    }

    #[test]
    fn exif_orientation_is_applied() {
        // An APP1 segment with one IFD entry: orientation (0x0112), SHORT, 1 value, 6 = turn by 90°.
        let tiff: Vec<u8> =
            [b"II*\0\x08\0\0\0".as_slice(), &[1, 0], &[0x12, 1, 3, 0, 1, 0, 0, 0, 6, 0, 0, 0], &[0, 0, 0, 0]]
                .concat();
        let mut segment = vec![0xFF, 0xE1];
        segment.extend_from_slice(&((tiff.len() + 8) as u16).to_be_bytes());
        segment.extend_from_slice(b"Exif\0\0");
        segment.extend_from_slice(&tiff);
        let plain = jpeg();
        let turned = [&plain[..2], &segment, &plain[2..]].concat();
        let (photo, orientation) = decode_photo(&turned, "x.jpg").unwrap();
        assert_eq!((photo.width(), photo.height()), (48, 64));
        assert_eq!(orientation, Orientation::Rotate90);
    }

    #[test]
    fn what_is_whole_but_not_read_is_not_called_damaged() {
        // A TIFF of one pixel in CIELab: width, height, bits per sample, compression, photometric interpretation, offset of
        // the pixel, samples per pixel, rows per strip, bytes of the strip.
        let entries: [[u16; 4]; 9] = [
            [256, 3, 1, 1],
            [257, 3, 1, 1],
            [258, 3, 3, 122],
            [259, 3, 1, 1],
            [262, 3, 1, 8],
            [273, 3, 1, 128],
            [277, 3, 1, 3],
            [278, 3, 1, 1],
            [279, 3, 1, 3],
        ];
        let mut tiff = b"II*\0\x08\0\0\0\x09\0".to_vec();
        for [tag, kind, count, value] in entries {
            for word in [tag, kind, count, 0, value, 0] {
                tiff.extend_from_slice(&word.to_le_bytes());
            }
        }
        tiff.extend_from_slice(&[0, 0, 0, 0]);
        tiff.extend_from_slice(&[8, 0, 8, 0, 8, 0, 50, 0, 0]);
        let failure = decode_photo(&tiff, "x.tif").unwrap_err().to_string();
        assert!(failure.contains("convert it") && !failure.contains("damaged"), "{failure}");
    }

    #[test]
    fn what_is_no_photograph_is_named() {
        for (bytes, word) in [
            (b"hello, this is text".as_slice(), "text file"),
            (b"\0\0\0\x18ftypheic\0\0\0\0", "heif-convert"),
            (b"GIF89a\0\0\0\0", "Gif"),
            (b"%PDF-1.7 ..", "PDF"),
        ] {
            let failure = decode_photo(bytes, "x.png").unwrap_err();
            assert_eq!(failure.code(), 3);
            assert!(failure.to_string().contains(word), "{failure}");
        }
    }
}
