//! Which cell of the panel a pixel sees, and whether that is certain.

use super::planes::{AxisPlanes, border_bit, number_of};

/// The cell of pixels that have none.
pub(super) const NO_CELL: u16 = u16::MAX;
/// The least certain contrast of pixels that are not lit: none reaches it.
pub(super) const UNLIT: i16 = i16::MAX;

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

/// How small a contrast may be to be certain. `sigma` is that of the contrast, `lit` white less black.
#[inline]
pub(super) fn least_contrast(sigma: f32, lit: Option<f32>) -> i16 {
    let least = (SIGMAS * sigma).max(LEAST_SHARE * lit.unwrap_or(0.0));
    // What is not below it is certain; it stays below that of pixels without light.
    (least.min(f32::from(i16::MAX - 2)) as i16) + 1
}

/// Pixels by what became of them.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct PixelCounts {
    pub(super) lit: usize,
    pub(super) undecided: usize,
    pub(super) contradicting: usize,
}

impl std::ops::Add for PixelCounts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            lit: self.lit + other.lit,
            undecided: self.undecided + other.undecided,
            contradicting: self.contradicting + other.contradicting,
        }
    }
}

impl PixelCounts {
    pub(super) fn count(&mut self, unread: Unread) {
        match unread {
            Unread::Undecided => self.undecided += 1,
            Unread::Contradicting => self.contradicting += 1,
        }
    }
}

/// Writes the cell of every pixel, [`NO_CELL`] where there is none. `least` are the contrasts that are certain.
pub(super) fn read_cells(planes: &AxisPlanes, least: &[i16], out: &mut Vec<u16>, counts: &mut PixelCounts) {
    let cells = planes.code.extent.div_ceil(planes.code.cell_px).min(NO_CELL.into()) as u16;
    let seen = planes.word.iter().zip(planes.finest.iter().zip(&planes.weakest));
    out.clear();
    // Most pixels are certain: many at once.
    out.extend(seen.zip(least).map(|((word, (finest, weakest)), least)| {
        let cell = number_of(*word);
        let is_certain = finest.abs() >= *least && weakest >= least && cell < cells;
        if is_certain { cell } else { NO_CELL }
    }));
    for (pixel, (cell, least)) in out.iter_mut().zip(least).enumerate() {
        counts.lit += usize::from(*least != UNLIT);
        if *cell == NO_CELL && *least != UNLIT {
            match cell_of(planes, pixel, *least) {
                Ok(read) => *cell = read.cell,
                Err(unread) => counts.count(unread),
            }
        }
    }
}

/// The cell of a pixel. At most one bit may be undecided: the one whose border runs through the pixel, so that both of its values mean
/// neighbouring cells.
#[inline]
pub(super) fn cell_of(planes: &AxisPlanes, pixel: usize, least: i16) -> Result<PixelCell, Unread> {
    let word = planes.word[pixel];
    let cell = number_of(word);
    let finest = planes.finest[pixel].abs() < least;
    let (weakest, second) = (planes.weakest[pixel], planes.second[pixel]);
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
