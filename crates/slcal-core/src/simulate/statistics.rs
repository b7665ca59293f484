//! Statistics of values and errors.

use serde::Serialize;

use crate::solve::median;

/// Statistics of non-negative errors (distances, rms). All `None` without a value.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Statistics {
    /// Mean.
    pub mean: Option<f64>,
    /// Standard deviation, with n − 1; `None` for fewer than two values.
    pub std: Option<f64>,
    /// Median (of an even number the larger of the middle two), which is robust to outliers.
    pub median: Option<f64>,
}

/// Statistics of signed errors of a known quantity.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct ErrorStatistics {
    /// Mean error (of a vector: the length of the mean).
    pub bias: Option<f64>,
    /// Standard deviation about the mean, with n − 1 (of a vector: over all components together).
    pub std: Option<f64>,
    /// Root mean square error.
    pub rms: Option<f64>,
    /// Median of the absolute error, which is robust to outliers.
    pub median: Option<f64>,
}

/// Coverage: the share of rigs whose ±1.96 σ contains the truth, among the rigs that have this σ; 0.95 where σ is
/// right. `None` without such a rig.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Coverage {
    /// Focal length of the camera.
    pub camera_focal: Option<f64>,
    /// Focal length of the projector.
    pub projector_focal: Option<f64>,
    /// Distance between camera and projector.
    pub baseline: Option<f64>,
}

/// Half a 95 % interval of a normal distribution, in σ.
const HALF_INTERVAL: f64 = 1.959_963_984_540_054;

/// The share of errors, each with its own σ (positive), that lie within their 95 % interval.
pub(super) fn coverage(errors: &[(f64, f64)]) -> Option<f64> {
    let within = errors.iter().filter(|(error, sigma)| error.abs() <= HALF_INTERVAL * sigma).count();
    (!errors.is_empty()).then(|| within as f64 / errors.len() as f64)
}

impl Statistics {
    /// Of `values`; those that are not finite are left out.
    #[must_use]
    pub fn of(values: &[f64]) -> Self {
        let mut finite: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
        let n = finite.len() as f64;
        if finite.is_empty() {
            return Self::default();
        }
        let mean = finite.iter().sum::<f64>() / n;
        let squares: f64 = finite.iter().map(|x| (x - mean).powi(2)).sum();
        Self {
            mean: Some(mean),
            std: (finite.len() > 1).then(|| (squares / (n - 1.0)).sqrt()),
            median: median(&mut finite),
        }
    }
}

impl ErrorStatistics {
    /// Of errors with `N` components each.
    #[must_use]
    pub fn of<const N: usize>(errors: &[[f64; N]]) -> Self {
        let finite: Vec<&[f64; N]> = errors.iter().filter(|e| e.iter().all(|x| x.is_finite())).collect();
        let n = finite.len() as f64;
        if finite.is_empty() {
            return Self::default();
        }
        let mean: [f64; N] = std::array::from_fn(|i| finite.iter().map(|e| e[i]).sum::<f64>() / n);
        let length = |e: &[f64; N]| e.iter().map(|x| x * x).sum::<f64>().sqrt();
        let squares: f64 =
            finite.iter().map(|e| e.iter().zip(&mean).map(|(x, m)| (x - m).powi(2)).sum::<f64>()).sum();
        let bias = if N == 1 { mean.iter().sum() } else { length(&mean) };
        Self {
            bias: Some(bias),
            std: (finite.len() > 1).then(|| (squares / (n - 1.0)).sqrt()),
            rms: Some((finite.iter().map(|e| length(e).powi(2)).sum::<f64>() / n).sqrt()),
            median: median(&mut finite.into_iter().map(length).collect::<Vec<_>>()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_match_closed_values() {
        let s = Statistics::of(&[1.0, 2.0, 6.0, f64::NAN]);
        assert_eq!((s.mean, s.median), (Some(3.0), Some(2.0)));
        assert!((s.std.unwrap() - 7.0_f64.sqrt()).abs() < 1e-15);
        let e = ErrorStatistics::of(&[[3.0, 4.0], [-3.0, 4.0]]);
        assert_eq!((e.bias, e.rms, e.median), (Some(4.0), Some(5.0), Some(5.0)));
        assert_eq!(e.std, Some(18.0_f64.sqrt()));
        assert_eq!(ErrorStatistics::of(&[[-2.0]]).bias, Some(-2.0));
    }

    #[test]
    fn coverage_counts_errors_within_their_interval() {
        assert_eq!(coverage(&[(1.9, 1.0), (-1.9, 1.0), (2.0, 1.0), (-3.9, 2.0)]), Some(0.75));
        assert_eq!(coverage(&[]), None);
    }

    #[test]
    fn statistics_without_values_are_none() {
        assert_eq!(Statistics::of(&[f64::INFINITY]), Statistics::default());
        assert_eq!(ErrorStatistics::of::<1>(&[]), ErrorStatistics::default());
        assert_eq!(Statistics::of(&[1.0]).std, None);
    }
}
