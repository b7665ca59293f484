//! A photograph in linear light, converted on access: most pixels of a large photograph are never needed at full size.

use nalgebra::Point2;

use super::bilinear::bilinear;
use super::{Encoding, GreyImage, Layout, LinearTable, PhotoView, Samples};

/// A borrowed photograph in linear light, 0–1, averaged over the three channels with equal weights. The sheet and the
/// projected light are white, so that equal weights give the least noise.
#[derive(Debug, Clone)]
pub(crate) struct LinearPhoto<'a> {
    view: PhotoView<'a>,
    table: LinearTable,
}

impl<'a> LinearPhoto<'a> {
    /// Reads `view` through the transfer curve `encoding`.
    #[must_use]
    pub(crate) fn new(view: PhotoView<'a>, encoding: Encoding) -> Self {
        Self { view, table: view.linear_table(encoding) }
    }

    /// The photograph itself.
    #[must_use]
    pub(crate) fn view(&self) -> PhotoView<'a> {
        self.view
    }

    /// Width, px.
    #[must_use]
    pub(crate) fn width(&self) -> usize {
        self.view.width()
    }

    /// Height, px.
    #[must_use]
    pub(crate) fn height(&self) -> usize {
        self.view.height()
    }

    /// The light of a pixel, which must lie in the photograph.
    #[inline]
    #[must_use]
    pub(crate) fn at(&self, x: usize, y: usize) -> f32 {
        self.view.linear_grey_pixel(x, y, &self.table)
    }

    /// The channels that differ: red, green and blue, or the one of a grey photograph.
    #[must_use]
    pub(crate) fn channels(&self) -> usize {
        if self.view.layout().has_color() { 3 } else { 1 }
    }

    /// The light of a pixel in one channel, and how much more the next code value stands for. Nothing follows the last one.
    #[inline]
    #[must_use]
    pub(crate) fn channel_and_step(&self, x: usize, y: usize, channel: usize) -> (f32, f32) {
        let code = usize::from(self.view.rgb_codes(x, y)[channel]);
        let light = self.table.light(code);
        (light, self.table.get(code + 1).map_or(f32::INFINITY, |next| next - light))
    }

    /// A copy in which the light of each row is divided by the gains of that row, red, green and blue.
    #[must_use]
    pub(crate) fn with_rows_divided(&self, gains: impl Fn(usize) -> [f32; 3]) -> DividedPhoto {
        let (width, height) = (self.width(), self.height());
        let channels = self.channels();
        let mut row = vec![[0.0; 3]; width];
        let mut most = 0.0_f32;
        for y in 0..height {
            self.view.linear_rgb_row(y, &self.table, &mut row);
            most = row.iter().flatten().fold(most, |m, &l| m.max(l));
        }
        let scale = f32::from(u16::MAX) / most.max(f32::MIN_POSITIVE);
        let mut samples = Vec::with_capacity(width * height * channels);
        for y in 0..height {
            self.view.linear_rgb_row(y, &self.table, &mut row);
            let factors = gains(y).map(|gain| scale / gain);
            for pixel in &row {
                // What was at the end of the range in a bright row stays the most there is. (The conversion saturates.)
                let code = |c: usize| (pixel[c] * factors[c] + 0.5) as u16;
                samples.extend((0..channels).map(code));
            }
        }
        DividedPhoto { samples, width, height }
    }

    /// Bilinear interpolation; `None` outside the centres of the border pixels.
    #[inline]
    #[must_use]
    pub(crate) fn bilinear(&self, p: Point2<f64>) -> Option<f64> {
        bilinear([self.width(), self.height()], p, |x, y| self.at(x, y))
    }

    /// The mean over blocks of `factor`×`factor` pixels; large blocks use every second row. Incomplete blocks at the end
    /// are left out. Pixel (x, y) of the result has its centre at (x·factor + (factor−1)/2, …) of the photograph.
    #[must_use]
    pub(crate) fn reduced(&self, factor: usize) -> GreyImage {
        let factor = factor.max(1);
        let (w, h) = (self.width() / factor, self.height() / factor);
        let mut data = vec![0.0_f32; w * h];
        for (y, sums) in data.chunks_exact_mut(w.max(1)).enumerate() {
            let mut rows = 0;
            for row in (0..factor).filter(|&row| is_read(row, factor)) {
                self.view.add_block_sums(y * factor + row, factor, &self.table, sums);
                rows += 1;
            }
            let scale = 1.0 / (rows * factor) as f32;
            for s in sums {
                *s *= scale;
            }
        }
        GreyImage::from_data(w, h, data)
    }
}

/// A photograph of its own whose samples are proportional to light; the brightest pixel of the original is at the end of
/// their range.
#[derive(Debug, Clone)]
pub(crate) struct DividedPhoto {
    samples: Vec<u16>,
    width: usize,
    height: usize,
}

impl DividedPhoto {
    /// The photograph; its encoding is [`Encoding::Linear`].
    #[must_use]
    pub(crate) fn view(&self) -> PhotoView<'_> {
        let channels = self.samples.len() / (self.width * self.height);
        let layout = if channels == 1 { Layout::Grey } else { Layout::Rgb };
        PhotoView::of_whole(Samples::U16(&self.samples), self.width, self.height, layout)
    }
}

/// Whether a row of a block is part of its mean. Of a large block every second row from either end is used: that does not
/// shift the mean, and noise stays low enough for the search.
fn is_read(row: usize, factor: usize) -> bool {
    /// Fewer rows than this are all read.
    const LARGE: usize = 4;
    factor < LARGE || row.min(factor - 1 - row).is_multiple_of(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bilinear_is_exact_on_a_ramp_up_to_the_border_and_nothing_beyond() {
        let codes: Vec<u16> = (0..20).map(|i| (i % 5) * 1000 + (i / 5) * 10_000).collect();
        let view = PhotoView::new(Samples::U16(&codes), 5, 4, 5, Layout::Grey).unwrap();
        let photo = LinearPhoto::new(view, Encoding::Linear);
        let at = |x: f64, y: f64| photo.bilinear(Point2::new(x, y)).map(|v| v * 65535.0);
        assert!((at(2.25, 1.5).unwrap() - 17_250.0).abs() < 0.01);
        assert!((at(4.0, 3.0).unwrap() - 34_000.0).abs() < 0.01);
        assert_eq!(at(4.01, 0.0), None);
        assert_eq!(at(f64::NAN, 0.0), None);
    }

    #[test]
    fn the_mean_of_a_large_block_is_that_of_its_centre() {
        let codes: Vec<u16> = (0..18 * 18).map(|i| (i % 18) * 1000 + (i / 18) * 2000).collect();
        let view = PhotoView::new(Samples::U16(&codes), 18, 18, 18, Layout::Grey).unwrap();
        let photo = LinearPhoto::new(view, Encoding::Linear);
        for factor in 1..=9 {
            let centre = 3000.0 * (factor as f32 - 1.0) / 2.0 / 65535.0;
            assert!((photo.reduced(factor).at(0, 0) - centre).abs() < 1e-6, "{factor}");
        }
    }

    #[test]
    fn blocks_of_any_layout_hold_the_mean_of_light() {
        let rgba: Vec<u8> =
            (0..7 * 5).flat_map(|i: usize| [i as u8, (2 * i) as u8, (3 * i) as u8, 255]).collect();
        let rgb: Vec<u8> = rgba.chunks(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        let with = |bytes: &[u8], stride: usize, layout| {
            let view = PhotoView::new(Samples::U8(bytes), 7, 5, stride, layout).unwrap();
            let photo = LinearPhoto::new(view, Encoding::Srgb);
            let small = photo.reduced(2);
            assert_eq!((small.width(), small.height()), (3, 2));
            let mean = (photo.at(2, 2) + photo.at(3, 2) + photo.at(2, 3) + photo.at(3, 3)) / 4.0;
            assert!((small.at(1, 1) - mean).abs() < 1e-6);
            small
        };
        let (a, b) = (with(&rgba, 28, Layout::Rgba), with(&rgb, 21, Layout::Rgb));
        assert!(a.data().iter().zip(b.data()).all(|(a, b)| (a - b).abs() < 1e-6));
    }
}
