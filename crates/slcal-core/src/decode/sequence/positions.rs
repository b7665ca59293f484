//! Planes → positions of every pixel, and what is reported of them.

use super::code_borders::CodeBorders;
use super::folded_frames::FoldedFrames;
use super::frame_checks::FrameChecks;
use super::frame_noise::FrameNoise;
use super::frame_plan::FramePlan;
use super::phase_positions::position;
use super::pixel_code::{PixelCell, Unread, cell_of, least_contrast};
use super::planes::AxisPlanes;
use super::report::{SequenceDecodeConfig, SequenceDecodeReport, SequenceDecoding};
use super::result_checks::{check_parallax, check_seen};
use crate::dense_matches::DenseMatches;
use crate::error::Result;
use crate::pattern::{Axis, SequencePattern};
use crate::solve::median;

/// A pixel is lit when white less black is more than this many times its noise.
const LIT_SIGMAS: f32 = 5.0;
/// Columns of the image whose lines are read together.
const BLOCK: usize = 32;
/// Medians are those of about this many pixels, spread evenly.
const SAMPLE: usize = 1 << 14;

/// The panel coordinates of every pixel, from frames that have all come.
///
/// # Errors
/// As [`SequenceDecoder::finish`](super::SequenceDecoder::finish).
pub(super) fn decoding(
    folded: &FoldedFrames,
    plan: &FramePlan,
    pattern: &SequencePattern,
    config: SequenceDecodeConfig,
) -> Result<SequenceDecoding> {
    let noise = FrameNoise::of(&folded.samples, plan, folded.scale);
    let checks = FrameChecks { samples: &folded.samples, plan, noise: &noise, scale: folded.scale };
    let warnings = checks.check()?;
    let read = Reader { state: folded, noise: &noise, paired: plan.partners.iter().any(Option::is_some) };
    let mut decoding = SequenceDecoding::default();
    let DenseMatches { width, height, column, sigma_column, row, sigma_row, confidence, color } =
        &mut decoding.matches;
    (*width, *height) = (folded.width, folded.height);
    confidence.resize(folded.width * folded.height, 1.0);
    let mut counts = Counts::default();
    if let Some(planes) = &folded.planes.axes[0] {
        read.axis(planes, Axis::Columns, [column, sigma_column], confidence, &mut counts);
    }
    if let Some(planes) = &folded.planes.axes[1] {
        read.axis(planes, Axis::Rows, [row, sigma_row], confidence, &mut counts);
    }
    color.clone_from(&folded.planes.color);
    if config.mirrored {
        let last = (pattern.projector[0] - 1) as f32;
        for c in column.iter_mut() {
            *c = last - *c;
        }
    }
    decoding.report = read.report(plan.lights.len(), &decoding.matches, &counts);
    decoding.report.warnings = warnings;
    check_seen(&decoding.report)?;
    check_parallax(&decoding.matches, pattern.projector)?;
    Ok(decoding)
}

/// Pixels by what became of them, and samples of what is reported.
#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    undecided: usize,
    contradicting: usize,
}

impl Counts {
    fn count(&mut self, unread: Unread) {
        match unread {
            Unread::Undecided => self.undecided += 1,
            Unread::Contradicting => self.contradicting += 1,
        }
    }
}

/// Reads positions from the planes.
struct Reader<'a> {
    state: &'a FoldedFrames,
    noise: &'a FrameNoise,
    /// Whether bits have inverses.
    paired: bool,
}

impl Reader<'_> {
    /// White less black of a pixel, where both are shown.
    #[inline]
    fn lit(&self, pixel: usize) -> Option<f32> {
        let planes = &self.state.planes;
        let white = planes.white.get(pixel)?;
        Some(f32::from(*white) - f32::from(*planes.black.get(pixel)?))
    }

    /// The noise of a pixel's levels.
    #[inline]
    fn sigma(&self, pixel: usize) -> f32 {
        let planes = &self.state.planes;
        let level = match (planes.white.get(pixel), planes.black.get(pixel)) {
            (Some(w), Some(b)) => 0.5 * (f32::from(*w) + f32::from(*b)),
            (Some(w), None) => 0.5 * f32::from(*w),
            _ => 0.5 * f32::from(self.state.scale.full),
        };
        self.noise.at(level)
    }

    /// Whether the projector lights a pixel, as far as this axis shows it.
    #[inline]
    fn is_lit(&self, planes: &AxisPlanes, pixel: usize, sigma: f32) -> bool {
        let least = LIT_SIGMAS * std::f32::consts::SQRT_2 * sigma;
        match self.lit(pixel) {
            Some(lit) => lit > least,
            None if planes.word.is_empty() => true,
            // The second least contrast of all: one bit may be undecided.
            None => 2.0 * f32::from(planes.weakest[pixel][1]) > least,
        }
    }

    /// Positions of all pixels along an axis, with σ.
    fn axis(
        &self,
        planes: &AxisPlanes,
        axis: Axis,
        [to, to_sigma]: [&mut Vec<f32>; 2],
        confidence: &mut [f32],
        counts: &mut Counts,
    ) {
        let pixels = self.state.width * self.state.height;
        to.clear();
        to.resize(pixels, f32::NAN);
        to_sigma.clear();
        to_sigma.resize(pixels, f32::NAN);
        if planes.code.sinusoid.is_some() {
            for pixel in 0..pixels {
                let sigma = self.sigma(pixel);
                if !self.is_lit(planes, pixel, sigma) {
                    continue;
                }
                let cell =
                    if planes.code.bits == 0 { Ok(None) } else { self.cell(planes, pixel, sigma).map(Some) };
                match cell.and_then(|cell| position(planes, pixel, cell, sigma)) {
                    Ok((at, sigma)) => (to[pixel], to_sigma[pixel]) = (at, sigma),
                    Err(unread) => counts.count(unread),
                }
            }
        } else {
            self.lines(planes, axis, to, to_sigma, counts);
        }
        for (pixel, confidence) in confidence.iter_mut().enumerate() {
            if to[pixel].is_finite() {
                *confidence = confidence.min(self.confidence(planes, pixel));
            }
        }
    }

    fn cell(&self, planes: &AxisPlanes, pixel: usize, sigma: f32) -> std::result::Result<PixelCell, Unread> {
        cell_of(planes, pixel, least_contrast(sigma, self.lit(pixel), self.paired))
    }

    /// The contrast that the position rests on, as a share of white less black.
    fn confidence(&self, planes: &AxisPlanes, pixel: usize) -> f32 {
        let Some(lit) = self.lit(pixel) else { return 1.0 };
        let contrast = match planes.code.sinusoid {
            Some((_, steps)) => 4.0 / steps as f32 * planes.cosine[pixel].hypot(planes.sine[pixel]),
            None => 2.0 * f32::from(planes.weakest[pixel][1]),
        };
        (contrast / lit).clamp(0.0, 1.0)
    }

    /// Positions by the borders of the code along lines of the image: rows for columns of the panel, columns for its rows.
    fn lines(
        &self,
        planes: &AxisPlanes,
        axis: Axis,
        to: &mut [f32],
        to_sigma: &mut [f32],
        counts: &mut Counts,
    ) {
        let FoldedFrames { width, height, .. } = *self.state;
        let (lines, length, block) = match axis {
            Axis::Columns => (height, width, 1),
            // Columns of the image that lie in the same lines of the cache.
            Axis::Rows => (width, height, BLOCK),
        };
        let index = |line: usize, i: usize| match axis {
            Axis::Columns => line * width + i,
            Axis::Rows => i * width + line,
        };
        let mut borders = CodeBorders::default();
        let mut cells = vec![u16::MAX; block * length];
        let mut found = vec![(f32::NAN, f32::NAN); block * length];
        for first in (0..lines).step_by(block) {
            let block = first..(first + block).min(lines);
            for i in 0..length {
                for line in block.clone() {
                    let pixel = index(line, i);
                    let sigma = self.sigma(pixel);
                    let cell = &mut cells[(line - first) * length + i];
                    *cell = u16::MAX;
                    if self.is_lit(planes, pixel, sigma) {
                        match self.cell(planes, pixel, sigma) {
                            Ok(read) => *cell = read.cell,
                            Err(unread) => counts.count(unread),
                        }
                    }
                }
            }
            for line in block.clone() {
                let part = (line - first) * length..(line - first + 1) * length;
                let sigma = |i: usize| self.sigma(index(line, i));
                borders.line(planes, &cells[part.clone()], |i| index(line, i), sigma, &mut found[part]);
            }
            for i in 0..length {
                for line in block.clone() {
                    (to[index(line, i)], to_sigma[index(line, i)]) = found[(line - first) * length + i];
                }
            }
        }
    }

    fn report(&self, frames: usize, matches: &DenseMatches, counts: &Counts) -> SequenceDecodeReport {
        let pixels = self.state.width * self.state.height;
        let full = f64::from(self.state.scale.full);
        let planes = &self.state.planes;
        let is_lit = |pixel: usize| {
            let sigma = self.sigma(pixel);
            planes.axes.iter().flatten().any(|axis| self.is_lit(axis, pixel, sigma))
        };
        let step = pixels.div_ceil(SAMPLE).max(1);
        let sampled: Vec<usize> = (0..pixels).step_by(step).filter(|i| is_lit(*i)).collect();
        let middle = |of: &dyn Fn(usize) -> Option<f32>| {
            let mut values: Vec<f64> =
                sampled.iter().filter_map(|i| of(*i)).filter(|x| x.is_finite()).map(f64::from).collect();
            median(&mut values)
        };
        let of_plane = |plane: &[f32]| middle(&|i| plane.get(i).copied());
        SequenceDecodeReport {
            frames,
            pixels,
            lit: (0..pixels).filter(|i| is_lit(*i)).count(),
            decoded: matches.known(),
            undecided: counts.undecided,
            contradicting: counts.contradicting,
            noise: middle(&|i| Some(self.sigma(i))).unwrap_or(0.0) / full,
            contrast: middle(&|i| self.lit(i)).map(|c| c / full),
            median_sigma_column_px: of_plane(&matches.sigma_column),
            median_sigma_row_px: of_plane(&matches.sigma_row),
            warnings: Vec::new(),
        }
    }
}
