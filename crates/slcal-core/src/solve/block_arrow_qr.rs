//! QR factorisation for linear least squares whose rows depend on shared unknowns and on those of at most one group. The
//! triangular factor is block-arrow shaped, and the cost of solving is proportional to the number of groups.
//!
//! Each group is eliminated by Householder reflections of its own rows [J_group | J_shared | r], never through JᵀJ, whose
//! condition number is the square of the problem's. The remaining rows depend on the shared unknowns alone.

use nalgebra::{DMatrix, DVector, DVectorView};

/// Which unknowns the rows of a Jacobian depend on. A step and a covariance list the shared unknowns first, then group
/// after group; a Jacobian has a column for each unknown of the row's own group, then one for each shared unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Structure<'a> {
    /// Unknowns that every row may depend on.
    pub(crate) shared: usize,
    /// Unknowns of each group.
    pub(crate) width: usize,
    /// How many consecutive rows belong to each group, in order.
    pub(crate) groups: &'a [usize],
    /// After these, so many rows more for each group; the rest depends on shared unknowns alone.
    pub(crate) more: usize,
}

impl Structure<'static> {
    /// Every row depends on every unknown.
    #[must_use]
    pub(crate) fn dense(unknowns: usize) -> Self {
        Self { shared: unknowns, width: 0, groups: &[], more: 0 }
    }
}

impl Structure<'_> {
    /// Columns of the Jacobian.
    #[must_use]
    pub(crate) fn columns(&self) -> usize {
        self.width + self.shared
    }

    /// Number of unknowns.
    #[must_use]
    pub(crate) fn unknowns(&self) -> usize {
        self.shared + self.width * self.groups.len()
    }

    /// Rows that belong to groups.
    fn rows_of_groups(&self) -> usize {
        self.groups.iter().sum::<usize>() + self.more * self.groups.len()
    }

    /// Where the unknowns of a group begin.
    pub(super) fn start(&self, group: usize) -> usize {
        self.shared + self.width * group
    }

    /// The rows of each group and of the rest, as (group, first row, number of rows).
    fn parts(&self, rows: usize) -> impl Iterator<Item = (Option<usize>, usize, usize)> {
        let mut at = 0;
        let rest: usize = rows.saturating_sub(self.rows_of_groups());
        let more = (0..if self.more > 0 { self.groups.len() } else { 0 }).map(|g| (Some(g), self.more));
        let counts =
            self.groups.iter().enumerate().map(|(g, n)| (Some(g), *n)).chain(more).chain([(None, rest)]);
        counts.map(move |(group, n)| {
            at += n;
            (group, at - n, n)
        })
    }
}

/// Reflects the rows of `below` (column-major, as many columns as `top`) into the triangle `top`, until nothing is left of
/// their first `pivots` columns (which are not written, as they would be zero).
fn absorb(top: &mut DMatrix<f64>, below: &mut [f64], rows: usize, pivots: usize) {
    let dot = |a: &[f64], b: &[f64]| DVectorView::from_slice(a, rows).dot(&DVectorView::from_slice(b, rows));
    let columns = top.ncols();
    for j in 0..pivots {
        let (left, right) = below.split_at_mut((j + 1) * rows);
        let v = &left[j * rows..];
        let tail = dot(v, v);
        if tail == 0.0 {
            continue;
        }
        let pivot = top[(j, j)];
        let norm = (pivot * pivot + tail).sqrt();
        let head = if pivot > 0.0 { pivot + norm } else { pivot - norm };
        let factor = 1.0 / (norm * (norm + pivot.abs()));
        top[(j, j)] = if pivot > 0.0 { -norm } else { norm };
        for l in j + 1..columns {
            let column = &mut right[(l - j - 1) * rows..(l - j) * rows];
            let share = (head * top[(j, l)] + dot(v, column)) * factor;
            top[(j, l)] -= share * head;
            for (c, x) in column.iter_mut().zip(v) {
                *c -= share * x;
            }
        }
    }
}

/// The triangular factor R and the right-hand side c of min |J·y + r|: R·y = −c.
#[derive(Debug, Clone)]
pub(super) struct Factor {
    /// Of each group [R | S | c]: its own triangle, what it shares, the right-hand side.
    heads: Vec<DMatrix<f64>>,
    /// Of the shared unknowns [R | c].
    root: DMatrix<f64>,
}

impl Factor {
    pub(super) fn zeros(s: &Structure) -> Self {
        let heads = vec![DMatrix::zeros(s.width, s.columns() + 1); s.groups.len()];
        Self { heads, root: DMatrix::zeros(s.shared, s.shared + 1) }
    }

    /// Adds rows [J_group | J_shared | r], column-major; `rows` is overwritten.
    pub(super) fn add(&mut self, group: Option<usize>, rows: &mut [f64], count: usize) {
        if count == 0 {
            return;
        }
        let width = rows.len() / count - self.root.ncols();
        if let Some(g) = group {
            absorb(&mut self.heads[g], rows, count, width);
        }
        let shared = self.root.nrows();
        absorb(&mut self.root, &mut rows[width * count..], count, shared);
    }

    /// Adds weighted rows of a Jacobian and their residuals, unknowns in units of `scale`.
    pub(super) fn add_weighted(
        &mut self,
        s: &Structure,
        jacobian: &DMatrix<f64>,
        residuals: &[f64],
        weights: &[f64],
        scale: &DVector<f64>,
        work: &mut Vec<f64>,
    ) {
        let rows = jacobian.nrows();
        for (group, first, count) in s.parts(rows) {
            let weights = &weights[first..first + count];
            work.clear();
            for c in 0..s.columns() {
                let scale = match group {
                    _ if c >= s.width => scale[c - s.width],
                    Some(g) => scale[s.start(g) + c],
                    None => f64::INFINITY,
                };
                let column = &jacobian.as_slice()[c * rows + first..][..count];
                work.extend(column.iter().zip(weights).map(|(x, w)| x * w / scale));
            }
            work.extend(residuals[first..first + count].iter().zip(weights).map(|(r, w)| r * w));
            self.add(group, work, count);
        }
    }

    /// Adds the rows of another factor of the same structure, multiplied by `weight`.
    pub(super) fn add_factor(&mut self, s: &Structure, other: &Self, weight: f64) {
        for (group, head) in other.heads.iter().enumerate() {
            let mut rows: Vec<f64> = head.iter().map(|x| x * weight).collect();
            self.add(Some(group), &mut rows, s.width);
        }
        let mut rows = vec![0.0; s.shared * (s.columns() + 1)];
        for (to, x) in rows[s.width * s.shared..].iter_mut().zip(&other.root) {
            *to = x * weight;
        }
        self.add(None, &mut rows, s.shared);
    }

    /// The triangles with their right-hand sides in the last column, and the number of unknowns of each.
    pub(super) fn triangles<'a>(&'a self, s: &Structure) -> impl Iterator<Item = (&'a DMatrix<f64>, usize)> {
        let (width, shared) = (s.width, s.shared);
        self.heads.iter().map(move |head| (head, width)).chain([(&self.root, shared)])
    }

    /// Adds one row per unknown with `diagonal` on its diagonal.
    fn add_diagonal(&mut self, s: &Structure, diagonal: impl Fn(usize) -> f64, work: &mut Vec<f64>) {
        let groups = (0..s.groups.len()).map(|g| (Some(g), s.start(g), s.width));
        for (group, first, count) in groups.chain([(None, 0, s.shared)]) {
            let before = if group.is_some() { 0 } else { s.width };
            work.clear();
            work.resize(count * (s.columns() + 1), 0.0);
            for i in 0..count {
                work[(before + i) * count + i] = diagonal(first + i);
            }
            self.add(group, work, count);
        }
    }

    fn copy_from(&mut self, other: &Self) {
        self.root.copy_from(&other.root);
        for (a, b) in self.heads.iter_mut().zip(&other.heads) {
            a.copy_from(b);
        }
    }

    /// y of R·y = −c; `None` when R is singular.
    fn solve(&self, s: &Structure) -> Option<DVector<f64>> {
        let mut y = DVector::zeros(s.unknowns());
        let shared = self.root.columns(0, s.shared).solve_upper_triangular(&-self.root.column(s.shared))?;
        y.rows_mut(0, s.shared).copy_from(&shared);
        for (g, head) in self.heads.iter().enumerate() {
            let right = -head.column(s.columns()) - head.columns(s.width, s.shared) * &shared;
            let own = head.columns(0, s.width).solve_upper_triangular(&right)?;
            y.rows_mut(s.start(g), s.width).copy_from(&own);
        }
        y.iter().all(|x| x.is_finite()).then_some(y)
    }

    /// |R·y|².
    fn image_norm_squared(&self, s: &Structure, y: &DVector<f64>) -> f64 {
        let shared = y.rows(0, s.shared);
        let of_groups = self.heads.iter().enumerate().map(|(g, head)| {
            let own = y.rows(s.start(g), s.width);
            (head.columns(0, s.width) * own + head.columns(s.width, s.shared) * shared).norm_squared()
        });
        of_groups.sum::<f64>() + (self.root.columns(0, s.shared) * shared).norm_squared()
    }

    /// (RᵀR)⁻¹ in full; `None` when R is singular. The shared part of R⁻¹ spreads to the groups by back-substitution, so
    /// that every block is a product of two thin ones.
    fn covariance(&self, s: &Structure) -> Option<DMatrix<f64>> {
        let n = s.unknowns();
        let root = self.root.columns(0, s.shared);
        let inverse = root.solve_upper_triangular(&DMatrix::identity(s.shared, s.shared))?;
        let mut spread = DMatrix::zeros(n, s.shared);
        spread.rows_mut(0, s.shared).copy_from(&inverse);
        let mut own = Vec::with_capacity(self.heads.len());
        for (g, head) in self.heads.iter().enumerate() {
            let triangle = head.columns(0, s.width);
            let through = triangle.solve_upper_triangular(&(head.columns(s.width, s.shared) * &inverse))?;
            spread.rows_mut(s.start(g), s.width).copy_from(&-through);
            own.push(triangle.solve_upper_triangular(&DMatrix::identity(s.width, s.width))?);
        }
        let mut covariance = &spread * spread.transpose();
        for (g, inverse) in own.iter().enumerate() {
            let mut block = covariance.view_mut((s.start(g), s.start(g)), (s.width, s.width));
            block += inverse * inverse.transpose();
        }
        Some(covariance)
    }
}

/// Norms of the columns of a weighted Jacobian, one for each unknown; zero columns count as one, so that unknowns without effect
/// do not change.
pub(super) fn column_norms(s: &Structure, jacobian: &DMatrix<f64>, weights: &[f64]) -> DVector<f64> {
    let mut scale = DVector::zeros(s.unknowns());
    for (group, first, count) in s.parts(jacobian.nrows()) {
        for (c, column) in jacobian.column_iter().enumerate() {
            let unknown = match group {
                _ if c >= s.width => c - s.width,
                Some(g) => s.start(g) + c,
                None => continue,
            };
            let rows = &column.as_slice()[first..first + count];
            scale[unknown] += rows.iter().zip(&weights[first..]).map(|(x, w)| (x * w).powi(2)).sum::<f64>();
        }
    }
    scale.apply(|x: &mut f64| *x = if *x > 0.0 { x.sqrt() } else { 1.0 });
    scale
}

/// A weighted problem with columns scaled to unit length, reduced to its factor. The memory is reused.
pub(super) struct Reduced {
    factor: Factor,
    damped: Factor,
    scale: DVector<f64>,
    work: Vec<f64>,
}

impl Reduced {
    pub(super) fn new(s: &Structure) -> Self {
        let factor = Factor::zeros(s);
        let damped = factor.clone();
        Self { factor, damped, scale: DVector::zeros(s.unknowns()), work: Vec::new() }
    }

    fn measure(&mut self, s: &Structure, jacobian: &DMatrix<f64>, weights: &[f64]) {
        self.scale = column_norms(s, jacobian, weights);
    }

    /// Factorises min |W·(J·δ + r)|, W diagonal; `false` where numbers are not finite.
    pub(super) fn reduce(
        &mut self,
        s: &Structure,
        jacobian: &DMatrix<f64>,
        residuals: &[f64],
        weights: &[f64],
    ) -> bool {
        self.measure(s, jacobian, weights);
        if !self.scale.iter().all(|x| x.is_finite()) {
            return false;
        }
        self.factor.root.fill(0.0);
        self.factor.heads.iter_mut().for_each(|h| h.fill(0.0));
        self.factor.add_weighted(s, jacobian, residuals, weights, &self.scale, &mut self.work);
        true
    }

    /// The step δ with √damping on the diagonal of the scaled problem, and the predicted decrease of |W·(J·δ + r)|².
    pub(super) fn step(&mut self, s: &Structure, damping: f64) -> Option<(DVector<f64>, f64)> {
        self.damped.copy_from(&self.factor);
        self.damped.add_diagonal(s, |_| damping.sqrt(), &mut self.work);
        let y = self.damped.solve(s)?;
        let predicted = 2.0 * damping * y.norm_squared() + self.factor.image_norm_squared(s, &y);
        Some((y.component_div(&self.scale), predicted))
    }
}

/// By how much the step to the minimum of |W·(J·δ + r)|² lowers it; `None` when the matrix is singular.
#[must_use]
pub(crate) fn predicted_decrease(
    s: &Structure,
    jacobian: &DMatrix<f64>,
    residuals: &[f64],
    weights: &[f64],
) -> Option<f64> {
    let mut reduced = Reduced::new(s);
    reduced.reduce(s, jacobian, residuals, weights).then_some(())?;
    reduced.step(s, 0.0).map(|(_, decrease)| decrease)
}

/// (JᵀJ + D²)⁻¹ of a whitened Jacobian, by orthogonal reduction on scaled columns; rows and columns as in a step.
///
/// `diagonal` is D: 1/σ of the prior of each unknown, 0 without one; empty without any prior.
/// `None` when the matrix is singular or numbers are not finite.
#[must_use]
pub(crate) fn covariance(s: &Structure, jacobian: &DMatrix<f64>, diagonal: &[f64]) -> Option<DMatrix<f64>> {
    let known = |i: usize| diagonal.get(i).copied().unwrap_or(0.0);
    let informed = jacobian.nrows() + diagonal.iter().filter(|d| **d != 0.0).count();
    let rows = jacobian.nrows();
    if informed < s.unknowns() || jacobian.ncols() != s.columns() || rows < s.rows_of_groups() {
        return None;
    }
    let mut reduced = Reduced::new(s);
    let mut work = Vec::new();
    if !reduced.reduce(s, jacobian, &vec![0.0; rows], &vec![1.0; rows]) {
        return None;
    }
    reduced.factor.add_diagonal(s, |i| known(i) / reduced.scale[i], &mut work);
    let mut c = reduced.factor.covariance(s)?;
    for (mut row, scale) in c.row_iter_mut().zip(&reduced.scale) {
        row /= *scale;
    }
    for (mut column, scale) in c.column_iter_mut().zip(&reduced.scale) {
        column /= *scale;
    }
    c.iter().all(|x| x.is_finite()).then_some(c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::{Rng, SeedableRng};

    const ROWS: [usize; 3] = [9, 14, 5];
    const S: Structure = Structure { shared: 4, width: 3, groups: &ROWS, more: 2 };

    /// A Jacobian with the block-arrow structure, the same as a dense matrix, and residuals; columns of very different lengths.
    fn problem(s: &Structure, seed: u64) -> (DMatrix<f64>, DMatrix<f64>, DVector<f64>) {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let rows = s.rows_of_groups() + 2;
        let mut thin = DMatrix::from_fn(rows, s.columns(), |_, c| {
            rng.random_range(-1.0..1.0) * 10f64.powi(2 * (c as i32 % 4) - 3)
        });
        let mut full = DMatrix::zeros(rows, s.unknowns());
        for (group, first, count) in s.parts(rows) {
            for i in first..first + count {
                full.view_mut((i, 0), (1, s.shared)).copy_from(&thin.view((i, s.width), (1, s.shared)));
                match group {
                    Some(g) => full
                        .view_mut((i, s.start(g)), (1, s.width))
                        .copy_from(&thin.view((i, 0), (1, s.width))),
                    // The content of the group's columns must not matter there.
                    None => thin.view_mut((i, 0), (1, s.width)).fill(7.0),
                }
            }
        }
        let residuals = DVector::from_fn(rows, |_, _| rng.random_range(-1.0..1.0));
        (thin, full, residuals)
    }

    #[test]
    fn step_and_covariance_are_those_of_the_full_problem() {
        let (thin, full, residuals) = problem(&S, 5);
        let rows = full.nrows();
        let weights: Vec<f64> = (0..rows).map(|i| 0.5 + (i % 3) as f64).collect();
        let w = DMatrix::from_diagonal(&DVector::from_vec(weights.clone()));
        let (j, r) = (&w * &full, &w * &residuals);
        for damping in [0.0, 1e-3, 10.0] {
            let mut reduced = Reduced::new(&S);
            assert!(reduced.reduce(&S, &thin, residuals.as_slice(), &weights));
            let (step, predicted) = reduced.step(&S, damping).unwrap();
            // The full problem with its damping, by singular values.
            let scale = DVector::from_fn(S.unknowns(), |c, _| j.column(c).norm());
            let mut a = j.clone().resize_vertically(rows + S.unknowns(), 0.0);
            let mut b = DVector::zeros(rows + S.unknowns());
            b.rows_mut(0, rows).copy_from(&-&r);
            for (c, s) in scale.iter().enumerate() {
                a.column_mut(c).unscale_mut(*s);
                a[(rows + c, c)] = f64::sqrt(damping);
            }
            let y = a.clone().svd(true, true).solve(&b, 0.0).unwrap();
            let expected = y.component_div(&scale);
            for (x, e) in step.iter().zip(&expected) {
                assert!((x / e - 1.0).abs() < 1e-9, "{damping}: {x} {e}");
            }
            let gain = r.norm_squared() - (&j * &expected + &r).norm_squared();
            assert!((predicted / gain - 1.0).abs() < 1e-9, "{predicted} {gain}");
        }
        let known: Vec<f64> = (0..S.unknowns()).map(|i| if i % 4 == 0 { 0.3 } else { 0.0 }).collect();
        for diagonal in [&known[..], &[]] {
            let mut information = full.transpose() * &full;
            diagonal.iter().enumerate().for_each(|(i, d)| information[(i, i)] += d * d);
            let scale = information.diagonal().map(f64::sqrt);
            let unit = DMatrix::from_diagonal(&scale.map(f64::recip));
            let expected = &unit * (&unit * information * &unit).try_inverse().unwrap() * &unit;
            let found = covariance(&S, &thin, diagonal).unwrap();
            for i in 0..S.unknowns() {
                for k in 0..S.unknowns() {
                    let size = (expected[(i, i)] * expected[(k, k)]).sqrt();
                    assert!((found[(i, k)] - expected[(i, k)]).abs() < 1e-9 * size, "{i} {k}");
                }
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn any_structure_gives_the_dense_solution(
            shared in 1_usize..6, width in 1_usize..5, surplus in prop::collection::vec(7_usize..12, 1..6),
            extra in 0_usize..5, seed: u64,
        ) {
            let groups: Vec<usize> = surplus.iter().map(|n| width + n - extra).collect();
            let s = Structure { shared, width, groups: &groups, more: extra };
            let (thin, full, residuals) = problem(&s, seed);
            let mut reduced = Reduced::new(&s);
            prop_assert!(reduced.reduce(&s, &thin, residuals.as_slice(), &vec![1.0; full.nrows()]));
            let (step, _) = reduced.step(&s, 0.0).unwrap();
            // In columns of unit length.
            let lengths = DVector::from_fn(s.unknowns(), |c, _| full.column(c).norm());
            let unit = &full * DMatrix::from_diagonal(&lengths.map(f64::recip));
            let expected = unit.clone().svd(true, true).solve(&-residuals, 0.0).unwrap();
            prop_assert!((step.component_mul(&lengths) - &expected).norm() < 1e-9 * (1.0 + expected.norm()));
            let expected = (unit.transpose() * &unit).try_inverse().unwrap();
            let scale = DMatrix::from_diagonal(&lengths);
            let found = &scale * covariance(&s, &thin, &[]).unwrap() * &scale;
            prop_assert!((&found - &expected).norm() < 1e-8 * expected.norm(), "{found} {expected}");
        }
    }

    #[test]
    fn covariance_of_badly_scaled_columns() {
        let dense = Structure::dense(2);
        let j = DMatrix::from_row_slice(3, 2, &[1e9, 0.0, 0.0, 1e-9, 0.0, 0.0]);
        let c = covariance(&dense, &j, &[]).unwrap();
        assert!((c[(0, 0)] * 1e18 - 1.0).abs() < 1e-12 && (c[(1, 1)] * 1e-18 - 1.0).abs() < 1e-12);
        assert!(covariance(&dense, &DMatrix::from_element(3, 2, f64::NAN), &[]).is_none());
        assert!(covariance(&dense, &DMatrix::zeros(1, 2), &[]).is_none());
        assert!(covariance(&dense, &DMatrix::zeros(3, 2), &[]).is_none());
        // A group without rows keeps its prior.
        let empty = Structure { shared: 1, width: 1, groups: &[0], more: 0 };
        let c = covariance(&empty, &DMatrix::from_element(1, 2, 2.0), &[0.0, 4.0]).unwrap();
        assert_eq!((c[(0, 0)], c[(1, 1)], c[(0, 1)]), (0.25, 0.0625, 0.0));
    }
}
