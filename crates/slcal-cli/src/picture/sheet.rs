//! The sheet and the projected pattern as they were found in a photograph.

use nalgebra::{Point2, Vector2};
use slcal_core::detect::Detection;
use slcal_core::geometry::Camera;
use slcal_core::{CornerPair, SheetObservation, View, ViewObservation};

use super::drawing::color::{ORANGE, PINK, SKY, WHITE, YELLOW};
use super::drawing::legend::{Legend, Swatch};
use super::drawing::{Anchor, Drawing, Pen};
use crate::name::short;

/// Radius of a corner's mark, units; no more than this share of the distance between corners.
const RING: f64 = 4.0;
const RING_SHARE: f64 = 0.3;
/// From a sheet's corner to its name, units.
const NAME_DISTANCE: f64 = 18.0;
/// Parts of a side that is drawn as a curve.
const SIDE_STEPS: usize = 24;
/// Points drawn on one row of the panel have the same ordinate but for rounding, px.
const SAME_ROW_PX: f64 = 1e-6;

fn sheet_pen() -> Pen {
    Pen::new(SKY).width(1.4)
}
fn edge_pen() -> Pen {
    Pen::new(YELLOW).plain()
}
fn corner_pen() -> Pen {
    Pen::new(ORANGE)
}
fn first_pen() -> Pen {
    Pen::new(PINK).width(1.8)
}

/// What was found in a photograph called `name`, with a legend.
pub(crate) fn found(size: [u32; 2], name: &str, detection: &Detection) -> Drawing {
    let name = short(name);
    let mut drawing = Drawing::new(size, format!("{name}: what was found"));
    draw_view(&mut drawing, &detection.observation);
    let title = format!("{name}: {}", found_in_words(detection));
    drawing.legend = Some(legend(title, [&detection.observation]));
    drawing
}

pub(crate) fn found_in_words(detection: &Detection) -> String {
    match (detection.observation.pairs.len(), detection.pattern_corners) {
        (_, 0) => "the sheet was found".to_owned(),
        (seen, all) if !are_corners(&detection.observation.pairs) => {
            format!("the sheet was found, and pairs in {seen} of {all} parts of it")
        }
        (seen, all) => format!("the sheet and {seen} of {all} corners of the pattern were found"),
    }
}

/// Whether pairs are the corners of a checkerboard, which lie in rows on the panel. Those of a sequence lie where its pixels were read.
fn are_corners(pairs: &[CornerPair]) -> bool {
    let in_row = |i: usize| (pairs[i].projector.y - pairs[i - 1].projector.y).abs() < SAME_ROW_PX;
    pairs.len() < 2 || 2 * (1..pairs.len()).filter(|i| in_row(*i)).count() >= pairs.len() - 1
}

/// What the pairs of some views are called.
pub(crate) fn pairs_word<'a>(views: impl IntoIterator<Item = &'a ViewObservation>) -> &'static str {
    let is_sequence = views.into_iter().any(|view| !are_corners(&view.pairs));
    if is_sequence { "pairs of the sequence" } else { "projected corners" }
}

/// What can be shown when not everything was found.
#[derive(Debug, Clone, Default)]
pub(crate) enum Partly {
    #[default]
    Nothing,
    /// The corners that were given by hand.
    Given([Point2<f64>; 4]),
    /// The sheet that was found without the pattern.
    Sheet(Box<ViewObservation>),
}

/// A photograph called `name` in which not everything was found, and why, with a legend.
pub(crate) fn not_found(size: [u32; 2], name: &str, why: &str, partly: &Partly) -> Drawing {
    // The headline names the file.
    let why = why.strip_prefix(name).and_then(|w| w.strip_prefix(": ")).unwrap_or(why);
    let name = short(name);
    let mut drawing = Drawing::new(size, format!("{name}: not everything was found"));
    draw_partly(&mut drawing, partly);
    let title = format!("{name}: not everything was found");
    let legend = match partly {
        Partly::Nothing => Legend::new(title),
        Partly::Given(_) => {
            Legend::new(title).entry(Swatch::Line(sheet_pen()), "the sheet by the corners that were given")
        }
        Partly::Sheet(view) => legend(title, [view.as_ref()]),
    };
    drawing.legend = Some(legend.note(why));
    drawing
}

pub(crate) fn draw_partly(drawing: &mut Drawing, partly: &Partly) {
    match partly {
        Partly::Nothing => {}
        Partly::Given(corners) => draw_outline(drawing, corners),
        Partly::Sheet(view) => draw_view(drawing, view),
    }
}

/// What the marks of [`draw_view`] mean in one or more views.
pub(crate) fn legend<'a>(title: String, views: impl IntoIterator<Item = &'a ViewObservation>) -> Legend {
    let views: Vec<_> = views.into_iter().collect();
    let word = pairs_word(views.iter().copied());
    let (mut edge_points, mut corners) = (0, 0);
    for view in views {
        corners += view.pairs.len();
        if let SheetObservation::Edges(sides) = &view.sheet {
            edge_points += sides.iter().map(Vec::len).sum::<usize>();
        }
    }
    let mut legend = Legend::new(title).entry(Swatch::Line(sheet_pen()), "the sheet");
    if edge_points > 0 {
        legend = legend.entry(Swatch::Dot(edge_pen()), format!("{edge_points} measured edge points"));
    }
    if corners > 0 {
        legend = legend
            .entry(Swatch::Ring(corner_pen()), format!("{corners} {word}"))
            .entry(Swatch::Ring(first_pen()), "the first one (top left in the projector's image)");
    }
    legend
}

/// The sheet's outline with its corners named, the edge points that were measured, and the pattern's corners: a circle
/// each, the first one in another colour, joined along the rows of the panel.
pub(crate) fn draw_view(drawing: &mut Drawing, view: &ViewObservation) {
    draw_sheet(drawing, view);
    draw_marks(drawing, view);
}

/// The sheet's outline with its corners named.
pub(crate) fn draw_sheet(drawing: &mut Drawing, view: &ViewObservation) {
    if let Some(corners) = view.sheet.corners() {
        draw_outline(drawing, &corners);
    }
}

/// The points that were measured.
pub(crate) fn draw_marks(drawing: &mut Drawing, view: &ViewObservation) {
    if let SheetObservation::Edges(sides) = &view.sheet {
        drawing.dots(sides.iter().flatten().map(|p| p.position), 1.2, edge_pen());
    }
    let same_row = |a: &CornerPair, b: &CornerPair| (a.projector.y - b.projector.y).abs() < SAME_ROW_PX;
    let rows: Vec<Vec<Point2<f64>>> =
        view.pairs.chunk_by(same_row).map(|row| row.iter().map(|p| p.camera).collect()).collect();
    drawing.lines(rows.iter().map(Vec::as_slice), Pen::new(WHITE).width(0.6).opacity(0.7));
    let radius = ring_radius(drawing, &rows);
    drawing.rings(view.pairs.iter().skip(1).map(|p| p.camera), radius, corner_pen());
    drawing.rings(view.pairs.first().map(|p| p.camera), radius, first_pen());
}

/// Of the corners' marks, units: such that neighbours stay apart.
fn ring_radius(drawing: &Drawing, rows: &[Vec<Point2<f64>>]) -> f64 {
    let gaps = rows.iter().flat_map(|row| row.windows(2)).map(|w| (w[1] - w[0]).norm());
    let nearest = gaps.filter(|g| g.is_finite()).fold(f64::INFINITY, f64::min);
    RING.min(RING_SHARE * nearest / drawing.unit())
}

/// The sheet as a rig expects it, with its bend and the lens's distortion; its corners alone where the camera cannot see it.
pub(crate) fn draw_expected(drawing: &mut Drawing, view: &View, camera: &Camera) {
    let Some(sides) = view.sides_px(camera, SIDE_STEPS) else {
        return draw_outline(drawing, &view.corners_px);
    };
    drawing.outline(&sides.concat(), sheet_pen());
    name_corners(drawing, &sides.map(|side| side[0]));
}

/// An outline TL, TR, BR, BL with its corners named; the name of a corner outside the frame stands where the frame ends.
pub(crate) fn draw_outline(drawing: &mut Drawing, corners: &[Point2<f64>; 4]) {
    drawing.outline(corners, sheet_pen());
    name_corners(drawing, corners);
}

fn name_corners(drawing: &mut Drawing, corners: &[Point2<f64>; 4]) {
    drawing.keep_clear(corners);
    let unit = drawing.unit();
    let room = drawing.frame().grown(-NAME_DISTANCE * unit);
    let centre = Point2::from(corners.iter().map(|c| c.coords).sum::<Vector2<f64>>() / 4.0);
    for (corner, name) in corners.iter().zip(["TL", "TR", "BR", "BL"]) {
        let Some(outwards) = (corner - centre).try_normalize(0.0) else { continue };
        let step = outwards * (NAME_DISTANCE * unit);
        let outside = corner + step;
        // Beside the paper when there is room, else upon it.
        let at = if room.holds(outside) { outside } else { corner - step };
        let at = if drawing.frame().holds(*corner) { at } else { room.nearest(at) };
        drawing.label(at, name, 1.0, Anchor::Middle, SKY);
    }
}
