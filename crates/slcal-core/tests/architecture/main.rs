//! The arrows between modules point one way, and `docs/architecture.md` draws all of them.

mod arrows;
mod planted;
mod source;
mod table;

use std::fs;
use std::path::{Path, PathBuf};

use source::{Modules, modules, read};

const CRATES: [&str; 3] = ["slcal-core", "slcal-cli", "slcal-py"];

fn sources(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name(name).join("src")
}

fn core() -> Modules {
    modules(&read(&sources("slcal-core")))
}

fn page() -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/architecture.md")).unwrap()
}

#[test]
fn modules_use_what_the_table_of_the_documentation_says() {
    let wrong = table::disagreements(&table::rows(&page(), "## Who uses whom"), &core(), &[]);
    assert!(wrong.is_empty(), "docs/architecture.md and crates/slcal-core/src disagree: {wrong:#?}");
}

#[test]
fn calibration_uses_its_parts_in_the_order_of_the_documentation() {
    let table = table::rows(&page(), "### Within `calibrate`");
    let wrong = table::disagreements(&table, &core(), &["calibrate".into()]);
    assert!(
        wrong.is_empty(),
        "docs/architecture.md and crates/slcal-core/src/calibrate disagree: {wrong:#?}"
    );
}

#[test]
fn no_file_uses_one_that_uses_it() {
    for name in CRATES {
        let circles = arrows::circles(&modules(&read(&sources(name))));
        assert!(circles.is_empty(), "{name}: {circles:#?}");
    }
}

/// Bindings and capture programs hand the library's advice to people who have no command line.
#[test]
fn messages_name_no_options_of_the_command() {
    let is_option = |after: &str| after.starts_with(|c: char| c.is_ascii_lowercase());
    let mut wrong = Vec::new();
    for (file, text) in read(&sources("slcal-core")) {
        for (i, line) in text.lines().enumerate().filter(|(_, l)| !l.trim_start().starts_with("//")) {
            // What is written for other programs, and said of them, may name their options.
            let of_others = file.contains("exchange/") && !line.contains("slcal ");
            if !of_others && line.split("--").skip(1).any(is_option) {
                wrong.push(format!("{file}:{}: {}", i + 1, line.trim()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
