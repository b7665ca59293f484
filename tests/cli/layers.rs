//! The arrows between the folders of the core point one way; `docs/architecture.md` tells why.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use slcal_tests::repository;

/// Each folder and what it may use of the crate, beside itself and `error`.
const MAY_USE: [(&str, &[&str]); 10] = [
    ("geometry", &[]),
    ("solve", &["geometry"]),
    ("photo", &[]),
    ("pattern", &["geometry", "photo"]),
    ("detect", &["geometry", "solve", "photo", "pattern", "observations"]),
    ("calibrate", &["geometry", "solve", "observations", "rig"]),
    ("decode", &["geometry", "solve", "photo", "pattern", "matches"]),
    ("reconstruct", &["geometry", "solve", "photo", "pattern", "decode", "matches", "rig", "cloud"]),
    ("evaluate", &["geometry", "solve", "cloud"]),
    ("format", &["geometry", "pattern", "rig", "matches", "cloud"]),
];

/// Names that follow `crate::` in the code of a folder, up to where a file's tests begin.
fn used_by(folder: &Path) -> BTreeSet<String> {
    let mut used = BTreeSet::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let is_tests = path.file_stem().is_some_and(|s| s.to_string_lossy().contains("test"));
        if path.is_dir() || is_tests || path.extension().is_none_or(|e| e != "rs") {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
        for line in code.lines().filter(|l| !l.trim_start().starts_with("//")) {
            for rest in line.split("crate::").skip(1) {
                let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                used.insert(name);
            }
        }
    }
    used
}

#[test]
fn folders_use_only_what_lies_below_them() {
    let source = repository().join("crates/slcal-core/src");
    for (folder, allowed) in MAY_USE {
        let path = source.join(folder);
        assert!(path.is_dir(), "{folder} is gone: update this list and docs/architecture.md");
        for name in used_by(&path) {
            let is_module = source.join(&name).is_dir() || source.join(format!("{name}.rs")).is_file();
            let fine = name == folder || name == "error" || allowed.contains(&name.as_str());
            assert!(!is_module || fine, "{folder} uses crate::{name}");
        }
    }
    let listed: BTreeSet<&str> = MAY_USE.iter().map(|(folder, _)| *folder).collect();
    for entry in fs::read_dir(&source).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        assert!(!path.is_dir() || listed.contains(name.as_str()), "{name} is not listed here");
    }
}
