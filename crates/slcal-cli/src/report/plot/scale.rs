//! From the values of an axis to places on the page.

/// Values and the places of the ends, which may run in either direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    values: [f64; 2],
    places: [f64; 2],
    logarithmic: bool,
}

impl Scale {
    pub(super) fn new(values: [f64; 2], places: [f64; 2], logarithmic: bool) -> Self {
        Self { values, places, logarithmic }
    }

    /// Where a value stands; values beyond the ends stand beyond them.
    pub(super) fn at(&self, value: f64) -> f64 {
        let [low, high, x] =
            [self.values[0], self.values[1], value].map(|x| if self.logarithmic { x.log10() } else { x });
        let share = (x - low) / (high - low);
        self.places[0] + share * (self.places[1] - self.places[0])
    }

    /// The lesser and the greater place of the ends.
    pub(super) fn reach(&self) -> [f64; 2] {
        let [a, b] = self.places;
        [a.min(b), a.max(b)]
    }

    /// Whether a value lies between the ends.
    pub(super) fn holds(&self, value: f64) -> bool {
        let [a, b] = self.values;
        (a.min(b)..=a.max(b)).contains(&value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_stand_at_their_places() {
        let up = Scale::new([0.0, 10.0], [300.0, 100.0], false);
        assert_eq!([0.0, 5.0, 10.0, 15.0].map(|x| up.at(x)), [300.0, 200.0, 100.0, 0.0]);
        assert_eq!(up.reach(), [100.0, 300.0]);
        let log = Scale::new([0.01, 100.0], [0.0, 400.0], true);
        assert!(
            [(0.01, 0.0), (1.0, 200.0), (100.0, 400.0)].iter().all(|(x, p)| (log.at(*x) - p).abs() < 1e-9)
        );
        let down = Scale::new([960.0, -96.0], [0.0, 1.0], false);
        assert_eq!([-97.0, -96.0, 0.0, 961.0].map(|x| down.holds(x)), [false, true, true, false]);
    }
}
