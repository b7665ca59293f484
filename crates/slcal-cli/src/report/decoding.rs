//! What decoding saw in the photograph, and why it left some of it out.

use maud::{Markup, html};
use slcal_core::decode::DecodeReport;

use super::number::{derived, fixed, significant};
use super::page::Section;
use super::verdict::sentence;
use crate::picture::stripes::thousands;
use crate::summary;

pub(super) fn section(report: &DecodeReport) -> Section {
    let remarks = summary::remarks(report);
    let d = &report.rejected;
    let share = |n: usize| 100.0 * n as f64 / report.crossings.max(1) as f64;
    let counts = [
        ("decoded", report.decoded, "became matches"),
        ("weak", d.low_contrast, "too little contrast, or a bright band without two edges"),
        ("ambiguous", d.ambiguous, "no place in the code that its neighbours agree on"),
        ("inconsistent", d.duplicate, "its neighbour has the same number, with better reason"),
        ("cut", d.truncated, "an outline or a shadow cuts it, so that its centre cannot be told"),
        ("unsure", d.low_confidence, "too few of the lines about it agree"),
    ];
    let content = html! {
        @if !remarks.is_empty() {
            ul.warnings { @for (label, remark) in &remarks {
                li { p { strong { (sentence(label).trim_end_matches('.')) ": " } (sentence(remark)) } }
            } }
        }
        h3 { (thousands(report.crossings)) " crossings of image lines with stripes" }
        div.scroll { table {
            thead { tr {
                th scope="col" { "" } th.number scope="col" { "crossings" } th.number scope="col" { "%" } th scope="col" { "because" }
            } }
            tbody { @for (name, count, why) in counts {
                tr {
                    th scope="row" { (name) }
                    td.number { (derived(&format!("decode.{name}"), count as f64, &thousands(count))) }
                    td.number { (fixed(share(count), 1)) }
                    td.aside { (why) }
                }
            } }
        } }
        h3 { "The photograph" }
        (measures(report))
        @if let Some(matrix) = &report.crosstalk { (crosstalk(matrix)) }
    };
    Section { id: "decoding", title: "Stripes", content }
}

/// What was measured, and what is usual.
fn measures(report: &DecodeReport) -> Markup {
    let rows = [
        ("Different slits", thousands(report.slits), "", "few: the camera sees a part of the pattern only"),
        (
            "Width of a stripe",
            fixed(report.stripe_width_px, 1),
            "px",
            "below 3: come nearer, or project fewer slits",
        ),
        ("As photographed over as drawn", fixed(report.width_ratio, 2), "", "1 to 1.2 when all is sharp"),
        (
            "Noise of a pixel",
            fixed(report.noise_levels, 1),
            "levels of 255",
            "above 4: more light, a lower gain",
        ),
        ("Overexposed", fixed(100.0 * report.saturated, 1), "%", "above 5: expose less"),
        ("Scatter of the colours", significant(report.hue_spread_rad, 2), "rad", "above 0.2 hues overlap"),
        (
            "How well the code fits",
            fixed(report.code_fit, 1),
            "nats",
            "2.4 is perfect for four hues, below 1 doubtful",
        ),
    ];
    html! {
        div.scroll { table {
            thead { tr { th scope="col" { "" } th.number scope="col" { "value" } th scope="col" { "unit" } th scope="col" { "to judge it" } } }
            tbody { @for (name, value, unit, judge) in rows {
                tr { th scope="row" { (name) } td.number { (value) } td.aside { (unit) } td.aside { (judge) } }
            } }
        } }
    }
}

fn crosstalk(matrix: &[[f64; 3]; 3]) -> Markup {
    const NAMES: [&str; 3] = ["red", "green", "blue"];
    html! {
        h3 { "What the camera’s channels see of the projector’s colours" }
        div.scroll { table.narrow {
            thead { tr {
                th scope="col" { "camera’s" }
                @for name in NAMES { th.number scope="col" { "projector’s " (name) } }
            } }
            tbody { @for (name, row) in NAMES.iter().zip(matrix) {
                tr { th scope="row" { (name) } @for x in row { td.number { (fixed(*x, 2)) } } }
            } }
        } }
        p.note { "1 in every column is the channel that sees most of it. Up to 0.3 in others is harmless." }
    }
}
