//! A projector whose pictures appear with left and right exchanged.

use serde_json::Value;

use crate::bench;

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn a_calibration_that_is_told_so_says_so_and_keeps_it() {
    let bench = bench();
    let _ = bench.run("simulate scene --surface sheet --mirror --out sheet").ok();
    let line = "calibrate sheet/photo.png --size A2-landscape --pattern sheet/pattern.json --mirror -o rig.json \
                --save-observations seen.json --report report.html";
    assert!(bench.run(line).ok().words().contains("column c counts as column width - 1 - c"));
    assert!(bench.text("report.html").contains("Its pictures appear mirrored"));
    assert_eq!(json(&bench.text("rig.json"))["projector"]["mirrored"], true);
    assert_eq!(json(&bench.text("seen.json"))["projector"]["mirrored"], true);
    let _ = bench.run("calibrate --observations seen.json -o again.json").ok();
    assert_eq!(json(&bench.text("again.json"))["projector"]["mirrored"], true);
    // The sheet and its residuals are found again by the pattern's file.
    let line = "report --rig rig.json --pattern sheet/pattern.json --photo sheet/photo.png -o later.html";
    let run = bench.run(line).ok();
    assert!(!run.stderr.contains("residuals are not shown"), "{}", run.stderr);
    let line = "verify --rig rig.json --pattern sheet/pattern.json --as-drawn sheet/photo.png";
    assert!(bench.run(line).ok().words().contains("has not moved"));
    // Formats that can hold it do, and the others tell.
    for format in ["opencv -o rig.yml", "npz -o rig.npz"] {
        let (_, file) = format.split_once(" -o ").unwrap();
        let _ = bench.run(&format!("export --rig rig.json --to {format}")).ok();
        let _ = bench.run(&format!("import {file} -o back.json --force")).ok();
        assert_eq!(json(&bench.text("back.json"))["projector"]["mirrored"], true, "{format}");
    }
    let run = bench.run("export --rig rig.json --to kalibr -o kalibr.yaml --lossy").ok();
    assert!(run.stderr.contains("pictures appear mirrored"), "{}", run.stderr);
}

#[test]
fn stripes_count_from_the_other_end() {
    let bench = bench();
    let _ = bench.run("simulate scene --surface plane --mirror --out wall").ok();
    let _ = bench.run("decode --pattern wall/pattern.json wall/photo.png --mirror -o said.csv").ok();
    let _ =
        bench.run("decode --pattern wall/pattern.json wall/photo.png --rig wall/rig.json -o known.csv").ok();
    assert_eq!(bench.text("said.csv"), bench.text("known.csv"));
    let columns = |name: &str| -> Vec<(usize, f64)> {
        let text = bench.text(name);
        let mut lines = text.lines().map(|l| l.split(',').map(str::to_owned).collect::<Vec<_>>());
        let head = lines.next().unwrap();
        let at = |name: &str| head.iter().position(|h| h == name).unwrap();
        let (slit, column) = (at("slit"), at("projector_column"));
        lines.map(|l| (l[slit].parse().unwrap(), l[column].parse().unwrap())).collect()
    };
    let pattern = json(&bench.text("wall/pattern.json"));
    for name in ["said.csv", "wall/truth_matches.csv"] {
        for (slit, column) in columns(name) {
            assert_eq!(column, 1023.0 - pattern["centres_px"][slit].as_f64().unwrap(), "{name}");
        }
    }
    // The rig says how its panel counts; without, the reason is named.
    let cloud = "--pattern wall/pattern.json wall/photo.png -o";
    let _ = bench.run(&format!("reconstruct --rig wall/rig.json {cloud} wall.ply")).ok();
    let mut rig = json(&bench.text("wall/rig.json"));
    rig["projector"].as_object_mut().unwrap().remove("mirrored");
    bench.put("unsaid.json", rig.to_string());
    let line = format!("reconstruct --rig unsaid.json {cloud} other.ply");
    bench.run(&line).fails(4, &["only with left and right of the picture exchanged"]);
    let _ = bench.run(&format!("{line} --mirror")).ok();
    let bytes = |name: &str| std::fs::read(bench.path(name)).unwrap();
    assert_eq!(bytes("wall.ply"), bytes("other.ply"));
}

#[test]
fn bad_lines_are_refused() {
    let bench = bench();
    let _ = bench.run("simulate scene --surface sheet --camera 320x240 --focal 375 --out small").ok();
    let line = "calibrate small/photo.png --size A2 --mirror -o rig.json";
    bench.run(line).fails(2, &["--mirror", "--pattern"]);
    let _ = bench.run("simulate scene --surface plane --camera 400x300 --focal 470 --out wall").ok();
    let line = "decode --pattern wall/pattern.json wall/photo.png --rig small/rig.json -o matches.csv";
    bench.run(line).fails(3, &["wall/photo.png", "320x240", "400x300"]);
    bench.put(
        "seen.json",
        r#"{"schema": "slcal-observations/1", "camera": {"width": 4, "height": 3},
        "projector": {"width": 4, "height": 3, "mirrored": 1}, "views": []}"#,
    );
    bench
        .run("calibrate --observations seen.json -o rig.json")
        .fails(3, &["projector.mirrored", "true or false"]);
}
