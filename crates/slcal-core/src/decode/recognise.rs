//! Whether the photograph shows this pattern: in colour, with its code and no other's.

use super::align::{Aligner, NONE};
use super::color::Hues;
use super::peaks::Peak;
use super::stages::{Crossings, SAMPLE_LINES, odds_of, usual};
use crate::error::{Error, Result};
use crate::pattern::StripePattern;

/// Angle between the strongest colours below which a photograph is grey, rad.
const MIN_HUE_SPREAD: f32 = 0.15;
/// Another code of the same kind, tried on the same stripes, reaches up to two thirds of the right one's score by chance.
const MIN_OVER_DECOY: f32 = 1.25;
/// Score per crossing below which even the best code does not fit, in nats: a perfect fit has ln(hues) + 1, photographs
/// without the pattern 0.2, and clutter among the crossings dilutes it.
const MIN_FIT: f32 = 0.35;

/// Refuses photographs without colour, such as a grey picture stored as RGB.
pub(super) fn check_color(peaks: &[Peak]) -> Result<()> {
    let chroma = |p: &Peak| {
        let (low, high) = p.color.iter().fold((f32::INFINITY, 0.0_f32), |(l, h), &c| (l.min(c), h.max(c)));
        f64::from((high - low) / high.max(f32::MIN_POSITIVE))
    };
    let spread = usual(peaks.iter().map(chroma));
    if peaks.is_empty() || spread < f64::from(MIN_HUE_SPREAD) {
        return Err(Error::NotFound {
            what: "coloured stripes",
            seen: format!(
                "{} stripe crossings, half of them with a saturation below {:.0} %",
                peaks.len(),
                100.0 * spread
            ),
            advice:
                "the stripes are told apart by their hues: give the colour photograph of the coloured pattern"
                    .into(),
        });
    }
    Ok(())
}

/// Tries the pattern and decoys of it, forwards and backwards, on some lines: whether slits run against the image,
/// and the score per crossing.
pub(super) fn try_pattern(
    crossings: &Crossings,
    hues: &Hues,
    pattern: &StripePattern,
) -> Result<(bool, f64)> {
    let n = hues.directions.len();
    if n < 2 {
        return Err(Error::invalid("palette", "at least two colours: slits of one cannot be told apart", n));
    }
    let ratio = (pattern.period_px() / pattern.width_px) as f32;
    let count = crossings.lines.len() - 1;
    let mut odds = Vec::new();
    let mut labels = Vec::new();
    let mut tried = 0;
    let mut score = |sequence: Vec<u8>| {
        let mut aligner = Aligner::new(sequence, ratio);
        let mut sum = 0.0;
        tried = 0;
        for i in 0..SAMPLE_LINES.min(count) {
            let range = crossings.of((2 * i + 1) * count / (2 * SAMPLE_LINES.min(count)));
            let peaks = &crossings.peaks[range];
            odds_of(hues, peaks, &mut odds);
            labels.clear();
            labels.resize(peaks.len(), NONE);
            sum += aligner.align(peaks, &odds, &[], hues, &mut labels);
            tried += peaks.len();
        }
        sum
    };
    let sequence = &pattern.sequence;
    let backwards = |s: &[u8]| s.iter().rev().copied().collect::<Vec<u8>>();
    let (ahead, back) = (score(sequence.clone()), score(backwards(sequence)));
    let best = ahead.max(back);
    // The same sequence with its hues exchanged in a circle: as good a code, but not this one.
    let mut decoy = 0.0_f32;
    for shift in 1..n {
        let other: Vec<u8> = sequence.iter().map(|&s| ((usize::from(s) + shift) % n) as u8).collect();
        decoy = decoy.max(score(backwards(&other))).max(score(other));
    }
    let fit = best / tried.max(1) as f32;
    if fit < MIN_FIT || best < MIN_OVER_DECOY * decoy {
        return Err(Error::NotFound {
            what: "the pattern's code",
            seen: format!(
                "{tried} stripe crossings on {} lines; their colours follow the pattern with {fit:.2} nats each, another code with {:.2}",
                SAMPLE_LINES.min(count),
                decoy / tried.max(1) as f32
            ),
            advice: "check that the pattern file is the one that was projected, and that the photograph's colours are not clipped".into(),
        });
    }
    Ok((back > ahead, f64::from(fit)))
}
