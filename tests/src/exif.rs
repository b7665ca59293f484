//! EXIF blocks in JPEG files, as cameras and programs write them, true or not.

/// The value of a tag.
#[derive(Debug, Clone)]
pub enum ExifValue {
    /// An unsigned number of 16 bit.
    Short(u16),
    /// An unsigned number of 32 bit.
    Long(u32),
    /// A fraction.
    Rational(u32, u32),
    /// A text.
    Ascii(&'static str),
}

use ExifValue::{Ascii, Long, Rational, Short};

/// `Orientation`.
#[must_use]
pub fn orientation(value: u16) -> (u16, ExifValue) {
    (0x0112, Short(value))
}

/// `PixelXDimension` and `PixelYDimension`.
#[must_use]
pub fn pixels([w, h]: [u32; 2]) -> [(u16, ExifValue); 2] {
    [(0xA002, Long(w)), (0xA003, Long(h))]
}

/// `FocalLengthIn35mmFilm`, mm.
#[must_use]
pub fn focal_35mm(mm: u16) -> (u16, ExifValue) {
    (0xA405, Short(mm))
}

/// `FocalLength`, mm.
#[must_use]
pub fn focal_length(mm: f64) -> (u16, ExifValue) {
    (0x920A, Rational((mm * 1000.0).round() as u32, 1000))
}

/// `Model`.
#[must_use]
pub fn model(name: &'static str) -> (u16, ExifValue) {
    (0x0110, Ascii(name))
}

/// The bytes of a JPEG with these tags. Tags of the camera and the orientation stand in the first directory, the others in
/// the one that it points to.
///
/// # Panics
/// When the block is larger than a segment of a JPEG.
#[must_use]
pub fn with_exif(jpeg: &[u8], tags: &[(u16, ExifValue)]) -> Vec<u8> {
    const POINTER: u16 = 0x8769;
    let (mut first, mut second): (Vec<_>, Vec<_>) = tags.iter().cloned().partition(|(tag, _)| *tag < POINTER);
    first.push((POINTER, Long(0)));
    first.sort_by_key(|(tag, _)| *tag);
    second.sort_by_key(|(tag, _)| *tag);
    let length = |entries: &[(u16, ExifValue)]| 2 + 12 * entries.len() + 4;
    let second_at = 8 + length(&first);
    let mut heap_at = second_at + length(&second);
    let (mut directories, mut heap) = (Vec::new(), Vec::new());
    for entries in [&first, &second] {
        directories.extend_from_slice(&(entries.len() as u16).to_le_bytes());
        for (tag, value) in entries {
            let (kind, count, inline, out_of_line): (u16, u32, u32, Vec<u8>) = match value {
                Long(_) if *tag == POINTER => (4, 1, second_at as u32, Vec::new()),
                Long(v) => (4, 1, *v, Vec::new()),
                Short(v) => (3, 1, u32::from(*v), Vec::new()),
                Rational(a, b) => (5, 1, heap_at as u32, [a.to_le_bytes(), b.to_le_bytes()].concat()),
                Ascii(text) => {
                    // Short texts stand in the entry itself.
                    assert!(text.len() > 3, "a text of four letters or more");
                    (2, text.len() as u32 + 1, heap_at as u32, [text.as_bytes(), b"\0"].concat())
                }
            };
            heap_at += out_of_line.len();
            heap.extend_from_slice(&out_of_line);
            for bytes in
                [&tag.to_le_bytes()[..], &kind.to_le_bytes(), &count.to_le_bytes(), &inline.to_le_bytes()]
            {
                directories.extend_from_slice(bytes);
            }
        }
        directories.extend_from_slice(&[0; 4]);
    }
    let block = [b"Exif\0\0II*\0\x08\0\0\0".as_slice(), &directories, &heap].concat();
    let size = u16::try_from(block.len() + 2).expect("a small block");
    [&jpeg[..2], &[0xFF, 0xE1], &size.to_be_bytes(), &block, &jpeg[2..]].concat()
}
