//! A rig.

use nalgebra::{Point2, Rotation3, Vector3};

use crate::geometry::{Camera, Distortion, Intrinsics, Pose};
use crate::rig::{Device, Projector, Rig, StereoPose};

/// A camera and a projector about 220 mm to its left and above, both looking at a point a metre away.
pub(crate) fn test_rig() -> Rig {
    let device = |width, height, focal, pp| Device {
        model: Camera {
            width,
            height,
            intrinsics: Intrinsics::square(focal, pp),
            distortion: Distortion::NONE,
        },
        sigma: None,
    };
    Rig {
        camera: device(1280, 960, 1536.0, Point2::new(639.5, 479.5)),
        projector: Some(Projector {
            device: device(1024, 768, 1638.4, Point2::new(511.5, 383.5)),
            from_camera: StereoPose::from(Pose {
                rotation: Rotation3::from_euler_angles(0.08, -0.2, 0.0),
                translation: Vector3::new(200.0, 80.0, 20.0),
            }),
            mirrored: false,
        }),
        views: Vec::new(),
        method: "test".into(),
        quality: None,
        covariance: None,
        channel_registration: None,
    }
}
