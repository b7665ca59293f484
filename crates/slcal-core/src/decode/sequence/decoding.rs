//! Folded frames → the result of decoding: noise, checks, positions, report.

use super::code_borders::MOST_CELLS;
use super::folded_frames::FoldedFrames;
use super::frame_checks::FrameChecks;
use super::frame_noise::{FrameNoise, NoiseOfSums};
use super::frame_plan::FramePlan;
use super::mixed_pixels::drop_mixed;
use super::pixel_code::PixelCounts;
use super::pixel_light::PixelLight;
use super::positions::axis_positions;
use super::report::{SequenceDecodeConfig, SequenceDecodeReport, SequenceDecoding};
use super::result_checks::{check_parallax, check_seen};
use crate::dense_matches::DenseMatches;
use crate::error::Result;
use crate::pattern::{AxisCode, SequencePattern};
use crate::solve::median;

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
    let samples = folded.samples();
    let noise = FrameNoise::of(&samples, plan, folded.scale);
    let warnings = FrameChecks { samples: &samples, plan, noise: &noise, scale: folded.scale }.check()?;
    let light = PixelLight {
        noise: NoiseOfSums::of(&noise, folded.scale),
        unshown: noise.at(0.5 * f32::from(folded.scale.full)),
        paired: plan.partners.iter().any(Option::is_some),
    };
    let mut decoding = SequenceDecoding::default();
    let DenseMatches { width, height, column, sigma_column, row, sigma_row, confidence, color } =
        &mut decoding.matches;
    (*width, *height) = (folded.width, folded.height);
    confidence.resize(folded.width * folded.height, 1.0);
    let axes = [[column, sigma_column], [row, sigma_row]].into_iter().enumerate();
    let mut counts = PixelCounts::default();
    let mut least = vec![Vec::new(); folded.bands.len()];
    for (axis, to) in axes {
        let of_axis = axis_positions(folded, &light, axis, config.parallel, to, confidence, &mut least);
        let lit = counts.lit.max(of_axis.lit);
        counts = PixelCounts { lit, ..counts + of_axis };
    }
    drop(least);
    let codes = folded.bands.iter().take(1).flat_map(|band| band.planes.axes.iter().flatten());
    let jump_px = codes.map(|axis| jump_px(axis.code)).fold(0.0, f32::max);
    color.reserve_exact(folded.bands.iter().map(|band| band.planes.color.len()).sum());
    for band in &folded.bands {
        color.extend_from_slice(&band.planes.color);
    }
    counts.undecided += drop_mixed(&mut decoding.matches, jump_px);
    if config.mirrored {
        let last = (pattern.projector[0] - 1) as f32;
        decoding.matches.column.iter_mut().for_each(|c| *c = last - *c);
    }
    decoding.report = report(folded, &light, plan.lights.len(), &decoding.matches, &counts);
    decoding.report.warnings = warnings;
    check_seen(&decoding.report)?;
    check_parallax(&decoding.matches, pattern.projector)?;
    Ok(decoding)
}

/// Neighbouring pixels of a surface are no farther apart on the panel.
fn jump_px(code: AxisCode) -> f32 {
    match code.sinusoid {
        Some((period, _)) => 0.5 * period as f32,
        None => f32::from(MOST_CELLS) * code.cell_px as f32,
    }
}

fn report(
    folded: &FoldedFrames,
    light: &PixelLight,
    frames: usize,
    matches: &DenseMatches,
    counts: &PixelCounts,
) -> SequenceDecodeReport {
    let pixels = folded.width * folded.height;
    let full = f64::from(folded.scale.full);
    let place = |pixel: usize| {
        let (band, y) = folded.band_of(pixel / folded.width);
        (&band.planes, y * folded.width + pixel % folded.width)
    };
    let is_lit = |pixel: &usize| {
        let (planes, at) = place(*pixel);
        planes.axes.iter().flatten().any(|axis| light.is_lit(planes, axis, at))
    };
    let step = pixels.div_ceil(SAMPLE).max(1);
    let sampled: Vec<usize> = (0..pixels).step_by(step).filter(is_lit).collect();
    let middle = |of: &dyn Fn(usize) -> Option<f32>| {
        let mut values: Vec<f64> =
            sampled.iter().filter_map(|i| of(*i)).filter(|x| x.is_finite()).map(f64::from).collect();
        median(&mut values)
    };
    let of_plane = |plane: &[f32]| middle(&|i| plane.get(i).copied());
    let sigma = |pixel: usize| {
        let (planes, at) = place(pixel);
        Some(light.sigma(planes, at))
    };
    let lit = |pixel: usize| {
        let (planes, at) = place(pixel);
        PixelLight::lit(planes, at)
    };
    SequenceDecodeReport {
        frames,
        pixels,
        lit: counts.lit,
        decoded: matches.known(),
        undecided: counts.undecided,
        contradicting: counts.contradicting,
        noise: middle(&sigma).unwrap_or(0.0) / full,
        contrast: middle(&lit).map(|c| c / full),
        median_sigma_column_px: of_plane(&matches.sigma_column),
        median_sigma_row_px: of_plane(&matches.sigma_row),
        warnings: Vec::new(),
    }
}
