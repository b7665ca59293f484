//! Conversion of the file's fields to a rig, with checks.

use nalgebra::{DMatrix, Matrix3, Point2, Rotation3, Vector3};
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::schema::{
    CovarianceDto, DeviceDto, QualityDto, REFERENCE, RegistrationDto, RigDto, Rows3, StereoDto, VanishingDto,
    ViewDto, malformed,
};
use crate::channel_registration::{ChannelDisplacements, ChannelRegistration};
use crate::error::Result;
use crate::geometry::{Camera, Distortion, Intrinsics, Pose, RectangleSize, SheetBend};
use crate::rig::{
    Covariance, Device, DeviceSigma, Projector, Quality, Rig, StereoPose, View, ViewBend, ViewRms,
};

/// Common prefix of all versions.
const SCHEMA_FAMILY: &str = "slcal-rig/";
/// A matrix this near to a rotation is kept exactly, so that writing and reading do not change a rig.
const EXACT_ROTATION: f64 = 1e-12;

pub(super) fn parse<T: DeserializeOwned>(value: Value, place: &str) -> Result<T> {
    serde_json::from_value(value).map_err(|e| malformed(format!("{place}: {e}")))
}

fn parse_optional<T: DeserializeOwned>(value: Value, place: &str) -> Result<Option<T>> {
    if value.is_null() { Ok(None) } else { parse(value, place).map(Some) }
}

pub(super) fn expect(found: &str, expected: &str, field: &str) -> Result<()> {
    if found == expected {
        return Ok(());
    }
    let version = |name: &str| name.strip_prefix(SCHEMA_FAMILY)?.parse::<u32>().ok();
    let newer = field == "schema" && version(found) > version(expected);
    let advice = if newer { "; it was written by a newer version of slcal: update to read it" } else { "" };
    let found: String = found.chars().take(40).collect();
    Err(malformed(format!("`{field}` is \"{found}\", expected \"{expected}\"{advice}")))
}

pub(super) fn rig_from_dto(dto: RigDto) -> Result<Rig> {
    let camera = device_from_dto(parse(dto.camera, "camera")?, "camera")?;
    let projector = parse_optional::<DeviceDto>(dto.projector, "projector")?
        .map(|d| Ok((d.mirrored, device_from_dto(d, "projector")?)))
        .transpose()?;
    let stereo = parse_optional::<StereoDto>(dto.projector_from_camera, "projector_from_camera")?
        .map(|s| {
            Ok(StereoPose {
                pose: pose_from_rows(&s.r, s.t, "projector_from_camera")?,
                sigma_t_mm: s.sigma_t_mm,
                sigma_r_rad: s.sigma_r_rad,
            })
        })
        .transpose()?;
    let projector = match (projector, stereo) {
        (Some((mirrored, device)), Some(from_camera)) => Some(Projector { device, from_camera, mirrored }),
        (None, None) => None,
        _ => {
            let wrong = "`projector` and `projector_from_camera` must both be given or both be null";
            return Err(malformed(wrong));
        }
    };
    let mut views = Vec::new();
    for (i, value) in dto.views.into_iter().enumerate() {
        let place = format!("views[{i}]");
        let view: ViewDto = parse(value, &place)?;
        views.extend(view_from_dto(view, &place, &camera.model, projector.as_ref())?);
    }
    let channel_registration = parse_optional(dto.channel_registration, "channel_registration")?
        .map(|r| registration_from_dto(&r, &camera.model, projector.as_ref()))
        .transpose()?;
    Ok(Rig {
        camera,
        projector,
        views,
        method: dto.method.unwrap_or_else(|| "unknown".into()),
        quality: parse_optional(dto.quality, "quality")?.and_then(quality_from_dto),
        covariance: parse_optional(dto.covariance, "covariance")?.map(covariance_from_dto).transpose()?,
        channel_registration,
    })
}

fn matrix_from_rows(m: &Rows3) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| m[i][j])
}

fn device_from_dto(dto: DeviceDto, place: &str) -> Result<Device> {
    if dto.width == 0 || dto.height == 0 {
        return Err(malformed(format!("{place}: width and height must be positive")));
    }
    let k = matrix_from_rows(&dto.k);
    let intrinsics = Intrinsics::from_matrix(&k).map_err(|e| malformed(format!("{place}: {e}")))?;
    let sigma = dto.sigma.and_then(|s| {
        let (focal_px, cx_px, cy_px) = (s.focal_px?, s.cx_px?, s.cy_px?);
        let (distortion, aspect) = (s.distortion.unwrap_or_default(), s.aspect.unwrap_or_default());
        Some(DeviceSigma { focal_px, cx_px, cy_px, distortion, aspect })
    });
    let distortion = Distortion::from_array(dto.distortion);
    Ok(Device { model: Camera { width: dto.width, height: dto.height, intrinsics, distortion }, sigma })
}

fn pose_from_rows(r: &Rows3, t: [f64; 3], place: &str) -> Result<Pose> {
    exact_pose(&matrix_from_rows(r), Vector3::from(t)).map_err(|e| malformed(format!("{place}: {e}")))
}

/// As [`Pose::from_matrix`], but an exact rotation is kept unchanged.
pub(in crate::format) fn exact_pose(matrix: &Matrix3<f64>, t: Vector3<f64>) -> Result<Pose> {
    let pose = Pose::from_matrix(matrix, t)?;
    if (matrix.transpose() * matrix - Matrix3::identity()).abs().max() <= EXACT_ROTATION {
        return Ok(Pose { rotation: Rotation3::from_matrix_unchecked(*matrix), ..pose });
    }
    Ok(pose)
}

fn vanishing_from_rows(rows: [[f64; 3]; 2]) -> [Vector3<f64>; 2] {
    rows.map(Vector3::from)
}

fn view_from_dto(
    dto: ViewDto,
    place: &str,
    camera: &Camera,
    projector: Option<&Projector>,
) -> Result<Option<View>> {
    let (Some([w, h]), Some(pose)) = (dto.size_mm, dto.camera_from_sheet) else { return Ok(None) };
    let size = RectangleSize::new(w, h).map_err(|e| malformed(format!("{place}: {e}")))?;
    let camera_from_sheet = pose_from_rows(&pose.r, pose.t, &format!("{place}.camera_from_sheet"))?;
    let projector_from_sheet = match dto.projector_from_sheet {
        Some(p) => Some(pose_from_rows(&p.r, p.t, &format!("{place}.projector_from_sheet"))?),
        None => projector.map(|p| p.from_camera.pose.compose(&camera_from_sheet)),
    };
    let given = dto.vanishing_points.unwrap_or(VanishingDto { camera: None, projector: None });
    let corners_px = match dto.corners_px {
        Some(c) => c.map(|[x, y]| Point2::new(x, y)),
        None => project_corners(camera, &camera_from_sheet, size)
            .ok_or_else(|| malformed(format!("{place}: the sheet lies behind the camera")))?,
    };
    let bend = dto.bend.map(|b| ViewBend {
        shape: SheetBend(b.coefficients_mm),
        sigma_mm: b.sigma_mm.unwrap_or_default(),
        expected_mm: b.expected_sigma_mm.unwrap_or_default(),
    });
    Ok(Some(View {
        photo: dto.photo,
        size,
        camera_from_sheet,
        bend,
        projector_from_sheet,
        camera_vanishing_points: given
            .camera
            .map_or_else(|| camera.vanishing_points(&camera_from_sheet), vanishing_from_rows),
        projector_vanishing_points: given
            .projector
            .map(vanishing_from_rows)
            .or_else(|| Some(projector?.device.model.vanishing_points(projector_from_sheet.as_ref()?))),
        corners_px,
        rms_px: dto
            .rms_px
            .and_then(|r| Some(ViewRms { edges: r.edges?, corners: r.corners, projector: r.projector })),
        clipped_percent: dto.clipped_percent,
    }))
}

pub(super) fn project_corners(camera: &Camera, pose: &Pose, size: RectangleSize) -> Option<[Point2<f64>; 4]> {
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
        depth_sigma_percent: dto.depth_sigma_percent,
        expected_point_sigma_mm: dto.expected_point_sigma_mm,
        cause: dto.cause,
        advice: dto.advice,
        warnings: dto.warnings,
        assumptions: dto.assumptions,
    })
}

fn covariance_from_dto(dto: CovarianceDto) -> Result<Covariance> {
    let n = dto.parameters.len();
    if dto.matrix.len() != n || dto.matrix.iter().any(|row| row.len() != n) {
        return Err(malformed(format!("covariance: expected a {n}x{n} matrix for {n} parameters")));
    }
    let parameters = dto.parameters.into_iter().map(|name| name.as_str().into()).collect();
    Ok(Covariance { matrix: DMatrix::from_fn(n, n, |i, j| dto.matrix[i][j]), parameters })
}

fn registration_from_dto(
    dto: &RegistrationDto,
    camera: &Camera,
    projector: Option<&Projector>,
) -> Result<ChannelRegistration> {
    expect(&dto.reference, REFERENCE, "channel_registration.reference")?;
    let Some(projector) = projector else {
        return Err(malformed(
            "channel_registration: expected a projector, found a rig that holds the camera alone",
        ));
    };
    if let Some(wrong) = dto.sigma.numbers().into_iter().find(|s| *s < 0.0) {
        return Err(malformed(format!(
            "channel_registration.sigma: expected σ that are not negative, found {wrong}"
        )));
    }
    let [width, height] = projector.device.model.size();
    Ok(ChannelRegistration {
        displacements: ChannelDisplacements { projector: dto.projector, camera: dto.camera },
        sigma: dto.sigma,
        from: dto.from,
        camera_centre: camera.intrinsics.principal_point(),
        panel_centre: Camera::image_centre(width, height),
    })
}
