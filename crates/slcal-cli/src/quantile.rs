//! Quantiles.

/// Finite values in ascending order.
pub(crate) struct Sorted(Vec<f64>);

impl Sorted {
    pub(crate) fn new(values: impl IntoIterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.into_iter().filter(|x| x.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        Self(sorted)
    }

    /// The value that this share of all values lies below; `None` without values.
    pub(crate) fn at(&self, share: f64) -> Option<f64> {
        let last = self.0.len().checked_sub(1)?;
        self.0.get(((share * self.0.len() as f64) as usize).min(last)).copied()
    }

    /// The range between two such shares; zeros without values.
    pub(crate) fn range(&self, [low, high]: [f64; 2]) -> [f64; 2] {
        [self.at(low), self.at(high)].map(Option::unwrap_or_default)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_and_skip_what_is_not_finite() {
        let sorted = Sorted::new([3.0, f64::NAN, 1.0, 2.0, f64::INFINITY, 4.0]);
        assert_eq!([0.0, 0.5, 0.9, 1.0].map(|s| sorted.at(s)), [1.0, 3.0, 4.0, 4.0].map(Some));
        assert_eq!(sorted.range([0.1, 0.3]), [1.0, 2.0]);
        assert_eq!((Sorted::new([]).at(0.5), Sorted::new([]).range([0.0, 1.0])), (None, [0.0; 2]));
    }
}
