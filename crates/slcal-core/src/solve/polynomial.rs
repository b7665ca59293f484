//! Weighted least-squares polynomials in one variable.

use nalgebra::{DMatrix, DVector};

/// A polynomial in a scaled variable, so that it stays well conditioned over thousands of pixels.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Polynomial {
    centre: f64,
    scale: f64,
    coefficients: Vec<f64>,
}

impl Polynomial {
    /// The polynomial of the given degree nearest to samples (x, y, weight). `None` when the samples do not determine
    /// it or are not finite.
    #[must_use]
    pub(crate) fn fit(samples: &[(f64, f64, f64)], degree: usize) -> Option<Self> {
        let (low, high) =
            samples.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| (l.min(s.0), h.max(s.0)));
        let (centre, scale) = (f64::midpoint(low, high), (high - low) / 2.0);
        if !(scale.is_finite() && scale > 0.0) {
            return None;
        }
        let n = degree + 1;
        let (mut normal, mut right) = (DMatrix::zeros(n, n), DVector::zeros(n));
        for &(x, y, weight) in samples {
            let t = (x - centre) / scale;
            let powers = DVector::from_iterator(n, (0..n).map(|k| t.powi(k as i32)));
            normal.ger(weight, &powers, &powers, 1.0);
            right.axpy(weight * y, &powers, 1.0);
        }
        let coefficients = normal.cholesky()?.solve(&right);
        coefficients.iter().all(|c| c.is_finite()).then(|| Self {
            centre,
            scale,
            coefficients: coefficients.as_slice().to_vec(),
        })
    }

    /// The value at x.
    #[must_use]
    pub(crate) fn value(&self, x: f64) -> f64 {
        let t = (x - self.centre) / self.scale;
        self.coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fits_a_cubic_exactly_and_refuses_too_few_points() {
        let f = |x: f64| 1e-6 * x.powi(3) - 2e-3 * x * x + 0.7 * x + 40.0;
        let samples: Vec<_> = (0..50).map(|i| f64::from(i) * 80.0).map(|x| (x, f(x), 1.0 + x)).collect();
        let cubic = Polynomial::fit(&samples, 3).unwrap();
        assert!((cubic.value(1234.5) - f(1234.5)).abs() < 1e-7);
        assert!(Polynomial::fit(&samples[..1], 1).is_none());
        assert!(Polynomial::fit(&samples[..3], 3).is_none_or(|p| p.value(0.0).is_finite()));
        assert!(Polynomial::fit(&[], 0).is_none());
    }
}
