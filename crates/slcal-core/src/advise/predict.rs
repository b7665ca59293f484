//! How well focal lengths would be known from given poses: the same Jacobian and priors at hypothetical measurements.

use nalgebra::{Matrix3, Point2, Point3, Rotation3, Unit, Vector3};

use crate::estimate::model::{Layout, Model};
use crate::estimate::refine::{Fit, covariance_at};
use crate::estimate::residual::lit_point;
use crate::estimate::{Joint, Kind, Measurement, Target};
use crate::geometry::{Pose, RectangleSize, Side};

/// Points that stand for a side in a prediction; their σ carries the information of all that were measured.
const POINTS_PER_SIDE: usize = 8;
/// The tilt that advice tries, rad.
pub(crate) const MORE_TILT: f64 = 15.0 * std::f64::consts::PI / 180.0;

/// Predicted relative σ of the focal lengths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FocalSigma {
    pub(crate) camera: f64,
    pub(crate) projector: Option<f64>,
}

impl FocalSigma {
    /// The larger one decides.
    pub(crate) fn worst(&self) -> f64 {
        self.camera.max(self.projector.unwrap_or(0.0))
    }
}

/// The relative σ of the focal lengths in a covariance of the layout's unknowns.
pub(crate) fn focal_sigma(covariance: &nalgebra::DMatrix<f64>, layout: &Layout) -> FocalSigma {
    let sigma = |place: Option<usize>| place.map_or(0.0, |i| covariance[(i, i)].sqrt());
    FocalSigma {
        camera: sigma(layout.camera[0]),
        projector: layout.stereo.map(|_| sigma(layout.projector[0])),
    }
}

/// What one measured view would yield in another pose, as exact measurements with the σ of the real ones.
struct Template {
    size: RectangleSize,
    /// Of each side, σ per point; or of each corner.
    sheet: Result<[f64; 4], f64>,
    pairs: Vec<(Point2<f64>, f64)>,
}

fn template(joint: &Joint, fit: &Fit, view: usize) -> Template {
    let mut information = [0.0; 4];
    let mut corner = None;
    let mut pairs = Vec::new();
    for (m, _) in joint.measurements.iter().zip(&fit.inliers).filter(|(m, keep)| m.view == view && **keep) {
        match m.of {
            Target::Edge(side) => information[side as usize] += (m.sigma_px * fit.widened[0]).powi(-2),
            Target::SheetCorner(_) => corner = Some(m.sigma_px),
            Target::Pair(q) => pairs.push((q, m.sigma_px * fit.widened[1])),
        }
    }
    let sheet = match corner {
        Some(sigma) => Err(sigma),
        None => Ok(information.map(|i: f64| (POINTS_PER_SIDE as f64 / i.max(f64::MIN_POSITIVE)).sqrt())),
    };
    Template { size: joint.sizes[view], sheet, pairs }
}

impl Template {
    /// The measurements in `pose`; `None` when part of the sheet would lie behind the camera.
    fn at(&self, model: &Model, pose: &Pose, view: usize) -> Option<Vec<Measurement>> {
        let project = |p: Point2<f64>| model.camera.project(&pose.transform(&Point3::new(p.x, p.y, 0.0)));
        let corners = self.size.corners();
        let mut all = Vec::new();
        match self.sheet {
            Err(sigma_px) => {
                for c in corners {
                    all.push(Measurement { view, seen: project(c)?, sigma_px, of: Target::SheetCorner(c) });
                }
            }
            Ok(sigmas) => {
                for side in Side::ALL {
                    let (a, b) = (corners[side as usize], corners[(side as usize + 1) % 4]);
                    for i in 0..POINTS_PER_SIDE {
                        let p = a + (b - a) * ((i as f64 + 0.5) / POINTS_PER_SIDE as f64);
                        let sigma_px = sigmas[side as usize];
                        all.push(Measurement { view, seen: project(p)?, sigma_px, of: Target::Edge(side) });
                    }
                }
            }
        }
        if let Some(projector) = &model.projector {
            for &(q, sigma_px) in &self.pairs {
                let Some(p) = lit_point(projector, &model.projector_from_camera, pose, q) else { continue };
                let Some(seen) = model.camera.project(&p) else { continue };
                all.push(Measurement { view, seen, sigma_px, of: Target::Pair(q) });
            }
        }
        Some(all)
    }
}

/// Predicted σ when view 0 is seen in each of `poses`.
pub(crate) fn predict(joint: &Joint, fit: &Fit, poses: &[Pose]) -> Option<FocalSigma> {
    let template = template(joint, fit, 0);
    let mut all = Vec::new();
    for (i, pose) in poses.iter().enumerate() {
        all.extend(template.at(&fit.model, pose, i)?);
    }
    let model = Model { views: poses.to_vec(), ..fit.model.clone() };
    let layout = joint.layout.with_views(poses.len());
    let hypothetical = Joint::new(vec![template.size; poses.len()], all, layout, joint.priors.clone());
    let inliers = vec![true; hypothetical.measurements.len()];
    let covariance = covariance_at(&hypothetical, &model, &inliers, [1.0; 2])?;
    Some(focal_sigma(&covariance, &hypothetical.layout))
}

/// σ of the focal lengths if the principal points were known exactly.
pub(crate) fn with_exact_principal_points(joint: &Joint, fit: &Fit) -> Option<FocalSigma> {
    // A prior of (almost) no width takes the unknown out without renumbering.
    let exact = joint.priors.iter().map(|p| crate::estimate::model::Prior {
        sigma: if (1..=2).contains(&p.index) { p.sigma * 1e-4 } else { p.sigma },
        ..*p
    });
    let (sizes, seen) = (joint.sizes.clone(), joint.measurements.clone());
    let mut tight = Joint::new(sizes, seen, joint.layout.clone(), exact.collect());
    for (block, original) in tight.blocks.iter_mut().zip(&joint.blocks) {
        block.loss = original.loss;
    }
    let covariance = covariance_at(&tight, &fit.model, &fit.inliers, fit.widened)?;
    Some(focal_sigma(&covariance, &joint.layout))
}

/// The pose turned about an axis of the camera frame through the sheet's centre.
pub(crate) fn turned(pose: &Pose, size: RectangleSize, axis: Unit<Vector3<f64>>, angle: f64) -> Pose {
    let centre = Point3::new(size.width_mm / 2.0, size.height_mm / 2.0, 0.0);
    let at = pose.transform(&centre);
    let rotation = Rotation3::from_axis_angle(&axis, angle) * pose.rotation;
    Pose { rotation, translation: at.coords - rotation * centre.coords }
}

/// The pose with the tilt reversed about both axes, the roll and the sheet's centre kept.
pub(crate) fn reversed(pose: &Pose, size: RectangleSize) -> Pose {
    let centre = Point3::new(size.width_mm / 2.0, size.height_mm / 2.0, 0.0);
    let at = pose.transform(&centre);
    let half_turn = Matrix3::from_diagonal(&Vector3::new(-1.0, -1.0, 1.0));
    let rotation = Rotation3::from_matrix_unchecked(half_turn * pose.rotation.matrix() * half_turn);
    Pose { rotation, translation: at.coords - rotation * centre.coords }
}

/// Tilt of the sheet against the image plane: in all, about the camera's horizontal axis, about its vertical axis; rad.
pub(crate) fn tilt(pose: &Pose) -> [f64; 3] {
    let n = pose.rotation * Vector3::z();
    [n.xy().norm().atan2(n.z), (-n.y).atan2(n.z), n.x.atan2(n.z)]
}

/// Whether anything of a kind was measured.
pub(crate) fn has(joint: &Joint, kind: Kind) -> bool {
    joint.measurements.iter().any(|m| m.kind() == kind)
}
