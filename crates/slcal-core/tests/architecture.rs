//! The arrows between the folders point one way.

use std::fs;
use std::path::{Path, PathBuf};

/// Which folders each folder may use, a folder within another by rules of its own. What is not listed here meets in the plain types at the top of the crate.
const MAY_USE: [(&str, &[&str]); 16] = [
    ("geometry", &[]),
    ("solve", &["geometry"]),
    ("photo", &[]),
    ("pattern", &["geometry", "photo"]),
    ("detect", &["geometry", "solve", "photo", "pattern"]),
    ("estimate", &["geometry", "solve", "calibrate"]),
    ("calibrate", &["geometry", "solve", "pattern", "estimate", "advise"]),
    ("advise", &["geometry", "solve", "pattern", "estimate", "calibrate"]),
    // Asks of one photograph more what the calibration asked of all, with its residuals.
    ("verify", &["geometry", "solve", "pattern", "estimate", "calibrate", "advise"]),
    ("rectify", &["geometry", "solve", "pattern"]),
    ("decode", &["geometry", "solve", "photo", "pattern"]),
    ("reconstruct", &["geometry", "solve", "photo", "pattern"]),
    (
        "pipeline",
        &[
            "geometry",
            "photo",
            "pattern",
            "detect",
            "calibrate",
            "verify",
            "rectify",
            "decode",
            "reconstruct",
        ],
    ),
    ("evaluate", &["geometry", "solve"]),
    ("format", &["geometry", "photo", "pattern"]),
    // Runs the estimators and compares with the truth; nothing depends on it.
    ("simulate", &["geometry", "solve", "photo", "pattern", "calibrate", "reconstruct"]),
];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
    files
}

/// What stands behind `crate::` wherever it occurs in code, tests left out.
fn used(text: &str) -> impl Iterator<Item = &str> {
    let code = text.split("#[cfg(test)]").next().unwrap_or_default();
    code.lines().filter(|l| !l.trim_start().starts_with("//")).flat_map(|line| {
        line.split("crate::")
            .skip(1)
            .filter_map(|rest| rest.split(|c: char| !(c.is_alphanumeric() || c == '_')).next())
    })
}

#[test]
fn folders_use_only_what_lies_below_them() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let folders: Vec<&str> = MAY_USE.iter().map(|(name, _)| *name).collect();
    let mut wrong = Vec::new();
    for (folder, allowed) in MAY_USE {
        for file in sources(&root.join(folder)) {
            // Files of tests alone may build their scenes from anything.
            let of_tests =
                |part: &std::ffi::OsStr| part.to_string_lossy().trim_end_matches(".rs").ends_with("tests");
            if file.strip_prefix(&root).unwrap().iter().any(of_tests) {
                continue;
            }
            let path = file.strip_prefix(&root).unwrap();
            let own_rules = |inner: &&str| {
                inner.len() > folder.len() && path.starts_with(inner) && inner.starts_with(folder)
            };
            if folders.iter().any(own_rules) {
                continue;
            }
            let text = fs::read_to_string(&file).unwrap();
            for name in used(&text) {
                if name != folder && folders.contains(&name) && !allowed.contains(&name) {
                    wrong.push(format!("{} uses {name}", file.strip_prefix(&root).unwrap().display()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn every_folder_is_listed() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for entry in fs::read_dir(root).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        assert!(!path.is_dir() || MAY_USE.iter().any(|(folder, _)| *folder == name), "{name} is not listed");
    }
}

/// Bindings and capture programs hand the library's advice to people who have no command line.
#[test]
fn messages_name_no_options_of_the_command() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let is_option = |after: &str| after.starts_with(|c: char| c.is_ascii_lowercase());
    let mut wrong = Vec::new();
    for file in sources(&root) {
        let text = fs::read_to_string(&file).unwrap();
        for (i, line) in text.lines().enumerate().filter(|(_, l)| !l.trim_start().starts_with("//")) {
            // What is written for other programs, and said of them, may name their options.
            let of_others =
                file.components().any(|c| c.as_os_str() == "exchange") && !line.contains("slcal ");
            if !of_others && line.split("--").skip(1).any(is_option) {
                wrong.push(format!("{}:{}: {}", file.display(), i + 1, line.trim()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
