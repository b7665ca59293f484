//! The scatter of light where no stripes are: a dark background that was demosaiced, sharpened and compressed.
//!
//! Neighbouring pixels differ less there than [`Noise`](super::noise::Noise) takes from them, since compression removes their
//! differences and keeps coarser ones, which look like faint stripes. Stripes continue from scanline to scanline, beyond the
//! blocks of a compressed photograph; noise does not. Pieces of scanlines that do not continue give the scatter, by the
//! light of the piece.

use super::running_mean::smooth;
use super::scanlines::{Scanline, ScanlineReader};

/// Scanlines that are sampled.
const LINES: usize = 24;
/// Length of a piece, in half periods of the stripes: it holds two stripes where there are any.
const PIECE_HALF_PERIODS: f32 = 4.0;
const MIN_PIECE: usize = 16;
/// Distance of the scanline on which a piece must continue: beyond a block of JPEG with halved colour.
const APART: usize = 17;
/// Correlation with the best place there below which a piece does not continue. Stripes under 45° are shifted by as much as
/// the scanlines are apart; of so many places, noise correlates with one by up to 0.7.
const CONTINUES: f32 = 0.8;
/// Pieces that give a scatter, and their share of all pieces with as much light: some that are lit do not continue either,
/// where a surface ends.
const MIN_PIECES: usize = 12;
const MIN_SHARE: f32 = 0.5;
/// Classes of light, each twice as bright as the one before; the last begins at half of full light.
const CLASSES: usize = 12;

/// 1σ of the smoothed light of unlit pieces, by their light; zero where there are none.
#[derive(Debug, Clone, Default)]
pub(super) struct UnlitNoise {
    sigma: [f32; CLASSES],
    pieces: [Vec<f32>; CLASSES],
    all: [usize; CLASSES],
    lines: [Scanline; 2],
    smoothed: [Vec<f32>; 2],
}

/// The class of a light, summed over the channels.
#[inline]
fn class_of(light: f32) -> usize {
    // The exponent of a positive number is the floor of its logarithm.
    let doublings =
        (light.max(f32::MIN_POSITIVE).to_bits() >> (f32::MANTISSA_DIGITS - 1)) as i32 - (f32::MAX_EXP - 1);
    (doublings + CLASSES as i32).clamp(0, CLASSES as i32 - 1) as usize
}

impl UnlitNoise {
    /// 1σ beside this light.
    pub(super) fn sigma(&self, light: f32) -> f32 {
        self.sigma[class_of(light)]
    }

    /// Nothing is known.
    pub(super) fn clear(&mut self) {
        self.sigma = [0.0; CLASSES];
    }

    /// Measures it in a photograph of stripes with this half period, px, smoothed over some pixels to either side.
    pub(super) fn measure(&mut self, reader: &ScanlineReader<'_>, half_period_px: f32, smoothing: usize) {
        self.clear();
        self.pieces.iter_mut().for_each(Vec::clear);
        self.all = [0; CLASSES];
        let piece = ((PIECE_HALF_PERIODS * half_period_px) as usize).max(MIN_PIECE);
        if reader.count() <= 2 * APART || reader.length() < piece + 2 * APART {
            return;
        }
        let lines = LINES.min(reader.count() / 2);
        for k in 0..lines {
            let y = reader.spread(k, lines).min(reader.count() - APART - 1);
            for (i, y) in [y, y + APART].into_iter().enumerate() {
                reader.read_total(y, &mut self.lines[i]);
                smooth(&self.lines[i].total, smoothing, &mut self.smoothed[i]);
            }
            let [here, there] = &self.smoothed;
            for from in (APART..here.len() - piece - APART).step_by(piece) {
                let around = &there[from - APART..from + piece + APART];
                let Some(Piece { light, sigma, continues }) = compare(&here[from..from + piece], around)
                else {
                    continue;
                };
                let class = class_of(light);
                self.all[class] += 1;
                if !continues {
                    self.pieces[class].push(sigma);
                }
            }
        }
        for ((sigma, pieces), all) in self.sigma.iter_mut().zip(&mut self.pieces).zip(self.all) {
            if pieces.len() >= MIN_PIECES && pieces.len() as f32 >= MIN_SHARE * all as f32 {
                let middle = pieces.len() / 2;
                *sigma = *pieces.select_nth_unstable_by(middle, f32::total_cmp).1;
            }
        }
    }
}

/// A part of a scanline.
#[derive(Debug)]
struct Piece {
    /// Mean and scatter.
    light: f32,
    sigma: f32,
    /// Whether a part of the other scanline is like it.
    continues: bool,
}

/// Compares a piece with what is `around` its place on another scanline. `None` for level light.
fn compare(piece: &[f32], around: &[f32]) -> Option<Piece> {
    let n = piece.len() as f32;
    let mean = piece.iter().sum::<f32>() / n;
    let energy: f32 = piece.iter().map(|v| (v - mean) * (v - mean)).sum();
    if energy <= 0.0 {
        return None;
    }
    let correlation = |at: usize| {
        let other = &around[at..at + piece.len()];
        let (mut sum, mut squares, mut products) = (0.0_f32, 0.0_f32, 0.0_f32);
        for (a, b) in piece.iter().zip(other) {
            sum += b;
            squares += b * b;
            products += (a - mean) * b;
        }
        products / (energy * (squares - sum * sum / n).max(f32::MIN_POSITIVE)).sqrt()
    };
    // From the middle outwards: most stripes are seen nearly upright, and the search ends there.
    let (places, middle) = (around.len() - piece.len() + 1, (around.len() - piece.len()) / 2);
    let outwards = (0..places).map(|k| if k % 2 == 0 { middle + k / 2 } else { middle - k.div_ceil(2) });
    let continues = outwards.into_iter().any(|at| correlation(at) >= CONTINUES);
    Some(Piece { light: mean, sigma: (energy / n).sqrt(), continues })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stripes_continue_and_noise_does_not() {
        let stripes = |shift: f32| -> Vec<f32> {
            (0..100).map(|x| 0.1 + 0.02 * ((x as f32 + shift) * 0.4).sin()).collect()
        };
        let found = compare(&stripes(0.0)[30..62], &stripes(9.0)[13..79]).unwrap();
        assert!((found.light - 0.1).abs() < 0.005 && (found.sigma - 0.0141).abs() < 0.001, "{found:?}");
        assert!(found.continues);
        let mut state = 1_u32;
        let mut noise = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state as f32 / u32::MAX as f32
        };
        let all: Vec<f32> = (0..200).map(|_| noise()).collect();
        assert!(!compare(&all[..40], &all[100..174]).unwrap().continues);
        assert!(compare(&[0.5; 40], &all[..74]).is_none());
    }

    #[test]
    fn classes_of_light_double() {
        assert_eq!([0.0, -1.0, 1e-9, 0.3, 0.6, 3.0].map(class_of), [0, 0, 0, 10, 11, 11]);
    }
}
