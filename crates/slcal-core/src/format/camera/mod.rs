//! Known camera intrinsics from other programs' files: OpenCV's `FileStorage` as YAML, XML or JSON, ROS `camera_info` YAML,
//! and rig JSON. The format is recognised by the content.
//!
//! OpenCV and ROS put integers at pixel centres, as this library does.

mod fields;
mod known_camera;

use std::io::Read;

pub use known_camera::KnownCamera;

pub(super) use fields::{FIRST, SECOND, device, distortion, numbers};

use super::recognise::refuse_others;
use super::tree::{Expecting, parse};
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::Camera;

/// Camera files have a few dozen values, four levels deep.
const CAMERA_FILE: Expecting = Expecting { what: ErrorSubject::CameraFile, most_nodes: 10_000 };

/// Reads a camera file. From a rig file it takes the camera without its σ: a known camera is held fixed.
///
/// # Errors
/// [`Error::Malformed`] when the text is of none of the kinds, when what it needs is missing, of another size than
/// stated or not finite, when K is no camera matrix, or when the lens model has terms beyond k1, k2, p1, p2, k3 that
/// are not zero; [`Error::Io`] when the stream fails.
///
/// # Examples
/// ```
/// use slcal_core::format::read_camera;
///
/// let yaml = "camera_matrix: {rows: 3, cols: 3, data: [1500, 0, 640, 0, 1500, 480, 0, 0, 1]}";
/// let known = read_camera(yaml.as_bytes())?;
/// assert_eq!(known.for_image([1280, 960])?.intrinsics.fx, 1500.0);
/// # Ok::<(), slcal_core::Error>(())
/// ```
pub fn read_camera(mut input: impl Read) -> Result<KnownCamera> {
    let mut bytes = Vec::new();
    input.read_to_end(&mut bytes).map_err(|e| Error::reading(ErrorSubject::CameraFile, e))?;
    refuse_others(&bytes, ErrorSubject::CameraFile, &["a camera", "a rig", "YAML", "XML"])?;
    let text = CAMERA_FILE.text(&bytes)?;
    if text.starts_with('{') && CAMERA_FILE.json(text)?.get("schema").is_some() {
        let rig = super::read_rig(bytes.as_slice())?;
        let Camera { width, height, intrinsics, distortion } = rig.camera.model;
        return Ok(KnownCamera { intrinsics, distortion, size: Some([width, height]), notes: Vec::new() });
    }
    fields::camera(&parse(text, CAMERA_FILE)?, CAMERA_FILE)
}

#[cfg(test)]
mod tests;
