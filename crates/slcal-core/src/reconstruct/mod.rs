//! Matches + [`Rig`](crate::Rig) → [`PointCloud`](crate::PointCloud): triangulation, removal of outliers, mesh.

mod components;
mod cull;
mod delaunay;
mod expected_uncertainty;
mod frame;
mod length_uncertainty;
mod light_plane;
mod local_slant;
mod point_covariance;
mod synthetic_match;
mod triangle_metrics;
mod triangulate;
mod triangulate_config;
#[cfg(test)]
mod triangulate_tests;

pub use cull::CullRule;
public_with! { "report": pub use cull::CullReport; }
public_with! { "stages": pub use cull::Culler; }
public_with! { "report": pub use expected_uncertainty::{ExpectedSigma, ExpectedUncertainty}; }
public_with! { "stages": pub use frame::in_frame; }
pub(crate) use frame::{first_view, turn};
public_with! { "report": pub use length_uncertainty::{LengthSigma, length_sigma}; }
public_with! { "stages": pub use triangulate::{Triangulator, triangulate}; }
pub use triangulate_config::TriangulateConfig;
public_with! { "report": pub use triangulate_config::TriangulateReport; }

/// A camera and a projector about 220 mm to its left and above, both looking at a point a metre away.
#[cfg(test)]
pub(crate) fn test_rig() -> crate::rig::Rig {
    use crate::geometry::{Camera, Distortion, Intrinsics, Pose};
    use crate::rig::{Device, Projector, Rig, StereoPose};
    use nalgebra::{Point2, Rotation3, Vector3};
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
        }),
        views: Vec::new(),
        method: "test".into(),
        quality: None,
        covariance: None,
    }
}
