//! The photograph as lines across the stripes, in linear light.

use crate::error::{Error, Result};
use crate::pattern::Axis;
use crate::photo::{Encoding, LinearTable, PhotoView};

/// Share of full light below which a pixel of the white frame says nothing about the surface's colour.
const MIN_WHITE: f32 = 1e-2;

/// A photograph with its dark and lit companions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frames<'a> {
    pub(super) photo: PhotoView<'a>,
    pub(super) black: Option<PhotoView<'a>>,
    pub(super) white: Option<PhotoView<'a>>,
}

/// Reads lines that run across the stripes: image rows for vertical stripes, columns for horizontal ones.
pub(super) struct LineReader<'a> {
    frames: Frames<'a>,
    table: LinearTable,
    black_table: Option<LinearTable>,
    white_table: Option<LinearTable>,
    axis: Axis,
    black: Vec<[f32; 3]>,
    white: Vec<[f32; 3]>,
}

impl<'a> LineReader<'a> {
    pub(super) fn new(frames: Frames<'a>, axis: Axis, encoding: Encoding) -> Result<Self> {
        encoding.validate()?;
        let (w, h) = (frames.photo.width(), frames.photo.height());
        if !frames.photo.layout().has_color() {
            return Err(Error::invalid(
                "striped photograph",
                "a colour photograph: the stripes are told apart by their hues",
                "a greyscale one",
            ));
        }
        for (name, frame) in [("black", frames.black), ("white", frames.white)] {
            if let Some(f) = frame
                && (f.width(), f.height()) != (w, h)
            {
                return Err(Error::invalid(
                    format!("{name} frame"),
                    format!("the size of the striped photograph, {w}x{h}"),
                    format!("{}x{}", f.width(), f.height()),
                ));
            }
        }
        let length = if axis == Axis::Columns { w } else { h };
        let buffer = |used: bool| vec![[0.0; 3]; if used { length } else { 0 }];
        Ok(Self {
            table: frames.photo.linear_table(encoding),
            black_table: frames.black.map(|f| f.linear_table(encoding)),
            white_table: frames.white.map(|f| f.linear_table(encoding)),
            axis,
            black: buffer(frames.black.is_some()),
            white: buffer(frames.white.is_some()),
            frames,
        })
    }

    /// Pixels of a line.
    pub(super) fn length(&self) -> usize {
        if self.axis == Axis::Columns { self.frames.photo.width() } else { self.frames.photo.height() }
    }

    /// Number of lines.
    pub(super) fn count(&self) -> usize {
        if self.axis == Axis::Columns { self.frames.photo.height() } else { self.frames.photo.width() }
    }

    /// Writes the projector's light on line `line` into `out` (of [`LineReader::length`] entries): the black frame taken
    /// off and the white frame's colour divided out, where they were given.
    pub(super) fn read(&mut self, line: usize, out: &mut [[f32; 3]]) {
        let axis = self.axis;
        let load = |view: &PhotoView<'_>, table: &LinearTable, out: &mut [[f32; 3]]| match axis {
            Axis::Columns => view.linear_rgb_row(line, table, out),
            Axis::Rows => view.linear_rgb_column(line, table, out),
        };
        load(&self.frames.photo, &self.table, out);
        if let (Some(view), Some(table)) = (&self.frames.black, &self.black_table) {
            load(view, table, &mut self.black);
            subtract(out, &self.black);
        }
        if let (Some(view), Some(table)) = (&self.frames.white, &self.white_table) {
            load(view, table, &mut self.white);
            subtract(&mut self.white, &self.black);
            for (o, w) in out.iter_mut().zip(&self.white) {
                for (o, w) in o.iter_mut().zip(w) {
                    *o = if *w > MIN_WHITE { (*o / w).clamp(-0.5, 2.0) } else { 0.0 };
                }
            }
        }
    }

    /// The photograph's own colour on a line, sRGB.
    pub(super) fn srgb(&self, line: usize, at: usize) -> [u8; 3] {
        let (x, y) = if self.axis == Axis::Columns { (at, line) } else { (line, at) };
        let light = self.frames.photo.linear_rgb(x, y, &self.table);
        light.map(|c| (Encoding::Srgb.from_linear(f64::from(c)) * 255.0).round() as u8)
    }
}

fn subtract(from: &mut [[f32; 3]], what: &[[f32; 3]]) {
    for (f, w) in from.iter_mut().zip(what) {
        for (f, w) in f.iter_mut().zip(w) {
            *f -= w;
        }
    }
}
