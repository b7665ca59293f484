//! Results in words, for people.

use std::fmt::Write as _;

use slcal_core::decode::{DecodeReport, Lines};
use slcal_core::evaluate::FitReport;
use slcal_core::reconstruct::Reconstruction;
use slcal_core::{CalibrationReport, Device, PointCloud, Rig, Verdict, View};

/// Above this share of clipped stripes the user is told to expose less.
const SATURATED_SHARE: f64 = 0.05;
/// Above this share of bright stripes without a number the pattern is doubted: the right one leaves 2 % in a clean
/// photograph and 18 % in a compressed one of a head; a pattern that shares parts of the code, on surfaces too broken for
/// decoding to refuse it, mostly 28 % to 80 %.
const UNNUMBERED_SHARE: f64 = 0.25;
/// Channels that spill more than this into each other are told: hues get closer.
const CROSSTALK_SHARE: f64 = 0.1;
/// Above this noise, in 8-bit grey levels, centres are told to be the worse for it.
const NOISE_LEVELS: f64 = 4.0;

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
            Verdict::Good => "good",
            Verdict::Fair => "fair: lengths may be off by several per cent",
            Verdict::Weak => "weak: treat lengths as rough",
            Verdict::Degenerate => "degenerate: do not rely on any of this",
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
    let mut said = std::collections::HashSet::new();
    advice.retain(|a| said.insert(*a));
    for sentence in advice {
        line(&mut text, "advice", sentence);
    }
    text
}

fn line(text: &mut String, label: &str, content: &str) {
    // Writing into a string cannot fail.
    let _ = writeln!(text, "{label:<10} {content}");
}

/// A number with `decimals`, or with as many more as a small one needs to show two digits.
fn rounded(x: f64, decimals: usize) -> String {
    let small = x != 0.0 && x.abs() < 0.1;
    let decimals = if small { (1.0 - x.abs().log10().floor()).min(6.0) as usize } else { decimals };
    format!("{x:.decimals$}")
}

fn device(text: &mut String, label: &str, device: &Device) {
    let model = &device.model;
    let k = &model.intrinsics;
    let focal = if (k.fx - k.fy).abs() < 1e-9 * k.fx {
        format!("{:.1}", k.fx)
    } else {
        format!("{:.1} x {:.1}", k.fx, k.fy)
    };
    let plus_minus =
        |sigma: f64| if sigma > 0.0 { format!(" ± {}", rounded(sigma, 1)) } else { " (fixed)".to_owned() };
    let (f, share, cx, cy) = device.sigma.as_ref().map_or_else(Default::default, |s| {
        let share = if s.focal_px > 0.0 {
            format!(" ({} %)", rounded(100.0 * s.focal_px / k.fx, 2))
        } else {
            String::new()
        };
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

/// What decoding saw and why it left some of it out.
pub(crate) fn decoding(report: &DecodeReport) -> String {
    let mut text = String::new();
    let share = 100.0 * report.decoded as f64 / report.crossings.max(1) as f64;
    line(
        &mut text,
        "stripes",
        &format!(
            "{} crossings seen, {} decoded ({share:.1} %), {} different slits, {:.1} px wide",
            report.crossings, report.decoded, report.slits, report.stripe_width_px
        ),
    );
    let d = &report.dropped;
    line(
        &mut text,
        "dropped",
        &format!(
            "{} weak, {} ambiguous, {} inconsistent, {} cut, {} unsure",
            d.weak, d.ambiguous, d.inconsistent, d.cut, d.unsure
        ),
    );
    for (label, remark) in remarks(report) {
        line(&mut text, label, &remark);
    }
    text
}

/// What the user should know or do about a photograph of stripes: "warning" or "note", and the sentence.
fn remarks(report: &DecodeReport) -> Vec<(&'static str, String)> {
    let mut remarks = Vec::new();
    if report.saturated > SATURATED_SHARE {
        let percent = 100.0 * report.saturated;
        let sentence = format!(
            "{percent:.0} % of the crossings are overexposed and their colours unreliable: expose less"
        );
        remarks.push(("warning", sentence));
    }
    let bright = report.crossings.saturating_sub(report.dropped.weak).max(1);
    let unnumbered = report.dropped.ambiguous as f64 / bright as f64;
    if unnumbered > UNNUMBERED_SHARE {
        let percent = 100.0 * unnumbered;
        let sentence = format!(
            "{percent:.0} % of the stripes have no place in the code: is the pattern file the one that was projected?"
        );
        remarks.push(("warning", sentence));
    }
    if report.reversed {
        let sentence = "the slits run backwards: the projector stands upside down or behind a mirror";
        remarks.push(("note", sentence.to_owned()));
    }
    if report.turned {
        let way = match report.lines {
            Lines::Rows => "down",
            Lines::Columns => "across",
        };
        let sentence = format!(
            "the stripes run {way} the photograph, a quarter turn from the pattern's: the camera or the projector is turned"
        );
        remarks.push(("note", sentence));
    }
    if let Some((into, of, share)) = largest_crosstalk(report)
        && share > CROSSTALK_SHARE
    {
        let percent = 100.0 * share;
        let sentence = format!("crosstalk: the camera's {into} sees {percent:.0} % of the projector's {of}");
        remarks.push(("note", sentence));
    }
    if report.noise_levels > NOISE_LEVELS {
        let sentence = format!(
            "noise of {:.1} grey levels (1σ) scatters the centres: more light or a lower gain makes them surer",
            report.noise_levels
        );
        remarks.push(("note", sentence));
    }
    remarks
}

/// The camera's channel that sees most of another primary's light, that primary, and the share.
fn largest_crosstalk(report: &DecodeReport) -> Option<(&'static str, &'static str, f64)> {
    const NAMES: [&str; 3] = ["red", "green", "blue"];
    let matrix = report.crosstalk.as_ref()?;
    let others = (0..9).map(|i| (i / 3, i % 3)).filter(|(row, column)| row != column);
    others
        .map(|(row, column)| (NAMES[row], NAMES[column], matrix[row][column]))
        .max_by(|a, b| a.2.total_cmp(&b.2))
}

/// One cloud of many: decoding and points in a line.
pub(crate) fn cloud_in_a_line(result: &Reconstruction) -> String {
    let mut text = format!("{} points", result.cloud.points.len());
    if !result.cloud.triangles.is_empty() {
        let _ = write!(text, ", {} triangles", result.cloud.triangles.len());
    }
    if let Some((near, _, far)) = distances(&result.cloud) {
        let _ = write!(text, ", {near:.0} to {far:.0} mm from the camera");
    }
    if let Some(report) = &result.decode {
        let _ = write!(text, "; {} of {} crossings decoded", report.decoded, report.crossings);
        for (label, remark) in remarks(report) {
            let _ = write!(text, "; {label}: {remark}");
        }
    }
    text
}

/// What became of the matches.
pub(crate) fn cloud(result: &Reconstruction) -> String {
    let mut text = String::new();
    let cloud = &result.cloud;
    let mut content = format!("{}", cloud.points.len());
    if !cloud.triangles.is_empty() {
        let _ = write!(content, ", {} triangles", cloud.triangles.len());
    }
    if let Some((near, middle, far)) = distances(cloud) {
        let _ =
            write!(content, ", {near:.0} to {far:.0} mm from the camera, half of them within {middle:.0} mm");
    }
    line(&mut text, "points", &content);
    let t = &result.triangulate;
    let refused = t.invalid + t.grazing + t.behind + t.outside_panel + t.contradicting;
    if refused + result.cull.outliers > 0 {
        let mut content = format!(
            "{} outliers; {} without coordinates, {} grazing, {} behind the devices, {} lit from outside the panel",
            result.cull.outliers, t.invalid, t.grazing, t.behind, t.outside_panel
        );
        if t.contradicting > 0 {
            let _ = write!(content, ", {} whose column and row contradict each other", t.contradicting);
        }
        line(&mut text, "left out", &content);
    }
    text
}

/// Nearest, median and farthest distance of the points from the camera, mm.
fn distances(cloud: &PointCloud) -> Option<(f64, f64, f64)> {
    let mut all: Vec<f64> = cloud.points.iter().map(|p| (p.position - cloud.camera_centre).norm()).collect();
    all.sort_by(f64::total_cmp);
    Some((*all.first()?, *all.get(all.len() / 2)?, *all.last()?))
}

/// How well a surface fits; `surface` describes it.
pub(crate) fn fit(surface: &str, report: &FitReport) -> String {
    let mut text = format!("{surface}\n");
    let percent = |mm: f64, percent: f64| format!("{mm:.4} mm ({percent:.4} % of the distance)");
    line(&mut text, "mean", &percent(report.mean_mm, report.mean_percent));
    line(&mut text, "std", &percent(report.std_mm, report.std_percent));
    line(&mut text, "rms", &percent(report.rms_mm, report.rms_percent));
    line(
        &mut text,
        "over",
        &format!(
            "{} of {} points, those within {:.3} mm of it ({:.1} % are not), {:.0} mm from the camera on average",
            report.inliers,
            report.points,
            report.inlier_limit_mm,
            100.0 * report.outlier_share,
            report.camera_distance_mm
        ),
    );
    text
}

#[cfg(test)]
mod tests {
    use slcal_core::decode::Dropped;

    use super::*;

    #[test]
    fn remarks_say_what_is_out_of_the_ordinary_and_nothing_else() {
        let plain = DecodeReport {
            crosstalk: Some([[1.0, 0.05, 0.0], [0.02, 1.0, 0.08], [0.0, 0.03, 1.0]]),
            noise_levels: 1.2,
            ..DecodeReport::default()
        };
        assert!(remarks(&plain).is_empty());
        let odd = DecodeReport {
            crosstalk: Some([[1.0, 0.2, 0.0], [0.02, 1.0, 0.08], [0.0, 0.31, 1.0]]),
            noise_levels: 7.0,
            turned: true,
            lines: Lines::Columns,
            crossings: 45_000,
            dropped: Dropped { weak: 5, ambiguous: 16_200, ..Dropped::default() },
            ..plain
        };
        let said: Vec<String> = remarks(&odd).into_iter().map(|(_, s)| s).collect();
        assert_eq!(said.len(), 4);
        assert!(said[0].contains("36 % of the stripes") && said[0].contains("pattern file"));
        assert!(said[1].contains("run across the photograph"));
        assert!(said[2].contains("blue sees 31 % of the projector's green"));
        assert!(said[3].contains("7.0 grey levels"));
    }

    #[test]
    fn small_numbers_keep_two_digits() {
        assert_eq!([34.21, 0.42, 0.0514, 0.0031].map(|x| rounded(x, 1)), ["34.2", "0.4", "0.051", "0.0031"]);
        assert_eq!([rounded(0.0, 2), rounded(2.234, 2)], ["0.00", "2.23"]);
    }
}
