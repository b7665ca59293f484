//! Surfaces in front of the rig.

use nalgebra::{Point3, Vector3};

use super::hit::Hit;
use super::mesh::TriangleMesh;
use crate::error::{Error, Result};
use crate::geometry::{Plane, Pose, Ray, RectangleSize};
use crate::simulate::bent_sheet::BentSheet;

/// The shape of a surface, in the camera's frame, mm. All are visible and lit from both sides, and cast shadows.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// An endless plane.
    Plane(Plane),
    /// A sphere.
    Sphere {
        /// Its centre.
        centre: Point3<f64>,
        /// Its radius, mm.
        radius_mm: f64,
    },
    /// A flat rectangle with its top left corner at its own origin and its sides along its own x and y.
    Rectangle {
        /// Its pose.
        camera_from_rectangle: Pose,
        /// Its sides.
        size: RectangleSize,
    },
    /// A bent sheet with the top left corner of the flat one at its own origin.
    BentSheet {
        /// The pose of the flat sheet.
        camera_from_sheet: Pose,
        /// Its shape.
        sheet: BentSheet,
    },
    /// A block, its centre at its own origin.
    Block {
        /// Its pose.
        camera_from_block: Pose,
        /// Its edges along its own x, y and z, mm.
        size_mm: [f64; 3],
    },
    /// Triangles.
    Mesh(TriangleMesh),
}

/// A surface and its colour.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Its shape and place.
    pub shape: Shape,
    /// Albedo, red, green, blue, 0–1; matt.
    pub albedo: [f64; 3],
    /// Whether it is the object, or else part of its surroundings; rendering treats both alike.
    pub is_object: bool,
}

impl Surface {
    /// A white object.
    #[must_use]
    pub fn object(shape: Shape) -> Self {
        Self { shape, albedo: [1.0; 3], is_object: true }
    }

    /// Part of the surroundings, of grey `albedo`.
    #[must_use]
    pub fn around(shape: Shape, albedo: f64) -> Self {
        Self { shape, albedo: [albedo; 3], is_object: false }
    }

    /// The same in another colour.
    #[must_use]
    pub fn colored(self, albedo: [f64; 3]) -> Self {
        Self { albedo, ..self }
    }

    /// Checks the values.
    ///
    /// # Errors
    /// [`Error::Invalid`] for albedos outside 0–1 and lengths that are not positive and finite.
    pub fn validate(&self) -> Result<()> {
        if let Some(a) = self.albedo.iter().find(|a| !(0.0..=1.0).contains(*a)) {
            return Err(Error::invalid("albedo", "0 to 1 in each channel", a));
        }
        let finite = |v: &Vector3<f64>| v.iter().all(|x| x.is_finite());
        let (lengths, placed) = match &self.shape {
            Shape::Plane(p) => (Vec::new(), p.offset_mm.is_finite() && finite(&p.normal)),
            Shape::Sphere { centre, radius_mm } => (vec![*radius_mm], finite(&centre.coords)),
            Shape::Rectangle { camera_from_rectangle: pose, size } => {
                (vec![size.width_mm, size.height_mm], finite(&pose.translation))
            }
            Shape::BentSheet { camera_from_sheet: pose, .. } => (Vec::new(), finite(&pose.translation)),
            Shape::Block { camera_from_block: pose, size_mm } => {
                (size_mm.to_vec(), finite(&pose.translation))
            }
            Shape::Mesh(_) => (Vec::new(), true),
        };
        if let Some(l) = lengths.iter().find(|l| !(l.is_finite() && **l > 0.0)) {
            return Err(Error::invalid("size of a surface", "positive lengths", format!("{l} mm")));
        }
        if !placed {
            return Err(Error::invalid(
                "place of a surface",
                "finite coordinates",
                format!("{:?}", self.shape),
            ));
        }
        Ok(())
    }

    /// The nearest point of the surface on a ray, further than `after` and nearer than `before` in lengths of the ray's
    /// direction.
    pub(super) fn meet(&self, ray: &Ray, [after, before]: [f64; 2]) -> Option<Hit> {
        let inside = |s: f64| s > after && s < before;
        match &self.shape {
            Shape::Plane(plane) => {
                let distance = -plane.signed_distance_mm(&ray.origin) / plane.normal.dot(&ray.direction);
                inside(distance).then_some(Hit { distance, normal: *plane.normal })
            }
            Shape::Sphere { centre, radius_mm } => {
                let distance = sphere(ray, *centre, *radius_mm).into_iter().flatten().find(|s| inside(*s))?;
                Some(Hit { distance, normal: ray.origin + ray.direction * distance - centre })
            }
            Shape::Rectangle { camera_from_rectangle, size } => {
                let local = local(ray, camera_from_rectangle);
                let distance = -local.origin.z / local.direction.z;
                let p = local.origin + local.direction * distance;
                let hit = inside(distance)
                    && (0.0..=size.width_mm).contains(&p.x)
                    && (0.0..=size.height_mm).contains(&p.y);
                hit.then(|| Hit { distance, normal: camera_from_rectangle.rotation * Vector3::z() })
            }
            Shape::BentSheet { camera_from_sheet, sheet } => {
                let hit = sheet.meet(&local(ray, camera_from_sheet), [after, before])?;
                let normal = camera_from_sheet.rotation * hit.normal;
                Some(Hit { distance: hit.distance, normal })
            }
            Shape::Block { camera_from_block, size_mm } => {
                let (distance, axis) =
                    block(&local(ray, camera_from_block), *size_mm).into_iter().find(|(s, _)| inside(*s))?;
                let normal = camera_from_block.rotation * Vector3::ith(axis, 1.0);
                Some(Hit { distance, normal })
            }
            Shape::Mesh(mesh) => mesh.meet(ray, [after, before]),
        }
    }
}

fn local(ray: &Ray, camera_from_local: &Pose) -> Ray {
    let back = camera_from_local.rotation.inverse();
    Ray { origin: back * (ray.origin - camera_from_local.translation), direction: back * ray.direction }
}

/// Both points on the line, nearest first; none when it passes by.
fn sphere(ray: &Ray, centre: Point3<f64>, radius: f64) -> Option<[f64; 2]> {
    let a = ray.direction.norm_squared();
    let to_centre = centre - ray.origin;
    let closest = ray.direction.dot(&to_centre) / a;
    // The offset of the line from the centre as a vector; b² − ac would lose significant digits.
    let off = (to_centre - ray.direction * closest).norm_squared();
    let half = ((radius * radius - off) / a).sqrt();
    half.is_finite().then_some([closest - half, closest + half])
}

/// Entry and exit of a line and the axes that they are perpendicular to.
fn block(ray: &Ray, size: [f64; 3]) -> [(f64, usize); 2] {
    let (mut entry, mut exit) = ((f64::NEG_INFINITY, 0), (f64::INFINITY, 0));
    for (axis, edge) in size.into_iter().enumerate() {
        let half = edge / 2.0;
        let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
        let [a, b] = [(-half - origin) / direction, (half - origin) / direction];
        // Within the slab all the way: no limit (0/0 on its very border counts as outside).
        if direction == 0.0 && origin.abs() < half {
            continue;
        }
        let (near, far) = (a.min(b), a.max(b));
        if !(near <= exit.0 && far >= entry.0) {
            return [(f64::NAN, 0); 2];
        }
        if near > entry.0 {
            entry = (near, axis);
        }
        if far < exit.0 {
            exit = (far, axis);
        }
    }
    if entry.0 <= exit.0 { [entry, exit] } else { [(f64::NAN, 0); 2] }
}
