//! One view under a rig: the rig's unknowns bound by its covariance, those under suspicion free, the sheet's pose free.
//!
//! With y the rig's unknowns in units of their own σ (uncorrelated), m what is free besides and v the pose now, the
//! minimum of |r(y, m, v)|² + |y|² is −2 ln of the likelihood times the rig's own posterior, to second order. That order
//! does not suffice where a rig is uncertain by far more than its noise, as from one photograph: what it allows is a curve.
//! So the rig's own views, as they are expected, constrain y in the directions that they determine (`Past`), and |y|² the
//! others.

use nalgebra::{DMatrix, DVector};

use crate::estimate::covariance::UNINFORMATIVE;
use crate::estimate::expected_view::{ExpectedSheet, ExpectedView};
use crate::estimate::implied_noise::implied_noise;
use crate::estimate::measurement::measurements;
use crate::estimate::planar_pose::sheet_pose;
use crate::estimate::propagation::propagate;
use crate::estimate::residual::POSE;
use crate::estimate::robust::{self, RobustFit, RobustProblem};
use crate::estimate::unknowns::SHARED;
use crate::estimate::{BundleAdjustment, Measurement, Model, Unknowns, covariance};
use crate::observations::Observations;
use crate::parameter::Parameter;
use crate::pattern::{CheckerConfig, CheckerPattern};
use crate::rig::Rig;
use crate::solve::{self, Block, Linearised, Loss, Problem, Structure, minimise, polish};

/// Of a rig's views this many are counted by themselves; with more of them it is certain enough for its covariance to do.
const VIEWS: usize = 2;
/// A direction of y of whose information the rig's views hold this part or more is constrained by them: along a curve y
/// itself moves by many σ there.
const DETERMINED_BY_VIEWS: f64 = 0.5;
/// Step of differences, in σ of the unknown. One view of a plane leaves a direction of the projector undetermined, and larger
/// parts of its σ are not straight.
const STEP_SIGMAS: f64 = 1e-4;
/// Degrees of freedom that the fit takes from edge points (a pose) and from projected corners (a homography).
const SPENT: [usize; 2] = [6, 8];

/// The rig as it was calibrated.
#[derive(Clone)]
struct Past {
    /// With its views, as far as they are counted.
    model: Model,
    /// What these views show under the rig; `None` when y alone stands for them.
    views: Option<BundleAdjustment>,
    /// From their residuals to the y that they imply, in some directions; to first order it is y itself.
    determined: DMatrix<f64>,
    /// The other directions, a row each.
    prior: DMatrix<f64>,
}

impl Past {
    /// The rig's first views as they are expected, with the noise that its covariance implies, where they determine y, and
    /// |y|² elsewhere.
    fn new(rig: &Rig, model: Model, factor: &DMatrix<f64>) -> Self {
        let unknowns = factor.ncols();
        let views = expected_views(rig, &model);
        let linear = Self {
            model,
            views: None,
            determined: DMatrix::zeros(0, 0),
            prior: DMatrix::identity(unknowns, unknowns),
        };
        let with_views = Self { views, ..linear.clone() };
        let Some((a, _)) = with_views.rows(&with_views.model, factor) else { return linear };
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

    /// Residuals of y and their derivatives: what the views imply and what they do not, each with unit σ.
    fn linearised(
        &self,
        model: &Model,
        factor: &DMatrix<f64>,
        y: &DVector<f64>,
    ) -> Option<(DMatrix<f64>, DVector<f64>)> {
        if self.determined.nrows() == 0 {
            return Some((self.prior.clone(), &self.prior * y));
        }
        let (by_y, residuals) = self.rows(model, factor)?;
        let n = self.determined.nrows() + self.prior.nrows();
        let (mut a, mut r) = (DMatrix::zeros(n, factor.ncols()), DVector::zeros(n));
        a.rows_mut(0, self.determined.nrows()).copy_from(&(&self.determined * by_y));
        r.rows_mut(0, self.determined.nrows()).copy_from(&(&self.determined * residuals));
        a.rows_mut(self.determined.nrows(), self.prior.nrows()).copy_from(&self.prior);
        r.rows_mut(self.determined.nrows(), self.prior.nrows()).copy_from(&(&self.prior * y));
        Some((a, r))
    }

    /// Derivatives by y and residuals of all views.
    fn rows(&self, model: &Model, factor: &DMatrix<f64>) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let problem = self.views.as_ref()?;
        let Linearised { residuals, jacobian } = problem.at(model)?;
        let mut a = jacobian.columns(POSE, SHARED) * factor.rows(0, SHARED);
        let mut at = 0;
        for (i, rows) in problem.structure().groups.iter().enumerate() {
            let by_view = jacobian.view((at, 0), (*rows, POSE)) * factor.rows(SHARED + POSE * i, POSE);
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
    let board = CheckerPattern::new([projector.width, projector.height], &CheckerConfig::default()).ok()?;
    let pattern = board.inner_corners().into_iter().map(|q| (q, 1.0)).collect();
    let mut view = ExpectedView { size, sheet: ExpectedSheet::Sides([1.0; 4]), pattern };
    view.shrink_pattern(|view| whole.views.iter().all(|pose| view.holds_pattern(&whole, pose)));
    let noise = implied_noise(rig, &whole, &view)?;
    Some(view.with_noise(noise).problem(model, &model.views, &Unknowns::all(0), &[])?.0)
}

/// A point of the search: the rig as it was and as it is, and the unknowns that lead there.
#[derive(Clone)]
pub(super) struct State {
    past: Model,
    now: Model,
    y: DVector<f64>,
    freed: DVector<f64>,
}

/// The problem, with unknowns in the order y, what is free, pose now.
#[derive(Clone)]
pub(super) struct Posterior {
    /// The photograph.
    photograph: BundleAdjustment,
    past: Past,
    /// F with F·Fᵀ the covariance of the shared unknowns and of the views of `past`.
    pub(super) factor: DMatrix<f64>,
    /// The rig, its view 0 where the sheet is seen now.
    start: Model,
    /// Natural units of the shared unknowns.
    pub(super) units: Vec<f64>,
    /// Which of the shared unknowns are free besides.
    free: Vec<usize>,
    blocks: Vec<Block>,
}

/// Where a fit ended.
pub(super) struct PosteriorFit {
    /// Its view 0 is the pose now.
    pub(super) model: Model,
    /// The rig as it was: without what was set free, with its own views.
    pub(super) past: Model,
    /// Which of the shared unknowns were free besides, and by how much they changed, in natural units.
    pub(super) free: Vec<usize>,
    pub(super) freed: DVector<f64>,
    pub(super) chi_squared: f64,
    /// Residual norms, px.
    pub(super) norms_px: Vec<f64>,
    /// Of y, what is free and the pose.
    pub(super) covariance: DMatrix<f64>,
}

impl Posterior {
    /// `seen` holds the photograph alone.
    pub(super) fn new(rig: &Rig, seen: &Observations) -> Option<Self> {
        let view = seen.views.first()?;
        let whole = Model::of_rig(rig);
        let start = whole.with_views(&[sheet_pose(view, &rig.camera.model)?]);
        let counted = rig.views.len().min(VIEWS);
        let unknowns = Unknowns::all(counted);
        let known = covariance::of_rig(rig, &unknowns)
            .unwrap_or_else(|| DMatrix::zeros(unknowns.len(), unknowns.len()));
        let factor = covariance::factor(&known);
        let past = Past::new(rig, whole.with_views(&whole.views[..counted]), &factor);
        let units = start.units(&Unknowns::all(0));
        let photograph =
            BundleAdjustment::new(vec![view.size], measurements(seen), Unknowns::all(1), Vec::new());
        Some(Self { photograph, past, factor, start, units, free: Vec::new(), blocks: Vec::new() })
    }

    pub(super) fn measurements(&self) -> &[Measurement] {
        &self.photograph.measurements
    }

    /// Number of the rig's unknowns, y.
    pub(super) fn bound(&self) -> usize {
        self.factor.ncols()
    }

    fn with_free(&self, free: &[Parameter]) -> Self {
        let all = Unknowns::all(0);
        let free: Vec<usize> = free.iter().filter_map(|p| all.position(p)).collect();
        let mut blocks = self.photograph.blocks.clone();
        let others = self.past.determined.nrows() + self.past.prior.nrows() + free.len();
        blocks.extend(vec![Block { len: 1, loss: Loss::Square }; others]);
        Self { free, blocks, ..self.clone() }
    }

    fn state(&self) -> State {
        State {
            past: self.past.model.clone(),
            now: self.start.clone(),
            y: DVector::zeros(self.bound()),
            freed: DVector::zeros(self.free.len()),
        }
    }

    /// The robust fit with these parameters free: it tells outliers, and how widely the others scatter.
    pub(super) fn fit_robustly(&self, free: &[Parameter]) -> Option<RobustFit<State>> {
        let mut problem = self.with_free(free);
        let start = problem.state();
        robust::fit(&mut problem, start, SPENT)
    }

    /// The same with the outliers left out and the σ of the others widened: χ² of different fits compare then.
    pub(super) fn with_inliers(&self, found: &RobustFit<State>) -> Self {
        let mut same = self.clone();
        let measured = self.measurements().iter().zip(&found.inliers).filter(|(_, keep)| **keep);
        let widened = measured.map(|(m, _)| {
            let factor = found.widened.get(m.kind() as usize).unwrap_or(&1.0);
            Measurement { sigma_px: m.sigma_px * factor, ..*m }
        });
        same.photograph = BundleAdjustment::new(
            self.photograph.sizes.clone(),
            widened.collect(),
            Unknowns::all(1),
            Vec::new(),
        );
        same
    }

    /// The minimum with these parameters free.
    pub(super) fn fit(&self, free: &[Parameter]) -> Option<PosteriorFit> {
        let problem = self.with_free(free);
        let minimum = polish(&problem, minimise(&problem, problem.state())?);
        let State { mut past, now: mut model, freed, .. } = minimum.state;
        past.renormalise();
        model.renormalise();
        let jacobian = &minimum.at.jacobian;
        let covariance = solve::covariance(&problem.structure(), jacobian, &[])?;
        let norms_px = self.photograph.norms_px(&model)?;
        let chi_squared = minimum.cost;
        Some(PosteriorFit { model, past, free: problem.free, freed, chi_squared, norms_px, covariance })
    }

    /// 1σ of functions of a fitted model.
    pub(super) fn propagate<const N: usize>(
        &self,
        fit: &PosteriorFit,
        of: impl Fn(&Model) -> Option<[f64; N]>,
    ) -> Option<[f64; N]> {
        propagate(&fit.covariance, STEP_SIGMAS, |step| of(&self.moved(&fit.model, &fit.free, step)?))
    }

    /// The model after a step in [y, what is free, pose].
    fn moved(&self, model: &Model, free: &[usize], step: &DVector<f64>) -> Option<Model> {
        let (k, f) = (self.bound(), free.len());
        let mut delta = DVector::zeros(SHARED + POSE);
        delta.rows_mut(0, SHARED).copy_from(&(self.factor.rows(0, SHARED) * step.rows(0, k)));
        for (c, &i) in free.iter().enumerate() {
            delta[i] += step[k + c] * self.units[i];
        }
        delta.rows_mut(SHARED, POSE).copy_from(&step.rows(k + f, POSE));
        model.moved(&Unknowns::all(1), &delta)
    }
}

impl Problem for Posterior {
    type State = State;

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn structure(&self) -> Structure<'_> {
        Structure::dense(self.bound() + self.free.len() + POSE)
    }

    fn linearise(&self, state: &State, to: &mut Linearised) -> Option<()> {
        let Linearised { residuals, jacobian } = self.photograph.at(&state.now)?;
        let (by_past, past) = self.past.linearised(&state.past, &self.factor, &state.y)?;
        let (n, p) = (residuals.len(), past.len());
        let (k, f) = (self.bound(), self.free.len());
        let by_shared = jacobian.columns(POSE, SHARED);
        to.jacobian.fill(0.0);
        to.jacobian.view_mut((0, 0), (n, k)).copy_from(&(by_shared * self.factor.rows(0, SHARED)));
        for (c, &i) in self.free.iter().enumerate() {
            to.jacobian.view_mut((0, k + c), (n, 1)).copy_from(&(by_shared.column(i) * self.units[i]));
            to.jacobian[(n + p + c, k + c)] = 1.0 / UNINFORMATIVE;
        }
        to.jacobian.view_mut((0, k + f), (n, POSE)).copy_from(&jacobian.columns(0, POSE));
        to.jacobian.view_mut((n, 0), (p, k)).copy_from(&by_past);
        to.residuals.rows_mut(0, n).copy_from(&residuals);
        to.residuals.rows_mut(n, p).copy_from(&past);
        to.residuals.rows_mut(n + p, f).copy_from(&(&state.freed / UNINFORMATIVE));
        Some(())
    }

    fn step(&self, state: &State, step: &DVector<f64>) -> Option<State> {
        let by_y = step.rows(0, self.bound());
        Some(State {
            past: state.past.moved(&Unknowns::all(state.past.views.len()), &(&self.factor * by_y))?,
            now: self.moved(&state.now, &self.free, step)?,
            y: &state.y + by_y,
            freed: &state.freed + step.rows(self.bound(), self.free.len()),
        })
    }
}

impl RobustProblem for Posterior {
    fn measured(&mut self) -> (&[Measurement], &mut [Block]) {
        (&self.photograph.measurements, &mut self.blocks)
    }

    fn norms_px(&self, state: &State) -> Option<Vec<f64>> {
        self.photograph.norms_px(&state.now)
    }

    fn renormalise(state: &mut State) {
        state.now.renormalise();
        state.past.renormalise();
    }
}
