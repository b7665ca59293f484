//! `slcal bug-report`: what is in the archive, and what is not.

use std::collections::BTreeMap;
use std::fs;
use std::io::{Cursor, Read};

use slcal_tests::exif::{model, with_exif};
use slcal_tests::{Bench, repository};
use zip::ZipArchive;

use crate::bench;

/// A folder in which somebody has calibrated.
fn calibrated() -> Bench {
    let bench = bench();
    let sheet = fs::read(repository().join("crates/slcal-cli/demo/sheet.jpg")).unwrap();
    fs::create_dir(bench.path("wrong")).unwrap();
    bench.put("wrong/sheet.jpg", with_exif(&sheet, &[model("the camera of somebody")]));
    let _ = bench.run("pattern checker --projector 1024x768 -o wrong/checker.png").ok();
    let _ = bench
        .run(
            "calibrate wrong/sheet.jpg --size A2-landscape --pattern wrong/checker.json -o wrong/rig.json \
             --save-observations wrong/seen.json",
        )
        .ok();
    bench.put("wrong/notes.txt", "nobody else is to read this");
    bench.put("wrong/other.json", r#"{"secret": 1}"#);
    bench.put("wrong/studio.json", r#"{"schema": "slcal-studio-settings/1"}"#);
    bench.put("wrong/broken.json", r#"{"schema": "slcal-rig/1", "camera":"#);
    bench.put("wrong/commands.txt", "slcal calibrate sheet-001.jpg");
    bench
}

fn unpacked(bytes: Vec<u8>) -> BTreeMap<String, Vec<u8>> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).unwrap();
    (0..archive.len())
        .map(|i| {
            let mut file = archive.by_index(i).unwrap();
            let mut bytes = Vec::new();
            file.read_to_end(&mut bytes).unwrap();
            (file.name().unwrap().into_owned(), bytes)
        })
        .collect()
}

#[test]
fn what_is_needed_is_packed_and_shown_and_nothing_else() {
    let bench = calibrated();
    let run = bench
        .run_args(
            &["bug-report", "wrong", "-o", "out.zip", "--command", "slcal calibrate \u{1b}[2J sheet.jpg"],
            b"",
        )
        .ok();
    let files = unpacked(fs::read(bench.path("out.zip")).unwrap());
    let names: Vec<&str> = files.keys().map(String::as_str).collect();
    let expected = [
        "about.txt",
        "broken.json",
        "checker.json",
        "commands.txt",
        "rig.json",
        "seen.json",
        "thumbnails/checker.png.jpg",
        "thumbnails/sheet.jpg.jpg",
    ];
    assert_eq!(names, expected);
    for name in ["broken.json", "checker.json", "commands.txt", "rig.json", "seen.json"] {
        assert_eq!(files[name], fs::read(bench.path(&format!("wrong/{name}"))).unwrap(), "{name}");
    }
    let small = image::load_from_memory(&files["thumbnails/sheet.jpg.jpg"]).unwrap();
    assert_eq!(small.width().max(small.height()), 640);
    let contains = |bytes: &[u8], words: &str| bytes.windows(words.len()).any(|w| w == words.as_bytes());
    for (name, bytes) in &files {
        assert!(!contains(bytes, "the camera of somebody"), "{name}");
    }
    let about = String::from_utf8(files["about.txt"].clone()).unwrap();
    let version = bench.run("--version").ok().text();
    assert!(about.starts_with(version.trim()) && about.contains("slcal calibrate"), "{about}");
    assert!(!about.contains('\u{1b}'), "{about}");
    for name in names.iter().skip(1) {
        assert!(about.contains(name) && run.text().contains(name), "{name}: {about}");
    }
    for name in ["notes.txt", "other.json", "studio.json"] {
        assert!(about.contains(name) && run.text().contains(name), "{name}: {about}");
    }
    // The same folder gives the same archive, on stdout as well.
    let again = ["bug-report", "wrong", "-o", "-", "--command", "slcal calibrate \u{1b}[2J sheet.jpg"];
    let again = bench.run_args(&again, b"").ok();
    assert!(again.stdout == fs::read(bench.path("out.zip")).unwrap());
}

#[test]
fn a_dry_run_writes_nothing() {
    let bench = calibrated();
    let before = bench.names();
    let run = bench.run("bug-report wrong --dry-run --thumbnail 0").ok();
    assert!(run.words().contains("would be packed") && run.text().contains("rig.json"), "{}", run.text());
    assert!(run.text().contains("no thumbnails"), "{}", run.text());
    assert_eq!(bench.names(), before);
}

#[test]
fn what_is_no_such_folder_or_would_be_replaced_is_refused() {
    let bench = calibrated();
    bench.run("bug-report nowhere").fails(3, &["nowhere"]);
    fs::create_dir(bench.path("empty")).unwrap();
    bench.run("bug-report empty").fails(3, &["empty"]);
    bench.put("empty/notes.txt", "");
    bench.run("bug-report empty").fails(3, &["the folder in which you calibrated"]);
    bench.run("bug-report wrong -o wrong/rig.json --force").fails(2, &["input"]);
    bench.put("out.zip", "");
    bench.run("bug-report wrong -o out.zip").fails(1, &["out.zip", "--force"]);
}
