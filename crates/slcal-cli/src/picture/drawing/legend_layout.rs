//! The panel of a legend: headline, swatches and words, one beneath the other or in columns.

use nalgebra::{Point2, Vector2};

use super::clip::Rect;
use super::color::{BLACK, Color, WHITE, ramp};
use super::font::Font;
use super::legend::{Entry, Legend, Swatch};
use super::primitive::{Anchor, Item, Pen, Primitive};

/// Sizes in units of the drawing.
const TEXT: f64 = 14.0;
const TITLE: f64 = 16.0;
/// From line to line, in sizes of the text.
const LEADING: f64 = 1.4;
const PADDING: f64 = 9.0;
const SWATCH: f64 = 34.0;
const GAP: f64 = 8.0;
/// Wider columns are wrapped: about sixty letters.
const WIDEST: f64 = 440.0;
/// Of the panel's black.
const PANEL_OPACITY: f64 = 0.72;
/// Colours in the picture of a ramp.
const RAMP_STEPS: usize = 24;

/// A legend at its place.
pub(crate) struct Placed {
    pub(crate) panel: Rect,
    pub(crate) items: Vec<Item>,
}

/// A legend at the origin.
pub(super) struct LegendLayout {
    pub(super) size: Vector2<f64>,
    items: Vec<Item>,
}

impl LegendLayout {
    /// The headline and the notes run over the whole width, the other entries stand in columns.
    pub(super) fn new(legend: &Legend, unit: f64, widest: f64, columns: usize) -> Self {
        let (notes, marks): (Vec<_>, Vec<_>) = legend.entries.iter().partition(|e| e.swatch == Swatch::Note);
        let [padding, between] = [PADDING * unit, 2.0 * PADDING * unit];
        let inner = (widest - 2.0 * padding).min(columns as f64 * WIDEST * unit);
        let columns = columns.clamp(1, marks.len().max(1));
        let column = (inner - between * (columns - 1) as f64) / columns as f64;
        let mut block = Writer { unit, at: Vector2::zeros(), ..Writer::default() };
        let (mut left, mut bottom) = (0.0, 0.0_f64);
        for entries in marks.chunks(marks.len().div_ceil(columns).max(1)) {
            block.at = Vector2::new(left, 0.0);
            for entry in entries {
                block.entry(entry, left + column);
            }
            bottom = bottom.max(block.at.y);
            left = block.right + between;
        }
        let width = block.right.max(inner);
        let mut whole = Writer { unit, at: Vector2::new(padding, padding), ..Writer::default() };
        if !legend.title.is_empty() {
            whole.text(&legend.title, TITLE, padding + width);
            whole.at.y += 0.3 * padding;
        }
        let shift = whole.at;
        whole.items.extend(block.items.into_iter().map(|item| shifted(item, shift)));
        whole.right = whole.right.max(padding + block.right);
        whole.at.y += bottom;
        for note in notes {
            whole.text(&note.text, TEXT, padding + width);
        }
        Self { size: Vector2::new(whole.right + padding, whole.at.y + padding), items: whole.items }
    }

    /// The legend on its panel, whose corner is at a point.
    pub(super) fn at(self, corner: Point2<f64>) -> Placed {
        let shift = corner.coords;
        let panel = Rect { low: corner, high: corner + self.size };
        let back = Primitive::Areas(vec![corners(&panel)]);
        let mut items = vec![Item { primitive: back, pen: Pen::new(BLACK).opacity(PANEL_OPACITY).plain() }];
        items.extend(self.items.into_iter().map(|item| shifted(item, shift)));
        Placed { panel, items }
    }
}

/// Writes from top to bottom.
#[derive(Default)]
struct Writer {
    unit: f64,
    at: Vector2<f64>,
    /// The right end of everything written.
    right: f64,
    items: Vec<Item>,
}

impl Writer {
    /// A text of a size in units that is wrapped at `end`.
    fn text(&mut self, text: &str, size: f64, end: f64) {
        let (font, size) = (Font::embedded(), size * self.unit);
        for line in font.wrap(text, size, end - self.at.x) {
            let at = Point2::from(self.at) + Vector2::new(0.0, 0.5 * LEADING * size);
            self.right = self.right.max(self.at.x + font.width(&line, size));
            let primitive = Primitive::Text { at, text: line, size, anchor: Anchor::Start };
            self.items.push(Item { primitive, pen: Pen::new(WHITE).plain() });
            self.at.y += LEADING * size;
        }
    }

    /// A swatch and what it means.
    fn entry(&mut self, entry: &Entry, end: f64) {
        let unit = self.unit;
        let indent = match &entry.swatch {
            Swatch::Note => 0.0,
            Swatch::Bar(_, length) => (SWATCH * unit).max(*length) + GAP * unit,
            Swatch::Ramp => (3.0 * SWATCH + GAP) * unit,
            _ => (SWATCH + GAP) * unit,
        };
        let middle = Point2::from(self.at) + Vector2::new(0.0, 0.5 * LEADING * TEXT * unit);
        self.items.extend(swatch(&entry.swatch, middle, unit));
        self.at.x += indent;
        self.text(&entry.text, TEXT, end);
        self.at.x -= indent;
    }
}

fn corners(rect: &Rect) -> Vec<Point2<f64>> {
    let (low, high) = (rect.low, rect.high);
    vec![low, Point2::new(high.x, low.y), high, Point2::new(low.x, high.y)]
}

fn shifted(mut item: Item, by: Vector2<f64>) -> Item {
    match &mut item.primitive {
        Primitive::Lines(parts) | Primitive::Areas(parts) => {
            parts.iter_mut().flatten().for_each(|p| *p += by);
        }
        Primitive::Dots(centres, _) | Primitive::Rings(centres, _) => {
            for p in centres {
                *p += by;
            }
        }
        Primitive::Text { at, .. } => *at += by,
    }
    item
}

/// The picture before an entry, its left end's middle at a point.
fn swatch(swatch: &Swatch, left: Point2<f64>, unit: f64) -> Vec<Item> {
    let along = |units: f64| left + Vector2::new(units * unit, 0.0);
    let item = |primitive: Primitive, pen: Pen| Item { primitive, pen };
    let middle = || vec![along(0.5 * SWATCH)];
    let block = |from: f64, to: f64, color: Color| {
        let half = Vector2::new(0.0, 4.5 * unit);
        let area = vec![along(from) - half, along(to) - half, along(to) + half, along(from) + half];
        item(Primitive::Areas(vec![area]), Pen::new(color).plain())
    };
    match swatch {
        Swatch::Note => Vec::new(),
        Swatch::Line(pen) => vec![item(Primitive::Lines(vec![vec![left, along(SWATCH)]]), *pen)],
        Swatch::Dot(pen) => vec![item(Primitive::Dots(middle(), 3.0 * unit), *pen)],
        Swatch::Ring(pen) => vec![item(Primitive::Rings(middle(), 5.0 * unit), *pen)],
        Swatch::Arrow(pen) => {
            let (tip, back, half) = (along(SWATCH), along(SWATCH - 6.0), Vector2::new(0.0, 2.7 * unit));
            vec![
                item(Primitive::Lines(vec![vec![left, back]]), *pen),
                item(
                    Primitive::Areas(vec![vec![tip, back + half, back - half]]),
                    Pen { dashed: false, ..*pen },
                ),
            ]
        }
        Swatch::Cross(pen) => {
            let centre = along(0.5 * SWATCH);
            let arms = [Vector2::new(4.5, 4.5), Vector2::new(4.5, -4.5)].map(|d| d * unit);
            vec![item(Primitive::Lines(arms.iter().map(|d| vec![centre - d, centre + d]).collect()), *pen)]
        }
        Swatch::Bar(pen, length) => {
            let (end, tick) = (left + Vector2::new(*length, 0.0), Vector2::new(0.0, 3.5 * unit));
            let lines = vec![vec![left, end], vec![left - tick, left + tick], vec![end - tick, end + tick]];
            vec![item(Primitive::Lines(lines), *pen)]
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
