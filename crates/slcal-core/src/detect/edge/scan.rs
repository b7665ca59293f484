//! Reading a photograph across a side of the sheet: along rows for steep sides, along columns for flat ones.

use nalgebra::{Point2, Vector2};

use crate::photo::LinearPhoto;

/// How a side is scanned: one crossing per row (steep sides) or per column (flat ones).
#[derive(Debug, Clone, Copy)]
pub(super) struct Scan {
    /// Crossings are searched along x (rows) or along y (columns).
    pub(super) along_x: bool,
    /// +1 when the sheet lies towards larger coordinates.
    pub(super) toward: f64,
}

impl Scan {
    pub(super) fn new(inward: Vector2<f64>) -> Self {
        let along_x = inward.x.abs() >= inward.y.abs();
        let component = if along_x { inward.x } else { inward.y };
        Self { along_x, toward: component.signum() }
    }

    /// (line, position) of a point: which row or column, and where on it.
    pub(super) fn split(self, p: Point2<f64>) -> (f64, f64) {
        if self.along_x { (p.y, p.x) } else { (p.x, p.y) }
    }

    pub(super) fn join(self, line: f64, position: f64) -> Point2<f64> {
        if self.along_x { Point2::new(position, line) } else { Point2::new(line, position) }
    }

    pub(super) fn lines(self, image: &LinearPhoto<'_>) -> usize {
        if self.along_x { image.height() } else { image.width() }
    }

    /// The pixel at an integer position of a line, or `None` outside the frame.
    pub(super) fn pixel(self, image: &LinearPhoto<'_>, line: usize, position: isize) -> Option<f64> {
        let position = usize::try_from(position).ok()?;
        let (x, y) = if self.along_x { (position, line) } else { (line, position) };
        (x < image.width() && y < image.height()).then(|| f64::from(image.at(x, y)))
    }
}
