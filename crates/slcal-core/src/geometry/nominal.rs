//! Devices from data sheets: by angle of view, 35 mm equivalent focal length or throw ratio.

use std::f64::consts::PI;

use nalgebra::Point2;

use super::{Camera, Distortion, Intrinsics};
use crate::error::{Error, Result};

/// Diagonal of a frame of 35 mm film, 36 × 24 mm.
pub(crate) const FILM_DIAGONAL_MM: f64 = 43.266_615_305_567_87;
/// Angles of view that a lens can have, degrees.
const FOV_RANGE_DEG: std::ops::Range<f64> = 0.1..179.0;

fn positive(what: &'static str, value: f64) -> Result<f64> {
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    Err(Error::invalid(what, "a number above zero", value))
}

impl Camera {
    /// A device without distortion whose axis goes through the middle of its image, of width and height `size`.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a focal length (px) that is not above zero, or a size without pixels.
    pub fn pinhole(size: [u32; 2], focal_px: f64) -> Result<Self> {
        let [width, height] = size;
        if size.contains(&0) {
            return Err(Error::invalid(
                "size",
                "a width and a height above zero",
                format!("{width}x{height}"),
            ));
        }
        let intrinsics =
            Intrinsics::square(positive("focal_px", focal_px)?, Self::image_centre(width, height));
        Ok(Self { width, height, intrinsics, distortion: Distortion::NONE })
    }

    /// [`pinhole`](Self::pinhole) by the angle of view across the width, degrees.
    ///
    /// # Errors
    /// [`Error::Invalid`] for an angle that is not between 0.1 and 179 degrees, or a size without pixels.
    pub fn from_fov(size: [u32; 2], fov_deg: f64) -> Result<Self> {
        if !FOV_RANGE_DEG.contains(&fov_deg) {
            return Err(Error::invalid("fov_deg", "0.1 to 179 degrees", fov_deg));
        }
        Self::pinhole(size, f64::from(size[0]) / 2.0 / (fov_deg * PI / 360.0).tan())
    }

    /// [`pinhole`](Self::pinhole) by the focal length as on 35 mm film, mm: the same angle of view over the diagonal.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a length that is not above zero, or a size without pixels.
    pub fn from_35mm(size: [u32; 2], focal_35mm: f64) -> Result<Self> {
        let diagonal_px = f64::from(size[0]).hypot(f64::from(size[1]));
        Self::pinhole(size, positive("focal_35mm", focal_35mm)? * diagonal_px / FILM_DIAGONAL_MM)
    }

    /// A projector by its throw ratio, the distance over the width of its picture. Its axis leaves through the middle of the
    /// panel's lower edge, as it does with most lens shifts.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a ratio that is not above zero, or a size without pixels.
    pub fn from_throw(size: [u32; 2], throw: f64) -> Result<Self> {
        let device = Self::pinhole(size, positive("throw", throw)? * f64::from(size[0]))?;
        let lower_edge = Point2::new(device.intrinsics.cx, f64::from(size[1]) - 0.5);
        Ok(device.with_principal_point(lower_edge))
    }

    /// The same device with its axis at another pixel, which may lie outside the image.
    #[must_use]
    pub fn with_principal_point(mut self, pixel: Point2<f64>) -> Self {
        (self.intrinsics.cx, self.intrinsics.cy) = (pixel.x, pixel.y);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    #[test]
    fn nominal_values_give_the_field_of_view() {
        // 90° of view: at 1 m the frame is 2 m wide.
        let camera = Camera::from_fov([1000, 600], 90.0).unwrap();
        let edge = camera.project(&Point3::new(1000.0, 0.0, 1000.0)).unwrap();
        assert!((edge - Point2::new(999.5, 299.5)).norm() < 1e-9, "{edge}");
        // The corner of the film, 36×24 mm behind 50 mm.
        let camera = Camera::from_35mm([3600, 2400], 50.0).unwrap();
        let corner = camera.project(&Point3::new(18.0, 12.0, 50.0)).unwrap();
        assert!((corner - Point2::new(3599.5, 2399.5)).norm() < 1e-9, "{corner}");
        // A picture as wide as 1/1.5 of its distance, all of it above the axis.
        let projector = Camera::from_throw([1024, 768], 1.5).unwrap();
        let right = projector.project(&Point3::new(500.0, 0.0, 1500.0)).unwrap();
        assert!((right - Point2::new(1023.5, 767.5)).norm() < 1e-9, "{right}");
    }

    #[test]
    fn invalid_values_are_named() {
        let said = |r: Result<Camera>| r.unwrap_err().to_string();
        assert!(said(Camera::from_fov([9, 9], 180.0)).starts_with("fov_deg"));
        assert!(said(Camera::from_fov([9, 9], f64::NAN)).starts_with("fov_deg"));
        assert!(said(Camera::from_35mm([9, 9], -1.0)).starts_with("focal_35mm"));
        assert!(said(Camera::from_throw([9, 9], 0.0)).starts_with("throw"));
        assert!(said(Camera::pinhole([9, 9], f64::INFINITY)).starts_with("focal_px"));
        assert!(said(Camera::pinhole([0, 9], 9.0)).starts_with("size"));
    }
}
