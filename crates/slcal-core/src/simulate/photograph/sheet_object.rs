//! A sheet of paper or a board in front of the rig.

use nalgebra::Point3;

use super::mesh::TriangleMesh;
use super::surface::Shape;
use crate::error::{Error, Result};
use crate::geometry::{Pose, RectangleSize};
use crate::simulate::bend::BendConfig;
use crate::simulate::bent_sheet::BentSheet;

/// Flat parts of the side face of a bent board. Each leaves the true face by less than 2e-6 of the side.
const PARTS: u32 = 256;

/// A sheet, flat or bent, without thickness or as a board.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetObject {
    /// The sides of the flat sheet.
    pub size: RectangleSize,
    /// The shape; `None` for a flat one.
    pub bent: Option<BentSheet>,
    /// The thickness behind the front, mm; 0 for a sheet without side faces.
    pub thickness_mm: f64,
}

impl SheetObject {
    /// A sheet.
    ///
    /// # Errors
    /// [`Error::Invalid`] for bends as [`BendConfig::validate`], and a thickness that is negative or above the shorter side.
    pub fn new(size: RectangleSize, bend: Option<&BendConfig>, thickness_mm: f64) -> Result<Self> {
        let most = size.width_mm.min(size.height_mm);
        if !(0.0..=most).contains(&thickness_mm) {
            let expected = format!("0 to {most} mm, the shorter side");
            return Err(Error::invalid("thickness of the sheet", expected, format!("{thickness_mm} mm")));
        }
        let bent = bend.map(|b| BentSheet::new(b, size)).transpose()?;
        Ok(Self { size, bent, thickness_mm })
    }

    /// Its front, then its side faces.
    pub(super) fn shapes(&self, camera_from_sheet: &Pose) -> Result<Vec<Shape>> {
        let camera_from_sheet = *camera_from_sheet;
        let mut shapes = vec![match &self.bent {
            None => Shape::Rectangle { camera_from_rectangle: camera_from_sheet, size: self.size },
            Some(sheet) => Shape::BentSheet { camera_from_sheet, sheet: sheet.clone() },
        }];
        if self.thickness_mm > 0.0 {
            shapes.push(Shape::Mesh(self.side_faces(&camera_from_sheet)?));
        }
        Ok(shapes)
    }

    /// The side faces, perpendicular to the front all the way round. The back is never seen.
    fn side_faces(&self, camera_from_sheet: &Pose) -> Result<TriangleMesh> {
        let parts = if self.bent.is_some() { PARTS } else { 1 };
        let corners = self.size.corners();
        let mut vertices = Vec::new();
        for side in 0..4 {
            let (a, b) = (corners[side], corners[(side + 1) % 4]);
            for i in 0..parts {
                let p = a + (b - a) * (f64::from(i) / f64::from(parts));
                let (front, normal) = match &self.bent {
                    None => (Point3::new(p.x, p.y, 0.0), nalgebra::Vector3::z()),
                    Some(sheet) => (sheet.point(p), sheet.normal(p)),
                };
                let back = front + normal * self.thickness_mm;
                vertices.extend([front, back].map(|p| camera_from_sheet.transform(&p)));
            }
        }
        let count = vertices.len() as u32;
        let faces = (0..count).step_by(2).flat_map(|i| {
            let [front, back, next, next_back] = [i, i + 1, (i + 2) % count, (i + 3) % count];
            [[front, next, back], [back, next, next_back]]
        });
        TriangleMesh::new(vertices, faces.collect())
    }
}
