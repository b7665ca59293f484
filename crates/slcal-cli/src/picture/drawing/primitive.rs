//! What a drawing is made of: shapes, and how each is drawn.

use nalgebra::Point2;

use super::color::Color;

/// How something is drawn. Widths are in units of the drawing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pen {
    pub(crate) color: Color,
    pub(crate) width: f64,
    pub(crate) opacity: f64,
    pub(crate) dashed: bool,
    /// A dark outline, so that it shows on bright paper, too.
    pub(crate) halo: bool,
}

impl Pen {
    /// A solid line with a halo, one unit wide.
    pub(crate) fn new(color: Color) -> Self {
        Self { color, width: 1.0, opacity: 1.0, dashed: false, halo: true }
    }
    pub(crate) fn width(self, width: f64) -> Self {
        Self { width, ..self }
    }
    pub(crate) fn opacity(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }
    pub(crate) fn dashed(self) -> Self {
        Self { dashed: true, ..self }
    }
    pub(crate) fn plain(self) -> Self {
        Self { halo: false, ..self }
    }
}

/// Which part of a text stands at its point; its capitals are centred there vertically.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// Coordinates and lengths in pixels of the photograph, pixel centres at integers.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Primitive {
    /// Lines through points.
    Lines(Vec<Vec<Point2<f64>>>),
    /// Filled polygons.
    Areas(Vec<Vec<Point2<f64>>>),
    /// Filled circles.
    Dots(Vec<Point2<f64>>, f64),
    /// Circles.
    Rings(Vec<Point2<f64>>, f64),
    Text {
        at: Point2<f64>,
        text: String,
        size: f64,
        anchor: Anchor,
    },
}

/// A primitive and how it is drawn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Item {
    pub(crate) primitive: Primitive,
    pub(crate) pen: Pen,
}
