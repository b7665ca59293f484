//! Frames of a sequence → the panel coordinates of every pixel.

use serde::{Deserialize, Serialize};

use super::code_borders::CodeBorders;
use super::frame_checks::FrameChecks;
use super::frame_noise::FrameNoise;
use super::frame_plan::FramePlan;
use super::levels::{LevelScale, levels};
use super::phase_positions::position;
use super::pixel_code::{PixelCell, Unread, cell_of, least_contrast};
use super::planes::{AxisPlanes, Planes};
use super::sample_lines::SampleLines;
use crate::dense_matches::DenseMatches;
use crate::error::{Error, ErrorSubject, Result};
use crate::pattern::{Axis, FrameLight, SequencePattern};
use crate::photo::PhotoView;
use crate::rig::Warning;
use crate::solve::median;

/// A pixel is lit when white less black is more than this many times its noise.
const LIT_SIGMAS: f32 = 5.0;
/// Pixels that are worked on together: what is kept of them stays in the processor's cache.
const BAND: usize = 1 << 14;
/// Columns of the image whose lines are read together.
const BLOCK: usize = 32;
/// The projector lights at least this share of the pixels.
const LEAST_LIT: f64 = 1e-4;
/// Medians are those of about this many pixels, spread evenly.
const SAMPLE: usize = 1 << 14;

/// Configuration of the decoding of sequences.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct SequenceDecodeConfig {
    /// Whether the projector's pictures appear with left and right exchanged.
    pub mirrored: bool,
}

/// Counts of a sequence.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[non_exhaustive]
pub struct SequenceDecodeReport {
    /// Frames of the sequence.
    pub frames: usize,
    /// Pixels of the camera.
    pub pixels: usize,
    /// Pixels on which white differs from black, or any bit from its inverse.
    pub lit: usize,
    /// Pixels with a position.
    pub decoded: usize,
    /// Lit pixels of which too little is certain: bits without contrast, or no amplitude.
    pub undecided: usize,
    /// Lit pixels whose bits mean no place on the panel, or contradict the sinusoid.
    pub contradicting: usize,
    /// 1σ of a pixel's level in a frame, as a share of white of the file (1/255 is a code value of 8 bit): the median of the lit pixels.
    pub noise: f64,
    /// White less black, as a share of white of the file: the median of the lit pixels; null when they are not shown.
    pub contrast: Option<f64>,
    /// Median 1σ of columns, panel px; null when they are not coded.
    pub median_sigma_column_px: Option<f64>,
    /// Median 1σ of rows, panel px; null when they are not coded.
    pub median_sigma_row_px: Option<f64>,
    /// What makes the result doubtful: `moved`, `saturated`.
    pub warnings: Vec<Warning>,
}

/// What a sequence says of every pixel.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct SequenceDecoding {
    /// Panel coordinates of every pixel.
    pub matches: DenseMatches,
    /// Counts.
    pub report: SequenceDecodeReport,
}

/// Decodes sequences of frames. A frame is folded into what is kept of every pixel and can be dropped: memory does not grow with the
/// number of frames (as long as they come in the [order](Self::reading_order) that needs least).
#[derive(Debug, Clone)]
pub struct SequenceDecoder {
    pattern: SequencePattern,
    config: SequenceDecodeConfig,
    plan: FramePlan,
    state: Option<State>,
    seen: Vec<bool>,
}

/// What is kept while frames come.
#[derive(Debug, Clone)]
struct State {
    width: usize,
    height: usize,
    scale: LevelScale,
    planes: Planes,
    samples: SampleLines,
    /// Levels of frames whose partners have not come, with the first pixel that they are of.
    held: Vec<Held>,
    spare: Vec<Vec<u16>>,
}

#[derive(Debug, Clone)]
struct Held {
    frame: usize,
    start: usize,
    levels: Vec<u16>,
}

impl SequenceDecoder {
    /// For the frames of this pattern.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a pattern that is not [valid](SequencePattern::validate).
    pub fn new(pattern: &SequencePattern, config: SequenceDecodeConfig) -> Result<Self> {
        pattern.validate()?;
        let plan = FramePlan::of(pattern);
        let seen = vec![false; plan.lights.len()];
        Ok(Self { pattern: pattern.clone(), config, plan, state: None, seen })
    }

    /// The order of frames in which the least has to be held: white and black, then every bit with its inverse.
    #[must_use]
    pub fn reading_order(&self) -> &[usize] {
        &self.plan.reading_order
    }

    /// Takes the photograph of a frame of the pattern, counted from 0; in any order.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a frame that is not in the pattern or has come before, and for a photograph of another size or depth than the first.
    pub fn push(&mut self, frame: usize, photo: PhotoView<'_>) -> Result<()> {
        self.accept(frame, &photo)?;
        if let Some(state) = &mut self.state {
            state.fold(&self.plan, &self.seen, frame, &photo, 0..photo.height());
        }
        Ok(())
    }

    /// Decodes frames that lie in memory, in the order of the pattern.
    ///
    /// # Errors
    /// As [`push`](Self::push) and [`finish`](Self::finish); [`Error::Invalid`] for another number of frames than the pattern has.
    pub fn decode(&mut self, frames: &[PhotoView<'_>]) -> Result<SequenceDecoding> {
        let expected = self.plan.lights.len();
        if frames.len() != expected {
            return Err(Error::invalid(
                "frames of the sequence",
                format!("{expected}, as the pattern has"),
                frames.len(),
            ));
        }
        self.clear();
        for (i, photo) in frames.iter().enumerate() {
            self.accept(i, photo)?;
        }
        if let Some(state) = &mut self.state {
            let rows = BAND.div_ceil(state.width);
            for first in (0..state.height).step_by(rows) {
                for &i in &self.plan.reading_order {
                    let rows = first..(first + rows).min(state.height);
                    state.fold(&self.plan, &self.seen, i, &frames[i], rows);
                }
            }
        }
        self.finish()
    }

    /// Drops what has come.
    pub fn clear(&mut self) {
        self.seen.fill(false);
        if let Some(state) = &mut self.state {
            state.clear();
        }
    }

    /// Checks a frame, and prepares for its size.
    fn accept(&mut self, frame: usize, photo: &PhotoView<'_>) -> Result<()> {
        let n = self.seen.len();
        if frame >= n {
            return Err(Error::invalid(
                "frame of the sequence",
                format!("below {n}, as the pattern has"),
                frame,
            ));
        }
        let name = self.plan.lights[frame];
        if self.seen[frame] {
            return Err(Error::invalid(
                "frames of the sequence",
                "each once",
                format!("frame {frame} ({name}) twice"),
            ));
        }
        let scale = LevelScale::of(photo);
        let is_first = !self.seen.contains(&true);
        let fits = |s: &State| (s.width, s.height) == (photo.width(), photo.height()) && s.scale == scale;
        match &self.state {
            Some(state) if fits(state) => {}
            Some(state) if !is_first => return Err(unlike(frame, photo, scale, state)),
            _ => self.state = Some(State::new(&self.pattern, &self.plan, photo, scale)),
        }
        self.seen[frame] = true;
        Ok(())
    }

    /// The panel coordinates of every pixel, once all frames have come; the next sequence can come then.
    ///
    /// # Errors
    /// [`Error::Invalid`] when frames are missing; [`Error::NotFound`] when no pixel is lit by the projector, or none can be read.
    pub fn finish(&mut self) -> Result<SequenceDecoding> {
        let missing: Vec<usize> = (0..self.seen.len()).filter(|i| !self.seen[*i]).collect();
        if let Some(&first) = missing.first() {
            let more = missing.len() - 1;
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            let found = format!("no frame {first} ({}){more}", self.plan.lights[first]);
            return Err(Error::invalid("frames of the sequence", format!("all {}", self.seen.len()), found));
        }
        let Some(state) = &mut self.state else {
            return Err(Error::invalid("frames of the sequence", "frames", "none"));
        };
        let decoding = state.decoding(&self.plan, &self.pattern, self.config);
        self.clear();
        decoding
    }
}

fn unlike(frame: usize, photo: &PhotoView<'_>, scale: LevelScale, state: &State) -> Error {
    let kind = |s: LevelScale| match s {
        LevelScale { full: u16::MAX, .. } => "16 bit",
        LevelScale { step: 1, .. } => "8 bit in colour",
        LevelScale { .. } => "8 bit in grey",
    };
    Error::invalid(
        ErrorSubject::Named("frames of the sequence"),
        format!("{}x{} px, {}, as the others", state.width, state.height, kind(state.scale)),
        format!("{}x{} px, {} (frame {frame})", photo.width(), photo.height(), kind(scale)),
    )
}

impl State {
    fn new(pattern: &SequencePattern, plan: &FramePlan, photo: &PhotoView<'_>, scale: LevelScale) -> Self {
        let (width, height) = (photo.width(), photo.height());
        let codes = [Axis::Columns, Axis::Rows].map(|axis| pattern.code(axis));
        let shown = |light| plan.position(light).is_some();
        let planes = Planes::new(codes, width * height, shown(FrameLight::White), shown(FrameLight::Black));
        let samples = SampleLines::new(width, height, plan.lights.len());
        Self { width, height, scale, planes, samples, held: Vec::new(), spare: Vec::new() }
    }

    fn clear(&mut self) {
        self.planes.axes.iter_mut().flatten().for_each(AxisPlanes::clear);
        self.spare.extend(self.held.drain(..).map(|held| held.levels));
    }

    /// Folds rows of a frame into the planes, or holds them until the frames come that they need.
    fn fold(
        &mut self,
        plan: &FramePlan,
        seen: &[bool],
        frame: usize,
        photo: &PhotoView<'_>,
        rows: std::ops::Range<usize>,
    ) {
        let levels_known =
            [FrameLight::White, FrameLight::Black].iter().all(|l| plan.position(*l).is_some_and(|i| seen[i]));
        let start = rows.start * self.width;
        let mut own = self.spare.pop().unwrap_or_default();
        levels(photo, rows.clone(), &mut own);
        self.samples.keep(frame, rows.start, &own);
        let range = start..start + own.len();
        match plan.lights[frame] {
            FrameLight::White => {
                self.planes.white[range.clone()].copy_from_slice(&own);
                for (to, i) in self.planes.color[range.clone()].iter_mut().zip(range.clone()) {
                    *to = photo.rgb_bytes(i % self.width, i / self.width);
                }
            }
            FrameLight::Black => self.planes.black[range.clone()].copy_from_slice(&own),
            FrameLight::Sinusoid { axis, step, of, .. } => {
                if let Some(planes) = self.planes.axis(axis) {
                    planes.fold_step(f64::from(step) / f64::from(of), start, &own);
                }
            }
            FrameLight::Bit { axis, bit, inverted } => {
                if let Some(partner) = plan.partners[frame] {
                    let Some(at) = self.held.iter().position(|h| h.frame == partner && h.start == start)
                    else {
                        self.held.push(Held { frame, start, levels: own });
                        return;
                    };
                    let other = self.held.swap_remove(at).levels;
                    let (set, unset) = if inverted { (&other, &own) } else { (&own, &other) };
                    if let Some(planes) = self.planes.axis(axis) {
                        let pairs = set.iter().zip(unset);
                        planes.fold_bit(bit, start, pairs.map(|(a, b)| i32::from(*a) - i32::from(*b)));
                    }
                    self.spare.push(other);
                } else if levels_known {
                    self.fold_single(axis, bit, inverted, start, &own);
                } else {
                    self.held.push(Held { frame, start, levels: own });
                    return;
                }
            }
        }
        self.spare.push(own);
        if levels_known {
            self.fold_waiting(plan);
        }
    }

    /// Folds bits without inverses that came before white and black.
    fn fold_waiting(&mut self, plan: &FramePlan) {
        let mut i = 0;
        while i < self.held.len() {
            match plan.lights[self.held[i].frame] {
                FrameLight::Bit { axis, bit, inverted } if plan.partners[self.held[i].frame].is_none() => {
                    let Held { start, levels, .. } = self.held.swap_remove(i);
                    self.fold_single(axis, bit, inverted, start, &levels);
                    self.spare.push(levels);
                }
                _ => i += 1,
            }
        }
    }

    /// Folds a bit without an inverse: its threshold is the mean of white and black.
    fn fold_single(&mut self, axis: Axis, bit: u32, inverted: bool, start: usize, own: &[u16]) {
        let Planes { white, black, axes, .. } = &mut self.planes;
        let Some(planes) = &mut axes[axis.index()] else { return };
        let sign = if inverted { -1 } else { 1 };
        let thresholds =
            white[start..].iter().zip(&black[start..]).map(|(w, b)| i32::from(*w) + i32::from(*b));
        planes.fold_bit(
            bit,
            start,
            own.iter().zip(thresholds).map(|(v, sum)| sign * (2 * i32::from(*v) - sum)),
        );
    }

    fn decoding(
        &mut self,
        plan: &FramePlan,
        pattern: &SequencePattern,
        config: SequenceDecodeConfig,
    ) -> Result<SequenceDecoding> {
        let noise = FrameNoise::of(&self.samples, plan, self.scale);
        let checks = FrameChecks { samples: &self.samples, plan, noise: &noise, scale: self.scale };
        let warnings = checks.check()?;
        let read = Reader { state: self, noise: &noise, paired: plan.partners.iter().any(Option::is_some) };
        let mut decoding = SequenceDecoding::default();
        let DenseMatches { width, height, column, sigma_column, row, sigma_row, confidence, color } =
            &mut decoding.matches;
        (*width, *height) = (self.width, self.height);
        confidence.resize(self.width * self.height, 1.0);
        let mut counts = Counts::default();
        if let Some(planes) = &self.planes.axes[0] {
            read.axis(planes, Axis::Columns, [column, sigma_column], confidence, &mut counts);
        }
        if let Some(planes) = &self.planes.axes[1] {
            read.axis(planes, Axis::Rows, [row, sigma_row], confidence, &mut counts);
        }
        color.clone_from(&self.planes.color);
        if config.mirrored {
            let last = (pattern.projector[0] - 1) as f32;
            for c in column.iter_mut() {
                *c = last - *c;
            }
        }
        decoding.report = read.report(plan.lights.len(), &decoding.matches, &counts);
        decoding.report.warnings = warnings;
        check_seen(&decoding.report)?;
        check_parallax(&decoding.matches, pattern.projector)?;
        Ok(decoding)
    }
}

/// Pixels by what became of them, and samples of what is reported.
#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    undecided: usize,
    contradicting: usize,
}

impl Counts {
    fn count(&mut self, unread: Unread) {
        match unread {
            Unread::Undecided => self.undecided += 1,
            Unread::Contradicting => self.contradicting += 1,
        }
    }
}

/// Reads positions from the planes.
struct Reader<'a> {
    state: &'a State,
    noise: &'a FrameNoise,
    /// Whether bits have inverses.
    paired: bool,
}

impl Reader<'_> {
    /// White less black of a pixel, where both are shown.
    #[inline]
    fn lit(&self, pixel: usize) -> Option<f32> {
        let planes = &self.state.planes;
        let white = planes.white.get(pixel)?;
        Some(f32::from(*white) - f32::from(*planes.black.get(pixel)?))
    }

    /// The noise of a pixel's levels.
    #[inline]
    fn sigma(&self, pixel: usize) -> f32 {
        let planes = &self.state.planes;
        let level = match (planes.white.get(pixel), planes.black.get(pixel)) {
            (Some(w), Some(b)) => 0.5 * (f32::from(*w) + f32::from(*b)),
            (Some(w), None) => 0.5 * f32::from(*w),
            _ => 0.5 * f32::from(self.state.scale.full),
        };
        self.noise.at(level)
    }

    /// Whether the projector lights a pixel, as far as this axis shows it.
    #[inline]
    fn is_lit(&self, planes: &AxisPlanes, pixel: usize, sigma: f32) -> bool {
        let least = LIT_SIGMAS * std::f32::consts::SQRT_2 * sigma;
        match self.lit(pixel) {
            Some(lit) => lit > least,
            None if planes.word.is_empty() => true,
            // The second least contrast of all: one bit may be undecided.
            None => 2.0 * f32::from(planes.weakest[pixel][1]) > least,
        }
    }

    /// Positions of all pixels along an axis, with σ.
    fn axis(
        &self,
        planes: &AxisPlanes,
        axis: Axis,
        [to, to_sigma]: [&mut Vec<f32>; 2],
        confidence: &mut [f32],
        counts: &mut Counts,
    ) {
        let pixels = self.state.width * self.state.height;
        to.clear();
        to.resize(pixels, f32::NAN);
        to_sigma.clear();
        to_sigma.resize(pixels, f32::NAN);
        if planes.code.sinusoid.is_some() {
            for pixel in 0..pixels {
                let sigma = self.sigma(pixel);
                if !self.is_lit(planes, pixel, sigma) {
                    continue;
                }
                let cell =
                    if planes.code.bits == 0 { Ok(None) } else { self.cell(planes, pixel, sigma).map(Some) };
                match cell.and_then(|cell| position(planes, pixel, cell, sigma)) {
                    Ok((at, sigma)) => (to[pixel], to_sigma[pixel]) = (at, sigma),
                    Err(unread) => counts.count(unread),
                }
            }
        } else {
            self.lines(planes, axis, to, to_sigma, counts);
        }
        for (pixel, confidence) in confidence.iter_mut().enumerate() {
            if to[pixel].is_finite() {
                *confidence = confidence.min(self.confidence(planes, pixel));
            }
        }
    }

    fn cell(&self, planes: &AxisPlanes, pixel: usize, sigma: f32) -> std::result::Result<PixelCell, Unread> {
        cell_of(planes, pixel, least_contrast(sigma, self.lit(pixel), self.paired))
    }

    /// The contrast that the position rests on, as a share of white less black.
    fn confidence(&self, planes: &AxisPlanes, pixel: usize) -> f32 {
        let Some(lit) = self.lit(pixel) else { return 1.0 };
        let contrast = match planes.code.sinusoid {
            Some((_, steps)) => 4.0 / steps as f32 * planes.cosine[pixel].hypot(planes.sine[pixel]),
            None => 2.0 * f32::from(planes.weakest[pixel][1]),
        };
        (contrast / lit).clamp(0.0, 1.0)
    }

    /// Positions by the borders of the code along lines of the image: rows for columns of the panel, columns for its rows.
    fn lines(
        &self,
        planes: &AxisPlanes,
        axis: Axis,
        to: &mut [f32],
        to_sigma: &mut [f32],
        counts: &mut Counts,
    ) {
        let State { width, height, .. } = *self.state;
        let (lines, length, block) = match axis {
            Axis::Columns => (height, width, 1),
            // Columns of the image that lie in the same lines of the cache.
            Axis::Rows => (width, height, BLOCK),
        };
        let index = |line: usize, i: usize| match axis {
            Axis::Columns => line * width + i,
            Axis::Rows => i * width + line,
        };
        let mut borders = CodeBorders::default();
        let mut cells = vec![u16::MAX; block * length];
        let mut found = vec![(f32::NAN, f32::NAN); block * length];
        for first in (0..lines).step_by(block) {
            let block = first..(first + block).min(lines);
            for i in 0..length {
                for line in block.clone() {
                    let pixel = index(line, i);
                    let sigma = self.sigma(pixel);
                    let cell = &mut cells[(line - first) * length + i];
                    *cell = u16::MAX;
                    if self.is_lit(planes, pixel, sigma) {
                        match self.cell(planes, pixel, sigma) {
                            Ok(read) => *cell = read.cell,
                            Err(unread) => counts.count(unread),
                        }
                    }
                }
            }
            for line in block.clone() {
                let part = (line - first) * length..(line - first + 1) * length;
                let sigma = |i: usize| self.sigma(index(line, i));
                borders.line(planes, &cells[part.clone()], |i| index(line, i), sigma, &mut found[part]);
            }
            for i in 0..length {
                for line in block.clone() {
                    (to[index(line, i)], to_sigma[index(line, i)]) = found[(line - first) * length + i];
                }
            }
        }
    }

    fn report(&self, frames: usize, matches: &DenseMatches, counts: &Counts) -> SequenceDecodeReport {
        let pixels = self.state.width * self.state.height;
        let full = f64::from(self.state.scale.full);
        let planes = &self.state.planes;
        let is_lit = |pixel: usize| {
            let sigma = self.sigma(pixel);
            planes.axes.iter().flatten().any(|axis| self.is_lit(axis, pixel, sigma))
        };
        let step = pixels.div_ceil(SAMPLE).max(1);
        let sampled: Vec<usize> = (0..pixels).step_by(step).filter(|i| is_lit(*i)).collect();
        let middle = |of: &dyn Fn(usize) -> Option<f32>| {
            let mut values: Vec<f64> =
                sampled.iter().filter_map(|i| of(*i)).filter(|x| x.is_finite()).map(f64::from).collect();
            median(&mut values)
        };
        let of_plane = |plane: &[f32]| middle(&|i| plane.get(i).copied());
        SequenceDecodeReport {
            frames,
            pixels,
            lit: (0..pixels).filter(|i| is_lit(*i)).count(),
            decoded: matches.known(),
            undecided: counts.undecided,
            contradicting: counts.contradicting,
            noise: middle(&|i| Some(self.sigma(i))).unwrap_or(0.0) / full,
            contrast: middle(&|i| self.lit(i)).map(|c| c / full),
            median_sigma_column_px: of_plane(&matches.sigma_column),
            median_sigma_row_px: of_plane(&matches.sigma_row),
            warnings: Vec::new(),
        }
    }
}

/// Refuses the pictures of the pattern themselves, and screenshots of them: every pixel sees the light of its own place.
fn check_parallax(matches: &DenseMatches, panel: [u32; 2]) -> Result<()> {
    if panel != [matches.width as u32, matches.height as u32] {
        return Ok(());
    }
    let own = |of: &[f32], place: &dyn Fn(usize) -> usize| {
        let step = of.len().div_ceil(SAMPLE).max(1);
        let known = (0..of.len()).step_by(step).filter(|i| of[*i].is_finite());
        let mut off: Vec<f64> = known.map(|i| f64::from((of[i] - place(i) as f32).abs())).collect();
        median(&mut off).is_none_or(|m| m < 0.5)
    };
    let is_own = own(&matches.column, &|i| i % matches.width) && own(&matches.row, &|i| i / matches.width);
    if !is_own {
        return Ok(());
    }
    Err(Error::NotFound {
        what: ErrorSubject::Named("a scene under the pattern"),
        seen: "frames in which every pixel shows the pattern's pixel of the same place: there is no parallax"
            .into(),
        advice: "give photographs that a camera took of the scene, not the pictures that are projected"
            .into(),
    })
}

/// Refuses sequences of which nothing can be read.
fn check_seen(report: &SequenceDecodeReport) -> Result<()> {
    // Noise alone is beyond the threshold on one pixel in a million.
    let is_dark = (report.lit as f64) < LEAST_LIT * report.pixels as f64 && report.decoded == 0;
    if report.lit == 0 || is_dark {
        return Err(Error::NotFound {
            what: ErrorSubject::Named("the light of the projector"),
            seen: format!("{} frames that are alike, but for noise, on all but {} of {} pixels", report.frames, report.lit, report.pixels),
            advice: "check that the frames are photographs of the scene, that the projector showed the pictures while they were taken, and that they are exposed well".into(),
        });
    }
    if report.decoded == 0 {
        return Err(Error::NotFound {
            what: ErrorSubject::Named("the code of the sequence"),
            seen: format!(
                "{} lit pixels, of which {} have undecided bits or no amplitude and {} have bits that mean no place on the panel",
                report.lit, report.undecided, report.contradicting
            ),
            advice: "check that the pattern file is that of these frames, and that frames are in its order"
                .into(),
        });
    }
    Ok(())
}
