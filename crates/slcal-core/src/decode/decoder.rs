//! The stages of decoding, in order, and the memory that they keep from one photograph to the next.

use nalgebra::Point2;

use super::code_check::{Candidates, check_color, try_pattern};
use super::config::{DecodeConfig, DecodeInput, Decoding, Rejected, ScanDirection};
use super::consistency::{check_neighbors, check_runs};
use super::crosstalk::{check_hues, crosstalk};
use super::labeling::{AlignedLines, Code, Numbers};
use super::noise::Noise;
use super::scanlines::{self, Line, LineReader, Tables};
use super::sequence_alignment::NONE;
use super::slit_layout::Spacing;
use super::stripe_centers::{self, Centre, SigmaWork};
use super::stripe_edges::{self, Crossing, Paint, Scratch};
use super::stripe_scale::{Look, LookScratch, look};
use super::tracks::Curves;
use crate::error::{Error, Result};
use crate::matches::Match;
use crate::pattern::{Axis, StripePattern, unique_window};
use crate::photo::Encoding;
use crate::solve::median_f32;

/// Parts into which a photograph's lines are cut; each can be searched by a thread of its own.
const BANDS: usize = 16;
/// The scatter of centres is counted over this many stripe widths along a curve to either side.
const SIGMA_WIDTHS: f32 = 3.0;
/// Share of the score of a perfect fit above which nothing better is sought.
const GOOD_FIT: f64 = 0.75;
/// Lines one way are across the stripes when what looks like stripes is closer together there, unless there is less than
/// this share of what is seen the other way.
const COVERED_SHARE: f64 = 0.4;

/// Decodes one photograph after another with the same pattern; once it has seen a few it needs no more memory.
#[derive(Debug, Clone)]
pub struct Decoder {
    pattern: StripePattern,
    config: DecodeConfig,
    candidates: Candidates,
    palette: Vec<[f32; 3]>,
    /// So many neighbouring hues occur once.
    window: usize,
    /// Distance of neighbouring slits over their width.
    period_in_widths: f32,
    tables: Tables,
    noise: Noise,
    look: LookScratch,
    bands: Vec<Band>,
    curves: Curves,
    numbers: Numbers,
    centres: Vec<Centre>,
    spacing: Spacing,
    sigma_work: SigmaWork,
    scratch: Vec<f32>,
    slits_seen: Vec<bool>,
    out: Decoding,
}

/// Neighbouring lines and the stripes on them.
#[derive(Debug, Clone, Default)]
struct Band {
    line: Line,
    scratch: Scratch,
    crossings: Vec<Crossing>,
    paints: Vec<Paint>,
    /// Crossings up to and including each line.
    ends: Vec<u32>,
    low_contrast: usize,
}

impl Decoder {
    /// Prepares for a pattern.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a pattern that contradicts itself or has one colour only, or a configuration out of range.
    pub fn new(pattern: &StripePattern, config: DecodeConfig) -> Result<Self> {
        config.validate()?;
        pattern.validate()?;
        let light = |c: u8| Encoding::Srgb.to_linear(f64::from(c) / 255.0) as f32;
        Ok(Self {
            pattern: pattern.clone(),
            config,
            candidates: Candidates::new(pattern)?,
            palette: pattern.palette.iter().map(|c| c.map(light)).collect(),
            window: unique_window(&pattern.sequence),
            period_in_widths: (pattern.period_px() / pattern.width_px) as f32,
            tables: Tables::default(),
            noise: Noise::new(config.encoding),
            look: LookScratch::default(),
            bands: vec![Band::default(); BANDS],
            curves: Curves::default(),
            numbers: Numbers::default(),
            centres: Vec::new(),
            spacing: Spacing::default(),
            sigma_work: SigmaWork::default(),
            scratch: Vec::new(),
            slits_seen: Vec::new(),
            out: Decoding::default(),
        })
    }

    /// Changes the last report for another one, whose memory the next one will use.
    pub(crate) fn swap_report(&mut self, with: &mut super::DecodeReport) {
        std::mem::swap(&mut self.out.report, with);
    }

    /// What the last call found, when it was successful, without a copy.
    pub(super) fn into_last(self) -> Decoding {
        self.out
    }

    /// Finds the stripes of a photograph and says which slit each is.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a greyscale photograph or frames of different sizes; [`Error::NotFound`] when there are no
    /// stripes, when they have no colour, or when their colours follow the pattern no better than chance would.
    pub fn decode(&mut self, input: &DecodeInput<'_>) -> Result<&Decoding> {
        scanlines::check(input)?;
        let frames = [Some(input.photo), input.black, input.white];
        for view in frames.iter().flatten() {
            self.tables.prepare(view, self.config.encoding);
        }
        // Lines across the stripes: what looks most like stripes first, the other way when that is not this pattern.
        let tables = std::mem::take(&mut self.tables);
        let result = self.decode_either_way(input, &tables);
        self.tables = tables;
        result?;
        Ok(&self.out)
    }

    fn decode_either_way(&mut self, input: &DecodeInput<'_>, tables: &Tables) -> Result<()> {
        let [rows, columns] =
            [ScanDirection::Rows, ScanDirection::Columns].map(|scan| LineReader::new(input, tables, scan));
        self.noise.measure(&rows);
        let [a, b] = [&rows, &columns].map(|r| look(r, &self.noise, &mut self.look).map(|l| (*r, l)));
        // Slanted stripes are crossed either way: across them is where they are close together.
        let columns_first = match (&a, &b) {
            (Some((_, a)), Some((_, b))) => {
                let (mine, other) = (a.covered_px, b.covered_px);
                let shorter = b.half_period_px < a.half_period_px;
                if shorter { other > COVERED_SHARE * mine } else { mine < COVERED_SHARE * other }
            }
            (None, Some(_)) => true,
            _ => false,
        };
        let (first, second) = if columns_first { (b, a) } else { (a, b) };
        let Some((reader, look)) = first else { return Err(no_stripes()) };
        let Err(error) = self.decode_lines(&reader, &look) else { return Ok(()) };
        match second {
            Some((reader, look)) => self.decode_lines(&reader, &look).map_err(|_| error),
            None => Err(error),
        }
    }

    fn decode_lines(&mut self, reader: &LineReader<'_>, look: &Look) -> Result<()> {
        let aligned = AlignedLines::for_width(look.half_period_px);
        let low_contrast = self.find(reader, look, aligned);
        self.curves.link();
        check_color(&self.curves, &mut self.scratch)?;
        self.scratch.clear();
        self.scratch.extend(self.curves.crossings.iter().map(Crossing::width));
        let width = median_f32(&mut self.scratch).unwrap_or(look.half_period_px);

        let ratio = self.period_in_widths;
        self.numbers.choose(&mut self.curves, aligned, width);
        let (reversed, fit) = self.recognise()?;
        let slits = self.candidates.slits(reversed);
        self.numbers.number(&self.curves, Code { slits, period_per_width: ratio });

        let slits = slits.len();
        check_runs(&self.curves, &self.numbers.votes, self.window, &mut self.scratch)?;
        check_neighbors(&mut self.numbers, &self.curves, slits, self.window)?;
        check_hues(&self.palette, &self.numbers.hues.directions)?;

        let nominal = (0.5 * self.pattern.width_px) as f32;
        let gaps = self.pattern.centres_px.windows(2).map(|w| (w[1] - w[0]) as f32);
        if reversed {
            self.spacing.set(gaps.rev(), nominal);
        } else {
            self.spacing.set(gaps, nominal);
        }
        let votes = &self.numbers.votes;
        let half_px =
            stripe_centers::measure_half_width(&self.curves, votes, &self.spacing, &mut self.scratch);
        self.spacing.set_half_width(half_px);
        stripe_centers::locate(&self.curves, votes, &self.spacing, &mut self.scratch, &mut self.centres);
        let reach = (SIGMA_WIDTHS * width).ceil() as usize;
        stripe_centers::measure_sigma(&self.curves, votes, reach, &mut self.sigma_work, &mut self.centres);

        let n = self.curves.crossings.len();
        let hues = &self.numbers.hues;
        let report = &mut self.out.report;
        report.crossings = n + low_contrast;
        report.rejected = Rejected { low_contrast, ..Rejected::default() };
        report.lines = reader.scan;
        report.stripe_width_px = f64::from(width);
        report.width_ratio = f64::from(half_px / nominal);
        report.noise_levels = f64::from(self.noise.sigma_code * 255.0);
        report.hues_seen.clear();
        report.hues_seen.extend(hues.directions.iter().map(|d| d.map(f64::from)));
        report.crosstalk = crosstalk(&self.palette, &hues.directions, &hues.brightness);
        report.hue_spread_rad = f64::from(hues.spread_rad);
        let saturated = self.curves.paints.iter().filter(|p| p.saturated).count();
        report.saturated = saturated as f64 / self.curves.paints.len().max(1) as f64;
        report.code_fit = fit;
        report.reversed = reversed;
        report.turned = (reader.scan == ScanDirection::Rows) != (self.pattern.axis == Axis::Columns);
        self.collect(reader)
    }

    /// Learns the hues and tries the pattern with them: balanced against the pattern's, which suits most photographs, and
    /// when that does not fit well also as drawn.
    fn recognise(&mut self) -> Result<(bool, f64)> {
        let balanced = self.try_hues(true);
        let perfect = (self.palette.len() as f64).ln() + 1.0;
        if balanced.as_ref().is_ok_and(|found| found.1 > GOOD_FIT * perfect) {
            return balanced;
        }
        let drawn = self.try_hues(false);
        match (&balanced, &drawn) {
            (Ok(a), Ok(b)) if a.1 <= b.1 => drawn,
            (Err(_), Ok(_)) => drawn,
            // Once more: the other try has moved the hues.
            (Ok(_), _) => self.try_hues(true),
            (Err(_), Err(_)) => balanced,
        }
    }

    fn try_hues(&mut self, balanced: bool) -> Result<(bool, f64)> {
        self.numbers.learn_hues(&self.palette, &self.pattern.sequence, balanced);
        try_pattern(&mut self.numbers, &self.curves, &mut self.candidates, self.period_in_widths)
    }

    /// All stripes of all lines; returns how many bright bands were none.
    fn find(&mut self, reader: &LineReader<'_>, look: &Look, aligned: AlignedLines) -> usize {
        let count = reader.count();
        let noise = &self.noise;
        let search = |(b, band): (usize, &mut Band)| {
            band.crossings.clear();
            band.paints.clear();
            band.ends.clear();
            band.low_contrast = 0;
            for y in b * count / BANDS..(b + 1) * count / BANDS {
                let Band { line, scratch, crossings, paints, .. } = band;
                let colored = aligned.contain(y);
                if colored {
                    reader.read(y, line);
                } else {
                    reader.read_total(y, line);
                }
                let light_at = |x: usize| reader.light(y, x, line);
                let paints = colored.then_some(paints);
                band.low_contrast +=
                    stripe_edges::find(line, look.scale, noise, scratch, light_at, crossings, paints);
                band.ends.push(band.crossings.len() as u32);
            }
        };
        each_band(&mut self.bands, self.config.parallel, search);
        self.curves.clear();
        for band in &self.bands {
            let before = self.curves.crossings.len() as u32;
            self.curves.crossings.extend_from_slice(&band.crossings);
            self.curves.paints.extend_from_slice(&band.paints);
            self.curves.lines.extend(band.ends.iter().map(|e| before + e));
        }
        self.bands.iter().map(|b| b.low_contrast).sum()
    }

    fn collect(&mut self, reader: &LineReader<'_>) -> Result<()> {
        let (curves, votes, centres) = (&self.curves, &self.numbers.votes, &self.centres);
        let report = &mut self.out.report;
        let matches = &mut self.out.matches.items;
        matches.clear();
        let n = self.pattern.sequence.len();
        self.slits_seen.clear();
        self.slits_seen.resize(n, false);
        for y in 0..curves.line_count() {
            let line = curves.of(y);
            for i in line.clone() {
                let (vote, centre) = (votes[i], centres[i]);
                if vote.label == NONE {
                    report.rejected.ambiguous += 1;
                    continue;
                }
                let twin = |j: usize| votes[j].label == vote.label && votes[j].support >= vote.support;
                if (i > line.start && twin(i - 1)) || (i + 1 < line.end && twin(i + 1)) {
                    report.rejected.duplicate += 1;
                    continue;
                }
                if centre.cut || !centre.u.is_finite() {
                    report.rejected.truncated += 1;
                    continue;
                }
                let confidence = f64::from(vote.support);
                if confidence < self.config.min_confidence {
                    report.rejected.low_confidence += 1;
                    continue;
                }
                let label = usize::from(vote.label);
                let slit = if report.reversed { n - 1 - label } else { label };
                self.slits_seen[slit] = true;
                let (along, across) = (y as f64, f64::from(centre.u));
                let at = ((across + 0.5).max(0.0) as usize).min(reader.length() - 1);
                let columns = self.pattern.axis == Axis::Columns;
                let px = self.pattern.centres_px[slit];
                matches.push(Match {
                    camera: match reader.scan {
                        ScanDirection::Rows => Point2::new(across, along),
                        ScanDirection::Columns => Point2::new(along, across),
                    },
                    projector_column: columns.then_some(px),
                    projector_row: (!columns).then_some(px),
                    slit: Some(slit as u16),
                    confidence,
                    sigma_px: f64::from(centre.sigma).max(1e-3),
                    color: reader.color(y, at, self.config.encoding),
                });
            }
        }
        report.decoded = matches.len();
        report.slits = self.slits_seen.iter().filter(|s| **s).count();
        if matches.is_empty() {
            return Err(Error::NotFound {
                what: "the pattern's code",
                seen: format!(
                    "{} stripe crossings; no stripe got a number that its neighbours confirm",
                    curves.crossings.len()
                ),
                advice: "check that the pattern file is the one that was projected".into(),
            });
        }
        Ok(())
    }
}

/// Calls `search` with every band, on several threads when asked to and built to.
fn each_band(bands: &mut [Band], parallel: bool, search: impl Fn((usize, &mut Band)) + Sync + Send) {
    #[cfg(feature = "rayon")]
    if parallel {
        use rayon::iter::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};
        bands.par_iter_mut().enumerate().for_each(search);
        return;
    }
    #[cfg(not(feature = "rayon"))]
    let _ = parallel;
    bands.iter_mut().enumerate().for_each(search);
}

fn no_stripes() -> Error {
    Error::NotFound {
        what: "stripes",
        seen: "neither along image rows nor along columns are there regular bright bands between dark ones".into(),
        advice: "photograph the object with the stripe pattern projected, in focus, in a room that is not too bright".into(),
    }
}
