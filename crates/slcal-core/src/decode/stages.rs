//! The stages of decoding, in order.

use nalgebra::Point2;

use super::align::{Aligner, Hint, NONE};
use super::color::Hues;
use super::config::{DecodeConfig, DecodeInput, DecodeReport, Decoding, Dropped};
use super::curves::{Curves, Vote};
use super::lines::{Frames, LineReader};
use super::noise::Noise;
use super::peaks::{Peak, PeakFinder};
use super::recognise::{check_color, try_pattern};
use super::width;
use crate::error::{Error, Result};
use crate::matches::{Match, Matches};
use crate::pattern::{Axis, StripePattern};
use crate::photo::Encoding;
use crate::solve::median;

/// Lines looked at to measure noise and width, and to try the pattern.
pub(super) const SAMPLE_LINES: usize = 64;
/// Rounds in which hues are learned anew from what was decoded, and votes are heard.
const LEARNING_PASSES: usize = 3;
/// Votes are counted over this many stripe widths along a curve to either side: what holds along a stripe about as far
/// as across two.
const REACH_WIDTHS: f64 = 4.0;
/// A crossing narrower than this share of its neighbours' mean width (of the only neighbour's) is cut by an outline.
const CUT_BETWEEN: f32 = 0.72;
const CUT_AT_END: f32 = 0.6;

/// All crossings of a photograph.
pub(super) struct Crossings {
    pub(super) peaks: Vec<Peak>,
    /// Peaks of line y: `lines[y]..lines[y + 1]`.
    pub(super) lines: Vec<u32>,
}

impl Crossings {
    pub(super) fn of(&self, line: usize) -> std::ops::Range<usize> {
        self.lines[line] as usize..self.lines[line + 1] as usize
    }
}

pub(super) fn run(
    input: &DecodeInput<'_>,
    pattern: &StripePattern,
    config: &DecodeConfig,
) -> Result<Decoding> {
    let frames = Frames { photo: input.photo, black: input.black, white: input.white };
    let mut reader = LineReader::new(frames, pattern.axis, config.encoding)?;
    let (noise, estimate) = look(&mut reader, config.encoding)?;
    let mut finder = PeakFinder::new(width::search_widths(estimate.typical_px, reader.length()));
    let crossings = find_all(&mut reader, &mut finder, &noise);
    let mut report = DecodeReport {
        crossings: crossings.peaks.len(),
        stripe_width_px: usual(crossings.peaks.iter().map(|p| f64::from(p.width))),
        saturated: share(&crossings.peaks, |p| p.saturated),
        dropped: Dropped { weak: finder.rejects.weak + finder.rejects.shapeless, ..Dropped::default() },
        ..DecodeReport::default()
    };
    check_color(&crossings.peaks)?;

    let palette: Vec<[f32; 3]> = pattern
        .palette
        .iter()
        .map(|c| c.map(|c| Encoding::Srgb.to_linear(f64::from(c) / 255.0) as f32))
        .collect();
    let mut hues = Hues::seed(&palette, &pattern.sequence, &crossings.peaks);
    hues.learn(&crossings.peaks, None);
    (report.reversed, report.code_fit) = try_pattern(&crossings, &hues, pattern)?;

    let order: Vec<u16> = {
        let n = pattern.sequence.len() as u16;
        if report.reversed { (0..n).rev().collect() } else { (0..n).collect() }
    };
    let slit_hues: Vec<u8> = order.iter().map(|&s| pattern.sequence[usize::from(s)]).collect();
    let mut aligner = Aligner::new(slit_hues.clone(), (pattern.period_px() / pattern.width_px) as f32);
    let curves = Curves::link(&crossings.peaks, &crossings.lines);
    let reach = (REACH_WIDTHS * report.stripe_width_px).ceil().max(3.0) as usize;
    let mut votes: Vec<Vote> = Vec::new();
    for pass in 0..=LEARNING_PASSES {
        let hints: Vec<Hint> = votes.iter().map(|v| (v.label, v.support)).collect();
        let labels = align_all(&crossings, &hues, &curves, &mut aligner, reach, &hints);
        votes = curves.vote(&labels, reach);
        if pass < LEARNING_PASSES {
            let known: Vec<Option<u8>> = votes
                .iter()
                .map(|v| slit_hues.get(usize::from(v.label)).copied().filter(|_| v.support > 0.8))
                .collect();
            hues.learn(&crossings.peaks, Some(&known));
        }
    }
    report.hues_seen = hues.directions.iter().map(|d| d.map(f64::from)).collect();
    report.hue_spread_rad = f64::from(hues.spread_rad);
    let scale = sigma_scale(&crossings.peaks, &curves);
    let fading = curves.fading(&crossings.peaks);
    let matches = collect(&crossings, &votes, &fading, &order, scale, &reader, pattern, config, &mut report);
    if matches.is_empty() {
        return Err(not_the_pattern(&report, "no stripe got a number that its neighbours confirm"));
    }
    Ok(Decoding { matches: Matches { items: matches }, report })
}

/// Noise and stripe width from some of the lines.
fn look(reader: &mut LineReader<'_>, encoding: Encoding) -> Result<(Noise, width::WidthEstimate)> {
    let (n, length) = (reader.count(), reader.length());
    let chosen: Vec<usize> =
        (0..SAMPLE_LINES.min(n)).map(|i| (2 * i + 1) * n / (2 * SAMPLE_LINES.min(n))).collect();
    let mut buffer = vec![[0.0_f32; 3]; length * chosen.len()];
    let mut noise = Noise::new(encoding);
    for (line, out) in chosen.iter().zip(buffer.chunks_exact_mut(length)) {
        reader.read(*line, out);
        noise.add(out);
    }
    noise.finish();
    let estimate = width::estimate(buffer.chunks_exact(length), length, &noise).ok_or_else(|| Error::NotFound {
        what: "stripes",
        seen: format!("on {} lines there are hardly any bright bands between dark ones", chosen.len()),
        advice: "photograph the object with the stripe pattern projected, in focus, in a room that is not too bright; \
                 check that the pattern's axis is the one that was projected"
            .into(),
    })?;
    Ok((noise, estimate))
}

fn find_all(reader: &mut LineReader<'_>, finder: &mut PeakFinder, noise: &Noise) -> Crossings {
    let mut line = vec![[0.0_f32; 3]; reader.length()];
    let mut crossings = Crossings { peaks: Vec::new(), lines: vec![0] };
    for y in 0..reader.count() {
        reader.read(y, &mut line);
        finder.find(&line, noise, &mut crossings.peaks);
        crossings.lines.push(crossings.peaks.len() as u32);
    }
    crossings
}

pub(super) fn odds_of(hues: &Hues, peaks: &[Peak], out: &mut Vec<f32>) {
    let n = hues.directions.len();
    out.clear();
    out.resize(peaks.len() * n, 0.0);
    for (p, o) in peaks.iter().zip(out.chunks_exact_mut(n)) {
        hues.log_odds(p.color, o);
    }
}

fn not_the_pattern(report: &DecodeReport, seen: &str) -> Error {
    Error::NotFound {
        what: "the pattern's code",
        seen: format!("{} stripe crossings; {seen}", report.crossings),
        advice: "check that the pattern file is the one that was projected".into(),
    }
}

/// Aligns every line, with colours averaged along the curves.
fn align_all(
    crossings: &Crossings,
    hues: &Hues,
    curves: &Curves,
    aligner: &mut Aligner,
    reach: usize,
    hints: &[Hint],
) -> Vec<u16> {
    let columns = hues.directions.len();
    let mut odds = Vec::new();
    odds_of(hues, &crossings.peaks, &mut odds);
    curves.smooth(&mut odds, columns, reach / 2);
    let mut labels = vec![NONE; crossings.peaks.len()];
    for y in 0..crossings.lines.len() - 1 {
        let r = crossings.of(y);
        let odds = &odds[r.start * columns..r.end * columns];
        let hints = hints.get(r.clone()).unwrap_or(&[]);
        aligner.align(&crossings.peaks[r.clone()], odds, hints, hues, &mut labels[r]);
    }
    labels
}

/// The measured over the predicted scatter of crossings along their curves.
fn sigma_scale(peaks: &[Peak], curves: &Curves) -> f32 {
    let mut ratios: Vec<f32> = Vec::new();
    for curve in curves.iter().filter(|c| c.len() >= 5) {
        for w in curve.windows(3).step_by(3) {
            let [a, b, c] = [w[0], w[1], w[2]].map(|i| &peaks[i as usize]);
            ratios.push((b.u - 0.5 * (a.u + c.u)).abs() / b.sigma);
        }
    }
    if ratios.is_empty() {
        return 1.0;
    }
    let middle = ratios.len() / 2;
    let (_, m, _) = ratios.select_nth_unstable_by(middle, f32::total_cmp);
    // Median of |x| of a normal variable, and the variance of a second difference.
    (*m / 0.6745 / 1.5_f32.sqrt()).clamp(0.3, 10.0)
}

#[expect(clippy::too_many_arguments, reason = "the last stage brings everything together")]
fn collect(
    crossings: &Crossings,
    votes: &[Vote],
    fading: &[bool],
    order: &[u16],
    sigma_scale: f32,
    reader: &LineReader<'_>,
    pattern: &StripePattern,
    config: &DecodeConfig,
    report: &mut DecodeReport,
) -> Vec<Match> {
    let mut matches = Vec::new();
    let mut seen = vec![false; order.len()];
    for y in 0..crossings.lines.len() - 1 {
        for i in crossings.of(y) {
            let (vote, peak) = (votes[i], &crossings.peaks[i]);
            if vote.label == NONE {
                report.dropped.ambiguous += 1;
                continue;
            }
            if fading[i] || is_cut(&crossings.peaks, votes, crossings.of(y), i) {
                report.dropped.cut += 1;
                continue;
            }
            let confidence = f64::from(vote.support);
            if confidence < config.min_confidence {
                report.dropped.unsure += 1;
                continue;
            }
            let slit = order[usize::from(vote.label)];
            seen[usize::from(slit)] = true;
            let (along, across) = (y as f64, f64::from(peak.u));
            let centre = pattern.centres_px[usize::from(slit)];
            let columns = pattern.axis == Axis::Columns;
            matches.push(Match {
                camera: if columns { Point2::new(across, along) } else { Point2::new(along, across) },
                projector_column: columns.then_some(centre),
                projector_row: (!columns).then_some(centre),
                slit: Some(slit),
                confidence,
                sigma_px: f64::from(peak.sigma * sigma_scale).max(1e-3),
                color: reader.srgb(y, (across.round().max(0.0) as usize).min(reader.length() - 1)),
            });
        }
    }
    report.decoded = matches.len();
    report.slits = seen.iter().filter(|s| **s).count();
    matches
}

/// Whether a crossing is much narrower than those of the neighbouring slits beside it.
fn is_cut(peaks: &[Peak], votes: &[Vote], line: std::ops::Range<usize>, i: usize) -> bool {
    let label = votes[i].label;
    let before = (i > line.start && votes[i - 1].label.wrapping_add(1) == label).then(|| peaks[i - 1].width);
    let after = (i + 1 < line.end && votes[i + 1].label == label + 1).then(|| peaks[i + 1].width);
    match (before, after) {
        (Some(a), Some(b)) => peaks[i].width < CUT_BETWEEN * 0.5 * (a + b),
        (Some(w), None) | (None, Some(w)) => peaks[i].width < CUT_AT_END * w,
        (None, None) => false,
    }
}

fn share(peaks: &[Peak], which: impl Fn(&Peak) -> bool) -> f64 {
    peaks.iter().filter(|p| which(p)).count() as f64 / peaks.len().max(1) as f64
}

/// The median of the finite values; 0 for none.
pub(super) fn usual(values: impl Iterator<Item = f64>) -> f64 {
    let mut finite: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    median(&mut finite).unwrap_or(0.0)
}
