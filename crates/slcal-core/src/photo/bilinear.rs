//! Bilinear interpolation.

use nalgebra::Point2;

/// The value at a position between the pixels of a `w` by `h` image; `None` outside the centres of the border pixels.
#[inline]
pub(super) fn bilinear([w, h]: [usize; 2], p: Point2<f64>, at: impl Fn(usize, usize) -> f32) -> Option<f64> {
    let inside = p.x >= 0.0 && p.y >= 0.0 && p.x <= w as f64 - 1.0 && p.y <= h as f64 - 1.0;
    if !inside {
        return None;
    }
    let (x, y) = (p.x as usize, p.y as usize);
    let (fx, fy) = (p.x - x as f64, p.y - y as f64);
    let (x1, y1) = ((x + 1).min(w - 1), (y + 1).min(h - 1));
    let along = |y: usize| {
        let (a, b) = (f64::from(at(x, y)), f64::from(at(x1, y)));
        a + fx * (b - a)
    };
    let (top, bottom) = (along(y), along(y1));
    Some(top + fy * (bottom - top))
}
