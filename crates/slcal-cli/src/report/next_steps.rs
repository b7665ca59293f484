//! Warnings, and the commands to run next.

use maud::{Markup, html};
use slcal_core::{Rig, Warning};

use super::command_line::quoted;
use super::page::Section;
use super::rig_page::RigPage;
use super::verdict::sentence;

/// The warnings with their advice.
pub(super) fn warnings(page: &RigPage) -> Option<Section> {
    let warnings = &page.rig.quality.as_ref()?.warnings;
    let content = html! {
        @if warnings.is_empty() { p { "None." } }
        @else { (listed(warnings)) }
    };
    Some(Section { id: "warnings", title: "Warnings", content })
}

/// Warnings with what to do about them.
pub(super) fn listed(warnings: &[Warning]) -> Markup {
    html! {
        ul.warnings { @for w in warnings {
            li {
                p { strong { "Warning: " } (sentence(&w.message)) " " span.aside { "(" code { (w.code) } ")" } }
                @if !w.advice.is_empty() { p { strong { "What to do: " } (sentence(&w.advice)) } }
            }
        } }
    }
}

/// The commands that were run, and those to run next.
pub(super) fn commands(page: &RigPage) -> Option<Section> {
    let next = following(page);
    (!page.made_by.is_empty() || !next.is_empty()).then(|| listings(&page.made_by, &next))
}

/// Commands to read and copy.
pub(super) fn listings(made_by: &[String], next: &[(&'static str, String)]) -> Section {
    let content = html! {
        @if !made_by.is_empty() {
            h3 { "Created by" }
            (listing(&made_by.join("\n")))
        }
        @if !next.is_empty() {
            h3 { "Next" }
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

/// The name of a rig that was read from stdin: no command can name it.
pub(super) const PIPED: &str = "stdin";

/// The commands that this rig is sufficient for, with the names of its files.
fn following(page: &RigPage) -> Vec<(&'static str, String)> {
    let mut next = Vec::new();
    if page.rig_name.is_empty() || page.rig_name == PIPED {
        return next;
    }
    let rig = file_word(&page.rig_name);
    let pattern = page.checker_name.as_deref().filter(|name| *name != PIPED).map(file_word);
    let checker = pattern.as_deref().unwrap_or("checker.json");
    let sheet_known = !page.rig.views.is_empty();
    let can_advise = sheet_known && page.rig.covariance.is_some();
    if page.rig.projector.is_none() {
        if can_advise {
            next.push(("Find the best next photograph", format!("slcal advise --rig {rig}")));
        }
        return next;
    }
    if can_advise {
        // Without a pattern, advise takes the default one.
        let with = pattern.as_ref().map(|p| format!(" --pattern {p}")).unwrap_or_default();
        next.push(("Find the best next photograph", format!("slcal advise --rig {rig}{with}")));
    }
    next.push((
        "Measure an object: photograph it under the stripes",
        format!("slcal reconstruct --rig {rig} --pattern stripes.json object.jpg -o cloud.ply --mesh --report cloud.html"),
    ));
    next.extend(many_shots(page.rig, &rig));
    if sheet_known {
        next.push((
            "Later: check that the rig has not moved",
            format!("slcal verify --rig {rig} --pattern {checker} --as-drawn photo.jpg"),
        ));
        next.push((
            "Project a picture without keystone",
            format!("slcal rectify --rig {rig} --pattern {checker} -o straight.png"),
        ));
    }
    next
}

/// A point per pixel of what does not move: the sequence codes what lies along the baseline.
fn many_shots(rig: &Rig, rig_name: &str) -> Option<(&'static str, String)> {
    let projector = rig.projector.as_ref()?;
    let ([w, h], t) = (projector.device.model.size(), projector.from_camera.pose.translation);
    let axis = if t.x.abs() >= t.y.abs() { "" } else { " --axis rows" };
    let draw = format!("slcal pattern phase --projector {w}x{h}{axis} --out-dir phase");
    let scan = format!(
        "slcal reconstruct --rig {rig_name} --pattern phase/sequence.json scan -o scan.ply --mesh --report scan.html"
    );
    let what = "Measure what does not move with a point per pixel: show the pictures of a sequence one after another, photograph each \
                into the folder scan";
    Some((what, format!("{draw}\n{scan}")))
}

/// The name of a file as a word of a command: never read as an option, nor expanded by a shell (`=name` in zsh).
pub(super) fn file_word(name: &str) -> String {
    let word = if name.starts_with('-') { quoted(&format!("./{name}")) } else { quoted(name) };
    if word.starts_with('=') { format!("'{word}'") } else { word }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_are_words_of_a_command() {
        assert_eq!(file_word("rig.json"), "rig.json");
        assert_eq!(file_word("-rig.json"), "./-rig.json");
        assert_eq!(file_word("-my rig.json"), "'./-my rig.json'");
        assert_eq!(file_word("=rig.json"), "'=rig.json'");
        assert_eq!(file_word("=it's"), "'=it'\\''s'");
    }
}
