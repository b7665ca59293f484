//! The pages, as they are built into the binary.

use include_dir::{Dir, include_dir};

static WEB: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/src/studio/web");
/// The view that reports use as well.
static CLOUD_VIEW: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/src/cloud_view");

/// The kind of a file and its content, by its name.
pub(super) fn file(name: &str) -> Option<(&'static str, &'static [u8])> {
    let kind = match name.rsplit_once('.')?.1 {
        "html" => "text/html; charset=utf-8",
        "js" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "svg" => "image/svg+xml",
        _ => return None,
    };
    let found = WEB.get_file(name).or_else(|| CLOUD_VIEW.get_file(name))?;
    Some((kind, found.contents()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_are_there_and_nothing_else() {
        for page in ["index.html", "display.html", "camera.html", "cloud_view.js"] {
            assert!(file(page).is_some_and(|(_, content)| !content.is_empty()), "{page}");
        }
        for other in ["mod.rs", "../mod.rs", "", "none.js", "/etc/passwd"] {
            assert!(file(other).is_none(), "{other}");
        }
    }

    #[test]
    fn pages_ask_nothing_of_other_hosts() {
        for found in WEB.files().chain(CLOUD_VIEW.files()) {
            let Some(text) = found.contents_utf8() else { continue };
            let names =
                text.match_indices("://").map(|(i, _)| &text[i.saturating_sub(5)..(i + 40).min(text.len())]);
            for name in names {
                assert!(
                    name.contains("w3.org") || name.contains("://$"),
                    "{}: {name}",
                    found.path().display()
                );
            }
        }
    }
}
