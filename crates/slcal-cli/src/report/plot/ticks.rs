//! Round values along an axis, and how they are written.

use super::super::number::{fixed, significant};
use crate::picture::vector_scale::round_up;

/// A value with a line of the grid and a label.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    pub(super) value: f64,
    pub(super) label: String,
}

/// Multiples of 1, 2 or 5 times a power of ten within a range, about as many as `most` or fewer.
pub(super) fn even([low, high]: [f64; 2], most: usize) -> Vec<Tick> {
    let wide = high - low;
    if !(wide.is_finite() && wide > 0.0) {
        return Vec::new();
    }
    let step = round_up(wide / most.max(1) as f64);
    // A hair beyond the ends, for what rounding does to them.
    let hair = 1e-9 * wide;
    let (first, last) = (((low - hair) / step).ceil(), ((high + hair) / step).floor());
    // Far from zero a narrow range has no values between its ends.
    let count = (last - first).clamp(0.0, 2.0 * most as f64) as usize;
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    (0..=count)
        .map(|i| {
            let value = (first + i as f64) * step;
            let readable = decimals <= 6 && value.abs() < 1e7;
            Tick { value, label: if readable { fixed(value, decimals) } else { significant(value, 3) } }
        })
        .collect()
}

/// 1, 2 and 5 times powers of ten within a positive range; over many decades the powers alone.
pub(super) fn logarithmic([low, high]: [f64; 2]) -> Vec<Tick> {
    /// Decades with three labels each.
    const FEW: f64 = 3.5;
    if !(low > 0.0 && high.is_finite() && low < high) {
        return Vec::new();
    }
    let digits: &[f64] = if (high / low).log10() > FEW { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let powers = low.log10().floor() as i32..=high.log10().floor() as i32;
    powers
        .flat_map(|p| digits.iter().map(move |d| d * 10f64.powi(p)))
        .filter(|x| (low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(x))
        .map(|value| Tick { value, label: significant(value, 1) })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(ticks: &[Tick]) -> Vec<&str> {
        ticks.iter().map(|t| t.label.as_str()).collect()
    }

    #[test]
    fn steps_are_round_and_labels_have_the_digits_they_need() {
        assert_eq!(labels(&even([0.0, 1280.0], 6)), ["0", "500", "1000"]);
        assert_eq!(labels(&even([-5.0, 5.0], 6)), ["\u{2212}4", "\u{2212}2", "0", "2", "4"]);
        assert_eq!(labels(&even([0.0, 0.3], 4)), ["0.0", "0.1", "0.2", "0.3"]);
        assert_eq!(labels(&even([99.98, 100.02], 4)), ["99.98", "99.99", "100.00", "100.01", "100.02"]);
        assert_eq!(even([0.1, 0.7], 6).len(), 7);
        assert_eq!(labels(&even([0.0, 3e8], 3)), ["0", "100000000", "200000000", "300000000"]);
    }

    #[test]
    fn ranges_without_width_have_no_ticks() {
        for range in [[1.0, 1.0], [2.0, 1.0], [f64::NAN, 1.0], [0.0, f64::INFINITY]] {
            assert!(even(range, 5).is_empty() && logarithmic(range).is_empty(), "{range:?}");
        }
        assert!(logarithmic([-1.0, 10.0]).is_empty());
        // Numbers this large are further apart than a step.
        assert!(even([1e300, 1.000_000_000_000_001e300], 5).len() <= 11);
    }

    #[test]
    fn logarithmic_ticks_are_fewer_over_many_decades() {
        assert_eq!(labels(&logarithmic([0.1, 50.0])), ["0.1", "0.2", "0.5", "1", "2", "5", "10", "20", "50"]);
        assert_eq!(labels(&logarithmic([0.01, 200.0])), ["0.01", "0.1", "1", "10", "100"]);
    }
}
