//! The ray of a camera's pixel.

// Inlined from match to point; otherwise the compiler passes every intersection through memory.
#![allow(clippy::inline_always)]

use nalgebra::{Matrix2, Point2, Rotation3, Vector3};

use crate::geometry::Camera;

/// A camera's ray, and how it turns with its pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct CameraRay {
    /// (x, y, 1) in the camera's frame.
    pub(super) bearing: Vector3<f64>,
    /// The same in the projector's.
    pub(super) in_projector: Vector3<f64>,
    /// d(x, y)/d(pixel).
    pub(super) by_pixel: Matrix2<f64>,
    pub(super) squared_length: f64,
}

/// Pixels of a camera as rays, with what is the same for all of them.
#[derive(Debug, Clone)]
pub(super) struct CameraRays {
    pub(super) camera: Camera,
    bent: bool,
    /// d(x, y)/d(pixel) without distortion.
    by_pixel: Matrix2<f64>,
}

impl CameraRays {
    pub(super) fn new(camera: Camera) -> Self {
        let k = &camera.intrinsics;
        let by_pixel = Matrix2::new(1.0 / k.fx, -k.skew / (k.fx * k.fy), 0.0, 1.0 / k.fy);
        Self { camera, bent: !camera.distortion.is_none(), by_pixel }
    }

    /// The ray of a pixel, also in the frame of a projector turned by `rotation`; `None` where the lens's model does
    /// not reach the pixel.
    #[inline(always)]
    pub(super) fn of(&self, pixel: Point2<f64>, rotation: &Rotation3<f64>) -> Option<CameraRay> {
        let seen = self.by_pixel * (pixel - self.camera.intrinsics.principal_point());
        let (ideal, by_pixel) = if self.bent {
            let (ideal, bend) = self.camera.distortion.undistort_with_jacobian(seen)?;
            (ideal, bend.try_inverse()? * self.by_pixel)
        } else {
            (seen, self.by_pixel)
        };
        let bearing = ideal.push(1.0);
        let in_projector = rotation.matrix() * bearing;
        Some(CameraRay { bearing, in_projector, by_pixel, squared_length: bearing.norm_squared() })
    }
}
