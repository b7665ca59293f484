//! What a calibration found.

use std::collections::HashSet;

use slcal_core::{CalibrationReport, Device, Quality, Rig, Verdict, View};

use super::number::rounded;
use super::verdict::verdict;
use crate::output::{FAIR, Table, TextLayout, sanitized, unbroken};

/// A σ from here on is told in whole pixels: its decimals mean nothing, and would burst the column.
const WIDE_SIGMA_PX: f64 = 1000.0;

/// What a calibration found, how sure it is, and what to do about it.
pub(crate) fn calibration(rig: &Rig, report: &CalibrationReport) -> String {
    let mut layout = TextLayout::new();
    if let Some(quality) = &rig.quality {
        judgement(&mut layout, quality, &report.cause);
        layout.gap();
    }
    devices(&mut layout, rig);
    if let Some(baseline) = rig.baseline_mm() {
        let sigma = rig.baseline_sigma_mm().map_or(String::new(), |s| format!(" ± {s:.1}"));
        layout.line("baseline", format!("{baseline:.1}{sigma} mm"));
    }
    if let Some(sigma) = rig.quality.as_ref().and_then(|q| q.expected_point_sigma_mm) {
        layout.line("points", format!("expected to be off by {sigma:.2} mm (1σ) at the sheet's distance"));
    }
    if let Some(first) = rig.views.first() {
        layout.gap();
        views(&mut layout, rig, first);
    }
    let said = remarks(rig, report);
    if !said.is_empty() {
        layout.gap();
    }
    for (style, label, sentence) in said {
        layout.styled_line(style, label, sentence);
    }
    layout.into_text()
}

fn judgement(layout: &mut TextLayout, quality: &Quality, cause: &str) {
    let word = verdict(quality.verdict);
    layout.line(
        "verdict",
        match quality.verdict {
            Verdict::Good => word,
            Verdict::Fair => format!("{word}: lengths may be off by several per cent"),
            Verdict::Weak => format!("{word}: treat lengths as rough"),
            Verdict::Degenerate => format!("{word}: do not rely on any of this"),
        },
    );
    if !cause.is_empty() {
        layout.line("because", cause);
    }
}

/// Camera and projector, a row each.
fn devices(layout: &mut TextLayout, rig: &Rig) {
    let mut table = Table::new(["", "focal length, px", ">", "principal point, px", "size, px"]);
    let mut bent = Vec::new();
    for (name, device) in rig.devices() {
        let (model, k) = (&device.model, &device.model.intrinsics);
        let sigma = device.sigma.as_ref();
        let percent = sigma.filter(|s| s.focal_px > 0.0);
        table.row([
            name.to_owned(),
            with_sigma(k.fx, sigma.map(|s| s.focal_px)),
            percent.map_or(String::new(), |s| format!("{} %", rounded(100.0 * s.focal_px / k.fx, 2))),
            format!(
                "{}, {}",
                with_sigma(k.cx, sigma.map(|s| s.cx_px)),
                with_sigma(k.cy, sigma.map(|s| s.cy_px))
            ),
            format!("{}x{}", model.width, model.height),
        ]);
        if (k.fx - k.fy).abs() >= 1e-9 * k.fx {
            table.row(["", &format!("{:.1} vertically", k.fy)]);
        }
        if model.distortion.to_array().iter().any(|&c| c != 0.0) {
            bent.push((name, device));
        }
    }
    layout.table(&table);
    for (name, device) in bent {
        distortion(layout, name, device);
    }
}

fn distortion(layout: &mut TextLayout, name: &str, device: &Device) {
    let terms = ["k1", "k2", "p1", "p2", "k3"].iter().zip(device.model.distortion.to_array());
    let terms: Vec<String> = terms.map(|(name, value)| unbroken(&format!("{name} {value:.4}"))).collect();
    layout.line("distortion", format!("of the {name}: {}", terms.join(", ")));
}

/// "1536.0 ± 34.2", or what was not estimated as "639.5 (fixed)".
fn with_sigma(value: f64, sigma: Option<f64>) -> String {
    match sigma {
        Some(s) if s >= WIDE_SIGMA_PX => format!("{value:.0} ± {s:.0}"),
        Some(s) if s > 0.0 => format!("{value:.1} ± {}", rounded(s, 1)),
        Some(_) => format!("{value:.1} (fixed)"),
        None => format!("{value:.1}"),
    }
}

/// The sheet in each photograph, a row each.
fn views(layout: &mut TextLayout, rig: &Rig, first: &View) {
    let all_alike = rig.views.iter().all(|v| v.size == first.size);
    let sizes = if all_alike {
        format!("{:.1} x {:.1} mm", first.size.width_mm, first.size.height_mm)
    } else {
        "of several sizes".to_owned()
    };
    let with_rms = rig.views.iter().any(|v| v.rms_px.is_some());
    layout.line("sheet", format!("{sizes}{}", if with_rms { "; residuals (rms) in px" } else { "" }));
    let mut heads = vec!["", ">away", ">tilted by"];
    if with_rms {
        heads.extend([">edges", ">pattern", ">panel"]);
    }
    heads.push("photograph");
    let mut table = Table::new(heads);
    for (i, view) in rig.views.iter().enumerate() {
        let centre = nalgebra::Point3::new(view.size.width_mm / 2.0, view.size.height_mm / 2.0, 0.0);
        let distance = view.camera_from_sheet.transform(&centre).coords.norm();
        let mut row = vec![
            format!("view {}", i + 1),
            format!("{distance:.0} mm"),
            rig.tilt_rad(i).map_or(String::new(), |t| format!("{:.1}°", t.to_degrees())),
        ];
        if with_rms {
            let rms = view.rms_px.as_ref();
            let px = |of: Option<f64>| of.map_or("-".to_owned(), |px| format!("{px:.3}"));
            row.extend([
                px(rms.map(|r| r.edges)),
                px(rms.and_then(|r| r.corners)),
                px(rms.and_then(|r| r.projector)),
            ]);
        }
        row.push(view.photo.as_deref().map_or(String::new(), sanitized));
        table.row(row);
    }
    layout.table(&table);
}

/// Warnings, and then what to do.
fn remarks<'a>(rig: &'a Rig, report: &'a CalibrationReport) -> Vec<(anstyle::Style, &'static str, String)> {
    let warnings = rig.quality.iter().flat_map(|q| &q.warnings);
    let mut said: Vec<_> =
        warnings.clone().map(|w| (FAIR, "warning", format!("{} ({})", w.message, w.code))).collect();
    // The report's advice is often that of a warning.
    let mut once = HashSet::new();
    let advice = warnings.map(|w| &w.advice).chain([&report.advice]);
    said.extend(
        advice
            .filter(|a| !a.is_empty() && once.insert(*a))
            .map(|a| (crate::output::BOLD, "advice", a.clone())),
    );
    said
}
