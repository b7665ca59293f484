//! Stripes that are shown smaller than drawn: by a viewer's window, or by a desktop that scales.
//!
//! The slit with the coordinate c then shines from m + s·(c − m), with m the middle of the panel and s the scale, and its
//! light ends inside the panel's borders. With the right s the ends lie on lines parallel to the borders.

use super::border::{BorderPoint, border_at};
use super::slit_ends::{Seen, SlitExtent};
use crate::solve::median;

/// Scales that are told from a rig that has moved. A camera that comes nearer makes the light smaller, too: by 2 % takes
/// 20 mm in a metre. Below the smallest, objects of the height of the light's are more likely.
const SCALES: std::ops::RangeInclusive<f64> = 0.8..=0.98;
/// Both ends are seen of at least this share of the slits.
const SHARE: f64 = 0.6;
/// The outermost slits are seen: they lie this many slits from the panel's borders at most.
const OUTERMOST: f64 = 1.5;
/// Largest difference of the two margins over their sum.
const ASYMMETRY: f64 = 0.5;
/// The scale converges by a factor of ten or more each time; an eighth of the slits' own scatter is enough.
const ROUNDS: usize = 4;

/// The scale, if the slits shine as if they were shown smaller about the panel's middle.
pub(super) fn shown_scale(
    seen: Seen<'_>,
    extents: &[SlitExtent],
    points: &mut Vec<BorderPoint>,
    buffer: &mut Vec<f64>,
) -> Option<f64> {
    let length = seen.positions.length_px(seen.axis);
    let whole = extents.iter().filter(|e| e.ends.iter().all(|end| end.in_frame)).count();
    if (whole as f64) < SHARE * extents.len() as f64 || !reaches_borders(seen, extents) {
        return None;
    }
    let mut scale = heights(seen, extents, 1.0, buffer)? / length;
    if scale > 0.5 * (1.0 + SCALES.end()) {
        return None;
    }
    for _ in 0..ROUNDS {
        scale = heights(seen, extents, scale, buffer)? / length;
    }
    let borders = [0, 1].map(|k| {
        points.clear();
        points.extend(extents.iter().filter_map(|e| point(seen, e, k, scale)));
        border_at(points, extents.len(), seen.positions.width_px(seen.axis), buffer)
    });
    let [low, high] = borders;
    let (low, high) = (low? + 0.5, length - 0.5 - high?);
    let shown = SCALES.contains(&scale) && (low - high).abs() <= ASYMMETRY * (low + high);
    shown.then_some(scale)
}

/// Whether the slits seen are all those of a pattern that fills the panel.
fn reaches_borders(seen: Seen<'_>, extents: &[SlitExtent]) -> bool {
    let Some((first, last)) = extents.first().zip(extents.last()) else { return false };
    let spacing = (last.coordinate - first.coordinate) / (extents.len() - 1).max(1) as f64;
    let width = seen.positions.width_px(seen.axis);
    let margin = OUTERMOST * spacing - 0.5;
    first.coordinate <= margin && last.coordinate >= width - 1.0 - margin
}

/// Where a slit really shines from when the pattern is shown at a scale.
fn scaled(seen: Seen<'_>, coordinate: f64, scale: f64) -> f64 {
    let middle = 0.5 * (seen.positions.width_px(seen.axis) - 1.0);
    middle + scale * (coordinate - middle)
}

fn point(seen: Seen<'_>, extent: &SlitExtent, side: usize, scale: f64) -> Option<BorderPoint> {
    let end = extent.ends[side];
    let coordinate = scaled(seen, extent.coordinate, scale);
    let at = seen.positions.at(&seen.matches[end.index], seen.axis, coordinate)?;
    end.in_frame.then_some(BorderPoint { coordinate, at, step: end.step })
}

/// Median length of the light of the slits when the pattern is shown at a scale, px on the panel.
fn heights(seen: Seen<'_>, extents: &[SlitExtent], scale: f64, buffer: &mut Vec<f64>) -> Option<f64> {
    buffer.clear();
    buffer.extend(extents.iter().filter_map(|e| {
        let (low, high) = (point(seen, e, 0, scale)?, point(seen, e, 1, scale)?);
        Some(high.at - low.at)
    }));
    median(buffer)
}
