//! Legendre polynomials up to the fourth degree, of which the surface of a bent sheet is made.

/// Beyond this |x| the polynomials mean nothing for a sheet, whose sides lie at ±1: the surface stays what it is there.
pub(super) const FURTHEST: f64 = 1.5;

/// A coordinate no further out than that.
pub(super) fn near(x: f64) -> f64 {
    x.clamp(-FURTHEST, FURTHEST)
}

/// One value for each degree along an axis.
pub(super) type Row = [f64; 5];

/// P0 to P4 at x.
pub(super) const fn legendre(x: f64) -> Row {
    let x2 = x * x;
    [1.0, x, (3.0 * x2 - 1.0) / 2.0, x * (5.0 * x2 - 3.0) / 2.0, ((35.0 * x2 - 30.0) * x2 + 3.0) / 8.0]
}

/// Their derivatives.
pub(super) const fn legendre_slope(x: f64) -> Row {
    let x2 = x * x;
    [0.0, 1.0, 3.0 * x, (15.0 * x2 - 3.0) / 2.0, x * (35.0 * x2 - 15.0) / 2.0]
}

pub(super) fn dot(a: &Row, b: &Row) -> f64 {
    (0..5).map(|i| a[i] * b[i]).sum()
}

pub(super) fn add(to: &mut Row, row: &Row, factor: f64) {
    (0..5).for_each(|i| to[i] += row[i] * factor);
}
