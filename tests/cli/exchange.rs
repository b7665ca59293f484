//! `slcal export` and `slcal import`: places, refusals and the way back of the real binary.

use serde_json::Value;
use slcal_tests::Bench;

use crate::bench;

/// Lens shift and unequal focal lengths; no distortion, so that every format holds it.
const RIG: &str = r#"{"schema": "slcal-rig/1", "units": "mm", "pixel_centre": "integer",
    "camera": {"width": 640, "height": 480, "K": [[800, 0, 319.5], [0, 1000, 199.5], [0, 0, 1]], "distortion": [0, 0, 0, 0, 0]},
    "projector": {"width": 1000, "height": 500, "K": [[2000, 0, 499.5], [0, 1600, 699.5], [0, 0, 1]], "distortion": [0, 0, 0, 0, 0]},
    "projector_from_camera": {"R": [[1, 0, 0], [0, 0, -1], [0, 1, 0]], "t": [100, -200, 50]},
    "views": [], "method": "by hand"}"#;

/// What each format's export is called, and the files that it leaves.
const FORMATS: [(&str, &str, &[&str]); 8] = [
    ("opencv", "a.yml", &["a.yml"]),
    ("opencv", "a.xml", &["a.xml"]),
    ("opencv", "a.json", &["a.json"]),
    ("ros", "a.yaml", &["a.yaml", "a_projector.yaml"]),
    ("colmap", "a", &["a/cameras.txt", "a/images.txt", "a/points3D.txt"]),
    ("kalibr", "a.yaml", &["a.yaml"]),
    ("blender", "a.py", &["a.py"]),
    ("npz", "a.npz", &["a.npz"]),
];

fn with_rig() -> Bench {
    let bench = bench();
    bench.put("rig.json", RIG);
    bench
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// All numbers in a value, in order.
fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        other => other.as_f64().into_iter().collect(),
    }
}

/// Asserts that two rigs have the same devices and the projector in the same place.
fn same(found: &str, expected: &str) {
    let (found, expected) = (json(found), json(expected));
    for (place, count) in [
        ("/camera/K", 9),
        ("/camera/distortion", 5),
        ("/projector/K", 9),
        ("/projector/distortion", 5),
        ("/projector_from_camera/R", 9),
        ("/projector_from_camera/t", 3),
    ] {
        let [a, b] = [&found, &expected].map(|v| v.pointer(place).map(numbers).unwrap_or_default());
        assert!(a.len() == count && b.len() == count, "{place}: {found:#}");
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12), "{place}: {a:?} {b:?}");
    }
}

#[test]
fn every_format_comes_back() {
    for (format, name, files) in FORMATS {
        let bench = with_rig();
        let run = bench.run(&format!("export --rig rig.json --to {format} -o {name}")).ok();
        for file in files {
            assert!(run.text().contains(&format!("wrote      {file}")), "{format}: {}", run.text());
            assert!(bench.path(file).is_file(), "{format}: {file}");
        }
        assert!(run.text().contains("convention"), "{}", run.text());
        let inputs = if format == "colmap" { "a".to_owned() } else { files.join(" ") };
        for from in [format!("--from {format}"), String::new()] {
            let back = bench.run(&format!("import {from} {inputs} -o back.json --force")).ok();
            assert!(back.text().contains(&format!("camera and projector from {format}")), "{}", back.text());
            same(&bench.text("back.json"), RIG);
        }
        // Nothing is replaced unasked, and a refusal leaves no half.
        bench.run(&format!("export --rig rig.json --to {format} -o {name}")).fails(1, &[files[0], "--force"]);
        let _ = bench.run(&format!("export --rig rig.json --to {format} -o {name} --force")).ok();
        assert!(bench.names().iter().all(|n| !n.starts_with(".slcal")), "{:?}", bench.names());
    }
}

#[test]
fn places_and_names() {
    let bench = with_rig();
    let _ = bench.run("export --rig rig.json --to ros -o calib").ok();
    assert!(bench.path("calib/camera.yaml").is_file() && bench.path("calib/projector.yaml").is_file());
    let _ = bench.run("import calib -o back.json").ok();
    same(&bench.text("back.json"), RIG);
    let _ = bench.run("export --rig rig.json --to colmap -o model").ok();
    let _ = bench.run("import model/cameras.txt -o - ").ok();
    // Stdout has the file and nothing else.
    let printed = bench.run("export --rig rig.json --to kalibr -o -").ok();
    assert!(printed.text().starts_with("# Metres") && !printed.text().contains("wrote"));
    let read = bench.run_args(&["import", "--from", "kalibr", "-", "-o", "-"], &printed.stdout).ok();
    same(&read.text(), RIG);
    let strange = "it's \"a\"\nné 日本.yaml";
    let _ = bench.run_args(&["export", "--rig", "rig.json", "--to", "ros", "-o", strange], b"").ok();
    let both = [strange, "it's \"a\"\nné 日本_projector.yaml"];
    let _ = bench.run_args(&["import", both[0], both[1], "-o", "b 2.json"], b"").ok();
    same(&bench.text("b 2.json"), RIG);
    // One of two files stands there already: neither is written.
    bench.put("c_projector.yaml", "mine");
    bench.run("export --rig rig.json --to ros -o c.yaml").fails(1, &["c_projector.yaml", "--force"]);
    assert!(!bench.path("c.yaml").exists() && bench.text("c_projector.yaml") == "mine");
    let said = json(&bench.run("export --rig rig.json --to npz -o r.npz --json").ok().text());
    assert_eq!((&said["schema"], &said["format"]), (&"slcal-export/1".into(), &"npz".into()));
    let said = json(&bench.run("import r.npz -o r.json --json").ok().text());
    assert_eq!((&said["schema"], &said["projector"]), (&"slcal-import/1".into(), &true.into()));
}

#[test]
fn wrong_places_are_refused() {
    let bench = with_rig();
    for (line, code, words) in [
        ("--to opencv -o a.txt", 2, &[".yml", ".xml", "a.txt"][..]),
        ("--to npz -o a.json", 2, &[".npz"]),
        ("--to ros -o -", 2, &["2 files"]),
        ("--to colmap -o images.txt", 2, &["folder"]),
        ("--to collada -o a.dae", 2, &["collada", "opencv", "blender"]),
        ("--to opencv -o none/a.yml", 1, &["does not exist"]),
        ("--to colmap -o none/model", 1, &["folder"]),
        ("--to opencv -o rig.json --force", 2, &["rig.json", "input"]),
        ("--to kalibr -o - --json", 2, &["stdout"]),
    ] {
        bench.run(&format!("export --rig rig.json {line}")).fails(code, words);
    }
    bench.run("import rig.npz -o - --json").fails(2, &["stdout"]);
    bench.put("file", "x");
    bench.run("export --rig rig.json --to colmap -o file").fails(1, &["file"]);
    std::fs::create_dir(bench.path("folder.yml")).unwrap();
    bench.run("export --rig rig.json --to opencv -o folder.yml").fails(1, &["folder"]);
    bench.run("import folder.yml -o a.json").fails(3, &["cameras.txt", "camera.yaml", "folder.yml"]);
    assert_eq!(bench.text("rig.json"), RIG);
}

#[test]
fn lenses_that_a_format_cannot_hold() {
    let bench = with_rig();
    bench.put("rig.json", RIG.replacen("[0, 0, 0, 0, 0]", "[-0.1, 0, 0, 0, 0.01]", 1));
    for (format, name) in [("kalibr", "a.yaml"), ("blender", "a.py")] {
        let line = format!("export --rig rig.json --to {format} -o {name}");
        bench.run(&line).fails(3, &["rig.json", "the camera's lens", format, "k3 = 0.01", " px", "lossy"]);
        assert!(!bench.path(name).exists());
        let run = bench.run(&format!("{line} --lossy")).ok();
        assert!(run.stderr.contains("k3 = 0.01") && run.stderr.contains("px"), "{}", run.stderr);
    }
    let skewed = RIG.replacen("[800, 0, 319.5]", "[800, 2, 319.5]", 1);
    bench.put("rig.json", &skewed);
    bench.run("export --rig rig.json --to colmap -o m").fails(3, &["skew = 2 px"]);
    assert!(!bench.path("m").exists());
    let run = bench.run("export --rig rig.json --to opencv -o a.yml").ok();
    assert!(run.stderr.contains("cv2.projectPoints"), "{}", run.stderr);
    let _ = bench.run("import a.yml -o back.json").ok();
    same(&bench.text("back.json"), &skewed);
}

#[test]
fn rigs_of_all_kinds() {
    let bench = with_rig();
    let mut alone = json(RIG);
    alone["projector"] = Value::Null;
    alone["projector_from_camera"] = Value::Null;
    bench.put("alone.json", alone.to_string());
    for (format, name, _) in FORMATS {
        let _ = bench.run(&format!("export --rig alone.json --to {format} -o {name} --force")).ok();
        let back = bench.run(&format!("import --from {format} {name} -o back.json --force")).ok();
        assert!(back.text().contains("a camera alone"), "{}", back.text());
        let back = json(&bench.text("back.json"));
        assert_eq!(numbers(&back["camera"]["K"]), numbers(&json(RIG)["camera"]["K"]), "{format}");
        assert_eq!(back["projector"], Value::Null, "{format}");
    }
    bench.put("newer.json", RIG.replace("slcal-rig/1", "slcal-rig/2"));
    bench.put("nan.json", RIG.replace("319.5", "NaN"));
    bench.put("huge.json", RIG.replace("319.5", "1e999"));
    for (name, word) in
        [("newer.json", "newer version"), ("nan.json", "malformed"), ("huge.json", "malformed")]
    {
        bench.run(&format!("export --rig {name} --to npz -o n.npz")).fails(3, &[name, word]);
        bench.run(&format!("import {name} -o n.json")).fails(3, &[name]);
    }
    bench.run("import rig.json -o n.json").fails(3, &["a rig file already"]);
    bench.run("export --rig none.json --to npz -o n.npz").fails(3, &["none.json", "no such file"]);
}

#[test]
fn sizes_that_files_do_not_say() {
    let bench = with_rig();
    let _ = bench.run("export --rig rig.json --to opencv -o a.yml").ok();
    let text = bench.text("a.yml");
    let sizeless: Vec<&str> =
        text.lines().filter(|l| !l.contains("_width") && !l.contains("_height")).collect();
    bench.put("a.yml", sizeless.join("\n"));
    bench.run("import a.yml -o b.json").fails(3, &["a.yml", "camera", "--camera-size WxH"]);
    bench.run("import a.yml -o b.json --camera-size 640x480").fails(3, &["--projector-size WxH"]);
    let _ = bench.run("import a.yml -o b.json --camera-size 640x480 --projector-size 1000x500").ok();
    same(&bench.text("b.json"), RIG);
    bench.run("import a.yml -o b.json --camera-size 640").fails(2, &["--camera-size"]);
    bench.put("words.yaml", "just words");
    bench.run("import words.yaml -o c.json").fails(3, &["words.yaml", "none of the formats", "--from"]);
}

#[test]
fn every_part_of_a_file_ends_in_a_message() {
    for (format, name, files) in FORMATS {
        let bench = with_rig();
        let _ = bench.run(&format!("export --rig rig.json --to {format} -o {name}")).ok();
        let whole = std::fs::read(bench.path(files[0])).unwrap();
        for i in 0..6 {
            std::fs::write(bench.path(files[0]), &whole[..whole.len() * i / 6]).unwrap();
            let run = bench.run(&format!("import --from {format} {} -o b.json --force", files.join(" ")));
            assert!(
                [0, 3].contains(&run.code) && !run.stderr.contains("panicked"),
                "{format}: {}",
                run.stderr
            );
            assert!(run.code == 0 || run.stderr.starts_with("slcal: "), "{}", run.stderr);
        }
    }
}
