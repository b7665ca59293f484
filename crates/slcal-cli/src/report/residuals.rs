//! Residuals: over the image, in units of their noise, and view by view.

use maud::{Markup, html};
use slcal_core::{PointResidual, Rig, ViewResiduals};

use super::number::{field, fixed, significant};
use super::page::Section;
use super::plot::{Axis, Bars, Colour, Crosses, Curve, Key, Plot, ScaleBar, Strips, Vectors};
use super::rig_page::{RigPage, photo_name};
use crate::picture::vector_scale::{self, round_down};

/// More arrows than this hide each other.
const MAX_ARROWS: usize = 1500;
/// Length at which a long residual is drawn, as a share of the image's width.
const ARROW_SHARE: f64 = 0.05;
/// Bars of the histogram: their width and reach in σ.
const BAR: f64 = 0.25;
const REACH: f64 = 5.0;

pub(super) fn section(page: &RigPage) -> Option<Section> {
    let rig = page.rig;
    if rig.views.is_empty() {
        return None;
    }
    let pairs = page.pairs_word();
    let content = html! {
        p {
            "A residual is the difference between the measured and the predicted position of a point. Small residuals mean that the \
             model fits. They do not tell how good the calibration is; the ± do."
        }
        @match &page.residuals {
            Ok(views) => div.pair { (over_image(rig, views, pairs)) (distribution(views)) },
            Err(why) => p.note { "Plots of the residuals are not shown: " (why) "." },
        }
        (table(rig, page.residuals.as_ref().ok(), pairs))
    };
    Some(Section { id: "residuals", title: "Residuals", content })
}

/// Arrows over the image, enlarged by a round factor.
fn over_image(rig: &Rig, views: &[ViewResiduals], pairs: &'static str) -> Markup {
    let [w, h] = rig.camera.model.size().map(f64::from);
    let kept = views.iter().flat_map(ViewResiduals::points).filter(|p| p.kept);
    let scale = vector_scale::factor(kept.map(|p| p.vector_px().norm()), ARROW_SHARE * w);
    let mut plot = Plot::new(Axis::even("column, px", [0.0, w]), Axis::even("row, px", [h, -0.1 * h]))
        .with_equal_units();
    for kind in [Kind::Side, Kind::Corner] {
        plot = arrows(plot, rig, views, (kind, pairs), scale);
    }
    // Their arrows would cover everything else.
    let left_out: Vec<_> = views.iter().flat_map(ViewResiduals::points).filter(|p| !p.kept).collect();
    if !left_out.is_empty() {
        let name = "outliers, left out";
        let at = thinned(&left_out).map(|p| [p.seen.x, p.seen.y]).collect();
        plot = plot.named(name, Key::Cross, Colour::Ink, Crosses { at, name: name.to_owned() });
    }
    // The scale's bar stands above the image.
    let bar = round_down(0.12 * w / scale);
    let words = format!("{} px", significant(bar, 2));
    let plot = plot.with(Colour::Ink, ScaleBar { from: [0.0, -0.05 * h], length: bar * scale, words });
    let alt = format!("Residuals over the image of the camera, enlarged {scale} times.");
    html! {
        figure {
            (plot.markup("residuals-image", &alt))
            figcaption {
                "From the measured to the predicted position" @if scale > 1.0 { ", enlarged " (significant(scale, 2)) " times" } ". They should point in \
                 random directions. A pattern means that the model is incomplete: a bent sheet, or unmodelled lens distortion."
            }
        }
    }
}

/// What was measured.
#[derive(Debug, Clone, Copy)]
enum Kind {
    Side,
    Corner,
}

impl Kind {
    /// `pairs` is what those of the pattern are called.
    fn name_and_colour(self, pairs: &'static str) -> (&'static str, Colour) {
        match self {
            Self::Side => ("sides of the sheet", Colour::Sheet),
            Self::Corner => (pairs, Colour::Projector),
        }
    }

    fn of(self, view: &ViewResiduals) -> Vec<&PointResidual> {
        let all: Vec<_> = match self {
            Self::Side => view.sheet.iter().collect(),
            Self::Corner => view.pairs.iter().map(|p| &p.camera).collect(),
        };
        all.into_iter().filter(|p| p.kept).collect()
    }
}

/// The residuals of a kind that were used, a group per photograph, so that the pointer can name it.
fn arrows(
    mut plot: Plot,
    rig: &Rig,
    views: &[ViewResiduals],
    (kind, pairs): (Kind, &'static str),
    scale: f64,
) -> Plot {
    let (name, colour) = kind.name_and_colour(pairs);
    let all: usize = views.iter().map(|v| kind.of(v).len()).sum();
    let step = all.div_ceil(MAX_ARROWS).max(1);
    let mut named = false;
    for (i, view) in views.iter().enumerate() {
        let points = kind.of(view);
        let finite = points.iter().filter(|p| p.vector_px().iter().all(|c| c.is_finite()));
        let from_to: Vec<_> = finite
            .step_by(step)
            .map(|p| [p.seen, p.seen + p.vector_px() * scale].map(|p| [p.x, p.y]))
            .collect();
        if from_to.is_empty() {
            continue;
        }
        let vectors = Vectors { from_to, name: format!("{}: {name}", photo_name(rig, i)) };
        plot =
            if named { plot.with(colour, vectors) } else { plot.named(name, Key::Vector, colour, vectors) };
        named = true;
    }
    plot
}

fn thinned<'a>(points: &'a [&PointResidual]) -> impl Iterator<Item = &'a PointResidual> {
    points.iter().copied().step_by(points.len().div_ceil(MAX_ARROWS).max(1))
}

/// The residuals in units of their noise, and the normal distribution.
fn distribution(views: &[ViewResiduals]) -> Markup {
    let mut all = Vec::new();
    for view in views {
        // Corners that were given move in both directions, points of a side only across it.
        let given = view.sheet.len() == 4;
        all.extend(view.sheet.iter().flat_map(|p| if given { components(p) } else { [across(p), f64::NAN] }));
        all.extend(view.pairs.iter().flat_map(|p| components(&p.camera)));
    }
    all.retain(|x| x.is_finite());
    let bars = (2.0 * REACH / BAR) as usize;
    let mut counts = vec![0usize; bars];
    for x in &all {
        let bar = ((x + REACH) / BAR).floor().clamp(0.0, (bars - 1) as f64);
        counts[bar as usize] += 1;
    }
    let beyond = all.iter().filter(|x| x.abs() > REACH).count();
    let normal = |x: f64| all.len() as f64 * BAR * (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt();
    let highest = counts.iter().max().map_or(0.0, |n| *n as f64).max(normal(0.0));
    let curve =
        (0..=100).map(|i| -REACH + f64::from(i) * REACH / 50.0).map(|x| Some([x, normal(x)])).collect();
    let bars: Vec<(f64, usize)> =
        counts.into_iter().enumerate().map(|(i, n)| (-REACH + (i as f64 + 0.5) * BAR, n)).collect();
    let words =
        |(x, n): &(f64, usize)| (*x, format!("{n} at {} σ, {} expected", fixed(*x, 2), fixed(normal(*x), 0)));
    let strips = bars.iter().map(words).collect();
    let plot = Plot::new(
        Axis::even("residual / σ of its noise", [-REACH, REACH]),
        Axis::from_zero("measurements", highest),
    )
    .named("measured", Key::Bar, Colour::Cloud, Bars { width: BAR, bars })
    .named("normal distribution", Key::Line, Colour::Ink, Curve { points: curve, dashed: false })
    .with(Colour::Ink, Strips { width: BAR, strips });
    let alt = format!(
        "Distribution of {} residuals in units of their noise, with the normal distribution.",
        all.len()
    );
    html! {
        figure {
            (plot.markup("residuals-distribution", &alt))
            figcaption {
                (all.len()) " residuals in units of their noise. Bars that follow the normal curve mean that the residuals are noise. A wider \
                 distribution means that the model is incomplete; a narrower one, that there was less noise than assumed."
                @if beyond > 0 { " " (beyond) " residuals beyond 5 σ are in the outer bars." }
            }
        }
    }
}

fn components(p: &PointResidual) -> [f64; 2] {
    let v = p.vector_px() / p.sigma_px;
    [v.x, v.y]
}

/// The distance from a side, its sign that of the larger component.
fn across(p: &PointResidual) -> f64 {
    let v = p.vector_px();
    let larger = if v.x.abs() > v.y.abs() { v.x } else { v.y };
    v.norm().copysign(larger) / p.sigma_px
}

/// The rms residuals of each view, and whether one fits worse than the others.
fn table(rig: &Rig, views: Option<&Vec<ViewResiduals>>, pairs: &str) -> Markup {
    if rig.views.iter().all(|v| v.rms_px.is_none()) {
        return html! { p.note { "The rig does not state the residuals of its photographs." } };
    }
    let number = |path: String, x: Option<f64>| html! { @match x { Some(x) => (field(&path, x, &significant(x, 2))), None => "–" } };
    html! {
        h3 { "Rms residuals, px" }
        div.scroll { table {
            thead { tr {
                th scope="col" { "Photograph" }
                th.number scope="col" { "sheet edges" } th.number scope="col" { (pairs) } th.number scope="col" { "on the projector" }
                @if views.is_some() { th.number scope="col" { "outliers" } }
            } }
            tbody { @for (i, view) in rig.views.iter().enumerate() {
                @let own = views.and_then(|v| v.get(i));
                @let odd = own.is_some_and(ViewResiduals::is_odd);
                tr.odd[odd] {
                    th scope="row" {
                        span.file { (photo_name(rig, i)) }
                        @if odd { " " span.flag { "⚠ " (odd_words(own)) } }
                    }
                    td.number { (number(format!("views.{i}.rms_px.edges"), view.rms_px.map(|r| r.edges))) }
                    td.number { (number(format!("views.{i}.rms_px.corners"), view.rms_px.and_then(|r| r.corners))) }
                    td.number { (number(format!("views.{i}.rms_px.projector"), view.rms_px.and_then(|r| r.projector))) }
                    @if views.is_some() { td.number { (own.map_or_else(String::new, left_out)) } }
                }
            } }
        } }
    }
}

/// How a photograph that fits badly compares with the others.
pub(super) fn odd_words(view: Option<&ViewResiduals>) -> String {
    let times = view.and_then(|v| v.times_others).unwrap_or_default();
    format!("fits {} times worse than the others: another sheet, a bent sheet, blur?", significant(times, 2))
}

fn left_out(view: &ViewResiduals) -> String {
    format!("{} of {}", view.points().filter(|p| !p.kept).count(), view.points().count())
}
