//! A solved problem, and how well focal lengths would be known from other views.

use nalgebra::DMatrix;

use super::assumptions::Lens;
use super::covariance::posterior;
use super::expected_view::{ExpectedSheet, ExpectedView, POINTS_PER_SIDE};
use super::hyperparameters;
use super::measurement::{Kind, Measurement, Target};
use super::model::Model;
use super::prior::{LensPrior, Priors};
use super::problem::BundleAdjustment;
use super::propagation::{DepthSigma, depth_sigma};
use super::robust::{self, RobustFit};
use super::sheet::Sheet;
use super::unknowns::Unknowns;
use crate::geometry::Pose;
use crate::parameter::LensParameter;

/// Rounds of fitting and learning the weights, and the change of any of them (of its logarithm) that ends them.
const LEARNING_ROUNDS: usize = 3;
const LEARNED: f64 = 0.04;

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
    /// By what the stated σ of edge points were multiplied because of their noise and its correlation.
    pub(crate) edge_inflation: f64,
    /// By how much the priors on bends of order 2, and of orders 3 and 4, were widened.
    pub(crate) bend_widths: [f64; 2],
}

impl Solution {
    /// Maximum likelihood from a start that is near, robustly; `None` where the numbers break down.
    pub(crate) fn refine(mut problem: BundleAdjustment, start: Model) -> Option<Self> {
        let fit = robust::fit(&mut problem, start, [0; 2])?;
        let covariance = posterior(&problem, &fit.state, &fit.inliers, fit.widened)?;
        Some(Self { problem, fit, covariance, edge_inflation: 1.0, bend_widths: [1.0; 2] })
    }

    /// The solution with the weights that it asks for itself: the noise of edge points with its correlation, and how far
    /// sheets bend. σ that were stated are never taken for too large.
    pub(crate) fn with_learned_weights(self) -> Self {
        let stated = self.problem.clone();
        let mut best = self;
        for _ in 0..LEARNING_ROUNDS {
            let Solution { problem, fit, edge_inflation, bend_widths, .. } = &best;
            let more = hyperparameters::edge_inflation(problem, &fit.state, &fit.inliers).unwrap_or(1.0);
            let inflation = (more * edge_inflation).max(1.0);
            let mut expected = problem.clone();
            expected.priors.bends.clone_from(&stated.priors.bends);
            let widths =
                hyperparameters::bend_widths(&expected, &fit.state, &fit.inliers).unwrap_or(*bend_widths);
            let lenses: Vec<LensPrior> =
                problem.priors.lenses.iter().map(|p| p.reconciled(&fit.state)).collect();
            let learned =
                [inflation / edge_inflation, widths[0] / bend_widths[0], widths[1] / bend_widths[1]];
            let widened = lenses.iter().zip(&problem.priors.lenses).map(|(new, old)| new.sigma / old.sigma);
            if learned.into_iter().chain(widened).all(|c| c.ln().abs() < LEARNED) {
                break;
            }
            let with_lenses = |mut p: BundleAdjustment| {
                p.priors.lenses = lenses;
                p
            };
            let Some(next) = stated
                .weighted(inflation, widths)
                .map(with_lenses)
                .and_then(|p| Self::refine(p, fit.state.clone()))
            else {
                break;
            };
            let iterations = fit.iterations + next.fit.iterations;
            best = Self { edge_inflation: inflation, bend_widths: widths, ..next };
            best.fit.iterations = iterations;
        }
        best
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

    /// σ of the depth of a point at the middle of each view's sheet.
    pub(crate) fn depth_sigmas(&self) -> impl Iterator<Item = DepthSigma> {
        let (model, unknowns) = (self.model(), &self.problem.unknowns);
        model.views.iter().filter_map(|sheet| depth_sigma(model, unknowns, &self.covariance, sheet))
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

    /// By how much the σ that were stated of a kind are to be multiplied for what the model leaves, with the correlation of edge
    /// points.
    pub(crate) fn noise_left(&self, kind: Kind) -> f64 {
        let learned = if kind == Kind::Edge { self.edge_inflation } else { 1.0 };
        self.fit.widened[kind as usize] * learned
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
        ExpectedView { size: self.model().views[view].size, sheet, pattern }
    }

    /// Expected σ when the first view's sheet is seen in each of `poses` instead.
    pub(crate) fn predict(&self, poses: &[Pose]) -> Option<FocalSigma> {
        let BundleAdjustment { unknowns, priors, .. } = &self.problem;
        let size = self.model().views.first()?.size;
        let sheets: Vec<Sheet> = poses.iter().map(|pose| Sheet::flat(*pose, size)).collect();
        let bends = priors.bends.first().map_or_else(Vec::new, |first| vec![*first; poses.len()]);
        let priors = Priors { lenses: priors.lenses.clone(), bends };
        let (problem, model) = self.expected_view(0).problem(self.model(), &sheets, unknowns, &priors)?;
        let covariance = posterior(&problem, &model, &vec![true; problem.measurements.len()], [1.0; 2])?;
        Some(FocalSigma::of(&covariance, unknowns))
    }

    /// σ of the focal lengths if the principal points were known exactly.
    pub(crate) fn with_exact_principal_points(&self) -> Option<FocalSigma> {
        let mut tight = self.problem.clone();
        for p in &mut tight.priors.lenses {
            // A prior of (almost) no width takes the unknown out without renumbering.
            if matches!(p.parameter, LensParameter::Cx | LensParameter::Cy) {
                p.sigma *= 1e-4;
            }
        }
        let covariance = posterior(&tight, self.model(), &self.fit.inliers, self.fit.widened)?;
        Some(FocalSigma::of(&covariance, &tight.unknowns))
    }
}
