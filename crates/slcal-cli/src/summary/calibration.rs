//! What a calibration found.

use std::collections::HashSet;

use nalgebra::Point2;
use slcal_core::{Assumption, CalibrationReport, ChannelRegistration, Device, Quality, Rig, Verdict, View};

use super::number::{rounded, unsigned};
use super::verdict::verdict;
use super::working_volume::{lengths, sheet_distance_mm, view_distance_mm, working_volume};
use crate::output::{BOLD, FAIR, Table, TextLayout, sanitized, unbroken};

/// From this σ on, numbers are printed in whole pixels: their decimals mean nothing and would widen the column.
const WIDE_SIGMA_PX: f64 = 1000.0;

/// The verdict, the parameters with their σ, the expected uncertainty of points and lengths, warnings and advice.
pub(crate) fn calibration(rig: &Rig, report: &CalibrationReport) -> String {
    let mut layout = TextLayout::new();
    if let Some(quality) = &rig.quality {
        judgement(&mut layout, quality, &report.cause);
        layout.gap();
    }
    devices(&mut layout, rig);
    if let Some(baseline) = rig.baseline_mm() {
        let sigma = rig.baseline_sigma_mm().map_or(String::new(), |s| format!(" ± {}", rounded(s, 1)));
        layout.line("baseline", format!("{baseline:.1}{sigma} mm"));
    }
    if rig.is_mirrored() {
        layout.line("mirrored", "the projector's pictures: column c counts as column width - 1 - c");
    }
    expected_uncertainty(&mut layout, rig);
    if let Some(first) = rig.views.first() {
        layout.gap();
        views(&mut layout, rig, first);
        exposure(&mut layout, rig);
        bends(&mut layout, rig);
    }
    if let Some(registration) = &rig.channel_registration {
        channels(&mut layout, registration);
    }
    if let Some(quality) = &rig.quality {
        rests_on(&mut layout, quality);
    }
    layout.gap();
    for (style, label, sentence) in remarks(rig, report) {
        layout.styled_line(style, label, sentence);
    }
    layout.into_text()
}

fn judgement(layout: &mut TextLayout, quality: &Quality, cause: &str) {
    let word = verdict(quality.verdict);
    layout.line(
        "verdict",
        match quality.verdict {
            Verdict::Good if quality.rests_on().next().is_some() => {
                format!("{word}, if what it assumes is true (below)")
            }
            Verdict::Good => word,
            Verdict::Fair => format!("{word}: lengths may be off by several per cent"),
            Verdict::Weak => format!("{word}: lengths are rough"),
            Verdict::Degenerate => format!("{word}: do not use these numbers"),
        },
    );
    if !cause.is_empty() {
        layout.line("because", sanitized(cause));
    }
    layout.line("", "(± and σ are one standard deviation)");
}

/// What nothing in the photographs confirms and would cost more than σ; what the same thing checks stands together.
fn rests_on(layout: &mut TextLayout, quality: &Quality) {
    let mut groups: Vec<(&str, Vec<&Assumption>)> = Vec::new();
    for a in quality.rests_on() {
        match groups.iter_mut().find(|(check, _)| *check == a.check()) {
            Some((_, group)) => group.push(a),
            None => groups.push((a.check(), vec![a])),
        }
    }
    if groups.is_empty() {
        return;
    }
    layout.gap();
    let mut label = "assumes";
    for (check, group) in groups {
        for a in &group {
            layout.line(label, format!("{} ({})", a.text, a.cost()));
            label = "";
        }
        layout.line("", format!("to check: {check}"));
    }
}

/// How far points and lengths are expected to be off at the sheet, and which part of that all points share.
fn expected_uncertainty(layout: &mut TextLayout, rig: &Rig) {
    let Some(quality) = &rig.quality else { return };
    if let Some(depth) = quality.depth_sigma_percent {
        let percent = rounded(depth, 2);
        layout.line(
            "depth",
            format!("± {percent} % at the sheet's distance, by the uncertainty of the calibration alone"),
        );
    }
    let Some(sigma) = quality.expected_point_sigma_mm else { return };
    let volume = working_volume(rig).ok().flatten();
    let common = volume.as_ref().is_some_and(|v| v.knows_rig && v.rig_mm() > v.sigma.noise_mm);
    let shared = if common {
        ", most of it common to all points: it shifts and scales the cloud as a whole"
    } else {
        ""
    };
    let distance = unbroken(&format!("({:.0} mm)", sheet_distance_mm(rig)));
    layout.line(
        "points",
        format!("± {sigma:.2} mm along the line of sight at the sheet's distance {distance}{shared}"),
    );
    if let Some((length, [across, along])) = volume.and_then(|v| lengths(rig, v.axis)) {
        let [across, along] = [across, along].map(|s| rounded(s, if s < 1.0 { 2 } else { 1 }));
        layout.line(
            "lengths",
            format!(
                "{length:.0} mm at the sheet: ± {across} mm across and ± {along} mm along the line of sight"
            ),
        );
    }
}

/// A row for each device.
fn devices(layout: &mut TextLayout, rig: &Rig) {
    let mut table = Table::new(["", "focal length, px", ">", "principal point, px", "size, px"]);
    let (mut distorted, mut ratios) = (Vec::new(), Vec::new());
    for ((name, device), fy_sigma) in rig.devices().zip(rig.fy_sigmas_px()) {
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
        if let Some(aspect) = sigma.map(|s| s.aspect).filter(|s| *s > 0.0) {
            let ratio = value_and_sigma(k.fy / k.fx, aspect);
            let fy = unbroken(&with_sigma(k.fy, fy_sigma));
            ratios.push(format!("of the {name} {} (fy {fy} px)", unbroken(&ratio)));
        } else if (k.fx - k.fy).abs() >= 1e-9 * k.fx {
            table.row(["", &format!("{:.1} vertically", k.fy)]);
        }
        let sigmas = sigma.map_or([0.0; 5], |s| s.distortion);
        if model.distortion.to_array().iter().chain(&sigmas).any(|&c| c != 0.0) {
            distorted.push((name, device));
        }
    }
    layout.table(&table);
    if !ratios.is_empty() {
        layout.line("fy/fx", ratios.join(", "));
    }
    for (name, device) in distorted {
        distortion(layout, name, device);
    }
}

fn distortion(layout: &mut TextLayout, name: &str, device: &Device) {
    let sigmas = device.sigma.map(|s| s.distortion);
    let terms = ["k1", "k2", "p1", "p2", "k3"].iter().zip(device.model.distortion.to_array()).enumerate();
    let terms = terms.filter_map(|(i, (name, value))| match sigmas.map(|s| s[i]) {
        Some(s) if s > 0.0 => Some(format!("{name} {}", value_and_sigma(value, s))),
        // A model by name has no others.
        Some(_) if value == 0.0 => None,
        Some(_) => Some(format!("{name} {value:.4} (fixed)")),
        None => Some(format!("{name} {value:.4}")),
    });
    let terms: Vec<String> = terms.map(|term| unbroken(&term)).collect();
    layout.line("distortion", format!("of the {name}: {}", terms.join(", ")));
}

/// A value to the last digit that counts, with two digits of its σ: "0.0133 ± 0.0045".
fn value_and_sigma(value: f64, sigma: f64) -> String {
    let decimals = (1.0 - sigma.log10().floor()).clamp(1.0, 9.0) as usize;
    format!("{:.decimals$} ± {sigma:.decimals$}", unsigned(value, decimals))
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

/// A row for the sheet in each photograph.
fn views(layout: &mut TextLayout, rig: &Rig, first: &View) {
    let sizes = sizes(rig, first);
    let with_rms = rig.views.iter().any(|v| v.rms_px.is_some());
    layout.line("sheet", format!("{sizes}{}", if with_rms { "; rms residuals in px" } else { "" }));
    let mut heads = vec!["", ">distance", ">tilt"];
    if with_rms {
        heads.extend([">edges", ">corners", ">projector"]);
    }
    heads.push("photograph");
    let mut table = Table::new(heads);
    for (i, view) in rig.views.iter().enumerate() {
        let mut row = vec![
            format!("view {}", i + 1),
            format!("{:.0} mm", view_distance_mm(view)),
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

/// How much of the sheet is overexposed, where it is any.
fn exposure(layout: &mut TextLayout, rig: &Rig) {
    let clipped = rig.views.iter().map(|v| v.clipped_percent.unwrap_or(0.0).round());
    let clipped: Vec<_> = clipped.enumerate().filter(|(_, percent)| *percent > 0.0).collect();
    if clipped.is_empty() {
        return;
    }
    let each = clipped.iter().map(|(i, percent)| match rig.views.len() {
        1 => format!("{percent:.0} %"),
        _ => unbroken(&format!("{percent:.0} % in view {}", i + 1)),
    });
    layout
        .line("clipped", format!("{} of the lit sheet is overexposed", each.collect::<Vec<_>>().join(", ")));
}

/// "297.0 x 210.0 mm", or how the sheet lies where it is turned in some of the photographs.
fn sizes(rig: &Rig, first: &View) -> String {
    let size = first.size;
    if rig.views.iter().all(|v| v.size == size) {
        return format!("{:.1} x {:.1} mm", size.width_mm, size.height_mm);
    }
    let turned = rig.views.iter().enumerate().filter(|(_, v)| v.size == size.transposed());
    let turned: Vec<String> = turned.map(|(i, _)| (i + 1).to_string()).collect();
    let others = rig.views.iter().filter(|v| v.size == size).count();
    if turned.len() + others < rig.views.len() {
        return "of several sizes".to_owned();
    }
    let plural = if turned.len() == 1 { "" } else { "s" };
    format!(
        "{:.1} x {:.1} mm, lying the other way round in view{plural} {}",
        size.width_mm,
        size.height_mm,
        turned.join(", ")
    )
}

/// How far the sheet bends in each photograph, where it was not taken for flat.
fn bends(layout: &mut TextLayout, rig: &Rig) {
    let mut table = Table::new(["", ">bend, mm", "nearest to the camera", "furthest from it"]);
    let mut any = false;
    for (i, view) in rig.views.iter().enumerate() {
        let Some(sag) = rig.sag(i) else { continue };
        any = true;
        // Where a sheet lies that may be flat means nothing.
        let place = |at: Point2<f64>| if sag.is_known() { view.size.place_in_words(at) } else { "-" };
        let bend = format!("{} ± {}", rounded(sag.sag_mm, 2), rounded(sag.sigma_mm, 2));
        table.row([format!("view {}", i + 1), bend, place(sag.peak).into(), place(sag.valley).into()]);
    }
    if any {
        layout.gap();
        layout.line("flatness", "how far the sheet bends, from its valley to its peak");
        layout.table(&table);
    }
}

/// How red and blue are displaced against green.
fn channels(layout: &mut TextLayout, registration: &ChannelRegistration) {
    layout.gap();
    layout.line(
        "channels",
        "red and blue against green: px to the right and down on the panel, and the camera's magnification",
    );
    let mut table = Table::new(["", ">right, px", ">down, px", ">magnification, 1e-4"]);
    let (d, sigma) = (&registration.displacements, &registration.sigma);
    for (name, shift, of_shift, lateral, of_lateral) in [
        ("red", d.projector.red, sigma.projector.red, d.camera.red, sigma.camera.red),
        ("blue", d.projector.blue, sigma.projector.blue, d.camera.blue, sigma.camera.blue),
    ] {
        let px = |k: usize| value_and_sigma(shift.shift_px[k], of_shift.shift_px[k]);
        let radial = value_and_sigma(1e4 * lateral.radial, 1e4 * of_lateral.radial);
        table.row([name.to_owned(), px(0), px(1), radial]);
    }
    layout.table(&table);
}

/// What must not change after the calibration.
pub(crate) fn holds_while(rig: &Rig) -> &'static str {
    match rig.projector {
        Some(_) => {
            "valid only while camera and projector keep their positions relative to each other, their zoom and their focus; \
             slcal verify checks it"
        }
        None => "valid only while the camera keeps its zoom and focus",
    }
}

/// Warnings, advice, and how long the calibration holds.
fn remarks(rig: &Rig, report: &CalibrationReport) -> Vec<(anstyle::Style, &'static str, String)> {
    let warnings = rig.quality.iter().flat_map(|q| &q.warnings);
    let mut remarks = Vec::new();
    // The advice of several warnings, and the report's, is often the same.
    let mut once = HashSet::new();
    let mut advise = |remarks: &mut Vec<_>, advice: &str| {
        if !advice.is_empty() && once.insert(advice.to_owned()) {
            remarks.push((BOLD, "advice", sanitized(advice)));
        }
    };
    for w in warnings {
        remarks.push((FAIR, "warning", sanitized(&format!("{} ({})", w.message, w.code))));
        advise(&mut remarks, &w.advice);
    }
    advise(&mut remarks, &report.advice);
    remarks.push((BOLD, "note", holds_while(rig).to_owned()));
    remarks
}
