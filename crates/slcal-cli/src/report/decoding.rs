//! Decoded and rejected stripe crossings, and the measures of the photograph.

use maud::{Markup, html};
use slcal_core::decode::DecodeReport;

use super::number::{derived, fixed, significant};
use super::page::Section;
use super::verdict::sentence;
use crate::picture::stripes::thousands;
use crate::summary;

/// What the reasons mean, in the order of [`Rejected::reasons`](slcal_core::decode::Rejected::reasons).
const WHY_REJECTED: [&str; 5] = [
    "contrast too low for the noise, or an edge is missing",
    "the scanlines of its stripe do not agree on a slit, or too few were decoded",
    "its neighbour on the scanline has the same slit and at least as much support",
    "cut by an outline or a shadow, so that the centre of its slit is unknown",
    "too few neighbouring scanlines confirm its slit",
];

pub(super) fn section(report: &DecodeReport) -> Section {
    let remarks = summary::remarks(report);
    let share = |n: usize| 100.0 * n as f64 / report.crossings.max(1) as f64;
    let explained =
        report.rejected.reasons().into_iter().zip(WHY_REJECTED).map(|((name, n), why)| (name, n, why));
    let counts = std::iter::once(("decoded", report.decoded, "became matches")).chain(explained);
    let content = html! {
        @if !remarks.is_empty() {
            ul.warnings { @for (label, remark) in &remarks {
                li { p { strong { (sentence(label).trim_end_matches('.')) ": " } (sentence(remark)) } }
            } }
        }
        h3 { (thousands(report.crossings)) " stripe crossings on scanlines" }
        div.scroll { table {
            thead { tr {
                th scope="col" { "" } th.number scope="col" { "crossings" } th.number scope="col" { "%" } th scope="col" { "reason" }
            } }
            tbody { @for (name, count, why) in counts {
                tr {
                    th scope="row" { (name) }
                    td.number { (derived(&format!("decode.{}", name.replace(' ', "_")), count as f64, &thousands(count))) }
                    td.number { (fixed(share(count), 1)) }
                    td.aside { (why) }
                }
            } }
        } }
        h3 { "The photograph" }
        (measures(report))
        @if let Some(matrix) = &report.crosstalk { (crosstalk(matrix)) }
    };
    Section { id: "decoding", title: "Decoding", content }
}

/// Measures of the photograph, and how to judge them.
fn measures(report: &DecodeReport) -> Markup {
    let rows = [
        ("Different slits", thousands(report.slits), "", "few: the camera sees only a part of the pattern"),
        (
            "Width of a stripe",
            fixed(report.stripe_width_px, 1),
            "px",
            "below 3: move nearer, or project fewer slits",
        ),
        (
            "Stripe width over slit width as drawn",
            fixed(report.width_ratio, 2),
            "",
            "1 to 1.2 in a sharp photograph",
        ),
        (
            "Noise of a pixel",
            fixed(report.noise_levels, 1),
            "levels of 255",
            "above 4: use more light or a lower gain",
        ),
        ("Overexposed", fixed(100.0 * report.saturated, 1), "%", "above 5: expose less"),
        ("Scatter of the colours", significant(report.hue_spread_rad, 2), "rad", "above 0.2: hues overlap"),
        (
            "Code fit per crossing",
            fixed(report.code_fit, 1),
            "nats",
            "2.4 is perfect for four hues; below 1 is doubtful",
        ),
    ];
    html! {
        div.scroll { table {
            thead { tr { th scope="col" { "" } th.number scope="col" { "value" } th scope="col" { "unit" } th scope="col" { "guide" } } }
            tbody { @for (name, value, unit, judge) in rows {
                tr { th scope="row" { (name) } td.number { (value) } td.aside { (unit) } td.aside { (judge) } }
            } }
        } }
    }
}

fn crosstalk(matrix: &[[f64; 3]; 3]) -> Markup {
    const NAMES: [&str; 3] = ["red", "green", "blue"];
    html! {
        h3 { "Crosstalk: the camera’s response to the projector’s colours" }
        div.scroll { table.narrow {
            thead { tr {
                th scope="col" { "camera’s" }
                @for name in NAMES { th.number scope="col" { "projector’s " (name) } }
            } }
            tbody { @for (name, row) in NAMES.iter().zip(matrix) {
                tr { th scope="row" { (name) } @for x in row { td.number { (fixed(*x, 2)) } } }
            } }
        } }
        p.note { "Each column is scaled so that the channel with the strongest response has 1. Up to 0.3 elsewhere is harmless." }
    }
}
