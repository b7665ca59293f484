//! How well a photograph fits the rig that was calibrated from it: residuals, magnified, upon what was found.

use nalgebra::{Point2, Vector2};
use slcal_core::geometry::ProjectivePoint;
use slcal_core::{PointResidual, View, ViewObservation, ViewResiduals};

use super::color::{GREEN, PINK, VERMILLION};
use super::drawing::{Anchor, Drawing, Pen};
use super::legend::{Legend, Swatch};
use super::{magnify, sheet, short};

/// Half the size of an outlier's cross, units.
const CROSS: f64 = 4.5;
/// A vanishing point is near, and drawn, within this many sizes of the image from its frame: beyond it its pencil looks
/// parallel.
const NEAR: f64 = 1.0;

/// A view and what a rig makes of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fit<'a> {
    pub(crate) observed: &'a ViewObservation,
    pub(crate) residuals: &'a ViewResiduals,
    pub(crate) view: &'a View,
}

fn arrow_pen() -> Pen {
    Pen::new(GREEN).width(1.2)
}
fn outlier_pen() -> Pen {
    Pen::new(VERMILLION).width(1.6)
}
fn pencil_pen() -> Pen {
    Pen::new(PINK).width(0.9).dashed()
}

impl Fit<'_> {
    fn points(&self) -> impl Iterator<Item = &PointResidual> {
        self.residuals.sheet.iter().chain(self.residuals.pairs.iter().map(|p| &p.camera))
    }

    fn outliers(&self) -> usize {
        self.points().filter(|p| !p.kept).count()
    }

    /// The residuals in words, by their root mean squares; empty when the rig does not state them.
    pub(crate) fn in_words(&self) -> String {
        let Some(rms) = self.view.rms_px else { return String::new() };
        let corners = rms.corners.map_or(String::new(), |c| format!(", corners {}", pixels(c)));
        format!("sides {}{corners} (rms)", pixels(rms.edges))
    }

    /// How this view compares with the others, when it does badly.
    pub(crate) fn odd_in_words(&self) -> Option<String> {
        let times = self.residuals.times_others.filter(|_| self.residuals.is_odd())?;
        Some(format!("fits {times:.1} times worse than the others"))
    }
}

/// A length with two digits, px.
fn pixels(x: f64) -> String {
    let decimals = if x > 0.0 { (1.0 - x.log10().floor()).clamp(0.0, 6.0) as usize } else { 0 };
    format!("{x:.decimals$} px")
}

/// By how much residuals are lengthened in the pictures of some views, so that they can be compared.
pub(crate) fn magnification<'a>(fits: impl IntoIterator<Item = Fit<'a>>, unit: f64) -> f64 {
    let mut lengths = Vec::new();
    for fit in fits {
        lengths.extend(fit.points().filter(|p| p.kept).map(|p| p.vector_px().norm()));
    }
    magnify::factor(lengths, unit)
}

/// A photograph called `name` with the residuals of the calibration, and a legend whose first line is `title`.
pub(crate) fn calibrated(size: [u32; 2], name: &str, title: &str, fit: Fit<'_>) -> Drawing {
    let mut drawing = Drawing::new(size, format!("{}: residuals of the calibration", short(name)));
    let factor = magnification([fit], drawing.unit());
    draw(&mut drawing, fit, factor);
    drawing.legend = Some(legend(&drawing, title, [fit], factor));
    drawing
}

/// What was found, arrows to where the rig expects it, `factor` times as long as they are, outliers, and vanishing points
/// that are near.
pub(crate) fn draw(drawing: &mut Drawing, fit: Fit<'_>, factor: f64) {
    draw_vanishing_points(drawing, fit.view);
    sheet::draw_sheet(drawing, fit.observed);
    let kept = fit.points().filter(|p| p.kept);
    let arrows: Vec<_> = kept.map(|p| (p.seen, magnify::end(p.seen, p.vector_px(), factor))).collect();
    drawing.arrows(arrows, arrow_pen());
    sheet::draw_marks(drawing, fit.observed);
    let arm = CROSS * drawing.unit();
    let crosses: Vec<_> = fit
        .points()
        .filter(|p| !p.kept)
        .flat_map(|p| [Vector2::new(arm, arm), Vector2::new(arm, -arm)].map(|d| [p.seen - d, p.seen + d]))
        .collect();
    drawing.lines(crosses.iter().map(<[_; 2]>::as_slice), outlier_pen());
}

/// What the marks of [`draw`] mean in one or more views.
pub(crate) fn legend<'a>(
    drawing: &Drawing,
    title: &str,
    fits: impl IntoIterator<Item = Fit<'a>>,
    factor: f64,
) -> Legend {
    let fits: Vec<_> = fits.into_iter().collect();
    let mut legend = sheet::legend(title.to_owned(), fits.iter().map(|f| f.observed));
    let lengthened =
        if factor > 1.0 { format!(", lengthened ×{}", magnify::plain(factor)) } else { String::new() };
    let (bar, length) = magnify::scale(drawing, factor, arrow_pen());
    legend = legend
        .entry(Swatch::Arrow(arrow_pen()), format!("to where the rig expects it{lengthened}"))
        .entry(bar, format!("{length} in the photograph"));
    let outliers: usize = fits.iter().map(Fit::outliers).sum();
    if outliers > 0 {
        let plural = if outliers == 1 { "" } else { "s" };
        let text = format!("{outliers} point{plural} left out, too far off");
        legend = legend.entry(Swatch::Cross(outlier_pen()), text);
    }
    if fits.iter().any(|f| near_points(drawing, f.view).next().is_some()) {
        legend =
            legend.entry(Swatch::Line(pencil_pen()), "to where its parallel sides meet (vanishing point)");
    }
    legend
}

/// The vanishing points that are near, each with the two sides of the sheet that run to it.
fn near_points<'a>(
    drawing: &Drawing,
    view: &'a View,
) -> impl Iterator<Item = (Point2<f64>, [[Point2<f64>; 2]; 2], &'static str)> + 'a {
    let [tl, tr, br, bl] = view.corners_px;
    let points = &view.camera_vanishing_points;
    let frame = drawing.frame();
    let size = frame.high - frame.low;
    let near = move |p: &Point2<f64>| {
        (0..2).all(|k| (frame.low[k] - NEAR * size[k]..=frame.high[k] + NEAR * size[k]).contains(&p[k]))
    };
    [(points.x, [[tl, tr], [bl, br]], "width"), (points.y, [[tl, bl], [tr, br]], "height")]
        .into_iter()
        .filter_map(move |(point, sides, name): (ProjectivePoint, _, _)| {
            Some((point.pixel().filter(near)?, sides, name))
        })
}

fn draw_vanishing_points(drawing: &mut Drawing, view: &View) {
    let near: Vec<_> = near_points(drawing, view).collect();
    for (point, sides, name) in near {
        let from = sides.map(|[a, b]| if (a - point).norm() < (b - point).norm() { a } else { b });
        drawing.lines(from.map(|p| [p, point]).iter().map(<[_; 2]>::as_slice), pencil_pen());
        let text = format!("vanishing point of its {name}");
        let unit = drawing.unit();
        if drawing.frame().holds(point) {
            drawing.rings([point], 6.0, Pen::new(PINK).width(1.6));
            let right = point.x > 0.5 * (drawing.frame().low.x + drawing.frame().high.x);
            let (step, anchor) = if right { (-12.0, Anchor::End) } else { (12.0, Anchor::Start) };
            drawing.label(point + Vector2::new(step * unit, 0.0), text, 0.85, anchor, PINK);
            continue;
        }
        // An arrow where the middle of its pencil leaves the frame.
        let middle = nalgebra::center(&from[0], &from[1]);
        let Some([start, leaves]) = drawing.frame().grown(-2.0 * unit).segment(middle, point) else {
            continue;
        };
        let reach = (leaves - start).norm().min(40.0 * unit);
        let Some(direction) = (leaves - start).try_normalize(0.0) else { continue };
        drawing.arrows([(leaves - direction * reach, leaves)], Pen::new(PINK).width(1.6));
        let room = drawing.frame().grown(-14.0 * unit);
        let anchor = match leaves.x {
            x if x > room.high.x => Anchor::End,
            x if x < room.low.x => Anchor::Start,
            _ => Anchor::Middle,
        };
        let beside =
            if anchor == Anchor::Middle { Vector2::new(0.0, 0.0) } else { Vector2::new(0.0, 14.0 * unit) };
        let back = direction * (if anchor == Anchor::Middle { reach + 10.0 * unit } else { 0.0 });
        drawing.label(room.nearest(leaves - back + beside), text, 0.85, anchor, PINK);
    }
}
