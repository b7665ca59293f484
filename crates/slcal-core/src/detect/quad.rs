//! Search for the sheet among the quadrilaterals formed by straight edges.

use nalgebra::Point2;

use super::edge_map::{EdgeMap, Edgel};
use super::lines::EdgeLine;
use crate::geometry::Line;

/// Four corners, clockwise in the image, in downsampled pixels, and how well edges support them.
#[derive(Debug, Clone)]
pub(super) struct Quad {
    pub(super) corners: [Point2<f64>; 4],
    pub(super) lines: [Line; 4],
    pub(super) score: f64,
}

/// What the quadrilateral must contain.
#[derive(Debug, Clone)]
pub(super) enum Content {
    /// The corners of the projected board, in downsampled pixels: the sheet is the quadrilateral that contains them. Some
    /// may lie beside it.
    Board(Vec<Point2<f64>>),
    /// Nothing is projected: the sheet is the brightest large quadrilateral.
    Anything,
}

/// The result of the search, with counts for the message when there is none.
#[derive(Debug, Clone)]
pub(super) struct Search {
    pub(super) best: Option<Quad>,
    /// Straight edges that were combined.
    pub(super) lines: usize,
    /// Quadrilaterals with edges along all four sides.
    pub(super) quads: usize,
}

/// At least this part of each side, and of all sides on average, must show an edge: a hand or a clip may hide the rest.
const MIN_SIDE_SUPPORT: f64 = 0.35;
const MIN_MEAN_SUPPORT: f64 = 0.6;
/// At least this part of each side must lie inside the frame.
const MIN_VISIBLE: f64 = 0.3;
/// Corners may lie outside the frame by this part of its diagonal.
const MAX_OUTSIDE: f64 = 0.5;
/// Smallest area, as a part of the frame: around a board, and for the brightest quadrilateral.
const MIN_AREA: [f64; 2] = [0.01, 0.04];
/// Neighbouring sides meet at an angle between 15° and 165°.
const MIN_CORNER_SINE: f64 = 0.26;
/// The sheet holds at least this share of the board's corners.
const MIN_HELD: f64 = 0.6;
/// Number of candidates whose interior is evaluated.
const SHORTLIST: usize = 40;
/// Edges are searched for beyond a corner over this part of the side: the sides of a sheet end at its corners.
const OVERSHOOT: f64 = 0.12;
/// Distance from the sides within which edges belong to them, in downsampled pixels.
const SIDE_MARGIN: f64 = 4.0;

/// Finds the sheet. `foreign` is true for edge pixels of the footprint's border and of the board.
pub(super) fn find_sheet(
    map: &EdgeMap<'_>,
    lines: &[EdgeLine],
    content: &Content,
    foreign: impl Fn(&Edgel) -> bool,
) -> Search {
    let mut lines: Vec<&EdgeLine> = lines.iter().filter(|l| holds(&l.line, content)).collect();
    lines.sort_by(|a, b| normal_angle(&a.line).total_cmp(&normal_angle(&b.line)));
    let mut quads = Vec::new();
    let n = lines.len();
    for i in 0..n {
        for j in i + 1..n {
            for k in j + 1..n {
                for l in k + 1..n {
                    quads.extend(combine(map, [lines[i], lines[j], lines[k], lines[l]], content));
                }
            }
        }
    }
    quads.sort_by(|a, b| b.score.total_cmp(&a.score));
    let count = quads.len();
    quads.truncate(SHORTLIST);
    for quad in &mut quads {
        quad.score *= match content {
            Content::Board(corners) => {
                share_inside(&quad.lines, corners).powi(2) * tidiness(map, quad, &foreign)
            }
            Content::Anything => step(map, quad).max(0.0),
        };
    }
    let best = quads.into_iter().filter(|q| q.score > 0.0).max_by(|a, b| a.score.total_cmp(&b.score));
    Search { best, lines: n, quads: count }
}

fn normal_angle(line: &Line) -> f64 {
    line.0.y.atan2(line.0.x)
}

/// Whether the content lies on the bright side of a line.
fn holds(line: &Line, content: &Content) -> bool {
    match content {
        Content::Board(corners) => share_inside(&[*line], corners) >= MIN_HELD,
        Content::Anything => true,
    }
}

/// The share of points on the bright side of all lines.
fn share_inside(lines: &[Line], points: &[Point2<f64>]) -> f64 {
    let inside = points.iter().filter(|p| lines.iter().all(|l| l.signed_distance_px(**p) > 0.0)).count();
    inside as f64 / points.len().max(1) as f64
}

/// The quadrilateral of four lines sorted by the angle of their inward normals, if it is convex, visible and supported.
fn combine(map: &EdgeMap<'_>, sides: [&EdgeLine; 4], content: &Content) -> Option<Quad> {
    let mut corners = [Point2::origin(); 4];
    for i in 0..4 {
        let (a, b) = (sides[i].line, sides[(i + 1) % 4].line);
        // The angle between consecutive normals is below 180°, and large enough for a corner.
        if a.normal().perp(&b.normal()) < MIN_CORNER_SINE {
            return None;
        }
        // Corner i + 1 joins side i and side i + 1.
        corners[(i + 1) % 4] = a.meet(b).pixel()?;
    }
    let (w, h) = (map.width as f64, map.height as f64);
    let reach = MAX_OUTSIDE * map.diagonal();
    for (i, c) in corners.iter().enumerate() {
        let near = c.x > -reach && c.y > -reach && c.x < w + reach && c.y < h + reach;
        let convex = sides[(i + 1) % 4].line.signed_distance_px(*c) > 0.0
            && sides[(i + 2) % 4].line.signed_distance_px(*c) > 0.0;
        if !(near && convex) {
            return None;
        }
    }
    let area = area(&corners) / (w * h);
    let least = MIN_AREA[usize::from(matches!(content, Content::Anything))];
    if area < least {
        return None;
    }
    let mut score = 1.0;
    let mut mean = 0.0;
    for (i, side) in sides.iter().enumerate() {
        let (from, to) = (corners[i], corners[(i + 1) % 4]);
        let seen = clip(from, to, w, h)?;
        if nalgebra::distance(&seen.0, &seen.1) < MIN_VISIBLE * nalgebra::distance(&from, &to) {
            return None;
        }
        let (a, b) = (side.along(seen.0), side.along(seen.1));
        let support = side.support(a, b).min(1.0);
        if support < MIN_SIDE_SUPPORT {
            return None;
        }
        mean += support / 4.0;
        score *= support;
        // An edge that continues beyond a corner lowers the score.
        let (a, b) = (side.along(from), side.along(to));
        let length = OVERSHOOT * (b - a);
        for (end, beyond) in [(b, b + length), (a, a - length)] {
            let p = if end == b { to } else { from };
            let visible = p.x > 0.0 && p.y > 0.0 && p.x < w && p.y < h;
            if visible {
                let gap = 3.0 * (beyond - end).signum();
                score *= 1.0 - 0.5 * side.support(end + gap, beyond + gap).min(1.0);
            }
        }
    }
    if mean < MIN_MEAN_SUPPORT {
        return None;
    }
    if matches!(content, Content::Anything) {
        score *= area.min(1.0).sqrt();
    }
    Some(Quad { corners, lines: sides.map(|s| s.line), score })
}

pub(super) fn area(c: &[Point2<f64>; 4]) -> f64 {
    0.5 * (c[2] - c[0]).perp(&(c[3] - c[1])).abs()
}

/// The part of a segment inside the frame (Liang–Barsky); `None` when there is none.
fn clip(a: Point2<f64>, b: Point2<f64>, w: f64, h: f64) -> Option<(Point2<f64>, Point2<f64>)> {
    let d = b - a;
    let (mut t0, mut t1) = (0.0_f64, 1.0_f64);
    for (p, q) in [(-d.x, a.x), (d.x, w - 1.0 - a.x), (-d.y, a.y), (d.y, h - 1.0 - a.y)] {
        if p == 0.0 {
            if q < 0.0 {
                return None;
            }
        } else if p < 0.0 {
            t0 = t0.max(q / p);
        } else {
            t1 = t1.min(q / p);
        }
    }
    (t0 < t1).then(|| (a + d * t0, a + d * t1))
}

/// How free of other edges the interior is. The sheet is plain apart from the board, while a larger quadrilateral contains
/// the sides of the sheet.
fn tidiness(map: &EdgeMap<'_>, quad: &Quad, foreign: &impl Fn(&Edgel) -> bool) -> f64 {
    let inside = |p: Point2<f64>| quad.lines.iter().all(|l| l.signed_distance_px(p) > SIDE_MARGIN);
    let stray = map.edgels.iter().filter(|e| inside(e.position) && !foreign(e)).count();
    let perimeter: f64 =
        (0..4).map(|i| nalgebra::distance(&quad.corners[i], &quad.corners[(i + 1) % 4])).sum();
    1.0 / (1.0 + 2.0 * stray as f64 / perimeter)
}

/// Mean step of tone across the sides, from outside to inside.
fn step(map: &EdgeMap<'_>, quad: &Quad) -> f64 {
    let (mut sum, mut n) = (0.0, 0.0);
    for i in 0..4 {
        let (a, b) = (quad.corners[i], quad.corners[(i + 1) % 4]);
        let normal = quad.lines[i].normal();
        for k in 1..40 {
            let p = a + (b - a) * (f64::from(k) / 40.0);
            let at = |s: f64| {
                let q = p + normal * s;
                map.tone.bilinear(q.x, q.y)
            };
            if let (Some(inner), Some(outer)) = (at(SIDE_MARGIN), at(-SIDE_MARGIN)) {
                sum += inner - outer;
                n += 1.0;
            }
        }
    }
    if n > 0.0 { sum / n } else { 0.0 }
}
