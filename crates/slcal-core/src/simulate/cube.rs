//! The reference cube: the accuracy of a calibration in space.

use nalgebra::{Point2, Point3, Vector3};

use super::draws::Draws;
use super::scene::Scene;
use crate::error::{Error, Result};
use crate::geometry::{Camera, Pose};
use crate::matches::{Match, Matches};
use crate::reconstruct::{TriangulateConfig, triangulate};
use crate::rig::Rig;

/// A cube on the middle of the sheet, its edges along the sheet's sides: those of its corners that both devices see.
#[derive(Debug, Clone, PartialEq)]
pub struct Cube {
    edge_mm: f64,
    /// Visible corners in the camera frame, with the camera's and the projector's pixel of each.
    corners: Vec<(Point3<f64>, Point2<f64>, Point2<f64>)>,
    /// Pairs of visible corners that an edge joins.
    edges: Vec<[usize; 2]>,
}

/// The error of a triangulated cube, in per cent of its edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CubeError {
    /// Mean distance of the corners from their true positions, in the camera's frame.
    pub position_percent: f64,
    /// Root mean square error of the lengths of its edges, which does not depend on the cube's pose.
    pub length_percent: f64,
}

/// The corner with index bits x, y, z, in units of the edge about the middle of the face on the sheet.
fn unit_corner(i: usize) -> Vector3<f64> {
    let bit = |k: usize| ((i >> k) & 1) as f64;
    // Towards the viewer is the sheet's −Z.
    Vector3::new(bit(0) - 0.5, bit(1) - 0.5, -bit(2))
}

impl Cube {
    /// The cube on the sheet of view 0.
    ///
    /// # Errors
    /// [`Error::Invalid`] for an edge that is not positive, a scene without a view, or a cube of which the two devices do not
    /// see a face together, inside picture and panel.
    pub fn new(scene: &Scene, edge_mm: f64) -> Result<Self> {
        let (w, h) = (scene.size.width_mm, scene.size.height_mm);
        if !(edge_mm > 0.0 && edge_mm <= w.min(h)) {
            let expected = format!("an edge above 0 and at most the sheet's shorter side, {} mm", w.min(h));
            return Err(Error::invalid("reference cube", expected, format!("{edge_mm} mm")));
        }
        let view = scene.views.first().ok_or_else(|| Error::invalid("poses", "at least one", "none"))?;
        let middle = Vector3::new(w / 2.0, h / 2.0, 0.0);
        let place = |i: usize| view.transform(&Point3::from(middle + unit_corner(i) * edge_mm));
        let mut corners = Vec::new();
        let mut index = [None; 8];
        for (i, slot) in index.iter_mut().enumerate() {
            if !seen_by_both(i, view, scene, &place) {
                continue;
            }
            let p = place(i);
            let in_camera = inside(&scene.camera, &p);
            let in_projector = inside(&scene.projector, &scene.projector_from_camera.transform(&p));
            let (Some(a), Some(b)) = (in_camera, in_projector) else {
                return Err(Error::invalid(
                    "reference cube",
                    "corners inside the camera's picture and the projector's light (a smaller cube)",
                    format!("a corner beyond them with an edge of {edge_mm} mm"),
                ));
            };
            *slot = Some(corners.len());
            corners.push((p, a, b));
        }
        let joined = |i: usize, k: usize| Some([index[i]?, index[i | (1 << k)]?]);
        let edges: Vec<[usize; 2]> =
            (0..24).filter(|n| (n / 3) & (1 << (n % 3)) == 0).filter_map(|n| joined(n / 3, n % 3)).collect();
        if corners.len() < 4 {
            let expected = "a face that both devices see (another tilt, a shorter baseline)";
            return Err(Error::invalid(
                "reference cube",
                expected,
                format!("{} visible corners", corners.len()),
            ));
        }
        Ok(Self { edge_mm, corners, edges })
    }

    /// Length of an edge, mm.
    #[must_use]
    pub fn edge_mm(&self) -> f64 {
        self.edge_mm
    }

    /// Number of corners that both devices see.
    #[must_use]
    pub fn visible(&self) -> usize {
        self.corners.len()
    }

    /// Triangulates the visible corners with a rig, from camera pixels with noise and exact projector pixels; `None`
    /// when a corner's rays do not meet.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a rig without a projector.
    pub fn error(&self, rig: &Rig, sigma_px: f64, draws: &mut Draws) -> Result<Option<CubeError>> {
        let items = self.corners.iter().map(|(_, camera, projector)| Match {
            camera: camera + draws.jitter(sigma_px),
            projector_column: Some(projector.x),
            projector_row: Some(projector.y),
            slit: None,
            confidence: 1.0,
            sigma_px: sigma_px.max(f64::MIN_POSITIVE),
            color: [0; 3],
        });
        let matches = Matches { items: items.collect() };
        let (cloud, _) = triangulate(rig, &matches, &TriangulateConfig::default())?;
        if cloud.points.len() != self.corners.len() {
            return Ok(None);
        }
        let at = |i: usize| cloud.points[i].position;
        let n = self.corners.len() as f64;
        let distance = self.corners.iter().enumerate().map(|(i, c)| (at(i) - c.0).norm()).sum::<f64>() / n;
        let off = |e: &[usize; 2]| (at(e[0]) - at(e[1])).norm() - self.edge_mm;
        let squares = self.edges.iter().map(|e| off(e).powi(2)).sum::<f64>() / self.edges.len() as f64;
        let percent = 100.0 / self.edge_mm;
        Ok(Some(CubeError { position_percent: distance * percent, length_percent: squares.sqrt() * percent }))
    }
}

/// Whether a corner belongs to a face that looks towards both devices.
fn seen_by_both(i: usize, view: &Pose, scene: &Scene, place: &dyn Fn(usize) -> Point3<f64>) -> bool {
    let centres = [Point3::origin(), scene.projector_from_camera.centre()];
    (0..3).any(|axis| {
        let outward = if (i >> axis) & 1 == usize::from(axis != 2) { 1.0 } else { -1.0 };
        let normal = view.rotation * Vector3::ith(axis, outward);
        centres.iter().all(|c| normal.dot(&(c - place(i))) > 0.0)
    })
}

fn inside(device: &Camera, p: &Point3<f64>) -> Option<Point2<f64>> {
    let [w, h] = [device.width, device.height].map(f64::from);
    device.project(p).filter(|q| (-0.5..=w - 0.5).contains(&q.x) && (-0.5..=h - 0.5).contains(&q.y))
}
