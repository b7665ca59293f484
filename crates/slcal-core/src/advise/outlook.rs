//! What would be known after another photograph: the calibration's own Jacobian at measurements that were not made.

use nalgebra::{DMatrix, DVector, Point2, Point3};

use super::shared::{self, PROJECTOR, Rows, SHARED, STEREO, rows};
use crate::calibrate::depth_on_column;
use crate::estimate::model::Model;
use crate::estimate::residual::{POSE, lit_point};
use crate::estimate::{Measurement, Target};
use crate::geometry::{Pose, RectangleSize, Side};
use crate::rig::Rig;
use crate::solve::{Structure, covariance};

/// Points that stand for a side; their σ carries the information of all that would be measured.
const POINTS_PER_SIDE: usize = 8;
/// 1σ of a stripe's position in the camera image that the σ of a point assumes, px; as for the rig's own.
const STRIPE_NOISE_PX: f64 = 0.1;
/// The sheet lies in the frame with this part of the frame's width to spare.
const FRAME_MARGIN: f64 = 0.01;
/// Neither device looks onto the sheet flatter than this, cosine (65° from face-on): squares would shrink to slivers.
const FLATTEST: f64 = 0.42;

/// 1σ of what matters, from a covariance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Predicted {
    /// Of the camera's focal length, as a share of it.
    pub camera_focal: f64,
    /// Of the projector's focal length, as a share of it.
    pub projector_focal: Option<f64>,
    /// Of the projector's vertical principal point, px.
    pub projector_cy_px: Option<f64>,
    /// Of a point at the middle of the sheet along the camera's ray, mm, with 0.1 px of stripe noise.
    pub point_mm: Option<f64>,
}

impl Predicted {
    /// The larger one of the focal lengths decides.
    #[must_use]
    pub fn worst_focal(&self) -> f64 {
        self.camera_focal.max(self.projector_focal.unwrap_or(0.0))
    }
}

/// What is known, and what a photograph would show.
#[derive(Debug, Clone)]
pub(crate) struct Outlook {
    /// Its views are the poses that were photographed already.
    pub(crate) model: Model,
    /// F with F·Fᵀ the covariance of the shared unknowns.
    pub(crate) root: DMatrix<f64>,
    pub(crate) size: RectangleSize,
    /// Corners of the sheet alone are measured, not points along its sides.
    pub(crate) corners_only: bool,
    /// Of each point that stands for a side (or of each corner), px.
    pub(crate) sheet_sigma_px: f64,
    /// Where the pattern's corners are on the panel.
    pub(crate) pattern: Vec<Point2<f64>>,
    pub(crate) pattern_sigma_px: f64,
}

impl Outlook {
    /// What would be measured in a pose; `None` when part of the sheet is behind the camera or the pattern beside the plane.
    pub(crate) fn measurements(&self, pose: &Pose) -> Option<Vec<Measurement>> {
        let camera = &self.model.camera;
        let see = |p: Point2<f64>| camera.project(&pose.transform(&Point3::new(p.x, p.y, 0.0)));
        let corners = self.size.corners();
        let mut all = Vec::new();
        let mut put = |seen, sigma_px, of| all.push(Measurement { view: 0, seen, sigma_px, of });
        if self.corners_only {
            for c in corners {
                put(see(c)?, self.sheet_sigma_px, Target::SheetCorner(c));
            }
        } else {
            for side in Side::ALL {
                let (a, b) = (corners[side as usize], corners[(side as usize + 1) % 4]);
                for i in 0..POINTS_PER_SIDE {
                    let p = a + (b - a) * ((i as f64 + 0.5) / POINTS_PER_SIDE as f64);
                    put(see(p)?, self.sheet_sigma_px, Target::Edge(side));
                }
            }
        }
        if let Some(projector) = &self.model.projector {
            for &q in &self.pattern {
                let p = lit_point(projector, &self.model.projector_from_camera, pose, q)?;
                put(camera.project(&p)?, self.pattern_sigma_px, Target::Pair(q));
            }
        }
        Some(all)
    }

    /// The rows of a pose.
    pub(crate) fn rows(&self, pose: &Pose) -> Option<Rows> {
        let model = Model { views: vec![*pose], ..self.model.clone() };
        rows(&model, self.size, &self.measurements(pose)?)
    }

    /// Whether the sheet in this pose is in the frame, the pattern on the sheet, and both seen under a fair angle.
    pub(crate) fn feasible(&self, pose: &Pose) -> bool {
        self.in_frame(pose) && self.holds_pattern(pose) && self.faces(pose)
    }

    fn in_frame(&self, pose: &Pose) -> bool {
        let camera = &self.model.camera;
        let (w, h) = (f64::from(camera.width), f64::from(camera.height));
        let margin = FRAME_MARGIN * w;
        self.size.corners().into_iter().all(|c| {
            camera.project(&pose.transform(&Point3::new(c.x, c.y, 0.0))).is_some_and(|p| {
                (margin..=w - 1.0 - margin).contains(&p.x) && (margin..=h - 1.0 - margin).contains(&p.y)
            })
        })
    }

    pub(crate) fn holds_pattern(&self, pose: &Pose) -> bool {
        let Some(projector) = &self.model.projector else { return true };
        let back = pose.inverse();
        self.pattern.iter().all(|&q| {
            lit_point(projector, &self.model.projector_from_camera, pose, q).is_some_and(|p| {
                let p = back.transform(&p);
                (0.0..=self.size.width_mm).contains(&p.x) && (0.0..=self.size.height_mm).contains(&p.y)
            })
        })
    }

    fn faces(&self, pose: &Pose) -> bool {
        let normal = pose.rotation * nalgebra::Vector3::z();
        let middle = centre(pose, self.size);
        let projector = self.model.projector.map(|_| self.model.projector_from_camera.centre());
        [Some(Point3::origin()), projector].into_iter().flatten().all(|eye| {
            let ray = middle - eye;
            normal.dot(&ray) >= FLATTEST * ray.norm()
        })
    }

    /// The covariance of the shared unknowns after photographs in these poses.
    pub(crate) fn after(&self, poses: &[Pose]) -> Option<DMatrix<f64>> {
        let k = self.root.ncols();
        let n = k + POSE * poses.len();
        let views = poses.iter().map(|p| self.rows(p)).collect::<Option<Vec<_>>>()?;
        let count: usize = views.iter().map(|v| v.residuals.len()).sum();
        let mut a = DMatrix::zeros(count + k, n);
        let mut at = 0;
        for (i, v) in views.iter().enumerate() {
            let m = v.residuals.len();
            a.view_mut((at, 0), (m, k)).copy_from(&(&v.by_shared * &self.root));
            a.view_mut((at, k + POSE * i), (m, POSE)).copy_from(&v.by_view);
            at += m;
        }
        a.view_mut((at, 0), (k, k)).fill_with_identity();
        let c = covariance(&Structure::dense(n), &a, &vec![0.0; n])?;
        Some(&self.root * c.view((0, 0), (k, k)) * self.root.transpose())
    }

    /// What a covariance of the shared unknowns means, for a point at the middle of the sheet in `pose`.
    pub(crate) fn predicted(&self, covariance: &DMatrix<f64>, pose: &Pose) -> Predicted {
        let sigma = |i: usize| covariance[(i, i)].max(0.0).sqrt();
        let with = self.model.projector.is_some();
        Predicted {
            camera_focal: sigma(0),
            projector_focal: with.then(|| sigma(PROJECTOR)),
            projector_cy_px: with.then(|| sigma(PROJECTOR + 2)),
            point_mm: self.point_sigma(covariance, pose),
        }
    }

    /// The σ after photographs in these poses.
    pub(crate) fn predict(&self, poses: &[Pose]) -> Option<Predicted> {
        Some(self.predicted(&self.after(poses)?, poses.first()?))
    }

    fn point_sigma(&self, covariance: &DMatrix<f64>, pose: &Pose) -> Option<f64> {
        let model = Model { views: Vec::new(), ..self.model.clone() };
        let middle = centre(pose, self.size);
        let pixel = model.camera.project(&middle)?;
        let lit = model.projector.as_ref()?.project(&model.projector_from_camera.transform(&middle))?;
        let length = model.camera.bearing(pixel)?.norm();
        let depth = |m: &Model, shift: f64| {
            depth_on_column(m, Point2::new(pixel.x + shift, pixel.y), lit.x, lit.y).map(|s| s * length)
        };
        let slope = (depth(&model, 0.5)? - depth(&model, -0.5)?) * STRIPE_NOISE_PX;
        let layout = shared::layout(0);
        let mut gradient = DVector::zeros(SHARED);
        for i in 0..SHARED {
            let h = 1e-3 * covariance[(i, i)].max(0.0).sqrt();
            if h > 0.0 {
                let mut delta = DVector::zeros(SHARED);
                delta[i] = h;
                let (up, down) = (model.moved(&layout, &delta)?, model.moved(&layout, &-delta)?);
                gradient[i] = (depth(&up, 0.0)? - depth(&down, 0.0)?) / (2.0 * h);
            }
        }
        let variance = gradient.dot(&(covariance * &gradient)).max(0.0) + slope * slope;
        variance.is_finite().then(|| variance.sqrt())
    }

    /// Takes σ of edges and corners from what a rig's own views told it: the information on the first view's pose and on
    /// the transform between the devices that its covariance holds, against that of the same views at 1 px. Where the
    /// covariance does not give it, from the residuals.
    pub(crate) fn learn_noise(&mut self, rig: &Rig) {
        let rms = rig.views.first().and_then(|v| v.rms_px);
        let fallback =
            |rms: Option<f64>| rms.filter(|r| *r > 0.0 && r.is_finite()).unwrap_or(STRIPE_NOISE_PX);
        let from_rms = [
            fallback(rms.map(|r| r.edges)),
            fallback(rms.and_then(|r| r.corners)) / std::f64::consts::SQRT_2,
        ];
        [self.sheet_sigma_px, self.pattern_sigma_px] = self.noise_of(rig).unwrap_or(from_rms);
    }

    /// [`Outlook::learn_noise`] from the covariance alone.
    pub(crate) fn noise_of(&self, rig: &Rig) -> Option<[f64; 2]> {
        let information = Information::of(rig)?;
        let unit = Self { sheet_sigma_px: 1.0, pattern_sigma_px: 1.0, ..self.clone() };
        let first = unit.rows(rig.views.first().map(|v| &v.camera_from_sheet)?)?;
        let edges = if self.corners_only { 8 } else { 4 * POINTS_PER_SIDE };
        let of = |j: &DMatrix<f64>, from: usize, n: usize| j.rows(from, n).transpose() * j.rows(from, n);
        let sheet = of(&first.by_view, 0, edges);
        let of_pairs = of(&first.by_view, edges, first.residuals.len() - edges);
        let mean = |unit: &DMatrix<f64>, found: &DMatrix<f64>| -> Option<f64> {
            let share = unit.clone().lu().solve(found)?.trace() / POSE as f64;
            (share > 0.0 && share.is_finite()).then_some(share)
        };
        let mut weight = 0.0;
        if self.model.projector.is_some() {
            let mut stereo = DMatrix::zeros(POSE, POSE);
            for v in &rig.views {
                let j = unit.rows(&v.camera_from_sheet)?.by_shared.columns(STEREO, POSE).into_owned();
                stereo += j.transpose() * j;
            }
            weight = mean(&stereo, &information.block("projector_from_camera")?)?;
        }
        let on_sheet = mean(&sheet, &(information.block("views[0]")? - of_pairs * weight))?;
        Some([on_sheet, weight].map(|w| if w > 0.0 { w.sqrt().recip() } else { 1.0 }))
    }
}

/// The sheet's middle in the camera's frame.
pub(crate) fn centre(pose: &Pose, size: RectangleSize) -> Point3<f64> {
    pose.transform(&Point3::new(size.width_mm / 2.0, size.height_mm / 2.0, 0.0))
}

/// The inverse of a rig's covariance.
struct Information<'a> {
    names: &'a [String],
    matrix: DMatrix<f64>,
}

impl<'a> Information<'a> {
    fn of(rig: &'a Rig) -> Option<Self> {
        let known = rig.covariance.as_ref()?;
        let n = known.matrix.nrows();
        let sigma: Vec<f64> = known.matrix.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect();
        if !sigma.iter().all(|s| *s > 0.0 && s.is_finite()) {
            return None;
        }
        // On correlations: the units differ by orders of magnitude.
        let correlation = DMatrix::from_fn(n, n, |i, j| known.matrix[(i, j)] / (sigma[i] * sigma[j]));
        let inverse = correlation.cholesky()?.inverse();
        let matrix = DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] / (sigma[i] * sigma[j]));
        Some(Self { names: &known.parameters, matrix })
    }

    /// The block of a pose.
    fn block(&self, of: &str) -> Option<DMatrix<f64>> {
        let at = self.names.iter().position(|n| *n == format!("{of}.rx_rad"))?;
        (at + POSE <= self.matrix.nrows()).then(|| self.matrix.view((at, at), (POSE, POSE)).into_owned())
    }
}
