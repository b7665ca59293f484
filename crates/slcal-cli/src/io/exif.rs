//! The focal length in the EXIF tags of a photograph.

use std::io::Cursor;
use std::path::Path;

use exif::{In, Reader, Tag, Value};

use crate::exit::{Failure, Outcome};

/// Relative difference of two aspect ratios beyond which one picture is not the other resized.
const SAME_SHAPE: f64 = 0.01;
/// Plausible 35 mm equivalents, mm: from fisheyes to telescopes.
const PLAUSIBLE_MM: std::ops::RangeInclusive<f64> = 5.0..=5000.0;

/// The 35 mm equivalent focal length, mm, of a photograph with the bytes of its file and the size of its upright
/// picture.
///
/// A digital zoom is refused, because the tag may or may not include it. So are pictures that were cropped
/// afterwards.
pub(crate) fn focal_35mm(path: &Path, bytes: &[u8], size: [u32; 2]) -> Outcome<f64> {
    let refused = |found: &str| {
        let message = format!(
            "--exif: expected the EXIF tag FocalLengthIn35mmFilm of an uncropped photograph, found {found}; give the photograph \
             as the camera wrote it, or leave --exif out"
        );
        Failure::input(path, message)
    };
    let tags = Reader::new()
        .read_from_container(&mut Cursor::new(bytes))
        .map_err(|e| refused(&format!("no readable tags ({e})")))?;
    let number = |tag| tags.get_field(tag, In::PRIMARY).and_then(|f| first_number(&f.value));
    let Some(equivalent) = number(Tag::FocalLengthIn35mmFilm).filter(|f| *f != 0.0) else {
        let real = number(Tag::FocalLength).map_or_else(
            || "no focal length".to_owned(),
            |f| format!("only the actual focal length, {f:.2} mm, for a sensor of unknown size"),
        );
        return Err(refused(&real));
    };
    if !PLAUSIBLE_MM.contains(&equivalent) {
        return Err(refused(&format!("{equivalent} mm")));
    }
    // Zero means no digital zoom.
    if let Some(zoom) = number(Tag::DigitalZoomRatio).filter(|z| *z != 0.0 && (z - 1.0).abs() > SAME_SHAPE) {
        return Err(refused(&format!("a digital zoom of {zoom:.2}, which the tag may or may not include")));
    }
    if let (Some(w), Some(h)) = (number(Tag::PixelXDimension), number(Tag::PixelYDimension))
        && w > 0.0
        && h > 0.0
    {
        // The tags are from before the rotation.
        let shape = |a: f64, b: f64| a.max(b) / a.min(b);
        let here = shape(f64::from(size[0]), f64::from(size[1]));
        if (shape(w, h) / here - 1.0).abs() > SAME_SHAPE {
            return Err(refused(&format!("{}x{} pixels of a photograph of {w}x{h}", size[0], size[1])));
        }
    }
    Ok(equivalent)
}

fn first_number(value: &Value) -> Option<f64> {
    let number = match value {
        Value::Short(v) => v.first().map(|x| f64::from(*x)),
        Value::Long(v) => v.first().map(|x| f64::from(*x)),
        Value::Rational(v) => v.first().map(exif::Rational::to_f64),
        _ => None,
    };
    number.filter(|x| x.is_finite())
}
