//! One view under a rig: the rig's unknowns bound by its covariance, those under suspicion free, the sheet's pose free.
//!
//! With y the rig's unknowns in units of their own σ (uncorrelated), m what is free besides and v the pose now, the
//! minimum of |r(y, m, v)|² + |y|² is −2 ln of the likelihood times the rig's own posterior, to second order. That order
//! does not suffice where a rig is uncertain by far more than its noise, as from one photograph: what it allows is a curve.
//! So the rig's own views, as they are expected, constrain y in the directions that they determine (`rig_views`), and |y|² the
//! others.

use nalgebra::{DMatrix, DVector};

use super::rig_views::RigViews;
use crate::estimate::covariance::UNINFORMATIVE;
use crate::estimate::measurement::measurements;
use crate::estimate::planar_pose::sheet_pose;
use crate::estimate::propagation::propagate;
use crate::estimate::robust::{self, RobustFit, RobustProblem};
use crate::estimate::unknowns::SHARED;
use crate::estimate::{BundleAdjustment, Measurement, Model, Priors, Sheet, Unknowns, covariance};
use crate::observations::Observations;
use crate::parameter::Parameter;
use crate::rig::Rig;
use crate::solve::{self, Block, Linearised, Loss, Problem, Structure, minimise, polish};

/// Of a rig's views this many are counted by themselves; with more of them it is certain enough for its covariance to do.
const VIEWS: usize = 2;
/// Step of differences, in σ of the unknown. One view of a plane leaves a direction of the projector undetermined, and larger
/// parts of its σ are not straight.
const STEP_SIGMAS: f64 = 1e-4;
/// Degrees of freedom that the fit takes from edge points (a pose) and from projected corners (a homography).
const SPENT: [usize; 2] = [6, 8];

/// A point of the search: the rig as it was and as it is, and the unknowns that lead there.
#[derive(Clone)]
pub(super) struct State {
    past: Model,
    now: Model,
    y: DVector<f64>,
    freed: DVector<f64>,
}

/// The problem, with unknowns in the order y, what is free, pose (and bend) of the sheet now.
#[derive(Clone)]
pub(super) struct Posterior {
    /// The photograph.
    photograph: BundleAdjustment,
    past: RigViews,
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
        let start = whole.with_views(&[Sheet::flat(sheet_pose(view, &rig.camera.model)?, view.size)]);
        let counted = rig.views.len().min(VIEWS);
        let bend = rig.views.first().and_then(|v| v.bend).map(|b| b.expected_mm);
        let unknowns = Unknowns::all(counted, bend.is_some());
        let known = covariance::of_rig(rig, &unknowns)
            .unwrap_or_else(|| DMatrix::zeros(unknowns.len(), unknowns.len()));
        let factor = covariance::factor(&known);
        let past = RigViews::new(rig, whole.with_views(&whole.views[..counted]), &factor);
        let units = start.units(&Unknowns::all(0, false));
        // The sheet bends by as much as those of the rig's own photographs may.
        let priors = Priors { bends: bend.into_iter().collect(), ..Priors::default() };
        let photograph = BundleAdjustment::new(measurements(seen), unknowns.with_views(1), priors);
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
        let all = Unknowns::all(0, false);
        let free: Vec<usize> = free.iter().filter_map(|p| all.position(p)).collect();
        let mut blocks = self.photograph.blocks.clone();
        let others = self.past.rows() + free.len();
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

    /// The robust fit with these parameters free: it detects outliers and measures the scatter of the others.
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
        let BundleAdjustment { unknowns, priors, .. } = self.photograph.clone();
        same.photograph = BundleAdjustment::new(widened.collect(), unknowns, priors);
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
        let (k, f, unknowns) = (self.bound(), free.len(), &self.photograph.unknowns);
        let mut delta = DVector::zeros(unknowns.len());
        delta.rows_mut(0, SHARED).copy_from(&(self.factor.rows(0, SHARED) * step.rows(0, k)));
        for (c, &i) in free.iter().enumerate() {
            delta[i] += step[k + c] * self.units[i];
        }
        delta.rows_mut(SHARED, unknowns.width()).copy_from(&step.rows(k + f, unknowns.width()));
        model.moved(unknowns, &delta)
    }
}

impl Problem for Posterior {
    type State = State;

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn structure(&self) -> Structure<'_> {
        Structure::dense(self.bound() + self.free.len() + self.photograph.unknowns.width())
    }

    fn linearise(&self, state: &State, to: &mut Linearised) -> Option<()> {
        let Linearised { residuals, jacobian } = self.photograph.at(&state.now)?;
        let (by_past, past) = self.past.linearised(&state.past, &self.factor, &state.y)?;
        let (n, p) = (residuals.len(), past.len());
        let (k, f) = (self.bound(), self.free.len());
        let width = self.photograph.unknowns.width();
        let by_shared = jacobian.columns(width, SHARED);
        to.jacobian.fill(0.0);
        to.jacobian.view_mut((0, 0), (n, k)).copy_from(&(by_shared * self.factor.rows(0, SHARED)));
        for (c, &i) in self.free.iter().enumerate() {
            to.jacobian.view_mut((0, k + c), (n, 1)).copy_from(&(by_shared.column(i) * self.units[i]));
            to.jacobian[(n + p + c, k + c)] = 1.0 / UNINFORMATIVE;
        }
        to.jacobian.view_mut((0, k + f), (n, width)).copy_from(&jacobian.columns(0, width));
        to.jacobian.view_mut((n, 0), (p, k)).copy_from(&by_past);
        to.residuals.rows_mut(0, n).copy_from(&residuals);
        to.residuals.rows_mut(n, p).copy_from(&past);
        to.residuals.rows_mut(n + p, f).copy_from(&(&state.freed / UNINFORMATIVE));
        Some(())
    }

    fn step(&self, state: &State, step: &DVector<f64>) -> Option<State> {
        let by_y = step.rows(0, self.bound());
        Some(State {
            past: state.past.moved(
                &self.photograph.unknowns.with_views(state.past.views.len()),
                &(&self.factor * by_y),
            )?,
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
