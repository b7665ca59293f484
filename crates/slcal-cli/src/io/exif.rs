//! The EXIF tags of a photograph.

use std::io::Cursor;

use exif::{Exif, In, Reader, Tag, Value};
use slcal_core::{Orientation, PhotoTags};

use super::contained::contained;

/// The tags in the bytes of a photograph's file; the error says why there are none that can be read.
///
/// Tags of the wrong kind count as missing.
pub(crate) fn read_tags(bytes: &[u8]) -> Result<PhotoTags, String> {
    let read = contained(|| Reader::new().read_from_container(&mut Cursor::new(bytes)))?;
    let tags = read.map_err(|e| e.to_string())?;
    let number = |tag| number(&tags, tag);
    let whole = |tag| number(tag).filter(|n| (0.0..=f64::from(u32::MAX)).contains(n));
    let mut read = PhotoTags::default();
    read.make = text(&tags, Tag::Make);
    read.model = text(&tags, Tag::Model);
    read.focal_mm = number(Tag::FocalLength);
    read.focal_35mm = number(Tag::FocalLengthIn35mmFilm);
    read.focal_plane_x_resolution = number(Tag::FocalPlaneXResolution);
    read.focal_plane_unit = whole(Tag::FocalPlaneResolutionUnit).map(|unit| unit as u16);
    read.digital_zoom = number(Tag::DigitalZoomRatio);
    let sides = whole(Tag::PixelXDimension).zip(whole(Tag::PixelYDimension));
    read.pixels = sides.map(|(w, h)| [w as u32, h as u32]);
    read.orientation = Orientation::of_tag(whole(Tag::Orientation).unwrap_or(1.0) as u16);
    Ok(read)
}

fn number(tags: &Exif, tag: Tag) -> Option<f64> {
    // Programs that write tags do not all keep to the kinds of the standard.
    let number = match &tags.get_field(tag, In::PRIMARY)?.value {
        Value::Byte(v) => f64::from(*v.first()?),
        Value::Short(v) => f64::from(*v.first()?),
        Value::Long(v) => f64::from(*v.first()?),
        Value::SShort(v) => f64::from(*v.first()?),
        Value::SLong(v) => f64::from(*v.first()?),
        Value::Rational(v) => v.first()?.to_f64(),
        Value::SRational(v) => v.first()?.to_f64(),
        Value::Float(v) => f64::from(*v.first()?),
        Value::Double(v) => *v.first()?,
        _ => return None,
    };
    number.is_finite().then_some(number)
}

fn text(tags: &Exif, tag: Tag) -> Option<String> {
    match &tags.get_field(tag, In::PRIMARY)?.value {
        Value::Ascii(lines) => Some(String::from_utf8_lossy(lines.first()?).trim().to_owned()),
        _ => None,
    }
}
