//! The usual objects in front of a rig: a plane, a sphere, a step, a sheet or a mesh, placed by a few numbers.

use nalgebra::{Point3, Rotation3, Vector3};

use super::mesh::TriangleMesh;
use super::sheet_object::SheetObject;
use super::surface::{Shape, Surface};
use crate::error::{Error, Result};
use crate::geometry::{Plane, Pose, RectangleSize};

/// The blocks of [`SceneObject::Step`]: middle (right, down) and width, height, depth, in distances from the camera.
const BLOCKS: [([f64; 2], [f64; 3]); 2] =
    [([-0.13, 0.02], [0.16, 0.22, 0.06]), ([0.11, -0.03], [0.13, 0.17, 0.12])];

/// The object in front of the rig.
#[derive(Debug, Clone, PartialEq)]
pub enum SceneObject {
    /// An endless plane.
    Plane,
    /// A sphere.
    Sphere {
        /// Its radius, mm.
        radius_mm: f64,
    },
    /// A wall with two blocks in front of it that cast shadows.
    Step,
    /// A sheet, flat or bent, or a board.
    Sheet(SheetObject),
    /// A mesh in its own frame, mm, with y up and z towards the viewer, placed by the middle of its box.
    Mesh(TriangleMesh),
    /// A mesh in the camera's frame, where it stays; only its wall is placed.
    MeshInCamera(TriangleMesh),
}

/// Place and colour of the object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Its middle in the camera's frame, mm: right, down, forward.
    pub middle_mm: [f64; 3],
    /// Rotations about the camera's x, y and z axis, R = Rx·Ry·Rz, rad.
    pub turn_rad: [f64; 3],
    /// Its albedo.
    pub albedo: [f64; 3],
    /// Distance of a wall behind the object's middle, mm, which rotates with it; `None` for no wall.
    pub wall_mm: Option<f64>,
    /// The grey albedo of that wall.
    pub wall_albedo: f64,
}

impl Placement {
    /// object's frame (x right, y down, z away, its middle the origin) → camera.
    #[must_use]
    pub fn camera_from_middle(&self) -> Pose {
        let [x, y, z] = self.turn_rad;
        let about = |axis, angle| Rotation3::from_axis_angle(&axis, angle);
        let rotation =
            about(Vector3::x_axis(), x) * about(Vector3::y_axis(), y) * about(Vector3::z_axis(), z);
        Pose { rotation, translation: Vector3::from(self.middle_mm) }
    }

    /// sheet (its corner the origin) → camera, for a sheet of this size.
    #[must_use]
    pub fn camera_from_sheet(&self, size: RectangleSize) -> Pose {
        let corner = Vector3::new(-size.width_mm / 2.0, -size.height_mm / 2.0, 0.0);
        self.camera_from_middle().compose(&Pose { rotation: Rotation3::identity(), translation: corner })
    }
}

impl SceneObject {
    /// The surfaces: the object's own first, the wall last.
    ///
    /// # Errors
    /// [`Error::Invalid`] for places and sizes that are not finite, albedos outside 0–1, a sheet or plane that is
    /// turned away, and a sphere that contains the camera.
    pub fn surfaces(&self, placement: &Placement) -> Result<Vec<Surface>> {
        let finite = placement.middle_mm.iter().chain(&placement.turn_rad).all(|x| x.is_finite());
        if !finite || placement.wall_mm.is_some_and(|w| !w.is_finite()) {
            return Err(Error::invalid(
                "place of the object",
                "finite lengths and angles",
                format!("{placement:?}"),
            ));
        }
        let pose = placement.camera_from_middle();
        let object = |shape| Surface::object(shape).colored(placement.albedo);
        let mut surfaces = match self {
            Self::Plane => vec![object(Shape::Plane(behind(&pose, 0.0)?))],
            Self::Sphere { radius_mm } => {
                let distance = pose.translation.norm();
                if *radius_mm >= distance {
                    let expected =
                        format!("less than the {distance:.1} mm to its middle, so that its outside is seen");
                    return Err(Error::invalid("radius of the sphere", expected, format!("{radius_mm} mm")));
                }
                vec![object(Shape::Sphere { centre: pose.translation.into(), radius_mm: *radius_mm })]
            }
            Self::Step => {
                let mut all: Vec<Surface> =
                    blocks(&pose, placement.middle_mm[2]).into_iter().map(object).collect();
                all.push(Surface::around(Shape::Plane(behind(&pose, 0.0)?), placement.wall_albedo));
                all
            }
            Self::Sheet(sheet) => {
                let shapes = sheet.shapes(&placement.camera_from_sheet(sheet.size))?;
                shapes.into_iter().map(object).collect()
            }
            Self::Mesh(mesh) => vec![object(Shape::Mesh(stood(mesh, &pose)?))],
            Self::MeshInCamera(mesh) => vec![object(Shape::Mesh(mesh.clone()))],
        };
        if let Some(distance) = placement.wall_mm {
            surfaces.push(Surface::around(Shape::Plane(behind(&pose, distance)?), placement.wall_albedo));
        }
        surfaces.iter().try_for_each(Surface::validate)?;
        Ok(surfaces)
    }
}

/// The plane at this distance behind the middle.
fn behind(pose: &Pose, distance: f64) -> Result<Plane> {
    let normal = pose.rotation * Vector3::z();
    let point = Point3::from(pose.translation + normal * distance);
    if normal.z <= 0.0 {
        return Err(Error::invalid(
            "tilt",
            "less than 90°, so that the front is seen",
            "a surface turned away",
        ));
    }
    Plane::from_point_normal(&point, normal)
        .ok_or_else(|| Error::invalid("tilt", "finite angles", "a plane without a normal"))
}

/// Blocks that stand on the plane through the middle.
fn blocks(pose: &Pose, distance: f64) -> Vec<Shape> {
    let block = |([x, y], size): ([f64; 2], [f64; 3])| {
        let size_mm = size.map(|s| s * distance);
        let translation = Vector3::new(x * distance, y * distance, -size_mm[2] / 2.0);
        let on_wall = Pose { rotation: Rotation3::identity(), translation };
        Shape::Block { camera_from_block: pose.compose(&on_wall), size_mm }
    };
    BLOCKS.into_iter().map(block).collect()
}

/// A mesh with y up and z towards the viewer, placed with the middle of its box at the pose.
fn stood(mesh: &TriangleMesh, pose: &Pose) -> Result<TriangleMesh> {
    let [least, most] = mesh.bounds();
    let half_turn = Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    let rotation = pose.rotation * half_turn;
    let middle = (least.coords + most.coords) / 2.0;
    mesh.placed(1.0, &Pose { rotation, translation: pose.translation - rotation * middle })
}
