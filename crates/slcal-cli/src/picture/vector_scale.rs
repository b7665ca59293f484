//! The enlargement of small vectors, and its scale bar.

use super::drawing::legend::{Legend, Swatch};
use super::drawing::{Drawing, Pen};
use crate::quantile::Sorted;

/// Length that long vectors are drawn with in photographs, units.
pub(crate) const SHOWN: f64 = 24.0;
/// The quantile of lengths that counts as long.
const LONGER_ONES: f64 = 0.9;
/// A larger factor would show rounding errors.
const MOST: f64 = 1e5;
/// Length of the scale bar, units, before it is rounded.
const BAR: f64 = 40.0;

/// The enlargement of vectors (px of the photograph) at which the long ones become `shown`: a round number, never below 1.
pub(crate) fn factor(lengths_px: impl IntoIterator<Item = f64>, shown: f64) -> f64 {
    let lengths = Sorted::new(lengths_px.into_iter().filter(|l| *l > 0.0));
    let Some(length) = lengths.at(LONGER_ONES) else { return 1.0 };
    round_down(shown / length).clamp(1.0, MOST)
}

/// The number 1, 2 or 5 times a power of ten that is no larger.
pub(crate) fn round_down(x: f64) -> f64 {
    if !(x.is_finite() && x > 0.0) {
        return 1.0;
    }
    let power = 10f64.powi(x.log10().floor() as i32);
    // A hair of room for what rounding does to the logarithm.
    [10.0, 5.0, 2.0].into_iter().map(|n| n * power).find(|n| *n <= x * (1.0 + 1e-12)).unwrap_or(power)
}

/// The number 1, 2 or 5 times a power of ten that is no smaller; 1 for what is no length.
pub(crate) fn round_up(x: f64) -> f64 {
    if !(x.is_finite() && x > 0.0) {
        return 1.0;
    }
    let power = 10f64.powi(x.log10().floor() as i32);
    [1.0, 2.0, 5.0].into_iter().map(|n| n * power).find(|n| *n >= x * (1.0 - 1e-12)).unwrap_or(10.0 * power)
}

/// A legend with an arrow that means `what`, its enlargement, and the scale bar.
pub(crate) fn explained(legend: Legend, drawing: &Drawing, factor: f64, pen: Pen, what: &str) -> Legend {
    let enlarged = if factor > 1.0 { format!(", enlarged ×{}", plain(factor)) } else { String::new() };
    let length = round_down(BAR * drawing.unit() / factor * 1.3);
    legend
        .entry(Swatch::Arrow(pen), format!("{what}{enlarged}"))
        .entry(Swatch::Bar(pen, length * factor), format!("{} px in the photograph", plain(length)))
}

/// A length with two significant digits.
pub(crate) fn two_digits(x: f64) -> String {
    let decimals = if x > 0.0 { (1.0 - x.log10().floor()).clamp(0.0, 6.0) as usize } else { 0 };
    format!("{x:.decimals$}")
}

/// A round number in plain decimals.
pub(crate) fn plain(x: f64) -> String {
    let decimals = if x >= 1.0 || x <= 0.0 { 0 } else { (-x.log10().floor()).clamp(0.0, 9.0) as usize };
    format!("{x:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_is_round_and_makes_the_vectors_seen() {
        for (length, expected) in [(0.05, 200.0), (0.11, 200.0), (0.13, 100.0), (24.0, 1.0), (900.0, 1.0)] {
            assert_eq!(factor([length; 20], SHOWN), expected, "{length}");
        }
        // A lone outlier does not shrink the others.
        assert_eq!(factor([0.05; 19].into_iter().chain([50.0]), SHOWN), 200.0);
        assert_eq!(factor([], SHOWN), 1.0);
        assert_eq!(factor([f64::NAN, 0.0, f64::INFINITY], SHOWN), 1.0);
        assert_eq!(factor([1e-300], SHOWN), MOST);
    }

    #[test]
    fn lengths_are_rounded_to_round_ones() {
        for (x, expected) in [(1234.0, 1000.0), (0.5, 0.5), (4.999, 2.0), (5.0, 5.0), (20.0, 20.0)] {
            assert!((round_down(x) / expected - 1.0).abs() < 1e-9, "{x}: {}", round_down(x));
        }
        let rounded = [0.011, 0.02, 0.021, 0.3, 7.0, 1000.0, f64::NAN, 0.0].map(round_up);
        for (found, expected) in rounded.into_iter().zip([0.02, 0.02, 0.05, 0.5, 10.0, 1000.0, 1.0, 1.0]) {
            assert!((found - expected).abs() < 1e-9 * expected, "{found} {expected}");
        }
    }

    #[test]
    fn the_bar_is_as_long_as_its_words_say() {
        let drawing = Drawing::new([1800, 1200], "");
        for factor in [1.0, 2.0, 50.0, 500.0, 1e5] {
            let legend = explained(Legend::default(), &drawing, factor, Pen::new([255; 3]), "");
            let (bar, words) = (&legend.entries[1].swatch, &legend.entries[1].text);
            let Swatch::Bar(_, length) = bar else { panic!("{bar:?}") };
            let said: f64 = words.trim_end_matches(" px in the photograph").parse().unwrap();
            assert!((said * factor - length).abs() < 1e-9 * length, "{words} {length}");
            assert!((20.0..=60.0).contains(&(length / drawing.unit())), "{words} {length}");
        }
    }
}
