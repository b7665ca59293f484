//! The head of the page: how good it is, why, what that means and what to do, for somebody who sees it for the first time.

use maud::{Markup, html};
use slcal_core::pattern::Axis;
use slcal_core::{Quality, Rig, Verdict};

use super::number::{derived, field, fixed, significant};
use super::rig_page::RigPage;
use super::working_volume::{WorkingVolume, lengths, stripes};

/// How a verdict looks: never by its colour alone.
struct VerdictStyle {
    class: &'static str,
    symbol: &'static str,
    word: &'static str,
    /// What it allows.
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

/// What the verdict allows.
fn lead(rig: &Rig) -> String {
    let Some(quality) = &rig.quality else {
        return "This rig does not say how sure its numbers are, as those that slcal calibrates do.".into();
    };
    let warned = |code: &str| quality.warnings.iter().any(|w| w.code == code);
    let text = match quality.verdict {
        Verdict::Good if noise_alone(rig) => "The measurements determine it well.",
        Verdict::Good if rig.projector.is_none() => {
            "Directions that are seen with it can be relied on, within their ±."
        }
        Verdict::Good => "Shapes and lengths that are measured with it can be relied on, within their ±.",
        Verdict::Fair => {
            "Good enough for projection mapping and rough shapes; lengths may be off by several per cent."
        }
        Verdict::Weak => "Good for a look; treat all lengths as rough.",
        Verdict::Degenerate if warned("focal-length-outlandish") => {
            "Do not rely on any of this: the focal length came out as that of no ordinary lens."
        }
        Verdict::Degenerate if of_sigma(quality) == Verdict::Degenerate => {
            "Do not rely on any of this: the photographs do not determine the focal length."
        }
        Verdict::Degenerate => "Do not rely on any of this.",
    };
    if noise_alone(rig) && quality.verdict != Verdict::Degenerate {
        return format!(
            "{text} But its ± holds the noise alone: principal points are taken as exact and lenses as undistorted, and what these \
             are off by comes on top."
        );
    }
    text.into()
}

/// Whether σ leaves out what is not known of principal points: so does the method of the two vanishing points.
fn noise_alone(rig: &Rig) -> bool {
    rig.method == "two-vp"
}

/// The verdict that the focal lengths' σ alone would give.
fn of_sigma(quality: &Quality) -> Verdict {
    let worst = quality.focal_sigma_percent_projector.map_or(quality.focal_sigma_percent_camera, |p| {
        // NaN counts as worst.
        if p <= quality.focal_sigma_percent_camera { quality.focal_sigma_percent_camera } else { p }
    });
    Verdict::of_focal_sigma(worst / 100.0)
}

/// The title of the page.
pub(super) fn title(page: &RigPage) -> String {
    let word = verdict_style(page.rig).word.to_lowercase();
    format!("{}: {word} – slcal", page.name())
}

/// The head of the page; `working` is where one works with the rig.
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
            (tiles(rig, working))
            (reasons(rig, working))
        }
    }
}

/// The few numbers that the verdict rests on.
fn tiles(rig: &Rig, working: Option<&WorkingVolume>) -> Markup {
    let Some(quality) = &rig.quality else { return html! {} };
    // What was given is not measured: no ± of zero.
    let measured = |path: &str, value: f64, unit: &str| {
        html! {
            @if value == 0.0 { (field(path, value, "given")) }
            @else { "± " (field(path, value, &significant(value, 2))) (unit) }
        }
    };
    let rows = working.is_some_and(|w| w.axis == Axis::Rows);
    html! {
        ul.tiles {
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
            @if let Some(sigma) = quality.expected_point_sigma_mm {
                li {
                    span.value { (measured("quality.expected_point_sigma_mm", sigma, " mm")) }
                    span.label {
                        "place of a point at the sheet, along the line of sight" @if rows && sigma > 0.0 { ", under vertical stripes" }
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

/// Why, what it means, what to do.
fn reasons(rig: &Rig, working: Option<&WorkingVolume>) -> Markup {
    let Some(quality) = &rig.quality else {
        return html! {
            dl.reasons {
                dt { "What to do next" }
                dd { "Calibrate with slcal, or check the rig: " code { "slcal verify" } " tells whether it fits a photograph." }
            }
        };
    };
    let Quality { cause, advice, .. } = quality;
    html! {
        dl.reasons {
            @if !cause.is_empty() { dt { "Why" } dd { (sentence(cause)) } }
            // A ± that rests on a focal length that is not known means nothing.
            @if quality.verdict != Verdict::Degenerate { dt { "What it means" } dd { (meaning(rig, working)) } }
            @if !advice.is_empty() { dt { "What to do next" } dd { (sentence(advice)) } }
        }
    }
}

/// What the numbers mean for somebody who measures with the rig.
fn meaning(rig: &Rig, working: Option<&WorkingVolume>) -> Markup {
    html! {
        @if rig.projector.is_none() {
            "Directions in the photograph are known; there is no projector in this rig, so no points can be measured. "
        } @else if let Some(working) = working {
            (of_a_point(rig, working))
            @if let Some((length, [across, along])) = lengths(rig, working.axis) {
                "A length of " (fixed(length, 0)) " mm there is off by about ± "
                (derived("length_across_sigma_mm", across, &significant(across, 2))) " mm across and ± "
                (derived("length_along_sigma_mm", along, &significant(along, 2))) " mm along the line of sight (1σ), beside how well its "
                "ends can be told: the worst of the sheet’s surroundings. "
                @if !is_good(rig) { "Take that as rough: with a focal length as unsure as this, it may be several times more. " }
            }
        }
        @if noise_alone(rig) {
            "Every ± on this page is one standard deviation, and holds the noise of what was measured alone: principal points are taken \
             as exact and lenses as undistorted."
        } @else {
            "Every ± on this page is one standard deviation: the truth lies within it about two times in three, and within \
             twice of it 19 times in 20."
        }
    }
}

fn is_good(rig: &Rig) -> bool {
    rig.quality.as_ref().is_some_and(|q| q.verdict == Verdict::Good)
}

/// How sure a point is at the sheet, and what that is made of.
fn of_a_point(rig: &Rig, working: &WorkingVolume) -> Markup {
    let told = rig.quality.as_ref().and_then(|q| q.expected_point_sigma_mm).filter(|s| *s > 0.0);
    // The rig's own number is that of vertical stripes, over all sheets.
    let (sigma, distance) = match (told, working.axis) {
        (Some(told), Axis::Columns) if working.of_sheet => (told, sheet_distance_mm(rig)),
        _ => (working.sigma.sigma_mm, working.distance_mm),
    };
    html! {
        "A point " @if working.of_sheet { "at the sheet’s distance (" } @else { "in " (working.place_in_words()) " (at " }
        (derived("sheet_distance_mm", distance, &significant(distance, 4))) " mm), under " (stripes(working.axis)) ", is off by about ± "
        (derived("point_sigma_mm", sigma, &significant(sigma, 2))) " mm along the line of sight (1σ), "
        (significant(100.0 * sigma / distance, 2)) " % of that distance. "
        @if !working.knows_rig {
            "That is noise alone: what is not known of the rig itself is not in it. "
        } @else if working.rig_mm() > working.sigma.noise_mm {
            "Most of that is common to all points"
            // Of a weak rig, all lengths are rough.
            @if rig.quality.as_ref().is_none_or(|q| q.verdict <= Verdict::Fair) { ", so that sizes and shapes are surer" } ". "
        } @else {
            "Most of that is noise, which differs from point to point: it makes a surface rough, and the mean of many points is surer. "
        }
    }
}

/// The rig behind a cloud.
pub(super) fn in_a_line(rig: &Rig, name: &str) -> Markup {
    let style = verdict_style(rig);
    html! {
        span class=(style.class) { strong.mark { (style.symbol) " " (style.word) } }
        @if !name.is_empty() { " (" span.file { (name) } ")" }
        ": " (style.lead)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worse_focal_length_decides_and_what_is_no_number_is_worst() {
        let quality = |projector: f64| Quality {
            verdict: Verdict::Weak,
            focal_sigma_percent_camera: 1.0,
            focal_sigma_percent_projector: Some(projector),
            expected_point_sigma_mm: None,
            cause: String::new(),
            advice: String::new(),
            warnings: Vec::new(),
        };
        let found = [0.5, 12.0, f64::NAN].map(|p| of_sigma(&quality(p)));
        assert_eq!(found, [Verdict::Good, Verdict::Weak, Verdict::Degenerate]);
    }
}
