//! The head of the page: how good it is, why, what that means and what to do, for somebody who sees it for the first time.

use maud::{Markup, html};
use slcal_core::pattern::Axis;
use slcal_core::reconstruct::length_sigma;
use slcal_core::{Match, Rig, Verdict};

use super::Subject;
use super::number::{derived, field, fixed, significant};

/// How a verdict looks: never by its colour alone.
struct Look {
    class: &'static str,
    symbol: &'static str,
    word: &'static str,
    /// What it allows.
    lead: &'static str,
}

fn look(rig: &Rig) -> Look {
    let (class, symbol, word, lead) = match rig.quality.as_ref().map(|q| q.verdict) {
        Some(Verdict::Good) => (
            "good",
            "✓",
            "Good",
            "Shapes and lengths that are measured with it can be relied on, within their ±.",
        ),
        Some(Verdict::Fair) => (
            "fair",
            "≈",
            "Fair",
            "Good enough for projection mapping and rough shapes; lengths may be off by several per cent.",
        ),
        Some(Verdict::Weak) => ("weak", "!", "Weak", "Good for a look; treat all lengths as rough."),
        Some(Verdict::Degenerate) => (
            "degenerate",
            "✕",
            "Degenerate",
            "Do not rely on any of this: the photographs do not determine the focal length.",
        ),
        None => (
            "none",
            "?",
            "No verdict",
            "This rig does not say how sure its numbers are, as those that slcal calibrates do.",
        ),
    };
    let lead = match rig.quality.as_ref().map(|q| q.verdict) {
        Some(Verdict::Good) if rig.projector.is_none() => {
            "Directions that are seen with it can be relied on, within their ±."
        }
        _ => lead,
    };
    Look { class, symbol, word, lead }
}

/// The title of the page.
pub(super) fn title(subject: &Subject) -> String {
    let word = look(subject.rig).word.to_lowercase();
    format!("{}: {word} – slcal", subject.name())
}

pub(super) fn head(subject: &Subject) -> Markup {
    let rig = subject.rig;
    let look = look(rig);
    html! {
        div class={ "verdict " (look.class) } {
            h1 {
                span.what { @if rig.projector.is_some() { "Camera and projector" } @else { "Camera" } " · " (subject.name()) }
                span.word { span.symbol aria-hidden="true" { (look.symbol) } " " (look.word) }
            }
            p.lead { (look.lead) }
            (tiles(rig))
            (reasons(rig))
        }
    }
}

/// The few numbers that the verdict rests on.
fn tiles(rig: &Rig) -> Markup {
    let Some(quality) = &rig.quality else { return html! {} };
    let percent = |path: &str, value: f64| field(path, value, &significant(value, 2));
    html! {
        ul.tiles {
            li {
                span.value { "± " (percent("quality.focal_sigma_percent.camera", quality.focal_sigma_percent_camera)) " %" }
                span.label { "focal length of the camera" }
            }
            @if let Some(sigma) = quality.focal_sigma_percent_projector {
                li {
                    span.value { "± " (percent("quality.focal_sigma_percent.projector", sigma)) " %" }
                    span.label { "focal length of the projector" }
                }
            }
            @if let Some(sigma) = quality.expected_point_sigma_mm {
                li {
                    span.value { "± " (field("quality.expected_point_sigma_mm", sigma, &significant(sigma, 2))) " mm" }
                    span.label { "place of a point at the sheet, along the line of sight" }
                }
            }
            li {
                span.value { (rig.views.len()) }
                span.label { @if rig.views.len() == 1 { "photograph" } @else { "photographs" } }
            }
        }
    }
}

/// Why, what it means, what to do.
fn reasons(rig: &Rig) -> Markup {
    let Some(quality) = &rig.quality else {
        return html! {
            dl.reasons {
                dt { "What to do next" }
                dd { "Calibrate with slcal, or check the rig: " code { "slcal verify" } " tells whether it fits a photograph." }
            }
        };
    };
    html! {
        dl.reasons {
            @if !quality.cause.is_empty() { dt { "Why" } dd { (sentence(&quality.cause)) } }
            dt { "What it means" }
            dd { (meaning(rig)) }
            @if !quality.advice.is_empty() { dt { "What to do next" } dd { (sentence(&quality.advice)) } }
        }
    }
}

/// What the numbers mean for somebody who measures with the rig.
fn meaning(rig: &Rig) -> Markup {
    let distance = rig.views.first().map(|_| sheet_distance_mm(rig));
    let sigma = rig.quality.as_ref().and_then(|q| q.expected_point_sigma_mm);
    html! {
        @if let (Some(sigma), Some(distance)) = (sigma, distance) {
            "A point at the sheet’s distance (" (derived("sheet_distance_mm", distance, &fixed(distance, 0)))
            " mm) comes out within " (significant(sigma, 2)) " mm of its true place along the line of sight, "
            (significant(100.0 * sigma / distance, 2)) " % of that distance. Most of that is common to all points, so that sizes and "
            "shapes are surer: "
            @match lengths(rig) {
                Some((length, [across, along])) => {
                    "a length of " (fixed(length, 0)) " mm there comes out within "
                    (derived("length_across_sigma_mm", across, &significant(across, 2))) " mm when it lies across the line of sight, and within "
                    (derived("length_along_sigma_mm", along, &significant(along, 2))) " mm when it lies along it, beside how well its ends can be told. "
                }
                None => "a flat thing comes out flat. ",
            }
        } @else if rig.projector.is_none() {
            "Directions in the photograph are known; there is no projector in this rig, so no points can be measured. "
        }
        "Every ± on this page is one standard deviation: the truth lies within it about two times in three, and within "
        "twice of it 19 times in 20."
    }
}

/// A length in the middle of the first sheet, and its σ across and along the line of sight, mm.
fn lengths(rig: &Rig) -> Option<(f64, [f64; 2])> {
    let view = rig.views.first()?;
    let (w, h) = (view.size.width_mm, view.size.height_mm);
    let middle = view.camera_from_sheet.transform(&nalgebra::Point3::new(w / 2.0, h / 2.0, 0.0));
    // As long as things are that one measures there: a quarter of the sheet, in round numbers.
    let length = [1000.0, 100.0, 10.0].into_iter().find(|l| *l <= w.max(h) / 2.0)?;
    let along = middle.coords.try_normalize(0.0)?;
    let across = nalgebra::Vector3::y().cross(&along).try_normalize(0.0)?;
    let sigma = |direction: nalgebra::Vector3<f64>| {
        let step = direction * (length / 2.0);
        let ends = [middle - step, middle + step];
        let found = length_sigma(rig, Axis::Columns, Match::DEFAULT_SIGMA_PX, ends).ok()??;
        Some(found.total_mm())
    };
    Some((length, [sigma(across)?, sigma(along)?]))
}

/// The rig behind a cloud.
pub(super) fn in_a_line(rig: &Rig, name: &str) -> Markup {
    let look = look(rig);
    html! {
        span class=(look.class) { strong.mark { (look.symbol) " " (look.word) } }
        @if !name.is_empty() { " (" span.file { (name) } ")" }
        ": " (look.lead)
        @if let Some(quality) = rig.quality.as_ref().filter(|q| !q.cause.is_empty()) { " " (sentence(&quality.cause)) }
    }
}

/// Mean distance of the sheets' centres from the camera, mm.
pub(super) fn sheet_distance_mm(rig: &Rig) -> f64 {
    let distances = rig.views.iter().map(|v| {
        let centre = nalgebra::Point3::new(v.size.width_mm / 2.0, v.size.height_mm / 2.0, 0.0);
        v.camera_from_sheet.transform(&centre).coords.norm()
    });
    distances.sum::<f64>() / rig.views.len().max(1) as f64
}

/// A clause of the library as a sentence.
pub(super) fn sentence(clause: &str) -> String {
    let mut letters = clause.chars();
    // σ has no capital that means the same.
    let first = letters.next().map(|c| if c.is_ascii() { c.to_ascii_uppercase() } else { c });
    let text: String = first.into_iter().chain(letters).collect();
    if text.ends_with(['.', '!', '?']) { text } else { text + "." }
}
