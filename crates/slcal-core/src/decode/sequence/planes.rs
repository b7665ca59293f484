//! What is kept of the frames of a sequence: a fixed number of bytes per pixel, into which every frame is folded.

use crate::pattern::{Axis, AxisCode};

/// What is kept of the code of one axis. Lists by pixel, one for each value: most of the work is done on many pixels at once.
#[derive(Debug, Clone)]
pub(super) struct AxisPlanes {
    pub(super) code: AxisCode,
    /// The Gray code, as the signs of the bits' contrasts say.
    pub(super) word: Vec<u16>,
    /// Contrast of bit 0: its frame less its inverse, or twice its frame less white and black.
    pub(super) finest: Vec<i16>,
    /// The least contrast of the other bits, whatever its sign.
    pub(super) weakest: Vec<i16>,
    /// Which bit has it.
    pub(super) weakest_bit: Vec<u8>,
    /// The second least contrast of the other bits.
    pub(super) second: Vec<i16>,
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
            weakest: vec![i16::MAX; bits],
            weakest_bit: vec![u8::MAX; bits],
            second: vec![i16::MAX; bits],
            cosine: vec![0.0; waves],
            sine: vec![0.0; waves],
        }
    }

    /// As after [`new`](Self::new).
    pub(super) fn clear(&mut self) {
        self.word.fill(0);
        self.finest.fill(0);
        self.weakest.fill(i16::MAX);
        self.weakest_bit.fill(u8::MAX);
        self.second.fill(i16::MAX);
        self.cosine.fill(0.0);
        self.sine.fill(0.0);
    }

    /// Folds the contrasts of a bit.
    pub(super) fn fold_bit(&mut self, bit: u32, contrasts: impl Iterator<Item = i16>) {
        let set = 1_u16 << bit;
        let word = self.word.iter_mut();
        if bit == 0 {
            for ((word, finest), contrast) in word.zip(&mut self.finest).zip(contrasts) {
                *word |= if contrast > 0 { set } else { 0 };
                *finest = contrast;
            }
            return;
        }
        let least = self.weakest.iter_mut().zip(&mut self.second);
        for (((word, (weakest, second)), which), contrast) in
            word.zip(least).zip(&mut self.weakest_bit).zip(contrasts)
        {
            *word |= if contrast > 0 { set } else { 0 };
            let size = contrast.max(-contrast);
            *which = if size < *weakest { bit as u8 } else { *which };
            *second = (*second).min(size.max(*weakest));
            *weakest = size.min(*weakest);
        }
    }

    /// Folds a step of the sinusoid.
    pub(super) fn fold_step(&mut self, turns: f64, levels: &[u16]) {
        let angle = std::f64::consts::TAU * turns;
        let (sin, cos) = (angle.sin() as f32, angle.cos() as f32);
        for ((cosine, sine), level) in self.cosine.iter_mut().zip(&mut self.sine).zip(levels) {
            let level = f32::from(*level);
            *cosine += level * cos;
            *sine += level * sin;
        }
    }

    /// The contrast of a bit at a pixel, whatever its sign; at least that where it was not kept.
    #[inline]
    pub(super) fn contrast(&self, pixel: usize, bit: u32) -> i16 {
        let is_weakest = u32::from(self.weakest_bit[pixel]) == bit;
        let other = if is_weakest { self.weakest[pixel] } else { self.second[pixel] };
        if bit == 0 { self.finest[pixel].abs() } else { other }
    }
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
    pub(super) fn new(codes: [Option<AxisCode>; 2], pixels: usize) -> Self {
        Self {
            white: Vec::new(),
            black: Vec::new(),
            color: Vec::new(),
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
            planes.fold_bit(bit, [contrast].into_iter());
        }
        assert_eq!((planes.word[0], planes.finest[0], planes.weakest_bit[0]), (0b0101, 6, 2));
        assert_eq!((planes.weakest[0], planes.second[0]), (90, 200));
        assert_eq!([0, 1, 2, 3].map(|bit| planes.contrast(0, bit)), [6, 200, 90, 200]);
        planes.clear();
        assert_eq!((planes.word[0], planes.contrast(0, 2)), (0, i16::MAX));
    }
}
