//! The frame of the page: head, style, scripts and the policy that keeps the page to itself.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use sha2::{Digest as _, Sha256};

const STYLE: &str = concat!(include_str!("style.css"), include_str!("../cloud_view/cloud_view.css"));
/// The view of what is in space, and what starts it: a module in one element.
const SCRIPT: &str = concat!(include_str!("../cloud_view/cloud_view.js"), include_str!("script.js"));

/// A part of the report with a heading of its own.
pub(super) struct Section {
    pub(super) id: &'static str,
    pub(super) title: &'static str,
    pub(super) content: Markup,
}

/// The whole file: the head of the page is `verdict`.
pub(super) fn html(title: &str, verdict: &Markup, sections: &[Section]) -> Vec<u8> {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(policy());
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta name="generator" content=(concat!("slcal ", env!("CARGO_PKG_VERSION")));
                title { (title) }
                // Browsers would ask for /favicon.ico.
                link rel="icon" href="data:,";
                style { (PreEscaped(STYLE)) }
            }
            body {
                header { (verdict) }
                nav.screen-only aria-label="Sections" {
                    ul { @for section in sections { li { a href={ "#" (section.id) } { (section.title) } } } }
                }
                main {
                    @for section in sections {
                        section id=(section.id) aria-labelledby={ (section.id) "-title" } {
                            h2 id={ (section.id) "-title" } { (section.title) }
                            (section.content)
                        }
                    }
                }
                footer {
                    p { "Made by slcal " (env!("CARGO_PKG_VERSION")) ". This file is self-contained: it needs no network and no other files." }
                }
                script type="module" { (PreEscaped(SCRIPT)) }
            }
        }
    };
    page.into_string().into_bytes()
}

/// Nothing is loaded from anywhere, and no script runs but the one whose digest stands here.
fn policy() -> String {
    let digest = STANDARD.encode(Sha256::digest(SCRIPT.as_bytes()));
    format!(
        "default-src 'none'; script-src 'sha256-{digest}'; style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; \
         form-action 'none'"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_are_escaped() {
        let title = "<script>alert(1)</script>\"'";
        let page = html(title, &html! { p { (title) } }, &[]);
        let text = String::from_utf8(page).unwrap();
        assert_eq!(text.matches("<script").count(), 1);
    }

    #[test]
    fn the_script_cannot_end_its_element() {
        assert!(!SCRIPT.contains("</script") && !SCRIPT.contains("<!--"));
    }
}
