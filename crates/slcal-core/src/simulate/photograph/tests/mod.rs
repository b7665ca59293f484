//! Photographs against closed forms.

mod channels;
mod geometry;
mod light;
mod meshes;
mod pipeline;
mod scene_objects;
mod sequences;
mod setups;
mod sheets;

use nalgebra::{Point3, Rotation3, Vector3};

use super::{RenderConfig, Shape, Surface};
use crate::geometry::{Distortion, Plane, Pose};
use crate::rig::Rig;
use crate::simulate::{PoseConfig, RigConfig, Scene};

/// The default rig with a camera of `width` px.
fn rig(width: u32) -> Rig {
    let config = RigConfig {
        camera: [width, width * 3 / 4],
        camera_focal_px: f64::from(width) * 1.17,
        ..RigConfig::default()
    };
    Scene::new(&config, &[PoseConfig::tilted(0.0, 0.0)]).unwrap().rig()
}

/// The same with both lenses bent.
fn bent_rig(width: u32) -> Rig {
    let mut rig = rig(width);
    rig.camera.model.distortion = Distortion::from_array([-0.2, 0.05, 1e-3, -5e-4, 0.0]);
    if let Some(projector) = &mut rig.projector {
        projector.device.model.distortion = Distortion::from_array([-0.06, 0.0, 0.0, 8e-4, 0.0]);
    }
    rig
}

/// A plane through (0, 0, `z`), tilted by degrees about x and y.
fn plane(z: f64, x: f64, y: f64) -> Plane {
    let turn = Rotation3::from_euler_angles(x.to_radians(), y.to_radians(), 0.0);
    Plane::from_point_normal(&Point3::new(0.0, 0.0, z), turn * Vector3::z()).unwrap()
}

fn wall(z: f64) -> Surface {
    Surface::around(Shape::Plane(plane(z, 0.0, 0.0)), 0.5)
}

fn block(x: f64, z: f64, size: f64) -> Shape {
    let rotation = Rotation3::from_euler_angles(0.2, 0.3, 0.1);
    let camera_from_block = Pose { rotation, translation: Vector3::new(x, 0.0, z) };
    Shape::Block { camera_from_block, size_mm: [size; 3] }
}

fn exact() -> RenderConfig {
    RenderConfig::exact()
}
