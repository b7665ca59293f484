//! Photographs: PNG, JPEG, TIFF, WebP and BMP, turned upright by their EXIF orientation, with samples as sRGB codes them.

use std::io::Cursor;
use std::path::Path;

use image::metadata::Orientation;
use image::{ColorType, DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use slcal_core::PhotoTags;
use slcal_core::format::recognise;

use super::alpha::{Opacity, without_alpha};
use super::contained::contained;
use super::exif::read_tags;
use super::input_kind::InputKind;
use super::jpeg_segments::{START_OF_SCAN, segments};
use super::named_inks::{are_inks_named, decode_named_inks};
use super::photo_kind::{FORMATS, Foreign, format_of, what_it_is};
use super::picture_memory::{Picture, decoder_limit, has_inks};
use super::read::read_bytes;
use super::sample_coding::{Coding, coding};
use super::tiff_tag::tiff_tag;
use super::transfer_curve::to_srgb;
use crate::exit::{Exit, Failure, Outcome};
use crate::name::input_name;
use crate::output::{Printer, Remarks};

/// Limit of the size of photographs, checked before decoding: above any camera, below a file that is made
/// to exhaust the memory.
pub(super) const MAX_PIXELS: u64 = 250_000_000;

/// A picture of which more is fully transparent than this, %, has no content that can be trusted.
const MOST_TRANSPARENT_PERCENT: f64 = 99.0;

/// The tag of a TIFF's colour profile.
const ICC_PROFILE: u16 = 34675;

/// What the samples of a photograph are taken for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) enum Samples {
    /// What the file says, converted to sRGB where it is another coding.
    #[default]
    AsFileSays,
    /// What the user says: they stay as they are stored.
    AsStored,
}

/// A photograph from its file.
#[derive(Debug)]
pub(crate) struct Decoded {
    pub(crate) photo: DynamicImage,
    /// The orientation that was applied.
    pub(crate) orientation: Orientation,
    /// How samples were converted, if they were.
    pub(crate) converted: Option<String>,
    /// What the file says that was not followed.
    pub(crate) notes: Vec<String>,
}

/// Reads a photograph, from stdin for `-`.
pub(crate) fn load_photo(path: &Path, samples: Samples, printer: Printer) -> Outcome<DynamicImage> {
    let mut remarks = Remarks::default();
    let loaded = read_photo(path, samples, &mut remarks);
    printer.remarks(&remarks);
    loaded
}

/// A photograph and its EXIF tags, or why there are none that can be read.
pub(crate) type TaggedPhoto = (DynamicImage, Result<PhotoTags, String>);

/// Reads a photograph with its tags.
pub(crate) fn load_tagged_photo(path: &Path, samples: Samples, printer: Printer) -> Outcome<TaggedPhoto> {
    let mut remarks = Remarks::default();
    let loaded = read_photo_and_file(path, samples, &mut remarks);
    printer.remarks(&remarks);
    loaded.map(|(photo, bytes)| {
        let mut tags = read_tags(&bytes);
        if let Ok(tags) = &mut tags {
            // What was done counts.
            tags.orientation = slcal_core::Orientation::of_tag(photo.orientation.to_exif().into());
        }
        (photo.photo, tags)
    })
}

/// Reads a photograph without printing.
pub(crate) fn read_photo(path: &Path, samples: Samples, remarks: &mut Remarks) -> Outcome<DynamicImage> {
    read_photo_and_file(path, samples, remarks).map(|(decoded, _)| decoded.photo)
}

fn read_photo_and_file(path: &Path, samples: Samples, remarks: &mut Remarks) -> Outcome<(Decoded, Vec<u8>)> {
    let name = input_name(path);
    let bytes = read_bytes(path, InputKind::Photo)?;
    let decoded = decode_photo_as(&bytes, &name, samples)?;
    let photo = &decoded.photo;
    if decoded.orientation != Orientation::NoTransforms {
        remarks.note(format!(
            "{name}: rotated according to its EXIF orientation ({:?}): {}x{} pixels",
            decoded.orientation,
            photo.width(),
            photo.height()
        ));
    }
    if let Some(converted) = &decoded.converted {
        remarks.note(format!("{name}: {converted}; --gamma takes them as they are stored"));
    }
    for note in &decoded.notes {
        remarks.note(format!("{name}: {note}"));
    }
    remarks.detail(format!("{name}: {}x{} {:?}", photo.width(), photo.height(), photo.color()));
    Ok((decoded, bytes))
}

/// Decodes a photograph as its file says. `name` is for messages; its extension identifies camera raw files.
pub(crate) fn decode_photo(bytes: &[u8], name: &str) -> Outcome<Decoded> {
    decode_photo_as(bytes, name, Samples::AsFileSays)
}

/// Decodes a photograph with its samples as they are said to be.
pub(crate) fn decode_photo_as(bytes: &[u8], name: &str, samples: Samples) -> Outcome<Decoded> {
    if let Some(foreign) = Foreign::of(bytes, name) {
        return Err(refused(name, foreign.found(), foreign.advice()));
    }
    let format = format_of(bytes).ok_or_else(|| not_read(bytes, name))?;
    let undecoded = |e: &ImageError| match e {
        ImageError::Unsupported(_) => {
            let found = format!("a {format:?} of an unsupported kind ({e})");
            refused(name, &found, "convert it to an RGB PNG or TIFF with 8 or 16 bit first")
        }
        e => broken(name, format, e),
    };
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(decoder_limit(format, bytes));
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits);
    // The decoders are other crates': where one panics, its file is broken.
    let gave_up = |why: String| broken(name, format, &format_args!("its decoder gave up: {why}"));
    let mut decoder = contained(|| reader.into_decoder()).map_err(gave_up)?.map_err(|e| undecoded(&e))?;
    let (width, height) = decoder.dimensions();
    if width == 0 || height == 0 {
        return Err(broken(name, format, &format_args!("it has {width}x{height} pixels")));
    }
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(refused(
            name,
            &format!("{width}x{height} pixels, more than 250 megapixels"),
            "reduce the picture",
        ));
    }
    let orientation = contained(|| decoder.orientation()).map_err(gave_up)?;
    let orientation = orientation.unwrap_or(Orientation::NoTransforms);
    let says = match samples {
        // A profile that cannot be read is one that says nothing.
        Samples::AsFileSays => {
            let profile = match format {
                ImageFormat::Tiff => tiff_tag(bytes, ICC_PROFILE).map(<[u8]>::to_vec),
                _ => contained(|| decoder.icc_profile()).map_err(gave_up)?.ok().flatten(),
            };
            coding((format == ImageFormat::Png).then_some(bytes), profile.as_deref())
        }
        Samples::AsStored => Coding::Srgb(None),
    };
    if let Coding::Refused(coding) = says {
        return Err(refused(
            name,
            &format!("a {format:?} whose samples are coded by {coding}"),
            "convert it to sRGB, or to linear light with 16 bit and say so",
        ));
    }
    if format == ImageFormat::Jpeg && !jpeg_is_complete(bytes) {
        // The decoder fills missing data with grey.
        return Err(broken(name, format, &"the data ends before the picture does"));
    }
    if matches!(decoder.color_type(), ColorType::Rgb32F | ColorType::Rgba32F) {
        return Err(refused(name, "a picture of floating-point samples", "convert it to 16 bit"));
    }
    let named_inks = format == ImageFormat::Jpeg && are_inks_named(bytes);
    let picture = Picture {
        file: bytes,
        format,
        color: decoder.color_type(),
        pixels: u64::from(width) * u64::from(height),
        has_inks: named_inks || has_inks(&decoder),
        is_converted: matches!(says, Coding::Curves { .. }),
        is_turned: is_quarter(orientation),
    };
    if let Some(excess) = picture.excess() {
        return Err(refused(name, &excess, "reduce the picture"));
    }
    let photo = if named_inks {
        let decoded = contained(|| decode_named_inks(bytes)).map_err(gave_up)?;
        decoded.map_err(|why| broken(name, format, &why))?
    } else {
        let decoded = contained(|| DynamicImage::from_decoder(decoder)).map_err(gave_up)?;
        decoded.map_err(|e| undecoded(&e))?
    };
    let mut decoded = Decoded { photo, orientation, converted: None, notes: Vec::new() };
    decoded.notes.extend(transparency(&decoded.photo, name)?);
    decoded.photo = without_alpha(decoded.photo);
    match says {
        Coding::Curves { says, curves, narrow } => {
            decoded.photo = to_srgb(decoded.photo, &curves, narrow);
            decoded.converted = Some(format!("{says}; they were converted to sRGB, 16 bit"));
        }
        Coding::Srgb(note) => decoded.notes.extend(note),
        Coding::Refused(_) => {}
    }
    decoded.photo.apply_orientation(orientation);
    Ok(decoded)
}

/// What is said of pixels that are transparent; an error where nearly all are.
fn transparency(photo: &DynamicImage, name: &str) -> Outcome<Option<String>> {
    let Some(Opacity { hidden, opaque }) = Opacity::of(photo) else { return Ok(None) };
    if hidden > MOST_TRANSPARENT_PERCENT {
        let found = format!("a picture of which {hidden:.1} % is transparent");
        return Err(refused(name, &found, "give the photograph without an alpha channel"));
    }
    Ok((opaque < 100.0).then(|| {
        format!(
            "{:.1} % of its pixels are transparent or partly so; they are taken as they are stored",
            100.0 - opaque
        )
    }))
}

/// Whether an orientation exchanges width and height.
fn is_quarter(orientation: Orientation) -> bool {
    use Orientation::{Rotate90, Rotate90FlipH, Rotate270, Rotate270FlipH};
    matches!(orientation, Rotate90 | Rotate270 | Rotate90FlipH | Rotate270FlipH)
}

/// Why these bytes are no photograph that is read.
fn not_read(bytes: &[u8], name: &str) -> Failure {
    match image::guess_format(bytes) {
        Ok(format) => refused(name, &format!("{format:?}"), "convert it to PNG first"),
        Err(_) => refused(
            name,
            &recognise(bytes).unwrap_or_else(|| what_it_is(bytes).to_owned()),
            "the content decides, not the name; give the photograph itself",
        ),
    }
}

fn broken(name: &str, format: ImageFormat, why: &dyn std::fmt::Display) -> Failure {
    let found = format!("a {format:?} that cannot be decoded ({why})");
    refused(name, &found, "it is damaged or truncated; copy it again")
}

fn refused(name: &str, found: &str, advice: &str) -> Failure {
    Failure::new(Exit::Input, format!("{name}: expected a photograph ({FORMATS}), found {found}; {advice}"))
}

/// Whether the end-of-image marker follows the first scan (the marker of an embedded thumbnail comes before it).
fn jpeg_is_complete(bytes: &[u8]) -> bool {
    const END_OF_IMAGE: [u8; 2] = [0xFF, 0xD9];
    let scan = segments(bytes).find(|s| s.marker == START_OF_SCAN);
    scan.is_some_and(|scan| scan.rest.windows(2).any(|w| w == END_OF_IMAGE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{Rgba, RgbaImage};
    use slcal_core::photo::PhotoView;

    /// A file of `fixtures/kinds`.
    fn kind(name: &str) -> Vec<u8> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/kinds");
        std::fs::read(folder.join(name)).unwrap()
    }

    fn encoded(picture: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Vec::new();
        picture.write_to(&mut Cursor::new(&mut bytes), format).unwrap();
        bytes
    }

    /// A smooth picture with a size that no block of a codec divides.
    fn picture() -> DynamicImage {
        image::RgbImage::from_fn(61, 43, |x, y| image::Rgb([x as u8 * 4, y as u8 * 5, (x + y) as u8])).into()
    }

    /// A PNG with a chunk behind its header.
    fn with_chunk(png: &[u8], name: [u8; 4], content: &[u8]) -> Vec<u8> {
        let mut chunk = (content.len() as u32).to_be_bytes().to_vec();
        chunk.extend_from_slice(&name);
        chunk.extend_from_slice(content);
        let checked = chunk[4..].iter().fold(!0_u32, |crc, &byte| {
            (0..8)
                .fold(crc ^ u32::from(byte), |c, _| if c & 1 == 1 { 0xEDB8_8320 ^ (c >> 1) } else { c >> 1 })
        });
        chunk.extend((!checked).to_be_bytes());
        [&png[..33], &chunk, &png[33..]].concat()
    }

    fn farthest(a: &DynamicImage, b: &DynamicImage) -> u8 {
        assert_eq!((a.width(), a.height()), (b.width(), b.height()));
        let (a, b) = (a.to_rgb8(), b.to_rgb8());
        a.as_raw().iter().zip(b.as_raw()).map(|(a, b)| a.abs_diff(*b)).max().unwrap()
    }

    #[test]
    fn jpeg_files_of_inks_show_what_was_printed() {
        let source = image::load_from_memory(&kind("source.png")).unwrap();
        for name in ["cmyk.jpg", "ycck.jpg", "ycck_named_cmyk.jpg"] {
            let seen = decode_photo(&kind(name), name).unwrap();
            assert!(farthest(&seen.photo, &source) <= 4, "{name}");
        }
    }

    #[test]
    fn every_format_gives_the_same_pixels() {
        use ImageFormat::{Bmp, Png, Tiff, WebP};
        for picture in [picture(), picture().to_rgba8().into(), picture().to_luma8().into()] {
            for format in [Png, Tiff, WebP, Bmp] {
                let seen = decode_photo(&encoded(&picture, format), "x").unwrap();
                assert_eq!(seen.photo.to_rgb8(), picture.to_rgb8(), "{format:?}");
                assert!(seen.converted.is_none() && seen.notes.is_empty(), "{seen:?}");
            }
        }
    }

    #[test]
    fn what_a_png_says_of_its_samples_is_followed_unless_it_is_overruled() {
        let stored = picture().to_rgb16();
        let png = encoded(&stored.clone().into(), ImageFormat::Png);
        let linear = with_chunk(&png, *b"gAMA", &100_000_u32.to_be_bytes());
        let seen = decode_photo(&linear, "x.png").unwrap();
        let told = seen.converted.unwrap();
        assert!(told.contains("gAMA") && told.contains("linear") && told.contains("sRGB"), "{told}");
        let encoding = slcal_core::photo::Encoding::Srgb;
        for (new, old) in seen.photo.to_rgb16().as_raw().iter().zip(stored.as_raw()) {
            let light = encoding.to_linear(f64::from(*new) / 65535.0);
            // A step of 16-bit sRGB is at most 2.3 steps of linear light.
            assert!((light * 65535.0 - f64::from(*old)).abs() < 1.2, "{new} {old}");
        }
        let seen = decode_photo_as(&linear, "x.png", Samples::AsStored).unwrap();
        assert!(seen.converted.is_none() && seen.photo.to_rgb16() == stored);
        // sRGB before gAMA, and a gAMA that is nearly sRGB.
        let srgb = with_chunk(&linear, *b"sRGB", &[0]);
        let usual = with_chunk(&png, *b"gAMA", &45_455_u32.to_be_bytes());
        for bytes in [srgb, usual] {
            let seen = decode_photo(&bytes, "x.png").unwrap();
            assert!(seen.converted.is_none() && seen.photo.to_rgb16() == stored);
        }
        let bt709 = decode_photo(&with_chunk(&linear, *b"cICP", &[1, 1, 0, 1]), "x.png").unwrap();
        assert!(bt709.converted.unwrap().contains("BT.709"));
        let pq = decode_photo(&with_chunk(&linear, *b"cICP", &[9, 16, 0, 1]), "x.png").unwrap_err();
        assert!(pq.code() == 3 && pq.to_string().contains("PQ"), "{pq}");
    }

    #[test]
    fn colour_profiles_are_told_in_every_format_that_has_them() {
        use super::super::color_profile::tests::{exponent, rgb, srgb_curve};
        use image::ImageEncoder;
        use image::codecs::{jpeg::JpegEncoder, png::PngEncoder, tiff::TiffEncoder, webp::WebPEncoder};
        fn write(mut encoder: impl ImageEncoder, profile: Vec<u8>) {
            encoder.set_icc_profile(profile).unwrap();
            let picture = picture().to_rgb8();
            let (width, height) = picture.dimensions();
            encoder.write_image(picture.as_raw(), width, height, image::ExtendedColorType::Rgb8).unwrap();
        }
        for (profile, word, converted) in [
            (rgb("Display P3", &srgb_curve()), "Display P3", false),
            (rgb("Adobe RGB (1998)", &exponent(2.199_22)), "Adobe RGB (1998)", false),
            (rgb("Linear sRGB", b"curv\0\0\0\0\0\0\0\0"), "linear", true),
        ] {
            let mut files = [const { Vec::new() }; 3];
            write(JpegEncoder::new(&mut files[0]), profile.clone());
            write(PngEncoder::new(&mut files[1]), profile.clone());
            write(WebPEncoder::new_lossless(&mut files[2]), profile.clone());
            let mut tiff = Cursor::new(Vec::new());
            write(TiffEncoder::new(&mut tiff), profile);
            for bytes in files.into_iter().chain([tiff.into_inner()]) {
                let seen = decode_photo(&bytes, "x").unwrap();
                assert_eq!(seen.converted.is_some(), converted, "{seen:?}");
                let told = seen.converted.iter().chain(&seen.notes).any(|note| note.contains(word));
                assert!(told, "{word} {:?}: {:?}", image::guess_format(&bytes), seen.notes);
            }
        }
    }

    #[test]
    fn transparent_pixels_are_taken_and_told() {
        let show = |hidden: u32| {
            let picture = RgbaImage::from_fn(40, 50, |x, y| {
                Rgba([x as u8, y as u8, 9, if 40 * y + x < hidden { 0 } else { 255 }])
            });
            decode_photo(&encoded(&picture.into(), ImageFormat::Png), "x.png")
        };
        assert!(show(0).unwrap().notes.is_empty());
        let seen = show(500).unwrap();
        assert!(seen.notes[0].starts_with("25.0 %"), "{:?}", seen.notes);
        assert_eq!(seen.photo.to_rgb8().get_pixel(7, 3).0, [7, 3, 9]);
        let failure = show(1999).unwrap_err();
        assert!(failure.code() == 3 && failure.to_string().contains("transparent"), "{failure}");
    }

    #[test]
    fn unusual_png_files_are_read() {
        // 1 bit: rows of 8 pixels; a palette with a transparent entry.
        let small = |depth: u8, color: u8, chunks: &[(&[u8; 4], &[u8])], rows: &[u8]| {
            let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
            png.extend([0; 25]);
            let mut body = Vec::new();
            // Stored, not compressed, in a zlib stream.
            let length = rows.len() as u16;
            body.extend([0x78, 1, 1]);
            body.extend(length.to_le_bytes());
            body.extend((!length).to_le_bytes());
            body.extend(rows);
            let (a, b) = rows.iter().fold((1_u32, 0_u32), |(a, b), v| {
                let a = (a + u32::from(*v)) % 65521;
                (a, (a + b) % 65521)
            });
            body.extend(((b << 16) | a).to_be_bytes());
            let header = [&[0, 0, 0, 8, 0, 0, 0, 2], &[depth, color, 0, 0, 0][..]].concat();
            // Behind each other: the last that is put stands first.
            let all =
                [&[(b"IHDR", header.as_slice())], chunks, &[(b"IDAT", body.as_slice()), (b"IEND", &[])]]
                    .concat();
            let mut bytes = png[..33].to_vec();
            for (name, content) in all.iter().rev() {
                bytes = with_chunk(&bytes, **name, content);
            }
            [&bytes[..8], &bytes[33..]].concat()
        };
        let bits = small(1, 0, &[], &[0, 0b1010_0000, 0, 0b0000_0001]);
        let seen = decode_photo(&bits, "x.png").unwrap();
        let grey = seen.photo.to_luma8();
        assert_eq!(
            [grey.get_pixel(0, 0).0, grey.get_pixel(1, 0).0, grey.get_pixel(7, 1).0],
            [[255], [0], [255]]
        );
        let palette = small(
            8,
            3,
            &[(b"PLTE", &[10, 20, 30, 200, 100, 50]), (b"tRNS", &[0])],
            &[0, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 1, 1, 1, 1, 1, 1, 1],
        );
        let seen = decode_photo(&palette, "x.png").unwrap();
        assert_eq!(seen.photo.to_rgb8().get_pixel(0, 1).0, [10, 20, 30]);
        assert!(seen.notes[0].contains("transparent"), "{:?}", seen.notes);
        for deep in [DynamicImage::from(picture().to_rgba16()), picture().to_luma_alpha16().into()] {
            let seen = decode_photo(&encoded(&deep, ImageFormat::Png), "x.png").unwrap();
            assert_eq!(seen.photo.to_rgb16(), deep.to_rgb16());
            assert!(!seen.photo.color().has_alpha() && PhotoView::try_from(&seen.photo).is_ok());
        }
    }

    /// Files of every format.
    fn files() -> Vec<(ImageFormat, Vec<u8>)> {
        use ImageFormat::{Bmp, Jpeg, Png, Tiff, WebP};
        let mut files = [Png, Jpeg, Tiff, WebP, Bmp].map(|f| (f, encoded(&picture(), f))).to_vec();
        files.extend(["cmyk.jpg", "ycck.jpg", "ycck_named_cmyk.jpg"].map(|name| (Jpeg, kind(name))));
        // A grey BMP with a palette, as industrial cameras write it.
        files.push((Bmp, encoded(&picture().to_luma8().into(), Bmp)));
        files
    }

    #[test]
    fn files_that_are_cut_are_no_photographs() {
        for (format, bytes) in files() {
            for length in (0..bytes.len()).step_by(bytes.len().div_ceil(150)) {
                if let Ok(seen) = decode_photo(&bytes[..length], "x") {
                    // What comes behind the pixels may be missing.
                    let whole = decode_photo(&bytes, "x").unwrap().photo;
                    assert_eq!(seen.photo, whole, "{format:?} {length} of {}", bytes.len());
                }
            }
        }
    }

    #[test]
    fn files_that_lie_about_their_size_do_no_harm() {
        let sizes = [0_u32, 1, 0x1000, 60_000, 0xFFFF, 0x7FFF_FFFF, u32::MAX];
        for (format, bytes) in files() {
            let at = |marker: &[u8], behind: usize| {
                bytes.windows(marker.len()).position(|w| w == marker).unwrap() + behind
            };
            // Where width and height stand, in how many bytes, and in which order these are.
            let (places, wide, big) = match format {
                ImageFormat::Png => ([16, 20], 4, true),
                ImageFormat::Jpeg => ([at(&[0xFF, 0xC0], 5), at(&[0xFF, 0xC0], 7)], 2, true),
                ImageFormat::Bmp => ([18, 22], 4, false),
                ImageFormat::WebP => ([at(b"VP8L", 9), at(b"VP8L", 10)], 2, false),
                _ => ([at(&[0, 1, 4, 0], 8), at(&[1, 1, 4, 0], 8)], 4, false),
            };
            for place in [&places[..1], &places[1..], &places[..]] {
                for size in sizes {
                    let mut lying = bytes.clone();
                    for &place in place {
                        let big_endian = &size.to_be_bytes()[4 - wide..];
                        let written = if big { big_endian } else { &size.to_le_bytes()[..wide] };
                        lying[place..place + wide].copy_from_slice(written);
                    }
                    if let Err(failure) = decode_photo(&lying, "x") {
                        assert_eq!(failure.code(), 3, "{failure}");
                    }
                }
            }
        }
    }

    #[test]
    fn no_changed_byte_makes_it_panic() {
        for (_, bytes) in files() {
            for at in 0..bytes.len().min(700) {
                for value in [0, 0xFF, bytes[at] ^ 0x80] {
                    let mut changed = bytes.clone();
                    changed[at] = value;
                    // Gigantic pictures only take time here.
                    let _ = decode_photo(&changed, "x");
                }
            }
        }
    }

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
        let Decoded { photo, orientation, .. } = decode_photo(&turned, "x.jpg").unwrap();
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
            (b"\0\0\0\x18ftypheic\0\0\0\0", "Most Compatible"),
            (b"GIF89a\0\0\0\0", "Gif"),
            (b"%PDF-1.7 ..", "PDF"),
        ] {
            let failure = decode_photo(bytes, "x.png").unwrap_err();
            assert_eq!(failure.code(), 3);
            assert!(failure.to_string().contains(word), "{failure}");
        }
    }
}
