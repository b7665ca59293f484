//! The head of the page, for a first-time reader: the verdict, why, what it means and what to do next.

use maud::{Markup, html};
use slcal_core::pattern::Axis;
use slcal_core::{Quality, Rig, Verdict};

use super::number::{derived, field, fixed, significant};
use super::rig_page::RigPage;
use crate::summary::holds_while;
use crate::summary::working_volume::{WorkingVolume, lengths, sheet_distance_mm, stripes};

/// The appearance of a verdict: colour, symbol and word.
struct VerdictStyle {
    class: &'static str,
    symbol: &'static str,
    word: &'static str,
    /// What the calibration can be used for.
    lead: String,
}

fn verdict_style(rig: &Rig) -> VerdictStyle {
    let (class, symbol, word) = match rig.quality.as_ref().map(|q| q.verdict) {
        Some(Verdict::Good) => ("good", "✓", "Good"),
        Some(Verdict::Fair) => ("fair", "≈", "Fair"),
        Some(Verdict::Weak) => ("weak", "!", "Weak"),
        Some(Verdict::Degenerate) => ("degenerate", "✕", "Degenerate"),
        None => ("none", "?", "No verdict"),
    };
    VerdictStyle { class, symbol, word, lead: lead(rig) }
}

/// What the calibration can be used for.
fn lead(rig: &Rig) -> String {
    let Some(quality) = &rig.quality else {
        return "This rig states no verdict on its uncertainty; rigs that slcal calibrates do.".into();
    };
    let warned = |code: &str| quality.warnings.iter().any(|w| w.code == code);
    let text = match quality.verdict {
        Verdict::Good if noise_alone(rig) => "The measurements determine the calibration well.",
        Verdict::Good if rig.projector.is_none() => {
            "Directions that it measures are reliable within their ±."
        }
        Verdict::Good => "Shapes and lengths that it measures are reliable within their ±.",
        Verdict::Fair => {
            "Good enough for projection mapping and rough shapes; lengths may be off by several per cent."
        }
        Verdict::Weak => "Good for a quick look only; all lengths are rough.",
        Verdict::Degenerate if warned("focal-length-outlandish") => {
            "Do not use these numbers: the focal length is implausible for any ordinary lens."
        }
        Verdict::Degenerate if of_focal(quality) == Verdict::Degenerate => {
            "Do not use these numbers: the photographs do not determine the focal length."
        }
        Verdict::Degenerate if of_depth(quality) == Some(Verdict::Degenerate) => {
            "Do not use these numbers: the photographs do not determine the depth of points."
        }
        Verdict::Degenerate => "Do not use these numbers.",
    };
    if noise_alone(rig) && quality.verdict != Verdict::Degenerate {
        return format!(
            "{text} But its ± counts the noise of the measurements alone: the method assumes exact principal points and undistorted \
             lenses, and errors of these assumptions come on top."
        );
    }
    text.into()
}

/// Whether σ leaves out the uncertainty of principal points, as the two-vanishing-point method does.
fn noise_alone(rig: &Rig) -> bool {
    rig.method == "two-vp"
}

/// The verdict from the focal lengths' σ alone.
fn of_focal(quality: &Quality) -> Verdict {
    let worst = quality.focal_sigma_percent_projector.map_or(quality.focal_sigma_percent_camera, |p| {
        // NaN counts as worst.
        if p <= quality.focal_sigma_percent_camera { quality.focal_sigma_percent_camera } else { p }
    });
    Verdict::of_focal_sigma(worst / 100.0)
}

/// The verdict from the depth's σ alone.
fn of_depth(quality: &Quality) -> Option<Verdict> {
    quality.depth_sigma_percent.map(|percent| Verdict::of_focal_sigma(percent / 100.0))
}

/// The title of the page.
pub(super) fn title(page: &RigPage) -> String {
    let word = verdict_style(page.rig).word.to_lowercase();
    format!("{}: {word} – slcal", page.name())
}

/// The head of the page; `working` is a place in the working volume.
pub(super) fn head(page: &RigPage, working: Option<&WorkingVolume>) -> Markup {
    let rig = page.rig;
    let style = verdict_style(rig);
    html! {
        div class={ "verdict " (style.class) } {
            h1 {
                span.what { @if rig.projector.is_some() { "Camera and projector" } @else { "Camera" } " · " (page.name()) }
                span.word { span.symbol aria-hidden="true" { (style.symbol) } " " (style.word) }
            }
            p.lead { (style.lead) }
            (key_figures(rig, working))
            (reasons(rig, working))
        }
    }
}

/// The key figures behind the verdict.
fn key_figures(rig: &Rig, working: Option<&WorkingVolume>) -> Markup {
    let Some(quality) = &rig.quality else { return html! {} };
    // A given value has no ±.
    let measured = |path: &str, value: f64, unit: &str| {
        html! {
            @if value == 0.0 { (field(path, value, "given")) }
            @else { "± " (field(path, value, &significant(value, 2))) (unit) }
        }
    };
    let rows = working.is_some_and(|w| w.axis == Axis::Rows);
    html! {
        ul.key-figures {
            li {
                span.value { (measured("quality.focal_sigma_percent.camera", quality.focal_sigma_percent_camera, " %")) }
                span.label { "focal length of the camera" }
            }
            @if let Some(sigma) = quality.focal_sigma_percent_projector {
                li {
                    span.value { (measured("quality.focal_sigma_percent.projector", sigma, " %")) }
                    span.label { "focal length of the projector" }
                }
            }
            @if let Some(sigma) = quality.depth_sigma_percent {
                li {
                    span.value { (measured("quality.depth_sigma_percent", sigma, " %")) }
                    span.label { "depth at the sheet, by the calibration alone" }
                }
            }
            @if let Some(sigma) = quality.expected_point_sigma_mm {
                li {
                    span.value { (measured("quality.expected_point_sigma_mm", sigma, " mm")) }
                    span.label {
                        "depth of a point at the sheet, along the line of sight" @if rows && sigma > 0.0 { ", with vertical stripes" }
                    }
                }
            }
            li {
                span.value { (rig.views.len()) }
                span.label { @if rig.views.len() == 1 { "photograph" } @else { "photographs" } }
            }
        }
    }
}

/// Why, what it means, what to do, and how long it holds.
fn reasons(rig: &Rig, working: Option<&WorkingVolume>) -> Markup {
    let Some(quality) = &rig.quality else {
        return html! {
            dl.reasons {
                dt { "What to do next" }
                dd { "Calibrate with slcal, or check the rig with a photograph: " code { "slcal verify" } "." }
            }
        };
    };
    let Quality { cause, advice, .. } = quality;
    html! {
        dl.reasons {
            @if !cause.is_empty() { dt { "Why" } dd { (sentence(cause)) } }
            // A ± means nothing when the focal length is undetermined.
            @if quality.verdict != Verdict::Degenerate { dt { "What it means" } dd { (meaning(rig, working)) } }
            @if !advice.is_empty() { dt { "What to do next" } dd { (sentence(advice)) } }
            dt { "How long it holds" }
            dd { (sentence(holds_while(rig))) }
        }
    }
}

/// What the numbers mean for measurements with the rig.
fn meaning(rig: &Rig, working: Option<&WorkingVolume>) -> Markup {
    html! {
        @if rig.projector.is_none() {
            "The camera measures directions. This rig has no projector, so no points can be measured. "
        } @else if let Some(working) = working {
            (of_a_point(rig, working))
            @if let Some((length, [across, along])) = lengths(rig, working.axis) {
                "A length of " (fixed(length, 0)) " mm there is off by ± "
                (derived("length_across_sigma_mm", across, &significant(across, 2))) " mm across and ± "
                (derived("length_along_sigma_mm", along, &significant(along, 2))) " mm along the line of sight. This is the largest value "
                "around the sheet; how precisely the ends of the length can be located comes on top. "
                @if !is_good(rig) { "Take it as rough: with a calibration this uncertain, the error may be several times larger. " }
            }
        }
        @if noise_alone(rig) {
            "Every ± on this page is one standard deviation (1σ) and counts the noise of the measurements alone: principal points are \
             assumed exact and lenses undistorted."
        } @else {
            "Every ± on this page is one standard deviation (1σ): the true value lies within ± in about two of three cases, and within \
             twice ± in 19 of 20."
        }
    }
}

fn is_good(rig: &Rig) -> bool {
    rig.quality.as_ref().is_some_and(|q| q.verdict == Verdict::Good)
}

/// The uncertainty of a point at the sheet, and which part of it all points share.
fn of_a_point(rig: &Rig, working: &WorkingVolume) -> Markup {
    let stated = rig.quality.as_ref().and_then(|q| q.expected_point_sigma_mm).filter(|s| *s > 0.0);
    // The number in the rig is for vertical stripes, over all sheets.
    let (sigma, distance) = match (stated, working.axis) {
        (Some(stated), Axis::Columns) if working.of_sheet => (stated, sheet_distance_mm(rig)),
        _ => (working.sigma.sigma_mm, working.distance_mm),
    };
    html! {
        "A point " @if working.of_sheet { "at the sheet’s distance (" } @else { "in " (working.place_in_words()) " (at " }
        (derived("sheet_distance_mm", distance, &significant(distance, 4))) " mm), measured with " (stripes(working.axis)) ", is off by ± "
        (derived("point_sigma_mm", sigma, &significant(sigma, 2))) " mm along the line of sight, "
        (significant(100.0 * sigma / distance, 2)) " % of that distance. "
        @if !working.knows_rig {
            "That is noise alone; the uncertainty of the rig itself is not known. "
        } @else if working.rig_mm() > working.sigma.noise_mm {
            "Most of that is common to all points: it shifts and scales the cloud as a whole"
            // With a weak rig, all lengths are rough.
            @if rig.quality.as_ref().is_none_or(|q| q.verdict <= Verdict::Fair) { ", and lengths are off by much less" } ". "
        } @else {
            "Most of that is noise, which differs from point to point: it makes a surface rough, and averages out over many points. "
        }
    }
}

/// The verdict on the rig of a cloud.
pub(super) fn in_a_line(rig: &Rig, name: &str) -> Markup {
    let style = verdict_style(rig);
    html! {
        span class=(style.class) { strong.mark { (style.symbol) " " (style.word) } }
        @if !name.is_empty() { " (" span.file { (name) } ")" }
        ": " (style.lead)
        @if let Some(quality) = rig.quality.as_ref().filter(|q| !q.cause.is_empty()) { " " (sentence(&quality.cause)) }
    }
}

/// A message of the library as a sentence.
pub(crate) fn sentence(clause: &str) -> String {
    let mut letters = clause.chars();
    // The capital of σ means something else.
    let first = letters.next().map(|c| if c.is_ascii() { c.to_ascii_uppercase() } else { c });
    let text: String = first.into_iter().chain(letters).collect();
    if text.ends_with(['.', '!', '?']) { text } else { text + "." }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_larger_sigma_of_the_focal_lengths_counts_and_nan_is_degenerate() {
        let quality = |projector: f64| Quality {
            verdict: Verdict::Weak,
            focal_sigma_percent_camera: 1.0,
            focal_sigma_percent_projector: Some(projector),
            depth_sigma_percent: None,
            expected_point_sigma_mm: None,
            cause: String::new(),
            advice: String::new(),
            warnings: Vec::new(),
            assumptions: Vec::new(),
        };
        let found = [0.5, 12.0, f64::NAN].map(|p| of_focal(&quality(p)));
        assert_eq!(found, [Verdict::Good, Verdict::Weak, Verdict::Degenerate]);
    }
}
