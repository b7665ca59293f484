//! The likelihood of the weights of a linear least-squares problem with the unknowns integrated out: with
//! χ²(δ) = |W·(J·δ + r)|² it is −(χ²_min + ln det JᵀW²J)/2 and a constant (plus ln det W, which is the caller's to count).

use nalgebra::{DMatrix, DVector};

use super::block_arrow_qr::{Factor, Structure, column_norms};

/// Rows reduced to a triangular factor, and the squares of their right-hand sides.
#[derive(Debug, Clone)]
pub(crate) struct MarginalLikelihood {
    factor: Factor,
    /// Units of the unknowns, the same in all that are compared or merged.
    scale: DVector<f64>,
    total: f64,
}

impl MarginalLikelihood {
    /// Of rows with weights; `None` where numbers are not finite.
    pub(crate) fn new(
        s: &Structure,
        jacobian: &DMatrix<f64>,
        residuals: &[f64],
        weights: &[f64],
    ) -> Option<Self> {
        let scale = column_norms(s, jacobian, &vec![1.0; residuals.len()]);
        Self::in_units(s, scale, jacobian, residuals, weights)
    }

    /// The same rows with other weights or of another Jacobian, in the units of this one.
    pub(crate) fn of(
        &self,
        s: &Structure,
        jacobian: &DMatrix<f64>,
        residuals: &[f64],
        weights: &[f64],
    ) -> Option<Self> {
        Self::in_units(s, self.scale.clone(), jacobian, residuals, weights)
    }

    fn in_units(
        s: &Structure,
        scale: DVector<f64>,
        jacobian: &DMatrix<f64>,
        residuals: &[f64],
        weights: &[f64],
    ) -> Option<Self> {
        let total = residuals.iter().zip(weights).map(|(r, w)| (r * w).powi(2)).sum::<f64>();
        if !(total.is_finite() && scale.iter().all(|x| x.is_finite())) {
            return None;
        }
        let mut factor = Factor::zeros(s);
        factor.add_weighted(s, jacobian, residuals, weights, &scale, &mut Vec::new());
        Some(Self { factor, scale, total })
    }

    /// Together with other rows in the same units, whose weights are multiplied by `weight`.
    pub(crate) fn with(&self, s: &Structure, other: &Self, weight: f64) -> Self {
        let mut both = self.clone();
        both.factor.add_factor(s, &other.factor, weight);
        both.total += other.total * weight * weight;
        both
    }

    /// With one row more for each own unknown of each group that `row` gives a coefficient and a residual for.
    pub(crate) fn with_own_rows(
        &self,
        s: &Structure,
        row: impl Fn(usize, usize) -> Option<(f64, f64)>,
    ) -> Self {
        let mut more = self.clone();
        let columns = s.columns() + 1;
        for group in 0..s.groups.len() {
            let own: Vec<(usize, f64, f64)> =
                (0..s.width).filter_map(|c| row(group, c).map(|(a, r)| (c, a, r))).collect();
            let count = own.len();
            let mut rows = vec![0.0; count * columns];
            for (i, (c, a, r)) in own.into_iter().enumerate() {
                rows[c * count + i] = a / self.scale[s.start(group) + c];
                rows[s.columns() * count + i] = r;
                more.total += r * r;
            }
            more.factor.add(Some(group), &mut rows, count);
        }
        more
    }

    /// ln of the likelihood up to a constant; `None` when the unknowns are not determined.
    pub(crate) fn ln(&self, s: &Structure) -> Option<f64> {
        let (mut determinant, mut explained) = (0.0, 0.0);
        for (factor, unknowns) in self.factor.triangles(s) {
            for i in 0..unknowns {
                determinant += factor[(i, i)].abs().ln();
                explained += factor[(i, factor.ncols() - 1)].powi(2);
            }
        }
        let value = -0.5 * (self.total - explained) - determinant;
        value.is_finite().then_some(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_likelihood_is_that_of_the_dense_problem() {
        let groups = [5, 4];
        let s = Structure { shared: 2, width: 2, groups: &groups, more: 0 };
        // Columns: two of the own group, two shared; every row some irregular numbers.
        let jacobian = DMatrix::from_fn(9, 4, |i, j| ((3 * i + 5 * j * j + i * j) as f64 * 0.7).sin());
        let residuals: Vec<f64> = (0..9).map(|i| (f64::from(i) * 1.3).cos()).collect();
        let weights: Vec<f64> = (0..9).map(|i| 0.5 + 0.2 * f64::from(i)).collect();
        let own = |view: usize, c: usize| (c == 1).then_some((2.0 + view as f64, 0.3));

        let mut full = DMatrix::zeros(11, 6);
        let mut right = DVector::zeros(11);
        for i in 0..9 {
            let group = usize::from(i >= 5);
            for c in 0..2 {
                full[(i, c)] = jacobian[(i, 2 + c)] * weights[i];
                full[(i, 2 + 2 * group + c)] = jacobian[(i, c)] * weights[i];
            }
            right[i] = residuals[i] * weights[i];
        }
        for view in 0..2 {
            full[(9 + view, 2 + 2 * view + 1)] = 2.0 + view as f64;
            right[9 + view] = 0.3;
        }
        let normal = full.transpose() * &full;
        let step = normal.clone().cholesky().unwrap().solve(&(full.transpose() * &right));
        let wanted = -0.5 * ((&right - &full * step).norm_squared() + normal.determinant().ln());
        let found = MarginalLikelihood::new(&s, &jacobian, &residuals, &weights).unwrap();
        let units: f64 = found.scale.iter().map(|x| x.ln()).sum();
        let ln = found.with_own_rows(&s, own).ln(&s).unwrap() - units;
        assert!((ln - wanted).abs() < 1e-9, "{ln} {wanted}");

        // In two parts.
        let part = |which: usize| -> Vec<f64> {
            weights.iter().enumerate().map(|(i, w)| if i % 2 == which { *w } else { 0.0 }).collect()
        };
        let odd = found.of(&s, &jacobian, &residuals, &part(1)).unwrap();
        let even = found.of(&s, &jacobian, &residuals, &part(0)).unwrap();
        let both = even.with(&s, &odd, 1.0).with_own_rows(&s, own).ln(&s).unwrap() - units;
        assert!((both - wanted).abs() < 1e-9, "{both} {wanted}");
    }
}
