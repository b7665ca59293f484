//! Estimates before detection: the direction of the stripes, their width and their sharpness.

use super::config::ScanDirection;
use super::noise::Noise;
use super::peaks::Peak;
use super::scanlines::{Scanline, ScanlineReader};
use super::stripe_edges::{FilterRadii, Scratch, peaks_of};
use crate::solve::median_f32;

/// Scanlines that are sampled.
const LINES: usize = 12;
/// Neighbouring stripes are about equally far apart: within this ratio, blur and slant included.
const REGULAR: f32 = 1.7;
/// The least smoothing is taken that finds this share of what the best one finds.
const ENOUGH: f64 = 0.85;
const GONE: f64 = 0.5;
/// Smoothing over this share of a stripe's width keeps stripes of half the usual width visible.
const SMOOTHING_SHARE: f32 = 0.33;
/// Fewer peaks than this per scanline on average are no stripes.
const MIN_PER_LINE: f64 = 2.0;

/// Estimates from a few scanlines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StripeScale {
    pub(super) scan: ScanDirection,
    pub(super) radii: FilterRadii,
    /// Half the usual distance between neighbouring stripes, px.
    pub(super) half_period_px: f32,
    /// Length of the scanlines that regular peaks cover, px: how much of the photograph looks like stripes.
    pub(super) covered_px: f64,
}

/// Working memory of [`measure_scale`].
#[derive(Debug, Clone, Default)]
pub(super) struct ScaleScratch {
    lines: Vec<Scanline>,
    scratch: Scratch,
    spacings: Vec<f32>,
    sharpness: Vec<f32>,
}

/// Estimates direction, width and sharpness from scanlines of one direction; `None` where there is no regular row of
/// peaks.
pub(super) fn measure_scale(
    reader: &ScanlineReader<'_>,
    noise: &Noise,
    work: &mut ScaleScratch,
) -> Option<StripeScale> {
    let count = LINES.min(reader.count());
    work.lines.resize_with(LINES, Scanline::default);
    for (k, line) in work.lines.iter_mut().take(count).enumerate() {
        reader.read(reader.spread(k, count), line);
    }
    let lines = &work.lines[..count];
    // Reaches of 0, 1, 3, 7 … pixels.
    let reaches = (0..12).map(|k| (1_usize << k) - 1).take_while(|r| 8 * r < reader.length());
    let mut best: Option<(usize, f64)> = None;
    for reach in reaches {
        let mut covered = 0.0;
        for line in lines {
            let peaks = peaks_of(&line.total, reach, noise, &mut work.scratch);
            regular(peaks, |_, spacing| covered += f64::from(spacing));
        }
        if best.is_none_or(|(_, most)| ENOUGH * covered > most) {
            best = Some((reach, covered));
        }
        // The stripes are smoothed away: more smoothing brings nothing back.
        if best.is_some_and(|(_, most)| covered < GONE * most) {
            break;
        }
    }
    let (reach, covered_px) = best?;
    work.spacings.clear();
    work.sharpness.clear();
    for line in lines {
        let peaks = peaks_of(&line.total, reach, noise, &mut work.scratch);
        let (spacings, sharpness) = (&mut work.spacings, &mut work.sharpness);
        regular(peaks, |peak, spacing| {
            spacings.push(spacing);
            sharpness.extend(edge_lengths(&line.total, peak).into_iter().flatten());
        });
    }
    if (work.spacings.len() as f64) < MIN_PER_LINE * count as f64 {
        return None;
    }
    let half_period_px = 0.5 * median_f32(&mut work.spacings)?;
    let blur = median_f32(&mut work.sharpness).unwrap_or(1.0);
    let by_width = ((SMOOTHING_SHARE * half_period_px - 1.0) / 2.0).round().max(0.0) as usize;
    let radii = FilterRadii { smoothing: by_width.max(reach), edge: blur.round() as usize + 1 };
    Some(StripeScale { scan: reader.scan, radii, half_period_px, covered_px })
}

/// Calls `each` with every peak about as far from the next one as from the previous one, and with that distance, px.
fn regular(peaks: &[Peak], mut each: impl FnMut(Peak, f32)) {
    for w in peaks.windows(3) {
        let (a, b) = ((w[1].top - w[0].top) as f32, (w[2].top - w[1].top) as f32);
        if a < REGULAR * b && b < REGULAR * a {
            each(w[1], 0.5 * (a + b));
        }
    }
}

/// Height over steepest step: the lengths of the edges before and after a peak, px.
fn edge_lengths(light: &[f32], peak: Peak) -> [Option<f32>; 2] {
    let [before, top, after] = [peak.before, peak.top, peak.after].map(|x| x as usize);
    let length = |edge: &[f32], sign: f32| {
        let steepest = edge.windows(2).map(|w| sign * (w[1] - w[0])).fold(0.0, f32::max);
        let height = sign * (edge.last()? - edge.first()?);
        (steepest > 0.0).then(|| height / steepest)
    };
    [length(&light[before..=top], 1.0), length(&light[top..=after], -1.0)]
}
