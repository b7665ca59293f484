//! Planes → positions of every pixel.

use super::code_lines::{column_positions, row_positions};
use super::folded_band::FoldedBand;
use super::folded_frames::FoldedFrames;
use super::phase_positions::position;
use super::pixel_code::{PixelCounts, cell_of, read_cells};
use super::pixel_light::PixelLight;
use super::planes::{AxisPlanes, Planes};
use crate::decode::in_threads::for_each;

/// Writes the positions of all pixels along an axis (0: columns, 1: rows), with σ, and lowers the confidence to that of this axis. `least`
/// are the contrasts of each band that are certain, as far as the other axis has asked for them.
pub(super) fn axis_positions(
    folded: &FoldedFrames,
    light: &PixelLight,
    axis: usize,
    parallel: bool,
    [to, to_sigma]: [&mut Vec<f32>; 2],
    confidence: &mut [f32],
    least: &mut [Vec<i16>],
) -> PixelCounts {
    let Some(code) = folded.bands.first().and_then(|band| band.planes.axes[axis].as_ref()).map(|a| a.code)
    else {
        return PixelCounts::default();
    };
    let pixels = folded.width * folded.height;
    to.resize(pixels, f32::NAN);
    to_sigma.resize(pixels, f32::NAN);
    let chunk = folded.band_rows * folded.width;
    let mut cells = vec![Vec::new(); folded.bands.len()];
    let mut parts: Vec<Part<'_>> = folded
        .bands
        .iter()
        .zip(cells.iter_mut().zip(least))
        .zip(to.chunks_mut(chunk).zip(to_sigma.chunks_mut(chunk)))
        .map(|((band, (cells, least)), (to, to_sigma))| Part {
            band,
            cells,
            least,
            to,
            to_sigma,
            counts: PixelCounts::default(),
        })
        .collect();
    for_each(&mut parts, parallel, |(_, part)| part.read(light, axis, folded.width));
    let counts = parts.iter().fold(PixelCounts::default(), |sum, part| sum + part.counts);
    if code.sinusoid.is_none() && axis == 1 {
        row_positions(folded, light, &cells, code.cell_px, [to, to_sigma]);
    }
    let mut parts: Vec<_> =
        folded.bands.iter().zip(to.chunks(chunk)).zip(confidence.chunks_mut(chunk)).collect();
    for_each(&mut parts, parallel, |(_, ((band, to), confidence))| {
        if let Some(of_axis) = &band.planes.axes[axis] {
            lower_confidence(&band.planes, of_axis, to, confidence);
        }
    });
    counts
}

/// A band, and its part of the result.
struct Part<'a> {
    band: &'a FoldedBand,
    cells: &'a mut Vec<u16>,
    least: &'a mut Vec<i16>,
    to: &'a mut [f32],
    to_sigma: &'a mut [f32],
    counts: PixelCounts,
}

impl Part<'_> {
    /// Positions by the phase or along rows; for what is read along columns, cells.
    fn read(&mut self, light: &PixelLight, axis: usize, width: usize) {
        let planes = &self.band.planes;
        let Some(of_axis) = &planes.axes[axis] else { return };
        if of_axis.code.sinusoid.is_some() {
            self.read_phases(light, of_axis);
            return;
        }
        // The same for both axes where white and black are shown.
        if self.least.is_empty() || planes.white.is_empty() || planes.black.is_empty() {
            light.least_contrasts(planes, of_axis, self.least);
        }
        read_cells(of_axis, self.least, self.cells, &mut self.counts);
        if axis == 0 {
            column_positions(self.band, light, self.cells, width, [self.to, self.to_sigma]);
        }
    }

    fn read_phases(&mut self, light: &PixelLight, axis: &AxisPlanes) {
        let planes = &self.band.planes;
        for (pixel, to) in self.to.iter_mut().zip(self.to_sigma.iter_mut()).enumerate() {
            if !light.is_lit(planes, axis, pixel) {
                continue;
            }
            self.counts.lit += 1;
            let cell = match axis.code.bits {
                0 => Ok(None),
                _ => cell_of(axis, pixel, light.least_contrast(planes, pixel)).map(Some),
            };
            match cell.and_then(|cell| position(axis, pixel, cell, light.sigma(planes, pixel))) {
                Ok((at, sigma)) => (*to.0, *to.1) = (at, sigma),
                Err(unread) => self.counts.count(unread),
            }
        }
    }
}

/// The contrast that a position rests on, as a share of white less black, where it is less than the confidence so far.
fn lower_confidence(planes: &Planes, axis: &AxisPlanes, to: &[f32], confidence: &mut [f32]) {
    let scale = axis.code.sinusoid.map(|(_, steps)| 4.0 / steps as f32);
    let lit = planes.white.iter().zip(&planes.black).map(|(w, b)| f32::from(*w) - f32::from(*b));
    for (pixel, ((to, confidence), lit)) in to.iter().zip(confidence).zip(lit).enumerate() {
        let contrast = match scale {
            Some(scale) => {
                let (cosine, sine) = (axis.cosine[pixel], axis.sine[pixel]);
                scale * (cosine * cosine + sine * sine).sqrt()
            }
            None => f32::from(axis.second[pixel]),
        };
        let share = (contrast / lit).clamp(0.0, 1.0);
        *confidence = if to.is_finite() { confidence.min(share) } else { *confidence };
    }
}
