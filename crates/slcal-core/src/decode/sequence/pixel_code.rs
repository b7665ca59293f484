//! Which cell of the panel a pixel sees, and whether that is certain.

use super::planes::{AxisPlanes, border_bit, number_of};

/// A contrast below this share of white less black is undecided, whatever the noise: light that other parts of the scene reflect onto
/// a pixel has as much.
const LEAST_SHARE: f32 = 0.03;
/// A contrast below this many times its own noise is undecided.
const SIGMAS: f32 = 1.5;

/// Why a pixel has no cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unread {
    /// Two bits or more are undecided, or one whose border is not here.
    Undecided,
    /// The cell lies outside the panel, or bits and sinusoid contradict each other.
    Contradicting,
}

/// A pixel's cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PixelCell {
    pub(super) cell: u16,
    /// The border that runs through the pixel, as the number of the cell behind it.
    pub(super) border: Option<u16>,
}

/// How small a contrast may be to be certain, in half steps. `sigma` is that of a level, `lit` white less black; `paired` says whether
/// the bits have inverses.
#[inline]
pub(super) fn least_contrast(sigma: f32, lit: Option<f32>, paired: bool) -> u16 {
    // A bit less its inverse; or twice a bit less white and black.
    let of_noise = if paired { std::f32::consts::SQRT_2 } else { 6.0_f32.sqrt() };
    let least = (SIGMAS * of_noise * sigma).max(LEAST_SHARE * lit.unwrap_or(0.0));
    (0.5 * least) as u16
}

/// The cell of a pixel. At most one bit may be undecided: the one whose border runs through the pixel, so that both of its values mean
/// neighbouring cells.
#[inline]
pub(super) fn cell_of(planes: &AxisPlanes, pixel: usize, least: u16) -> Result<PixelCell, Unread> {
    let word = planes.word[pixel];
    let cell = number_of(word);
    let finest = planes.finest[pixel].unsigned_abs() < least;
    let [weakest, second] = planes.weakest[pixel];
    if u32::from(cell) * planes.code.cell_px >= planes.code.extent {
        return Err(Unread::Contradicting);
    }
    if !finest && weakest >= least {
        return Ok(PixelCell { cell, border: None });
    }
    if second < least || (finest && weakest < least) {
        return Err(Unread::Undecided);
    }
    let bit = if finest { 0 } else { u32::from(planes.weakest_bit[pixel]) };
    let other = number_of(word ^ (1 << bit));
    if cell.abs_diff(other) != 1 {
        return Err(Unread::Undecided);
    }
    let border = cell.max(other);
    debug_assert_eq!(border_bit(border), bit);
    Ok(PixelCell { cell, border: Some(border) })
}
