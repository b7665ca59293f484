//! The placement of a legend where it covers least.

use nalgebra::{Point2, Vector2};

use super::canvas::Drawing;
use super::clip::Rect;
use super::font::Font;
use super::legend::Legend;
use super::legend_layout::{LegendLayout, Placed};
use super::primitive::{Item, Primitive};

/// From the panel to the frame, units.
const MARGIN: f64 = 8.0;
/// Largest number of columns that is tried.
const COLUMNS: usize = 3;
/// Largest share of the frame that the panel takes in each direction.
const LARGEST_SHARE: f64 = 0.97;
/// Sizes that are tried, and how many more marks the usual size may cover: a smaller panel must cover fewer marks by more than its
/// area is smaller.
const SIZES: [(f64, f64); 3] = [(1.0, 0.0), (0.85, 0.5), (0.72, 1.2)];
/// Up to this many covered marks, letters stay at the usual size.
const WELCOME: f64 = 10.0;
/// Places of the panel, as shares of the free room.
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
/// Weights of a corner of a word and of a single mark, relative to a point of a line.
const WORD_WEIGHT: f64 = 30.0;
const RING_WEIGHT: f64 = 3.0;
/// Spacing of the points in areas that are kept clear, units, and their weight.
const CLEAR_STEP: f64 = 10.0;
const CLEAR_WEIGHT: f64 = 0.3;

impl Drawing {
    /// All items in drawing order, the legend last, where it covers least.
    pub(super) fn all_items(&self) -> Vec<Item> {
        let mut items = self.items.clone();
        items.extend(self.legend.iter().flat_map(|legend| place(self, legend).items));
        items
    }
}

/// Puts the legend where it covers least of the drawing: along the frame, in one or more columns, smaller if that helps much.
fn place(drawing: &Drawing, legend: &Legend) -> Placed {
    let unit = drawing.unit();
    let most = (drawing.frame().high - drawing.frame().low) * LARGEST_SHARE;
    let marks = marks(drawing);
    let mut best: Option<(f64, Placed)> = None;
    for (size, dislike) in SIZES {
        for columns in 1..=COLUMNS {
            let layout = LegendLayout::new(legend, size * unit, most.x, columns);
            let fits = layout.size.x <= most.x && layout.size.y <= most.y;
            // The smallest size in one column is made to fit if nothing else does.
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
    best.map_or_else(
        || LegendLayout::new(legend, unit, most.x, 1).at(drawing.frame().low),
        |(_, placed)| placed,
    )
}

/// The legend at a given corner, no wider than `widest`, with the lowest possible panel.
pub(crate) fn at(legend: &Legend, unit: f64, widest: f64, corner: Point2<f64>) -> Placed {
    let layouts = (1..=COLUMNS).map(|columns| LegendLayout::new(legend, unit, widest, columns));
    let fitting = layouts.filter(|l| l.size.x <= widest);
    let lowest = fitting.min_by(|a, b| a.size.y.total_cmp(&b.size.y));
    lowest.unwrap_or_else(|| squeezed(legend, unit, Vector2::new(widest, f64::INFINITY))).at(corner)
}

/// In one column, with letters as small as necessary.
fn squeezed(legend: &Legend, mut unit: f64, most: Vector2<f64>) -> LegendLayout {
    let mut layout = LegendLayout::new(legend, unit, most.x, 1);
    // Smaller letters wrap differently; a few rounds converge.
    for _ in 0..8 {
        let shrink = (most.x / layout.size.x).min(most.y / layout.size.y);
        if shrink >= 1.0 {
            break;
        }
        unit *= shrink.max(0.25);
        layout = LegendLayout::new(legend, unit, most.x, 1);
    }
    layout
}

/// The place along the frame that covers the fewest marks, and their number; corners come first.
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

/// Points spread over the areas that are kept clear, with their weight.
fn kept_clear(drawing: &Drawing) -> Vec<(Point2<f64>, f64)> {
    let (frame, step) = (drawing.frame(), CLEAR_STEP * drawing.unit());
    let count = |k: usize| ((frame.high[k] - frame.low[k]) / step) as u32;
    let at = |i: u32, j: u32| frame.low + Vector2::new(f64::from(i), f64::from(j)) * step;
    let grid = (0..=count(0)).flat_map(|i| (0..=count(1)).map(move |j| at(i, j)));
    let clear = |p: &Point2<f64>| drawing.kept_clear.iter().any(|polygon| inside(polygon, p));
    grid.filter(clear).map(|p| (p, CLEAR_WEIGHT)).collect()
}

/// Whether a ray from a point to the right crosses a polygon's sides an odd number of times.
fn inside(polygon: &[Point2<f64>], p: &Point2<f64>) -> bool {
    let sides = polygon.iter().zip(polygon.iter().cycle().skip(1));
    let crossed = sides
        .filter(|(a, b)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y));
    crossed.count() % 2 == 1
}

/// Points of everything drawn, with their weight.
fn marks(drawing: &Drawing) -> Vec<(Point2<f64>, f64)> {
    let step = 6.0 * drawing.unit();
    let mut marks = kept_clear(drawing);
    for item in &drawing.items {
        match &item.primitive {
            Primitive::Lines(parts) | Primitive::Areas(parts) => {
                for pair in parts.iter().flat_map(|p| p.windows(2)) {
                    let along = pair[1] - pair[0];
                    // The frame holds all parts, so that this is a small number.
                    let steps = (along.norm() / step).ceil().max(1.0) as usize;
                    let point = |i: usize| pair[0] + along * (i as f64 / steps as f64);
                    let weight = item.pen.opacity * (along.norm() / step).min(1.0);
                    marks.extend((0..steps).map(|i| (point(i), weight)));
                }
            }
            Primitive::Dots(centres, _) => marks.extend(centres.iter().map(|p| (*p, 1.0))),
            Primitive::Rings(centres, _) => marks.extend(centres.iter().map(|p| (*p, RING_WEIGHT))),
            Primitive::Text { at, text, size, .. } => {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::drawing::color::WHITE;
    use crate::picture::drawing::legend::Swatch;
    use crate::picture::drawing::primitive::Pen;

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
            match &item.primitive {
                Primitive::Lines(parts) | Primitive::Areas(parts) => points.extend(parts.iter().flatten()),
                Primitive::Dots(centres, r) | Primitive::Rings(centres, r) => {
                    let d = Vector2::new(*r, *r);
                    points.extend(centres.iter().flat_map(|c| [c - d, c + d]));
                }
                Primitive::Text { at, text, size, .. } => {
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
    fn it_does_not_lie_across_a_sheet_whose_sides_alone_are_drawn() {
        // Room for it above and below the sheet only.
        let corners = [[60.0, 230.0], [1140.0, 240.0], [1150.0, 670.0], [50.0, 660.0]].map(Point2::from);
        let mut drawing = Drawing::new([1200, 900], "");
        drawing.outline(&corners, Pen::new(WHITE));
        drawing.keep_clear(&corners);
        drawing.keep_clear(&[Point2::new(f64::NAN, 0.0)]);
        let panel = place(&drawing, &legend()).panel;
        assert!(panel.high.y < 230.0 || panel.low.y > 670.0, "{panel:?}");
        assert!(inside(&corners, &Point2::new(600.0, 400.0)) && !inside(&corners, &Point2::new(20.0, 400.0)));
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
