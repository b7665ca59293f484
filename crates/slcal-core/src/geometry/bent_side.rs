//! A side of a bent sheet: a curve whose points are polynomials of the place along it, found once for all points of the side.

use nalgebra::Vector2;

use super::legendre::{FURTHEST, Row, dot, legendre, legendre_slope, near};
use super::{RectangleSize, SheetBend, Shortening, Side};

/// Places that determine the shift of the side's points: squares of slopes have degree 6, their integrals 7.
const NODES: usize = 8;

/// A side from one corner (`part` 0) to the next one (1), and beyond.
pub(crate) struct BentSide {
    /// The height as a sum of Legendre polynomials of 2·part − 1.
    rise: Row,
    /// How the points at the nodes shift in the sheet's plane; none of a flat sheet.
    shifts: Option<[Shortening; NODES]>,
}

/// 2·part − 1 at a node; they are evenly spaced.
const fn node(i: usize) -> f64 {
    FURTHEST * (2.0 * i as f64 / (NODES - 1) as f64 - 1.0)
}

/// What makes Lagrange's polynomials one at their own nodes: 1/Π (x_i − x_k).
const UNITS: [f64; NODES] = {
    let mut units = [1.0; NODES];
    let mut i = 0;
    while i < NODES * NODES {
        let (own, other) = (i / NODES, i % NODES);
        if own != other {
            units[own] /= node(own) - node(other);
        }
        i += 1;
    }
    units
};

/// Lagrange's polynomials of the nodes at x.
fn lagrange(x: f64) -> [f64; NODES] {
    let mut values = UNITS;
    let (mut before, mut after) = (1.0, 1.0);
    for i in 0..NODES {
        let last = NODES - 1 - i;
        values[i] *= before;
        values[last] *= after;
        (before, after) = (before * (x - node(i)), after * (x - node(last)));
    }
    values
}

/// Their derivatives.
fn lagrange_slope(x: f64) -> [f64; NODES] {
    std::array::from_fn(|i| {
        let (mut product, mut slope) = (UNITS[i], 0.0);
        for k in (0..NODES).filter(|&k| k != i) {
            let factor = x - node(k);
            (product, slope) = (product * factor, slope * factor + product);
        }
        slope
    })
}

impl BentSide {
    pub(crate) fn new(bend: &SheetBend, size: RectangleSize, side: Side) -> Self {
        let corners = size.corners();
        let (from, to) = (corners[side as usize], corners[(side as usize + 1) % 4]);
        let shift = |i| bend.shortening(size, from + (to - from) * f64::midpoint(node(i), 1.0));
        Self { rise: bend.rise_of_side(side), shifts: (!bend.is_flat()).then(|| std::array::from_fn(shift)) }
    }

    /// Height, mm, and its derivative by `part`.
    pub(crate) fn height(&self, part: f64) -> (f64, f64) {
        let far = 2.0 * part - 1.0;
        let x = near(far);
        let slope = if x == far { 2.0 * dot(&self.rise, &legendre_slope(x)) } else { 0.0 };
        (dot(&self.rise, &legendre(x)), slope)
    }

    /// How fast the shift in the sheet's plane changes, mm by `part`.
    pub(crate) fn shift_by_part(&self, part: f64) -> Vector2<f64> {
        let far = 2.0 * part - 1.0;
        let shifts = self.shifts.as_ref().filter(|_| near(far) == far);
        let at_nodes = shifts.into_iter().flatten().zip(lagrange_slope(far));
        at_nodes.map(|(at, slope)| at.shift * (2.0 * slope)).sum()
    }

    /// The shift in the sheet's plane.
    pub(crate) fn shortening(&self, part: f64) -> Shortening {
        let mut sum = Shortening::NONE;
        let Some(shifts) = &self.shifts else { return sum };
        for (at, value) in shifts.iter().zip(lagrange(near(2.0 * part - 1.0))) {
            sum.shift += at.shift * value;
            sum.by_terms.iter_mut().zip(&at.by_terms).for_each(|(s, t)| *s += t * value);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;

    const SIZE: RectangleSize = RectangleSize { width_mm: 594.0, height_mm: 420.0 };

    #[test]
    fn the_curve_is_the_border_of_the_surface() {
        let bend = SheetBend(std::array::from_fn(|k| 0.9 - 0.17 * k as f64));
        let corners = SIZE.corners();
        for side in Side::ALL {
            let curve = BentSide::new(&bend, SIZE, side);
            let from = corners[side as usize];
            let along = corners[(side as usize + 1) % 4] - from;
            for part in [-0.3, -0.26, 0.0, 0.21, 0.5, 0.83, 1.0, 1.24, 1.3] {
                let at: Point2<f64> = from + along * part;
                let (z, slope) = bend.height(SIZE, at);
                let surface = bend.shortening(SIZE, at);
                let (height, by_part) = curve.height(part);
                assert!((height - z).abs() < 1e-12 && (by_part - slope.dot(&along)).abs() < 1e-11);
                let found = curve.shortening(part);
                assert!((found.shift - surface.shift).amax() < 1e-13, "{side:?} {part}");
                for (found, wanted) in found.by_terms.into_iter().zip(surface.by_terms) {
                    assert!((found - wanted).amax() < 1e-13, "{side:?} {part}");
                }
                // The ends of the range that the polynomials hold for are corners of the curve.
                if (part - 0.5).abs() < 0.7 {
                    let shift = |d: f64| bend.shortening(SIZE, at + along * d).shift;
                    let numeric = (shift(1e-5) - shift(-1e-5)) / 2e-5;
                    assert!((curve.shift_by_part(part) - numeric).amax() < 1e-8, "{side:?} {part}");
                }
            }
        }
    }
}
