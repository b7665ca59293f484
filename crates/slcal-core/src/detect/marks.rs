//! The marks at the border of the panel, found where the board predicts them or where the border of the light does.

use nalgebra::{Point2, Vector2};

use super::light_border::LightBorder;
use super::panel_view::PanelView;
use crate::observations::PanelPoint;
use crate::pattern::{CheckerPattern, PanelMarks, SquareColor};

/// Samples over the side of a mark: its hole is half as many wide.
const CELLS: i32 = 16;
/// How far from its expected place a mark is searched for, in samples: as far as it is wide. The second mark beside it is further
/// away.
const REACH: i32 = CELLS;
/// Correlation with the drawn mark from which a mark is one: the corner of a sheet or a shadow reach a half.
const MIN_CORRELATION: f64 = 0.75;
/// Its ring and its hole differ at least by this share of the step between black and white squares.
const MIN_CONTRAST: f64 = 0.3;
/// σ of a mark's middle in samples: the search is as fine.
const SIGMA_CELLS: f64 = 0.25;

/// The marks that are seen, each with the place where the pattern has it: as they were drawn or, in a mirrored picture, at the
/// opposite places.
pub(super) fn find(
    view: &PanelView<'_>,
    pattern: &CheckerPattern,
    borders: &[LightBorder],
) -> Vec<PanelPoint> {
    let (Some(marks), Some([black, white])) = (&pattern.marks, view.levels(pattern)) else {
        return Vec::new();
    };
    let bright_hole = pattern.background == SquareColor::White;
    let search = Search { view, marks, step: white - black, bright_hole };
    // Marks move with the picture. From a description that is not what was shown they may also stay at the border of the panel.
    let mut upright = search.all(|p| p);
    if !borders.is_empty() {
        let at_border = search.all(|p| by_borders(borders, pattern, p));
        if at_border.len() > upright.len() {
            upright = at_border;
        }
    }
    let [w, h] = pattern.projector.map(|n| f64::from(n) - 1.0);
    let flips: [&dyn Fn(Point2<f64>) -> Point2<f64>; 2] =
        [&|p| Point2::new(w - p.x, p.y), &|p| Point2::new(p.x, h - p.y)];
    for flip in flips {
        // The marks that have no counterpart at the opposite place decide.
        let single = |c: &Point2<f64>| {
            !marks.centres_px.iter().any(|other| (flip(*c) - other).norm() < 0.5 * marks.side_px)
        };
        let seen = |points: &[(Point2<f64>, PanelPoint)]| points.iter().filter(|(c, _)| single(c)).count();
        if seen(&upright) == 0 {
            let mirrored = search.all(flip);
            if seen(&mirrored) > 0 {
                upright = mirrored;
                break;
            }
        }
    }
    upright.into_iter().map(|(_, point)| point).collect()
}

/// Where a place on the panel falls in the pattern's pixels by the borders of the light: moved, and scaled where opposite ones are
/// seen.
fn by_borders(borders: &[LightBorder], pattern: &CheckerPattern, p: Point2<f64>) -> Point2<f64> {
    let along = |axis: usize| {
        let mut seen = borders.iter().filter(|b| b.side.axis == axis);
        let place = |b: &LightBorder| (b.side.coordinate(pattern.projector), b.coordinate);
        match (seen.next().map(place), seen.next().map(place)) {
            (Some((from, to)), None) => p[axis] + to - from,
            (Some((from, to)), Some((end, end_to))) => to + (p[axis] - from) * (end_to - to) / (end - from),
            _ => p[axis],
        }
    };
    Point2::new(along(0), along(1))
}

/// The search for marks.
struct Search<'a> {
    view: &'a PanelView<'a>,
    marks: &'a PanelMarks,
    /// Light of white squares less that of black ones.
    step: f64,
    bright_hole: bool,
}

impl Search<'_> {
    /// The middles of the marks that are seen near `place` of where they were drawn.
    fn all(&self, place: impl Fn(Point2<f64>) -> Point2<f64>) -> Vec<(Point2<f64>, PanelPoint)> {
        let cell = self.marks.side_px / f64::from(CELLS);
        let near = |c: &Point2<f64>| {
            let found = self.near(place(*c), cell)?;
            let [x, y] = self.view.scale(found);
            let sigma_px = Some(SIGMA_CELLS * cell * x.max(y));
            let camera = self.view.camera(found)?;
            Some((*c, PanelPoint { camera, expected: [Some(c.x), Some(c.y)], sigma_px }))
        };
        self.marks.centres_px.iter().filter_map(near).collect()
    }

    /// The middle of the mark that is nearest to looking like the drawn one.
    fn near(&self, place: Point2<f64>, cell: f64) -> Option<Point2<f64>> {
        let patch = self.patch(place, cell);
        let shifts = || (-REACH..=REACH).flat_map(|y| (-REACH..=REACH).map(move |x| [x, y]));
        let score = |shift| self.correlation(&patch, shift);
        let scored = shifts().filter_map(|shift| Some((shift, score(shift)?)));
        let (best, most) = scored.reduce(|a, b| if b.1 > a.1 { b } else { a })?;
        if most < MIN_CORRELATION {
            return None;
        }
        // The vertex of the parabola through the neighbours.
        let vertex = |step: [i32; 2]| {
            let beside = |sign: i32| score([best[0] + sign * step[0], best[1] + sign * step[1]]);
            let (Some(before), Some(after)) = (beside(-1), beside(1)) else { return 0.0 };
            let bend = before - 2.0 * most + after;
            if bend < 0.0 { (0.5 * (before - after) / bend).clamp(-0.5, 0.5) } else { 0.0 }
        };
        let offset = Vector2::new(f64::from(best[0]) + vertex([1, 0]), f64::from(best[1]) + vertex([0, 1]));
        Some(place + offset * cell)
    }

    /// The light around a place, row by row; `None` beside the sheet.
    fn patch(&self, place: Point2<f64>, cell: f64) -> Vec<Option<f64>> {
        let at = |k: i32| (f64::from(k) - f64::from(WIDTH - 1) / 2.0) * cell;
        let light = |(x, y): (i32, i32)| self.view.light(place + Vector2::new(at(x), at(y)));
        (0..WIDTH).flat_map(|y| (0..WIDTH).map(move |x| (x, y))).map(light).collect()
    }

    /// Correlation of the patch, shifted, with a mark; `None` where a part is not seen or without contrast.
    fn correlation(&self, patch: &[Option<f64>], [dx, dy]: [i32; 2]) -> Option<f64> {
        let [mut hole, mut ring, mut squares] = [0.0; 3];
        let quarter = CELLS / 4..3 * CELLS / 4;
        for (x, y) in (0..CELLS).flat_map(|y| (0..CELLS).map(move |x| (x, y))) {
            let (column, row) = (REACH + dx + x, REACH + dy + y);
            if !(0..WIDTH).contains(&column) || !(0..WIDTH).contains(&row) {
                return None;
            }
            let light = patch[(row * WIDTH + column) as usize]?;
            *if quarter.contains(&x) && quarter.contains(&y) { &mut hole } else { &mut ring } += light;
            squares += light * light;
        }
        // A quarter of the cells lies in the hole.
        let n = f64::from(CELLS * CELLS);
        let (mean, of_hole, of_ring) = ((hole + ring) / n, hole / (n / 4.0), ring / (3.0 * n / 4.0));
        let contrast = if self.bright_hole { of_hole - of_ring } else { of_ring - of_hole };
        let deviation = (squares / n - mean * mean).max(0.0).sqrt();
        // The drawn mark deviates from its mean by √3/4 of its contrast.
        (contrast > MIN_CONTRAST * self.step).then(|| 3.0_f64.sqrt() / 4.0 * contrast / deviation)
    }
}

/// Samples over the side of the patch that is searched.
const WIDTH: i32 = CELLS + 2 * REACH;
