//! What is kept of the frames of a sequence: a fixed number of bytes per pixel, into which every frame is folded.

use crate::pattern::{Axis, AxisCode};

/// What is kept of the code of one axis.
#[derive(Debug, Clone)]
pub(super) struct AxisPlanes {
    pub(super) code: AxisCode,
    /// The Gray code, as the signs of the bits' contrasts say.
    pub(super) word: Vec<u16>,
    /// Contrast of bit 0: its frame less its inverse, in half steps.
    pub(super) finest: Vec<i16>,
    /// The two least contrasts of the other bits, in half steps.
    pub(super) weakest: Vec<[u16; 2]>,
    /// Which bit has the least contrast of the others.
    pub(super) weakest_bit: Vec<u8>,
    /// Sums of the sinusoid's frames times cosine and sine of their shifts.
    pub(super) cosine: Vec<f32>,
    pub(super) sine: Vec<f32>,
}

impl AxisPlanes {
    pub(super) fn new(code: AxisCode, pixels: usize) -> Self {
        let bits = if code.bits > 0 { pixels } else { 0 };
        let waves = if code.sinusoid.is_some() { pixels } else { 0 };
        Self {
            code,
            word: vec![0; bits],
            finest: vec![0; bits],
            weakest: vec![[u16::MAX; 2]; bits],
            weakest_bit: vec![u8::MAX; bits],
            cosine: vec![0.0; waves],
            sine: vec![0.0; waves],
        }
    }

    /// As after [`new`](Self::new).
    pub(super) fn clear(&mut self) {
        self.word.fill(0);
        self.finest.fill(0);
        self.weakest.fill([u16::MAX; 2]);
        self.weakest_bit.fill(u8::MAX);
        self.cosine.fill(0.0);
        self.sine.fill(0.0);
    }

    /// Folds the contrasts of a bit into the pixels from `start` on.
    pub(super) fn fold_bit(&mut self, bit: u32, start: usize, contrasts: impl Iterator<Item = i32>) {
        let set = 1_u16 << bit;
        if bit == 0 {
            let to = self.word[start..].iter_mut().zip(&mut self.finest[start..]);
            for ((word, finest), contrast) in to.zip(contrasts) {
                *word |= if contrast > 0 { set } else { 0 };
                *finest = half(contrast);
            }
            return;
        }
        let to = self.word[start..].iter_mut().zip(&mut self.weakest[start..]);
        for (((word, weakest), which), contrast) in to.zip(&mut self.weakest_bit[start..]).zip(contrasts) {
            *word |= if contrast > 0 { set } else { 0 };
            let size = half(contrast).unsigned_abs();
            let [least, second] = *weakest;
            *which = if size < least { bit as u8 } else { *which };
            *weakest = [least.min(size), second.min(least.max(size))];
        }
    }

    /// Folds a step of the sinusoid into the pixels from `start` on.
    pub(super) fn fold_step(&mut self, turns: f64, start: usize, levels: &[u16]) {
        let angle = std::f64::consts::TAU * turns;
        let (sin, cos) = (angle.sin() as f32, angle.cos() as f32);
        let to = self.cosine[start..].iter_mut().zip(&mut self.sine[start..]);
        for ((cosine, sine), level) in to.zip(levels) {
            let level = f32::from(*level);
            *cosine += level * cos;
            *sine += level * sin;
        }
    }

    /// The contrast of a bit at a pixel, in half steps; at least that where it was not kept.
    pub(super) fn contrast(&self, pixel: usize, bit: u32) -> u16 {
        if bit == 0 {
            self.finest[pixel].unsigned_abs()
        } else if u32::from(self.weakest_bit[pixel]) == bit {
            self.weakest[pixel][0]
        } else {
            self.weakest[pixel][1]
        }
    }
}

/// Half of a difference of two levels of 16 bit fits into 16 bit.
#[inline]
fn half(contrast: i32) -> i16 {
    (contrast >> 1) as i16
}

/// What is kept of all frames.
#[derive(Debug, Clone)]
pub(super) struct Planes {
    /// Under white and under black; empty where they are not shown.
    pub(super) white: Vec<u16>,
    pub(super) black: Vec<u16>,
    /// Colour under white.
    pub(super) color: Vec<[u8; 3]>,
    /// Columns, rows.
    pub(super) axes: [Option<AxisPlanes>; 2],
}

impl Planes {
    pub(super) fn new(codes: [Option<AxisCode>; 2], pixels: usize, white: bool, black: bool) -> Self {
        let plane = |is_shown| if is_shown { vec![0; pixels] } else { Vec::new() };
        Self {
            white: plane(white),
            black: plane(black),
            color: vec![[0; 3]; if white { pixels } else { 0 }],
            axes: codes.map(|code| code.map(|code| AxisPlanes::new(code, pixels))),
        }
    }

    pub(super) fn axis(&mut self, axis: Axis) -> Option<&mut AxisPlanes> {
        self.axes[axis.index()].as_mut()
    }
}

/// The number whose Gray code a word is.
#[inline]
pub(super) fn number_of(word: u16) -> u16 {
    let mut number = word;
    number ^= number >> 1;
    number ^= number >> 2;
    number ^= number >> 4;
    number ^ (number >> 8)
}

/// The bit in which the Gray codes of `cell` − 1 and `cell` differ.
#[inline]
pub(super) fn border_bit(cell: u16) -> u32 {
    cell.trailing_zeros()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::gray_code;

    #[test]
    fn gray_codes_are_read_and_neighbours_differ_in_the_bit_of_their_border() {
        for cell in 0..=u16::MAX {
            let word = gray_code(cell.into()) as u16;
            assert_eq!(number_of(word), cell);
            if cell > 0 {
                assert_eq!(gray_code(u32::from(cell) - 1) ^ u32::from(word), 1 << border_bit(cell));
            }
        }
    }

    #[test]
    fn the_two_weakest_bits_are_kept() {
        let code = AxisCode { extent: 16, bits: 4, cell_px: 1, sinusoid: None };
        let mut planes = AxisPlanes::new(code, 1);
        for (bit, contrast) in [(3, -400), (2, 90), (1, -200), (0, 6)] {
            planes.fold_bit(bit, 0, [contrast].into_iter());
        }
        assert_eq!((planes.word[0], planes.finest[0], planes.weakest_bit[0]), (0b0101, 3, 2));
        assert_eq!(planes.weakest[0], [45, 100]);
        assert_eq!([0, 1, 2, 3].map(|bit| planes.contrast(0, bit)), [3, 100, 45, 100]);
    }
}
