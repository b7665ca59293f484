//! Conversion of imported devices to a rig.

use nalgebra::{Matrix3, Vector3};

use super::files::ExchangeFormat;
use crate::error::{Error, ErrorSubject, Result};
use crate::format::camera::KnownCamera;
use crate::format::rig_json::exact_pose;
use crate::format::tree::Expecting;
use crate::geometry::{Camera, Pose};
use crate::rig::{Device, Projector, Rig};

/// An imported device. Its size comes from `given` where the file does not state it.
pub(super) fn device(
    known: KnownCamera,
    given: Option<[u32; 2]>,
    name: &str,
    notes: &mut Vec<String>,
) -> Result<Device> {
    let what =
        if name == "camera" { ErrorSubject::CameraImageSize } else { ErrorSubject::ProjectorImageSize };
    if let (Some(found), Some(given)) = (known.size, given)
        && found != given
    {
        let shown = |[w, h]: [u32; 2]| format!("{w}x{h} px");
        return Err(Error::invalid(what, format!("{}, as the file says", shown(found)), shown(given)));
    }
    let Some([width, height]) = known.size.or(given) else {
        let expected = "one in the file, or given beside it";
        return Err(Error::invalid(what, expected, "none"));
    };
    notes.extend(known.notes);
    Ok(Camera { width, height, intrinsics: known.intrinsics, distortion: known.distortion }.into())
}

/// An imported pose, mm.
pub(super) fn pose_of(r: &Matrix3<f64>, t: Vector3<f64>, expecting: Expecting, place: &str) -> Result<Pose> {
    exact_pose(r, t).map_err(|e| expecting.malformed(format!("{place}: {e}")))
}

/// A rig of imported devices without further information.
pub(super) fn plain_rig(camera: Device, projector: Option<&(Device, Pose)>, format: ExchangeFormat) -> Rig {
    Rig {
        camera,
        projector: projector.map(|&(device, pose)| Projector {
            device,
            from_camera: pose.into(),
            mirrored: false,
        }),
        views: Vec::new(),
        method: format.name().to_owned(),
        quality: None,
        covariance: None,
        channel_registration: None,
    }
}
