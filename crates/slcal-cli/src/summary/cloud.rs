//! Point clouds.

use std::fmt::Write as _;

use slcal_core::{PointCloud, Reconstruction};

use super::decoding::{add_counts, add_remarks, decoded_percent};
use super::sequence::{add_sequence, sequence_percent};
use crate::output::{BOLD, FAIR, TextLayout, sanitized, unbroken};
use crate::quantile::Sorted;

/// One cloud of many: points and decoding in one line, then warnings and notes.
pub(crate) fn cloud_in_a_line(result: &Reconstruction) -> String {
    let mut text = format!("{} points", result.cloud.points.len());
    if !result.cloud.triangles.is_empty() {
        let _ = write!(text, ", {} triangles", result.cloud.triangles.len());
    }
    if let Some((near, _, far)) = distances(&result.cloud) {
        let _ = write!(text, ", {near:.0} to {far:.0} mm away");
    }
    if let Some(report) = result.decode() {
        let _ = write!(text, ", {:.1} % decoded", decoded_percent(report));
    }
    if let Some(report) = result.sequence() {
        let _ = write!(text, ", {:.1} % decoded", sequence_percent(report));
    }
    let mut layout = TextLayout::new();
    add_warnings(&mut layout, result);
    let _ = write!(text, "\n{}", layout.into_text());
    text.trim_end().to_owned()
}

/// Decoding, points, warnings and notes.
pub(crate) fn reconstruction(result: &Reconstruction) -> String {
    let mut layout = TextLayout::new();
    if let Some(report) = result.decode() {
        add_counts(&mut layout, report);
    }
    if let Some(report) = result.sequence() {
        add_sequence(&mut layout, report);
    }
    points(&mut layout, result);
    add_warnings(&mut layout, result);
    layout.into_text()
}

/// Warnings about the cloud with their advice, then those of decoding.
fn add_warnings(layout: &mut TextLayout, result: &Reconstruction) {
    let warnings = result.warnings();
    for w in &warnings {
        layout.styled_line(FAIR, "warning", sanitized(&format!("{} ({})", w.message, w.code)));
    }
    for w in &warnings {
        layout.styled_line(BOLD, "advice", sanitized(&w.advice));
    }
    if let Some(report) = result.decode() {
        add_remarks(layout, report);
    }
}

/// Points from matches, and warnings.
pub(crate) fn cloud(result: &Reconstruction) -> String {
    let mut layout = TextLayout::new();
    points(&mut layout, result);
    add_warnings(&mut layout, result);
    layout.into_text()
}

fn points(layout: &mut TextLayout, result: &Reconstruction) {
    let cloud = &result.cloud;
    let mut parts = vec![cloud.points.len().to_string()];
    if !cloud.triangles.is_empty() {
        parts.push(format!("{} triangles", cloud.triangles.len()));
    }
    if let Some((near, middle, far)) = distances(cloud) {
        parts.push(format!("{near:.0} to {far:.0} mm from the camera"));
        parts.push(format!("half of them within {middle:.0} mm"));
    }
    layout.line("points", listed(&parts));
    let left_out = left_out(result);
    if !left_out.is_empty() {
        layout.line(
            "left out",
            listed(&left_out.iter().map(|(count, why)| format!("{count} {why}")).collect::<Vec<_>>()),
        );
    }
}

/// Matches that are no points of the cloud: how many, and why; only reasons that occurred.
pub(crate) fn left_out(result: &Reconstruction) -> Vec<(usize, &'static str)> {
    let t = result.triangulate();
    let mut reasons = vec![
        (result.cull().outliers, "outliers (far from their neighbours)"),
        (t.invalid, "invalid (no projector coordinate, or outside the lens model)"),
        (t.grazing, "with a ray nearly parallel to the light plane"),
        (t.behind, "behind the camera or the projector"),
        (t.outside_panel, "lit from outside the projector's image"),
        (t.contradicting, "whose column and row contradict each other"),
        (t.outside_depth, "outside the depth limits"),
    ];
    reasons.retain(|(count, _)| *count > 0);
    reasons
}

/// Joined by commas; lines break only there.
fn listed(parts: &[String]) -> String {
    parts.iter().map(|p| unbroken(p)).collect::<Vec<_>>().join(", ")
}

/// Nearest, median and farthest distance of the points from the camera, mm.
fn distances(cloud: &PointCloud) -> Option<(f64, f64, f64)> {
    let all = Sorted::new(cloud.distances_mm());
    Some((all.at(0.0)?, all.at(0.5)?, all.at(1.0)?))
}
