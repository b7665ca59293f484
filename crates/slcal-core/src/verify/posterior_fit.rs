//! One view under a rig: the rig's unknowns bound by its covariance, those under suspicion set free, the sheet's pose free.
//!
//! With y the rig's unknowns in units of their own σ (uncorrelated), m what is set free besides and v the pose now, the
//! minimum of |r(y, m, v)|² + |y|² is −2 ln of the likelihood times the rig's own posterior, to second order. That order
//! does not do where a rig is uncertain by far more than its noise, as from one photograph: what it allows is a curve. So
//! the rig's own views, as they are expected, tell y in the directions that they determine (`Past`), and |y|² the others.

use nalgebra::{DMatrix, DVector};

use crate::advise::shared::{self, SHARED, rows};
use crate::estimate::model::Model;
use crate::estimate::{Kind, Measurement};
use crate::geometry::RectangleSize;
use crate::solve::{Structure, covariance, robust_scale};

/// 1σ of what is set free, in natural units (1 for ln f and angles, the width, the distance): no information.
const VAGUE: f64 = 10.0;
/// A direction of y of whose information the rig's views hold this part or more is told by them: along a curve y itself moves
/// by many σ there.
const TOLD_BY_VIEWS: f64 = 0.5;
const MAX_STEPS: usize = 60;
const MAX_HALVINGS: usize = 12;
/// Steps end when they gain less than this in χ²: far below what any probability shows.
const SMALLEST_GAIN: f64 = 1e-7;
/// Rounds of weighing; the first ones are convex.
const ROUNDS: usize = 6;
const CONVEX_ROUNDS: usize = 2;
const CONVEX_CUTOFF: f64 = 3.0;
/// Measurements further off than this many times the inliers' scale are left out (as the calibration's loss does).
const CUTOFF: f64 = 4.685;
/// As in the calibration: σ of correlated edge points are three to four times their scatter.
const SMALLEST_SCALE: f64 = 0.25;
const FEWEST_FOR_ROBUST: usize = 12;
/// Median of |(x, y)| relative to that of |x|.
const RAYLEIGH_TO_NORMAL: f64 = 1.745_6;

/// What is fitted.
pub(super) struct Scene {
    pub(super) size: RectangleSize,
    pub(super) measurements: Vec<Measurement>,
    /// F with F·Fᵀ the covariance of the shared unknowns and of the views of `past`.
    pub(super) root: DMatrix<f64>,
    pub(super) past: Past,
    /// The rig, its view 0 where the sheet is seen now.
    pub(super) base: Model,
    /// Natural units of the shared unknowns.
    pub(super) units: Vec<f64>,
}

/// The rig as it was calibrated.
pub(super) struct Past {
    /// With its views, as far as they are counted with.
    pub(super) model: Model,
    /// The sheet of those views.
    pub(super) size: RectangleSize,
    /// What each view shows under the rig; nothing, when y alone speaks for them.
    pub(super) seen: Vec<Vec<Measurement>>,
    /// From their residuals to the y that they tell, in some directions; to first order it is y itself.
    told: DMatrix<f64>,
    /// The other directions, a row each.
    prior: DMatrix<f64>,
}

impl Past {
    /// y alone: |y|².
    pub(super) fn linear(model: Model, size: RectangleSize, unknowns: usize) -> Self {
        let prior = DMatrix::identity(unknowns, unknowns);
        Self { model, size, seen: Vec::new(), told: DMatrix::zeros(0, 0), prior }
    }

    /// The views, where they determine y, and |y|² elsewhere.
    pub(super) fn with_views(
        model: Model,
        seen: Vec<Vec<Measurement>>,
        size: RectangleSize,
        root: &DMatrix<f64>,
    ) -> Option<Self> {
        let mut past = Self { seen, ..Self::linear(model, size, root.ncols()) };
        let (a, _) = past.rows(&past.model, root)?;
        // Of information 1 in every direction of y, the views hold the eigenvalue.
        let eigen = (a.transpose() * &a).symmetric_eigen();
        let directions = |told: bool| {
            let those = |i: &usize| (eigen.eigenvalues[*i] >= TOLD_BY_VIEWS) == told;
            let chosen: Vec<usize> = (0..eigen.eigenvalues.len()).filter(those).collect();
            DMatrix::from_fn(chosen.len(), root.ncols(), |r, c| {
                let weight = if told { 1.0 / eigen.eigenvalues[chosen[r]] } else { 1.0 };
                eigen.eigenvectors[(c, chosen[r])] * weight
            })
        };
        past.told = directions(true) * a.transpose();
        past.prior = directions(false);
        Some(past)
    }

    /// The system of y: what the views tell of it and what they do not, each with unit σ.
    fn system(
        &self,
        model: &Model,
        root: &DMatrix<f64>,
        y: &DVector<f64>,
    ) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let q = self.prior.nrows();
        let told = self.told.nrows();
        let (mut a, mut r) = (DMatrix::zeros(told + q, root.ncols()), DVector::zeros(told + q));
        if told > 0 {
            let (by_y, residuals) = self.rows(model, root)?;
            a.rows_mut(0, told).copy_from(&(&self.told * by_y));
            r.rows_mut(0, told).copy_from(&(&self.told * residuals));
        }
        a.rows_mut(told, q).copy_from(&self.prior);
        r.rows_mut(told, q).copy_from(&(&self.prior * y));
        Some((a, r))
    }

    /// Derivatives by y and residuals of all views.
    fn rows(&self, model: &Model, root: &DMatrix<f64>) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let mut parts = Vec::new();
        for (i, seen) in self.seen.iter().enumerate() {
            let of_view = Model { views: vec![*model.views.get(i)?], ..model.clone() };
            let r = rows(&of_view, self.size, seen)?;
            let a = &r.by_shared * root.rows(0, SHARED) + &r.by_view * root.rows(SHARED + 6 * i, 6);
            parts.push((a, r.residuals));
        }
        let count = parts.iter().map(|p| p.1.len()).sum();
        let (mut a, mut b) = (DMatrix::zeros(count, root.ncols()), DVector::zeros(count));
        let mut at = 0;
        for (part, residuals) in parts {
            a.rows_mut(at, part.nrows()).copy_from(&part);
            b.rows_mut(at, part.nrows()).copy_from(&residuals);
            at += part.nrows();
        }
        Some((a, b))
    }
}

/// A point of the search: the rig as it was and as it is, and the unknowns that lead there.
#[derive(Clone)]
struct State {
    past: Model,
    now: Model,
    y: DVector<f64>,
    freed: DVector<f64>,
}

/// Where a fit ended.
pub(super) struct Fit {
    /// Its view 0 is the pose now.
    pub(super) model: Model,
    /// The rig as it was: without what was set free, with its own views.
    pub(super) past: Model,
    /// What was set free, in natural units.
    pub(super) freed: DVector<f64>,
    pub(super) chi_squared: f64,
    /// Residual norms in σ, one per measurement.
    pub(super) norms: Vec<f64>,
    /// Of y, what is free and the pose, in this order.
    pub(super) covariance: DMatrix<f64>,
}

/// Weights of the measurements, and the factors by which σ of sheet and pairs were widened.
pub(super) struct Weights {
    pub(super) each: Vec<f64>,
    pub(super) widened: [f64; 2],
}

impl Weights {
    pub(super) fn left_out(&self) -> usize {
        self.each.iter().filter(|w| **w == 0.0).count()
    }
}

fn is_pair(m: &Measurement) -> usize {
    usize::from(m.kind() == Kind::Pair)
}

fn dense_covariance(a: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    covariance(&Structure::dense(a.ncols()), a, &vec![0.0; a.ncols()])
}

impl Scene {
    /// The system of one step: rows [by y, by what is free, by the pose] and what they should become.
    fn system(
        &self,
        state: &State,
        free: &[usize],
        weights: &[f64],
    ) -> Option<(DMatrix<f64>, DVector<f64>, Vec<f64>)> {
        let all = rows(&state.now, self.size, &self.measurements)?;
        let (by_past, past) = self.past.system(&state.past, &self.root, &state.y)?;
        let (n, p) = (all.residuals.len(), past.len());
        let (k, f) = (self.root.ncols(), free.len());
        let mut norms = vec![0.0; self.measurements.len()];
        for (row, &i) in all.of.iter().enumerate() {
            norms[i] += all.residuals[row].powi(2);
        }
        let mut a = DMatrix::zeros(n + p + f, k + f + 6);
        let mut b = DVector::zeros(n + p + f);
        a.view_mut((0, 0), (n, k)).copy_from(&(&all.by_shared * self.root.rows(0, SHARED)));
        for (c, &i) in free.iter().enumerate() {
            a.view_mut((0, k + c), (n, 1)).copy_from(&(all.by_shared.column(i) * self.units[i]));
        }
        a.view_mut((0, k + f), (n, 6)).copy_from(&all.by_view);
        for (row, &i) in all.of.iter().enumerate() {
            a.row_mut(row).scale_mut(weights[i]);
            b[row] = -all.residuals[row] * weights[i];
        }
        a.view_mut((n, 0), (p, k)).copy_from(&by_past);
        b.rows_mut(n, p).copy_from(&-past);
        for i in 0..f {
            a[(n + p + i, k + i)] = 1.0 / VAGUE;
            b[n + p + i] = -state.freed[i] / VAGUE;
        }
        Some((a, b, norms.into_iter().map(f64::sqrt).collect()))
    }

    fn stepped(&self, state: &State, free: &[usize], step: &DVector<f64>) -> Option<State> {
        let k = self.root.ncols();
        let views = state.past.views.len();
        let by_y = step.rows(0, k);
        Some(State {
            past: state.past.moved(&shared::layout(views), &(&self.root * by_y))?,
            now: self.moved(&state.now, free, step)?,
            y: &state.y + by_y,
            freed: &state.freed + step.rows(k, free.len()),
        })
    }

    /// The model after a step in [y, what is free, pose].
    pub(super) fn moved(&self, model: &Model, free: &[usize], step: &DVector<f64>) -> Option<Model> {
        let (k, f) = (self.root.ncols(), free.len());
        let mut delta = DVector::zeros(SHARED + 6);
        delta.rows_mut(0, SHARED).copy_from(&(self.root.rows(0, SHARED) * step.rows(0, k)));
        for (c, &i) in free.iter().enumerate() {
            delta[i] += step[k + c] * self.units[i];
        }
        delta.rows_mut(SHARED, 6).copy_from(&step.rows(k + f, 6));
        model.moved(&shared::layout(1), &delta)
    }

    /// The minimum with the shared unknowns in `free` set free.
    pub(super) fn fit(&self, free: &[usize], weights: &[f64]) -> Option<Fit> {
        let mut state = State {
            past: self.past.model.clone(),
            now: self.base.clone(),
            y: DVector::zeros(self.root.ncols()),
            freed: DVector::zeros(free.len()),
        };
        let (mut a, mut b, mut norms) = self.system(&state, free, weights)?;
        for _ in 0..MAX_STEPS {
            let qr = a.clone().qr();
            let mut right = b.clone();
            qr.q_tr_mul(&mut right);
            let right = right.rows(0, a.ncols()).into_owned();
            let mut step = qr.unpack_r().solve_upper_triangular(&right)?;
            let now = b.norm_squared();
            let mut better = None;
            for _ in 0..MAX_HALVINGS {
                if let Some(next) = self.stepped(&state, free, &step)
                    && let Some(system) = self.system(&next, free, weights)
                    && system.1.norm_squared() < now
                {
                    better = Some((next, system));
                    break;
                }
                step *= 0.5;
            }
            let Some((next, system)) = better else { break };
            let gain = now - system.1.norm_squared();
            state = next;
            (a, b, norms) = system;
            if gain < SMALLEST_GAIN {
                break;
            }
        }
        state.now.renormalise();
        state.past.renormalise();
        let covariance = dense_covariance(&a)?;
        let State { past, now: model, freed, .. } = state;
        Some(Fit { model, past, freed, chi_squared: b.norm_squared(), norms, covariance })
    }

    /// Weights from a fit with `free` set free: outliers get none, and the inliers' σ are widened when they scatter more
    /// than they say.
    pub(super) fn weigh(&self, free: &[usize]) -> Option<Weights> {
        let mut each = vec![1.0; self.measurements.len()];
        let count = [0, 1].map(|kind| self.measurements.iter().filter(|m| is_pair(m) == kind).count());
        let correction = [1.0, RAYLEIGH_TO_NORMAL];
        let mut norms = Vec::new();
        for round in 0..ROUNDS {
            norms = self.fit(free, &each)?.norms;
            let scale = [0, 1].map(|kind| {
                let of_kind = self.measurements.iter().zip(&norms).filter(|(m, _)| is_pair(m) == kind);
                robust_scale(of_kind.map(|(_, n)| n / correction[kind])).max(SMALLEST_SCALE)
            });
            for ((w, n), m) in each.iter_mut().zip(&norms).zip(&self.measurements) {
                let kind = is_pair(m);
                let robust = count[kind] >= FEWEST_FOR_ROBUST && m.kind() != Kind::SheetCorner;
                *w = match (robust, round < CONVEX_ROUNDS) {
                    (false, _) => 1.0,
                    (true, true) => (CONVEX_CUTOFF * scale[kind] / n.max(f64::MIN_POSITIVE)).min(1.0).sqrt(),
                    (true, false) => f64::from(u8::from(*n <= CUTOFF * scale[kind])),
                };
            }
        }
        let widened = [0, 1].map(|kind| self.widening(kind, &norms, &each));
        for (w, m) in each.iter_mut().zip(&self.measurements) {
            *w /= widened[is_pair(m)];
        }
        Some(Weights { each, widened })
    }

    /// The rms of the inliers, those of the degrees of freedom that they spend on the fit left out; never below one.
    fn widening(&self, kind: usize, norms: &[f64], weights: &[f64]) -> f64 {
        // A homography, or a pose.
        let spent = [6.0, 8.0][kind];
        let (mut sum, mut rows) = (0.0, 0.0);
        for ((m, n), w) in self.measurements.iter().zip(norms).zip(weights) {
            if is_pair(m) == kind && *w > 0.0 {
                sum += n * n;
                rows += if m.kind() == Kind::Edge { 1.0 } else { 2.0 };
            }
        }
        if rows < 2.0 * FEWEST_FOR_ROBUST as f64 { 1.0 } else { (sum / (rows - spent)).sqrt().max(1.0) }
    }

    /// 1σ of functions of the fitted model, by central differences along every unknown.
    pub(super) fn propagate<const N: usize>(
        &self,
        fit: &Fit,
        free: &[usize],
        of: impl Fn(&Model) -> Option<[f64; N]>,
    ) -> Option<[f64; N]> {
        let n = fit.covariance.nrows();
        let mut gradient = DMatrix::zeros(N, n);
        for i in 0..n {
            // A small part of the unknown's own σ: far above rounding, far below curvature.
            let h = 1e-2 * fit.covariance[(i, i)].sqrt();
            let mut step = DVector::zeros(n);
            step[i] = h;
            let up = of(&self.moved(&fit.model, free, &step)?)?;
            let down = of(&self.moved(&fit.model, free, &-step)?)?;
            for r in 0..N {
                gradient[(r, i)] = (up[r] - down[r]) / (2.0 * h);
            }
        }
        let c = &gradient * &fit.covariance * gradient.transpose();
        let sigma: [f64; N] = std::array::from_fn(|i| c[(i, i)].max(0.0).sqrt());
        sigma.iter().all(|s| s.is_finite()).then_some(sigma)
    }
}
