//! A camera read from a file.

use crate::error::{Error, Result};
use crate::geometry::{Camera, Distortion, Intrinsics};

/// A focal length outside of these multiples of the image's longer side is not in pixels, or not of this image.
const FOCAL_RANGE: std::ops::RangeInclusive<f64> = 0.1..=100.0;
/// A principal point further outside the image than this many times its size is a mistake.
const FARTHEST: f64 = 1.0;

/// A camera read from a file. Not every file states the image size.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct KnownCamera {
    /// K, px.
    pub intrinsics: Intrinsics,
    /// `plumb_bob` distortion; zeros where the file has none.
    pub distortion: Distortion,
    /// Width and height of the image, px; `None` when the file does not state them.
    pub size: Option<[u32; 2]>,
    /// Remarks on how the file was read.
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
