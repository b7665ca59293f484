//! Positions on the panel from the phase of the sinusoid, with the Gray code for the number of its periods.

use super::pixel_code::{PixelCell, Unread};
use super::planes::{AxisPlanes, border_bit};

/// Largest σ of a phase, as a share of the period: beyond, the period next to it is as good.
const MOST_SIGMA: f32 = 1.0 / 12.0;
/// A bit has clearly less contrast than another below one part in this.
const CLEARLY: f32 = 2.0;
/// A phase is not off by more than this many times its σ.
const PHASE_SIGMAS: f32 = 5.0;
/// Where code and phase are compared across a border of a cell: the share of a period on either side.
const NEAR_BORDER: f32 = 0.25;

/// Position and σ on the panel, px. `sigma` is the noise of a level.
#[inline]
pub(super) fn position(
    planes: &AxisPlanes,
    pixel: usize,
    cell: Option<PixelCell>,
    sigma: f32,
) -> Result<(f32, f32), Unread> {
    let Some((period, steps)) = planes.code.sinusoid else { return Err(Unread::Undecided) };
    let (period, steps) = (period as f32, steps as f32);
    let (cosine, sine) = (planes.cosine[pixel], planes.sine[pixel]);
    let sum = (cosine * cosine + sine * sine).sqrt();
    // The amplitude is 2/N of the sum, the noise of either sum σ·√(N/2).
    let sigma = period * std::f32::consts::FRAC_1_PI * 0.5 * sigma * (0.5 * steps).sqrt() / sum;
    let is_seen = sigma <= MOST_SIGMA * period;
    if !is_seen {
        return Err(Unread::Undecided);
    }
    let phase = period * std::f32::consts::FRAC_1_PI * 0.5 * sine.atan2(cosine);
    let extent = planes.code.extent as f32;
    let at = match cell {
        // One period over the whole panel.
        None => nearest(phase, period, 0.5 * (extent - 1.0)),
        Some(PixelCell { border: Some(border), .. }) => {
            let cell_px = planes.code.cell_px as f32;
            let edge = f32::from(border) * cell_px - 0.5;
            let at = nearest(phase, period, edge);
            if (at - edge).abs() > NEAR_BORDER.max(0.5 * cell_px / period) * period {
                return Err(Unread::Contradicting);
            }
            at
        }
        Some(PixelCell { cell, border: None }) => {
            let cell_px = planes.code.cell_px as f32;
            let first = f32::from(cell) * cell_px - 0.5;
            let at = nearest(phase, period, first + 0.5 * cell_px);
            across_border(planes, pixel, cell, (at, sigma), period)
        }
    };
    if at < -1.0 || at > extent {
        return Err(Unread::Contradicting);
    }
    Ok((at, sigma))
}

/// Of the positions with this phase, the one nearest to a place.
#[inline]
fn nearest(phase: f32, period: f32, place: f32) -> f32 {
    phase + period * ((place - phase) / period).round()
}

/// Near a border of its cell, a position may belong to the other side of the opposite border: the bit whose border is here has less
/// contrast than that of the other one.
#[inline]
fn across_border(planes: &AxisPlanes, pixel: usize, cell: u16, (at, sigma): (f32, f32), period: f32) -> f32 {
    let cell_px = planes.code.cell_px as f32;
    let first = f32::from(cell) * cell_px - 0.5;
    let last = first + cell_px;
    let (here, there, other) =
        if at - first < last - at { (cell, cell + 1, at + period) } else { (cell + 1, cell, at - period) };
    let (near, far) = if here == cell { (first, last) } else { (last, first) };
    let is_near = (at - near).abs() < NEAR_BORDER * period && (other - far).abs() < NEAR_BORDER * period;
    let cells = planes.code.extent.div_ceil(planes.code.cell_px);
    if !is_near || there == 0 || u32::from(there) >= cells {
        return at;
    }
    // The panel ends here: there is no bit that changes.
    let ends = here == 0 || u32::from(here) >= cells;
    let contrast = |border: u16| f32::from(planes.contrast(pixel, border_bit(border)));
    // Within the noise of the phase both sides are as likely before the contrasts are asked.
    let clearly = if (at - near).abs() < PHASE_SIGMAS * sigma { 1.0 } else { CLEARLY };
    // With no border here the other side needs a border there that is seen, which would be undecided; stay.
    if !ends && clearly * contrast(there) < contrast(here) { other } else { at }
}
