//! Levenberg–Marquardt for small problems (J. J. Moré, "The Levenberg-Marquardt algorithm: implementation and theory",
//! 1978, with the damping rule of H. B. Nielsen, 1999) on scaled columns; the linear algebra is in `block_arrow_qr`.

use nalgebra::{DMatrix, DVector};

use super::Loss;
use super::block_arrow_qr::{Reduced, Structure};

/// A residual block: consecutive residuals with one loss of their norm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Block {
    /// Number of residuals.
    pub(crate) len: usize,
    /// Their loss.
    pub(crate) loss: Loss,
}

/// Residuals, and their derivatives by a step, at one state.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Linearised {
    /// Residuals divided by their σ.
    pub(crate) residuals: DVector<f64>,
    /// d residuals / d step at step zero, columns as the problem's [`Structure`] has them.
    pub(crate) jacobian: DMatrix<f64>,
}

impl Linearised {
    /// Zeros of the sizes that a problem needs.
    #[must_use]
    pub(crate) fn zeros<P: Problem>(problem: &P) -> Self {
        let rows = problem.blocks().iter().map(|b| b.len).sum();
        Self {
            residuals: DVector::zeros(rows),
            jacobian: DMatrix::zeros(rows, problem.structure().columns()),
        }
    }
}

/// A least-squares problem over a state that may live on a manifold.
pub(crate) trait Problem {
    /// What is estimated.
    type State: Clone;
    /// How the residuals are grouped, in order.
    fn blocks(&self) -> &[Block];
    /// Which unknowns they depend on.
    fn structure(&self) -> Structure<'_>;
    /// Writes every residual and every derivative (`at` holds those of another state); `None` where the model is not
    /// defined.
    fn linearise(&self, state: &Self::State, at: &mut Linearised) -> Option<()>;
    /// The state after a step; `None` when it leaves the domain.
    fn step(&self, state: &Self::State, delta: &DVector<f64>) -> Option<Self::State>;
    /// Maximum number of steps. Well-posed calibrations take 5 to 20, nearly singular ones 100.
    fn max_iterations(&self) -> usize {
        300
    }
}

/// The result of a minimisation.
#[derive(Debug, Clone)]
pub(crate) struct Minimum<S> {
    /// The state.
    pub(crate) state: S,
    /// Sum of the blocks' costs.
    pub(crate) cost: f64,
    /// Residuals and derivatives there, without the weights of the losses.
    pub(crate) at: Linearised,
    /// Accepted and rejected steps; fewer than the problem allows when it has converged.
    pub(crate) iterations: usize,
}

/// In units of χ²: a predicted decrease d leaves the parameters within √d of their own σ.
pub(crate) const CONVERGED_DECREASE: f64 = 1e-12;
/// Predicted decrease below which a step without gain means convergence: a thousandth of the parameters' σ from the
/// minimum.
const STALLED_DECREASE: f64 = 1e-6;
/// Damping of a search whose start may be far from the minimum.
pub(crate) const INITIAL_DAMPING: f64 = 1e-4;
const MAX_DAMPING: f64 = 1e16;

/// Sum of the blocks' costs.
#[must_use]
pub(crate) fn robust_cost(blocks: &[Block], residuals: &DVector<f64>) -> f64 {
    let mut at = 0;
    let mut cost = 0.0;
    for block in blocks {
        cost += block.loss.cost(residuals.rows(at, block.len).norm_squared());
        at += block.len;
    }
    cost
}

/// Square roots of the blocks' weights, one for each residual.
fn set_weights(weights: &mut Vec<f64>, blocks: &[Block], residuals: &DVector<f64>) {
    weights.clear();
    for block in blocks {
        let s = residuals.rows(weights.len(), block.len).norm_squared();
        let w = if block.loss == Loss::Square { 1.0 } else { block.loss.weight(s).sqrt() };
        weights.resize(weights.len() + block.len, w);
    }
}

/// Minimises the problem's cost from `start`; `None` when the model is not defined there.
#[must_use]
pub(crate) fn minimise<P: Problem>(problem: &P, start: P::State) -> Option<Minimum<P::State>> {
    minimise_from(problem, start, INITIAL_DAMPING, CONVERGED_DECREASE)
}

/// The same with a damping to begin with (little near the minimum), until steps are predicted to lower the cost by less
/// than `decrease`, in units of χ².
#[must_use]
pub(crate) fn minimise_from<P: Problem>(
    problem: &P,
    start: P::State,
    mut damping: f64,
    decrease: f64,
) -> Option<Minimum<P::State>> {
    let (blocks, structure) = (problem.blocks(), problem.structure());
    let mut here = Linearised::zeros(problem);
    problem.linearise(&start, &mut here)?;
    let mut cost = robust_cost(blocks, &here.residuals);
    if !cost.is_finite() {
        return None;
    }
    let mut there = here.clone();
    let mut reduced = Reduced::new(&structure);
    let mut weights = Vec::with_capacity(here.residuals.len());
    let mut reduce = |at: &Linearised, reduced: &mut Reduced| {
        set_weights(&mut weights, blocks, &at.residuals);
        reduced.reduce(&structure, &at.jacobian, at.residuals.as_slice(), &weights).then_some(())
    };
    reduce(&here, &mut reduced)?;
    let mut state = start;
    let mut growth = 2.0;
    let mut iterations = 0;
    while iterations < problem.max_iterations() && damping < MAX_DAMPING {
        iterations += 1;
        let Some((delta, predicted)) = reduced.step(&structure, damping) else {
            damping = damping.max(f64::EPSILON) * 10.0;
            continue;
        };
        let tried = problem.step(&state, &delta).and_then(|s| {
            problem.linearise(&s, &mut there)?;
            let c = robust_cost(blocks, &there.residuals);
            c.is_finite().then_some((s, c))
        });
        let small = predicted <= decrease;
        match tried {
            Some((s, c)) if c < cost => {
                let gain = (cost - c) / predicted;
                (state, cost) = (s, c);
                std::mem::swap(&mut here, &mut there);
                damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).clamp(0.1, 1.0);
                growth = 2.0;
                // A heavily damped step is short whatever the gradient: only nearly undamped ones show convergence.
                if small && damping <= INITIAL_DAMPING {
                    break;
                }
                reduce(&here, &mut reduced)?;
            }
            // Rounding prevents a further decrease.
            _ if predicted <= decrease.max(STALLED_DECREASE) => break,
            _ => {
                damping *= growth;
                growth *= 2.0;
            }
        }
    }
    Some(Minimum { state, cost, at: here, iterations })
}

/// Gauss-Newton steps of full length, whatever the cost does on the way, until one is predicted to lower it by less than
/// `decrease`; `None` where that takes more than `most`. From one minimum to that of a problem that differs a little they lead
/// across the curved valleys of nearly undetermined unknowns, along which steps that must lower the cost are short.
#[must_use]
pub(crate) fn undamped<P: Problem>(
    problem: &P,
    mut state: P::State,
    decrease: f64,
    most: usize,
) -> Option<Minimum<P::State>> {
    let (blocks, structure) = (problem.blocks(), problem.structure());
    let mut reduced = Reduced::new(&structure);
    let (mut at, mut weights) = (Linearised::zeros(problem), Vec::new());
    for iterations in 0..=most {
        problem.linearise(&state, &mut at)?;
        let cost = robust_cost(blocks, &at.residuals);
        set_weights(&mut weights, blocks, &at.residuals);
        let solved = reduced.reduce(&structure, &at.jacobian, at.residuals.as_slice(), &weights);
        let (delta, predicted) = solved.then(|| reduced.step(&structure, 0.0)).flatten()?;
        if predicted <= decrease {
            return Some(Minimum { state, cost, at, iterations });
        }
        state = problem.step(&state, &delta)?;
    }
    None
}

/// A minimum after undamped steps, which complete directions that damping shortens. Their decrease is below rounding, so
/// the cost must only not rise beyond rounding.
#[must_use]
pub(crate) fn polish<P: Problem>(problem: &P, mut from: Minimum<P::State>) -> Minimum<P::State> {
    const STEPS: usize = 2;
    const ROUNDING: f64 = 1e-12;
    let (blocks, structure) = (problem.blocks(), problem.structure());
    let mut reduced = Reduced::new(&structure);
    let mut there = from.at.clone();
    let mut weights = Vec::with_capacity(there.residuals.len());
    for _ in 0..STEPS {
        set_weights(&mut weights, blocks, &from.at.residuals);
        if !reduced.reduce(&structure, &from.at.jacobian, from.at.residuals.as_slice(), &weights) {
            break;
        }
        let step = reduced.step(&structure, 0.0).filter(|(_, predicted)| *predicted <= STALLED_DECREASE);
        let Some(state) = step.and_then(|(delta, _)| problem.step(&from.state, &delta)) else { break };
        if problem.linearise(&state, &mut there).is_none() {
            break;
        }
        let cost = robust_cost(blocks, &there.residuals);
        if cost.is_nan() || cost > from.cost * (1.0 + ROUNDING) {
            break;
        }
        (from.state, from.cost) = (state, cost);
        std::mem::swap(&mut from.at, &mut there);
        from.iterations += 1;
    }
    from
}

#[cfg(test)]
mod tests {
    use super::*;

    /// a·exp(−b·t) sampled at t = 0, 1, …, one sample spoilt.
    struct Decay {
        samples: Vec<f64>,
        blocks: Vec<Block>,
    }

    impl Decay {
        fn new(loss: Loss) -> Self {
            let mut samples: Vec<f64> = (0..12).map(|t| 5.0 * (-0.3 * f64::from(t)).exp()).collect();
            samples[3] += 4.0;
            Self { blocks: vec![Block { len: 1, loss }; samples.len()], samples }
        }
    }

    impl Problem for Decay {
        type State = [f64; 2];
        fn blocks(&self) -> &[Block] {
            &self.blocks
        }
        fn structure(&self) -> Structure<'_> {
            Structure::dense(2)
        }
        fn linearise(&self, [a, b]: &[f64; 2], at: &mut Linearised) -> Option<()> {
            for (t, sample) in self.samples.iter().enumerate() {
                let e = (-b * t as f64).exp();
                at.residuals[t] = a * e - sample;
                at.jacobian[(t, 0)] = e;
                at.jacobian[(t, 1)] = -a * t as f64 * e;
            }
            Some(())
        }
        fn step(&self, s: &[f64; 2], d: &DVector<f64>) -> Option<[f64; 2]> {
            Some([s[0] + d[0], s[1] + d[1]])
        }
    }

    #[test]
    fn a_redescending_loss_finds_the_truth_beside_an_outlier() {
        let problem = Decay::new(Loss::Square);
        let square = minimise(&problem, [1.0, 0.1]).unwrap();
        assert!(square.iterations < problem.max_iterations() && (square.state[0] - 5.0).abs() > 0.05);
        let problem = Decay::new(Loss::Tukey(1.0));
        let robust = minimise(&problem, square.state).unwrap();
        assert!(robust.iterations < problem.max_iterations());
        assert!((robust.state[0] - 5.0).abs() < 1e-9 && (robust.state[1] - 0.3).abs() < 1e-9);
    }

    #[test]
    fn undamped_steps_end_where_damped_ones_do() {
        let problem = Decay::new(Loss::Square);
        let wanted = minimise(&problem, [1.0, 0.1]).unwrap();
        let found = undamped(&problem, [4.0, 0.2], CONVERGED_DECREASE, 20).unwrap();
        assert!((found.state[0] - wanted.state[0]).abs() < 1e-6 && (found.cost - wanted.cost).abs() < 1e-9);
        assert!(undamped(&problem, [4.0, 0.2], CONVERGED_DECREASE, 0).is_none());
    }

    #[test]
    fn the_gradient_vanishes_at_a_minimum() {
        let problem = Decay::new(Loss::Square);
        let at = minimise(&problem, [1.0, 0.1]).unwrap().at;
        let gradient = at.jacobian.transpose() * at.residuals;
        assert!(gradient.norm() < 1e-5, "{gradient}");
    }
}
