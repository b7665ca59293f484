//! The stages of decoding, in order, and the buffers that they keep from one photograph to the next.

use nalgebra::Point2;

use super::center_sigma::{SigmaWork, measure_sigma};
use super::code_check::{CodeCandidates, another_pattern, check_color, try_pattern};
use super::config::{DecodeConfig, DecodeInput, DecodeReport, Decoding, Rejected, ScanDirection};
use super::consistency::{check_neighbors, check_runs};
use super::crossing_features::NONE;
use super::crosstalk::{check_hues, crosstalk, mixing};
use super::in_threads::for_each;
use super::labeling::{AlignedLines, Labeling};
use super::noise::Noise;
use super::registration::{Labelled, Registration};
use super::row_parity;
use super::scanlines::{self, Scanline, ScanlineReader, Tables};
use super::sequence_alignment::Code;
use super::slit_layout::SlitLayout;
use super::stripe_centers::{self, StripeCenter};
use super::stripe_edges::{self, Scratch, StripeColor, StripeEdges};
use super::stripe_scale::{ScaleScratch, StripeScale, measure_scale};
use super::touching_stripes::{stripes_touch, touching};
use super::tracks::Tracks;
use crate::error::{Error, ErrorSubject, Result};
use crate::matches::Match;
use crate::pattern::{Axis, StripePattern, unique_window};
use crate::photo::{Encoding, PhotoView};
use crate::solve::median_f32;

/// Number of bands of scanlines; each can be searched by its own thread.
const BANDS: usize = 16;
/// The scatter of centres is measured over this many stripe widths along a track to either side.
const SIGMA_WIDTHS: f32 = 3.0;
/// Share of the score of a perfect fit above which no better classes are sought.
const GOOD_FIT: f64 = 0.75;
/// The scanlines run in the direction in which stripes are closer together, unless less than this share of what the
/// other direction covers is covered there.
const COVERED_SHARE: f64 = 0.4;

/// Finds the stripes of a photograph and identifies their slits. A [`DecodeInput`] adds two optional photographs: one with
/// a dark projector (ambient light is subtracted) and one with a plain white projection (the surface's own colour is
/// divided out).
///
/// # Errors
/// [`crate::Error::Invalid`] for a greyscale photograph, frames of different sizes or a configuration out of range;
/// [`crate::Error::NotFound`] when there are no stripes, when they have no colour, or when their colours follow the
/// pattern no better than by chance.
///
/// # Examples
/// ```
/// use slcal_core::decode::{DecodeConfig, decode};
/// use slcal_core::{PhotoView, StripePattern};
///
/// let stripes = StripePattern::new([1024, 768], &Default::default())?;
/// let photo = image::open(concat!(env!("CARGO_MANIFEST_DIR"), "/../slcal-cli/demo/board.jpg"))?;
/// let decoding = decode(PhotoView::try_from(&photo)?, &stripes, &DecodeConfig::default())?;
/// assert!(decoding.matches.items.len() > 10_000);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn decode<'a>(
    scene: impl Into<DecodeInput<'a>>,
    pattern: &StripePattern,
    config: &DecodeConfig,
) -> Result<Decoding> {
    let mut decoder = Decoder::new(pattern, *config)?;
    decoder.decode(scene)?;
    Ok(decoder.out)
}

/// Stripes that are finer than this are told by the colours of a few pixels, which blur, a Bayer mosaic and compression mix: refusals
/// are then likely a matter of resolution. Photographs with demosaicing, JPEG and blur were refused up to 2.1 px, and read from 2.6 px on.
const FINEST_PX: f32 = 3.0;

/// Decodes one photograph after another with the same pattern. After the first few its buffers do not grow.
#[derive(Debug, Clone)]
pub struct Decoder {
    /// As it lies on the panel.
    pattern: StripePattern,
    config: DecodeConfig,
    candidates: CodeCandidates,
    palette: Vec<[f32; 3]>,
    /// A window of this many neighbouring hues occurs once.
    window: usize,
    /// Distance between neighbouring slits over their width.
    period_in_widths: f32,
    tables: Tables,
    noise: Noise,
    scale_scratch: ScaleScratch,
    bands: Vec<Band>,
    tracks: Tracks,
    labeling: Labeling,
    centers: Vec<StripeCenter>,
    layout: SlitLayout,
    registration: Registration,
    sigma_work: SigmaWork,
    scratch: Vec<f32>,
    slits_seen: Vec<bool>,
    out: Decoding,
}

/// Neighbouring scanlines and the stripes on them.
#[derive(Debug, Clone, Default)]
struct Band {
    line: Scanline,
    scratch: Scratch,
    crossings: Vec<StripeEdges>,
    colors: Vec<StripeColor>,
    /// Crossings up to and including each scanline.
    ends: Vec<u32>,
    low_contrast: usize,
}

impl Decoder {
    /// Prepares for a pattern.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a pattern that contradicts itself or has one colour only, or a configuration out of
    /// range.
    pub fn new(pattern: &StripePattern, config: DecodeConfig) -> Result<Self> {
        config.validate()?;
        pattern.validate()?;
        let mirrored = config.mirrored.then(|| pattern.mirrored());
        let pattern = mirrored.as_ref().unwrap_or(pattern);
        let light = |c: u8| Encoding::Srgb.to_linear(f64::from(c) / 255.0) as f32;
        Ok(Self {
            pattern: pattern.clone(),
            config,
            candidates: CodeCandidates::new(pattern)?,
            palette: pattern.palette.iter().map(|c| c.map(light)).collect(),
            window: unique_window(&pattern.sequence),
            period_in_widths: (pattern.period_px() / pattern.width_px) as f32,
            tables: Tables::default(),
            noise: Noise::new(config.encoding),
            scale_scratch: ScaleScratch::default(),
            bands: vec![Band::default(); BANDS],
            tracks: Tracks::default(),
            labeling: Labeling::default(),
            centers: Vec::new(),
            layout: SlitLayout::default(),
            registration: Registration::default(),
            sigma_work: SigmaWork::default(),
            scratch: Vec::new(),
            slits_seen: Vec::new(),
            out: Decoding::default(),
        })
    }

    /// Exchanges the last report for another one, whose memory the next one will use.
    pub(crate) fn swap_report(&mut self, with: &mut DecodeReport) {
        std::mem::swap(&mut self.out.report, with);
    }

    /// Finds the stripes of a photograph and identifies their slits.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a greyscale photograph or frames of different sizes; [`Error::NotFound`] when there are
    /// no stripes, when they have no colour, or when their colours follow the pattern no better than by chance.
    pub fn decode<'a>(&mut self, scene: impl Into<DecodeInput<'a>>) -> Result<&Decoding> {
        let input = &scene.into();
        scanlines::check(input)?;
        let frames = [Some(input.photo), input.black, input.white];
        for view in frames.iter().flatten() {
            self.tables.prepare(view, self.config.encoding);
        }
        // The direction that looks most like stripes comes first, the other one when the first does not show this
        // pattern.
        let tables = std::mem::take(&mut self.tables);
        let result =
            self.decode_either_way(input, &tables).map_err(|error| self.named(error, input, &tables));
        self.tables = tables;
        result?;
        Ok(&self.out)
    }

    /// A refusal with its reason where that can be told: channels that are exchanged, another family of patterns.
    fn named(&mut self, error: Error, input: &DecodeInput<'_>, tables: &Tables) -> Error {
        let Error::NotFound { what, .. } = &error else { return error };
        if matches!(what, ErrorSubject::PatternCode | ErrorSubject::PatternHues)
            && let Some(exchanged) = exchanged(input)
            && self.decode_either_way(&exchanged, tables).is_ok()
        {
            return Error::NotFound {
                what: ErrorSubject::PatternHues,
                seen: "stripes whose code fits with red and blue exchanged".into(),
                advice: "give the photograph as RGB: programs that use OpenCV write BGR; or project the pattern with its colours in their order".into(),
            };
        }
        let either = [ScanDirection::Rows, ScanDirection::Columns];
        let touch =
            either.iter().any(|scan| stripes_touch(&ScanlineReader::new(input, tables, *scan), &self.noise));
        if touch { touching() } else { error }
    }

    fn decode_either_way(&mut self, input: &DecodeInput<'_>, tables: &Tables) -> Result<()> {
        let [rows, columns] = [ScanDirection::Rows, ScanDirection::Columns]
            .map(|scan| ScanlineReader::new(input, tables, scan));
        self.noise.measure(&rows);
        let [a, b] = [&rows, &columns]
            .map(|r| measure_scale(r, &self.noise, &mut self.scale_scratch).map(|l| (*r, l)));
        // Scanlines of either direction cross slanted stripes; the right direction is the one in which they are closer
        // together.
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
        let Some((reader, scale)) = first else { return Err(no_stripes()) };
        let Err(error) = self.decode_lines(&reader, &scale) else { return Ok(()) };
        if let Some((reader, scale)) = &second
            && self.decode_lines(reader, scale).is_ok()
        {
            return Ok(());
        }
        // The direction that sees more of the picture covered with stripes.
        let scales = [Some(&scale), second.as_ref().map(|s| &s.1)].into_iter().flatten();
        let most = scales.max_by(|a, b| a.covered_px.total_cmp(&b.covered_px));
        let width_px = most.map_or(f32::INFINITY, |s| s.half_period_px);
        Err(if width_px < FINEST_PX { too_fine(error, width_px) } else { error })
    }

    fn decode_lines(&mut self, reader: &ScanlineReader<'_>, scale: &StripeScale) -> Result<()> {
        self.noise.unlit.measure(reader, scale.half_period_px, scale.radii.smoothing);
        let aligned = AlignedLines::for_width(scale.half_period_px);
        let low_contrast = self.find(reader, scale, aligned);
        self.tracks.link();
        check_color(&self.tracks, &mut self.scratch)?;
        self.scratch.clear();
        self.scratch.extend(self.tracks.crossings.iter().map(StripeEdges::width));
        let width = median_f32(&mut self.scratch).unwrap_or(scale.half_period_px);

        let ratio = self.period_in_widths;
        self.labeling.select(&mut self.tracks, aligned, width);
        let (reversed, fit) = self.recognize()?;
        let slits = self.candidates.slits(reversed);
        self.labeling.label_all(&self.tracks, Code { slits, period_per_width: ratio });

        let slits = slits.len();
        check_runs(&self.tracks, &self.labeling.votes, self.window, &mut self.scratch)?;
        check_neighbors(&mut self.labeling, &self.tracks, slits, self.window)?;
        check_hues(&self.palette, &self.labeling.classes.directions)?;

        let nominal = (0.5 * self.pattern.width_px) as f32;
        let gaps = self.pattern.centres_px.windows(2).map(|w| (w[1] - w[0]) as f32);
        if reversed {
            self.layout.set(gaps.rev(), nominal);
        } else {
            self.layout.set(gaps, nominal);
        }
        let votes = &self.labeling.votes;
        let slits = self.candidates.slits(reversed);
        let demosaiced = row_parity::remove(&mut self.tracks, votes, slits, &mut self.scratch);
        let half_px =
            stripe_centers::measure_half_width(&self.tracks, votes, &self.layout, &mut self.scratch);
        self.layout.set_half_width(half_px);
        let hues = &self.labeling.classes;
        let mixing = mixing(&self.palette, &hues.directions, &hues.brightness);
        let labelled = Labelled {
            tracks: &mut self.tracks,
            votes,
            layout: &self.layout,
            slits,
            reversed,
            pattern: &self.pattern,
        };
        let channel_shift = self.registration.locate(
            labelled,
            reader,
            self.config.registration.as_ref(),
            (&hues.directions, mixing.as_ref()),
            &mut self.scratch,
            &mut self.centers,
        );
        let reach = (SIGMA_WIDTHS * width).ceil() as usize;
        measure_sigma(&self.tracks, votes, reach, &mut self.sigma_work, &mut self.centers);

        let n = self.tracks.crossings.len();
        let report = &mut self.out.report;
        report.crossings = n + low_contrast;
        report.rejected = Rejected { low_contrast, ..Rejected::default() };
        report.lines = reader.scan;
        report.stripe_width_px = f64::from(width);
        report.width_ratio = f64::from(half_px / nominal);
        report.noise_levels = f64::from(self.noise.sigma_code * 255.0);
        report.hues_seen.clear();
        report.hues_seen.extend(hues.directions.iter().map(|d| d.map(f64::from)));
        report.crosstalk = mixing.as_ref().and_then(crosstalk);
        report.channel_shift = channel_shift;
        report.demosaiced = demosaiced;
        report.hue_spread_rad = f64::from(hues.spread_rad);
        let saturated = self.tracks.colors.iter().filter(|p| p.saturated).count();
        report.saturated = saturated as f64 / self.tracks.colors.len().max(1) as f64;
        report.code_fit = fit;
        report.reversed = reversed;
        report.turned = (reader.scan == ScanDirection::Rows) != (self.pattern.axis == Axis::Columns);
        self.collect(reader)
    }

    /// Learns the colour classes and tries the pattern with them: first balanced against the pattern, which suits most
    /// photographs, and when that does not fit well also as drawn.
    fn recognize(&mut self) -> Result<(bool, f64)> {
        let balanced = self.try_classes(true);
        let perfect = (self.palette.len() as f64).ln() + 1.0;
        if balanced.as_ref().is_ok_and(|found| found.1 > GOOD_FIT * perfect) {
            return balanced;
        }
        let drawn = self.try_classes(false);
        match (&balanced, &drawn) {
            (Ok(a), Ok(b)) if a.1 <= b.1 => drawn,
            (Err(_), Ok(_)) => drawn,
            // Once more, since the other try has moved the classes.
            (Ok(_), _) => self.try_classes(true),
            (Err(_), Err(_)) => balanced,
        }
    }

    fn try_classes(&mut self, balanced: bool) -> Result<(bool, f64)> {
        self.labeling.learn_classes(&self.palette, &self.pattern.sequence, balanced);
        try_pattern(&mut self.labeling, &self.tracks, &mut self.candidates, self.period_in_widths)
    }

    /// Finds all stripes on all scanlines. Returns the number of rejected peaks.
    fn find(&mut self, reader: &ScanlineReader<'_>, scale: &StripeScale, aligned: AlignedLines) -> usize {
        let count = reader.count();
        let noise = &self.noise;
        let search = |(b, band): (usize, &mut Band)| {
            band.crossings.clear();
            band.colors.clear();
            band.ends.clear();
            band.low_contrast = 0;
            for y in b * count / BANDS..(b + 1) * count / BANDS {
                let Band { line, scratch, crossings, colors, .. } = band;
                let colored = aligned.contain(y);
                if colored {
                    reader.read(y, line);
                } else {
                    reader.read_total(y, line);
                }
                let light_at = |x: usize| reader.light(y, x, line);
                let colors = colored.then_some(colors);
                band.low_contrast +=
                    stripe_edges::find(line, scale.radii, noise, scratch, light_at, crossings, colors);
                band.ends.push(band.crossings.len() as u32);
            }
        };
        for_each(&mut self.bands, self.config.parallel, search);
        self.tracks.clear();
        for band in &self.bands {
            let before = self.tracks.crossings.len() as u32;
            self.tracks.crossings.extend_from_slice(&band.crossings);
            self.tracks.colors.extend_from_slice(&band.colors);
            self.tracks.lines.extend(band.ends.iter().map(|e| before + e));
        }
        self.bands.iter().map(|b| b.low_contrast).sum()
    }

    fn collect(&mut self, reader: &ScanlineReader<'_>) -> Result<()> {
        let (tracks, votes, centers) = (&self.tracks, &self.labeling.votes, &self.centers);
        let report = &mut self.out.report;
        let matches = &mut self.out.matches.items;
        matches.clear();
        let n = self.pattern.sequence.len();
        self.slits_seen.clear();
        self.slits_seen.resize(n, false);
        for y in 0..tracks.line_count() {
            let line = tracks.of(y);
            for i in line.clone() {
                let (vote, center) = (votes[i], centers[i]);
                if vote.label == NONE {
                    report.rejected.ambiguous += 1;
                    continue;
                }
                let twin = |j: usize| votes[j].label == vote.label && votes[j].support >= vote.support;
                if (i > line.start && twin(i - 1)) || (i + 1 < line.end && twin(i + 1)) {
                    report.rejected.duplicate += 1;
                    continue;
                }
                if center.truncated || !center.u.is_finite() {
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
                let (along, across) = (y as f64, f64::from(center.u));
                let at = ((across + 0.5).max(0.0) as usize).min(reader.length() - 1);
                let columns = self.pattern.axis == Axis::Columns;
                let px = self.pattern.centres_px[slit];
                let from_end = columns && self.config.mirrored;
                matches.push(Match {
                    camera: match reader.scan {
                        ScanDirection::Rows => Point2::new(across, along),
                        ScanDirection::Columns => Point2::new(along, across),
                    },
                    projector_column: columns.then_some(px),
                    projector_row: (!columns).then_some(px),
                    slit: Some(if from_end { n - 1 - slit } else { slit } as u16),
                    confidence,
                    sigma_px: f64::from(center.sigma).max(1e-3),
                    color: reader.color(y, at, self.config.encoding),
                });
            }
        }
        report.decoded = matches.len();
        report.slits = self.slits_seen.iter().filter(|s| **s).count();
        if matches.is_empty() {
            return Err(another_pattern(
                ErrorSubject::PatternCode,
                format!(
                    "{} stripe crossings; none has a slit that its neighbours confirm",
                    tracks.crossings.len()
                ),
            ));
        }
        Ok(())
    }
}

/// The frames with red taken for blue and blue for red.
fn exchanged<'a>(input: &DecodeInput<'a>) -> Option<DecodeInput<'a>> {
    let exchange = |frame: Option<PhotoView<'a>>| frame.map(|f| f.with_red_and_blue_exchanged().unwrap_or(f));
    let photo = input.photo.with_red_and_blue_exchanged()?;
    Some(DecodeInput { photo, black: exchange(input.black), white: exchange(input.white) })
}

/// A refusal with its likely reason.
fn too_fine(error: Error, width_px: f32) -> Error {
    match error {
        Error::NotFound { what, seen, .. } => Error::NotFound {
            what,
            seen: format!(
                "{seen}; the stripes are only about {width_px:.1} px wide, too fine to tell their colours"
            ),
            advice: format!(
                "move nearer, photograph with more pixels or a sharper focus, or project fewer slits: a stripe of {FINEST_PX} px or more is safe"
            ),
        },
        other => other,
    }
}

fn no_stripes() -> Error {
    Error::NotFound {
        what: ErrorSubject::Stripes,
        seen: "no regular bright bands between dark ones, along image rows or columns".into(),
        advice: "photograph the object with the stripe pattern projected, in focus, in a room that is not too bright".into(),
    }
}
