//! A bundle adjustment with unknowns of an explanation beside its own.

use nalgebra::{DVector, Vector2};

use super::explanation::Explanation;
use crate::estimate::robust::RobustProblem;
use crate::estimate::{BundleAdjustment, Measurement, Model};
use crate::solve::{Block, Linearised, Problem, Structure};

/// Differences of amounts: ln of a proportion, px.
const NEAR: f64 = 1e-3;

pub(super) struct WithAmounts {
    pub(super) by: Explanation,
    pub(super) problem: BundleAdjustment,
}

/// Sizes in the model are those that were given.
pub(super) type State = (Model, Vector2<f64>);

impl WithAmounts {
    fn changed(&self, (model, amounts): &State) -> (BundleAdjustment, Model) {
        self.by.changed(&self.problem, model, *amounts)
    }
}

impl Problem for WithAmounts {
    type State = State;

    fn blocks(&self) -> &[Block] {
        self.problem.blocks()
    }

    fn structure(&self) -> Structure<'_> {
        let inner = self.problem.structure();
        Structure { shared: inner.shared + self.by.parameters(), ..inner }
    }

    fn linearise(&self, state: &State, to: &mut Linearised) -> Option<()> {
        let at = |state: &State| {
            let (problem, model) = self.changed(state);
            problem.at(&model)
        };
        let here = at(state)?;
        let columns = here.jacobian.ncols();
        to.jacobian.columns_mut(0, columns).copy_from(&here.jacobian);
        for k in 0..self.by.parameters() {
            let mut beyond = state.clone();
            beyond.1[k] += NEAR;
            let by_amount = (at(&beyond)?.residuals - &here.residuals) / NEAR;
            to.jacobian.set_column(columns + k, &by_amount);
        }
        to.residuals.copy_from(&here.residuals);
        Some(())
    }

    fn step(&self, (model, amounts): &State, delta: &DVector<f64>) -> Option<State> {
        // The amounts stand after the shared unknowns of the problem, before those of the views.
        let (shared, count) = (self.problem.unknowns.shared, self.by.parameters());
        let mut amounts = *amounts;
        (0..count).for_each(|k| amounts[k] += delta[shared + k]);
        let own = delta.clone().remove_rows(shared, count);
        Some((model.moved(&self.problem.unknowns, &own)?, amounts))
    }

    fn max_iterations(&self) -> usize {
        self.problem.max_iterations()
    }
}

impl RobustProblem for WithAmounts {
    fn measured(&mut self) -> (&[Measurement], &mut [Block]) {
        self.problem.measured()
    }

    fn norms_px(&self, state: &State) -> Option<Vec<f64>> {
        let (problem, model) = self.changed(state);
        problem.norms_px(&model)
    }

    fn renormalise((model, _): &mut State) {
        model.renormalise();
    }
}
