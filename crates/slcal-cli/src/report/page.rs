//! The frame of the page: head, style, scripts and the policy that keeps the page to itself.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use plotly::Plot;
use sha2::{Digest as _, Sha256};

use super::figure::Figures;

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");
/// plotly measures letters by reading its canvas back; browsers warn unless this is said beforehand.
const BEFORE: &str = "(() => { const get = HTMLCanvasElement.prototype.getContext; HTMLCanvasElement.prototype.getContext = function \
                      (kind, options) { return get.call(this, kind, kind === '2d' ? { ...options, willReadFrequently: true } : \
                      options); }; })();";

/// A part of the report with a heading of its own.
pub(super) struct Section {
    pub(super) id: &'static str,
    pub(super) title: &'static str,
    pub(super) content: Markup,
}

/// The whole file: the head of the page is `verdict`.
pub(super) fn html(title: &str, verdict: &Markup, sections: &[Section], figures: &Figures) -> Vec<u8> {
    let library = if figures.is_empty() { String::new() } else { plotly_js() };
    let scripts: &[&str] = if figures.is_empty() { &[] } else { &[BEFORE, &library, SCRIPT] };
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(policy(scripts));
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
                @if !figures.is_empty() {
                    noscript { p.note { "The plots need JavaScript; everything else works without it." } }
                    script type="application/json" id="figures" { (PreEscaped(figures.json())) }
                    // Read by the last script, once the page is shown.
                    script type="text/plain" id="plotly" { (PreEscaped(&library)) }
                    @for script in [BEFORE, SCRIPT] { script { (PreEscaped(script)) } }
                }
            }
        }
    };
    page.into_string().into_bytes()
}

/// plotly.js out of the crate's script elements; MathJax, which comes after it, is not used here.
fn plotly_js() -> String {
    let mut elements = Plot::offline_js_sources();
    let start = elements.find('>').map_or(0, |i| i + 1);
    let end = elements.find("</script>").unwrap_or(elements.len());
    elements.truncate(end);
    elements.split_off(start.min(end))
}

/// Nothing is loaded from anywhere, and no script runs but those whose digests stand here.
fn policy(scripts: &[&str]) -> String {
    let digest = |s: &&str| format!("'sha256-{}'", STANDARD.encode(Sha256::digest(s.as_bytes())));
    let scripts: Vec<String> = scripts.iter().map(digest).collect();
    let scripts = if scripts.is_empty() { "'none'".to_owned() } else { scripts.join(" ") };
    // plotly.js makes its own style elements and attributes, and pictures of its plots.
    format!(
        "default-src 'none'; script-src {scripts}; style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; \
         form-action 'none'"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_is_plotly_alone_and_whole() {
        let library = plotly_js();
        assert!(library.trim_start().starts_with("/**\n* plotly.js"), "{}", &library[..60]);
        assert!(library.trim_end().ends_with(';'));
        assert!(!library.contains("</script"), "it would end its element");
        assert!((3_000_000..5_000_000).contains(&library.len()), "{}", library.len());
    }

    #[test]
    fn titles_are_escaped() {
        let title = "<script>alert(1)</script>\"'";
        let page = html(title, &html! { p { (title) } }, &[], &Figures::default());
        let text = String::from_utf8(page).unwrap();
        assert!(!text.contains("<script"));
        assert!(text.contains("script-src 'none'"));
    }
}
