//! How far the sheet bends in each photograph: a figure with exaggerated heights.

use std::fmt::Write as _;

use maud::{Markup, PreEscaped, html};
use nalgebra::Point2;
use slcal_core::geometry::{RectangleSize, SheetBend};
use slcal_core::{Rig, Sag, View};

use super::number::{decimals_of, derived, field, fixed, significant};
use super::page::Section;
use super::rig_page::{RigPage, photo_name};
use crate::picture::push_lines;
use crate::picture::vector_scale::round_down;

/// Width of the figure, in units of which a letter of the page is about 16 high.
const WIDTH: f64 = 420.0;
/// Width of the drawn sheet, and how far its top side is moved to the right and up, in lengths of the left side.
const SHEET: f64 = 260.0;
const RIGHT: f64 = 0.35;
const UP: f64 = 0.45;
/// The largest bend is drawn at most this high.
const HEIGHT: f64 = 100.0;
/// Cells along the longer side of the grid.
const CELLS: usize = 18;
/// Shades on each side of the mean plane.
const SHADES: f64 = 4.0;
/// Around the drawing.
const MARGIN: f64 = 26.0;

pub(super) fn section(page: &RigPage) -> Option<Section> {
    let rig = page.rig;
    let bends: Vec<(usize, &View, Sag)> =
        rig.views.iter().enumerate().filter_map(|(i, view)| Some((i, view, rig.sag(i)?))).collect();
    if bends.is_empty() {
        return None;
    }
    // One scale for all, so that they can be compared.
    let widest = |(_, view, sag): &(usize, &View, Sag)| sag.sag_mm.max(2.0 * sag.sigma_mm) * unit(view.size);
    let scale = round_down(HEIGHT / bends.iter().map(widest).fold(0.0, f64::max));
    let content = html! {
        p {
            "Sheets are not flat. How far the sheet bends in each photograph is estimated together with the devices, and every ± on this \
             page contains it. The figures show the sheet lying on its back, its top side behind; up is towards the camera. Heights are \
             drawn " (derived("bend_exaggeration", scale, &scale.to_string())) " times larger than widths."
        }
        div.photos.bends { @for (i, view, sag) in &bends { (figure(rig, *i, view, sag, scale)) } }
    };
    Some(Section { id: "sheet", title: "How the sheet bends", content })
}

/// Units of the figure in a millimetre of the sheet.
fn unit(size: RectangleSize) -> f64 {
    SHEET / size.width_mm.max(size.height_mm)
}

fn figure(rig: &Rig, i: usize, view: &View, sag: &Sag, scale: f64) -> Markup {
    let path = format!("views.{i}.bend.sag_mm");
    let sigma = format!("views.{i}.bend_sigma_mm");
    let place = |at: Point2<f64>| view.size.place_in_words(at);
    html! {
        figure {
            (PreEscaped(svg(view, sag, scale)))
            figcaption {
                strong.file { (photo_name(rig, i)) }
                ": " (field(&path, sag.sag_mm, &fixed(sag.sag_mm, decimals_of(sag.sigma_mm)))) " ± "
                (derived(&sigma, sag.sigma_mm, &significant(sag.sigma_mm, 2))) " mm from valley to peak"
                @if sag.is_known() {
                    "; nearest to the camera: " (place(sag.peak)) ", furthest from it: " (place(sag.valley))
                } @else { ", not to be told from a flat one" }
                "."
            }
        }
    }
}

/// A point of the figure.
type Spot = [f64; 2];

/// Where a point over the sheet is drawn.
struct Projection {
    size: RectangleSize,
    shape: SheetBend,
    scale: f64,
}

impl Projection {
    /// A point of the sheet, mm, at a height towards the camera, mm.
    fn at(&self, p: Point2<f64>, towards_mm: f64) -> Spot {
        let unit = unit(self.size);
        let behind = (self.size.height_mm - p.y) * unit;
        [p.x * unit + RIGHT * behind, -UP * behind - self.scale * unit * towards_mm]
    }

    /// Height of the sheet towards the camera, mm.
    fn height(&self, p: Point2<f64>) -> f64 {
        -self.shape.point(self.size, p).z
    }

    fn on_sheet(&self, p: Point2<f64>) -> Spot {
        self.at(p, self.height(p))
    }
}

/// Writing into a string cannot fail.
fn put(text: &mut String, what: std::fmt::Arguments<'_>) {
    let _ = text.write_fmt(what);
}

fn path(points: &[Spot]) -> String {
    let mut text = String::new();
    push_lines(&mut text, points.iter().copied());
    text
}

fn svg(view: &View, sag: &Sag, scale: f64) -> String {
    let shape = view.bend.map_or(SheetBend::FLAT, |b| b.shape);
    let to = Projection { size: view.size, shape, scale };
    let corners = view.size.corners();
    let mean: Vec<Spot> = corners.iter().map(|c| to.at(*c, 0.0)).collect();
    let (cells, mut spots) = surface(&to, sag);
    spots.extend(&mean);
    let extreme = |k: usize| {
        spots.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], s| [l.min(s[k]), h.max(s[k])])
    };
    let ([left, right], [top, bottom]) = (extreme(0), extreme(1));
    let x0 = (left + right - WIDTH) / 2.0;
    let (y0, height) = (top - MARGIN, bottom - top + 2.0 * MARGIN);
    let words = format!(
        "The bent sheet: {:.2} mm from valley to peak, heights drawn {scale} times larger",
        sag.sag_mm
    );
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"bend\" viewBox=\"{x0:.1} {y0:.1} {WIDTH} {height:.1}\" role=\"img\" \
         aria-label=\"{words}\"><title>{words}</title>"
    );
    text.push_str(&cells);
    put(&mut text, format_args!("<path class=\"mean\" d=\"{}Z\"/>", path(&mean)));
    // The names of the corners stand outside the sheet.
    for ((corner, name), (dx, anchor)) in corners.iter().zip(["TL", "TR", "BR", "BL"]).zip([
        (-6.0, "end"),
        (6.0, "start"),
        (6.0, "start"),
        (-6.0, "end"),
    ]) {
        let [x, y] = to.on_sheet(*corner);
        put(
            &mut text,
            format_args!(
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{name}</text>",
                x + dx,
                y + 5.0
            ),
        );
    }
    if sag.is_known() {
        let spots = [sag.peak, sag.valley].map(|p| to.on_sheet(p));
        // The upper one has its label above, so that neither covers the other.
        let peak_above = spots[0][1] <= spots[1][1];
        for (i, (at, sign)) in [(sag.peak, "+"), (sag.valley, "\u{2212}")].into_iter().enumerate() {
            let [x, y] = spots[i];
            let dy = if (i == 0) == peak_above { -8.0 } else { 19.0 };
            put(
                &mut text,
                format_args!(
                    "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\"/><text class=\"mm\" x=\"{x:.1}\" y=\"{:.1}\" \
                     text-anchor=\"middle\">{sign}{:.2} mm</text>",
                    y + dy,
                    to.height(at).abs()
                ),
            );
        }
    }
    bar(&mut text, &to, [x0 + 8.0, top]);
    text.push_str("</svg>");
    text
}

/// The sheet's cells from back to front, shaded by height, and their corners.
fn surface(to: &Projection, sag: &Sag) -> (String, Vec<Spot>) {
    let size = to.size;
    let longer = size.width_mm.max(size.height_mm);
    let count = |length: f64| ((CELLS as f64 * length / longer).round() as usize).max(2);
    let (columns, rows) = (count(size.width_mm), count(size.height_mm));
    let at = |i: usize, j: usize| {
        Point2::new(size.width_mm * i as f64 / columns as f64, size.height_mm * j as f64 / rows as f64)
    };
    let highest = [sag.peak, sag.valley].map(|p| to.height(p).abs()).into_iter().fold(0.0, f64::max);
    let mut spots = Vec::new();
    let mut text = String::new();
    for j in 0..rows {
        for i in 0..columns {
            let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            let mean = corners.iter().map(|c| to.height(*c)).sum::<f64>() / 4.0;
            let shade = (SHADES * mean.abs() / highest.max(f64::MIN_POSITIVE)).round().min(SHADES);
            let side = if mean > 0.0 { "near" } else { "far" };
            let drawn = corners.map(|c| to.on_sheet(c));
            put(&mut text, format_args!("<path class=\"{side}{shade:.0}\" d=\"{}Z\"/>", path(&drawn)));
            spots.extend(drawn);
        }
    }
    (text, spots)
}

/// The scale of heights: an upright bar with its length, beside the top side.
fn bar(text: &mut String, to: &Projection, [x, top]: Spot) {
    let per_mm = to.scale * unit(to.size);
    let length = round_down(0.6 * HEIGHT / per_mm);
    let end = top + length * per_mm;
    let [left, right, beside, middle] = [x - 4.0, x + 4.0, x + 8.0, f64::midpoint(top, end) + 5.0];
    put(
        text,
        format_args!(
            "<path class=\"bar\" d=\"M{left:.1} {top:.1}H{right:.1}M{x:.1} {top:.1}V{end:.1}M{left:.1} {end:.1}H{right:.1}\"/>\
             <text x=\"{beside:.1}\" y=\"{middle:.1}\">{} mm</text>",
            significant(length, 1)
        ),
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_towards_the_camera() {
        let size = RectangleSize::new(594.0, 420.0).unwrap();
        let mut shape = SheetBend::FLAT;
        shape.0[0] = 2.0;
        let to = Projection { size, shape, scale: 50.0 };
        // The ends lie away from the camera, below the mean plane.
        let (end, middle) = (Point2::new(0.0, 210.0), Point2::new(297.0, 210.0));
        assert!(to.on_sheet(end)[1] > to.at(end, 0.0)[1] && to.on_sheet(middle)[1] < to.at(middle, 0.0)[1]);
    }
}
