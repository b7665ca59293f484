//! One channel of linear light.

use nalgebra::Point2;

use super::bilinear::bilinear;

/// A grey image in linear light, 0–1, row-major.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct GreyImage {
    width: usize,
    height: usize,
    data: Vec<f32>,
}

impl GreyImage {
    /// An image whose pixels are `f(x, y)`.
    pub(crate) fn from_fn(width: usize, height: usize, mut f: impl FnMut(usize, usize) -> f32) -> Self {
        let mut data = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                data.push(f(x, y));
            }
        }
        Self { width, height, data }
    }

    /// An image of `width`·`height` values; what is missing is black.
    pub(super) fn from_data(width: usize, height: usize, mut data: Vec<f32>) -> Self {
        data.resize(width * height, 0.0);
        Self { width, height, data }
    }

    /// Width, px.
    #[must_use]
    pub(crate) fn width(&self) -> usize {
        self.width
    }

    /// Height, px.
    #[must_use]
    pub(crate) fn height(&self) -> usize {
        self.height
    }

    /// One row.
    #[must_use]
    pub(crate) fn row(&self, y: usize) -> &[f32] {
        &self.data[y * self.width..(y + 1) * self.width]
    }

    /// The value of a pixel.
    #[inline]
    #[must_use]
    pub(crate) fn at(&self, x: usize, y: usize) -> f32 {
        self.data[y * self.width + x]
    }

    /// Bilinear interpolation at a position; `None` outside the centres of the border pixels.
    #[inline]
    #[must_use]
    pub(crate) fn bilinear(&self, x: f64, y: f64) -> Option<f64> {
        bilinear([self.width, self.height], Point2::new(x, y), |x, y| self.at(x, y))
    }

    /// All pixels, row-major.
    #[must_use]
    pub(crate) fn data(&self) -> &[f32] {
        &self.data
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bilinear_is_exact_on_a_ramp_up_to_the_border_and_nothing_beyond() {
        let image = GreyImage::from_fn(5, 4, |x, y| x as f32 + 10.0 * y as f32);
        assert!((image.bilinear(2.25, 1.5).unwrap() - 17.25).abs() < 1e-6);
        assert_eq!(image.bilinear(4.0, 3.0), Some(34.0));
        assert_eq!(image.bilinear(4.01, 0.0), None);
        assert_eq!(image.bilinear(f64::NAN, 0.0), None);
    }
}
