//! Light that falls off from the middle of a picture towards its corners.

/// Light at a distance r from the middle: 1 − share · r² / r_corner², where r_corner is the distance of the picture's
/// corners. It is what cos⁴ is for a moderate field of view, with the loss in the corners as its one number.
#[derive(Debug, Clone, Copy)]
pub(super) struct RadialFalloff {
    middle: [f64; 2],
    /// Lost per square of the distance, 1/px².
    loss: f64,
}

impl RadialFalloff {
    /// Of a picture of this size that loses `share` of its light in the corners.
    pub(super) fn new(share: f64, width: usize, height: usize) -> Self {
        let [w, h] = [width as f64, height as f64];
        Self { middle: [(w - 1.0) / 2.0, (h - 1.0) / 2.0], loss: 4.0 * share / (w * w + h * h) }
    }

    /// The light that is left at a pixel.
    pub(super) fn at(&self, x: usize, y: usize) -> f64 {
        let [x, y] = [x as f64 - self.middle[0], y as f64 - self.middle[1]];
        1.0 - self.loss * (x * x + y * y)
    }
}
