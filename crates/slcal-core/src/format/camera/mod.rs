//! Known camera intrinsics from other programs' files: OpenCV's `FileStorage` as YAML, XML or JSON, ROS `camera_info` YAML,
//! and rig JSON. Which of them it is follows from the content.
//!
//! OpenCV and ROS put integers at pixel centres, as this library does.

mod fields;

use std::io::Read;

pub(super) use fields::{FIRST, SECOND, device, distortion, numbers};

use super::tree::Expecting;
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::{Camera, Distortion, Intrinsics};

/// Camera files have a few dozen values, four levels deep.
const CAMERA_FILE: Expecting = Expecting { what: ErrorSubject::CameraFile, most_nodes: 10_000 };

/// A focal length outside of these multiples of the image's longer side is not in pixels, or not of this image.
const FOCAL_RANGE: std::ops::RangeInclusive<f64> = 0.1..=100.0;
/// A principal point further outside the image than this many times its size is a mistake.
const FARTHEST: f64 = 1.0;

/// A camera as a file describes it; not every file says for which resolution.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownCamera {
    /// K, px.
    pub intrinsics: Intrinsics,
    /// `plumb_bob` distortion; zeros where the file has none.
    pub distortion: Distortion,
    /// Width and height of the image, px; `None` when the file does not say.
    pub size: Option<[u32; 2]>,
    /// What else is worth knowing about how the file was read.
    pub notes: Vec<String>,
}

impl KnownCamera {
    /// The camera for an image of this size.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the file is for another size (with what the intrinsics would be here, where the
    /// proportions agree), or when focal length and principal point cannot be those of such an image.
    pub fn for_image(&self, [width, height]: [u32; 2]) -> Result<Camera> {
        if let Some([w, h]) = self.size.filter(|s| *s != [width, height]) {
            let same_shape = u64::from(w) * u64::from(height) == u64::from(h) * u64::from(width);
            let advice = if same_shape {
                let s = f64::from(width) / f64::from(w);
                let k = &self.intrinsics;
                format!(
                    "; intrinsics hold for one resolution only. If these images are the same ones resized, f becomes {:.2}, \
                     cx {:.2} and cy {:.2}",
                    k.fx * s,
                    (k.cx + 0.5) * s - 0.5,
                    (k.cy + 0.5) * s - 0.5
                )
            } else {
                "; intrinsics hold for one resolution only, and these images differ in shape as well"
                    .to_owned()
            };
            return Err(Error::invalid(
                "the known camera's image size",
                format!("{width}x{height} pixels"),
                format!("{w}x{h}{advice}"),
            ));
        }
        let k = &self.intrinsics;
        let longer = f64::from(width.max(height));
        if ![k.fx, k.fy].iter().all(|f| FOCAL_RANGE.contains(&(f / longer))) {
            return Err(Error::invalid(
                "the known camera's focal lengths",
                format!("pixels, for an image of {width}x{height}"),
                format!("{}, {}", k.fx, k.fy),
            ));
        }
        let near = |c: f64, side: u32| {
            let side = f64::from(side);
            (-FARTHEST * side..=(1.0 + FARTHEST) * side).contains(&c)
        };
        if !(near(k.cx, width) && near(k.cy, height)) {
            return Err(Error::invalid(
                "the known camera's principal point",
                format!("pixels in or near an image of {width}x{height}"),
                format!("{}, {}", k.cx, k.cy),
            ));
        }
        Ok(Camera { width, height, intrinsics: *k, distortion: self.distortion })
    }
}

/// Reads a camera file. Of a rig the camera is taken, its σ left aside: a known camera is held fixed.
///
/// # Errors
/// [`Error::Malformed`] when the text is of none of the kinds, when what it needs is missing, of another size than
/// stated or not finite, when K is no camera matrix, or when the lens model has terms beyond k1, k2, p1, p2, k3 that
/// are not zero; [`Error::Io`] when the stream fails.
pub fn read_camera(mut input: impl Read) -> Result<KnownCamera> {
    let mut bytes = Vec::new();
    input.read_to_end(&mut bytes).map_err(|e| Error::reading(ErrorSubject::CameraFile, e))?;
    let text = CAMERA_FILE.text(&bytes)?;
    if text.starts_with('{') && CAMERA_FILE.json(text)?.get("schema").is_some() {
        let rig = super::read_rig(bytes.as_slice())?;
        let Camera { width, height, intrinsics, distortion } = rig.camera.model;
        return Ok(KnownCamera { intrinsics, distortion, size: Some([width, height]), notes: Vec::new() });
    }
    fields::camera(&CAMERA_FILE.parse(text)?, CAMERA_FILE)
}

#[cfg(test)]
mod tests;
