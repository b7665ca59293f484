//! The border of the light: a straight line through the ends of many slits, parallel to the panel's.

use crate::solve::median;

/// Fewer ends make no line.
const FEWEST: usize = 12;
/// At least this share of all slits ends on it.
const SHARE: f64 = 0.6;
/// It spans at least this share of the panel.
const SPAN: f64 = 0.5;
/// It rises or falls by at most this (0.3°). The edge of an object follows the panel's rows that closely in one photograph
/// of many, even where projector and object both stand upright.
const PARALLEL: f64 = 0.005;
/// Ends on a line scatter by this many scanlines.
const SCATTER_LINES: f64 = 3.0;

/// An end of a slit.
#[derive(Debug, Clone, Copy)]
pub(super) struct BorderPoint {
    /// The slit's coordinate, px.
    pub(super) coordinate: f64,
    /// Position along the slit, px.
    pub(super) at: f64,
    /// Positions per scanline, px.
    pub(super) step: f64,
}

impl BorderPoint {
    fn is_on(&self, line: f64) -> bool {
        (self.at - line).abs() <= SCATTER_LINES * self.step
    }
}

/// The position of the border, px, among ends in the order of their coordinates. `None` where they lie on no such line.
pub(super) fn border_at(
    points: &[BorderPoint],
    slits: usize,
    panel_px: f64,
    buffer: &mut Vec<f64>,
) -> Option<f64> {
    let n = points.len();
    if n < FEWEST || points[n - 1].coordinate - points[0].coordinate < SPAN * panel_px {
        return None;
    }
    let mut middle = |points: &[BorderPoint], what: fn(&BorderPoint) -> f64| {
        buffer.clear();
        buffer.extend(points.iter().map(what));
        median(buffer)
    };
    let (left, right) = (&points[..n / 2], &points[n - n / 2..]);
    let rise = middle(right, |p| p.at)? - middle(left, |p| p.at)?;
    let run = middle(right, |p| p.coordinate)? - middle(left, |p| p.coordinate)?;
    let at = middle(points, |p| p.at)?;
    let on = points.iter().filter(|p| p.is_on(at + rise / run * (p.coordinate - centre(points)))).count();
    (rise.abs() <= PARALLEL * run && on as f64 >= SHARE * slits as f64).then_some(at)
}

/// Between the outermost coordinates.
fn centre(points: &[BorderPoint]) -> f64 {
    points.first().zip(points.last()).map_or(0.0, |(a, b)| 0.5 * (a.coordinate + b.coordinate))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(slope: f64, others: usize) -> Vec<BorderPoint> {
        (0..60_u32)
            .map(|i| {
                let coordinate = 16.0 * f64::from(i) + 8.0;
                let on_object = (i as usize * 7) % 60 < others;
                let at = if on_object { 200.0 + 5.0 * f64::from(i) } else { 20.0 + slope * coordinate };
                BorderPoint { coordinate, at: at + 0.5 * f64::from(i % 3), step: 1.0 }
            })
            .collect()
    }

    #[test]
    fn a_border_is_straight_parallel_and_wide() {
        let mut buffer = Vec::new();
        let mut at = |points: &[BorderPoint]| border_at(points, 60, 1024.0, &mut buffer);
        assert!((at(&line(0.0, 0)).unwrap() - 20.5).abs() < 0.6);
        // An object hides some ends of the light.
        assert!((at(&line(0.001, 15)).unwrap() - 21.0).abs() < 1.1);
        assert_eq!(at(&line(0.0, 40)), None);
        // The edge of an object.
        assert_eq!(at(&line(0.02, 0)), None);
        assert_eq!(at(&line(0.0, 0)[..25]), None);
        assert_eq!(at(&line(0.0, 0)[..8]), None);
        assert_eq!(at(&[]), None);
    }
}
