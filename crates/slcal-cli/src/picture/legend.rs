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
/// Wider columns are wrapped: about sixty letters.
const WIDEST: f64 = 440.0;
const COLUMNS: usize = 3;
/// The panel takes no more than this share of the frame either way.
const LARGEST_SHARE: f64 = 0.97;
/// Sizes that are tried, and how much more marks one of usual size may hide: a smaller panel is taken only when it hides
/// less by more than its area is less.
const SIZES: [(f64, f64); 3] = [(1.0, 0.0), (0.85, 0.5), (0.72, 1.2)];
/// As many hidden marks are no reason for small letters.
const WELCOME: f64 = 10.0;
/// Where the panel may stand, as shares of the room that it leaves.
const PLACES: [[f64; 2]; 16] = [
    [0.0, 0.0],
    [1.0, 0.0],
    [0.0, 1.0],
    [1.0, 1.0],
    [0.5, 1.0],
    [0.5, 0.0],
    [0.25, 1.0],
    [0.75, 1.0],
    [0.25, 0.0],
    [0.75, 0.0],
    [0.0, 0.5],
    [1.0, 0.5],
    [0.0, 0.25],
    [0.0, 0.75],
    [1.0, 0.25],
    [1.0, 0.75],
];
/// Of the panel's black.
const PANEL_OPACITY: f64 = 0.72;
/// Colours in the picture of a ramp.
const RAMP_STEPS: usize = 24;
/// How much worse it is to hide a corner of a word, or a mark of its own, than a point of a line.
const WORD_WEIGHT: f64 = 30.0;
const RING_WEIGHT: f64 = 3.0;

/// What stands before an entry.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Swatch {
    /// Nothing: the text begins at the left.
    Note,
    Line(Pen),
    Dot(Pen),
    Ring(Pen),
    Arrow(Pen),
    Cross(Pen),
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

    /// The same for a picture that is shown at a scale: bars are as long as what they stand for is shown.
    pub(crate) fn with_bars(mut self, scale: f64) -> Self {
        for entry in &mut self.entries {
            if let Swatch::Bar(_, length) = &mut entry.swatch {
                *length *= scale;
            }
        }
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

/// Lays the legend out and puts it where it hides least of the drawing: along the frame, in one column or more, smaller if
/// that helps a good deal.
pub(crate) fn place(drawing: &Drawing, legend: &Legend) -> Placed {
    let unit = drawing.unit();
    let most = (drawing.frame().high - drawing.frame().low) * LARGEST_SHARE;
    let marks = marks(drawing);
    let mut best: Option<(f64, Placed)> = None;
    for (size, dislike) in SIZES {
        for columns in 1..=COLUMNS {
            let layout = Layout::new(legend, size * unit, most.x, columns);
            let fits = layout.size.x <= most.x && layout.size.y <= most.y;
            // The smallest in one column is made to fit, should nothing else.
            if !fits && (best.is_some() || size > SIZES[SIZES.len() - 1].0 || columns < COLUMNS) {
                continue;
            }
            let layout = if fits { layout } else { squeezed(legend, size * unit, most) };
            let (hidden, corner) = best_corner(drawing, &marks, layout.size);
            let cost = (hidden + WELCOME) * (1.0 + dislike);
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, layout.at(corner)));
            }
        }
    }
    best.map_or_else(|| Layout::new(legend, unit, most.x, 1).at(drawing.frame().low), |(_, placed)| placed)
}

/// Lays the legend out at a corner of one's own choice, no wider than `widest`, as low as it can be.
pub(crate) fn at(legend: &Legend, unit: f64, widest: f64, corner: Point2<f64>) -> Placed {
    let layouts = (1..=COLUMNS).map(|columns| Layout::new(legend, unit, widest, columns));
    let fitting = layouts.filter(|l| l.size.x <= widest);
    let lowest = fitting.min_by(|a, b| a.size.y.total_cmp(&b.size.y));
    lowest.unwrap_or_else(|| squeezed(legend, unit, Vector2::new(widest, f64::INFINITY))).at(corner)
}

/// In one column, with letters as small as they must be.
fn squeezed(legend: &Legend, mut unit: f64, most: Vector2<f64>) -> Layout {
    let mut layout = Layout::new(legend, unit, most.x, 1);
    // Smaller letters are wrapped anew: a few rounds come to rest.
    for _ in 0..8 {
        let shrink = (most.x / layout.size.x).min(most.y / layout.size.y);
        if shrink >= 1.0 {
            break;
        }
        unit *= shrink.max(0.25);
        layout = Layout::new(legend, unit, most.x, 1);
    }
    layout
}

/// Of the places along the frame, the one over the fewest marks, and how many; corners before others.
fn best_corner(drawing: &Drawing, marks: &[(Point2<f64>, f64)], size: Vector2<f64>) -> (f64, Point2<f64>) {
    let frame = drawing.frame();
    let room = frame.high - frame.low - size;
    let margin = room.map(|r| (MARGIN * drawing.unit()).min(0.5 * r.max(0.0)));
    let at = |k: usize, share: f64| frame.low[k] + margin[k] + share * (room[k] - 2.0 * margin[k]);
    let mut best = (f64::INFINITY, frame.low);
    for [x, y] in PLACES {
        let corner = Point2::new(at(0, x), at(1, y));
        let panel = Rect { low: corner, high: corner + size };
        let hidden: f64 = marks.iter().filter(|(p, _)| panel.holds(*p)).map(|(_, weight)| weight).sum();
        if hidden < best.0 {
            best = (hidden, corner);
        }
    }
    best
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
            Shape::Dots(centres, _) => marks.extend(centres.iter().map(|p| (*p, 1.0))),
            Shape::Rings(centres, _) => marks.extend(centres.iter().map(|p| (*p, RING_WEIGHT))),
            Shape::Text { at, text, size, .. } => {
                // Their anchors matter little: they are short.
                let half = 0.5 * Vector2::new(Font::embedded().width(text, *size), *size);
                let corners = [[-1.0, -1.0], [1.0, -1.0], [0.0, 0.0], [-1.0, 1.0], [1.0, 1.0]];
                let point = |[x, y]: [f64; 2]| at + half.component_mul(&Vector2::new(x, y));
                marks.extend(corners.map(|c| (point(c), WORD_WEIGHT)));
            }
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
    /// The headline and the notes run over the whole width, the other entries stand in columns.
    fn new(legend: &Legend, unit: f64, widest: f64, columns: usize) -> Self {
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

    fn at(self, corner: Point2<f64>) -> Placed {
        let shift = corner.coords;
        let panel = Rect { low: corner, high: corner + self.size };
        let back = Shape::Areas(vec![corners(&panel)]);
        let mut items = vec![Item { shape: back, pen: Pen::new(BLACK).opacity(PANEL_OPACITY).plain() }];
        items.extend(self.items.into_iter().map(|item| shifted(item, shift)));
        Placed { panel, items }
    }
}

/// Writes downwards.
#[derive(Default)]
struct Writer {
    unit: f64,
    at: Vector2<f64>,
    /// As far as anything reaches.
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
            let shape = Shape::Text { at, text: line, size, anchor: Anchor::Start };
            self.items.push(Item { shape, pen: Pen::new(WHITE).plain() });
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
        Swatch::Cross(pen) => {
            let centre = along(0.5 * SWATCH);
            let arms = [Vector2::new(4.5, 4.5), Vector2::new(4.5, -4.5)].map(|d| d * unit);
            vec![item(Shape::Lines(arms.iter().map(|d| vec![centre - d, centre + d]).collect()), *pen)]
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

#[cfg(test)]
mod tests {
    use super::*;

    fn legend() -> Legend {
        let pen = Pen::new(WHITE);
        Legend::new("photo.jpg: the sheet and 70 of 70 corners of the pattern were found")
            .entry(Swatch::Line(pen), "the sheet")
            .entry(Swatch::Dot(pen), "179 points measured on its sides")
            .entry(Swatch::Bar(pen, 50.0), "0.1 px in the photograph")
            .entry(Swatch::Ramp, "2000 … 900 mm from the camera")
            .note("a note that says something about the photograph, at some length, so that it takes two lines or more")
    }

    /// Everything that is drawn, as points; of a text both ends and its height.
    fn reach(items: &[Item]) -> Vec<Point2<f64>> {
        let font = Font::embedded();
        let mut points = Vec::new();
        for item in items {
            match &item.shape {
                Shape::Lines(parts) | Shape::Areas(parts) => points.extend(parts.iter().flatten()),
                Shape::Dots(centres, r) | Shape::Rings(centres, r) => {
                    let d = Vector2::new(*r, *r);
                    points.extend(centres.iter().flat_map(|c| [c - d, c + d]));
                }
                Shape::Text { at, text, size, .. } => {
                    let wide = Vector2::new(font.width(text, *size), 0.0);
                    let high = Vector2::new(0.0, 0.5 * size);
                    points.extend([at - high, at + wide + high]);
                }
            }
        }
        points
    }

    #[test]
    fn it_stays_inside_of_every_photograph() {
        for size in [
            [64, 48],
            [320, 240],
            [640, 480],
            [480, 640],
            [1920, 1080],
            [6000, 4000],
            [4000, 300],
            [300, 4000],
        ] {
            let drawing = Drawing::new(size, "");
            let placed = place(&drawing, &legend());
            let inside = placed.panel.grown(1e-6);
            assert!(reach(&placed.items).iter().all(|p| inside.holds(*p)), "{size:?}");
            let frame = drawing.frame().grown(1e-6);
            assert!(
                frame.holds(placed.panel.low) && frame.holds(placed.panel.high),
                "{size:?} {:?}",
                placed.panel
            );
        }
    }

    #[test]
    fn it_stands_where_it_hides_nothing() {
        let size = [1200, 900];
        for free in 0..4 {
            let mut drawing = Drawing::new(size, "");
            let quarter = |p: &Point2<f64>| usize::from(p.x > 600.0) + 2 * usize::from(p.y > 450.0);
            let grid =
                (0..40).flat_map(|i| (0..30).map(move |j| Point2::new(f64::from(i), f64::from(j)) * 30.0));
            drawing.dots(grid.filter(|p| quarter(p) != free), 2.0, Pen::new(WHITE));
            let panel = place(&drawing, &legend()).panel;
            assert_eq!(quarter(&nalgebra::center(&panel.low, &panel.high)), free, "{panel:?}");
        }
    }

    #[test]
    fn a_legend_without_words_is_no_trouble() {
        let drawing = Drawing::new([640, 480], "");
        for legend in [Legend::default(), Legend::new("写真.jpg"), Legend::new("x".repeat(5000))] {
            let placed = place(&drawing, &legend);
            assert!(drawing.frame().holds(placed.panel.low) && drawing.frame().holds(placed.panel.high));
        }
    }
}
