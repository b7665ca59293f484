//! Help, summaries and messages word for word. New words are accepted by
//! `INSTA_UPDATE=always cargo test -p slcal-tests snapshots`, and read before they are committed.

use std::fs;

use regex::Regex;
use slcal_tests::{Bench, repository};

use crate::bench;

/// What a terminal would show, stderr first.
fn shown(bench: &Bench, line: &str, any_number: bool) -> String {
    let run = bench.run(line);
    let text = [run.stderr.clone(), run.text()].concat().replace("slcal-under-test", "slcal");
    let text = if any_number { without_numbers(&text) } else { text };
    format!("$ slcal {line}\n{text}(exit {})\n", run.code)
}

/// Every number as 0, and spaces within a line as one: a digit or a sign more is no other wording.
/// (That columns fit is seen to by `terminal.rs`.)
fn without_numbers(text: &str) -> String {
    let numbers = Regex::new(r"-?\b\d+(\.\d+)?").unwrap().replace_all(text, "0");
    Regex::new(r"(\S) {2,}").unwrap().replace_all(&numbers, "$1 ").into_owned()
}

fn assert_shown(name: &str, shown: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, shown));
}

/// The verbs with their own help.
const VERBS: [&str; 20] = [
    "demo",
    "pattern checker",
    "pattern stripes",
    "pattern gray",
    "pattern phase",
    "calibrate",
    "rectify",
    "verify",
    "decode",
    "triangulate",
    "reconstruct",
    "evaluate plane",
    "evaluate sphere",
    "simulate noise",
    "simulate scene",
    "advise",
    "export",
    "import",
    "report",
    "bug-report",
];

#[test]
fn help() {
    let bench = bench();
    assert_shown("help", &shown(&bench, "--help", false));
    for verb in VERBS {
        assert_shown(
            &format!("help {verb}").replace(' ', "_"),
            &shown(&bench, &format!("{verb} --help"), false),
        );
    }
}

#[test]
fn summaries() {
    let bench = bench();
    for path in
        ["crates/slcal-cli/demo/sheet.jpg", "crates/slcal-cli/demo/board.jpg", "fixtures/sheet_reversed.jpg"]
    {
        let path = repository().join(path);
        bench.put(path.file_name().unwrap().to_str().unwrap(), fs::read(&path).unwrap());
    }
    let lines = [
        "pattern checker --projector 1024x768 -o checker.png",
        "pattern stripes --projector 1024x768 -o stripes.png",
        "calibrate sheet.jpg --size A2-landscape --pattern checker.json -o quick.json",
        "calibrate sheet.jpg sheet_reversed.jpg --size 594x420mm --pattern checker.json -o rig.json",
        "decode --pattern stripes.json board.jpg -o matches.csv",
        "triangulate --rig rig.json matches.csv -o matches.ply",
        "reconstruct --rig rig.json --pattern stripes.json board.jpg -o cloud.ply --mesh",
        "evaluate plane cloud.ply",
        "evaluate sphere cloud.ply",
        "verify --rig rig.json --pattern checker.json --as-drawn sheet.jpg",
        "rectify --rig rig.json --pattern checker.json -o straight.png",
        "advise --rig quick.json",
        "export --rig rig.json --to kalibr -o kalibr.yaml",
        "import kalibr.yaml -o back.json",
        "report --rig rig.json -o report.html",
        "simulate noise --levels 0.2 --draws 5",
        "simulate scene --surface sphere --camera 320x240 --out scene",
    ];
    let shown: Vec<String> = lines.iter().map(|line| shown(&bench, line, true)).collect();
    assert_shown("summaries", &shown.join("\n"));
}

#[test]
fn messages() {
    let bench = bench();
    bench.put("sheet.jpg", fs::read(repository().join("crates/slcal-cli/demo/sheet.jpg")).unwrap());
    bench.put("near_frontal.jpg", fs::read(repository().join("fixtures/near_frontal.jpg")).unwrap());
    bench.put("notes.txt", "nothing\n");
    let lines = [
        "pattern checker --projector 1024x768 -o checker.png",
        "pattern stripes --projector 1024x768 -o stripes.png",
        // A wrong command line.
        "calibrat",
        "calibrate sheet.jpg --pattern checker.json -o rig.json",
        "calibrate sheet.jpg --size 594x420 --pattern checker.json -o rig.json",
        "calibrate sheet.jpg --size A9 --pattern checker.json -o rig.json",
        "pattern checker --projector 1024 -o other.png",
        "pattern stripes --projector 64x48 -o other.png",
        // A wrong file.
        "calibrate sheets.jpg --size A2 --pattern checker.json -o rig.json",
        "calibrate sheet.jpg --size A2 --pattern checker.png -o rig.json",
        "calibrate sheet.jpg --size A2 --pattern stripes.json -o rig.json",
        "calibrate notes.txt --size A2 --pattern checker.json -o rig.json",
        "advise --rig checker.json",
        "evaluate plane sheet.jpg",
        "reconstruct --rig checker.json --pattern stripes.json sheet.jpg -o cloud.ply",
        "import notes.txt -o rig.json",
        "pattern checker --projector 1024x768 -o checker.png",
        // A photograph that does not show what it should.
        "calibrate near_frontal.jpg --size A2-landscape --pattern checker.json -o rig.json",
        "calibrate sheet.jpg --size 59.4x42.0mm --pattern checker.json -o small.json",
        "calibrate sheet.jpg --size 420x594mm --pattern checker.json -o turned.json",
        "decode --pattern stripes.json sheet.jpg -o matches.csv",
    ];
    let shown: Vec<String> = lines
        .iter()
        .map(|line| shown(&bench, line, line.contains("simulate") || line.contains(".jpg")))
        .collect();
    assert_shown("messages", &shown.join("\n"));
}
