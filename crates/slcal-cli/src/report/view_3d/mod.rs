//! Devices, sheets and cloud as a 3D plot.

mod point_cloud;

use maud::html;
use nalgebra::{Point2, Point3};
use serde_json::{Value, json};
use slcal_core::geometry::{Camera, Pose};
use slcal_core::{Projector, Rig, View};

use self::point_cloud::plotted;
use super::figure::{Figures, packed};
use super::page::Section;
use super::rig_page::ShownCloud;
use crate::summary::working_volume::sheet_distance_mm;

/// Length of the drawn pyramids as a share of the distance of the sheet or cloud.
const PYRAMID: f64 = 0.22;
/// Assumed distance where there is neither a sheet nor a cloud, mm.
const NOTHING_SEEN_MM: f64 = 1000.0;

pub(super) fn section(rig: &Rig, beside: Option<&ShownCloud>, figures: &mut Figures) -> Section {
    let shown = beside.map(|c| point_cloud::ShownPoints::new(rig, c.cloud));
    let distance = match (rig.views.is_empty(), &shown) {
        (false, _) => sheet_distance_mm(rig),
        (true, Some(cloud)) => cloud.median_depth_mm().unwrap_or(NOTHING_SEEN_MM),
        (true, None) => rig.baseline_mm().map_or(NOTHING_SEEN_MM, |b| 3.0 * b),
    };
    let length = PYRAMID * distance;
    let projector_below = rig.projector.is_some_and(|p| p.from_camera.pose.centre().y > 0.0);
    // Names above and below, so that neither covers the other device.
    let [camera_label, projector_label] =
        if projector_below { ["top center", "bottom center"] } else { ["bottom center", "top center"] };
    let mut traces =
        pyramid(("camera", "$camera", camera_label), &rig.camera.model, &Pose::identity(), length);
    if let Some(Projector { device, from_camera }) = &rig.projector {
        let camera_from_projector = from_camera.pose.inverse();
        let style = ("projector", "$projector", projector_label);
        traces.extend(pyramid(style, &device.model, &camera_from_projector, length));
        let centre = from_camera.pose.centre();
        traces.push(lines("baseline", "$ink", &[vec![Point3::origin(), centre]], "dash"));
    }
    for (i, view) in rig.views.iter().enumerate() {
        traces.extend(sheet(i, view));
    }
    let mut choices = Vec::new();
    if let Some(shown) = &shown {
        choices = shown.add_to(&mut traces);
    }
    // Devices alone fill the view to its corners; with sheet or cloud the scene is long and narrow.
    let away = if rig.views.is_empty() && beside.is_none() { 1.6 } else { 1.0 };
    let alt = alt(rig, beside);
    let plot = figures.space("space", &alt, traces, layout(away), choices);
    let content = html! {
        p { (alt) span.screen-only { " Drag or press the arrow keys to rotate; scroll, pinch or press + and − to zoom; double-click to reset." } }
        (plot)
        @if let (Some(shown), Some(cloud)) = (&shown, beside) { p.note { (shown.note(&cloud.name)) } }
    };
    Section { id: "in-space", title: "3D view", content }
}

fn alt(rig: &Rig, beside: Option<&ShownCloud>) -> String {
    let mut parts = vec!["the camera".to_owned()];
    if let Some(baseline) = rig.baseline_mm() {
        parts.push(format!("the projector, {baseline:.0} mm from it"));
    }
    match rig.views.len() {
        0 => {}
        1 => parts.push(format!("the sheet, {:.0} mm from the camera", sheet_distance_mm(rig))),
        n => parts.push(format!(
            "the sheet in its {n} poses, {:.0} mm from the camera on average",
            sheet_distance_mm(rig)
        )),
    }
    if let Some(cloud) = beside {
        parts.push(format!("the points of {}", cloud.name));
    }
    let last = parts.pop().unwrap_or_default();
    let text = if parts.is_empty() { last } else { format!("{} and {last}", parts.join(", ")) };
    super::verdict::sentence(&text)
}

/// Lines, one after the other, as one trace.
fn lines(name: &str, colour: &str, all: &[Vec<Point3<f64>>], dash: &str) -> Value {
    let mut columns: [Vec<Option<f64>>; 3] = Default::default();
    for line in all {
        for p in line {
            for (column, x) in columns.iter_mut().zip(plotted(p)) {
                column.push(Some(x));
            }
        }
        for column in &mut columns {
            column.push(None);
        }
    }
    let [x, y, z] = columns;
    json!({
        "type": "scatter3d", "mode": "lines", "name": name, "x": x, "y": y, "z": z, "hoverinfo": "name",
        "line": { "color": colour, "width": 4, "dash": dash },
    })
}

/// The field of view of a device: a pyramid from its centre to its image.
fn pyramid(
    (name, colour, label_at): (&str, &str, &str),
    model: &Camera,
    camera_from_device: &Pose,
    length: f64,
) -> Vec<Value> {
    let (w, h) = (f64::from(model.width) - 0.5, f64::from(model.height) - 0.5);
    let corners = [(-0.5, -0.5), (w, -0.5), (w, h), (-0.5, h)].map(|(u, v)| {
        // Without distortion: far outside, that of some lenses has no inverse.
        let x = model.intrinsics.normalized(Point2::new(u, v));
        camera_from_device.transform(&Point3::new(x.x * length, x.y * length, length))
    });
    let centre = camera_from_device.transform(&Point3::origin());
    let [a, b, c, d] = corners;
    // A small roof marks the top side.
    let roof = a + (b - a) / 2.0 + (a - d) * 0.25;
    let outline = vec![a, b, c, d, a, roof, b];
    let edges = [vec![centre, a], vec![centre, b], vec![centre, c], vec![centre, d]];
    let mut all = vec![outline];
    all.extend(edges);
    let label = plotted(&centre);
    vec![
        lines(name, colour, &all, "solid"),
        json!({
            "type": "scatter3d", "mode": "markers+text", "name": name, "showlegend": false, "hoverinfo": "name",
            "x": [label[0]], "y": [label[1]], "z": [label[2]], "text": [name], "textposition": label_at,
            "textfont": { "color": colour, "size": 13 }, "marker": { "color": colour, "size": 4 },
        }),
    ]
}

/// The sheet of a view.
fn sheet(i: usize, view: &View) -> Vec<Value> {
    let corners: Vec<Point3<f64>> = view
        .size
        .corners()
        .iter()
        .map(|c| view.camera_from_sheet.transform(&Point3::new(c.x, c.y, 0.0)))
        .collect();
    let mut outline = corners.clone();
    outline.extend(corners.first().copied());
    let name = format!("sheet {}", i + 1);
    let axis = |k: usize| packed(&corners.iter().map(|c| plotted(c)[k]).collect::<Vec<_>>());
    let mut trace = lines(&name, "$sheet", &[outline], "solid");
    trace["showlegend"] = json!(i == 0);
    trace["name"] = json!(if i == 0 { "sheet" } else { &name });
    vec![
        trace,
        json!({
            "type": "mesh3d", "name": name, "x": axis(0), "y": axis(1), "z": axis(2), "i": [0, 0], "j": [1, 2], "k": [2, 3],
            "color": "$sheet", "opacity": 0.25, "hoverinfo": "name", "showlegend": false, "flatshading": true,
            "lighting": { "ambient": 1.0, "diffuse": 0.0, "specular": 0.0 },
        }),
    ]
}

fn layout(away: f64) -> Value {
    let axis = |title: &str| {
        json!({
            "title": { "text": title }, "color": "$muted", "gridcolor": "$line", "zeroline": false,
            "showbackground": false, "showspikes": false, "tickfont": { "size": 10 },
        })
    };
    json!({
        "paper_bgcolor": "rgba(0,0,0,0)",
        "font": { "family": "system-ui, sans-serif", "size": 13, "color": "$ink" },
        "margin": { "l": 0, "r": 0, "t": 0, "b": 0 },
        "legend": { "orientation": "h", "x": 0, "y": 0, "yanchor": "bottom", "bgcolor": "rgba(0,0,0,0)" },
        "scene": {
            "aspectmode": "data",
            "xaxis": axis("right, mm"), "yaxis": axis("depth, mm"), "zaxis": axis("up, mm"),
            "camera": { "center": { "x": 0, "y": 0, "z": -0.12 }, "eye": { "x": -1.1 * away, "y": -0.9 * away, "z": 0.55 * away }, "up": { "x": 0, "y": 0, "z": 1 } },
            "dragmode": "orbit",
        },
    })
}
