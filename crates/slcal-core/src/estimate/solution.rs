//! A solved problem, and how well focal lengths would be known from other views.

use nalgebra::DMatrix;

use super::assumptions::Lens;
use super::covariance::posterior;
use super::expected_view::{ExpectedSheet, ExpectedView, POINTS_PER_SIDE};
use super::measurement::{Kind, Measurement, Target};
use super::model::Model;
use super::problem::BundleAdjustment;
use super::robust::{self, RobustFit};
use super::unknowns::Unknowns;
use crate::geometry::Pose;
use crate::parameter::LensParameter;

/// Relative σ of the focal lengths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FocalSigma {
    pub(crate) camera: f64,
    pub(crate) projector: Option<f64>,
}

impl FocalSigma {
    fn of(covariance: &DMatrix<f64>, unknowns: &Unknowns) -> Self {
        let sigma = |lens| {
            unknowns.lens(lens, LensParameter::Focal).map_or(0.0, |i| covariance[(i, i)].max(0.0).sqrt())
        };
        Self {
            camera: sigma(Lens::Camera),
            projector: unknowns.projector_from_camera().map(|_| sigma(Lens::Projector)),
        }
    }

    /// The larger one decides.
    pub(crate) fn worst(&self) -> f64 {
        self.camera.max(self.projector.unwrap_or(0.0))
    }
}

/// An estimate and the problem that it solves.
#[derive(Debug, Clone)]
pub(crate) struct Solution {
    pub(crate) problem: BundleAdjustment,
    pub(crate) fit: RobustFit<Model>,
    /// Of the problem's unknowns, focal lengths as ln f.
    pub(crate) covariance: DMatrix<f64>,
}

impl Solution {
    /// Maximum likelihood from a start that is near, robustly; `None` where the numbers break down.
    pub(crate) fn refine(mut problem: BundleAdjustment, start: Model) -> Option<Self> {
        let fit = robust::fit(&mut problem, start, [0; 2])?;
        let covariance = posterior(&problem, &fit.state, &fit.inliers, fit.widened)?;
        Some(Self { problem, fit, covariance })
    }

    pub(crate) fn model(&self) -> &Model {
        &self.fit.state
    }

    /// 1σ of a parameter, the focal length's relative; `None` where it is held fixed.
    pub(crate) fn sigma(&self, lens: Lens, parameter: LensParameter) -> Option<f64> {
        self.problem.unknowns.lens(lens, parameter).map(|i| self.covariance[(i, i)].sqrt())
    }

    pub(crate) fn focal_sigma(&self) -> FocalSigma {
        FocalSigma::of(&self.covariance, &self.problem.unknowns)
    }

    /// Every measurement with the norm of its residual (px), and whether it was kept.
    pub(crate) fn measured(&self) -> impl Iterator<Item = (&Measurement, f64, bool)> {
        let norms = self.problem.measurements.iter().zip(&self.fit.norms_px);
        norms.zip(&self.fit.inliers).map(|((m, norm), keep)| (m, *norm, *keep))
    }

    /// Measurements that were left out, and all, of a kind.
    pub(crate) fn outliers(&self, kind: Kind) -> [usize; 2] {
        let of_kind = self.measured().filter(|(m, ..)| m.kind() == kind);
        of_kind.fold([0, 0], |[out, all], (.., keep)| [out + usize::from(!keep), all + 1])
    }

    /// What another photograph like this view is expected to give, with the σ of what was kept of it.
    fn expected_view(&self, view: usize) -> ExpectedView {
        let widened = self.fit.widened;
        let mut information = [0.0; 4];
        let mut corner = None;
        let mut pattern = Vec::new();
        for (m, ..) in self.measured().filter(|(m, _, keep)| m.view == view && *keep) {
            match m.of {
                Target::Edge(side) => information[side as usize] += (m.sigma_px * widened[0]).powi(-2),
                Target::SheetCorner(_) => corner = Some(m.sigma_px),
                Target::Pair(q) => pattern.push((q, m.sigma_px * widened[1])),
            }
        }
        let per_point = |i: f64| (POINTS_PER_SIDE as f64 / i.max(f64::MIN_POSITIVE)).sqrt();
        let sheet = corner.map_or(ExpectedSheet::Sides(information.map(per_point)), ExpectedSheet::Corners);
        ExpectedView { size: self.problem.sizes[view], sheet, pattern }
    }

    /// Expected σ when the first view's sheet is seen in each of `poses` instead.
    pub(crate) fn predict(&self, poses: &[Pose]) -> Option<FocalSigma> {
        let BundleAdjustment { unknowns, priors, .. } = &self.problem;
        let (problem, model) = self.expected_view(0).problem(self.model(), poses, unknowns, priors)?;
        let covariance = posterior(&problem, &model, &vec![true; problem.measurements.len()], [1.0; 2])?;
        Some(FocalSigma::of(&covariance, unknowns))
    }

    /// σ of the focal lengths if the principal points were known exactly.
    pub(crate) fn with_exact_principal_points(&self) -> Option<FocalSigma> {
        let mut tight = self.problem.clone();
        for p in &mut tight.priors {
            // A prior of (almost) no width takes the unknown out without renumbering.
            if matches!(p.parameter, LensParameter::Cx | LensParameter::Cy) {
                p.sigma *= 1e-4;
            }
        }
        let covariance = posterior(&tight, self.model(), &self.fit.inliers, self.fit.widened)?;
        Some(FocalSigma::of(&covariance, &tight.unknowns))
    }
}
