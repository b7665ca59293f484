//! How a rig is shown: in a line, in a notebook, as records.

use std::fmt::Write as _;

use pyo3::prelude::*;
use serde_json::{Value, json};
use slcal_core::{CalibrationReport, Device, Quality, Rig, Verdict};

use crate::errors;

/// The verdict in the word that files have for it.
pub(super) fn verdict(quality: &Quality) -> &'static str {
    match quality.verdict {
        Verdict::Good => "good",
        Verdict::Fair => "fair",
        Verdict::Weak => "weak",
        Verdict::Degenerate => "degenerate",
    }
}

/// The record `Quality`.
pub(super) fn quality(q: &Quality) -> Value {
    json!({
        "verdict": verdict(q),
        "focal_sigma_percent": {
            "camera": q.focal_sigma_percent_camera,
            "projector": q.focal_sigma_percent_projector,
        },
        "expected_point_sigma_mm": q.expected_point_sigma_mm,
        "warnings": q.warnings.iter()
            .map(|w| json!({ "code": w.code, "message": w.message, "advice": w.advice }))
            .collect::<Vec<_>>(),
    })
}

/// The record `CalibrationReport`.
pub(super) fn report(r: &CalibrationReport) -> Value {
    json!({
        "iterations": r.iterations,
        "edge_inliers": r.edge_inliers,
        "corner_inliers": r.corner_inliers,
        "cause": r.cause,
        "advice": r.advice,
    })
}

/// The report that a pickled rig holds.
pub(super) fn report_of(py: Python<'_>, text: &str) -> PyResult<CalibrationReport> {
    let read = || {
        let value: Value = serde_json::from_str(text).ok()?;
        Some(CalibrationReport {
            iterations: value["iterations"].as_u64()? as usize,
            edge_inliers: value["edge_inliers"].as_f64()?,
            corner_inliers: value["corner_inliers"].as_f64()?,
            cause: value["cause"].as_str()?.to_owned(),
            advice: value["advice"].as_str()?.to_owned(),
        })
    };
    read().ok_or_else(|| errors::invalid(py, "pickled rig", "the report of a calibration", text))
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
        let _ = write!(text, "{}: ", verdict(q));
    }
    let _ = write!(text, "camera {}", focal(&rig.camera));
    if let Some(projector) = &rig.projector {
        let _ = write!(text, ", projector {}", focal(projector));
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
        row("verdict", verdict(q));
    }
    for (label, device) in [("camera", Some(&rig.camera)), ("projector", rig.projector.as_ref())] {
        if let Some(device) = device {
            let k = &device.model.intrinsics;
            row(label, &format!("{}, principal point {:.1}, {:.1}", focal(device), k.cx, k.cy));
        }
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
