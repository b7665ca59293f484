//! erf and its slope by cubic interpolation in a table: the corner model evaluates them millions of times.

use std::f64::consts::FRAC_2_SQRT_PI;

/// Steps per unit.
const STEPS: usize = 32;
/// erf(x) differs from one by less than 1e-9 beyond this.
const END: usize = 4;

/// erf at multiples of 1/[`STEPS`] from zero, with the slope there times the step.
#[derive(Debug, Clone)]
pub(super) struct ErfTable(Vec<[f64; 2]>);

impl ErfTable {
    pub(super) fn new() -> Self {
        let entry = |i: usize| {
            let x = i as f64 / STEPS as f64;
            [libm::erf(x), FRAC_2_SQRT_PI * (-x * x).exp() / STEPS as f64]
        };
        Self((0..=STEPS * END + 1).map(entry).collect())
    }

    /// (erf(x), d erf / dx), to 1e-8 and 1e-6.
    #[inline]
    pub(super) fn at(&self, x: f64) -> (f64, f64) {
        let s = x.abs() * STEPS as f64;
        let i = s as usize;
        // A NaN has index 0 and remains NaN.
        let Some(&[[f0, d0], [f1, d1]]) = self.0.get(i..).and_then(<[_]>::first_chunk::<2>) else {
            return (x.signum(), 0.0);
        };
        let t = s - i as f64;
        let rise = f1 - f0;
        let (c, e) = (3.0 * rise - 2.0 * d0 - d1, d0 + d1 - 2.0 * rise);
        let value = f0 + t * (d0 + t * (c + t * e));
        let slope = (d0 + t * (2.0 * c + 3.0 * t * e)) * STEPS as f64;
        (value.copysign(x), slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn follows_erf_and_its_slope_on_both_sides_and_far_out() {
        let table = ErfTable::new();
        for k in -6000..=6000 {
            let x = f64::from(k) * 0.001_03;
            let (value, slope) = table.at(x);
            assert!((value - libm::erf(x)).abs() < 3e-8, "{x}: {value}");
            assert!((slope - FRAC_2_SQRT_PI * (-x * x).exp()).abs() < 3e-6, "{x}: {slope}");
        }
        assert_eq!(table.at(f64::INFINITY).0, 1.0);
        assert!(table.at(f64::NAN).0.is_nan());
    }
}
