//! What else was noticed, and what to type next.

use maud::{Markup, html};

use super::page::Section;
use super::verdict::sentence;
use super::{Subject, quoted};

/// The warnings with their advice.
pub(super) fn warnings(subject: &Subject) -> Option<Section> {
    let warnings = &subject.rig.quality.as_ref()?.warnings;
    let content = html! {
        @if warnings.is_empty() { p { "Nothing: no warnings." } }
        @else {
            ul.warnings { @for w in warnings {
                li {
                    p { strong { "Warning: " } (sentence(&w.message)) " " span.aside { "(" code { (w.code) } ")" } }
                    @if !w.advice.is_empty() { p { strong { "What to do: " } (sentence(&w.advice)) } }
                }
            } }
        }
    };
    Some(Section { id: "warnings", title: "What else was noticed", content })
}

/// The commands that led here, and those that lead on.
pub(super) fn commands(subject: &Subject) -> Option<Section> {
    let next = following(subject);
    (!subject.made_by.is_empty() || !next.is_empty()).then(|| listings(&subject.made_by, &next))
}

/// Commands to look at and to copy.
pub(super) fn listings(made_by: &[String], next: &[(&'static str, String)]) -> Section {
    let content = html! {
        @if !made_by.is_empty() {
            h3 { "Made by" }
            (listing(&made_by.join("\n")))
        }
        @if !next.is_empty() {
            h3 { "To go on" }
            dl.next { @for (what, command) in next { dt { (what) } dd { (listing(command)) } } }
        }
    };
    Section { id: "commands", title: "Commands", content }
}

fn listing(text: &str) -> Markup {
    html! {
        div.listing {
            pre tabindex="0" { code { (text) } }
            button.copy.screen-only type="button" hidden { "Copy" }
        }
    }
}

/// What one does with such a rig, with the names of its files.
fn following(subject: &Subject) -> Vec<(&'static str, String)> {
    let rig = quoted(&subject.rig_name);
    let mut next = Vec::new();
    if subject.rig_name.is_empty() {
        return next;
    }
    let checker = subject.checker_name.as_deref().map_or_else(|| "checker.json".to_owned(), quoted);
    if subject.rig.projector.is_none() {
        next.push(("Which photograph to take next", format!("slcal advise --rig {rig}")));
        return next;
    }
    next.push((
        "See what the next photograph would bring",
        format!("slcal advise --rig {rig} --pattern {checker}"),
    ));
    next.push((
        "Measure something: photograph it under the stripes",
        format!("slcal reconstruct --rig {rig} --pattern stripes.json object.jpg -o cloud.ply --mesh --report cloud.html"),
    ));
    next.push((
        "Later: is the rig still as it was?",
        format!("slcal verify --rig {rig} --pattern {checker} --as-drawn photo.jpg"),
    ));
    next.push((
        "Project without keystone",
        format!("slcal rectify --rig {rig} --pattern {checker} -o straight.png"),
    ));
    next
}
