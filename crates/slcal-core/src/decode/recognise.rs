//! Whether the photograph shows this pattern: in colour, with its code and no other's.

use nalgebra::{Matrix3, Vector3};

use super::align::{BRIGHTER, NONE, Node, differ, relit};
use super::curves::Curves;
use super::number::{Numbers, Vote};
use crate::error::{Error, Result};
use crate::pattern::StripePattern;
use crate::solve::median_f32;

/// Lines on which the pattern and its decoys are tried.
const LINES: usize = 10;
/// Difference between the strongest and the weakest channel, as a share of the strongest, below which a photograph is
/// grey.
const MIN_SATURATION: f32 = 0.15;
/// The right code scores 2.5 times as much as its decoys on the same stripes; a wrong one, by chance, up to 1.3 times.
const MIN_OVER_DECOY: f32 = 1.5;
/// Score per crossing below which even the best code does not fit, in nats: a perfect fit has ln(hues) + 1, photographs
/// without the pattern 0.2, and clutter among the crossings dilutes it.
const MIN_FIT: f32 = 0.35;
/// Every further slit fits by chance with one over the number of hues.
const BEYOND_WINDOW: usize = 2;

/// Numbers are held against each other on about so many lines.
const EVIDENCE_LINES: usize = 120;
/// Neighbours belong to one regular run of stripes when their distances follow each other within this factor, and their
/// widths within that one: a step of depth between them seldom leaves them so.
const EVEN: f32 = 1.15;
const ALIKE: f32 = 1.5;
/// Share of the neighbours in regular runs whose numbers do not follow each other, above which the code is another's. The
/// right one leaves up to 3 % on planes, spheres, heads and blocks, however blurred, noisy or coloured, up to 12 % on
/// shelves of upright boards whose edges run along the stripes; other codes mostly 17 % to 92 %, but as little as 4 % where
/// they lack or repeat only a few words of it: most of those have other hues or another end.
const MAX_BROKEN: f64 = 0.15;
/// Share of the runs through the code's first or last slit that go on beyond it, above which the pattern is another one
/// with the same beginning: up to 3 % with the right one, from 57 % when the end of a shortened one is in view.
const MAX_BEYOND: f64 = 0.13;
/// An end is in view when it is seen on this share of the lines with regular runs; and so many are needed to judge.
const END_SHARE: f64 = 0.2;
const MIN_LINES: usize = 5;
const MIN_LINKS: usize = 50;
/// Angle by which a hue may miss what the palette's primaries mix to, rad: 1.3° with the right palette, 3° (with seven hues
/// and crosstalk 7°) where the projector's gamma is 1.8 or 2.6 instead of sRGB's; mostly 5° to 30° with one of five hues or more
/// that is another's. Four hues or fewer always fit.
const MAX_HUE_MISFIT: f64 = 0.12;
/// Smallest angle between hues over the palette's: from 0.52 where channels mix, below 0.17 where two hues of the palette
/// stand for one.
const MIN_HUE_ANGLE: f64 = 0.3;
/// Rounds in which the brightness of the hues is fitted: enough for paint that returns a tenth of a channel.
const MIX_ROUNDS: usize = 200;

/// Refuses photographs without colour, such as a grey picture stored as RGB.
pub(super) fn check_color(curves: &Curves, scratch: &mut Vec<f32>) -> Result<()> {
    scratch.clear();
    scratch.extend(curves.paints.iter().map(|p| {
        let c = p.unit;
        let (low, high) = c.iter().fold((f32::INFINITY, 0.0_f32), |(l, h), &c| (l.min(c), h.max(c)));
        (high - low) / high.max(f32::MIN_POSITIVE)
    }));
    let Some(saturation) = median_f32(scratch) else {
        return Err(Error::NotFound {
            what: "stripes",
            seen: format!(
                "{} of pixels across what could be stripes, too few to read colours from",
                match curves.line_count() {
                    1 => "1 line".to_owned(),
                    n => format!("{n} lines"),
                }
            ),
            advice: "give a photograph that shows the stripes over some length: several of their widths"
                .into(),
        });
    };
    if saturation < MIN_SATURATION {
        return Err(Error::NotFound {
            what: "coloured stripes",
            seen: format!(
                "{} stripe crossings, half of them with a saturation below {:.0} %",
                curves.crossings.len(),
                100.0 * saturation
            ),
            advice:
                "the stripes are told apart by their hues: give the colour photograph of the coloured pattern"
                    .into(),
        });
    }
    Ok(())
}

/// Refuses numbers that hold together no further than any code's do: on lines under another code, windows that occur in
/// this one are found all over, but they do not continue. Half the numbered crossings of the right one stand in runs as
/// long as the code's window and [`BEYOND_WINDOW`] together.
pub(super) fn check_runs(
    curves: &Curves,
    votes: &[Vote],
    window: usize,
    scratch: &mut Vec<f32>,
) -> Result<()> {
    scratch.clear();
    for y in 0..curves.line_count() {
        let line = &votes[curves.of(y)];
        for run in line.chunk_by(|a, b| a.label != NONE && a.label + 1 == b.label) {
            if run[0].label != NONE {
                scratch.extend(run.iter().map(|_| run.len() as f32));
            }
        }
    }
    let usual = median_f32(scratch).unwrap_or(0.0);
    if usual < (window + BEYOND_WINDOW) as f32 {
        return Err(Error::NotFound {
            what: "the pattern's code",
            seen: format!(
                "{} stripe crossings; those that fit the code follow each other for {usual} slits, where {window} fit by chance",
                curves.crossings.len()
            ),
            advice: "check that the pattern file is the one that was projected".into(),
        });
    }
    Ok(())
}

/// What neighbours on regular runs of stripes say of the numbers: there, every slit is followed by the next.
#[derive(Debug, Clone, Copy, Default)]
struct Evidence {
    /// Lines with regular runs.
    lines: usize,
    /// Neighbours on them, and those of which the second has the number after the first's.
    links: usize,
    follow: usize,
    /// Sightings of the first and the last slit, and those beyond which the run goes on.
    ends: [usize; 2],
    beyond: [usize; 2],
}

impl Evidence {
    fn add_run(&mut self, labels: impl ExactSizeIterator<Item = u16>, last: u16) {
        self.links += labels.len().saturating_sub(1);
        let mut previous = None;
        for label in labels {
            if let Some(before) = previous {
                self.follow += usize::from(label != NONE && before != NONE && before + 1 == label);
                self.beyond[0] += usize::from(label == 0);
                self.beyond[1] += usize::from(before == last);
            }
            self.ends[0] += usize::from(label == 0);
            self.ends[1] += usize::from(label == last);
            previous = Some(label);
        }
    }

    fn broken(&self) -> f64 {
        if self.links < MIN_LINKS {
            return 0.0;
        }
        1.0 - self.follow as f64 / self.links as f64
    }

    /// The larger share of the two ends.
    fn beyond(&self) -> f64 {
        let enough = (END_SHARE * self.lines as f64).max(MIN_LINES as f64);
        let shares = self.ends.iter().zip(self.beyond).filter(|(seen, _)| **seen as f64 >= enough);
        shares.map(|(&seen, beyond)| beyond as f64 / seen as f64).fold(0.0, f64::max)
    }
}

/// Whether crossing `i` goes on with the regular run that starts at `from`.
fn goes_on(nodes: &[Node], from: usize, i: usize) -> bool {
    let (a, b) = (&nodes[i - 1], &nodes[i]);
    let even = i < from + 2 || !differ(b.u - a.u, a.u - nodes[i - 2].u, EVEN);
    even && !differ(a.width, b.width, ALIKE) && !relit(a, b, BRIGHTER)
}

/// Refuses numbers that contradict each other on one surface, and a code beyond whose end the stripes go on: a pattern may
/// share windows, or its beginning, with the one that was projected.
///
/// What stands in no regular run of more slits than the code's window is not asked: clutter, and whatever else a room holds.
pub(super) fn check_neighbors(
    numbers: &mut Numbers,
    curves: &Curves,
    slits: usize,
    window: usize,
) -> Result<()> {
    let (count, last) = (numbers.line_count(), slits.saturating_sub(1) as u16);
    let mut evidence = Evidence::default();
    for line in (0..count).step_by((count / EVIDENCE_LINES).max(1)) {
        let (nodes, label) = numbers.numbered_line(curves, line);
        let before = evidence.links;
        let mut from = 0;
        for i in 1..=nodes.len() {
            if i < nodes.len() && goes_on(nodes, from, i) {
                continue;
            }
            if i - from >= window + BEYOND_WINDOW {
                evidence.add_run((from..i).map(&label), last);
            }
            from = i;
        }
        evidence.lines += usize::from(evidence.links > before);
    }
    let (broken, beyond) = (evidence.broken(), evidence.beyond());
    let seen = if broken > MAX_BROKEN {
        format!(
            "{} pairs of evenly spaced neighbours; in {:.0} % of them the second does not follow the first in the code",
            evidence.links,
            100.0 * broken
        )
    } else if beyond > MAX_BEYOND {
        format!(
            "evenly spaced stripes that go on beyond an end of the code, on {:.0} % of the lines that show it",
            100.0 * beyond
        )
    } else {
        return Ok(());
    };
    Err(Error::NotFound {
        what: "the pattern's code",
        seen,
        advice: "check that the pattern file is the one that was projected".into(),
    })
}

/// Refuses hues that the palette's cannot have become, by whatever mixing of the channels and colour of the surface.
pub(super) fn check_hues(palette: &[[f32; 3]], directions: &[[f32; 3]]) -> Result<()> {
    let misfit = hue_misfit(palette, directions).unwrap_or(0.0);
    let seen = if misfit > MAX_HUE_MISFIT {
        format!(
            "stripes of which one hue is {:.0}° off what the palette's primaries mix to",
            misfit.to_degrees()
        )
    } else if smallest_angle(directions) < MIN_HUE_ANGLE * smallest_angle(palette) {
        format!("stripes of fewer hues than the {} of the palette", palette.len())
    } else {
        return Ok(());
    };
    Err(Error::NotFound {
        what: "the pattern's hues",
        seen,
        advice: "check that the pattern file is the one that was projected".into(),
    })
}

fn vector(color: [f32; 3]) -> Vector3<f64> {
    Vector3::from(color.map(f64::from))
}

/// The largest angle between a hue's direction and M · its colour in the palette, for the matrix M and the brightness of
/// the hues that fit best, in turn; rad. `None` where the palette has fewer than three independent colours.
fn hue_misfit(palette: &[[f32; 3]], directions: &[[f32; 3]]) -> Option<f64> {
    let own = palette.iter().fold(Matrix3::zeros(), |sum, &p| sum + vector(p) * vector(p).transpose());
    if own.determinant() < 1e-6 * own.trace().powi(3) {
        return None;
    }
    let inverse = own.try_inverse()?;
    let hues = || palette.iter().zip(directions).map(|(&p, &d)| (vector(p), vector(d)));
    let fit = |brightness: &dyn Fn(&Vector3<f64>, &Vector3<f64>) -> f64| {
        hues().fold(Matrix3::zeros(), |sum, (p, d)| sum + d * brightness(&p, &d) * p.transpose()) * inverse
    };
    let mut mix = fit(&|p, _| p.norm());
    for _ in 0..MIX_ROUNDS {
        let last = mix / mix.norm().max(f64::MIN_POSITIVE);
        mix = fit(&|p, d| (last * p).dot(d).max(1e-3));
    }
    let angle = |(p, d): (Vector3<f64>, Vector3<f64>)| (mix * p).angle(&d);
    hues().map(angle).reduce(f64::max).filter(|a| a.is_finite())
}

/// The smallest angle between two colours, rad.
fn smallest_angle(colors: &[[f32; 3]]) -> f64 {
    let others = |i: usize| colors[i + 1..].iter().map(move |&c| vector(c).angle(&vector(colors[i])));
    (0..colors.len()).flat_map(others).fold(std::f64::consts::PI, f64::min)
}

/// The pattern read forwards and backwards, and decoys of it: the same sequence with its hues exchanged in a circle, as
/// good a code, but another one.
#[derive(Debug, Clone, Default)]
pub(super) struct Candidates {
    /// Forwards, backwards, then the decoys.
    codes: Vec<Vec<u8>>,
    scores: Vec<f32>,
}

impl Candidates {
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

    /// The hues in the order in which lines meet the slits.
    pub(super) fn slits(&self, reversed: bool) -> &[u8] {
        self.codes.get(usize::from(reversed)).map_or(&[], Vec::as_slice)
    }
}

/// Tries the pattern and its decoys on some lines: whether slits run against the image, and the score per crossing.
pub(super) fn try_pattern(
    numbers: &mut Numbers,
    curves: &Curves,
    candidates: &mut Candidates,
    period_per_width: f32,
) -> Result<(bool, f64)> {
    let Candidates { codes, scores } = candidates;
    let tried = numbers.score(curves, codes, period_per_width, LINES, scores);
    let score = |k: usize| scores.get(k).copied().unwrap_or(0.0);
    let (ahead, back) = (score(0), score(1));
    let best = ahead.max(back);
    let decoy = scores.iter().skip(2).copied().fold(0.0, f32::max);
    let fit = best / tried.max(1) as f32;
    if fit < MIN_FIT || best < MIN_OVER_DECOY * decoy {
        return Err(Error::NotFound {
            what: "the pattern's code",
            seen: format!(
                "{tried} stripe crossings on {LINES} lines; their colours follow the pattern with {fit:.2} nats each, another code with {:.2}",
                decoy / tried.max(1) as f32
            ),
            advice: "check that the pattern file is the one that was projected, and that the photograph's colours are not clipped".into(),
        });
    }
    Ok((back > ahead, f64::from(fit)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIVE: [[f32; 3]; 5] =
        [[1.0, 0.0, 0.0], [0.6, 1.0, 0.0], [0.0, 1.0, 0.13], [0.0, 0.13, 1.0], [0.6, 0.0, 1.0]];

    #[test]
    fn hues_fit_a_palette_that_channels_and_paint_have_mixed_and_no_other() {
        let mixed = |m: Matrix3<f64>, palette: &[[f32; 3]]| -> Vec<[f32; 3]> {
            palette.iter().map(|&p| (m * vector(p)).normalize().map(|x| x as f32).into()).collect()
        };
        let mix = Matrix3::new(0.6, 0.12, 0.0, 0.1, 0.4, 0.05, 0.02, 0.2, 0.3);
        let seen = mixed(mix, &FIVE);
        assert!(hue_misfit(&FIVE, &seen).unwrap() < 0.01);
        assert!(check_hues(&FIVE, &seen).is_ok());
        // The first five of six evenly spaced hues; two that are the same; too few primaries to say.
        let six = [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]];
        assert!(check_hues(&FIVE, &mixed(mix, &six)).is_err());
        let mut same = seen;
        same[2] = same[1];
        assert!(check_hues(&FIVE, &same).is_err());
        assert!(hue_misfit(&FIVE[..2], &same[..2]).is_none());
        assert!(check_hues(&[], &[]).is_ok());
    }

    #[test]
    fn runs_count_what_follows_and_what_lies_beyond_the_ends() {
        let mut evidence = Evidence::default();
        evidence.add_run([0, 1, 2, 3, NONE, NONE].into_iter(), 3);
        evidence.add_run([NONE, 0, 1, 1, 3].into_iter(), 3);
        assert_eq!((evidence.links, evidence.follow), (9, 4));
        assert_eq!((evidence.ends, evidence.beyond), ([2, 2], [1, 1]));
        assert!(evidence.broken() < f64::EPSILON, "too few to judge");
    }
}
