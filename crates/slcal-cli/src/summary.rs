//! Results in words, for people.

use std::fmt::Write as _;

use slcal_core::{CalibrationReport, Device, Rig, Verdict, View};

/// What a calibration found, how sure it is, and what to do about it.
pub(crate) fn calibration(rig: &Rig, report: &CalibrationReport) -> String {
    let mut text = String::new();
    let mut advice: Vec<&str> = Vec::new();
    device(&mut text, "camera", &rig.camera);
    if let Some(projector) = &rig.projector {
        device(&mut text, "projector", projector);
    }
    if let Some(baseline) = rig.baseline_mm() {
        let sigma = rig.baseline_sigma_mm().map_or(String::new(), |s| format!(" ± {s:.1}"));
        line(&mut text, "baseline", &format!("{baseline:.1}{sigma} mm"));
    }
    for (i, v) in rig.views.iter().enumerate() {
        view(&mut text, rig, i, v);
    }
    if let Some(quality) = &rig.quality {
        let meaning = match quality.verdict {
            Verdict::Good => "good: the focal lengths are known to better than 4 %",
            Verdict::Fair => "fair: a focal length is known to between 4 and 10 % only",
            Verdict::Weak => "weak: a focal length is uncertain by 10 to 25 %; treat lengths as rough",
            Verdict::Degenerate => {
                "degenerate: this view does not determine the focal lengths; do not rely on it"
            }
        };
        line(&mut text, "verdict", meaning);
        if !report.cause.is_empty() {
            line(&mut text, "because", &report.cause);
        }
        if let Some(sigma) = quality.expected_point_sigma_mm {
            line(
                &mut text,
                "points",
                &format!("expected to be off by {sigma:.2} mm (1σ) at the sheet's distance"),
            );
        }
        for warning in &quality.warnings {
            line(&mut text, "warning", &format!("{} ({})", warning.message, warning.code));
            advice.push(&warning.advice);
        }
    }
    advice.push(&report.advice);
    advice.retain(|a| !a.is_empty());
    // The report's advice is often that of a warning.
    advice.dedup();
    for sentence in advice {
        line(&mut text, "advice", sentence);
    }
    text
}

fn line(text: &mut String, label: &str, content: &str) {
    // Writing into a string cannot fail.
    let _ = writeln!(text, "{label:<10} {content}");
}

fn device(text: &mut String, label: &str, device: &Device) {
    let model = &device.model;
    let k = &model.intrinsics;
    let focal = if (k.fx - k.fy).abs() < 1e-9 * k.fx {
        format!("{:.1}", k.fx)
    } else {
        format!("{:.1} x {:.1}", k.fx, k.fy)
    };
    let plus_minus = |sigma: f64| if sigma > 0.0 { format!(" ± {sigma:.1}") } else { " (fixed)".to_owned() };
    let (f, share, cx, cy) = device.sigma.as_ref().map_or_else(Default::default, |s| {
        let share =
            if s.focal_px > 0.0 { format!(" ({:.2} %)", 100.0 * s.focal_px / k.fx) } else { String::new() };
        (plus_minus(s.focal_px), share, plus_minus(s.cx_px), plus_minus(s.cy_px))
    });
    line(
        text,
        label,
        &format!(
            "{}x{} px, focal length {focal}{f} px{share}, principal point {:.1}{cx}, {:.1}{cy} px",
            model.width, model.height, k.cx, k.cy
        ),
    );
    let d = model.distortion.to_array();
    if d.iter().any(|&c| c != 0.0) {
        line(
            text,
            "",
            &format!(
                "distortion k1 {:.4}, k2 {:.4}, p1 {:.4}, p2 {:.4}, k3 {:.4}",
                d[0], d[1], d[2], d[3], d[4]
            ),
        );
    }
}

fn view(text: &mut String, rig: &Rig, index: usize, view: &View) {
    let centre = nalgebra::Point3::new(view.size.width_mm / 2.0, view.size.height_mm / 2.0, 0.0);
    let distance = view.camera_from_sheet.transform(&centre).coords.norm();
    let tilt = rig.tilt_rad(index).map_or(String::new(), |t| format!(", tilted by {:.1}°", t.to_degrees()));
    let name = view.photo.as_deref().map_or(String::new(), |p| format!(" in {p}"));
    let mut content = format!(
        "{:.1} x {:.1} mm{name}, {distance:.0} mm away{tilt}",
        view.size.width_mm, view.size.height_mm
    );
    if let Some(rms) = &view.rms_px {
        let _ = write!(content, "; residuals (rms): edges {:.3} px", rms.edges);
        if let Some(corners) = rms.corners {
            let _ = write!(content, ", pattern {corners:.3} px");
        }
        if let Some(projector) = rms.projector {
            let _ = write!(content, " ({projector:.3} projector px)");
        }
    }
    line(text, "sheet", &content);
}
