//! What would be known after another photograph: the calibration's own Jacobian at measurements that were not made.

use nalgebra::{DMatrix, Point2, Point3, Vector3};

use crate::error::{Error, ErrorSubject, Result};
use crate::estimate::expected_view::{ExpectedSheet, ExpectedView};
use crate::estimate::implied_noise::implied_noise;
use crate::estimate::propagation::{STRIPE_NOISE_PX, depth_sigma};
use crate::estimate::residual::BEND;
use crate::estimate::unknowns::SHARED;
use crate::estimate::{Lens, Model, Priors, Sheet, Unknowns, covariance};
use crate::geometry::{Camera, Pose, RectangleSize};
use crate::parameter::LensParameter;
use crate::pattern::{CheckerConfig, CheckerPattern};
use crate::rig::Rig;
use crate::solve::{self, Problem, Structure};

/// The sheet lies in the frame with this part of the frame's width to spare.
const FRAME_MARGIN: f64 = 0.01;
/// Neither device sees the sheet flatter than this, cosine (65° from face-on): squares would shrink to slivers.
const FLATTEST: f64 = 0.42;

/// Expected 1σ after a photograph.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
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

/// What is known of the devices, and what a photograph would show.
#[derive(Debug, Clone)]
pub(super) struct Knowledge {
    /// Its views are the poses that were photographed already.
    pub(super) model: Model,
    /// F with F·Fᵀ the covariance of the shared unknowns.
    pub(super) factor: DMatrix<f64>,
    pub(super) view: ExpectedView,
    /// 1σ of the coefficients of a sheet's bend, mm; `None` for flat sheets.
    bend: Option<[f64; BEND]>,
    /// σ of the sheet's measurement and of a projected corner, px.
    pub(super) noise_px: [f64; 2],
}

impl Knowledge {
    /// `pattern` is given, or the default board that shrinks until it `fits`.
    pub(super) fn new(
        model: Model,
        factor: DMatrix<f64>,
        (size, sheet): (RectangleSize, ExpectedSheet),
        bend: Option<[f64; BEND]>,
        pattern: Option<&CheckerPattern>,
        noise_px: [f64; 2],
        fits: impl Fn(&ExpectedView, &Model) -> bool,
    ) -> Result<Self> {
        let mut view = ExpectedView { size, sheet, pattern: pattern_of(&model, pattern)? };
        if pattern.is_none() {
            view.shrink_pattern(|view| fits(view, &model));
        }
        Ok(Self { model, factor, view: view.with_noise(noise_px), bend, noise_px })
    }

    /// From a rig's covariance and its first view's sheet, with the noise that its views had: as the covariance implies, or
    /// else the rms of its residuals.
    pub(super) fn of_rig(rig: &Rig, pattern: Option<&CheckerPattern>) -> Result<Self> {
        let first = rig.views.first().ok_or_else(|| {
            let expected = "one with the views that it was calibrated from";
            Error::invalid(ErrorSubject::Rig, expected, "none of them")
        })?;
        let known = covariance::of_rig(rig, &Unknowns::all(0, false)).ok_or_else(|| {
            let advice =
                "one with a covariance, as calibrate writes it (for a camera from elsewhere give the camera itself)";
            Error::invalid(ErrorSubject::Rig, advice, "none")
        })?;
        let sheet = (first.size, ExpectedSheet::Sides([1.0; 4]));
        // A default board that is not the one that was projected is made to fit the sheets that held it.
        let on_all = |view: &ExpectedView, model: &Model| {
            model.views.iter().all(|sheet| view.holds_pattern(model, sheet))
        };
        let factor = covariance::factor(&known);
        let bend = first.bend.map(|b| b.expected_mm);
        let mut knowledge = Self::new(Model::of_rig(rig), factor, sheet, bend, pattern, [1.0; 2], on_all)?;
        let rms = |rms: Option<f64>| rms.filter(|r| *r > 0.0 && r.is_finite()).unwrap_or(STRIPE_NOISE_PX);
        let from_rms = || {
            let of_view = first.rms_px;
            [rms(of_view.map(|r| r.edges)), rms(of_view.and_then(|r| r.corners)) / std::f64::consts::SQRT_2]
        };
        knowledge.noise_px = implied_noise(rig, &knowledge.model, &knowledge.view).unwrap_or_else(from_rms);
        knowledge.view = knowledge.view.with_noise(knowledge.noise_px);
        Ok(knowledge)
    }

    fn sheet(&self, pose: &Pose) -> Sheet {
        Sheet::flat(*pose, self.view.size)
    }

    /// Whether the sheet in this pose is in the frame, the pattern on the sheet, and both seen under a fair angle.
    pub(super) fn feasible(&self, pose: &Pose) -> bool {
        self.in_frame(pose) && self.view.holds_pattern(&self.model, &self.sheet(pose)) && self.faces(pose)
    }

    fn in_frame(&self, pose: &Pose) -> bool {
        let camera = &self.model.camera;
        let (w, h) = (f64::from(camera.width), f64::from(camera.height));
        let margin = FRAME_MARGIN * w;
        self.view.size.corners().into_iter().all(|c| {
            camera.project(&pose.lift(c)).is_some_and(|p| {
                (margin..=w - 1.0 - margin).contains(&p.x) && (margin..=h - 1.0 - margin).contains(&p.y)
            })
        })
    }

    fn faces(&self, pose: &Pose) -> bool {
        let normal = pose.rotation * Vector3::z();
        let middle = pose.lift(self.view.size.centre());
        let projector = self.model.projector.map(|_| self.model.projector_from_camera.centre());
        [Some(Point3::origin()), projector].into_iter().flatten().all(|eye| {
            let ray = middle - eye;
            normal.dot(&ray) >= FLATTEST * ray.norm()
        })
    }

    /// The covariance of the shared unknowns after photographs in these poses.
    fn after(&self, poses: &[Pose]) -> Option<DMatrix<f64>> {
        let sheets: Vec<Sheet> = poses.iter().map(|pose| self.sheet(pose)).collect();
        let unknowns = Unknowns::all(0, self.bend.is_some());
        let bends = self.bend.map_or_else(Vec::new, |bend| vec![bend; poses.len()]);
        let priors = Priors { bends, ..Priors::default() };
        let (problem, model) = self.view.problem(&self.model, &sheets, &unknowns, &priors)?;
        let jacobian = problem.at(&model)?.jacobian;
        // By the shared unknowns in units of their own σ, uncorrelated.
        let k = self.factor.ncols();
        let width = unknowns.width();
        let mut j = DMatrix::zeros(jacobian.nrows(), width + k);
        j.columns_mut(0, width).copy_from(&jacobian.columns(0, width));
        j.columns_mut(width, k).copy_from(&(jacobian.columns(width, SHARED) * &self.factor));
        let structure = Structure { shared: k, ..problem.structure() };
        let c = solve::covariance(&structure, &j, &vec![1.0; k])?;
        Some(&self.factor * c.view((0, 0), (k, k)) * self.factor.transpose())
    }

    /// What a covariance of the shared unknowns means, for a point at the middle of the sheet in `pose`.
    fn predicted(&self, covariance: &DMatrix<f64>, pose: &Pose) -> Predicted {
        let unknowns = Unknowns::all(0, false);
        let sigma = |lens, parameter| {
            self.model.lens(lens)?;
            unknowns.lens(lens, parameter).map(|i| covariance[(i, i)].max(0.0).sqrt())
        };
        Predicted {
            camera_focal: sigma(Lens::Camera, LensParameter::Focal).unwrap_or(0.0),
            projector_focal: sigma(Lens::Projector, LensParameter::Focal),
            projector_cy_px: sigma(Lens::Projector, LensParameter::Cy),
            point_mm: depth_sigma(&self.model, &unknowns, covariance, &self.sheet(pose)).map(|s| s.total()),
        }
    }

    /// The σ before another photograph.
    pub(super) fn now(&self, pose: &Pose) -> Predicted {
        self.predicted(&(&self.factor * self.factor.transpose()), pose)
    }

    /// The σ after photographs in these poses.
    pub(super) fn predict(&self, poses: &[Pose]) -> Option<Predicted> {
        Some(self.predicted(&self.after(poses)?, poses.first()?))
    }
}

/// The inner corners of a checkerboard for a model's projector; those of the default one where none is given.
fn pattern_of(model: &Model, pattern: Option<&CheckerPattern>) -> Result<Vec<(Point2<f64>, f64)>> {
    let Some(Camera { width, height, .. }) = model.projector else { return Ok(Vec::new()) };
    let corners = match pattern {
        Some(p) if p.projector != [width, height] => {
            let [w, h] = p.projector;
            let expected = format!("one for the panel of {width}x{height} px");
            return Err(Error::invalid(ErrorSubject::Pattern, expected, format!("one for {w}x{h} px")));
        }
        Some(p) => p.inner_corners(),
        None => CheckerPattern::new([width, height], &CheckerConfig::default())?.inner_corners(),
    };
    Ok(corners.into_iter().map(|q| (q, 1.0)).collect())
}
