//! Arithmetic of linear RGB, written channel by channel: closures mapped over arrays are not always inlined, and are
//! then several times as slow.

/// Red, green and blue.
pub(super) type Rgb = [f32; 3];

/// The sum over the channels: the scalar in which stripes of all hues stand out.
#[inline]
pub(super) fn total(c: Rgb) -> f32 {
    c[0] + c[1] + c[2]
}

#[inline]
pub(super) fn plus(a: Rgb, b: Rgb) -> Rgb {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline]
pub(super) fn minus(a: Rgb, b: Rgb) -> Rgb {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Channel by channel.
#[inline]
pub(super) fn times(a: Rgb, b: Rgb) -> Rgb {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

/// Channel by channel.
#[inline]
pub(super) fn over(a: Rgb, b: Rgb) -> Rgb {
    [a[0] / b[0], a[1] / b[1], a[2] / b[2]]
}

#[inline]
pub(super) fn scaled(a: Rgb, by: f32) -> Rgb {
    [a[0] * by, a[1] * by, a[2] * by]
}

#[inline]
pub(super) fn dot(a: Rgb, b: Rgb) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Negative values (noise about a dark band) set to zero.
#[inline]
pub(super) fn positive(c: Rgb) -> Rgb {
    let positive = |x: f32| if x > 0.0 { x } else { 0.0 };
    [positive(c[0]), positive(c[1]), positive(c[2])]
}

/// The direction of the positive part of a colour; `None` where there is none.
#[inline]
pub(super) fn unit(c: Rgb) -> Option<Rgb> {
    let c = positive(c);
    let norm = dot(c, c).sqrt();
    (norm > 0.0 && norm.is_finite()).then(|| scaled(c, 1.0 / norm))
}

/// The mean of some pixels; black for none.
#[inline]
pub(super) fn mean(pixels: &[Rgb]) -> Rgb {
    let mut sum = [0.0; 3];
    for &p in pixels {
        sum = plus(sum, p);
    }
    scaled(sum, 1.0 / pixels.len().max(1) as f32)
}
