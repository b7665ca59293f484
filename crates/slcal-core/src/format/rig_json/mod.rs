//! rig.json (`"schema": "slcal-rig/1"`): a calibrated rig as text.
//!
//! Required on reading: schema, units, `pixel_centre`, camera and projector {width, height, K, distortion},
//! `projector_from_camera` {R, t}; the projector and what belongs to it may be null. Everything else is optional and
//! unknown fields are skipped. Numbers are written with the fewest digits that read back to the same `f64`.

mod read;
mod write;

use std::io::{Read, Write};

pub(super) use read::exact_pose;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::error::{Error, ErrorSubject, Result};
use crate::rig::{Rig, Verdict, Warning};

const SCHEMA: &str = "slcal-rig/1";
const UNITS: &str = "mm";
const PIXEL_CENTRE: &str = "integer";

type Rows3 = [[f64; 3]; 3];

#[derive(Deserialize)]
struct RigDto {
    schema: String,
    units: String,
    pixel_centre: String,
    camera: Value,
    projector: Value,
    projector_from_camera: Value,
    #[serde(default)]
    views: Vec<Value>,
    #[serde(default)]
    method: Option<String>,
    #[serde(default)]
    quality: Value,
    #[serde(default)]
    covariance: Value,
}

#[derive(Serialize, Deserialize)]
struct DeviceDto {
    width: u32,
    height: u32,
    #[serde(rename = "K")]
    k: Rows3,
    distortion: [f64; 5],
    #[serde(default)]
    sigma: Option<SigmaDto>,
}

#[derive(Serialize, Deserialize)]
struct SigmaDto {
    focal_px: Option<f64>,
    cx_px: Option<f64>,
    cy_px: Option<f64>,
    distortion: Option<[f64; 5]>,
}

#[derive(Serialize, Deserialize)]
struct StereoDto {
    #[serde(rename = "R")]
    r: Rows3,
    t: [f64; 3],
    #[serde(default)]
    sigma_t_mm: Option<[f64; 3]>,
    #[serde(default)]
    sigma_r_rad: Option<[f64; 3]>,
}

#[derive(Serialize, Deserialize)]
struct PoseDto {
    #[serde(rename = "R")]
    r: Rows3,
    t: [f64; 3],
}

#[derive(Serialize, Deserialize)]
struct VanishingDto {
    camera: Option<[[f64; 3]; 2]>,
    projector: Option<[[f64; 3]; 2]>,
}

#[derive(Serialize, Deserialize)]
struct RmsDto {
    edges: Option<f64>,
    corners: Option<f64>,
    projector: Option<f64>,
}

#[derive(Serialize, Deserialize)]
struct ViewDto {
    photo: Option<String>,
    size_mm: Option<[f64; 2]>,
    camera_from_sheet: Option<PoseDto>,
    projector_from_sheet: Option<PoseDto>,
    vanishing_points: Option<VanishingDto>,
    corners_px: Option<[[f64; 2]; 4]>,
    rms_px: Option<RmsDto>,
}

#[derive(Serialize, Deserialize)]
struct FocalSigmaDto {
    camera: Option<f64>,
    projector: Option<f64>,
}

#[derive(Serialize, Deserialize)]
struct QualityDto {
    verdict: Option<Verdict>,
    focal_sigma_percent: Option<FocalSigmaDto>,
    expected_point_sigma_mm: Option<f64>,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    cause: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    advice: String,
    #[serde(default)]
    warnings: Vec<Warning>,
}

#[derive(Serialize, Deserialize)]
struct CovarianceDto {
    parameters: Vec<String>,
    matrix: Vec<Vec<f64>>,
}

fn malformed(detail: impl Into<String>) -> Error {
    Error::malformed(ErrorSubject::RigFile, detail)
}

/// Reads a rig.
///
/// A view without `size_mm` or `camera_from_sheet` says nothing that a rig could use and is left out; its other fields
/// are derived from the rig where they are missing.
///
/// # Errors
/// [`Error::Malformed`] naming the field when the text is not JSON, a required field is missing, or a value is not what
/// the schema says (R not a rotation, K not upper triangular with positive focal lengths, other units);
/// [`Error::Io`] when the stream fails.
pub fn read_rig(mut input: impl Read) -> Result<Rig> {
    let mut text = Vec::new();
    input.read_to_end(&mut text).map_err(|e| Error::reading(ErrorSubject::RigFile, e))?;
    rig_of_value(
        serde_json::from_slice(&text).map_err(|e| Error::unparsable(ErrorSubject::RigFile, "JSON", e))?,
    )
}

/// The rig of the values that [`read_rig`] reads.
pub(super) fn rig_of_value(value: Value) -> Result<Rig> {
    let Some(object) = value.as_object() else {
        return Err(malformed("expected an object with \"schema\": \"slcal-rig/1\""));
    };
    // `Value` fields that are absent would read as null: tell "missing" from "null" first.
    for field in ["schema", "units", "pixel_centre", "camera", "projector", "projector_from_camera"] {
        if !object.contains_key(field) {
            return Err(malformed(format!("missing field `{field}`")));
        }
    }
    let dto: RigDto = read::parse(value, "the rig")?;
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
pub fn write_rig(rig: &Rig, mut output: impl Write) -> Result<()> {
    let dto = write::rig_to_dto(rig)?;
    let failed = |e| Error::writing(ErrorSubject::RigFile, e);
    serde_json::to_writer_pretty(&mut output, &dto).map_err(|e| failed(e.into()))?;
    output.write_all(b"\n").and_then(|()| output.flush()).map_err(failed)
}

#[cfg(test)]
mod tests;
