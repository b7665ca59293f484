//! Levenberg–Marquardt for small dense problems (J. J. Moré, "The Levenberg-Marquardt algorithm: implementation and
//! theory", 1978, with the damping rule of H. B. Nielsen, 1999), by QR on scaled columns: never through JᵀJ, whose
//! condition number is the square of the problem's.

use nalgebra::{DMatrix, DVector};

use super::Loss;

/// A residual block: consecutive residuals whose norm is judged together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// Number of residuals.
    pub len: usize,
    /// What they cost.
    pub loss: Loss,
}

/// A least-squares problem over a state that may live on a manifold.
pub trait Problem {
    /// What is estimated.
    type State: Clone;
    /// How the residuals are grouped, in order.
    fn blocks(&self) -> &[Block];
    /// Residuals divided by their σ; `None` where the model is not defined.
    fn residuals(&self, state: &Self::State) -> Option<DVector<f64>>;
    /// d residuals / d step at step zero.
    fn jacobian(&self, state: &Self::State) -> Option<DMatrix<f64>>;
    /// The state after a step; `None` when it leaves the domain.
    fn step(&self, state: &Self::State, delta: &DVector<f64>) -> Option<Self::State>;
    /// Steps tried before giving up. Well-posed calibrations take 5 to 20, nearly singular ones 100.
    fn max_iterations(&self) -> usize {
        300
    }
}

/// Where a minimisation ended.
#[derive(Debug, Clone)]
pub struct Minimum<S> {
    /// The state.
    pub state: S,
    /// Sum of the blocks' costs.
    pub cost: f64,
    /// Accepted and rejected steps.
    pub iterations: usize,
    /// Whether the predicted decrease fell below [`CONVERGED_DECREASE`], or steps that should gain next to nothing gained
    /// nothing; otherwise the iterations ran out or no step reduced the cost.
    pub converged: bool,
}

/// In units of χ²: a predicted decrease d leaves the parameters within √d of their own σ.
pub const CONVERGED_DECREASE: f64 = 1e-12;
/// A step that should gain this little and does not: a thousandth of the parameters' σ from the minimum.
const STALLED_DECREASE: f64 = 1e-6;
const INITIAL_DAMPING: f64 = 1e-4;
const MAX_DAMPING: f64 = 1e16;

/// Sum of the blocks' costs.
#[must_use]
pub fn robust_cost(blocks: &[Block], residuals: &DVector<f64>) -> f64 {
    let mut at = 0;
    let mut cost = 0.0;
    for block in blocks {
        cost += block.loss.cost(residuals.rows(at, block.len).norm_squared());
        at += block.len;
    }
    cost
}

/// Multiplies residuals and Jacobian by the square roots of the blocks' weights.
fn apply_weights(blocks: &[Block], residuals: &mut DVector<f64>, jacobian: &mut DMatrix<f64>) {
    let mut at = 0;
    for block in blocks {
        if block.loss != Loss::Square {
            let w = block.loss.weight(residuals.rows(at, block.len).norm_squared()).sqrt();
            residuals.rows_mut(at, block.len).scale_mut(w);
            jacobian.rows_mut(at, block.len).scale_mut(w);
        }
        at += block.len;
    }
}

/// Column norms; zero columns count as one, so that parameters without effect stay where they are.
fn column_scale(jacobian: &DMatrix<f64>) -> DVector<f64> {
    DVector::from_iterator(
        jacobian.ncols(),
        jacobian.column_iter().map(|c| {
            let n = c.norm();
            if n > 0.0 { n } else { 1.0 }
        }),
    )
}

/// The problem reduced to R·y = −c in scaled steps y, by QR of [J D⁻¹ | r].
struct Reduced {
    r: DMatrix<f64>,
    rhs: DVector<f64>,
    scale: DVector<f64>,
}

fn reduce<P: Problem>(problem: &P, state: &P::State, mut residuals: DVector<f64>) -> Option<Reduced> {
    let mut j = problem.jacobian(state)?;
    apply_weights(problem.blocks(), &mut residuals, &mut j);
    if !j.iter().all(|x| x.is_finite()) {
        return None;
    }
    let scale = column_scale(&j);
    let (m, n) = j.shape();
    let mut augmented = j.resize(m.max(n + 1), n + 1, 0.0);
    for (mut column, s) in augmented.column_iter_mut().zip(&scale) {
        column /= *s;
    }
    augmented.view_mut((0, n), (m, 1)).copy_from(&residuals);
    let factor = augmented.qr().unpack_r();
    Some(Reduced {
        r: factor.view((0, 0), (n, n)).into(),
        rhs: factor.view((0, n), (n, 1)).column(0).into(),
        scale,
    })
}

impl Reduced {
    /// The damped step in scaled parameters.
    fn step(&self, damping: f64) -> Option<DVector<f64>> {
        let n = self.r.ncols();
        let mut a = DMatrix::zeros(2 * n, n);
        a.view_mut((0, 0), (n, n)).copy_from(&self.r);
        a.view_mut((n, 0), (n, n)).fill_diagonal(damping.sqrt());
        let mut b = DVector::zeros(2 * n);
        b.rows_mut(0, n).copy_from(&-&self.rhs);
        let qr = a.qr();
        qr.q_tr_mul(&mut b);
        let y = qr.r().solve_upper_triangular(&b.rows(0, n).into_owned())?;
        y.iter().all(|x| x.is_finite()).then_some(y)
    }
}

/// Minimises the problem's cost from `start`; `None` when the model is not defined there.
#[must_use]
pub fn minimise<P: Problem>(problem: &P, start: P::State) -> Option<Minimum<P::State>> {
    let mut residuals = problem.residuals(&start)?;
    let mut cost = robust_cost(problem.blocks(), &residuals);
    if !cost.is_finite() {
        return None;
    }
    let mut state = start;
    let mut damping = INITIAL_DAMPING;
    let mut growth = 2.0;
    let mut reduced = reduce(problem, &state, residuals.clone())?;
    let mut converged = false;
    let mut iterations = 0;
    while iterations < problem.max_iterations() && damping < MAX_DAMPING {
        iterations += 1;
        let Some(y) = reduced.step(damping) else {
            damping = damping.max(f64::EPSILON) * 10.0;
            continue;
        };
        let predicted = 2.0 * damping * y.norm_squared() + (&reduced.r * &y).norm_squared();
        let candidate = problem.step(&state, &y.component_div(&reduced.scale));
        let tried = candidate.and_then(|s| {
            let r = problem.residuals(&s)?;
            let c = robust_cost(problem.blocks(), &r);
            c.is_finite().then_some((s, r, c))
        });
        let small = predicted <= CONVERGED_DECREASE;
        match tried {
            Some((s, r, c)) if c < cost => {
                let gain = (cost - c) / predicted;
                (state, residuals, cost) = (s, r, c);
                damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).clamp(0.1, 1.0);
                growth = 2.0;
                // A heavily damped step is short whatever the gradient: only nearly undamped ones show convergence.
                if small && damping <= INITIAL_DAMPING {
                    converged = true;
                    break;
                }
                reduced = reduce(problem, &state, residuals.clone())?;
            }
            // Rounding, or a Jacobian that is exact to first order only, keeps the cost from falling further.
            _ if predicted <= STALLED_DECREASE => {
                converged = true;
                break;
            }
            _ => {
                damping *= growth;
                growth *= 2.0;
            }
        }
    }
    Some(Minimum { state, cost, iterations, converged })
}

/// (JᵀJ)⁻¹ of a whitened Jacobian that includes the priors, by QR on scaled columns; `None` when it is singular.
#[must_use]
pub fn covariance(jacobian: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let (m, n) = jacobian.shape();
    if m < n || !jacobian.iter().all(|x| x.is_finite()) {
        return None;
    }
    let scale = column_scale(jacobian);
    let mut scaled = jacobian.clone();
    for (mut column, s) in scaled.column_iter_mut().zip(&scale) {
        column /= *s;
    }
    let r = scaled.qr().unpack_r();
    let mut inverse = r.solve_upper_triangular(&DMatrix::identity(n, n))?;
    for (mut row, s) in inverse.row_iter_mut().zip(&scale) {
        row /= *s;
    }
    let c = &inverse * inverse.transpose();
    c.iter().all(|x| x.is_finite()).then_some(c)
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
        fn residuals(&self, [a, b]: &[f64; 2]) -> Option<DVector<f64>> {
            Some(DVector::from_fn(self.samples.len(), |t, _| a * (-b * t as f64).exp() - self.samples[t]))
        }
        fn jacobian(&self, [a, b]: &[f64; 2]) -> Option<DMatrix<f64>> {
            Some(DMatrix::from_fn(self.samples.len(), 2, |t, j| {
                let e = (-b * t as f64).exp();
                if j == 0 { e } else { -a * t as f64 * e }
            }))
        }
        fn step(&self, s: &[f64; 2], d: &DVector<f64>) -> Option<[f64; 2]> {
            Some([s[0] + d[0], s[1] + d[1]])
        }
    }

    #[test]
    fn a_redescending_loss_finds_the_truth_beside_an_outlier() {
        let square = minimise(&Decay::new(Loss::Square), [1.0, 0.1]).unwrap();
        assert!(square.converged && (square.state[0] - 5.0).abs() > 0.05);
        let robust = minimise(&Decay::new(Loss::Tukey(1.0)), square.state).unwrap();
        assert!(robust.converged);
        assert!((robust.state[0] - 5.0).abs() < 1e-9 && (robust.state[1] - 0.3).abs() < 1e-9);
    }

    #[test]
    fn the_gradient_vanishes_at_a_minimum() {
        let problem = Decay::new(Loss::Square);
        let at = minimise(&problem, [1.0, 0.1]).unwrap().state;
        let gradient = problem.jacobian(&at).unwrap().transpose() * problem.residuals(&at).unwrap();
        assert!(gradient.norm() < 1e-5, "{gradient}");
    }

    #[test]
    fn covariance_of_badly_scaled_columns() {
        let j = DMatrix::from_row_slice(3, 2, &[1e9, 0.0, 0.0, 1e-9, 0.0, 0.0]);
        let c = covariance(&j).unwrap();
        assert!((c[(0, 0)] * 1e18 - 1.0).abs() < 1e-12 && (c[(1, 1)] * 1e-18 - 1.0).abs() < 1e-12);
        assert!(covariance(&DMatrix::from_element(3, 2, f64::NAN)).is_none());
        assert!(covariance(&DMatrix::zeros(1, 2)).is_none());
    }
}
