//! Checks that the photograph shows this pattern: in colour, and with this code rather than another.

use super::labeling::Labeling;
use super::tracks::Tracks;
use crate::error::{Error, ErrorSubject, Result};
use crate::pattern::StripePattern;
use crate::solve::median_f32;

/// Scanlines on which the pattern and its decoys are tried.
const LINES: usize = 10;
/// Difference between the strongest and the weakest channel, relative to the strongest, below which a photograph is
/// grey.
const MIN_SATURATION: f32 = 0.15;
/// The right code scores 2.5 times as much as its decoys on the same stripes; a wrong one scores up to 1.3 times, by
/// chance.
const MIN_OVER_DECOY: f32 = 1.5;
/// Score per crossing below which even the best code does not fit, in nats. A perfect fit has ln(hues) + 1, photographs
/// without the pattern have 0.2, and clutter among the crossings lowers it.
const MIN_FIT: f32 = 0.35;

/// What else there is to check: finer stripes blur into each other, and their colours with them.
const WIDE_ENOUGH: &str =
    "that its stripes are 3 px wide or more in the photograph (nearer, sharper, fewer slits)";

/// What to do with a camera without colour.
pub(super) const GREY_CAMERA: &str = "With a camera that sees no colour, calibrate as usual, show stripes without colour (Gray code), \
                                      decode them with another program, and triangulate its matches";

/// The error for stripes of another pattern.
pub(super) fn another_pattern(what: ErrorSubject, seen: String) -> Error {
    Error::NotFound {
        what,
        seen,
        advice: format!("check that the pattern file is the one that was projected, and {WIDE_ENOUGH}"),
    }
}

/// Refuses photographs without colour, such as a grey picture stored as RGB.
pub(super) fn check_color(tracks: &Tracks, scratch: &mut Vec<f32>) -> Result<()> {
    scratch.clear();
    scratch.extend(tracks.colors.iter().map(|p| {
        let c = p.unit;
        let (low, high) = c.iter().fold((f32::INFINITY, 0.0_f32), |(l, h), &c| (l.min(c), h.max(c)));
        (high - low) / high.max(f32::MIN_POSITIVE)
    }));
    let Some(saturation) = median_f32(scratch) else {
        return Err(Error::NotFound {
            what: ErrorSubject::Stripes,
            seen: format!(
                "{} of pixels across what could be stripes, too few to read colours from",
                match tracks.line_count() {
                    1 => "1 line".to_owned(),
                    n => format!("{n} lines"),
                }
            ),
            advice: "give a photograph that shows the stripes over several of their widths".into(),
        });
    };
    if saturation < MIN_SATURATION {
        return Err(Error::NotFound {
            what: ErrorSubject::ColoredStripes,
            seen: format!(
                "{} stripe crossings, half of them with a saturation below {:.0} %",
                tracks.crossings.len(),
                100.0 * saturation
            ),
            advice: format!(
                "the stripes are told apart by their hues: give the colour photograph of the coloured pattern. {GREY_CAMERA}"
            ),
        });
    }
    Ok(())
}

/// The pattern read forwards and backwards, and decoys: the same sequence with its hues permuted cyclically, which is
/// another code of the same quality.
#[derive(Debug, Clone, Default)]
pub(super) struct CodeCandidates {
    /// Forwards, backwards, then the decoys.
    codes: Vec<Vec<u8>>,
    scores: Vec<f32>,
}

impl CodeCandidates {
    /// # Errors
    /// [`Error::Invalid`] for a palette of one colour.
    pub(super) fn new(pattern: &StripePattern) -> Result<Self> {
        let n = pattern.palette.len();
        if n < 2 {
            return Err(Error::invalid(
                "palette",
                "at least two colours: slits of one cannot be told apart",
                n,
            ));
        }
        let turned = |shift: usize| -> Vec<u8> {
            pattern.sequence.iter().map(|&s| ((usize::from(s) + shift) % n) as u8).collect()
        };
        let both_ways = |ahead: Vec<u8>| {
            let back = ahead.iter().rev().copied().collect();
            [ahead, back]
        };
        Ok(Self { codes: (0..n).flat_map(|shift| both_ways(turned(shift))).collect(), scores: Vec::new() })
    }

    /// The hues of the slits in the order of a scanline.
    pub(super) fn slits(&self, reversed: bool) -> &[u8] {
        self.codes.get(usize::from(reversed)).map_or(&[], Vec::as_slice)
    }
}

/// Tries the pattern and its decoys on some scanlines. Returns whether slits descend along the image, and the score per
/// crossing.
pub(super) fn try_pattern(
    labeling: &mut Labeling,
    tracks: &Tracks,
    candidates: &mut CodeCandidates,
    period_per_width: f32,
) -> Result<(bool, f64)> {
    let CodeCandidates { codes, scores } = candidates;
    let tried = labeling.score(tracks, codes, period_per_width, LINES, scores);
    let score = |k: usize| scores.get(k).copied().unwrap_or(0.0);
    let (ahead, back) = (score(0), score(1));
    let best = ahead.max(back);
    let decoy = scores.iter().skip(2).copied().fold(0.0, f32::max);
    let fit = best / tried.max(1) as f32;
    if fit < MIN_FIT || best < MIN_OVER_DECOY * decoy {
        return Err(Error::NotFound {
            what: ErrorSubject::PatternCode,
            seen: format!(
                "{tried} stripe crossings on {LINES} lines; their colours fit the pattern with {fit:.2} nats each, another code with {:.2}",
                decoy / tried.max(1) as f32
            ),
            advice: format!(
                "check that the pattern file is the one that was projected, that the photograph's colours are not clipped, and {WIDE_ENOUGH}"
            ),
        });
    }
    Ok((back > ahead, f64::from(fit)))
}
