//! Borrowed photographs: from `image` buffers or straight from a driver's memory.

use image::{DynamicImage, RgbImage};

use super::{Encoding, LinearTable};
use crate::error::{Error, ErrorSubject, Result};

/// The samples of a photograph, 8 or 16 bit.
#[derive(Debug, Clone, Copy)]
pub enum Samples<'a> {
    /// 8 bit.
    U8(&'a [u8]),
    /// 16 bit, native byte order.
    U16(&'a [u16]),
}

/// The samples of one pixel, in memory order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// One sample.
    Grey,
    /// Grey and an alpha that is ignored.
    GreyAlpha,
    /// Red first.
    Rgb,
    /// Blue first.
    Bgr,
    /// Red first, alpha ignored.
    Rgba,
    /// Blue first, alpha ignored.
    Bgra,
}

impl Layout {
    fn channels(self) -> usize {
        match self {
            Self::Grey => 1,
            Self::GreyAlpha => 2,
            Self::Rgb | Self::Bgr => 3,
            Self::Rgba | Self::Bgra => 4,
        }
    }

    /// Whether there are three colour channels.
    #[must_use]
    pub fn has_color(self) -> bool {
        self.channels() >= 3
    }

    /// Offsets of red, green and blue within a pixel.
    fn rgb_offsets(self) -> [usize; 3] {
        match self {
            Self::Grey | Self::GreyAlpha => [0, 0, 0],
            Self::Rgb | Self::Rgba => [0, 1, 2],
            Self::Bgr | Self::Bgra => [2, 1, 0],
        }
    }
}

/// A borrowed photograph. Nothing is copied: the samples may lie in an `image` buffer or in the memory of a camera's driver.
///
/// ```
/// use slcal_core::photo::{Layout, PhotoView, Samples};
///
/// // Two rows of two BGRA pixels, as a driver hands them out, with four bytes of padding behind each row.
/// let frame = [10_u8, 20, 30, 255, 40, 50, 60, 255, 0, 0, 0, 0, 11, 21, 31, 255, 41, 51, 61, 255, 0, 0, 0, 0];
/// let view = PhotoView::new(Samples::U8(&frame), 2, 2, 12, Layout::Bgra)?;
/// assert_eq!(view.rgb_bytes(1, 0), [60, 50, 40]);
///
/// let image = image::DynamicImage::new_rgb16(640, 480);
/// assert_eq!(PhotoView::try_from(&image)?.width(), 640);
/// # Ok::<(), slcal_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct PhotoView<'a> {
    samples: Samples<'a>,
    width: usize,
    height: usize,
    row_stride: usize,
    layout: Layout,
}

impl<'a> PhotoView<'a> {
    /// A view of `height` rows that start every `row_stride` samples.
    ///
    /// # Errors
    /// [`Error::Invalid`] when a side is zero, the stride is shorter than a row, or the samples are too few.
    pub fn new(
        samples: Samples<'a>,
        width: usize,
        height: usize,
        row_stride: usize,
        layout: Layout,
    ) -> Result<Self> {
        let row = width.saturating_mul(layout.channels());
        let needed = row_stride.saturating_mul(height.saturating_sub(1)).saturating_add(row);
        let found = match samples {
            Samples::U8(s) => s.len(),
            Samples::U16(s) => s.len(),
        };
        if width == 0 || height == 0 || row_stride < row || found < needed {
            return Err(Error::invalid(
                ErrorSubject::Photograph,
                format!("at least 1x1 pixels, a stride of {row} samples or more and {needed} samples in all"),
                format!("{width}x{height} pixels, a stride of {row_stride} and {found} samples"),
            ));
        }
        Ok(Self { samples, width, height, row_stride, layout })
    }

    /// A view of all samples, which the caller guarantees to be as many as the pixels need.
    pub(super) fn of_whole(samples: Samples<'a>, width: usize, height: usize, layout: Layout) -> Self {
        Self { samples, width, height, row_stride: width * layout.channels(), layout }
    }

    /// The same samples, with red taken for blue and blue for red; `None` without colour.
    pub(crate) fn with_red_and_blue_exchanged(&self) -> Option<Self> {
        let layout = match self.layout {
            Layout::Grey | Layout::GreyAlpha => return None,
            Layout::Rgb => Layout::Bgr,
            Layout::Bgr => Layout::Rgb,
            Layout::Rgba => Layout::Bgra,
            Layout::Bgra => Layout::Rgba,
        };
        Some(Self { layout, ..*self })
    }

    /// Width, px.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height, px.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// The samples, row after row.
    #[must_use]
    pub fn samples(&self) -> Samples<'a> {
        self.samples
    }

    /// Order of the samples of a pixel.
    #[must_use]
    pub fn layout(&self) -> Layout {
        self.layout
    }

    /// The table from this photograph's code values to linear light.
    #[must_use]
    pub(crate) fn linear_table(&self, encoding: Encoding) -> LinearTable {
        encoding.table(match self.samples {
            Samples::U8(_) => 1 << 8,
            Samples::U16(_) => 1 << 16,
        })
    }

    /// The code values of a pixel as 0–1, red, green, blue.
    #[inline]
    #[must_use]
    pub fn rgb_code(&self, x: usize, y: usize) -> [f32; 3] {
        let [r, g, b] = self.rgb_at(x, y);
        match self.samples {
            Samples::U8(s) => [f32::from(s[r]) / 255.0, f32::from(s[g]) / 255.0, f32::from(s[b]) / 255.0],
            Samples::U16(s) => {
                [f32::from(s[r]) / 65535.0, f32::from(s[g]) / 65535.0, f32::from(s[b]) / 65535.0]
            }
        }
    }

    /// The code values of a pixel in 8 bit, red, green, blue.
    #[inline]
    #[must_use]
    pub fn rgb_bytes(&self, x: usize, y: usize) -> [u8; 3] {
        let [r, g, b] = self.rgb_at(x, y);
        match self.samples {
            Samples::U8(s) => [s[r], s[g], s[b]],
            Samples::U16(s) => {
                let byte = |at: usize| ((u32::from(s[at]) + 128) / 257) as u8;
                [byte(r), byte(g), byte(b)]
            }
        }
    }

    /// The code values of a pixel as they are, red, green, blue.
    #[inline]
    pub(crate) fn rgb_codes(&self, x: usize, y: usize) -> [u16; 3] {
        let at = self.rgb_at(x, y);
        match self.samples {
            Samples::U8(s) => at.map(|at| u16::from(s[at])),
            Samples::U16(s) => at.map(|at| s[at]),
        }
    }

    /// Writes the linear light (red, green, blue) of one row into `out`, which must hold `width` entries.
    pub(crate) fn linear_rgb_row(&self, y: usize, table: &LinearTable, out: &mut [[f32; 3]]) {
        self.each_light(y, table, out, |r, g, b| [r, g, b]);
    }

    /// Writes the sum of the channels' linear light of one row into `out`, which must hold `width` entries.
    pub(crate) fn linear_total_row(&self, y: usize, table: &LinearTable, out: &mut [f32]) {
        self.each_light(y, table, out, |r, g, b| r + g + b);
    }

    /// Writes what becomes of the linear light (red, green, blue) of each pixel of a row.
    #[inline]
    fn each_light<T>(&self, y: usize, table: &LinearTable, out: &mut [T], of: impl Fn(f32, f32, f32) -> T) {
        let [r, g, b] = self.layout.rgb_offsets();
        let channels = self.layout.channels();
        let range = y * self.row_stride..y * self.row_stride + self.width * channels;
        match (self.samples, table.of_bytes()) {
            // No index can lie outside this table, and pixels are arrays of three: there are no bounds checks per sample.
            (Samples::U8(s), Some(t)) if channels == 3 => {
                let light = |c: u8| t[usize::from(c)];
                for (o, p) in out.iter_mut().zip(s[range].as_chunks::<3>().0) {
                    *o = of(light(p[r]), light(p[g]), light(p[b]));
                }
            }
            (Samples::U8(s), _) => {
                let light = |c: u8| table.light(usize::from(c));
                for (o, p) in out.iter_mut().zip(s[range].chunks_exact(channels)) {
                    *o = of(light(p[r]), light(p[g]), light(p[b]));
                }
            }
            (Samples::U16(s), _) => {
                let light = |c: u16| table.light(usize::from(c));
                for (o, p) in out.iter_mut().zip(s[range].chunks_exact(channels)) {
                    *o = of(light(p[r]), light(p[g]), light(p[b]));
                }
            }
        }
    }

    /// Writes the linear light (red, green, blue) of one column into `out`, which must hold `height` entries.
    pub(crate) fn linear_rgb_column(&self, x: usize, table: &LinearTable, out: &mut [[f32; 3]]) {
        for (y, o) in out.iter_mut().enumerate().take(self.height) {
            *o = self.linear_rgb(x, y, table);
        }
    }

    /// The linear light (red, green, blue) of one pixel.
    #[inline]
    #[must_use]
    pub(crate) fn linear_rgb(&self, x: usize, y: usize, table: &LinearTable) -> [f32; 3] {
        let [r, g, b] = self.rgb_at(x, y);
        match self.samples {
            Samples::U8(s) => {
                let light = |at: usize| table.light(usize::from(s[at]));
                [light(r), light(g), light(b)]
            }
            Samples::U16(s) => {
                let light = |at: usize| table.light(usize::from(s[at]));
                [light(r), light(g), light(b)]
            }
        }
    }

    /// The samples of a row, of the slice that holds all.
    #[inline]
    pub(crate) fn row_of<'s, T>(&self, samples: &'s [T], y: usize) -> &'s [T] {
        let start = y * self.row_stride;
        &samples[start..start + self.width * self.layout.channels()]
    }

    /// Red, green and blue of the pixels of a row.
    #[inline]
    pub(crate) fn pixels_of<'s, T: Copy>(&self, row: &'s [T]) -> impl Iterator<Item = [T; 3]> + use<'s, T> {
        let [r, g, b] = self.layout.rgb_offsets();
        row.chunks_exact(self.layout.channels()).map(move |p| [p[r], p[g], p[b]])
    }

    /// Where the samples of a pixel lie. (Channels are written out in this file: a closure mapped over an array of three
    /// is not always inlined.)
    #[inline]
    fn rgb_at(&self, x: usize, y: usize) -> [usize; 3] {
        let at = y * self.row_stride + x * self.layout.channels();
        let [r, g, b] = self.layout.rgb_offsets();
        [at + r, at + g, at + b]
    }

    /// The linear light of one pixel, the mean of the three channels.
    #[inline]
    #[must_use]
    pub(super) fn linear_grey_pixel(&self, x: usize, y: usize, table: &LinearTable) -> f32 {
        if self.layout.has_color() {
            let [r, g, b] = self.linear_rgb(x, y, table);
            (r + g + b) / 3.0
        } else {
            let at = y * self.row_stride + x * self.layout.channels();
            match self.samples {
                Samples::U8(s) => table.light(usize::from(s[at])),
                Samples::U16(s) => table.light(usize::from(s[at])),
            }
        }
    }

    /// Adds the light of `factor` neighbouring pixels of a row to each of `sums`.
    pub(super) fn add_block_sums(&self, y: usize, factor: usize, table: &LinearTable, sums: &mut [f32]) {
        let start = y * self.row_stride;
        match (self.samples, table.of_bytes()) {
            // No index can lie outside this table: there are no bounds checks per sample.
            (Samples::U8(s), Some(t)) => self.add_blocks(&s[start..], factor, |c| t[usize::from(c)], sums),
            (Samples::U8(s), None) => {
                self.add_blocks(&s[start..], factor, |c| table.light(usize::from(c)), sums);
            }
            (Samples::U16(s), _) => {
                self.add_blocks(&s[start..], factor, |c| table.light(usize::from(c)), sums);
            }
        }
    }

    fn add_blocks<T: Copy>(&self, row: &[T], factor: usize, light: impl Fn(T) -> f32, sums: &mut [f32]) {
        let channels = self.layout.channels();
        let blocks = row.chunks(factor * channels);
        if channels == 3 || channels == 1 {
            // Three running sums make the additions independent. They are added in the order red, green, blue, so that the
            // order of the channels in memory does not change a bit.
            let [first, second, third] = if self.layout == Layout::Bgr { [2, 1, 0] } else { [0, 1, 2] };
            for (sum, block) in sums.iter_mut().zip(blocks) {
                let mut part = [0.0_f32; 3];
                let (triples, rest) = block.as_chunks::<3>();
                for t in triples {
                    part[0] += light(t[0]);
                    part[1] += light(t[1]);
                    part[2] += light(t[2]);
                }
                let rest: f32 = rest.iter().map(|c| light(*c)).sum();
                *sum += (part[first] + part[second] + part[third] + rest) / channels as f32;
            }
        } else {
            // Alpha has no part in the mean.
            let [r, g, b] = self.layout.rgb_offsets();
            let colors = self.layout.has_color();
            for (sum, block) in sums.iter_mut().zip(blocks) {
                let pixels = block.chunks_exact(channels);
                *sum += if colors {
                    pixels.map(|p| light(p[r]) + light(p[g]) + light(p[b])).sum::<f32>() / 3.0
                } else {
                    pixels.map(|p| light(p[0])).sum()
                };
            }
        }
    }
}

impl<'a> TryFrom<&'a DynamicImage> for PhotoView<'a> {
    type Error = Error;

    /// A view of a decoded picture; floating-point pictures are refused.
    fn try_from(image: &'a DynamicImage) -> Result<Self> {
        let (samples, layout) = match image {
            DynamicImage::ImageLuma8(i) => (Samples::U8(i.as_raw()), Layout::Grey),
            DynamicImage::ImageLumaA8(i) => (Samples::U8(i.as_raw()), Layout::GreyAlpha),
            DynamicImage::ImageRgb8(i) => (Samples::U8(i.as_raw()), Layout::Rgb),
            DynamicImage::ImageRgba8(i) => (Samples::U8(i.as_raw()), Layout::Rgba),
            DynamicImage::ImageLuma16(i) => (Samples::U16(i.as_raw()), Layout::Grey),
            DynamicImage::ImageLumaA16(i) => (Samples::U16(i.as_raw()), Layout::GreyAlpha),
            DynamicImage::ImageRgb16(i) => (Samples::U16(i.as_raw()), Layout::Rgb),
            DynamicImage::ImageRgba16(i) => (Samples::U16(i.as_raw()), Layout::Rgba),
            other => {
                return Err(Error::invalid(
                    ErrorSubject::Photograph,
                    "8 or 16 bit, grey or RGB(A)",
                    format!("{:?}", other.color()),
                ));
            }
        };
        let (width, height) = (image.width() as usize, image.height() as usize);
        Self::new(samples, width, height, width * layout.channels(), layout)
    }
}

impl<'a> TryFrom<&'a RgbImage> for PhotoView<'a> {
    type Error = Error;

    /// A view of an 8-bit RGB picture; one without pixels is refused.
    fn try_from(image: &'a RgbImage) -> Result<Self> {
        let (width, height) = (image.width() as usize, image.height() as usize);
        Self::new(Samples::U8(image.as_raw()), width, height, 3 * width, Layout::Rgb)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::layouts;

    #[test]
    fn layouts_depths_and_strides_give_the_same_light() {
        let (width, height) = (5, 4);
        let rgb: Vec<u8> = (0..3 * width * height).map(|i| (i * 37 % 251) as u8).collect();
        let mut first: Option<(Vec<[f32; 3]>, Vec<f32>)> = None;
        for (bytes, layout, stride) in layouts(&rgb, width) {
            let wide: Vec<u16> = bytes.iter().map(|&c| u16::from(c) * 257).collect();
            for samples in [Samples::U8(&bytes), Samples::U16(&wide)] {
                let view = PhotoView::new(samples, width, height, stride, layout).unwrap();
                let table = view.linear_table(Encoding::Srgb);
                let mut light = vec![[0.0; 3]; width * height];
                let mut total = vec![0.0; width];
                for (y, row) in light.chunks_exact_mut(width).enumerate() {
                    view.linear_rgb_row(y, &table, row);
                    view.linear_total_row(y, &table, &mut total);
                    assert!(row.iter().zip(&total).all(|(p, t)| p[0] + p[1] + p[2] == *t));
                    assert!((0..width).all(|x| view.linear_rgb(x, y, &table) == row[x]));
                    assert!((0..width).all(|x| view.rgb_bytes(x, y) == rgb[3 * (y * width + x)..][..3]));
                }
                let mut blocks = vec![0.0; 2];
                view.add_block_sums(1, 2, &table, &mut blocks);
                let first = first.get_or_insert_with(|| (light.clone(), blocks.clone()));
                assert_eq!(light, first.0, "{layout:?}");
                let near = blocks.iter().zip(&first.1).all(|(a, b)| (a - b).abs() < 1e-6);
                assert!(near, "{layout:?}: {blocks:?} {:?}", first.1);
            }
        }
    }

    #[test]
    fn too_few_samples_are_refused() {
        assert!(PhotoView::new(Samples::U8(&[0; 11]), 2, 2, 6, Layout::Rgb).is_err());
        assert!(PhotoView::new(Samples::U8(&[0; 12]), 2, 2, 5, Layout::Rgb).is_err());
        assert!(PhotoView::new(Samples::U8(&[]), 0, 0, 0, Layout::Rgb).is_err());
    }
}
