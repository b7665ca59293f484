//! Losses that bound the influence of outliers, as weights for iteratively reweighted least squares.

/// The cost of a residual block of whitened norm r.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Loss {
    /// r²: no robustness.
    Square,
    /// Huber: quadratic up to the cutoff, linear beyond. Convex, for a start that may be far from the minimum.
    Huber(f64),
    /// Tukey's biweight: redescending, constant beyond the cutoff, for one-sided contamination.
    Tukey(f64),
}

impl Loss {
    /// Twice the negative log-likelihood of a block with squared norm `s`.
    #[must_use]
    pub(crate) fn cost(self, s: f64) -> f64 {
        match self {
            Self::Square => s,
            Self::Huber(c) if s <= c * c => s,
            Self::Huber(c) => 2.0 * c * s.sqrt() - c * c,
            Self::Tukey(c) => {
                let inside = (1.0 - s / (c * c)).max(0.0);
                c * c / 3.0 * (1.0 - inside.powi(3))
            }
        }
    }

    /// d cost / d s: the weight of the block's squares.
    #[must_use]
    pub(crate) fn weight(self, s: f64) -> f64 {
        match self {
            Self::Square => 1.0,
            Self::Huber(c) => (c / s.sqrt()).min(1.0),
            Self::Tukey(c) => (1.0 - s / (c * c)).max(0.0).powi(2),
        }
    }
}

/// The standard deviation of normal numbers from the median of their absolute values; 0 for none.
#[must_use]
pub(crate) fn robust_scale(absolute: impl Iterator<Item = f64>) -> f64 {
    /// 1 / Φ⁻¹(3/4).
    const MAD_TO_SIGMA: f64 = 1.482_602_218_505_602;
    median(&mut absolute.collect::<Vec<_>>()).map_or(0.0, |m| m * MAD_TO_SIGMA)
}

/// Root mean square; `None` for nothing.
#[must_use]
pub(crate) fn rms(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, n) = values.fold((0.0, 0), |(s, n), v| (s + v * v, n + 1));
    (n > 0).then(|| (sum / f64::from(n)).sqrt())
}

/// The median, for an even number the larger of the middle two; `None` without values. Reorders the values.
#[must_use]
pub(crate) fn median(values: &mut [f64]) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// [`median`] of single precision, in which pixels are measured.
#[must_use]
pub(crate) fn median_f32(values: &mut [f32]) -> Option<f32> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f32::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_the_derivatives_of_costs() {
        for loss in [Loss::Square, Loss::Huber(2.0), Loss::Tukey(3.0)] {
            for s in [0.5, 3.9, 4.1, 8.0, 20.0] {
                let h = 1e-6;
                let slope = (loss.cost(s + h) - loss.cost(s - h)) / (2.0 * h);
                assert!((slope - loss.weight(s)).abs() < 1e-8, "{loss:?} at {s}");
            }
        }
        assert_eq!(Loss::Tukey(3.0).weight(10.0), 0.0);
    }

    #[test]
    fn the_median_is_a_value_of_the_list() {
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&mut [4.0, 1.0, 3.0, 2.0]), Some(3.0));
        assert_eq!(median(&mut []), None);
    }

    #[test]
    fn scale_ignores_a_minority_of_outliers() {
        let values = (1..=1000).map(|i| if i % 3 == 0 { 1e9 } else { 0.0 });
        assert_eq!(robust_scale(values), 0.0);
        assert_eq!(robust_scale(std::iter::empty()), 0.0);
    }
}
