//! The legend: a panel that says what is drawn, put where it hides least.

use nalgebra::{Point2, Vector2};

use super::clip::Rect;
use super::color::{BLACK, Color, WHITE, ramp};
use super::drawing::{Anchor, Drawing, Item, Pen, Shape};
use super::font::Font;

/// Sizes in units of the drawing.
const TEXT: f64 = 14.0;
const TITLE: f64 = 16.0;
/// From line to line, in sizes of the text.
const LEADING: f64 = 1.4;
const PADDING: f64 = 9.0;
const MARGIN: f64 = 8.0;
const SWATCH: f64 = 34.0;
const GAP: f64 = 8.0;
/// Longer lines are wrapped: about sixty letters, or this share of a narrow photograph.
const WIDEST: f64 = 440.0;
const WIDEST_SHARE: f64 = 0.85;
/// The panel takes no more than this share of the frame either way; its letters shrink for it.
const LARGEST_SHARE: f64 = 0.96;
/// Of the panel's black.
const PANEL_OPACITY: f64 = 0.72;
/// Colours in the picture of a ramp.
const RAMP_STEPS: usize = 24;
/// How much worse it is to hide a word than a point of a line.
const WORD_WEIGHT: f64 = 60.0;

/// What stands before an entry.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Swatch {
    /// Nothing: the text begins at the left.
    Note,
    Line(Pen),
    Dot(Pen),
    Ring(Pen),
    Arrow(Pen),
    /// A scale: a bar of this length, px of the photograph.
    Bar(Pen, f64),
    /// Several colours side by side.
    Colors(Vec<Color>),
    /// The ramp for quantities.
    Ramp,
}

/// What a mark means.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    pub(crate) swatch: Swatch,
    pub(crate) text: String,
}

/// A headline, which says the result in words, and what the marks mean.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Legend {
    pub(crate) title: String,
    pub(crate) entries: Vec<Entry>,
}

impl Legend {
    pub(crate) fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), entries: Vec::new() }
    }

    pub(crate) fn entry(mut self, swatch: Swatch, text: impl Into<String>) -> Self {
        self.entries.push(Entry { swatch, text: text.into() });
        self
    }

    pub(crate) fn note(self, text: impl Into<String>) -> Self {
        self.entry(Swatch::Note, text)
    }
}

/// A legend that has found its place.
pub(crate) struct Placed {
    pub(crate) panel: Rect,
    pub(crate) items: Vec<Item>,
}

/// Lays the legend out and puts it where it hides least of the drawing.
pub(crate) fn place(drawing: &Drawing, legend: &Legend) -> Placed {
    let unit = drawing.unit();
    let [w, h] = drawing.size.map(f64::from);
    let mut layout = Layout::new(legend, unit, (WIDEST * unit).min(WIDEST_SHARE * w));
    let shrink = (LARGEST_SHARE * w / layout.size.x).min(LARGEST_SHARE * h / layout.size.y).min(1.0);
    if shrink < 1.0 {
        layout = Layout::new(legend, unit * shrink, (WIDEST * unit).min(WIDEST_SHARE * w) * shrink);
    }
    let corner = best_corner(drawing, layout.size);
    layout.at(corner)
}

/// Of the places along the frame, the one over the fewest marks; corners before others.
fn best_corner(drawing: &Drawing, size: Vector2<f64>) -> Point2<f64> {
    let frame = drawing.frame();
    let room = frame.high - frame.low - size;
    let margin = room.map(|r| (MARGIN * drawing.unit()).min(0.5 * r.max(0.0)));
    let at = |k: usize, share: f64| frame.low[k] + margin[k] + share * (room[k] - 2.0 * margin[k]);
    let shares =
        [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.5, 1.0], [0.5, 0.0], [0.0, 0.5], [1.0, 0.5]];
    let marks = marks(drawing);
    let mut best = (f64::INFINITY, frame.low);
    for [x, y] in shares {
        let corner = Point2::new(at(0, x), at(1, y));
        let panel = Rect { low: corner, high: corner + size };
        let hidden: f64 = marks.iter().filter(|(p, _)| panel.holds(*p)).map(|(_, weight)| weight).sum();
        if hidden < best.0 {
            best = (hidden, corner);
        }
    }
    best.1
}

/// Points of everything drawn, with their weight.
fn marks(drawing: &Drawing) -> Vec<(Point2<f64>, f64)> {
    let step = 6.0 * drawing.unit();
    let mut marks = Vec::new();
    for item in &drawing.items {
        match &item.shape {
            Shape::Lines(parts) | Shape::Areas(parts) => {
                for pair in parts.iter().flat_map(|p| p.windows(2)) {
                    let along = pair[1] - pair[0];
                    // The frame holds all parts, so that this is a small number.
                    let steps = (along.norm() / step).ceil().max(1.0) as usize;
                    let point = |i: usize| pair[0] + along * (i as f64 / steps as f64);
                    let weight = item.pen.opacity * (along.norm() / step).min(1.0);
                    marks.extend((0..steps).map(|i| (point(i), weight)));
                }
            }
            Shape::Dots(centres, _) | Shape::Rings(centres, _) => {
                marks.extend(centres.iter().map(|p| (*p, 1.0)));
            }
            Shape::Text { at, .. } => marks.push((*at, WORD_WEIGHT)),
        }
    }
    marks
}

/// A legend at the origin.
struct Layout {
    size: Vector2<f64>,
    items: Vec<Item>,
}

impl Layout {
    fn new(legend: &Legend, unit: f64, widest: f64) -> Self {
        let font = Font::embedded();
        let padding = PADDING * unit;
        let mut items = Vec::new();
        let (mut y, mut right) = (padding, 0.0_f64);
        let mut text = |text: &str, left: f64, size: f64, y: &mut f64, items: &mut Vec<Item>| {
            for line in font.wrap(text, size, widest - left) {
                let at = Point2::new(left, *y + 0.5 * LEADING * size);
                right = right.max(left + font.width(&line, size));
                let shape = Shape::Text { at, text: line, size, anchor: Anchor::Start };
                items.push(Item { shape, pen: Pen::new(WHITE).plain() });
                *y += LEADING * size;
            }
        };
        if !legend.title.is_empty() {
            text(&legend.title, padding, TITLE * unit, &mut y, &mut items);
        }
        for entry in &legend.entries {
            let indent = match &entry.swatch {
                Swatch::Note => 0.0,
                Swatch::Bar(_, length) => (SWATCH * unit).max(*length) + GAP * unit,
                Swatch::Ramp => (3.0 * SWATCH + GAP) * unit,
                _ => (SWATCH + GAP) * unit,
            };
            let middle = Point2::new(padding, y + 0.5 * LEADING * TEXT * unit);
            items.extend(swatch(&entry.swatch, middle, unit));
            text(&entry.text, padding + indent, TEXT * unit, &mut y, &mut items);
        }
        let size = Vector2::new(right + padding, y + padding);
        Self { size, items }
    }

    fn at(self, corner: Point2<f64>) -> Placed {
        let shift = corner.coords;
        let panel = Rect { low: corner, high: corner + self.size };
        let back = Shape::Areas(vec![corners(&panel)]);
        let mut items = vec![Item { shape: back, pen: Pen::new(BLACK).opacity(PANEL_OPACITY).plain() }];
        items.extend(self.items.into_iter().map(|item| shifted(item, shift)));
        Placed { panel, items }
    }
}

fn corners(rect: &Rect) -> Vec<Point2<f64>> {
    let (low, high) = (rect.low, rect.high);
    vec![low, Point2::new(high.x, low.y), high, Point2::new(low.x, high.y)]
}

fn shifted(mut item: Item, by: Vector2<f64>) -> Item {
    match &mut item.shape {
        Shape::Lines(parts) | Shape::Areas(parts) => parts.iter_mut().flatten().for_each(|p| *p += by),
        Shape::Dots(centres, _) | Shape::Rings(centres, _) => centres.iter_mut().for_each(|p| *p += by),
        Shape::Text { at, .. } => *at += by,
    }
    item
}

/// The picture before an entry, its left end's middle at a point.
fn swatch(swatch: &Swatch, left: Point2<f64>, unit: f64) -> Vec<Item> {
    let along = |units: f64| left + Vector2::new(units * unit, 0.0);
    let item = |shape: Shape, pen: Pen| Item { shape, pen };
    let middle = || vec![along(0.5 * SWATCH)];
    let block = |from: f64, to: f64, color: Color| {
        let half = Vector2::new(0.0, 4.5 * unit);
        let area = vec![along(from) - half, along(to) - half, along(to) + half, along(from) + half];
        item(Shape::Areas(vec![area]), Pen::new(color).plain())
    };
    match swatch {
        Swatch::Note => Vec::new(),
        Swatch::Line(pen) => vec![item(Shape::Lines(vec![vec![left, along(SWATCH)]]), *pen)],
        Swatch::Dot(pen) => vec![item(Shape::Dots(middle(), 3.0 * unit), *pen)],
        Swatch::Ring(pen) => vec![item(Shape::Rings(middle(), 5.0 * unit), *pen)],
        Swatch::Arrow(pen) => {
            let (tip, back, half) = (along(SWATCH), along(SWATCH - 6.0), Vector2::new(0.0, 2.7 * unit));
            vec![
                item(Shape::Lines(vec![vec![left, back]]), *pen),
                item(Shape::Areas(vec![vec![tip, back + half, back - half]]), Pen { dashed: false, ..*pen }),
            ]
        }
        Swatch::Bar(pen, length) => {
            let (end, tick) = (left + Vector2::new(*length, 0.0), Vector2::new(0.0, 3.5 * unit));
            let lines = vec![vec![left, end], vec![left - tick, left + tick], vec![end - tick, end + tick]];
            vec![item(Shape::Lines(lines), *pen)]
        }
        Swatch::Colors(colors) => {
            let wide = SWATCH / colors.len().max(1) as f64;
            let place = |i: usize| i as f64 * wide;
            colors.iter().enumerate().map(|(i, c)| block(place(i), place(i + 1), *c)).collect()
        }
        Swatch::Ramp => {
            let wide = 3.0 * SWATCH / RAMP_STEPS as f64;
            let color = |i: usize| ramp(i as f64 / (RAMP_STEPS - 1) as f64);
            // Each reaches under the next, so that no seams show.
            let last = |i: usize| ((i + 2).min(RAMP_STEPS)) as f64 * wide;
            (0..RAMP_STEPS).map(|i| block(i as f64 * wide, last(i), color(i))).collect()
        }
    }
}
