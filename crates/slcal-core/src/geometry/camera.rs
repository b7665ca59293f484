//! The pinhole model with distortion, for cameras and projectors: a projector is an inverse camera.

use nalgebra::{Matrix3, Point2, Point3, Vector2, Vector3};
use serde::{Deserialize, Serialize};

use super::{Distortion, Homography, Pose};
use crate::error::{Error, Result};

/// The matrix K = [[fx, s, cx], [0, fy, cy], [0, 0, 1]], px.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Intrinsics {
    /// Focal length along x, px.
    pub fx: f64,
    /// Focal length along y, px.
    pub fy: f64,
    /// Skew, px.
    pub skew: f64,
    /// Principal point, px; may lie outside the image.
    pub cx: f64,
    /// Principal point, px; may lie outside the image.
    pub cy: f64,
}

impl Intrinsics {
    /// Square pixels, no skew.
    #[must_use]
    pub fn square(focal_px: f64, principal_point: Point2<f64>) -> Self {
        Self { fx: focal_px, fy: focal_px, skew: 0.0, cx: principal_point.x, cy: principal_point.y }
    }

    /// From K of any overall scale.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the matrix is not upper triangular with positive, finite focal lengths.
    pub fn from_matrix(k: &Matrix3<f64>) -> Result<Self> {
        let m = k / k[(2, 2)];
        let lower = m[(1, 0)].abs().max(m[(2, 0)].abs()).max(m[(2, 1)].abs());
        if !(m.iter().all(|x| x.is_finite())
            && m[(0, 0)] > 0.0
            && m[(1, 1)] > 0.0
            && lower <= 1e-9 * m[(0, 0)])
        {
            return Err(Error::invalid(
                "K",
                "[[fx, s, cx], [0, fy, cy], [0, 0, 1]] with positive, finite focal lengths",
                format!("{:?}", k.row_iter().map(|r| [r[0], r[1], r[2]]).collect::<Vec<_>>()),
            ));
        }
        Ok(Self { fx: m[(0, 0)], fy: m[(1, 1)], skew: m[(0, 1)], cx: m[(0, 2)], cy: m[(1, 2)] })
    }

    /// As the 3×3 matrix K.
    #[must_use]
    pub fn matrix(&self) -> Matrix3<f64> {
        Matrix3::new(self.fx, self.skew, self.cx, 0.0, self.fy, self.cy, 0.0, 0.0, 1.0)
    }

    /// The principal point, px.
    #[must_use]
    pub fn principal_point(&self) -> Point2<f64> {
        Point2::new(self.cx, self.cy)
    }

    /// Pixel of a (distorted) normalized point.
    #[must_use]
    pub fn pixel(&self, x: Vector2<f64>) -> Point2<f64> {
        Point2::new(self.fx * x.x + self.skew * x.y + self.cx, self.fy * x.y + self.cy)
    }

    /// (Distorted) normalized point of a pixel.
    #[must_use]
    pub fn normalized(&self, p: Point2<f64>) -> Vector2<f64> {
        let y = (p.y - self.cy) / self.fy;
        Vector2::new((p.x - self.cx - self.skew * y) / self.fx, y)
    }
}

/// An image plane of known size behind a lens: camera or projector.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Width of the image or panel, px.
    pub width: u32,
    /// Height of the image or panel, px.
    pub height: u32,
    /// K.
    pub intrinsics: Intrinsics,
    /// Lens distortion.
    pub distortion: Distortion,
}

impl Camera {
    /// The centre of a W×H image, ((W−1)/2, (H−1)/2), as pixel centres are integers.
    #[must_use]
    pub fn image_centre(width: u32, height: u32) -> Point2<f64> {
        Point2::new((f64::from(width) - 1.0) / 2.0, (f64::from(height) - 1.0) / 2.0)
    }

    /// Width and height, px.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Whether a pixel, with its whole area, belongs to the image.
    #[must_use]
    pub fn holds(&self, p: Point2<f64>) -> bool {
        let [w, h] = self.size().map(f64::from);
        (-0.5..=w - 0.5).contains(&p.x) && (-0.5..=h - 0.5).contains(&p.y)
    }

    /// The pixel of a point in the device frame; `None` behind the device.
    ///
    /// # Examples
    /// ```
    /// use slcal_core::nalgebra::{Point2, Point3};
    /// use slcal_core::{Camera, Distortion, Intrinsics};
    ///
    /// let camera = Camera {
    ///     width: 1280,
    ///     height: 960,
    ///     intrinsics: Intrinsics::square(1500.0, Camera::image_centre(1280, 960)),
    ///     distortion: Distortion { k1: -0.1, ..Distortion::NONE },
    /// };
    /// assert_eq!(camera.project(&Point3::new(0.0, 0.0, 1000.0)), Some(Point2::new(639.5, 479.5)));
    /// // The way back: the direction that a pixel sees.
    /// let pixel = camera.project(&Point3::new(200.0, 100.0, 1000.0)).unwrap();
    /// let bearing = camera.bearing(pixel).unwrap();
    /// assert!((bearing.x - 0.2).abs() < 1e-9 && (bearing.y - 0.1).abs() < 1e-9);
    /// ```
    #[must_use]
    pub fn project(&self, p: &Point3<f64>) -> Option<Point2<f64>> {
        (p.z > 0.0)
            .then(|| self.intrinsics.pixel(self.distortion.distort(Vector2::new(p.x / p.z, p.y / p.z))))
    }

    /// The undistorted normalized point (x/z, y/z) of a pixel; `None` where the distortion has no inverse.
    #[must_use]
    pub fn undistort(&self, p: Point2<f64>) -> Option<Vector2<f64>> {
        self.distortion.undistort(self.intrinsics.normalized(p))
    }

    /// The images of the X and Y directions of a plane that stands at `device_from_plane`, without distortion, in
    /// homogeneous pixels: the columns of K·R.
    #[must_use]
    pub fn vanishing_points(&self, device_from_plane: &Pose) -> [Vector3<f64>; 2] {
        let [x, y, _] = Homography(self.intrinsics.matrix() * device_from_plane.rotation.matrix()).columns();
        [x, y]
    }

    /// The direction (x, y, 1) seen at a pixel; `None` where the distortion has no inverse.
    #[must_use]
    pub fn bearing(&self, p: Point2<f64>) -> Option<Vector3<f64>> {
        self.undistort(p).map(|x| Vector3::new(x.x, x.y, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn camera() -> Camera {
        Camera {
            width: 1280,
            height: 960,
            intrinsics: Intrinsics { fx: 1500.0, fy: 1490.0, skew: 0.7, cx: 650.0, cy: -30.0 },
            distortion: Distortion { k1: -0.1, k2: 0.02, p1: 1e-3, p2: 5e-4, k3: 0.0 },
        }
    }

    #[test]
    fn bearing_inverts_project_for_any_k() {
        let p = Point3::new(120.0, -80.0, 900.0);
        let b = camera().bearing(camera().project(&p).unwrap()).unwrap();
        assert_relative_eq!(b * 900.0, p.coords, epsilon = 1e-9);
    }

    #[test]
    fn what_lies_behind_is_not_seen() {
        assert!(camera().project(&Point3::new(0.0, 0.0, -1.0)).is_none());
        assert!(camera().project(&Point3::new(1.0, 0.0, 0.0)).is_none());
    }

    #[test]
    fn k_from_files_is_checked() {
        let k = camera().intrinsics.matrix();
        assert_eq!(Intrinsics::from_matrix(&(k * 2.0)).unwrap(), camera().intrinsics);
        assert!(Intrinsics::from_matrix(&(-k)).is_ok(), "the overall scale is free");
        assert!(Intrinsics::from_matrix(&k.transpose()).is_err());
        assert!(Intrinsics::from_matrix(&Matrix3::zeros()).is_err());
    }
}
