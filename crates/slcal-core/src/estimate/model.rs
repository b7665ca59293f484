//! The two devices, the transform between them and the sheet's poses: what is estimated.

use nalgebra::{DVector, Point2, Point3, Rotation3, Vector3};

use super::assumptions::Lens;
use super::residual::{LENS, lit_point};
use super::sheet::Sheet;
use super::unknowns::Unknowns;
use crate::geometry::{Camera, Distortion, Intrinsics, Pose, SheetBend};
use crate::parameter::{LensParameter, Parameter, PoseParameter};
use crate::rig::Rig;

/// A focal length outside this range (in units of the longer side of the image) is not that of a lens: 170° to 0.5° of view.
pub(crate) const FOCAL_RANGE: [f64; 2] = [0.05, 100.0];
/// Focal lengths of ordinary lenses in units of the longer side of the image: 118° to 3° of view.
pub(crate) const ORDINARY_FOCAL: [f64; 2] = [0.3, 20.0];
/// Each round gains two digits or more at the strongest distortion that a projector has.
const ROUNDS_ON_A_CURVED_COLUMN: usize = 30;

/// Everything that is estimated, and what is held fixed with it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Model {
    pub(crate) camera: Camera,
    pub(crate) projector: Option<Camera>,
    pub(crate) projector_from_camera: Pose,
    /// The sheet, view by view.
    pub(crate) views: Vec<Sheet>,
}

/// Values of a lens in the order of its parameters, focal length and aspect as logarithms.
pub(crate) fn lens_values(c: &Camera) -> [f64; LENS] {
    let d = c.distortion;
    let k = c.intrinsics;
    [k.fx.ln(), k.cx, k.cy, d.k1, d.k2, d.p1, d.p2, d.k3, (k.fy / k.fx).ln()]
}

/// fx, fy and skew grow together.
fn moved_lens(c: &Camera, lens: Lens, unknowns: &Unknowns, delta: &DVector<f64>) -> Option<Camera> {
    let position = |p| unknowns.lens(lens, p);
    let d = LensParameter::ALL.map(|p| position(p).map_or(0.0, |i| delta[i]));
    let (k, grow) = (c.intrinsics, d[0].exp());
    let l = c.distortion;
    let intrinsics = Intrinsics {
        fx: k.fx * grow,
        fy: k.fy * grow * d[8].exp(),
        skew: k.skew * grow,
        cx: k.cx + d[1],
        cy: k.cy + d[2],
    };
    let side = f64::from(c.width.max(c.height));
    let fine = position(LensParameter::Focal).is_none()
        || (FOCAL_RANGE[0] * side..=FOCAL_RANGE[1] * side).contains(&intrinsics.fx);
    let distortion =
        Distortion { k1: l.k1 + d[3], k2: l.k2 + d[4], p1: l.p1 + d[5], p2: l.p2 + d[6], k3: l.k3 + d[7] };
    (fine && intrinsics.cx.is_finite() && intrinsics.cy.is_finite()).then_some(Camera {
        intrinsics,
        distortion,
        ..*c
    })
}

fn moved_pose(p: &Pose, at: usize, delta: &DVector<f64>) -> Pose {
    let turn = Rotation3::new(Vector3::new(delta[at], delta[at + 1], delta[at + 2]));
    let shift = Vector3::new(delta[at + 3], delta[at + 4], delta[at + 5]);
    Pose { rotation: turn * p.rotation, translation: p.translation + shift }
}

fn moved_sheet(sheet: &Sheet, unknowns: &Unknowns, view: usize, delta: &DVector<f64>) -> Sheet {
    let mut bend = sheet.bend;
    if let Some(at) = unknowns.bend(view) {
        bend.0.iter_mut().enumerate().for_each(|(k, c)| *c += delta[at + k]);
    }
    Sheet { pose: moved_pose(&sheet.pose, unknowns.view(view), delta), bend, ..*sheet }
}

impl Model {
    /// A rig with all of its views.
    pub(crate) fn of_rig(rig: &Rig) -> Self {
        Self {
            camera: rig.camera.model,
            projector: rig.projector.map(|p| p.device.model),
            projector_from_camera: rig.projector.map_or(Pose::identity(), |p| p.from_camera.pose),
            views: rig
                .views
                .iter()
                .map(|v| Sheet {
                    pose: v.camera_from_sheet,
                    size: v.size,
                    bend: v.bend.map_or(SheetBend::FLAT, |b| b.shape),
                })
                .collect(),
        }
    }

    /// The same devices with other views.
    pub(crate) fn with_views(&self, views: &[Sheet]) -> Self {
        Self { views: views.to_vec(), ..*self }
    }

    /// A device, if there is one.
    pub(crate) fn lens(&self, lens: Lens) -> Option<&Camera> {
        match lens {
            Lens::Camera => Some(&self.camera),
            Lens::Projector => self.projector.as_ref(),
        }
    }

    /// The model after a step; `None` where a focal length leaves the range that lenses have.
    pub(crate) fn moved(&self, unknowns: &Unknowns, delta: &DVector<f64>) -> Option<Self> {
        Some(Self {
            camera: moved_lens(&self.camera, Lens::Camera, unknowns, delta)?,
            projector: match &self.projector {
                Some(p) => Some(moved_lens(p, Lens::Projector, unknowns, delta)?),
                None => None,
            },
            projector_from_camera: unknowns
                .projector_from_camera()
                .map_or(self.projector_from_camera, |at| moved_pose(&self.projector_from_camera, at, delta)),
            views: self.views.iter().enumerate().map(|(i, v)| moved_sheet(v, unknowns, i, delta)).collect(),
        })
    }

    /// The natural unit of each unknown: 1 for ln f, angles and coefficients, the width for pixels, the distance of the
    /// furthest sheet for lengths.
    pub(crate) fn units(&self, unknowns: &Unknowns) -> Vec<f64> {
        let distance = self.views.iter().map(|v| v.pose.translation.norm()).fold(f64::MIN_POSITIVE, f64::max);
        let lens = |lens: Lens, p| match p {
            LensParameter::Cx | LensParameter::Cy => self.lens(lens).map_or(1.0, |c| f64::from(c.width)),
            _ => 1.0,
        };
        let pose = |p| if p as usize >= PoseParameter::Tx as usize { distance } else { 1.0 };
        let unit = |parameter| match parameter {
            Parameter::Camera(p) => lens(Lens::Camera, p),
            Parameter::Projector(p) => lens(Lens::Projector, p),
            Parameter::ProjectorFromCamera(p) | Parameter::View(_, p) => pose(p),
            Parameter::Bend(..) => distance,
            Parameter::Other(_) => 1.0,
        };
        unknowns.parameters().into_iter().map(unit).collect()
    }

    /// Removes the drift from orthonormality that products of rotations collect.
    pub(crate) fn renormalise(&mut self) {
        let sheets = self.views.iter_mut().map(|v| &mut v.pose);
        for pose in sheets.chain([&mut self.projector_from_camera]) {
            pose.rotation.renormalize();
        }
    }

    /// Where a projector pixel falls on a sheet, in the camera frame; `None` when it misses it.
    pub(crate) fn lit(&self, sheet: &Sheet, q: Point2<f64>) -> Option<Point3<f64>> {
        lit_point(self.projector.as_ref()?, &self.projector_from_camera, sheet, q)
    }

    /// A camera pixel cast onto a sheet, in the camera frame; `None` when its ray misses it.
    pub(crate) fn on_sheet(&self, sheet: &Sheet, seen: Point2<f64>) -> Option<Point3<f64>> {
        sheet.meet(Point3::origin(), self.camera.bearing(seen)?).map(|hit| hit.point)
    }

    /// A camera pixel cast onto a sheet and seen from the projector, projector px.
    pub(crate) fn on_panel(&self, sheet: &Sheet, seen: Point2<f64>) -> Option<Point2<f64>> {
        let point = self.projector_from_camera.transform(&self.on_sheet(sheet, seen)?);
        self.projector.as_ref()?.project(&point)
    }

    /// Distance along the camera's ray through pixel `p` (per unit of the bearing's length) at which the projector's column
    /// `column` crosses it (Orghidan et al. 2014, eq. 17 to 19). `row` is about where the light comes from.
    pub(crate) fn depth_on_column(&self, p: Point2<f64>, column: f64, row: f64) -> Option<f64> {
        let projector = self.projector.as_ref()?;
        let ray = self.projector_from_camera.rotation * self.camera.bearing(p)?;
        let t = self.projector_from_camera.translation;
        // The column as the plane through the projector's centre and the light at (column, row) along the panel's y axis. A
        // distorted column is no plane: its part at the row that the point is lit from.
        let mut row = row;
        for _ in 0..ROUNDS_ON_A_CURVED_COLUMN {
            let light = projector.bearing(Point2::new(column, row))?;
            let s = -(t.x - light.x * t.z) / (ray.x - light.x * ray.z);
            if !(s.is_finite() && s > 0.0) {
                return None;
            }
            if projector.distortion.is_none() {
                return Some(s);
            }
            let next = projector.project(&Point3::from(ray * s + t))?.y;
            if (next - row).abs() < 1e-9 * f64::from(projector.height) {
                return Some(s);
            }
            row = next;
        }
        None
    }
}
