//! Decoded stripes as curves over the dimmed photograph.

use std::collections::BTreeMap;

use nalgebra::Point2;
use slcal_core::decode::{DecodeReport, Decoding};
use slcal_core::{PointCloud, Reconstruction};

use super::drawing::color::{Color, WHITE, ramp, slit_color};
use super::drawing::legend::{Legend, Swatch};
use super::drawing::{Anchor, Drawing, Pen};
use crate::name::short;
use crate::quantile::Sorted;

/// Points of one slit are joined over at most this many scanlines, so that small gaps close and larger ones show.
const JOINED_LINES: i64 = 3;
/// Points are joined up to this ratio of their distances across and along the stripe; steeper pairs belong to two curves.
const JOINED_LEAN: f64 = 2.0;
/// A curve is at least this wide, px: thinner ones fade.
const MIN_CURVE_WIDTH_PX: f64 = 1.2;
/// Number of colours of the ramp.
const SHADES: u16 = 64;
/// Share of the points at either end that the ramp leaves out, so that outliers do not use up its colours.
const STRAY_SHARE: f64 = 0.02;
/// Least distance between numbers of slits, units.
const NUMBERS_APART: f64 = 60.0;
/// Least length of a curve with a number, units.
const NUMBERED_LENGTH: f64 = 30.0;

/// The matches of a photograph called `name`, a colour per slit, with a legend.
pub(crate) fn decoded(size: [u32; 2], name: &str, decoding: &Decoding) -> Drawing {
    let name = short(name);
    let mut drawing = dimmed(size, format!("{name}: decoded stripes"));
    let points: Vec<_> = decoding
        .matches
        .items
        .iter()
        .map(|m| {
            let slit = m.slit.unwrap_or(0);
            Mark { at: m.camera, slit, color: slit_color(slit) }
        })
        .collect();
    let curves = draw_curves(&mut drawing, &points);
    number(&mut drawing, &curves);
    let title = format!("{name}: {}", counted(&decoding.report));
    let colors = (0..6).map(slit_color).collect();
    let mut legend = Legend::new(title)
        .entry(Swatch::Colors(colors), "stripes, one colour per slit; some with the slit's number");
    if let Some(why) = rejected(&decoding.report) {
        legend = legend.note(why);
    }
    drawing.legend = Some(legend);
    drawing
}

/// The points of a cloud in their photograph called `name`, coloured by their distance from the camera, with a legend.
pub(crate) fn reconstructed(size: [u32; 2], name: &str, result: &Reconstruction) -> Drawing {
    let (name, cloud) = (short(name), &result.cloud);
    let mut drawing = dimmed(size, format!("{name}: reconstructed points"));
    let [near, far] = reach_mm(cloud);
    let shade = |d: f64| {
        let share = if far > near { (d - near) / (far - near) } else { 0.5 };
        (share.clamp(0.0, 1.0) * f64::from(SHADES - 1)).round() / f64::from(SHADES - 1)
    };
    // Near is light.
    let color = |d: f64| ramp(1.0 - shade(d));
    let points: Vec<_> = cloud
        .points
        .iter()
        .zip(cloud.distances_mm())
        .map(|(p, d)| Mark { at: p.pixel, slit: p.slit.unwrap_or(0), color: color(d) })
        .collect();
    draw_curves(&mut drawing, &points);
    let mut legend = Legend::new(format!("{name}: {} points", thousands(cloud.points.len())));
    if !points.is_empty() {
        let decimals = usize::from(far - near < 10.0);
        legend =
            legend.entry(Swatch::Ramp, format!("{far:.decimals$} … {near:.decimals$} mm from the camera"));
    }
    if let Some(report) = result.decode() {
        legend = legend.note(counted(report));
    }
    drawing.legend = Some(legend);
    drawing
}

fn dimmed(size: [u32; 2], title: String) -> Drawing {
    let mut drawing = Drawing::new(size, title);
    drawing.dimmed = true;
    drawing
}

fn counted(report: &DecodeReport) -> String {
    format!(
        "{} of {} stripe crossings decoded, {} slits",
        thousands(report.decoded),
        thousands(report.crossings),
        report.slits
    )
}

/// The rejected crossings by reason; `None` when there are none.
fn rejected(report: &DecodeReport) -> Option<String> {
    let parts: Vec<_> = report
        .rejected
        .reasons()
        .into_iter()
        .filter(|(_, count)| *count > 0)
        .map(|(reason, count)| format!("{reason} {}", thousands(count)))
        .collect();
    (!parts.is_empty()).then(|| format!("rejected: {}", parts.join(", ")))
}

/// A count with thousands separators.
pub(crate) fn thousands(n: usize) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// The range of distances from the camera without outliers, which the colours of [`reconstructed`] span.
pub(crate) fn reach_mm(cloud: &PointCloud) -> [f64; 2] {
    Sorted::new(cloud.distances_mm()).range([STRAY_SHARE, 1.0 - STRAY_SHARE])
}

/// A point of a stripe.
#[derive(Debug, Clone, Copy)]
struct Mark {
    at: Point2<f64>,
    slit: u16,
    color: Color,
}

/// Points of one slit and one colour that follow each other.
#[derive(Debug, Clone)]
struct Curve {
    slit: u16,
    color: Color,
    points: Vec<Point2<f64>>,
}

/// Draws the stripes as thin curves; a point without neighbours on its stripe is a dot. Gives the curves.
fn draw_curves(drawing: &mut Drawing, marks: &[Mark]) -> Vec<Curve> {
    let curves = curves(marks);
    let width = (MIN_CURVE_WIDTH_PX / drawing.unit()).max(1.0);
    let mut by_color: BTreeMap<Color, Vec<&[Point2<f64>]>> = BTreeMap::new();
    for curve in &curves {
        by_color.entry(curve.color).or_default().push(&curve.points);
    }
    for (color, all) in by_color {
        let pen = Pen::new(color).width(width).plain();
        let (alone, lines): (Vec<_>, Vec<_>) = all.into_iter().partition(|points| points.len() == 1);
        drawing.lines(lines, pen);
        drawing.dots(alone.into_iter().flatten().copied(), 0.6 * width, pen);
    }
    curves
}

/// Joins the points of each slit along the lines of the photograph that the decoder read.
fn curves(marks: &[Mark]) -> Vec<Curve> {
    let marks: Vec<_> = marks.iter().filter(|m| m.at.x.is_finite() && m.at.y.is_finite()).collect();
    // Whichever coordinate is whole counts the lines.
    let whole = |axis: usize| marks.iter().filter(|m| m.at[axis].fract() == 0.0).count();
    let along = usize::from(whole(1) >= whole(0));
    let mut by_place: BTreeMap<(u16, i64), Vec<usize>> = BTreeMap::new();
    for (i, m) in marks.iter().enumerate() {
        by_place.entry((m.slit, m.at[along].round() as i64)).or_default().push(i);
    }
    let mut curves: Vec<Curve> = Vec::new();
    // The curve that ends in a point, so far.
    let mut ends: Vec<Option<usize>> = vec![None; marks.len()];
    for ((slit, line), here) in &by_place {
        for &i in here {
            let (p, color) = (marks[i].at, marks[i].color);
            let next = (1..=JOINED_LINES).find_map(|step| {
                let there = by_place.get(&(*slit, line + step))?;
                let lean = |j: &usize| (marks[*j].at[1 - along] - p[1 - along]).abs() / step as f64;
                let near = there.iter().filter(|j| lean(j) <= JOINED_LEAN);
                near.min_by(|a, b| lean(a).total_cmp(&lean(b))).copied()
            });
            // A curve goes on in one colour.
            let own = ends[i].filter(|c| curves[*c].color == color);
            let Some(next) = next else {
                if ends[i].is_none() {
                    curves.push(Curve { slit: *slit, color, points: vec![p] });
                }
                continue;
            };
            let curve = own.unwrap_or_else(|| {
                curves.push(Curve { slit: *slit, color, points: vec![p] });
                curves.len() - 1
            });
            curves[curve].points.push(marks[next].at);
            ends[next] = Some(curve);
        }
    }
    curves
}

/// Writes the number of a slit beside the middle of its longest curve, where the numbers do not crowd.
fn number(drawing: &mut Drawing, curves: &[Curve]) {
    let unit = drawing.unit();
    let length = |c: &Curve| c.points.first().zip(c.points.last()).map_or(0.0, |(a, b)| (b - a).norm());
    let mut longest: BTreeMap<u16, &Curve> = BTreeMap::new();
    for curve in curves.iter().filter(|c| length(c) >= NUMBERED_LENGTH * unit) {
        let best = longest.entry(curve.slit).or_insert(curve);
        if length(curve) > length(best) {
            *best = curve;
        }
    }
    let room = drawing.frame().grown(-12.0 * unit);
    let mut taken: Vec<Point2<f64>> = Vec::new();
    for (slit, curve) in longest {
        let at = curve.points[curve.points.len() / 2];
        if room.holds(at) && taken.iter().all(|t| (t - at).norm() > NUMBERS_APART * unit) {
            taken.push(at);
            drawing.label(at, slit.to_string(), 0.8, Anchor::Middle, WHITE);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two slits a row apart from each other in every line but some, and a point alone.
    fn marks(turned: bool) -> Vec<Mark> {
        let curve = |u: f64, slit: u16| {
            let lines = (0..40).filter(|l| *l != 8 && !(20..30).contains(l));
            lines.map(move |l| (u + 0.25 * f64::from(l), f64::from(l), slit))
        };
        let all = curve(10.2, 3).chain(curve(20.2, 4)).chain([(35.3, 5.0, 9), (f64::NAN, 7.0, 3)]);
        all.map(|(u, v, slit)| {
            let at = if turned { Point2::new(v, u) } else { Point2::new(u, v) };
            Mark { at, slit, color: slit_color(slit) }
        })
        .collect()
    }

    #[test]
    fn points_of_one_slit_become_a_curve_whichever_way_the_lines_run() {
        let (upright, turned) = (curves(&marks(false)), curves(&marks(true)));
        // A gap of one line closes, one of ten shows.
        let ends: Vec<_> = upright.iter().map(|c| (c.slit, c.points[0].y, c.points.len())).collect();
        assert_eq!(ends, [(3, 0.0, 19), (3, 30.0, 10), (4, 0.0, 19), (4, 30.0, 10), (9, 5.0, 1)]);
        for (a, b) in upright.iter().zip(&turned) {
            assert!(a.points.iter().zip(&b.points).all(|(p, q)| p.x == q.y && p.y == q.x));
        }
        assert_eq!(upright.len(), turned.len());
    }

    #[test]
    fn a_curve_changes_its_colour_without_a_gap() {
        let mark = |v: u16| Mark { at: Point2::new(3.3, f64::from(v)), slit: 1, color: [(v / 5) as u8; 3] };
        let marks: Vec<_> = (0..10).map(mark).collect();
        let curves = curves(&marks);
        assert_eq!(curves.len(), 2);
        assert_eq!(curves[0].points.last(), curves[1].points.first());
        assert_eq!((curves[0].points.len(), curves[1].points.len()), (6, 5));
    }

    #[test]
    fn thousands_are_set_off() {
        assert_eq!([0, 999, 1000, 1_234_567].map(thousands), ["0", "999", "1,000", "1,234,567"]);
    }
}
