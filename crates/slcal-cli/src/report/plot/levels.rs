//! Round levels over a field of values, and a colour for each step between them.

use super::super::number::fixed;
use crate::picture::ramp;
use crate::picture::vector_scale::round_up;
use crate::quantile::Sorted;

/// About so many steps.
const STEPS: f64 = 9.0;
/// Few high values share the last step, so that the others differ in colour.
const NEARLY_ALL: f64 = 0.97;

/// Levels at equal distances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Levels {
    first: f64,
    step: f64,
    pub(super) steps: usize,
}

impl Levels {
    /// Round ones over nearly all values.
    pub(crate) fn over(values: impl IntoIterator<Item = f64>) -> Self {
        let all = Sorted::new(values);
        let (Some(low), Some(high)) = (all.at(0.0), all.at(NEARLY_ALL)) else {
            return Self { first: 0.0, step: 1.0, steps: 1 };
        };
        let step = round_up(0.999 * ((high - low) / STEPS).max(high.abs() * 1e-3).max(1e-9));
        let first = (low / step).floor();
        let steps = ((high / step).ceil() - first).clamp(1.0, 2.0 * STEPS);
        Self { first: first * step, step, steps: steps as usize }
    }

    /// The lower end of step `i`.
    pub(super) fn at(&self, i: usize) -> f64 {
        self.first + i as f64 * self.step
    }

    pub(super) fn label(&self, i: usize) -> String {
        fixed(self.at(i), (-self.step.log10().floor()).clamp(0.0, 9.0) as usize)
    }

    /// The colour of step `i`: light for low values, dark for high ones.
    pub(super) fn colour(&self, i: usize) -> String {
        let share = i as f64 / (self.steps - 1).max(1) as f64;
        let [r, g, b] = ramp(1.0 - share);
        format!("#{r:02x}{g:02x}{b:02x}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_round_and_reach_over_nearly_all_values() {
        let levels = Levels::over((0..1000).map(|i| 0.03 + 0.001 * f64::from(i)));
        assert_eq!((levels.label(0), levels.label(1), levels.steps), ("0.0".into(), "0.2".into(), 5));
        assert_ne!(levels.colour(0), levels.colour(4));
        // One value, and none.
        let one = Levels::over([5.0]);
        assert!(one.steps >= 1 && one.at(0) <= 5.0 && 5.0 <= one.at(one.steps), "{one:?}");
        assert_eq!(Levels::over([f64::NAN]).steps, 1);
    }
}
