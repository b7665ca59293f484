//! What the benchmarks of decoding photograph.

use nalgebra::{Point3, Vector3};
use slcal_core::Rig;
use slcal_core::geometry::Plane;
use slcal_core::simulate::{Photographer, PoseConfig, RenderConfig, RigConfig, Scene, Shape, Surface};

/// A ball before a wall, with the noise of a good camera; the rig, and the size of its projector.
pub(crate) fn ball_before_wall(camera: [u32; 2]) -> (Rig, [u32; 2], Photographer) {
    let default = RigConfig::default();
    let scale = f64::from(camera[0]) / f64::from(default.camera[0]);
    let config = RigConfig { camera, camera_focal_px: default.camera_focal_px * scale, ..default };
    let rig = Scene::new(&config, &[PoseConfig::tilted(0.0, 0.0)]).expect("a scene").rig();
    let ball = Shape::Sphere { centre: Point3::new(0.0, 0.0, 1050.0), radius_mm: 200.0 };
    let wall = Plane::from_point_normal(&Point3::new(0.0, 0.0, 1200.0), Vector3::z());
    let surfaces = [Surface::object(ball), Surface::around(Shape::Plane(wall.expect("a plane")), 0.5)];
    let photographer = Photographer::new(&rig, &surfaces, &RenderConfig::default()).expect("a rig");
    (rig, config.projector, photographer)
}
