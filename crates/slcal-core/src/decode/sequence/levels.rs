//! The levels of a frame: grey values of 15 bit, so that the difference of any two fits into 16.

use crate::photo::{Layout, PhotoView, Samples};

/// Largest level of frames of 8 bit: three times 255. The sum of the channels has less noise than any one of them.
const FULL_8_BIT: u16 = 765;
/// Largest level of frames of 16 bit, whose samples are halved. No camera tells the last of 16 bits.
const FULL_16_BIT: u16 = u16::MAX / 2;

/// How the samples of a frame become levels; the same for all frames of a sequence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct LevelScale {
    /// The level of white.
    pub(super) full: u16,
    /// From one code value to the next.
    pub(super) step: u16,
}

impl LevelScale {
    pub(super) fn of(photo: &PhotoView<'_>) -> Self {
        match (photo.samples(), photo.layout().has_color()) {
            (Samples::U8(_), false) => Self { full: FULL_8_BIT, step: 3 },
            (Samples::U8(_), true) => Self { full: FULL_8_BIT, step: 1 },
            (Samples::U16(_), _) => Self { full: FULL_16_BIT, step: 1 },
        }
    }

    /// What frames of this scale are.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self { full: FULL_16_BIT, .. } => "16 bit",
            Self { step: 1, .. } => "8 bit in colour",
            Self { .. } => "8 bit in grey",
        }
    }
}

/// Writes the levels of rows into `out`, which becomes as long as they are.
pub(super) fn levels(photo: &PhotoView<'_>, rows: std::ops::Range<usize>, out: &mut Vec<u16>) {
    out.clear();
    out.reserve(rows.len() * photo.width());
    for y in rows {
        match photo.samples() {
            Samples::U8(samples) => {
                let row = photo.row_of(samples, y);
                match photo.layout() {
                    Layout::Grey => out.extend(row.iter().map(|v| u16::from(*v) * 3)),
                    _ => out.extend(photo.pixels_of(row).map(|p| {
                        let [r, g, b] = p.map(u16::from);
                        r + g + b
                    })),
                }
            }
            Samples::U16(samples) => {
                let row = photo.row_of(samples, y);
                match photo.layout() {
                    Layout::Grey => out.extend(row.iter().map(|v| v / 2)),
                    _ => out.extend(photo.pixels_of(row).map(|p| {
                        let [r, g, b] = p.map(u32::from);
                        ((r + g + b + 3) / 6) as u16
                    })),
                }
            }
        }
    }
}

/// Writes the colours of rows into `out`, 8 bit.
pub(super) fn colors(photo: &PhotoView<'_>, rows: std::ops::Range<usize>, out: &mut Vec<[u8; 3]>) {
    out.clear();
    for y in rows {
        match photo.samples() {
            Samples::U8(samples) => {
                let row = photo.row_of(samples, y);
                match photo.layout() {
                    Layout::Grey => out.extend(row.iter().map(|v| [*v; 3])),
                    _ => out.extend(photo.pixels_of(row)),
                }
            }
            Samples::U16(_) => out.extend((0..photo.width()).map(|x| photo.rgb_bytes(x, y))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_and_colour_have_the_same_levels() {
        let grey = [7_u8, 200, 0, 255];
        let color: Vec<u8> = grey.iter().flat_map(|v| [*v; 3]).chain([9; 6]).collect();
        let [mut a, mut b] = [Vec::new(), Vec::new()];
        levels(&PhotoView::new(Samples::U8(&grey), 2, 2, 2, Layout::Grey).unwrap(), 0..2, &mut a);
        let padded = [&color[..6], &[1, 2, 3], &color[6..]].concat();
        levels(&PhotoView::new(Samples::U8(&padded), 2, 2, 9, Layout::Bgr).unwrap(), 0..2, &mut b);
        assert_eq!(a, b);
        assert_eq!(a, [21, 600, 0, 765]);
        let deep = [0_u16, 65535, 65535, 0];
        let view = PhotoView::new(Samples::U16(&deep), 1, 1, 4, Layout::Rgba).unwrap();
        levels(&view, 0..1, &mut a);
        assert_eq!(a, [21845]);
    }
}
