//! Conversion of a rig to the file's fields; all numbers are finite.

use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

use super::schema::{
    BendDto, CovarianceDto, DeviceDto, FocalSigmaDto, PIXEL_CENTRE, PoseDto, QualityDto, REFERENCE,
    RegistrationDto, RmsDto, Rows3, SCHEMA, SigmaDto, StereoDto, UNITS, VanishingDto, ViewDto,
};
use crate::assumption::Assumption;
use crate::channel_registration::ChannelRegistration;
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::Pose;
use crate::rig::{Covariance, Device, Projector, Quality, Rig, StereoPose, View};

fn rows_from_matrix(m: &Matrix3<f64>) -> Rows3 {
    std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)]))
}

/// JSON has no NaN: it is refused here instead of written as null.
fn finite<'a>(numbers: impl IntoIterator<Item = &'a f64>, part: &'static str) -> Result<()> {
    match numbers.into_iter().find(|x| !x.is_finite()) {
        Some(x) => Err(Error::invalid(ErrorSubject::Part { part, of: "rig to write" }, "finite numbers", x)),
        None => Ok(()),
    }
}

pub(super) fn rig_to_dto(rig: &Rig) -> Result<impl Serialize> {
    // The fields of the file have the order of this declaration.
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
        #[serde(skip_serializing_if = "Option::is_none")]
        channel_registration: Option<RegistrationDto>,
    }
    let out = RigOut {
        schema: SCHEMA,
        units: UNITS,
        pixel_centre: PIXEL_CENTRE,
        camera: device_to_dto(&rig.camera, "camera")?,
        projector: rig.projector.as_ref().map(projector_to_dto).transpose()?,
        projector_from_camera: rig.projector.as_ref().map(|p| stereo_to_dto(&p.from_camera)).transpose()?,
        views: rig.views.iter().map(view_to_dto).collect::<Result<_>>()?,
        method: rig.method.clone(),
        quality: rig.quality.as_ref().map(quality_to_dto).transpose()?,
        covariance: rig.covariance.as_ref().map(covariance_to_dto).transpose()?,
        channel_registration: rig.channel_registration.as_ref().map(registration_to_dto).transpose()?,
    };
    Ok(out)
}

fn projector_to_dto(p: &Projector) -> Result<DeviceDto> {
    Ok(DeviceDto { mirrored: p.mirrored, ..device_to_dto(&p.device, "projector")? })
}

fn device_to_dto(d: &Device, part: &'static str) -> Result<DeviceDto> {
    let k = d.model.intrinsics.matrix();
    let distortion = d.model.distortion.to_array();
    finite(k.iter().chain(&distortion), part)?;
    if let Some(s) = &d.sigma {
        finite([s.focal_px, s.cx_px, s.cy_px].iter().chain(&s.distortion).chain([&s.aspect]), part)?;
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
            aspect: Some(s.aspect),
        }),
        mirrored: false,
    })
}

fn pose_to_dto(p: &Pose, part: &'static str) -> Result<PoseDto> {
    finite(p.rotation.matrix().iter().chain(&p.translation), part)?;
    Ok(PoseDto { r: rows_from_matrix(p.rotation.matrix()), t: p.translation.into() })
}

fn stereo_to_dto(s: &StereoPose) -> Result<StereoDto> {
    let pose = pose_to_dto(&s.pose, "projector_from_camera")?;
    finite(s.sigma_t_mm.iter().chain(&s.sigma_r_rad).flatten(), "projector_from_camera")?;
    Ok(StereoDto { r: pose.r, t: pose.t, sigma_t_mm: s.sigma_t_mm, sigma_r_rad: s.sigma_r_rad })
}

fn view_to_dto(v: &View) -> Result<ViewDto> {
    let rows = |v: &[Vector3<f64>; 2]| v.map(Into::into);
    let camera: [[f64; 3]; 2] = rows(&v.camera_vanishing_points);
    let projector = v.projector_vanishing_points.as_ref().map(rows);
    finite(camera.iter().chain(projector.iter().flatten()).flatten(), "vanishing points")?;
    finite(v.corners_px.iter().flat_map(|c| c.coords.iter()), "corners")?;
    if let Some(b) = &v.bend {
        finite(b.shape.0.iter().chain(&b.sigma_mm).chain(&b.expected_mm), "bend")?;
    }
    if let Some(r) = &v.rms_px {
        finite([&r.edges].into_iter().chain(&r.corners).chain(&r.projector), "rms")?;
    }
    finite(v.clipped_percent.iter(), "clipped_percent")?;
    Ok(ViewDto {
        photo: v.photo.clone(),
        size_mm: Some([v.size.width_mm, v.size.height_mm]),
        camera_from_sheet: Some(pose_to_dto(&v.camera_from_sheet, "camera_from_sheet")?),
        bend: v.bend.map(|b| BendDto {
            coefficients_mm: b.shape.0,
            sigma_mm: Some(b.sigma_mm),
            expected_sigma_mm: Some(b.expected_mm),
            sag_mm: Some(b.shape.sag_mm(v.size).0),
        }),
        projector_from_sheet: v
            .projector_from_sheet
            .as_ref()
            .map(|p| pose_to_dto(p, "projector_from_sheet"))
            .transpose()?,
        vanishing_points: Some(VanishingDto { camera: Some(camera), projector }),
        corners_px: Some(v.corners_px.map(|c| [c.x, c.y])),
        rms_px: v.rms_px.map(|r| RmsDto { edges: Some(r.edges), corners: r.corners, projector: r.projector }),
        clipped_percent: v.clipped_percent,
    })
}

fn quality_to_dto(q: &Quality) -> Result<QualityDto> {
    let optional = q.focal_sigma_percent_projector.iter().chain(&q.expected_point_sigma_mm);
    let of_assumption = |a: &Assumption| {
        let moves = [a.moves_percent.f_cam, a.moves_percent.f_proj, a.moves_percent.baseline];
        [Some(a.value), a.sigma, Some(a.if_off_by)].into_iter().chain(moves).flatten().collect::<Vec<_>>()
    };
    finite(&q.assumptions.iter().flat_map(of_assumption).collect::<Vec<_>>(), "quality.assumptions")?;
    let optional = optional.chain(&q.depth_sigma_percent);
    finite(optional.chain([&q.focal_sigma_percent_camera]), "quality")?;
    Ok(QualityDto {
        verdict: Some(q.verdict),
        focal_sigma_percent: Some(FocalSigmaDto {
            camera: Some(q.focal_sigma_percent_camera),
            projector: q.focal_sigma_percent_projector,
        }),
        depth_sigma_percent: q.depth_sigma_percent,
        expected_point_sigma_mm: q.expected_point_sigma_mm,
        cause: q.cause.clone(),
        advice: q.advice.clone(),
        warnings: q.warnings.clone(),
        assumptions: q.assumptions.clone(),
    })
}

fn covariance_to_dto(c: &Covariance) -> Result<CovarianceDto> {
    finite(c.matrix.iter(), "covariance")?;
    let matrix = c.matrix.row_iter().map(|r| r.iter().copied().collect()).collect();
    Ok(CovarianceDto { parameters: c.parameters.iter().map(ToString::to_string).collect(), matrix })
}

/// The centres are those of the devices, and are not written.
fn registration_to_dto(r: &ChannelRegistration) -> Result<RegistrationDto> {
    finite(&[r.displacements.numbers(), r.sigma.numbers()].concat(), "channel_registration")?;
    Ok(RegistrationDto {
        reference: REFERENCE.into(),
        projector: r.displacements.projector,
        camera: r.displacements.camera,
        sigma: r.sigma,
        from: r.from,
    })
}
