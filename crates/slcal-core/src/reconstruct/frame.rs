//! Clouds in the camera's frame and in that of the sheet.

use nalgebra::Point3;

use crate::cloud::{Frame, PointCloud};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::rig::{Rig, View};

/// Transforms a cloud into another frame.
///
/// # Errors
/// [`Error::Invalid`] for the sheet's frame when the rig holds no view.
pub fn in_frame(mut cloud: PointCloud, rig: &Rig, frame: Frame) -> Result<PointCloud> {
    if frame == cloud.frame {
        return Ok(cloud);
    }
    let camera_from_sheet = first_view(rig)?.camera_from_sheet;
    let to = if frame == Frame::Plane { camera_from_sheet.inverse() } else { camera_from_sheet };
    turn(&mut cloud, &to);
    if frame == Frame::Camera {
        // Exactly, without rounding errors.
        cloud.camera_centre = Point3::origin();
    }
    cloud.frame = frame;
    Ok(cloud)
}

pub(crate) fn first_view(rig: &Rig) -> Result<&View> {
    rig.views.first().ok_or_else(|| {
        Error::invalid("frame", "the camera's: this rig holds no view of a sheet", "the sheet's plane")
    })
}

/// Transforms positions and the camera's centre.
pub(crate) fn turn(cloud: &mut PointCloud, pose: &Pose) {
    for p in &mut cloud.points {
        p.position = pose.transform(&p.position);
    }
    for normal in &mut cloud.normals {
        *normal = (pose.rotation * normal.cast::<f64>()).cast();
    }
    cloud.camera_centre = pose.transform(&cloud.camera_centre);
}
