//! What a rig's own views constrain, where its covariance alone does not suffice (see `posterior_fit`).

use nalgebra::{DMatrix, DVector};

use crate::estimate::expected_view::{ExpectedSheet, ExpectedView};
use crate::estimate::implied_noise::implied_noise;
use crate::estimate::unknowns::SHARED;
use crate::estimate::{BundleAdjustment, Model, Priors, Unknowns};
use crate::pattern::{CheckerConfig, CheckerPattern};
use crate::rig::Rig;
use crate::solve::{Linearised, Problem};

/// A direction of y of whose information the rig's views hold this part or more is constrained by them: along a curve y
/// itself moves by many σ there.
const DETERMINED_BY_VIEWS: f64 = 0.1;

/// The rig as it was calibrated, and what its first views constrain.
#[derive(Clone)]
pub(super) struct RigViews {
    /// With its views, as far as they are counted.
    pub(super) model: Model,
    /// What these views show under the rig; `None` when y alone stands for them.
    views: Option<BundleAdjustment>,
    /// From their residuals to the y that they imply, in some directions; to first order it is y itself.
    determined: DMatrix<f64>,
    /// The other directions, a row each.
    prior: DMatrix<f64>,
}

impl RigViews {
    /// The rig's first views as they are expected, with the noise that its covariance implies, where they determine y, and
    /// |y|² elsewhere.
    pub(super) fn new(rig: &Rig, model: Model, factor: &DMatrix<f64>) -> Self {
        let unknowns = factor.ncols();
        let views = expected_views(rig, &model);
        let linear = Self {
            model,
            views: None,
            determined: DMatrix::zeros(0, 0),
            prior: DMatrix::identity(unknowns, unknowns),
        };
        let with_views = Self { views, ..linear.clone() };
        let Some((a, _)) = with_views.of_views(&with_views.model, factor) else { return linear };
        // Of information 1 in every direction of y, the views hold the eigenvalue.
        let eigen = (a.transpose() * &a).symmetric_eigen();
        let directions = |determined: bool| {
            let those = |i: &usize| (eigen.eigenvalues[*i] >= DETERMINED_BY_VIEWS) == determined;
            let chosen: Vec<usize> = (0..unknowns).filter(those).collect();
            DMatrix::from_fn(chosen.len(), unknowns, |r, c| {
                let weight = if determined { 1.0 / eigen.eigenvalues[chosen[r]] } else { 1.0 };
                eigen.eigenvectors[(c, chosen[r])] * weight
            })
        };
        Self { determined: directions(true) * a.transpose(), prior: directions(false), ..with_views }
    }

    /// Number of residuals.
    pub(super) fn rows(&self) -> usize {
        self.determined.nrows() + self.prior.nrows()
    }

    /// Residuals of y and their derivatives: what the views imply and what they do not, each with unit σ.
    pub(super) fn linearised(
        &self,
        model: &Model,
        factor: &DMatrix<f64>,
        y: &DVector<f64>,
    ) -> Option<(DMatrix<f64>, DVector<f64>)> {
        if self.determined.nrows() == 0 {
            return Some((self.prior.clone(), &self.prior * y));
        }
        let (by_y, residuals) = self.of_views(model, factor)?;
        let n = self.rows();
        let (mut a, mut r) = (DMatrix::zeros(n, factor.ncols()), DVector::zeros(n));
        a.rows_mut(0, self.determined.nrows()).copy_from(&(&self.determined * by_y));
        r.rows_mut(0, self.determined.nrows()).copy_from(&(&self.determined * residuals));
        a.rows_mut(self.determined.nrows(), self.prior.nrows()).copy_from(&self.prior);
        r.rows_mut(self.determined.nrows(), self.prior.nrows()).copy_from(&(&self.prior * y));
        Some((a, r))
    }

    /// Derivatives by y and residuals of all views.
    fn of_views(&self, model: &Model, factor: &DMatrix<f64>) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let problem = self.views.as_ref()?;
        let Linearised { residuals, jacobian } = problem.at(model)?;
        let width = problem.unknowns.width();
        let mut a = jacobian.columns(width, SHARED) * factor.rows(0, SHARED);
        let mut at = 0;
        for (i, rows) in problem.structure().groups.iter().enumerate() {
            let by_view = jacobian.view((at, 0), (*rows, width)) * factor.rows(SHARED + width * i, width);
            let mut own = a.rows_mut(at, *rows);
            own += by_view;
            at += rows;
        }
        a.iter().chain(residuals.iter()).all(|x| x.is_finite()).then_some((a, residuals))
    }
}

/// What the views of a model show; `None` where the rig's covariance does not give their noise, or their sheets differ.
fn expected_views(rig: &Rig, model: &Model) -> Option<BundleAdjustment> {
    let size = rig.views.first()?.size;
    if rig.views[..model.views.len()].iter().any(|v| v.size != size) {
        return None;
    }
    let whole = Model::of_rig(rig);
    let projector = model.projector?;
    let board = CheckerPattern::new(projector.size(), &CheckerConfig::default()).ok()?;
    let pattern = board.inner_corners().into_iter().map(|q| (q, 1.0)).collect();
    let mut view = ExpectedView { size, sheet: ExpectedSheet::Sides([1.0; 4]), pattern };
    view.shrink_pattern(|view| whole.views.iter().all(|sheet| view.holds_pattern(&whole, sheet)));
    let noise = implied_noise(rig, &whole, &view)?;
    let unknowns = Unknowns::all(0, rig.views.first()?.bend.is_some());
    Some(view.with_noise(noise).problem(model, &model.views, &unknowns, &Priors::default())?.0)
}
