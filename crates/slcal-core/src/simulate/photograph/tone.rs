//! The tone curve of cameras: more contrast in the middle, less in the darks and the lights.

/// The value (0–1) of an encoded value `v` (0–1) under an S-shaped curve of `strength` 0 (none) to 1:
/// v + strength · (3 v² − 2 v³ − v). Black, middle and white stay; the slope is 1 + strength / 2 in the middle and
/// 1 − strength at both ends.
pub(super) fn curved(v: f64, strength: f64) -> f64 {
    v + strength * (v * v * (3.0 - 2.0 * v) - v)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_is_an_s_with_the_stated_slopes() {
        for strength in [0.0, 0.25, 1.0] {
            for fixed in [0.0, 0.5, 1.0] {
                assert_eq!(curved(fixed, strength), fixed);
            }
            let slope = |v: f64| (curved(v + 1e-6, strength) - curved(v - 1e-6, strength)) / 2e-6;
            for (v, expected) in [(0.0, 1.0 - strength), (0.5, 1.0 + strength / 2.0), (1.0, 1.0 - strength)] {
                assert!((slope(v) - expected).abs() < 1e-5, "{v} {strength}");
            }
            // It never falls, and is the same upside down.
            let values: Vec<f64> = (0..=100).map(|i| curved(f64::from(i) / 100.0, strength)).collect();
            assert!(values.windows(2).all(|w| w[1] >= w[0]));
            assert!(values.iter().zip(values.iter().rev()).all(|(a, b)| (a + b - 1.0).abs() < 1e-12));
        }
        assert_eq!(curved(0.3, 0.0), 0.3);
    }
}
