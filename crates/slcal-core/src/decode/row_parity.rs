//! Edges that alternate from scanline to scanline, as demosaicing and sharpening leave them: a channel is measured in every
//! other pixel, in other pixels on even rows than on odd ones.

use super::labeling::VotedLabel;
use super::tracks::Tracks;

/// The stripes of a hue alternate where the mean is beyond this many of its σ, and beyond this distance, px.
const SIGMAS: f64 = 5.0;
const LEAST_PX: f64 = 0.01;
/// Every so many crossings of a track are looked at.
const SAMPLED: usize = 3;
/// Shorter tracks say little.
const MIN_LENGTH: usize = 8;
/// Hues that are told apart; further ones are left out.
const HUES: usize = 16;

/// Sums over the crossings of a hue.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    n: f64,
    sum: f64,
    squares: f64,
}

/// Averages the edges of every stripe over three scanlines, with weights 1, 2, 1, where those of some hue alternate. `slits` has
/// the hues of the labels. Returns whether it did.
pub(super) fn remove(
    tracks: &mut Tracks,
    votes: &[VotedLabel],
    slits: &[u8],
    scratch: &mut Vec<f32>,
) -> bool {
    let mut sums = [Sums::default(); HUES];
    for track in tracks.iter().filter(|t| t.len() >= MIN_LENGTH) {
        let first = tracks.line_of(track[0] as usize);
        // An odd step: both parities.
        for (at, w) in track.windows(3).enumerate().step_by(SAMPLED) {
            let [a, b, c] = [w[0], w[1], w[2]].map(|i| tracks.crossings[i as usize].middle());
            let Some(&hue) = slits.get(usize::from(votes[w[1] as usize].label)) else { continue };
            let Some(sums) = sums.get_mut(usize::from(hue)) else { continue };
            let line = first + at;
            let sign = if line.is_multiple_of(2) { 1.0 } else { -1.0 };
            let miss = sign * f64::from(b - 0.5 * (a + c));
            sums.n += 1.0;
            sums.sum += miss;
            sums.squares += miss * miss;
        }
    }
    let alternates = |s: &Sums| {
        let mean = s.sum / s.n.max(1.0);
        s.n > 1.0 && mean.abs() > LEAST_PX && mean * mean * s.n * s.n > SIGMAS * SIGMAS * s.squares
    };
    if !sums.iter().any(alternates) {
        return false;
    }
    smooth(tracks, scratch);
    true
}

fn smooth(tracks: &mut Tracks, scratch: &mut Vec<f32>) {
    scratch.clear();
    scratch.extend(tracks.crossings.iter().flat_map(|c| [c.left, c.right]));
    let (all, crossings) = tracks.with_crossings();
    for track in all {
        for w in track.windows(3) {
            let [a, b, c] = [w[0], w[1], w[2]].map(|i| 2 * i as usize);
            let mean = |edge: usize| 0.25 * (scratch[a + edge] + 2.0 * scratch[b + edge] + scratch[c + edge]);
            let crossing = &mut crossings[w[1] as usize];
            (crossing.left, crossing.right) = (mean(0), mean(1));
        }
    }
}
