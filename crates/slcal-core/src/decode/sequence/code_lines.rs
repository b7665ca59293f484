//! Positions by the code alone along the lines of the image: rows of the image for columns of the panel, columns of the image for its rows.

use super::code_borders::{Line, LineRun};
use super::disorder::{settle_columns, settle_row};
use super::folded_band::FoldedBand;
use super::folded_frames::FoldedFrames;
use super::pixel_light::PixelLight;
use super::planes::{AxisPlanes, Planes};

/// A row of a band.
struct Row<'a> {
    light: &'a PixelLight,
    planes: &'a Planes,
    axis: &'a AxisPlanes,
    /// The row's first pixel in the band.
    first: usize,
    cells: &'a [u16],
    to: &'a mut [f32],
    to_sigma: &'a mut [f32],
}

impl Line for Row<'_> {
    #[inline]
    fn cell(&self, i: usize) -> u16 {
        self.cells[i]
    }

    #[inline]
    fn contrast(&self, i: usize, bit: u32) -> i16 {
        self.axis.contrast(self.first + i, bit)
    }

    #[inline]
    fn sigma(&self, i: usize) -> f32 {
        self.light.contrast_sigma(self.planes, self.first + i)
    }

    #[inline]
    fn full_contrast(&self, i: usize) -> f32 {
        PixelLight::lit(self.planes, self.first + i).unwrap_or(0.0)
    }

    #[inline]
    fn put(&mut self, i: usize, position: f32, sigma: f32) {
        (self.to[i], self.to_sigma[i]) = (position, sigma);
    }
}

/// Positions of the panel's columns in one band, along its rows. `cells` are those of its pixels.
pub(super) fn column_positions(
    band: &FoldedBand,
    light: &PixelLight,
    cells: &[u16],
    width: usize,
    [to, to_sigma]: [&mut [f32]; 2],
) {
    let planes = &band.planes;
    let Some(axis) = &planes.axes[0] else { return };
    let cell_px = axis.code.cell_px as f32;
    let mut before = Vec::with_capacity(width);
    let rows =
        cells.chunks_exact(width).zip(to.chunks_exact_mut(width)).zip(to_sigma.chunks_exact_mut(width));
    for (y, ((cells, to), to_sigma)) in rows.enumerate() {
        let mut line = Row { light, planes, axis, first: y * width, cells, to, to_sigma };
        let mut run = LineRun::default();
        for (i, cell) in cells.iter().enumerate() {
            run.next(&mut line, cell_px, i, *cell);
        }
        run.end(&mut line, cell_px, width);
        settle_row(cell_px, cells, line.to, line.to_sigma, &mut before);
    }
}

/// The columns of the image, of which row after row is read: what is near in it is near in memory.
struct Columns<'a> {
    light: &'a PixelLight,
    folded: &'a FoldedFrames,
    cells: &'a [Vec<u16>],
    /// The one that is read.
    x: usize,
    to: &'a mut [f32],
    to_sigma: &'a mut [f32],
}

impl Columns<'_> {
    #[inline]
    fn at(&self, y: usize) -> (&Planes, usize) {
        let (band, y) = self.folded.band_of(y);
        (&band.planes, y * self.folded.width + self.x)
    }
}

impl Line for Columns<'_> {
    #[inline]
    fn cell(&self, i: usize) -> u16 {
        let (band, y) = self.folded.band_row(i);
        self.cells[band][y * self.folded.width + self.x]
    }

    #[inline]
    fn contrast(&self, i: usize, bit: u32) -> i16 {
        let (planes, pixel) = self.at(i);
        planes.axes[1].as_ref().map_or(0, |axis| axis.contrast(pixel, bit))
    }

    #[inline]
    fn sigma(&self, i: usize) -> f32 {
        let (planes, pixel) = self.at(i);
        self.light.contrast_sigma(planes, pixel)
    }

    #[inline]
    fn full_contrast(&self, i: usize) -> f32 {
        let (planes, pixel) = self.at(i);
        PixelLight::lit(planes, pixel).unwrap_or(0.0)
    }

    #[inline]
    fn put(&mut self, i: usize, position: f32, sigma: f32) {
        let at = i * self.folded.width + self.x;
        (self.to[at], self.to_sigma[at]) = (position, sigma);
    }
}

/// Positions of the panel's rows along the columns of the image. `cells` has those of every band.
pub(super) fn row_positions(
    folded: &FoldedFrames,
    light: &PixelLight,
    cells: &[Vec<u16>],
    cell_px: u32,
    [to, to_sigma]: [&mut [f32]; 2],
) {
    let (width, height, cell_px) = (folded.width, folded.height, cell_px as f32);
    let row = |y: usize| {
        let (band, y) = folded.band_row(y);
        &cells[band][y * width..(y + 1) * width]
    };
    let mut runs = vec![LineRun::default(); width];
    let mut columns = Columns { light, folded, cells, x: 0, to, to_sigma };
    for y in 0..height {
        for (x, (run, cell)) in runs.iter_mut().zip(row(y)).enumerate() {
            columns.x = x;
            run.next(&mut columns, cell_px, y, *cell);
        }
    }
    for (x, run) in runs.iter_mut().enumerate() {
        columns.x = x;
        run.end(&mut columns, cell_px, height);
    }
    settle_columns(cell_px, width, row, columns.to, columns.to_sigma);
}
