//! Residuals: over the image, in units of their noise, and view by view.

use maud::{Markup, html};
use serde_json::{Value, json};
use slcal_core::{PointResidual, Rig, ViewResiduals};

use super::figure::{Figures, flat_layout};
use super::number::{field, significant};
use super::page::Section;
use super::rig_page::{RigPage, photo_name};
use crate::picture::vector_scale::{self, round_down};

/// More arrows than this hide each other.
const MAX_ARROWS: usize = 1500;
/// Length at which a long residual is drawn, as a share of the image's width.
const ARROW_SHARE: f64 = 0.05;
/// Bars of the histogram: their width and reach in σ.
const BAR: f64 = 0.25;
const REACH: f64 = 5.0;

pub(super) fn section(page: &RigPage, figures: &mut Figures) -> Option<Section> {
    let rig = page.rig;
    if rig.views.is_empty() {
        return None;
    }
    let content = html! {
        p {
            "A residual is the difference between the measured and the predicted position of a point. Small residuals mean that the \
             model fits. They do not tell how good the calibration is; the ± do."
        }
        @match &page.residuals {
            Ok(views) => div.pair { (over_image(rig, views, figures)) (distribution(views, figures)) },
            Err(why) => p.note { "Plots of the residuals are not shown: " (why) "." },
        }
        (table(rig, page.residuals.as_ref().ok()))
    };
    Some(Section { id: "residuals", title: "Residuals", content })
}

/// Arrows over the image, enlarged by a round factor.
fn over_image(rig: &Rig, views: &[ViewResiduals], figures: &mut Figures) -> Markup {
    let [w, h] = rig.camera.model.size().map(f64::from);
    let sheet = || views.iter().flat_map(|v| &v.sheet);
    let pairs = || views.iter().flat_map(|v| &v.pairs).map(|p| &p.camera);
    let kept = views.iter().flat_map(ViewResiduals::points).filter(|p| p.kept);
    let scale = vector_scale::factor(kept.map(|p| p.vector_px().norm()), ARROW_SHARE * w);
    let bar = round_down(0.12 * w / scale);
    let mut traces = Vec::new();
    let kinds: [(&str, &str, Vec<&PointResidual>); 2] = [
        ("sides of the sheet", "$sheet", sheet().collect()),
        ("projected corners", "$projector", pairs().collect()),
    ];
    for (name, colour, points) in &kinds {
        let kept: Vec<_> = points.iter().copied().filter(|p| p.kept).collect();
        if !kept.is_empty() {
            traces.push(arrows(name, colour, &kept, scale));
        }
    }
    // Their arrows would cover everything else.
    let left_out: Vec<_> = sheet().chain(pairs()).filter(|p| !p.kept).collect();
    if !left_out.is_empty() {
        traces.push(crosses(&left_out));
    }
    // The scale's bar stands above the image.
    let y = -0.06 * h;
    traces.push(json!({
        "type": "scatter", "mode": "lines+text", "x": [0.0, bar * scale], "y": [y, y], "showlegend": false,
        "text": ["", format!(" {} px", significant(bar, 2))], "textposition": "middle right", "hoverinfo": "skip",
        "line": { "color": "$ink", "width": 3 }, "textfont": { "color": "$ink" }, "cliponaxis": false,
    }));
    let mut layout = flat_layout(
        json!({ "title": { "text": "column, px" }, "range": [0.0, w], "constrain": "domain" }),
        json!({ "title": { "text": "row, px" }, "range": [h, -0.1 * h], "scaleanchor": "x", "constrain": "domain" }),
    );
    layout["legend"]["y"] = json!(1.0);
    let alt = format!("Residuals over the image of the camera, enlarged {scale} times.");
    html! {
        figure {
            (figures.flat("residuals-image", &alt, traces, layout))
            figcaption {
                "From the measured to the predicted position" @if scale > 1.0 { ", enlarged " (significant(scale, 2)) " times" } ". They should point in \
                 random directions. A pattern means that the model is incomplete: a bent sheet, or unmodelled lens distortion."
            }
        }
    }
}

fn arrows(name: &str, colour: &str, points: &[&PointResidual], scale: f64) -> Value {
    let step = points.len().div_ceil(MAX_ARROWS).max(1);
    let (mut x, mut y, mut size) = (Vec::new(), Vec::new(), Vec::new());
    for p in points.iter().step_by(step).filter(|p| p.vector_px().iter().all(|c| c.is_finite())) {
        let end = p.seen + p.vector_px() * scale;
        x.extend([Some(rounded(p.seen.x)), Some(rounded(end.x)), None]);
        y.extend([Some(rounded(p.seen.y)), Some(rounded(end.y)), None]);
        size.extend([3, 0, 0]);
    }
    json!({
        "type": "scatter", "mode": "lines+markers", "name": name, "x": x, "y": y, "hoverinfo": "skip",
        "line": { "color": colour, "width": 1.25 }, "marker": { "size": size, "color": colour, "line": { "width": 0 } },
    })
}

/// Points that were left out of the fit.
fn crosses(points: &[&PointResidual]) -> Value {
    let step = points.len().div_ceil(MAX_ARROWS).max(1);
    let shown = || points.iter().step_by(step);
    json!({
        "type": "scatter", "mode": "markers", "name": "outliers, left out", "hoverinfo": "skip",
        "x": shown().map(|p| rounded(p.seen.x)).collect::<Vec<_>>(), "y": shown().map(|p| rounded(p.seen.y)).collect::<Vec<_>>(),
        "marker": { "symbol": "x-thin", "size": 6, "line": { "width": 1.25, "color": "$ink" } },
    })
}

/// To hundredths of a pixel, which are enough for a plot.
fn rounded(x: f64) -> f64 {
    (x * 100.0).round() / 100.0
}

/// The residuals in units of their noise, and the normal distribution.
fn distribution(views: &[ViewResiduals], figures: &mut Figures) -> Markup {
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
    let middle = |i: usize| -REACH + (i as f64 + 0.5) * BAR;
    let normal = |x: f64| all.len() as f64 * BAR * (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt();
    let curve: Vec<f64> = (0..=100).map(|i| -REACH + f64::from(i) * REACH / 50.0).collect();
    let traces = vec![
        json!({
            "type": "bar", "name": "measured", "x": (0..bars).map(middle).collect::<Vec<_>>(), "y": counts,
            "width": BAR * 0.92, "marker": { "color": "$cloud" }, "hovertemplate": "%{y} at %{x:.2f} σ<extra></extra>",
        }),
        json!({
            "type": "scatter", "mode": "lines", "name": "normal distribution", "x": curve, "y": curve.iter().map(|x| normal(*x)).collect::<Vec<_>>(),
            "line": { "color": "$ink", "width": 2 }, "hoverinfo": "skip",
        }),
    ];
    let layout = flat_layout(
        json!({ "title": { "text": "residual / σ of its noise" }, "range": [-REACH, REACH] }),
        json!({ "title": { "text": "measurements" }, "rangemode": "tozero" }),
    );
    let alt = format!(
        "Distribution of {} residuals in units of their noise, with the normal distribution.",
        all.len()
    );
    html! {
        figure {
            (figures.flat("residuals-distribution", &alt, traces, layout))
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
fn table(rig: &Rig, views: Option<&Vec<ViewResiduals>>) -> Markup {
    if rig.views.iter().all(|v| v.rms_px.is_none()) {
        return html! { p.note { "The rig does not state the residuals of its photographs." } };
    }
    let number = |path: String, x: Option<f64>| html! { @match x { Some(x) => (field(&path, x, &significant(x, 2))), None => "–" } };
    html! {
        h3 { "Rms residuals, px" }
        div.scroll { table {
            thead { tr {
                th scope="col" { "Photograph" }
                th.number scope="col" { "sheet edges" } th.number scope="col" { "projected corners" } th.number scope="col" { "on the projector" }
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
