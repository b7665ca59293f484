//! A drawing over a photograph: lines, marks and words, independent of the output format.

use nalgebra::{Point2, Vector2};

use super::clip::Rect;
use super::color::Color;
use super::legend::Legend;
use super::primitive::{Anchor, Item, Pen, Primitive};

/// Units in the longer side of a photograph, so that a picture fitted to a screen looks the same at any resolution.
const UNITS_PER_SIDE: f64 = 900.0;
/// Least size of a unit in pixels of the written picture, so that letters (14 units) are readable.
const LEAST_UNIT_PX: f64 = 0.75;
/// Photographs with a shorter longer side are enlarged, px.
const LEAST_SIDE_PX: f64 = 480.0;
/// The size of labels, units.
const LABEL: f64 = 15.0;
/// Length of an arrow's head, units; no more than this share of the arrow.
const HEAD: f64 = 5.0;
const HEAD_SHARE: f64 = 0.45;

/// A drawing over a photograph.
#[derive(Debug, Clone)]
pub(crate) struct Drawing {
    /// Of the photograph, px.
    pub(crate) size: [u32; 2],
    /// The text alternative of the picture.
    pub(crate) title: String,
    /// Whether the photograph is dimmed, so that the colours of the drawing stand out.
    pub(crate) dimmed: bool,
    /// Factor on the size of lines, marks and words.
    coarseness: f64,
    pub(crate) items: Vec<Item>,
    /// Polygons that the legend should not cover.
    pub(crate) kept_clear: Vec<Vec<Point2<f64>>>,
    pub(crate) legend: Option<Legend>,
}

impl Drawing {
    /// An empty drawing for a photograph of the given size, px.
    pub(crate) fn new(size: [u32; 2], title: impl Into<String>) -> Self {
        Self {
            size,
            title: title.into(),
            dimmed: false,
            coarseness: 1.0,
            items: Vec::new(),
            kept_clear: Vec::new(),
            legend: None,
        }
    }

    /// The same with lines, marks and words enlarged by a factor, for a picture that is shown small.
    pub(crate) fn coarser(self, coarseness: f64) -> Self {
        Self { coarseness, ..self }
    }

    fn longer_side(&self) -> f64 {
        f64::from(self.size[0].max(self.size[1]).max(1))
    }

    /// How many pixels of the picture a pixel of the photograph becomes: more than one for tiny photographs only.
    pub(crate) fn enlarged(&self) -> u32 {
        (LEAST_SIDE_PX / self.longer_side()).ceil().max(1.0) as u32
    }

    /// The width of a line, px of the photograph; letters and marks are measured in it.
    pub(crate) fn unit(&self) -> f64 {
        self.coarseness
            * (self.longer_side() / UNITS_PER_SIDE).max(LEAST_UNIT_PX / f64::from(self.enlarged()))
    }

    /// From edge to edge of the photograph.
    pub(crate) fn frame(&self) -> Rect {
        let [w, h] = self.size.map(|n| f64::from(n) - 0.5);
        Rect { low: Point2::new(-0.5, -0.5), high: Point2::new(w, h) }
    }

    /// With room for marks that reach into the frame.
    fn reach(&self) -> Rect {
        self.frame().grown(10.0 * self.unit())
    }

    /// Lines through points; what lies outside the frame or is not finite is left out.
    pub(crate) fn lines<'a>(&mut self, lines: impl IntoIterator<Item = &'a [Point2<f64>]>, pen: Pen) {
        let reach = self.reach();
        let parts: Vec<_> = lines.into_iter().flat_map(|line| reach.polyline(line)).collect();
        self.push(Primitive::Lines(parts), pen);
    }

    /// A line through points.
    pub(crate) fn polyline(&mut self, points: &[Point2<f64>], pen: Pen) {
        self.lines([points], pen);
    }

    /// A line through points and back to the first.
    pub(crate) fn outline(&mut self, points: &[Point2<f64>], pen: Pen) {
        let closed: Vec<_> = points.iter().chain(points.first()).copied().collect();
        self.polyline(&closed, pen);
    }

    /// Asks the legend not to cover a polygon if possible.
    pub(crate) fn keep_clear(&mut self, polygon: &[Point2<f64>]) {
        if polygon.iter().all(|p| p.x.is_finite() && p.y.is_finite()) {
            self.kept_clear.push(polygon.to_vec());
        }
    }

    /// Filled circles of a radius in units.
    pub(crate) fn dots(&mut self, centres: impl IntoIterator<Item = Point2<f64>>, radius: f64, pen: Pen) {
        let centres = self.within_reach(centres);
        self.push(Primitive::Dots(centres, radius * self.unit()), pen);
    }

    /// Circles of a radius in units.
    pub(crate) fn rings(&mut self, centres: impl IntoIterator<Item = Point2<f64>>, radius: f64, pen: Pen) {
        let centres = self.within_reach(centres);
        self.push(Primitive::Rings(centres, radius * self.unit()), pen);
    }

    /// Lines with a head at their end; what is shorter than a line is wide is left out.
    pub(crate) fn arrows(&mut self, arrows: impl IntoIterator<Item = (Point2<f64>, Point2<f64>)>, pen: Pen) {
        let reach = self.reach();
        let (mut shafts, mut heads) = (Vec::new(), Vec::new());
        for (from, to) in arrows {
            let along = to - from;
            let length = along.norm();
            if !length.is_finite() || !(reach.holds(from) || reach.holds(to)) {
                continue;
            }
            if length < pen.width * self.unit() {
                continue;
            }
            let head = (HEAD * self.unit()).min(HEAD_SHARE * length);
            let back = along * (head / length);
            let side = Vector2::new(-back.y, back.x) * 0.45;
            shafts.extend(reach.polyline(&[from, to - back * 0.8]));
            if reach.holds(to) {
                heads.push(vec![to, to - back + side, to - back - side]);
            }
        }
        self.push(Primitive::Lines(shafts), pen);
        self.push(Primitive::Areas(heads), Pen { dashed: false, ..pen });
    }

    /// A word at a point, of the usual size times `scale`; nothing when the point is outside the frame.
    pub(crate) fn label(
        &mut self,
        at: Point2<f64>,
        text: impl Into<String>,
        scale: f64,
        anchor: Anchor,
        color: Color,
    ) {
        let text = text.into();
        if self.frame().holds(at) && !text.is_empty() {
            self.words(at, text, LABEL * scale * self.unit(), anchor, Pen::new(color));
        }
    }

    /// A text of a size in pixels at a point that is finite.
    pub(crate) fn words(&mut self, at: Point2<f64>, text: String, size: f64, anchor: Anchor, pen: Pen) {
        self.push(Primitive::Text { at, text, size, anchor }, pen);
    }

    fn within_reach(&self, points: impl IntoIterator<Item = Point2<f64>>) -> Vec<Point2<f64>> {
        let reach = self.reach();
        points.into_iter().filter(|p| reach.holds(*p)).collect()
    }

    fn push(&mut self, primitive: Primitive, pen: Pen) {
        let empty = match &primitive {
            Primitive::Lines(parts) | Primitive::Areas(parts) => parts.is_empty(),
            Primitive::Dots(centres, _) | Primitive::Rings(centres, _) => centres.is_empty(),
            Primitive::Text { .. } => false,
        };
        if !empty {
            self.items.push(Item { primitive, pen });
        }
    }
}
