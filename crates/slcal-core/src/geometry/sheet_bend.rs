//! How a sheet of paper bends out of its plane.
//!
//! With u and v in [−1, 1] along width and height and P the Legendre polynomials, the sheet's height z above its mean plane (away
//! from the viewer) is a sum of the twelve products of polynomials that have an order of 2 to 4 and are no change of the pose to first
//! order. A sheet keeps its length when it bends: its points move towards its middle by half the square of the slope.

use nalgebra::{Point2, Point3, SVector, Vector2};
use serde::{Deserialize, Serialize};

use super::legendre::{Row, add, dot, legendre, legendre_slope, near};
use super::{RectangleSize, Side};

/// Number of terms.
const TERMS: usize = 12;
/// Nodes and weights of the Gauss–Legendre rule on [0, 1] that is exact for polynomials of degree 7.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];
/// Points along each axis at which the bend is looked for.
const GRID: usize = 33;

/// One value for each term.
pub(crate) type Terms = SVector<f64, TERMS>;

/// The coefficients of a sheet's surface, mm: of P2(u), u·v, P2(v), P3(u), P2(u)·v, u·P2(v), P3(v), P4(u), P4(v), P3(u)·v,
/// u·P3(v), P2(u)·P2(v).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SheetBend(pub [f64; TERMS]);

/// P0 to P4 and their derivatives at the middle of the sheet.
const MIDDLE: Row = legendre(0.0);
const MIDDLE_SLOPE: Row = legendre_slope(0.0);

/// How a point that is fixed to the sheet moves in the sheet's plane because the sheet keeps its length.
pub(crate) struct Shortening {
    /// mm.
    pub(crate) shift: Vector2<f64>,
    /// Derivatives of its two components by the coefficients.
    pub(crate) by_terms: [Terms; 2],
}

impl Shortening {
    pub(super) const NONE: Self = Self {
        shift: Vector2::new(0.0, 0.0),
        by_terms: [SVector::from_array_storage(nalgebra::ArrayStorage([[0.0; TERMS]])); 2],
    };
}

/// Minus the shift along the first axis, in lengths of it, and its derivatives by the coefficients: ∫ z_u² du from 0 to u along v,
/// and ∫ z_u·z_v dv from 0 to v along u = 0. The height is a polynomial along either path, which makes each integral one in one
/// variable.
fn along(c: &[f64; TERMS], degrees: [[usize; 2]; TERMS], [u, v]: [f64; 2]) -> (f64, Terms) {
    let p = legendre(v);
    // Coefficients of the height along the first path; along the second one, and of its derivative by u there.
    let [mut first, mut second, mut second_u] = [[0.0; 5]; 3];
    for (&[i, j], c) in degrees.iter().zip(c) {
        first[i] += c * p[j];
        second[j] += c * MIDDLE[i];
        second_u[j] += c * MIDDLE_SLOPE[i];
    }
    let [mut own, mut by_u, mut by_v] = [[0.0; 5]; 3];
    let mut shift = 0.0;
    for (node, weight) in GAUSS {
        let d = legendre_slope(node * u);
        let (zu, weighted) = (dot(&first, &d), weight * u);
        shift += weighted * zu * zu;
        add(&mut own, &d, 2.0 * weighted * zu);
        let (q, dq) = (legendre(node * v), legendre_slope(node * v));
        let (zu, zv, weighted) = (dot(&second_u, &q), dot(&second, &dq), weight * v);
        shift += weighted * zu * zv;
        add(&mut by_u, &q, weighted * zv);
        add(&mut by_v, &dq, weighted * zu);
    }
    let by_term = |[i, j]: [usize; 2]| own[i] * p[j] + MIDDLE_SLOPE[i] * by_u[j] + MIDDLE[i] * by_v[j];
    (shift, Terms::from(degrees.map(by_term)))
}

impl SheetBend {
    /// A flat sheet.
    pub const FLAT: Self = Self([0.0; TERMS]);
    /// Degrees of the terms along u and v.
    pub const DEGREES: [[usize; 2]; TERMS] =
        [[2, 0], [1, 1], [0, 2], [3, 0], [2, 1], [1, 2], [0, 3], [4, 0], [0, 4], [3, 1], [1, 3], [2, 2]];

    /// Order of a term, 2 to 4.
    #[must_use]
    pub fn order(term: usize) -> usize {
        Self::DEGREES[term][0] + Self::DEGREES[term][1]
    }

    /// Whether the sheet is flat.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.0.iter().all(|&c| c == 0.0)
    }

    /// The terms at (u, v).
    fn terms([u, v]: [f64; 2]) -> Terms {
        let (p, q) = (legendre(u), legendre(v));
        Terms::from(Self::DEGREES.map(|[i, j]| p[i] * q[j]))
    }

    /// Derivative by the coefficients of the height over a point of the sheet's plane.
    pub(crate) fn by_terms(size: RectangleSize, at: Point2<f64>) -> Terms {
        Self::terms(normalised(size, at).map(near))
    }

    /// Height of the surface over a point of the sheet's plane, mm, and its slope there.
    pub(crate) fn height(&self, size: RectangleSize, at: Point2<f64>) -> (f64, Vector2<f64>) {
        if self.is_flat() {
            return (0.0, Vector2::zeros());
        }
        let uv = normalised(size, at);
        let [u, v] = uv.map(near);
        let (p, q, dp, dq) = (legendre(u), legendre(v), legendre_slope(u), legendre_slope(v));
        let (mut z, mut slope) = (0.0, Vector2::zeros());
        for (c, [i, j]) in self.0.into_iter().zip(Self::DEGREES) {
            z += c * p[i] * q[j];
            slope += Vector2::new(dp[i] * q[j], p[i] * dq[j]) * c;
        }
        let inside = Vector2::new(f64::from(u == uv[0]), f64::from(v == uv[1]));
        let by_mm = Vector2::new(2.0 / size.width_mm, 2.0 / size.height_mm);
        (z, slope.component_mul(&by_mm).component_mul(&inside))
    }

    /// The height along a side as a sum of Legendre polynomials of x, which goes from −1 at its first corner to 1 at the next.
    pub(super) fn rise_of_side(&self, side: Side) -> Row {
        let (fixed, direction) = match side {
            Side::Top => (-1.0, 1.0),
            Side::Right => (1.0, 1.0),
            Side::Bottom => (1.0, -1.0),
            Side::Left => (-1.0, -1.0),
        };
        let across = legendre(fixed);
        let mut rise = [0.0; 5];
        for (c, [i, j]) in self.0.into_iter().zip(Self::DEGREES) {
            let (own, other) = if matches!(side, Side::Top | Side::Bottom) { (i, j) } else { (j, i) };
            rise[own] += c * across[other] * if own % 2 == 1 { direction } else { 1.0 };
        }
        rise
    }

    /// How far a point of the sheet moves in the sheet's plane because the sheet keeps its length. Measured from the middle, exact
    /// to second order for every cylinder: ∂ξ/∂x = −z_x²/2, ∂η/∂y = −z_y²/2, ∂ξ/∂y = ∂η/∂x = −z_x z_y/2 along the axes.
    pub(crate) fn shortening(&self, size: RectangleSize, at: Point2<f64>) -> Shortening {
        if self.is_flat() {
            return Shortening::NONE;
        }
        let [u, v] = normalised(size, at).map(near);
        let (x, by_x) = along(&self.0, Self::DEGREES, [u, v]);
        let (y, by_y) = along(&self.0, Self::DEGREES.map(|[i, j]| [j, i]), [v, u]);
        let (w, h) = (size.width_mm, size.height_mm);
        Shortening { shift: -Vector2::new(x / w, y / h), by_terms: [by_x / -w, by_y / -h] }
    }

    /// Where a point of the sheet (mm from its top left corner) lies in the sheet's frame, mm.
    #[must_use]
    pub fn point(&self, size: RectangleSize, at: Point2<f64>) -> Point3<f64> {
        let place = at + self.shortening(size, at).shift;
        Point3::new(place.x, place.y, self.height(size, at).0)
    }

    /// The deepest and the highest points of the sheet, mm on the sheet: the valley lies furthest from the viewer, the peak
    /// nearest.
    #[must_use]
    pub fn valley_and_peak(&self, size: RectangleSize) -> [Point2<f64>; 2] {
        let mut found = [(f64::MIN, size.centre()), (f64::MAX, size.centre())];
        for i in 0..GRID * GRID {
            let part = |k: usize| k as f64 / (GRID - 1) as f64;
            let at = Point2::new(size.width_mm * part(i % GRID), size.height_mm * part(i / GRID));
            let z = self.height(size, at).0;
            if z > found[0].0 {
                found[0] = (z, at);
            }
            if z < found[1].0 {
                found[1] = (z, at);
            }
        }
        found.map(|(_, at)| at)
    }

    /// How far the sheet bends from valley to peak, mm, and the point of the sheet (mm) that lies furthest from its mean plane.
    #[must_use]
    pub fn sag_mm(&self, size: RectangleSize) -> (f64, Point2<f64>) {
        let [low, high] = self.valley_and_peak(size).map(|at| (self.height(size, at).0, at));
        let furthest = if low.0.abs() > high.0.abs() { low.1 } else { high.1 };
        (low.0 - high.0, furthest)
    }
}

fn normalised(size: RectangleSize, at: Point2<f64>) -> [f64; 2] {
    [2.0 * at.x / size.width_mm - 1.0, 2.0 * at.y / size.height_mm - 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: RectangleSize = RectangleSize { width_mm: 594.0, height_mm: 420.0 };

    #[test]
    fn no_term_is_a_shift_or_a_tilt() {
        // Products with 1, u and v integrate to zero over the sheet (midpoint rule).
        let n = 800;
        let at = |i: usize| (i as f64 + 0.5) / n as f64 * 2.0 - 1.0;
        let mut sums = [Terms::zeros(); 3];
        for i in 0..n * n {
            let uv = [at(i % n), at(i / n)];
            for (sum, by) in sums.iter_mut().zip([1.0, uv[0], uv[1]]) {
                *sum += SheetBend::terms(uv) * (by / (n * n) as f64);
            }
        }
        assert!(sums.iter().all(|s| s.amax() < 1e-5), "{sums:?}");
    }

    #[test]
    fn an_oblique_cylinder_keeps_its_lengths() {
        // z = a·(x cos α + y sin α)² about the middle is a sum of P2(u), u·v and P2(v) up to a shift.
        let (a, alpha): (f64, f64) = (4e-5, 0.6);
        let (w, h) = (SIZE.width_mm / 2.0, SIZE.height_mm / 2.0);
        let mut c = [0.0; 12];
        c[0] = a * (alpha.cos() * w).powi(2) * 2.0 / 3.0;
        c[1] = a * 2.0 * alpha.cos() * alpha.sin() * w * h;
        c[2] = a * (alpha.sin() * h).powi(2) * 2.0 / 3.0;
        let bend = SheetBend(c);
        // Chords between near points have the length that they have in the flat sheet, to fourth order of the slope.
        let points = [(10.0, 20.0), (300.0, 5.0), (590.0, 400.0), (150.0, 300.0)];
        for (x, y) in points {
            for direction in [Vector2::x(), Vector2::y(), Vector2::new(0.6, 0.8)] {
                let (p, q) = (Point2::new(x, y), Point2::new(x, y) + direction);
                let length = nalgebra::distance(&bend.point(SIZE, p), &bend.point(SIZE, q));
                let slope = bend.height(SIZE, p).1.norm();
                assert!(slope < 0.03 && (length - 1.0).abs() < slope.powi(4) + 1e-8, "{length} {slope}");
            }
        }
        let (sag, _) = bend.sag_mm(SIZE);
        let longest = (w * alpha.cos()).abs() + (h * alpha.sin()).abs();
        assert!((sag - a * longest * longest).abs() < 1e-9);
    }

    #[test]
    fn derivatives_agree_with_finite_differences() {
        let bend = SheetBend(std::array::from_fn(|k| 0.7 - 0.13 * k as f64));
        let at = Point2::new(430.0, 77.0);
        let ((_, slope), terms) = (bend.height(SIZE, at), SheetBend::by_terms(SIZE, at));
        let z = |dx: f64, dy: f64| bend.height(SIZE, at + Vector2::new(dx, dy)).0;
        assert!((slope.x - (z(1e-3, 0.0) - z(-1e-3, 0.0)) / 2e-3).abs() < 1e-9);
        assert!((slope.y - (z(0.0, 1e-3) - z(0.0, -1e-3)) / 2e-3).abs() < 1e-9);
        let [x, y] = bend.shortening(SIZE, at).by_terms;
        for k in 0..12 {
            let changed = |d: f64| {
                let mut other = bend;
                other.0[k] += d;
                let p = other.point(SIZE, at);
                Point3::new(p.x, p.y, p.z)
            };
            let numeric = (changed(1e-4) - changed(-1e-4)) / 2e-4;
            assert!((numeric - nalgebra::Vector3::new(x[k], y[k], terms[k])).amax() < 1e-7, "{k}");
        }
    }
}
