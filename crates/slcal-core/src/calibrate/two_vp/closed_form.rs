//! The published method from corners to camera, sheet and projector, step by step.

use nalgebra::Point2;

use super::{focal, pose, rectified_pattern, vanishing_points, vanishing_points_of_quad};
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::{Camera, Distortion, Intrinsics, Pose, RectangleSize};
use crate::solve::homography_from_points;

/// Four corners, TL TR BR BL.
pub(crate) type Quad = [Point2<f64>; 4];

/// What the closed form starts from, in square, undistorted camera pixels.
#[derive(Clone)]
pub(crate) struct Input {
    pub(crate) corners: Quad,
    /// The pattern's outer corners in the camera image (through the homography) and in the projector.
    pub(crate) outline: Option<(Quad, Quad)>,
    pub(crate) size: RectangleSize,
    pub(crate) camera: [u32; 2],
    pub(crate) camera_pp: Point2<f64>,
    pub(crate) known_focal: Option<f64>,
    pub(crate) projector: Option<([u32; 2], Point2<f64>)>,
}

/// What it answers.
pub(crate) struct Output {
    pub(crate) camera: Camera,
    pub(crate) sheet: Pose,
    pub(crate) projector: Option<(Camera, Pose)>,
}

fn pinhole([width, height]: [u32; 2], f: f64, pp: Point2<f64>) -> Camera {
    Camera { width, height, intrinsics: Intrinsics::square(f, pp), distortion: Distortion::NONE }
}

/// The published method.
pub(crate) fn closed_form(input: &Input) -> Result<Output> {
    let v = vanishing_points_of_quad(&input.corners);
    let f = match input.known_focal {
        Some(f) => f,
        None => focal(&v, input.camera_pp, ErrorSubject::Camera)?,
    };
    let camera = pinhole(input.camera, f, input.camera_pp);
    let sheet = pose(&camera, &v, &input.corners, input.size)?;
    let (Some((panel, pp)), Some((seen, drawn))) = (input.projector, input.outline) else {
        return Ok(Output { camera, sheet, projector: None });
    };
    let pairs: Vec<_> = seen.into_iter().zip(drawn).collect();
    let projector_from_camera = homography_from_points(&pairs)?;
    let v = vanishing_points(&rectified_pattern(&seen, &v, &projector_from_camera));
    let projector = pinhole(panel, focal(&v, pp, ErrorSubject::Projector)?, pp);
    let mut corners = input.corners;
    for c in &mut corners {
        *c = projector_from_camera.map(*c).ok_or_else(|| {
            Error::invalid("the sheet in the projector's image", "finite corners", "a corner at infinity")
        })?;
    }
    let projector_from_sheet = pose(&projector, &v, &corners, input.size)?;
    Ok(Output { camera, sheet, projector: Some((projector, projector_from_sheet.compose(&sheet.inverse()))) })
}
