//! What of a line lies in the picture.

use nalgebra::Point2;

/// A rectangle, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rect {
    pub(crate) low: Point2<f64>,
    pub(crate) high: Point2<f64>,
}

impl Rect {
    pub(crate) fn holds(&self, p: Point2<f64>) -> bool {
        (0..2).all(|k| (self.low[k]..=self.high[k]).contains(&p[k]))
    }

    pub(crate) fn grown(&self, by: f64) -> Self {
        let by = nalgebra::Vector2::new(by, by);
        Self { low: self.low - by, high: self.high + by }
    }

    /// The point of the rectangle that is nearest to one that is finite.
    pub(crate) fn nearest(&self, p: Point2<f64>) -> Point2<f64> {
        // Not `clamp`, which does not allow for a rectangle that has shrunk to less than nothing.
        let inside = |k: usize| p[k].max(self.low[k]).min(self.high[k].max(self.low[k]));
        Point2::new(inside(0), inside(1))
    }

    /// The part of a segment within the rectangle (L.-D. Liang, B. Barsky 1984).
    pub(crate) fn segment(&self, from: Point2<f64>, to: Point2<f64>) -> Option<[Point2<f64>; 2]> {
        let direction = to - from;
        if !direction.iter().all(|d| d.is_finite()) {
            return None;
        }
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for axis in 0..2 {
            let (d, p) = (direction[axis], from[axis]);
            if d == 0.0 {
                if !(self.low[axis]..=self.high[axis]).contains(&p) {
                    return None;
                }
            } else {
                let (a, b) = ((self.low[axis] - p) / d, (self.high[axis] - p) / d);
                enter = enter.max(a.min(b));
                leave = leave.min(a.max(b));
            }
        }
        // The ends themselves where they lie inside: no rounding.
        let start = if enter <= 0.0 { from } else { from + direction * enter };
        let end = if leave >= 1.0 { to } else { from + direction * leave };
        (enter <= leave).then_some([start, end])
    }

    /// The parts of a line through points that lie within the rectangle; it breaks at points that are not finite.
    pub(crate) fn polyline(&self, points: &[Point2<f64>]) -> Vec<Vec<Point2<f64>>> {
        let mut parts: Vec<Vec<Point2<f64>>> = Vec::new();
        for pair in points.windows(2) {
            let Some([from, to]) = self.segment(pair[0], pair[1]) else { continue };
            match parts.last_mut() {
                Some(part) if part.last() == Some(&from) => part.push(to),
                _ => parts.push(vec![from, to]),
            }
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Rect = Rect { low: Point2::new(0.0, 0.0), high: Point2::new(40.0, 30.0) };

    #[test]
    fn a_segment_is_cut_at_the_frame() {
        let cut = FRAME.segment(Point2::new(-100.0, 15.0), Point2::new(100.0, 15.0));
        assert_eq!(cut, Some([Point2::new(0.0, 15.0), Point2::new(40.0, 15.0)]));
        assert_eq!(FRAME.segment(Point2::new(-5.0, -1.0), Point2::new(60.0, -1.0)), None);
        assert_eq!(FRAME.segment(Point2::new(-5.0, 28.0), Point2::new(20.0, 60.0)), None);
        let inside = [Point2::new(0.1, 0.2), Point2::new(0.3, 29.7)];
        assert_eq!(FRAME.segment(inside[0], inside[1]), Some(inside));
    }

    #[test]
    fn points_far_away_and_not_finite_only_break_the_line() {
        let line = [
            [5.0, 5.0],
            [10.0, 5.0],
            [1e300, 5.0],
            [f64::NAN, 1.0],
            [3.0, f64::INFINITY],
            [5.0, 20.0],
            [8.0, 20.0],
        ];
        let parts = FRAME.polyline(&line.map(Point2::from));
        assert_eq!(parts.len(), 2);
        assert_eq!(parts[0][..2], [Point2::new(5.0, 5.0), Point2::new(10.0, 5.0)]);
        assert!((parts[0][2].x - 40.0).abs() < 1e-6, "{parts:?}");
        assert_eq!(parts[1], [Point2::new(5.0, 20.0), Point2::new(8.0, 20.0)]);
        assert!(FRAME.polyline(&[]).is_empty() && FRAME.polyline(&[Point2::new(1.0, 1.0)]).is_empty());
    }
}
