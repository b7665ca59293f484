//! How a sheet of paper bends out of its plane.
//!
//! With u and v in [−1, 1] along width and height and P the Legendre polynomials, the sheet's height z above its mean plane (away
//! from the viewer) is a sum of the twelve products of polynomials that have an order of 2 to 4 and are no change of the pose to first
//! order. A sheet keeps its length when it bends: its points move towards its middle by half the square of the slope.

use nalgebra::{Matrix2, Point2, Point3, SVector, Vector2};
use serde::{Deserialize, Serialize};

use super::RectangleSize;

/// Number of terms.
const TERMS: usize = 12;
/// Beyond this |u| or |v| the polynomials mean nothing: the height stays what it is there.
const FURTHEST: f64 = 1.5;
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

/// P0 to P4 at x.
fn legendre(x: f64) -> [f64; 5] {
    let x2 = x * x;
    [1.0, x, (3.0 * x2 - 1.0) / 2.0, x * (5.0 * x2 - 3.0) / 2.0, ((35.0 * x2 - 30.0) * x2 + 3.0) / 8.0]
}

/// Their derivatives.
fn legendre_slope(x: f64) -> [f64; 5] {
    let x2 = x * x;
    [0.0, 1.0, 3.0 * x, (15.0 * x2 - 3.0) / 2.0, x * (35.0 * x2 - 15.0) / 2.0]
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

    fn coefficients(&self) -> Terms {
        Terms::from(self.0)
    }

    /// The terms at (u, v).
    fn terms([u, v]: [f64; 2]) -> Terms {
        let (p, q) = (legendre(u), legendre(v));
        Terms::from(Self::DEGREES.map(|[i, j]| p[i] * q[j]))
    }

    /// Their derivatives by u and by v.
    fn slopes([u, v]: [f64; 2]) -> [Terms; 2] {
        let (p, q, dp, dq) = (legendre(u), legendre(v), legendre_slope(u), legendre_slope(v));
        [
            Terms::from(Self::DEGREES.map(|[i, j]| dp[i] * q[j])),
            Terms::from(Self::DEGREES.map(|[i, j]| p[i] * dq[j])),
        ]
    }

    /// Height of the surface over a point of the sheet's plane, mm, its slope there, and the derivative of the height by
    /// the coefficients.
    pub(crate) fn height(&self, size: RectangleSize, at: Point2<f64>) -> (f64, Vector2<f64>, Terms) {
        let uv = normalised(size, at);
        let near = uv.map(|x| x.clamp(-FURTHEST, FURTHEST));
        let terms = Self::terms(near);
        if self.is_flat() {
            return (0.0, Vector2::zeros(), terms);
        }
        let c = self.coefficients();
        let [du, dv] = Self::slopes(near);
        let slope = |d: Terms, i: usize, length: f64| {
            if near[i] == uv[i] { c.dot(&d) * 2.0 / length } else { 0.0 }
        };
        (c.dot(&terms), Vector2::new(slope(du, 0, size.width_mm), slope(dv, 1, size.height_mm)), terms)
    }

    /// How far a point of the sheet moves in the sheet's plane because the sheet keeps its length, mm, with the derivatives by
    /// the coefficients. Measured from the middle, exact to second order for every cylinder:
    /// ∂ξ/∂x = −z_x²/2, ∂η/∂y = −z_y²/2, ∂ξ/∂y = ∂η/∂x = −z_x z_y/2.
    pub(crate) fn shortening(&self, size: RectangleSize, at: Point2<f64>) -> [(f64, Terms); 2] {
        if self.is_flat() {
            return [(0.0, Terms::zeros()); 2];
        }
        let [u, v] = normalised(size, at).map(|x| x.clamp(-FURTHEST, FURTHEST));
        let c = self.coefficients();
        // ∫ z_a·z_b along one axis, with the derivative.
        let along = |path: &dyn Fn(f64) -> [f64; 2], length: f64, a: usize, b: usize| {
            let mut sum = (0.0, Terms::zeros());
            for (node, weight) in GAUSS {
                let d = Self::slopes(path(node));
                let (za, zb) = (c.dot(&d[a]), c.dot(&d[b]));
                sum.0 += weight * length * za * zb;
                sum.1 += (d[a] * zb + d[b] * za) * (weight * length);
            }
            sum
        };
        let shift = |own: (f64, Terms), shear: (f64, Terms), side: f64| {
            let unit = -1.0 / side;
            (unit * (own.0 + shear.0), (own.1 + shear.1) * unit)
        };
        let x = shift(along(&|t| [t * u, v], u, 0, 0), along(&|t| [0.0, t * v], v, 0, 1), size.width_mm);
        let y = shift(along(&|t| [u, t * v], v, 1, 1), along(&|t| [t * u, 0.0], u, 0, 1), size.height_mm);
        [x, y]
    }

    /// How fast it changes along the sheet: ∂(ξ, η)/∂(x, y).
    pub(crate) fn shortening_by_place(&self, size: RectangleSize, at: Point2<f64>) -> Matrix2<f64> {
        let uv = normalised(size, at);
        let near = uv.map(|x| x.clamp(-FURTHEST, FURTHEST));
        let [u, v] = near;
        let (c, half) = (self.coefficients(), [size.width_mm / 2.0, size.height_mm / 2.0]);
        let slope = |at| {
            let d = Self::slopes(at);
            [c.dot(&d[0]) / half[0], c.dot(&d[1]) / half[1]]
        };
        let twist = |[u, v]: [f64; 2]| {
            let (dp, dq) = (legendre_slope(u), legendre_slope(v));
            let by_both = Terms::from(Self::DEGREES.map(|[i, j]| dp[i] * dq[j]));
            c.dot(&by_both) / (half[0] * half[1])
        };
        // Across its own axis a, ∫ 2·z_a·z_xy da and z_x z_y where the shear begins.
        let across = |path: &dyn Fn(f64) -> [f64; 2], a: usize, begins: [f64; 2]| {
            let sum: f64 = GAUSS.iter().map(|&(t, w)| w * 2.0 * slope(path(t))[a] * twist(path(t))).sum();
            let [zx, zy] = slope(begins);
            -(sum * near[a] * half[a] + zx * zy) / 2.0
        };
        let [zx, zy] = slope(near);
        let mut all = Matrix2::new(
            -zx * zx / 2.0,
            across(&|t| [t * u, v], 0, [0.0, v]),
            across(&|t| [u, t * v], 1, [u, 0.0]),
            -zy * zy / 2.0,
        );
        for i in (0..2).filter(|&i| near[i] != uv[i]) {
            all.column_mut(i).fill(0.0);
        }
        all
    }

    /// Where a point of the sheet (mm from its top left corner) lies in the sheet's frame, mm.
    #[must_use]
    pub fn point(&self, size: RectangleSize, at: Point2<f64>) -> Point3<f64> {
        let [x, y] = self.shortening(size, at);
        Point3::new(at.x + x.0, at.y + y.0, self.height(size, at).0)
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
        let (_, slope, terms) = bend.height(SIZE, at);
        let z = |dx: f64, dy: f64| bend.height(SIZE, at + Vector2::new(dx, dy)).0;
        assert!((slope.x - (z(1e-3, 0.0) - z(-1e-3, 0.0)) / 2e-3).abs() < 1e-9);
        assert!((slope.y - (z(0.0, 1e-3) - z(0.0, -1e-3)) / 2e-3).abs() < 1e-9);
        let by_place = bend.shortening_by_place(SIZE, at);
        for (i, step) in [Vector2::x(), Vector2::y()].into_iter().enumerate() {
            let shift = |d: f64| bend.shortening(SIZE, at + step * d).map(|s| s.0);
            let ([a, b], [c, d]) = (shift(1e-2), shift(-1e-2));
            let numeric = Vector2::new(a - c, b - d) / 2e-2;
            assert!((numeric - by_place.column(i)).amax() < 1e-10, "{numeric} {by_place}");
        }
        let [x, y] = bend.shortening(SIZE, at);
        for k in 0..12 {
            let changed = |d: f64| {
                let mut other = bend;
                other.0[k] += d;
                let p = other.point(SIZE, at);
                Point3::new(p.x, p.y, p.z)
            };
            let numeric = (changed(1e-4) - changed(-1e-4)) / 2e-4;
            assert!((numeric - nalgebra::Vector3::new(x.1[k], y.1[k], terms[k])).amax() < 1e-7, "{k}");
        }
    }
}
