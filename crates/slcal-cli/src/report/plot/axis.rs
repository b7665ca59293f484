//! An axis: what it shows and from where to where.

use super::scale::Scale;
use super::ticks::{self, Tick};

/// Room for labels, in units of the plot.
const PER_LABEL_ACROSS: f64 = 48.0;
const PER_LABEL_UP: f64 = 38.0;

/// An axis from the first value of its range to the second, which may be the lesser.
#[derive(Debug, Clone)]
pub(crate) struct Axis {
    pub(super) title: String,
    pub(super) range: [f64; 2],
    logarithmic: bool,
}

impl Axis {
    /// Evenly divided. A range without width is widened.
    pub(crate) fn even(title: impl Into<String>, [first, last]: [f64; 2]) -> Self {
        let sound = (last - first).is_finite() && first != last;
        let first = if first.is_finite() { first } else { 0.0 };
        let half = 0.5 * first.abs().max(1.0);
        let range = if sound { [first, last] } else { [first - half, first + half] };
        Self { title: title.into(), range, logarithmic: false }
    }

    /// From zero to a little above a value.
    pub(crate) fn from_zero(title: impl Into<String>, highest: f64) -> Self {
        Self::even(title, [0.0, if highest > 0.0 { 1.05 * highest } else { 1.0 }])
    }

    /// Logarithmic around positive values.
    pub(crate) fn logarithmic(title: impl Into<String>, values: impl IntoIterator<Item = f64>) -> Self {
        /// Room at the ends.
        const ROOM: f64 = 1.15;
        let positive = values.into_iter().filter(|x| *x > 0.0 && x.is_finite());
        let (low, high) = positive.fold((f64::INFINITY, 0.0_f64), |(l, h), x| (l.min(x), h.max(x)));
        let range = if low <= high { [low / ROOM, high * ROOM] } else { [0.1, 10.0] };
        Self { title: title.into(), range, logarithmic: true }
    }

    /// Its scale between two places.
    pub(super) fn between(&self, places: [f64; 2]) -> Scale {
        Scale::new(self.range, places, self.logarithmic)
    }

    /// Its ticks where it is so many units wide.
    pub(super) fn ticks_across(&self, wide: f64) -> Vec<Tick> {
        self.ticks((wide / PER_LABEL_ACROSS) as usize)
    }

    /// Its ticks where it is so many units high.
    pub(super) fn ticks_up(&self, high: f64) -> Vec<Tick> {
        self.ticks((high / PER_LABEL_UP) as usize)
    }

    fn ticks(&self, most: usize) -> Vec<Tick> {
        let [a, b] = self.range;
        let range = [a.min(b), a.max(b)];
        if self.logarithmic { ticks::logarithmic(range) } else { ticks::even(range, most.max(2)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_axis_has_a_width() {
        assert_eq!(Axis::even("", [5.0, 5.0]).range, [2.5, 7.5]);
        assert_eq!(Axis::even("", [f64::NAN, 1.0]).range, [-0.5, 0.5]);
        assert_eq!(Axis::even("", [960.0, -96.0]).range, [960.0, -96.0]);
        assert_eq!(Axis::from_zero("", 0.0).range, [0.0, 1.0]);
        assert_eq!(Axis::logarithmic("", [f64::NAN, 0.0]).range, [0.1, 10.0]);
        let [low, high] = Axis::logarithmic("", [3.0]).range;
        assert!(low < 3.0 && 3.0 < high);
    }
}
