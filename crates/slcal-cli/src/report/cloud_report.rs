//! The report on a cloud, which `slcal reconstruct --report` writes.

use maud::{Markup, html};
use slcal_core::{Reconstruction, Rig};

use super::next_steps::{PIPED, file_word};
use super::number::{derived, fixed, significant};
use super::page::{self, Section};
use super::photo::Photo;
use super::point_statistics;
use super::rig_page::ShownCloud;
use super::sequence_maps::{self, SequenceMaps};
use super::{decoding, next_steps, verdict, view_3d};
use crate::picture::stripes::{self, thousands};
use crate::summary;
use crate::surface::FittedSurface;

/// What is shown of the photographs.
pub(crate) enum Pictured {
    /// They are not there.
    Nothing,
    /// The photograph under stripes.
    Stripes(Photo),
    /// Maps of a scan by a sequence.
    Sequence(Box<SequenceMaps>),
}

/// What the report on a cloud shows.
pub(crate) struct CloudPage<'a> {
    pub(crate) rig: &'a Rig,
    pub(crate) rig_name: String,
    /// The photograph's name.
    pub(crate) image_name: String,
    /// The cloud's file.
    pub(crate) cloud_name: String,
    pub(crate) pictured: Pictured,
    pub(crate) result: &'a Reconstruction,
    /// The fitted surface that was asked for, or why there is none.
    pub(crate) surface: Option<Result<FittedSurface, String>>,
    pub(crate) made_by: Vec<String>,
}

/// The report, complete.
pub(crate) fn cloud_html(page: &CloudPage) -> Vec<u8> {
    let result = page.result;
    let shown = ShownCloud { name: page.cloud_name.clone(), cloud: &result.cloud };
    let fit = page.surface.as_ref().map(|surface| point_statistics::fit(surface, &result.cloud));
    let (photographs, maps) = match &page.pictured {
        Pictured::Nothing => (None, None),
        Pictured::Stripes(photo) => (Some(photograph(page, photo)), None),
        Pictured::Sequence(maps) => (Some(maps.section()), Some(maps.as_ref())),
    };
    let sections = [
        photographs,
        Some(view_3d::section(page.rig, Some(&shown), view_3d::Begin::Cloud)),
        fit,
        Some(point_statistics::section(result)),
        result.decode().map(decoding::section),
        result.sequence().map(|report| sequence_maps::decoding(report, maps)),
        Some(next_steps::listings(&page.made_by, &following(page))),
    ];
    let sections: Vec<Section> = sections.into_iter().flatten().collect();
    page::html(&format!("{}: cloud – slcal", page.image_name), &head(page), &sections)
}

fn head(page: &CloudPage) -> Markup {
    let (result, rig) = (page.result, page.rig);
    let (cloud, t) = (&result.cloud, result.triangulate());
    let remarks = result.decode().map(summary::remarks).unwrap_or_default();
    let warnings = result.warnings();
    let doubtful = !warnings.is_empty() || remarks.iter().any(|(label, _)| *label == "warning");
    let millimetres = |name: &str, x: f64| derived(name, x, &significant(x, 2));
    html! {
        div class={ "verdict " (if doubtful { "fair" } else { "none" }) } {
            h1 {
                span.what { "Cloud of " (page.image_name) }
                span.word { (thousands(cloud.points.len())) " points" }
            }
            ul.key-figures {
                @if let Some(decode) = result.decode() {
                    @let share = 100.0 * decode.decoded as f64 / decode.crossings.max(1) as f64;
                    li { span.value { (derived("decoded_percent", share, &fixed(share, 0))) " %" } span.label { "of the stripe crossings decoded" } }
                }
                @if let Some(report) = result.sequence() {
                    @let share = 100.0 * report.decoded as f64 / report.lit.max(1) as f64;
                    li { span.value { (derived("decoded_percent", share, &fixed(share, 0))) " %" } span.label { "of the lit pixels decoded" } }
                }
                @if !cloud.points.is_empty() {
                    @let [near, far] = stripes::reach_mm(cloud);
                    li {
                        span.value { (derived("nearest_mm", near, &fixed(near, 0))) "–" (derived("farthest_mm", far, &fixed(far, 0))) " mm" }
                        span.label { "from the camera" }
                    }
                }
                li {
                    span.value { "± " (millimetres("median_noise_mm", t.median_noise_mm)) " mm" }
                    span.label { "noise: scatter from point to point" }
                }
                @if t.rig_sigma_known {
                    li {
                        span.value { "± " (millimetres("median_sigma_mm", t.median_sigma_mm)) " mm" }
                        span.label { "position of a point, including the rig’s uncertainty" }
                    }
                }
                @if !cloud.triangles.is_empty() {
                    li { span.value { (thousands(cloud.triangles.len())) } span.label { "triangles of the surface" } }
                }
            }
            dl.reasons {
                dt { "What it means" }
                dd {
                    "Neighbouring points scatter about the true surface by ± " (significant(t.median_noise_mm, 2)) " mm along the line \
                     of sight. "
                    @if t.rig_sigma_known {
                        "The uncertainty of the rig may also shift and scale the cloud as a whole: together a point is off by ± "
                        (significant(t.median_sigma_mm, 2)) " mm. "
                    } @else { "The rig states no covariance, so the common error of the whole cloud is not known. " }
                    "Every ± is one standard deviation."
                }
                dt { "The rig" }
                dd { (verdict::in_a_line(rig, &page.rig_name)) }
                @if !warnings.is_empty() {
                    dt { @if result.sequence().is_some() { "Warnings" } @else { "Does the rig fit?" } }
                    dd { (next_steps::listed(&warnings)) }
                }
                @if !remarks.is_empty() {
                    dt { "Warnings and notes" }
                    @for (_, remark) in &remarks { dd { (verdict::sentence(remark)) } }
                }
            }
        }
    }
}

fn photograph(page: &CloudPage, photo: &Photo) -> Section {
    let model = &page.rig.camera.model;
    let mut drawing = stripes::reconstructed(model.size(), &page.image_name, page.result);
    // The page has its own legend.
    drawing.legend = None;
    let cloud = &page.result.cloud;
    let content = html! {
        div.photos { figure {
            (photo.under(&drawing))
            figcaption {
                "The stripes where they became points, coloured by their distance from the camera: light is near, dark is far"
                @if !cloud.points.is_empty() {
                    @let [near, far] = stripes::reach_mm(cloud);
                    " (" (fixed(near, 0)) " to " (fixed(far, 0)) " mm)"
                }
                ". "
                (thousands(cloud.points.len())) " points."
            }
        } }
    };
    Section { id: "photographs", title: "Photograph", content }
}

fn following(page: &CloudPage) -> Vec<(&'static str, String)> {
    let mut next = Vec::new();
    if page.cloud_name.to_lowercase().ends_with(".ply") {
        let cloud = file_word(&page.cloud_name);
        next.push(("Fit a plane: how flat is it?", format!("slcal evaluate plane {cloud}")));
        if page.rig_name != PIPED {
            let rig = file_word(&page.rig_name);
            next.push((
                "Show the cloud in the report on the calibration",
                format!("slcal report --rig {rig} --cloud {cloud} -o report.html"),
            ));
        }
    }
    next
}
