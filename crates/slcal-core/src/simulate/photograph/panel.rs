//! The light of the projector, averaged over any part of its panel.

use image::RgbImage;

use super::blur::{Border, blur};
use super::radial_falloff::RadialFalloff;
use crate::photo::Encoding;

/// Largest subdivision of a panel's pixel for its blur. The remaining steps are half a pixel wide, which the camera's
/// own pixels hide.
const BLUR_DIVISIONS: usize = 2;
/// Smallest width of a part of the panel, px: the difference of sums keeps its digits, and no pixel's light changes
/// within it.
const THINNEST_PX: f64 = 1.0 / 64.0;

/// How a projector turns the values of a picture into light.
#[derive(Debug, Clone, Copy)]
pub(super) struct Emission {
    /// Linear light of a value.
    pub(super) curve: Encoding,
    /// Light where the picture is black, as a share of full light.
    pub(super) black: f64,
    /// σ of the Gaussian blur, panel px.
    pub(super) blur_px: f64,
    /// Share of the light that is lost in the panel's corners.
    pub(super) falloff: f64,
}

/// Linear light of a panel as a summed-area table at the pixels' corners. A pixel is a square of constant light;
/// outside the panel it is dark.
pub(super) struct Panel {
    sums: Vec<[f64; 3]>,
    width: usize,
    height: usize,
    divisions: f64,
}

impl Panel {
    /// Of a picture.
    pub(super) fn new(picture: &RgbImage, emission: &Emission) -> Self {
        let Emission { curve, black, blur_px, falloff } = *emission;
        let table: Vec<f64> =
            (0..=255_u8).map(|c| black + (1.0 - black) * curve.to_linear(f64::from(c) / 255.0)).collect();
        let n = if blur_px > 0.0 { BLUR_DIVISIONS } else { 1 };
        let (width, height) = (picture.width() as usize * n, picture.height() as usize * n);
        let falloff = RadialFalloff::new(falloff, width, height);
        let light = |x: usize, y: usize| {
            let left = falloff.at(x, y);
            picture.get_pixel((x / n) as u32, (y / n) as u32).0.map(|c| left * table[usize::from(c)])
        };
        let mut values: Vec<[f64; 3]> = Vec::with_capacity(width * height);
        for y in 0..height {
            values.extend((0..width).map(|x| light(x, y)));
        }
        if blur_px > 0.0 {
            blur(&mut values, width, blur_px * n as f64, Border::Dark);
        }
        let mut sums = vec![[0.0; 3]; (width + 1) * (height + 1)];
        for y in 0..height {
            let mut row = [0.0; 3];
            for x in 0..width {
                let above = sums[y * (width + 1) + x + 1];
                for c in 0..3 {
                    row[c] += values[y * width + x][c];
                    sums[(y + 1) * (width + 1) + x + 1][c] = above[c] + row[c];
                }
            }
        }
        Self { sums, width, height, divisions: n as f64 }
    }

    /// Mean light of the upright rectangle around panel position (`x`, `y`), pixel centres at integers, px.
    pub(super) fn mean(&self, x: f64, y: f64, width: f64, height: f64) -> [f64; 3] {
        let (w, h) = (width.max(THINNEST_PX), height.max(THINNEST_PX));
        let [x, y] = [x + 0.5, y + 0.5];
        let [x0, x1] = [x - w / 2.0, x + w / 2.0].map(|v| v * self.divisions);
        let [y0, y1] = [y - h / 2.0, y + h / 2.0].map(|v| v * self.divisions);
        let corners = [self.sum(x0, y0), self.sum(x1, y0), self.sum(x0, y1), self.sum(x1, y1)];
        let area = (x1 - x0) * (y1 - y0);
        std::array::from_fn(|c| {
            ((corners[3][c] - corners[1][c] - corners[2][c] + corners[0][c]) / area).max(0.0)
        })
    }

    /// The integral over everything above and left: linear within a pixel, since its light is constant.
    fn sum(&self, x: f64, y: f64) -> [f64; 3] {
        let (x, y) = (x.clamp(0.0, self.width as f64), y.clamp(0.0, self.height as f64));
        let (i, j) = ((x as usize).min(self.width - 1), (y as usize).min(self.height - 1));
        let (s, t) = (x - i as f64, y - j as f64);
        let at = j * (self.width + 1) + i;
        let (a, b) = (&self.sums[at], &self.sums[at + 1]);
        let (c, d) = (&self.sums[at + self.width + 1], &self.sums[at + self.width + 2]);
        std::array::from_fn(|k| (1.0 - t) * ((1.0 - s) * a[k] + s * b[k]) + t * ((1.0 - s) * c[k] + s * d[k]))
    }
}
