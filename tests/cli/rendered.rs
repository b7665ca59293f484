//! Rendered photographs with known truth: the demonstration's and those in `fixtures/`.

use std::fs;

use serde_json::Value;
use slcal_tests::{Bench, IDEAL, repository};

use crate::bench;

/// A folder with the patterns and a photograph under the name photo.jpg.
fn with_photo(path: &str) -> Bench {
    let bench = bench();
    let _ = bench.run("pattern checker --projector 1024x768 -o checker.png").ok();
    let _ = bench.run("pattern stripes --projector 1024x768 -o stripes.png").ok();
    bench.put("photo.jpg", fs::read(repository().join(path)).unwrap());
    bench
}

fn calibrate(bench: &Bench, more: &str) -> Value {
    let line = format!("calibrate photo.jpg --size 594x420mm --pattern checker.json --json {more}");
    serde_json::from_str(&bench.run(&line).ok().text()).unwrap()
}

/// Errors of the focal lengths of camera and projector, per cent.
fn focal_errors(rig: &Value, camera: f64, projector: f64) -> [f64; 2] {
    [("camera", camera), ("projector", projector)]
        .map(|(device, truth)| 100.0 * (rig[device]["K"][0][0].as_f64().unwrap() / truth - 1.0).abs())
}

#[test]
fn lens_shift_is_found_from_one_photograph() {
    let bench = with_photo("crates/slcal-cli/demo/sheet.jpg");
    let rig = calibrate(&bench, "");
    let [camera, projector] = focal_errors(&rig, 1536.0, 1587.2);
    assert!(camera < 0.1 && projector < 0.5, "{camera} {projector}");
    let shift = rig["projector"]["K"][1][2].as_f64().unwrap() - 767.5;
    assert!(shift.abs() < 4.0, "{shift}");
    // One photograph cannot know the principal point: σ says so.
    let sigma = rig["quality"]["focal_sigma_percent"]["camera"].as_f64().unwrap();
    assert!((1.0..4.0).contains(&sigma), "{sigma}");
}

#[test]
fn half_the_size_gives_half_the_focal_length() {
    let rig = calibrate(&with_photo("fixtures/tilted_half.jpg"), IDEAL);
    let [camera, projector] = focal_errors(&rig, 768.0, 1638.4);
    assert!(camera < 0.3 && projector < 0.4, "{camera} {projector}");
}

#[test]
fn the_right_sheet_is_found_in_the_dark_among_others() {
    let rig = calibrate(&with_photo("fixtures/dark_clutter.jpg"), IDEAL);
    let [camera, projector] = focal_errors(&rig, 1920.0, 1638.4);
    assert!(camera < 0.3 && projector < 0.6, "{camera} {projector}");
}

#[test]
fn a_sheet_seen_face_on_needs_exact_principal_points() {
    let bench = with_photo("fixtures/near_frontal.jpg");
    let line = "calibrate photo.jpg --size 594x420mm --pattern checker.json -o rig.json";
    bench.run(line).fails(5, &["photo.jpg", "face-on"]);
    let rig = calibrate(&bench, &format!("{IDEAL} --camera-pp 639.5,479.5 --projector-pp 511.5,383.5"));
    let [camera, _] = focal_errors(&rig, 1536.0, 1638.4);
    assert!(camera < 1.0, "{camera}");
}

#[test]
fn the_published_method_does_not_survive_lens_shift() {
    let bench = with_photo("crates/slcal-cli/demo/sheet.jpg");
    let run =
        bench.run("calibrate photo.jpg --size 594x420mm --pattern checker.json --method two-vp -o rig.json");
    if run.code == 0 {
        let rig: Value = serde_json::from_str(&bench.text("rig.json")).unwrap();
        let [_, projector] = focal_errors(&rig, 1536.0, 1587.2);
        assert!(projector > 20.0 && run.words().contains("warning"), "{projector} {}", run.text());
    } else {
        run.fails(5, &["photo.jpg", "imaginary"]);
    }
}

#[test]
fn a_sphere_is_reconstructed_as_one() {
    let bench = with_photo("fixtures/sphere.jpg");
    bench.put("rig.json", fs::read(repository().join("crates/slcal-cli/demo/truth_rig.json")).unwrap());
    let run = bench.run(
        "reconstruct --rig rig.json --pattern stripes.json photo.jpg -o cloud.ply --overlay seen.png --mesh --json",
    );
    let report: Value = serde_json::from_str(&run.ok().text()).unwrap();
    assert_eq!(report["schema"], "slcal-reconstruct/1");
    assert!(report["clouds"][0]["triangles"].as_u64().unwrap() > 1000);
    let fit: Value =
        serde_json::from_str(&bench.run("evaluate sphere cloud.ply --json").ok().text()).unwrap();
    assert_eq!(fit["schema"], "slcal-evaluate/1");
    assert!(fit["mean_percent"].as_f64().unwrap() < 0.1, "{fit}");
    assert!(bench.run("evaluate sphere cloud.ply").ok().words().contains("radius"));
}

#[test]
fn the_name_tells_the_format_of_a_cloud() {
    let bench = with_photo("fixtures/sphere.jpg");
    bench.put("rig.json", fs::read(repository().join("crates/slcal-cli/demo/truth_rig.json")).unwrap());
    let line = "reconstruct --rig rig.json --pattern stripes.json photo.jpg --mesh";
    let report: Value =
        serde_json::from_str(&bench.run(&format!("{line} -o c.xyz --json")).ok().text()).unwrap();
    let points = report["clouds"][0]["points"].as_u64().unwrap() as usize;
    let triangles = report["clouds"][0]["triangles"].as_u64().unwrap() as usize;
    assert_eq!(bench.text("c.xyz").lines().count(), points);
    let _ = bench.run(&format!("{line} -o c.OBJ")).ok();
    let with = |start: &str| bench.text("c.OBJ").lines().filter(|l| l.starts_with(start)).count();
    assert_eq!((with("v "), with("f ")), (points, triangles));
    let _ = bench.run("decode --pattern stripes.json photo.jpg -o m.csv").ok();
    let _ = bench.run("triangulate --rig rig.json m.csv -o t.xyz").ok();
    assert!(bench.text("t.xyz").lines().count() >= points);
    for line in [&format!("{line} -o c.stl"), "triangulate --rig rig.json m.csv -o t"] {
        bench.run(line).fails(2, &[".ply, .pcd, .xyz, .obj or .glb"]);
    }
}

#[test]
fn a_pattern_that_was_not_projected_gives_no_cloud() {
    let bench = with_photo("fixtures/sphere.jpg");
    bench.put("rig.json", fs::read(repository().join("crates/slcal-cli/demo/truth_rig.json")).unwrap());
    let mut mirrored: Value = serde_json::from_str(&bench.text("stripes.json")).unwrap();
    mirrored["sequence"].as_array_mut().unwrap().reverse();
    bench.put("mirrored.json", mirrored.to_string());
    let mut one: Value = serde_json::from_str(&bench.text("stripes.json")).unwrap();
    one["palette"] = serde_json::json!([[255, 0, 0]]);
    one["sequence"] = serde_json::json!(vec![0; 64]);
    bench.put("one.json", one.to_string());
    for (name, hues, order, slits) in [("a", 5, 3, 64), ("b", 3, 4, 61), ("c", 6, 2, 37), ("d", 4, 3, 48)] {
        let _ = bench
            .run(&format!("pattern stripes --projector 1024x768 --hues {hues} --order {order} --slits {slits} -o {name}.png"))
            .ok();
    }
    for (name, exit) in [("mirrored", 4), ("a", 4), ("b", 4), ("c", 4), ("d", 4), ("one", 3)] {
        bench
            .run(&format!("reconstruct --rig rig.json --pattern {name}.json photo.jpg -o cloud.ply"))
            .fails(exit, &[if exit == 3 { "one.json" } else { "photo.jpg" }, "pa"]);
        assert!(!bench.names().iter().any(|n| n == "cloud.ply"));
    }
}

#[test]
fn decode_and_triangulate_are_reconstruct_in_two_steps() {
    let bench = with_photo("fixtures/sphere.jpg");
    bench.put("rig.json", fs::read(repository().join("crates/slcal-cli/demo/truth_rig.json")).unwrap());
    let run = bench.run("decode --pattern stripes.json photo.jpg -o m.csv --json").ok();
    let report: Value = serde_json::from_str(&run.text()).unwrap();
    assert_eq!(report["schema"], "slcal-decode/1");
    let table = bench.text("m.csv");
    assert_eq!(table.lines().next(), Some("u,v,projector_column,slit,confidence,sigma_px"));
    let rows = table.lines().count() - 1;
    assert_eq!(report["decoded"].as_u64(), Some(rows as u64));
    let _ = bench.run("triangulate --rig rig.json m.csv -o a.ply").ok();
    let _ = bench.run("reconstruct --rig rig.json --pattern stripes.json photo.jpg --cull off -o b.ply").ok();
    assert_eq!(fs::read(bench.path("a.ply")).unwrap().len(), fs::read(bench.path("b.ply")).unwrap().len());
    let cloud = fs::read(bench.path("a.ply")).unwrap();
    let header = String::from_utf8_lossy(&cloud[..400]).into_owned();
    let vertices = header.lines().find_map(|l| l.strip_prefix("element vertex ")).unwrap();
    // A few matches are impossible in space.
    assert!(vertices.parse::<usize>().unwrap() * 1000 > rows * 999, "{vertices} of {rows}");
    assert!(header.contains("comment units mm") && header.contains("comment frame camera"), "{header}");
    // From stdin to stdout, and into a folder.
    let args = ["triangulate", "--rig", "rig.json", "-", "-o", "-", "-q"];
    let piped = bench.run_args(&args, table.as_bytes()).ok();
    assert_eq!(piped.stdout, fs::read(bench.path("a.ply")).unwrap());
    let _ = bench
        .run("reconstruct --rig rig.json --pattern stripes.json photo.jpg --frame plane --out-dir clouds")
        .ok();
    let cloud = fs::read(bench.path("clouds/photo.ply")).unwrap();
    assert!(String::from_utf8_lossy(&cloud[..200]).contains("comment frame plane"));
    bench
        .run("reconstruct --rig rig.json --pattern stripes.json photo.jpg --out-dir clouds")
        .fails(1, &["photo.ply", "--force"]);
}

#[test]
fn the_demonstration_runs_the_whole_chain() {
    let bench = bench();
    let run = bench.run("demo --out demo").ok();
    for word in ["sheet.jpg", "focal length", "Verdict: good", "board.jpg", "cloud.ply", "rig.json"] {
        assert!(run.words().contains(word), "no {word} in {}", run.text());
    }
    let mut names: Vec<String> = fs::read_dir(bench.path("demo"))
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    assert_eq!(
        names,
        [
            "board.jpg",
            "board.ply",
            "checker.json",
            "checker.png",
            "cloud.ply",
            "head.jpg",
            "head_found.png",
            "report.html",
            "rig.json",
            "sheet.jpg",
            "sheet_found.png",
            "stripes.json",
            "stripes.png"
        ]
    );
    let fit: Value =
        serde_json::from_str(&bench.run("evaluate plane demo/board.ply --json").ok().text()).unwrap();
    assert!(fit["mean_percent"].as_f64().unwrap() < 0.1, "{fit}");
    // What it says can be done by hand can be done.
    let _ = bench
        .run("calibrate demo/sheet.jpg --size 594x420mm --pattern demo/checker.json -o demo/my_rig.json")
        .ok();
    let by_hand: Value = serde_json::from_str(&bench.text("demo/my_rig.json")).unwrap();
    let built_in: Value = serde_json::from_str(&bench.text("demo/rig.json")).unwrap();
    assert_eq!(by_hand["camera"], built_in["camera"]);
    bench.run("demo --out demo").fails(1, &["demo", "--force"]);
}
