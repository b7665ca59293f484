//! Training data of the colour classes: samples whose slit is known, with the colour of the surface divided out.

use crate::decode::color_classes::{ColorSample, NO_CLASS};
use crate::decode::crossing_features::NONE;
use crate::decode::rgb::{Rgb, over, plus, scaled, times, total, unit};

/// The colour of a surface is estimated from this many neighbouring stripes to either side. At least as many stripes as a
/// window of the code, and some more, must be there. Each channel must hold this share of their light.
const SURFACE_REACH: usize = 6;
const MIN_SURFACE: usize = 6;
const MIN_CHANNEL: f32 = 0.08;
/// The estimate serves this many consecutive stripes.
const SURFACE_STEP: usize = 3;
/// Iterations of the estimate, and the relative change of a channel at which it has converged.
const SURFACE_ROUNDS: usize = 5;
const SURFACE_TOLERANCE: f32 = 0.05;

/// Crossings on aligned scanlines with what is known of them; all slices have one entry per crossing.
pub(super) struct KnownCrossings<'a, L: Fn(usize) -> u16> {
    /// The slit of a crossing, or [`NONE`].
    pub(super) label: L,
    /// The colour class of the slit, or [`NO_CLASS`] where the slit is not certain.
    pub(super) hues: &'a [u8],
    /// Colours as measured.
    pub(super) raw: &'a [ColorSample],
    /// Directions of the colour classes.
    pub(super) directions: &'a [Rgb],
}

impl<L: Fn(usize) -> u16> KnownCrossings<'_, L> {
    /// Whether a crossing and the next one on the scanline carry consecutive slits.
    fn are_consecutive(&self, at: usize) -> bool {
        let label = (self.label)(at);
        label != NONE && label.wrapping_add(1) == (self.label)(at + 1)
    }

    /// Writes the colours of one scanline into `samples`, divided by the colour of the surface: what neighbouring stripes on
    /// it have in common beyond their hues.
    pub(super) fn remove_surface_color(&self, line: std::ops::Range<usize>, samples: &mut [ColorSample]) {
        // The estimate of one stripe serves its next neighbours on the surface.
        let (mut valid_to, mut found) = (0, None);
        for at in line.clone() {
            samples[at] = self.raw[at];
            if at > line.start && !self.are_consecutive(at - 1) {
                valid_to = at;
            }
            if self.hues[at] == NO_CLASS {
                continue;
            }
            if at >= valid_to {
                let (mut from, mut to) = (at, at);
                while from > line.start && at - from < SURFACE_REACH && self.are_consecutive(from - 1) {
                    from -= 1;
                }
                while to + 1 < line.end && to - at < SURFACE_REACH && self.are_consecutive(to) {
                    to += 1;
                }
                (valid_to, found) = (at + SURFACE_STEP, self.surface_gain(from..=to));
            }
            if let Some(gain) = found
                && let Some(direction) = self.directions.get(usize::from(self.hues[at]))
            {
                let own = self.raw[at];
                let lit = total(times(*direction, gain)) / total(*direction);
                samples[at].unit = divided(own.unit, gain);
                samples[at].light = own.light / lit;
                samples[at].log_light = own.log_light - lit.ln();
            }
        }
    }

    /// The reflectance of a surface per channel, up to a factor, from neighbouring stripes on it. Divided by it, the
    /// directions of their colours have the same sum as the directions of their classes.
    fn surface_gain(&self, stripes: std::ops::RangeInclusive<usize>) -> Option<Rgb> {
        let direction = |at: &usize| self.directions.get(usize::from(self.hues[*at]));
        let (mut expected, mut n) = ([0.0_f32; 3], 0);
        for &direction in stripes.clone().filter_map(|at| direction(&at)) {
            n += 1;
            expected = plus(expected, direction);
        }
        let least = MIN_CHANNEL * n as f32;
        let mut gain = [1.0_f32; 3];
        for _ in 0..SURFACE_ROUNDS {
            let mut seen = [0.0_f32; 3];
            for at in stripes.clone().filter(|at| direction(at).is_some()) {
                let own = self.raw[at].unit;
                let unit = if gain == [1.0; 3] { own } else { divided(own, gain) };
                seen = plus(seen, unit);
            }
            if n < MIN_SURFACE || expected.iter().chain(&seen).any(|&x| x < least) {
                return None;
            }
            let change = over(seen, expected);
            gain = times(gain, change);
            if change.iter().all(|c| (c - 1.0).abs() < SURFACE_TOLERANCE) {
                break;
            }
        }
        Some(scaled(gain, 3.0 / total(gain)))
    }
}

fn divided(color: Rgb, gain: Rgb) -> Rgb {
    unit(over(color, gain)).unwrap_or(color)
}
