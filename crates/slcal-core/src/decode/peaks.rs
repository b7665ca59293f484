//! Segmentation of a scanline into bright peaks between dark valleys, of any width.

use super::noise::Noise;

/// A peak begins where the light has risen above the valley by this share of the valley's light, and ends where it has
/// fallen by this share of the rise. Texture and shading change less from pixel to pixel; stripes change more even when
/// blur takes most of their contrast.
const RISE: f32 = 0.12;
const FALL: f32 = 0.25;
/// The same in units of noise: a scanline has a few thousand pixels.
const SIGMAS: f32 = 4.5;
/// A peak lower than this share of both its neighbours is noise between them.
const WIGGLE: f32 = 0.15;
/// A valley above this share of the lower of its two peaks is a dent in one peak.
const DENT: f32 = 0.75;

/// A maximum between two minima, as indices of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Peak {
    pub(super) before: u32,
    pub(super) top: u32,
    pub(super) after: u32,
}

impl Peak {
    /// Height above the higher of the two valleys.
    fn height(self, light: &[f32]) -> f32 {
        light[self.top as usize] - light[self.before as usize].max(light[self.after as usize])
    }

    /// The peak on the unfiltered light, for a peak that was found on the running mean over `reach` pixels to either
    /// side: extrema are at most that far away.
    pub(super) fn refined(self, light: &[f32], reach: usize) -> Self {
        let extreme = |x: u32, sign: f32| {
            let from = (x as usize).saturating_sub(reach);
            let (mut best, mut most) = (from, f32::NEG_INFINITY);
            for (at, v) in light.iter().enumerate().take(x as usize + reach + 1).skip(from) {
                (best, most) = if sign * v > most { (at, sign * v) } else { (best, most) };
            }
            best
        };
        let (before, top, after) =
            (extreme(self.before, -1.0), extreme(self.top, 1.0), extreme(self.after, -1.0));
        if before >= top || top >= after {
            return self;
        }
        Self { before: before as u32, top: top as u32, after: after as u32 }
    }
}

/// Detects the peaks of a scanline. `noise_share`: σ of `light` over that of a pixel, less than one where it is
/// smoothed. `turns` is working memory.
pub(super) fn find(
    light: &[f32],
    noise: &Noise,
    noise_share: f32,
    turns: &mut Vec<u8>,
    peaks: &mut Vec<Peak>,
) {
    peaks.clear();
    let Some(&first) = light.first() else { return };
    let sigmas = SIGMAS * noise_share;
    let (mut low, mut low_at) = (first, 0);
    let (mut high, mut high_at) = (first, 0);
    let mut rising = false;
    // Looked up when the light turns, not at every pixel of a slope.
    let mut threshold = None;
    each_turn(light, turns, |x| {
        let v = light[x];
        if rising {
            if v > high {
                (high, high_at, threshold) = (v, x, None);
            } else if v < *threshold.get_or_insert_with(|| fall(low, high, noise, sigmas)) {
                peaks.push(Peak { before: low_at as u32, top: high_at as u32, after: x as u32 });
                (low, low_at, rising, threshold) = (v, x, false, None);
            }
        } else if v < low {
            (low, low_at, threshold) = (v, x, None);
        } else if v > *threshold.get_or_insert_with(|| rise(low, noise, sigmas)) {
            if let Some(peak) = peaks.last_mut() {
                peak.after = low_at as u32;
            }
            (high, high_at, rising, threshold) = (v, x, true, None);
        }
    });
    if !rising && let Some(peak) = peaks.last_mut() {
        peak.after = low_at as u32;
    }
    merge(light, peaks);
}

/// Calls `visit` with every pixel at which the light begins or ceases to rise, in order: extrema are among them.
fn each_turn(light: &[f32], marks: &mut Vec<u8>, mut visit: impl FnMut(usize)) {
    const BLOCK: usize = 64;
    let n = light.len();
    marks.clear();
    marks.resize(n.next_multiple_of(BLOCK), 0);
    if n > 2 {
        let (before, at, after) = (&light[..n - 2], &light[1..n - 1], &light[2..]);
        for (((mark, a), b), c) in marks[1..n - 1].iter_mut().zip(before).zip(at).zip(after) {
            *mark = u8::from(b > a) ^ u8::from(c > b);
        }
    }
    for end in [0, n.saturating_sub(1)] {
        if let Some(mark) = marks.get_mut(end) {
            *mark = 1;
        }
    }
    for (block, marks) in marks.as_chunks::<BLOCK>().0.iter().enumerate() {
        let mut left = packed(marks);
        while left != 0 {
            visit(BLOCK * block + left.trailing_zeros() as usize);
            left &= left - 1;
        }
    }
}

/// One bit for each of 64 bytes that are 0 or 1.
fn packed(marks: &[u8; 64]) -> u64 {
    // The product moves the bit of byte i to bit 56 + i.
    const GATHER: u64 = 0x0102_0408_1020_4080;
    let (eights, _) = marks.as_chunks::<8>();
    eights
        .iter()
        .rev()
        .fold(0, |bits, eight| bits << 8 | u64::from_le_bytes(*eight).wrapping_mul(GATHER) >> 56)
}

fn rise(low: f32, noise: &Noise, sigmas: f32) -> f32 {
    low + (RISE * low).max(sigmas * noise.sigma_of_total(low)).max(SIGMAS * noise.unlit.sigma(low))
}

fn fall(low: f32, high: f32, noise: &Noise, sigmas: f32) -> f32 {
    high - (FALL * (high - low)).max(sigmas * noise.sigma_of_total(high)).max(SIGMAS * noise.unlit.sigma(low))
}

/// Removes low peaks between two higher ones, and joins peaks with a dent between them.
fn merge(light: &[f32], peaks: &mut Vec<Peak>) {
    let at = |x: u32| light[x as usize];
    let mut kept = 0;
    for i in 0..peaks.len() {
        let peak = peaks[i];
        let next = peaks.get(i + 1).map_or(f32::INFINITY, |h| h.height(light));
        let previous = if kept > 0 { peaks[kept - 1].height(light) } else { f32::INFINITY };
        let wiggle = kept > 0 && i + 1 < peaks.len() && peak.height(light) < WIGGLE * previous.min(next);
        if wiggle {
            let lower = if at(peak.after) < at(peak.before) { peak.after } else { peak.before };
            peaks[kept - 1].after = lower;
            peaks[i + 1].before = lower;
            continue;
        }
        if kept > 0 {
            let last = peaks[kept - 1];
            let floor = at(last.before).min(at(peak.after));
            let lower_top = at(last.top).min(at(peak.top));
            if at(peak.before) - floor > DENT * (lower_top - floor) {
                let top = if at(peak.top) > at(last.top) { peak.top } else { last.top };
                peaks[kept - 1] = Peak { before: last.before, top, after: peak.after };
                continue;
            }
        }
        peaks[kept] = peak;
        kept += 1;
    }
    peaks.truncate(kept);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photo::Encoding;

    fn peaks(light: &[f32]) -> Vec<(u32, u32, u32)> {
        let mut noise = Noise::new(Encoding::Linear);
        noise.set(1e-3);
        let mut out = Vec::new();
        find(light, &noise, 1.0, &mut Vec::new(), &mut out);
        out.iter().map(|h| (h.before, h.top, h.after)).collect()
    }

    #[test]
    fn peaks_of_any_width_and_height_are_found() {
        let mut light = vec![0.05; 4];
        light.extend([0.9; 3]);
        light.extend([0.05; 2]);
        light.extend([0.2; 40]);
        light.extend([0.05; 3]);
        assert_eq!(peaks(&light), [(0, 4, 8), (8, 9, 51)]);
    }

    #[test]
    fn dents_noise_and_level_light_are_no_peaks() {
        assert!(peaks(&[0.5; 50]).is_empty());
        assert!(peaks(&[]).is_empty());
        // A step up, or down, is no stripe.
        assert!(peaks(&[0.1, 0.1, 0.9, 0.9]).is_empty());
        assert_eq!(peaks(&[0.0, 0.8, 0.9, 0.75, 0.9, 0.8, 0.0]).len(), 1);
        assert_eq!(peaks(&[0.0, 1.0, 0.1, 0.15, 0.08, 1.0, 0.0]), [(0, 1, 4), (4, 5, 6)]);
    }
}
