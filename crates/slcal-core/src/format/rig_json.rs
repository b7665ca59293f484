//! rig.json (`"schema": "slcal-rig/1"`): a calibrated rig as text.
//!
//! Required on reading: schema, units, `pixel_centre`, camera and projector {width, height, K, distortion},
//! `projector_from_camera` {R, t}; the projector and what belongs to it may be null. Everything else is optional and
//! unknown fields are skipped. Numbers are written with the fewest digits that read back to the same `f64`.

use std::io::{Read, Write};

use nalgebra::{DMatrix, Matrix3, Point2, Rotation3, Vector3};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::error::{Error, Result};
use crate::geometry::{
    Camera, Distortion, Homography, Intrinsics, Pose, ProjectivePoint, RectangleSize, VanishingPoints,
};
use crate::rig::{
    Covariance, Device, DeviceSigma, Quality, Rig, StereoPose, Verdict, View, ViewRms, Warning,
};

const WHAT: &str = "rig JSON";
const SCHEMA: &str = "slcal-rig/1";
const UNITS: &str = "mm";
const PIXEL_CENTRE: &str = "integer";
/// A matrix this near to a rotation is kept digit by digit, so that a rig survives writing and reading unchanged.
const EXACT_ROTATION: f64 = 1e-12;

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
    #[serde(default)]
    warnings: Vec<Warning>,
}

#[derive(Serialize, Deserialize)]
struct CovarianceDto {
    parameters: Vec<String>,
    matrix: Vec<Vec<f64>>,
}

fn malformed(detail: impl Into<String>) -> Error {
    Error::Malformed { what: WHAT, detail: detail.into() }
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
    input
        .read_to_end(&mut text)
        .map_err(|e| Error::Io { what: "reading a rig JSON", detail: e.to_string() })?;
    let value: Value = serde_json::from_slice(&text).map_err(|e| malformed(e.to_string()))?;
    let Some(object) = value.as_object() else {
        return Err(malformed("expected an object with \"schema\": \"slcal-rig/1\""));
    };
    // `Value` fields that are absent would read as null: tell "missing" from "null" first.
    for field in ["schema", "units", "pixel_centre", "camera", "projector", "projector_from_camera"] {
        if !object.contains_key(field) {
            return Err(malformed(format!("missing field `{field}`")));
        }
    }
    let dto: RigDto = parse(value, "the rig")?;
    expect(&dto.schema, SCHEMA, "schema")?;
    expect(&dto.units, UNITS, "units")?;
    expect(&dto.pixel_centre, PIXEL_CENTRE, "pixel_centre")?;
    rig_from_dto(dto)
}

/// Writes a rig as indented JSON with a final newline.
///
/// # Errors
/// [`Error::Invalid`] when a number is not finite; [`Error::Io`] when the stream fails.
pub fn write_rig(rig: &Rig, mut output: impl Write) -> Result<()> {
    let dto = rig_to_dto(rig)?;
    let io = |e: &dyn std::fmt::Display| Error::Io { what: "writing a rig JSON", detail: e.to_string() };
    serde_json::to_writer_pretty(&mut output, &dto).map_err(|e| io(&e))?;
    output.write_all(b"\n").map_err(|e| io(&e))?;
    output.flush().map_err(|e| io(&e))
}

fn parse<T: DeserializeOwned>(value: Value, place: &str) -> Result<T> {
    serde_json::from_value(value).map_err(|e| malformed(format!("{place}: {e}")))
}

fn parse_optional<T: DeserializeOwned>(value: Value, place: &str) -> Result<Option<T>> {
    if value.is_null() { Ok(None) } else { parse(value, place).map(Some) }
}

fn expect(found: &str, expected: &str, field: &str) -> Result<()> {
    if found == expected {
        return Ok(());
    }
    Err(malformed(format!("`{field}` is \"{found}\", expected \"{expected}\"")))
}

fn rig_from_dto(dto: RigDto) -> Result<Rig> {
    let camera = device_from_dto(parse(dto.camera, "camera")?, "camera")?;
    let projector =
        parse_optional(dto.projector, "projector")?.map(|d| device_from_dto(d, "projector")).transpose()?;
    let stereo = parse_optional::<StereoDto>(dto.projector_from_camera, "projector_from_camera")?
        .map(|s| {
            Ok(StereoPose {
                projector_from_camera: pose_from_rows(&s.r, s.t, "projector_from_camera")?,
                sigma_t_mm: s.sigma_t_mm,
                sigma_r_rad: s.sigma_r_rad,
            })
        })
        .transpose()?;
    if projector.is_some() != stereo.is_some() {
        return Err(malformed("`projector` and `projector_from_camera` must both be given or both be null"));
    }
    let mut views = Vec::new();
    for (i, value) in dto.views.into_iter().enumerate() {
        let place = format!("views[{i}]");
        let view: ViewDto = parse(value, &place)?;
        views.extend(view_from_dto(view, &place, &camera.model, projector.as_ref(), stereo.as_ref())?);
    }
    Ok(Rig {
        camera,
        projector,
        stereo,
        views,
        method: dto.method.unwrap_or_else(|| "unknown".into()),
        quality: parse_optional(dto.quality, "quality")?.and_then(quality_from_dto),
        covariance: parse_optional(dto.covariance, "covariance")?.map(covariance_from_dto).transpose()?,
    })
}

fn matrix_from_rows(m: &Rows3) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| m[i][j])
}

fn rows_from_matrix(m: &Matrix3<f64>) -> Rows3 {
    std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)]))
}

fn device_from_dto(dto: DeviceDto, place: &str) -> Result<Device> {
    if dto.width == 0 || dto.height == 0 {
        return Err(malformed(format!("{place}: width and height must be positive")));
    }
    let k = matrix_from_rows(&dto.k);
    let intrinsics = Intrinsics::from_matrix(&k).map_err(|e| malformed(format!("{place}: {e}")))?;
    let sigma = dto.sigma.and_then(|s| {
        let (focal_px, cx_px, cy_px) = (s.focal_px?, s.cx_px?, s.cy_px?);
        Some(DeviceSigma { focal_px, cx_px, cy_px, distortion: s.distortion.unwrap_or_default() })
    });
    let distortion = Distortion::from_array(dto.distortion);
    Ok(Device { model: Camera { width: dto.width, height: dto.height, intrinsics, distortion }, sigma })
}

fn pose_from_rows(r: &Rows3, t: [f64; 3], place: &str) -> Result<Pose> {
    let matrix = matrix_from_rows(r);
    let pose =
        Pose::from_matrix(&matrix, Vector3::from(t)).map_err(|e| malformed(format!("{place}: {e}")))?;
    if (matrix.transpose() * matrix - Matrix3::identity()).abs().max() <= EXACT_ROTATION {
        return Ok(Pose { rotation: Rotation3::from_matrix_unchecked(matrix), ..pose });
    }
    Ok(pose)
}

fn vanishing_from_rows([x, y]: [[f64; 3]; 2]) -> VanishingPoints {
    VanishingPoints { x: ProjectivePoint(Vector3::from(x)), y: ProjectivePoint(Vector3::from(y)) }
}

fn vanishing_points_of(device: &Camera, device_from_sheet: &Pose) -> VanishingPoints {
    Homography(device.intrinsics.matrix() * device_from_sheet.rotation.matrix()).vanishing_points()
}

fn view_from_dto(
    dto: ViewDto,
    place: &str,
    camera: &Camera,
    projector: Option<&Device>,
    stereo: Option<&StereoPose>,
) -> Result<Option<View>> {
    let (Some([w, h]), Some(pose)) = (dto.size_mm, dto.camera_from_sheet) else { return Ok(None) };
    let size = RectangleSize::new(w, h).map_err(|e| malformed(format!("{place}: {e}")))?;
    let camera_from_sheet = pose_from_rows(&pose.r, pose.t, &format!("{place}.camera_from_sheet"))?;
    let projector_from_sheet = match dto.projector_from_sheet {
        Some(p) => Some(pose_from_rows(&p.r, p.t, &format!("{place}.projector_from_sheet"))?),
        None => stereo.map(|s| s.projector_from_camera.compose(&camera_from_sheet)),
    };
    let given = dto.vanishing_points.unwrap_or(VanishingDto { camera: None, projector: None });
    let corners_px = match dto.corners_px {
        Some(c) => c.map(|[x, y]| Point2::new(x, y)),
        None => project_corners(camera, &camera_from_sheet, size)
            .ok_or_else(|| malformed(format!("{place}: the sheet lies behind the camera")))?,
    };
    Ok(Some(View {
        photo: dto.photo,
        size,
        camera_from_sheet,
        projector_from_sheet,
        camera_vanishing_points: given
            .camera
            .map_or_else(|| vanishing_points_of(camera, &camera_from_sheet), vanishing_from_rows),
        projector_vanishing_points: given
            .projector
            .map(vanishing_from_rows)
            .or_else(|| Some(vanishing_points_of(&projector?.model, projector_from_sheet.as_ref()?))),
        corners_px,
        rms_px: dto
            .rms_px
            .and_then(|r| Some(ViewRms { edges: r.edges?, corners: r.corners, projector: r.projector })),
    }))
}

fn project_corners(camera: &Camera, pose: &Pose, size: RectangleSize) -> Option<[Point2<f64>; 4]> {
    let mut corners = size.corners();
    for c in &mut corners {
        *c = camera.project(&pose.transform(&nalgebra::Point3::new(c.x, c.y, 0.0)))?;
    }
    Some(corners)
}

fn quality_from_dto(dto: QualityDto) -> Option<Quality> {
    let sigma = dto.focal_sigma_percent?;
    Some(Quality {
        verdict: dto.verdict?,
        focal_sigma_percent_camera: sigma.camera?,
        focal_sigma_percent_projector: sigma.projector,
        expected_point_sigma_mm: dto.expected_point_sigma_mm,
        warnings: dto.warnings,
    })
}

fn covariance_from_dto(dto: CovarianceDto) -> Result<Covariance> {
    let n = dto.parameters.len();
    if dto.matrix.len() != n || dto.matrix.iter().any(|row| row.len() != n) {
        return Err(malformed(format!("covariance: expected a {n}x{n} matrix for {n} parameters")));
    }
    Ok(Covariance { matrix: DMatrix::from_fn(n, n, |i, j| dto.matrix[i][j]), parameters: dto.parameters })
}

/// JSON has no NaN: refuse it here instead of writing a null that nobody can read.
fn finite<'a>(numbers: impl IntoIterator<Item = &'a f64>, what: &str) -> Result<()> {
    match numbers.into_iter().find(|x| !x.is_finite()) {
        Some(x) => Err(Error::invalid(format!("rig to write, {what}"), "finite numbers", x)),
        None => Ok(()),
    }
}

fn rig_to_dto(rig: &Rig) -> Result<impl Serialize> {
    // The order of the fields in the file is the order in which they are declared here.
    #[derive(Serialize)]
    struct RigOut {
        schema: &'static str,
        units: &'static str,
        pixel_centre: &'static str,
        camera: DeviceDto,
        projector: Option<DeviceDto>,
        projector_from_camera: Option<StereoDto>,
        views: Vec<ViewDto>,
        method: String,
        quality: Option<QualityDto>,
        covariance: Option<CovarianceDto>,
    }
    let out = RigOut {
        schema: SCHEMA,
        units: UNITS,
        pixel_centre: PIXEL_CENTRE,
        camera: device_to_dto(&rig.camera, "camera")?,
        projector: rig.projector.as_ref().map(|d| device_to_dto(d, "projector")).transpose()?,
        projector_from_camera: rig.stereo.as_ref().map(stereo_to_dto).transpose()?,
        views: rig.views.iter().map(view_to_dto).collect::<Result<_>>()?,
        method: rig.method.clone(),
        quality: rig.quality.as_ref().map(quality_to_dto).transpose()?,
        covariance: rig.covariance.as_ref().map(covariance_to_dto).transpose()?,
    };
    Ok(out)
}

fn device_to_dto(d: &Device, what: &str) -> Result<DeviceDto> {
    let k = d.model.intrinsics.matrix();
    let distortion = d.model.distortion.to_array();
    finite(k.iter().chain(&distortion), what)?;
    if let Some(s) = &d.sigma {
        finite([s.focal_px, s.cx_px, s.cy_px].iter().chain(&s.distortion), what)?;
    }
    Ok(DeviceDto {
        width: d.model.width,
        height: d.model.height,
        k: rows_from_matrix(&k),
        distortion,
        sigma: d.sigma.map(|s| SigmaDto {
            focal_px: Some(s.focal_px),
            cx_px: Some(s.cx_px),
            cy_px: Some(s.cy_px),
            distortion: Some(s.distortion),
        }),
    })
}

fn pose_to_dto(p: &Pose, what: &str) -> Result<PoseDto> {
    finite(p.rotation.matrix().iter().chain(&p.translation), what)?;
    Ok(PoseDto { r: rows_from_matrix(p.rotation.matrix()), t: p.translation.into() })
}

fn stereo_to_dto(s: &StereoPose) -> Result<StereoDto> {
    let pose = pose_to_dto(&s.projector_from_camera, "projector_from_camera")?;
    finite(s.sigma_t_mm.iter().chain(&s.sigma_r_rad).flatten(), "projector_from_camera")?;
    Ok(StereoDto { r: pose.r, t: pose.t, sigma_t_mm: s.sigma_t_mm, sigma_r_rad: s.sigma_r_rad })
}

fn view_to_dto(v: &View) -> Result<ViewDto> {
    let rows = |v: &VanishingPoints| [v.x.0.into(), v.y.0.into()];
    let camera: [[f64; 3]; 2] = rows(&v.camera_vanishing_points);
    let projector = v.projector_vanishing_points.as_ref().map(rows);
    finite(camera.iter().chain(projector.iter().flatten()).flatten(), "vanishing points")?;
    finite(v.corners_px.iter().flat_map(|c| c.coords.iter()), "corners")?;
    if let Some(r) = &v.rms_px {
        finite([&r.edges].into_iter().chain(&r.corners).chain(&r.projector), "rms")?;
    }
    Ok(ViewDto {
        photo: v.photo.clone(),
        size_mm: Some([v.size.width_mm, v.size.height_mm]),
        camera_from_sheet: Some(pose_to_dto(&v.camera_from_sheet, "camera_from_sheet")?),
        projector_from_sheet: v
            .projector_from_sheet
            .as_ref()
            .map(|p| pose_to_dto(p, "projector_from_sheet"))
            .transpose()?,
        vanishing_points: Some(VanishingDto { camera: Some(camera), projector }),
        corners_px: Some(v.corners_px.map(|c| [c.x, c.y])),
        rms_px: v.rms_px.map(|r| RmsDto { edges: Some(r.edges), corners: r.corners, projector: r.projector }),
    })
}

fn quality_to_dto(q: &Quality) -> Result<QualityDto> {
    let optional = q.focal_sigma_percent_projector.iter().chain(&q.expected_point_sigma_mm);
    finite(optional.chain([&q.focal_sigma_percent_camera]), "quality")?;
    Ok(QualityDto {
        verdict: Some(q.verdict),
        focal_sigma_percent: Some(FocalSigmaDto {
            camera: Some(q.focal_sigma_percent_camera),
            projector: q.focal_sigma_percent_projector,
        }),
        expected_point_sigma_mm: q.expected_point_sigma_mm,
        warnings: q.warnings.clone(),
    })
}

fn covariance_to_dto(c: &Covariance) -> Result<CovarianceDto> {
    finite(c.matrix.iter(), "covariance")?;
    let matrix = c.matrix.row_iter().map(|r| r.iter().copied().collect()).collect();
    Ok(CovarianceDto { parameters: c.parameters.clone(), matrix })
}

#[cfg(test)]
#[path = "rig_json_tests.rs"]
mod tests;
