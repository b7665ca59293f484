//! The photograph as scanlines across the stripes, in linear light.

use super::config::{DecodeInput, ScanDirection};
use crate::error::{Error, ErrorSubject, Result};
use crate::photo::{Encoding, LinearTable, PhotoView, Samples};

/// Share of full light below which a pixel of the white frame does not show the surface's colour.
const MIN_WHITE: f32 = 1e-2;

/// One scanline: the light of each pixel, its sum over the channels, and buffers for the black and the white frame.
#[derive(Debug, Clone, Default)]
pub(super) struct Scanline {
    pub(super) rgb: Vec<[f32; 3]>,
    /// The scalar in which stripes of all hues stand out.
    pub(super) total: Vec<f32>,
    /// The pixels that the photograph clips, when the black or white frame has changed their light.
    clipped: Vec<bool>,
    black: Vec<[f32; 3]>,
    white: Vec<[f32; 3]>,
}

/// Light above this share of the full one is clipped.
const CLIPPED: f32 = 0.98;

impl Scanline {
    /// Whether the photograph clips a pixel in some channel.
    pub(super) fn is_clipped(&self, at: usize) -> bool {
        let known = self.clipped.get(at).copied();
        known.unwrap_or_else(|| self.rgb.get(at).is_some_and(|p| p.iter().any(|&c| c > CLIPPED)))
    }
}

/// Tables from code values to light; made once for each sample type and kept.
#[derive(Debug, Clone, Default)]
pub(super) struct Tables {
    bytes: Option<LinearTable>,
    words: Option<LinearTable>,
}

impl Tables {
    pub(super) fn prepare(&mut self, view: &PhotoView<'_>, encoding: Encoding) {
        let slot = match view.samples() {
            Samples::U8(_) => &mut self.bytes,
            Samples::U16(_) => &mut self.words,
        };
        if slot.is_none() {
            *slot = Some(view.linear_table(encoding));
        }
    }

    fn of(&self, view: &PhotoView<'_>) -> Option<&LinearTable> {
        match view.samples() {
            Samples::U8(_) => self.bytes.as_ref(),
            Samples::U16(_) => self.words.as_ref(),
        }
    }
}

/// Reads scanlines of a photograph and of its black and white frames.
#[derive(Debug, Clone, Copy)]
pub(super) struct ScanlineReader<'a> {
    frames: &'a DecodeInput<'a>,
    tables: &'a Tables,
    pub(super) scan: ScanDirection,
}

/// What to do with a camera without colour.
pub(super) const GREY_CAMERA: &str = "With a camera that sees no colour, calibrate as usual, show stripes without colour (Gray code), \
                                      decode them with another program, and triangulate its matches";

/// Refuses frames of different sizes and photographs without colour.
pub(super) fn check(frames: &DecodeInput<'_>) -> Result<()> {
    let (w, h) = (frames.photo.width(), frames.photo.height());
    if !frames.photo.layout().has_color() {
        return Err(Error::invalid(
            ErrorSubject::StripedPhotograph,
            "a colour photograph: the stripes are told apart by their hues, which a camera without colour does not see",
            format!("a greyscale one. {GREY_CAMERA}"),
        ));
    }
    for (name, frame) in [(ErrorSubject::BlackFrame, frames.black), (ErrorSubject::WhiteFrame, frames.white)]
    {
        if let Some(f) = frame
            && (f.width(), f.height()) != (w, h)
        {
            return Err(Error::invalid(
                name,
                format!("the size of the striped photograph, {w}x{h}"),
                format!("{}x{}", f.width(), f.height()),
            ));
        }
    }
    Ok(())
}

impl<'a> ScanlineReader<'a> {
    pub(super) fn new(frames: &'a DecodeInput<'a>, tables: &'a Tables, scan: ScanDirection) -> Self {
        Self { frames, tables, scan }
    }

    /// Pixels of a scanline.
    pub(super) fn length(&self) -> usize {
        let p = &self.frames.photo;
        if self.scan == ScanDirection::Rows { p.width() } else { p.height() }
    }

    /// Number of scanlines.
    pub(super) fn count(&self) -> usize {
        let p = &self.frames.photo;
        if self.scan == ScanDirection::Rows { p.height() } else { p.width() }
    }

    /// The `k`-th of `n` scanlines spread evenly over the photograph.
    pub(super) fn spread(&self, k: usize, n: usize) -> usize {
        (2 * k + 1) * self.count() / (2 * n.max(1))
    }

    fn load(&self, view: &PhotoView<'_>, line: usize, out: &mut Vec<[f32; 3]>) {
        out.resize(self.length(), [0.0; 3]);
        let Some(table) = self.tables.of(view) else { return };
        match self.scan {
            ScanDirection::Rows => view.linear_rgb_row(line, table, out),
            ScanDirection::Columns => view.linear_rgb_column(line, table, out),
        }
    }

    /// The projector's light on a scanline, summed over the channels: the total of [`ScanlineReader::read`], without
    /// the colours where that is faster.
    pub(super) fn read_total(&self, line: usize, out: &mut Scanline) {
        let photo = &self.frames.photo;
        match (self.scan, self.tables.of(photo)) {
            (ScanDirection::Rows, Some(table)) if !self.has_companion() => {
                out.rgb.clear();
                out.total.resize(self.length(), 0.0);
                photo.linear_total_row(line, table, &mut out.total);
            }
            _ => self.read(line, out),
        }
    }

    /// The projector's light on a pixel of scanline `y`, which was read into `line` with or without its colours.
    pub(super) fn light(&self, y: usize, at: usize, line: &Scanline) -> [f32; 3] {
        let photo = &self.frames.photo;
        match (line.rgb.get(at), self.tables.of(photo)) {
            (Some(light), _) => *light,
            // Only rows of a photograph without black and white frames are read without colours.
            (None, Some(table)) if at < photo.width() && y < photo.height() => photo.linear_rgb(at, y, table),
            _ => [0.0; 3],
        }
    }

    /// The projector's light on a scanline. The black frame is subtracted and the colour of the white frame divided
    /// out, where given.
    pub(super) fn read(&self, line: usize, out: &mut Scanline) {
        self.load(&self.frames.photo, line, &mut out.rgb);
        out.clipped.clear();
        if self.has_companion() {
            out.clipped.extend(out.rgb.iter().map(|p| p.iter().any(|&c| c > CLIPPED)));
        }
        if let Some(view) = &self.frames.black {
            self.load(view, line, &mut out.black);
            subtract(&mut out.rgb, &out.black);
        }
        if let Some(view) = &self.frames.white {
            self.load(view, line, &mut out.white);
            if self.frames.black.is_some() {
                subtract(&mut out.white, &out.black);
            }
            for (o, w) in out.rgb.iter_mut().zip(&out.white) {
                for (o, w) in o.iter_mut().zip(w) {
                    *o = if *w > MIN_WHITE { (*o / w).clamp(-0.5, 2.0) } else { 0.0 };
                }
            }
        }
        out.total.clear();
        out.total.extend(out.rgb.iter().map(|c| c[0] + c[1] + c[2]));
    }

    /// The code values (0–1) of a pixel.
    pub(super) fn code(&self, line: usize, at: usize) -> [f32; 3] {
        let (x, y) = if self.scan == ScanDirection::Rows { (at, line) } else { (line, at) };
        self.frames.photo.rgb_code(x, y)
    }

    /// The colour of a pixel in the photograph, sRGB.
    pub(super) fn color(&self, line: usize, at: usize, encoding: Encoding) -> [u8; 3] {
        let (x, y) = if self.scan == ScanDirection::Rows { (at, line) } else { (line, at) };
        if encoding == Encoding::Srgb {
            return self.frames.photo.rgb_bytes(x, y);
        }
        let byte = |c: f32| {
            let light = encoding.to_linear(f64::from(c));
            (255.0 * Encoding::Srgb.from_linear(light) + 0.5) as u8
        };
        let [r, g, b] = self.frames.photo.rgb_code(x, y);
        [byte(r), byte(g), byte(b)]
    }

    /// Whether the noise of a black or white frame adds to that of the photograph.
    pub(super) fn has_companion(&self) -> bool {
        self.frames.black.is_some() || self.frames.white.is_some()
    }
}

fn subtract(from: &mut [[f32; 3]], what: &[[f32; 3]]) {
    for (f, w) in from.iter_mut().zip(what) {
        for (f, w) in f.iter_mut().zip(w) {
            *f -= w;
        }
    }
}
