//! The width of the stripes, measured before anything else.

use super::noise::Noise;
use super::peaks::{PeakFinder, ladder};

/// Narrowest stripe that can be seen, px.
const MIN_WIDTH_PX: f64 = 1.4;
/// Widest stripe, as a share of the line: fewer than four stripes carry no code.
const MAX_WIDTH_SHARE: f64 = 1.0 / 8.0;
/// Maxima of the filter whose widths differ by more than this do not hide each other while the width is unknown: a
/// bright object is no reason not to see the stripes on it.
const MERGE_RATIO: f32 = 2.0;
/// Stripes on surfaces at other distances and slants than most: sought from a third to three times the usual width.
const RANGE: f64 = 3.0;
/// A maximum counts when it rises above this share of the light there.
const MIN_SHARE_OF_LIGHT: f32 = 0.2;
/// Fewer maxima than this per line on average are no stripes.
pub(super) const MIN_PEAKS_PER_LINE: f64 = 3.0;

/// What a look at a few lines tells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WidthEstimate {
    /// Width of most stripes, px.
    pub(super) typical_px: f64,
    /// Maxima of about that width per line.
    pub(super) per_line: f64,
}

/// Weighs maxima by width over the given lines and takes the width where most of their weight is; `None` when there is hardly any.
pub(super) fn estimate<'l>(
    lines: impl Iterator<Item = &'l [[f32; 3]]>,
    length: usize,
    noise: &Noise,
) -> Option<WidthEstimate> {
    let widths = ladder(MIN_WIDTH_PX, (length as f64 * MAX_WIDTH_SHARE).max(2.0 * MIN_WIDTH_PX));
    let mut counts = vec![0.0_f64; widths.len()];
    let mut maxima = counts.clone();
    let mut finder = PeakFinder::new(widths.clone());
    let mut number = 0;
    for line in lines {
        number += 1;
        for c in finder.candidates(line, noise, MERGE_RATIO) {
            let light = line[c.u].iter().sum::<f32>();
            if c.response > MIN_SHARE_OF_LIGHT * light {
                let k = widths.iter().position(|&w| w as f32 >= c.width - 1e-3).unwrap_or(0);
                // Weighted by height, so that many wiggles of the noise do not outvote the stripes.
                counts[k] += f64::from(c.response);
                maxima[k] += 1.0;
            }
        }
    }
    let smooth = |k: usize| {
        let at = |i: Option<usize>| i.and_then(|i| counts.get(i)).copied().unwrap_or(0.0);
        at(k.checked_sub(1)) + 2.0 * at(Some(k)) + at(Some(k + 1))
    };
    let mode = (0..counts.len()).max_by(|&a, &b| smooth(a).total_cmp(&smooth(b)))?;
    let near = mode.saturating_sub(2)..(mode + 3).min(counts.len());
    let (mut weight, mut log_width, mut number_near) = (0.0, 0.0, 0.0);
    for k in near {
        weight += counts[k];
        log_width += counts[k] * widths[k].ln();
        number_near += maxima[k];
    }
    let per_line = number_near / f64::from(number.max(1));
    (weight > 0.0 && per_line >= MIN_PEAKS_PER_LINE)
        .then(|| WidthEstimate { typical_px: (log_width / weight).exp(), per_line })
}

/// The filter widths for a photograph whose stripes are typically this wide.
pub(super) fn search_widths(typical_px: f64, length: usize) -> Vec<f64> {
    let widest = (typical_px * RANGE).min(length as f64 / 4.0);
    ladder((typical_px / RANGE).max(MIN_WIDTH_PX).min(typical_px), widest)
}
