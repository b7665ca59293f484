//! rig.json (`"schema": "slcal-rig/1"`): a calibrated rig as text.
//!
//! Required on reading: schema, units, `pixel_centre`, camera and projector {width, height, K, distortion},
//! `projector_from_camera` {R, t}; the projector and its fields may be null. Everything else is optional and
//! unknown fields are skipped. Numbers are written with the fewest digits that read back to the same `f64`.

mod read;
mod schema;
mod write;

use std::io::{Read, Write};

pub(super) use read::exact_pose;

use serde_json::Value;

use self::schema::{PIXEL_CENTRE, RigDto, SCHEMA, UNITS, malformed};
use super::recognise::read_json;
use crate::error::{Error, ErrorSubject, Result};
use crate::rig::Rig;

/// Reads a rig.
///
/// A view without `size_mm` or `camera_from_sheet` is left out. Other missing fields of a view are derived from the rig.
///
/// # Errors
/// [`Error::Malformed`] naming the field when the text is not JSON, a required field is missing, or a value is not what
/// the schema says (R not a rotation, K not upper triangular with positive focal lengths, other units);
/// [`Error::Io`] when the stream fails.
pub fn read_rig(input: impl Read) -> Result<Rig> {
    rig_of_value(read_json(input, ErrorSubject::RigFile, "a rig")?)
}

/// The rig of the values that [`read_rig`] reads.
pub(super) fn rig_of_value(value: Value) -> Result<Rig> {
    let Value::Object(mut object) = value else {
        return Err(malformed("expected an object with \"schema\": \"slcal-rig/1\""));
    };
    // Absent `Value` fields would read as null: distinguish "missing" from "null" first.
    for field in ["schema", "units", "pixel_centre", "camera", "projector", "projector_from_camera"] {
        if !object.contains_key(field) {
            return Err(malformed(format!("missing field `{field}`")));
        }
    }
    // Moved rather than read by serde, which would build them again beside those that are there.
    let views = match object.remove("views") {
        None => Vec::new(),
        Some(Value::Array(views)) => views,
        Some(_) => return Err(malformed("views: expected a list with one entry per photograph")),
    };
    let mut moved = |name: &str| object.remove(name).unwrap_or_default();
    let [camera, projector, projector_from_camera] =
        ["camera", "projector", "projector_from_camera"].map(&mut moved);
    let [quality, covariance, channel_registration] =
        ["quality", "covariance", "channel_registration"].map(&mut moved);
    let dto: RigDto = read::parse(Value::Object(object), "the rig")?;
    let dto = RigDto {
        camera,
        projector,
        projector_from_camera,
        views,
        quality,
        covariance,
        channel_registration,
        ..dto
    };
    read::expect(&dto.schema, SCHEMA, "schema")?;
    read::expect(&dto.units, UNITS, "units")?;
    read::expect(&dto.pixel_centre, PIXEL_CENTRE, "pixel_centre")?;
    read::rig_from_dto(dto)
}

/// The values that [`write_rig`] writes.
pub(super) fn rig_value(rig: &Rig) -> Result<Value> {
    serde_json::to_value(write::rig_to_dto(rig)?).map_err(|e| Error::writing(ErrorSubject::RigFile, e))
}

/// Writes a rig as indented JSON with a final newline.
///
/// # Errors
/// [`Error::Invalid`] when a number is not finite; [`Error::Io`] when the stream fails.
///
/// # Examples
/// ```
/// use slcal_core::format::{read_rig, write_rig};
///
/// # let rig = slcal_core::format::read_rig(&include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/../slcal-cli/demo/truth_rig.json"))[..])?;
/// let mut bytes = Vec::new(); // or a file: anything that is std::io::Write
/// write_rig(&rig, &mut bytes)?;
/// assert_eq!(read_rig(bytes.as_slice())?, rig);
/// # Ok::<(), slcal_core::Error>(())
/// ```
pub fn write_rig(rig: &Rig, mut output: impl Write) -> Result<()> {
    let dto = write::rig_to_dto(rig)?;
    let failed = |e| Error::writing(ErrorSubject::RigFile, e);
    serde_json::to_writer_pretty(&mut output, &dto).map_err(|e| failed(e.into()))?;
    output.write_all(b"\n").and_then(|()| output.flush()).map_err(failed)
}

#[cfg(test)]
mod tests;
