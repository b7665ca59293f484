//! A rig as a line of text, as a table for notebooks, and as a record.

use std::fmt::Write as _;

use serde_json::{Value, json};
use slcal_core::{ChannelRegistration, Device, Quality, Rig};

/// The record `Quality`.
pub(super) fn quality(q: &Quality) -> Value {
    json!({
        "verdict": q.verdict,
        "focal_sigma_percent": {
            "camera": q.focal_sigma_percent_camera,
            "projector": q.focal_sigma_percent_projector,
        },
        "depth_sigma_percent": q.depth_sigma_percent,
        "expected_point_sigma_mm": q.expected_point_sigma_mm,
        "cause": q.cause,
        "advice": q.advice,
        "warnings": q.warnings,
        "assumptions": q.assumptions,
    })
}

/// The record `ChannelRegistration`.
pub(super) fn registration(r: &ChannelRegistration) -> Value {
    json!({
        "reference": "green",
        "projector": r.displacements.projector,
        "camera": r.displacements.camera,
        "sigma": r.sigma,
        "source": r.from,
    })
}

fn focal(device: &Device) -> String {
    let m = &device.model;
    let sigma = device.sigma.as_ref().filter(|s| s.focal_px > 0.0);
    let sigma = sigma.map_or(String::new(), |s| format!(" ± {:.1}", s.focal_px));
    format!("{}x{} f {:.1}{sigma} px", m.width, m.height, m.intrinsics.fx)
}

fn baseline(rig: &Rig) -> Option<String> {
    let sigma = rig.baseline_sigma_mm().map_or(String::new(), |s| format!(" ± {s:.1}"));
    rig.baseline_mm().map(|b| format!("{b:.1}{sigma} mm"))
}

/// `repr(rig)`.
pub(super) fn in_a_line(rig: &Rig) -> String {
    let mut text = String::from("Rig(");
    // Writing into a string cannot fail.
    if let Some(q) = &rig.quality {
        let _ = write!(text, "{}: ", q.verdict.name());
    }
    let _ = write!(text, "camera {}", focal(&rig.camera));
    if let Some(projector) = &rig.projector {
        let _ = write!(text, ", projector {}", focal(&projector.device));
    }
    if let Some(baseline) = baseline(rig) {
        let _ = write!(text, ", baseline {baseline}");
    }
    text.push(')');
    text
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// The rig as a table for notebooks.
pub(super) fn as_html(rig: &Rig) -> String {
    let mut rows = String::new();
    let mut row = |label: &str, content: &str| {
        let _ = write!(
            rows,
            "<tr><th style=\"text-align:left\">{label}</th><td style=\"text-align:left\">{}</td></tr>",
            escaped(content)
        );
    };
    if let Some(q) = &rig.quality {
        row("verdict", q.verdict.name());
    }
    for (label, device) in rig.devices() {
        let k = &device.model.intrinsics;
        row(label, &format!("{}, principal point {:.1}, {:.1}", focal(device), k.cx, k.cy));
    }
    if let Some(baseline) = baseline(rig) {
        row("baseline", &baseline);
    }
    for (i, view) in rig.views.iter().enumerate() {
        let tilt = rig.tilt_rad(i).map_or(String::new(), |t| format!(", tilted by {:.1}°", t.to_degrees()));
        let photo = view.photo.as_deref().map_or(String::new(), |p| format!(" in {p}"));
        row("sheet", &format!("{} x {} mm{photo}{tilt}", view.size.width_mm, view.size.height_mm));
    }
    for warning in rig.quality.iter().flat_map(|q| &q.warnings) {
        row("warning", &format!("{} ({}): {}", warning.message, warning.code, warning.advice));
    }
    format!("<table><caption>slcal.Rig</caption>{rows}</table>")
}
