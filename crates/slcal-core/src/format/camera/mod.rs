//! Known camera intrinsics from other programs' files: OpenCV's `FileStorage` as YAML, XML or JSON, ROS `camera_info` YAML,
//! and rig JSON. The format is recognised by the content.
//!
//! OpenCV and ROS put integers at pixel centres, as this library does.

mod fields;
mod known_camera;

use std::io::Read;

pub use known_camera::KnownCamera;

#[cfg(feature = "npz")]
pub(super) use fields::FISHEYE;
pub(super) use fields::{FIRST, SECOND, device, distortion, numbers};

use super::budget::Budget;
use super::recognise::refuse_others;
use super::rig_json::rig_of_value;
use super::tree::{Expecting, from_json, parse};
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::Camera;

const CAMERA_FILE: Expecting = Expecting(ErrorSubject::CameraFile);

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
    let budget = Budget::new(ErrorSubject::CameraFile, bytes.len());
    if !text.starts_with('{') {
        return fields::camera(&parse(text, CAMERA_FILE, &budget)?, CAMERA_FILE);
    }
    let value = CAMERA_FILE.json(text, &budget)?;
    if value.get("schema").is_none() {
        return fields::camera(&from_json(value, &budget)?, CAMERA_FILE);
    }
    let Camera { width, height, intrinsics, distortion } = rig_of_value(value)?.camera.model;
    Ok(KnownCamera { intrinsics, distortion, size: Some([width, height]), notes: Vec::new() })
}

#[cfg(test)]
mod tests;
