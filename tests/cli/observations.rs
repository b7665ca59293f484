//! `slcal calibrate --observations`: corners and pairs of any detector.

use image::{DynamicImage, ImageFormat};
use serde_json::{Value, json};
use slcal_core::pattern::{CheckerConfig, CheckerPattern};
use slcal_tests::{Bench, IDEAL, Scene};

use crate::bench;

const LINE: &str = "calibrate --observations seen.json -o rig.json";

/// Noise that is the same in every run: the fractional parts of the golden ratio's multiples, with a spread of one.
fn jitter(i: usize) -> f64 {
    ((i as f64 * 0.618_033_988_749_895).fract() - 0.5) * 12_f64.sqrt()
}

/// What the default scene shows, pairs on a grid of the panel, with noise of `sigma_px`.
fn seen(scene: &Scene, columns: usize, rows: usize, sigma_px: f64) -> Value {
    let camera_from_sheet = scene.camera_from_sheet();
    let camera_from_projector =
        camera_from_sheet.compose(&scene.projector_from_sheet([1024, 768]).inverse().unwrap());
    let corners = [[0.0, 0.0], [594.0, 0.0], [594.0, 420.0], [0.0, 420.0]]
        .map(|[x, y]| camera_from_sheet.map(nalgebra::Point2::new(x, y)).unwrap());
    let pairs: Vec<[f64; 4]> = (0..columns * rows)
        .map(|i| {
            let [x, y] =
                [(i % columns) as f64 / (columns - 1) as f64, (i / columns) as f64 / (rows - 1) as f64];
            let q = nalgebra::Point2::new(272.0 + 480.0 * x, 234.0 + 300.0 * y);
            let p = camera_from_projector.map(q).unwrap();
            [p.x + sigma_px * jitter(2 * i), p.y + sigma_px * jitter(2 * i + 7), q.x, q.y]
        })
        .collect();
    json!({
        "schema": "slcal-observations/1",
        "camera": {"width": 960, "height": 720},
        "projector": {"width": 1024, "height": 768},
        "views": [{"size_mm": [594, 420], "sheet_corners_px": corners.map(|c| [c.x, c.y]), "pairs": pairs}],
    })
}

fn with(change: impl FnOnce(&mut Value)) -> Bench {
    let bench = bench();
    let mut value = seen(&Scene::default(), 9, 6, 0.05);
    change(&mut value["views"][0]);
    bench.put("seen.json", value.to_string());
    bench
}

fn focal(rig: &Value, device: &str) -> f64 {
    rig[device]["K"][0][0].as_f64().unwrap()
}

fn rig_of(bench: &Bench) -> Value {
    serde_json::from_str(&bench.text("rig.json")).unwrap()
}

#[test]
fn corners_and_pairs_give_a_rig_without_a_photograph() {
    let scene = Scene::default();
    let bench = with(|_| {});
    let run = bench.run(&format!("{LINE} {IDEAL}")).ok();
    let rig = rig_of(&bench);
    assert!((focal(&rig, "camera") / scene.camera_focal_px - 1.0).abs() < 0.002);
    assert!((focal(&rig, "projector") / scene.projector_focal_px - 1.0).abs() < 0.002);
    assert_eq!(rig["views"][0]["photo"], Value::Null);
    for word in ["noise of the pairs", "residuals", "the sheet's corners", "assumed"] {
        assert!(run.stderr.contains(word), "no {word} in {}", run.stderr);
    }
    let warnings = rig["quality"]["warnings"].as_array().unwrap();
    assert!(warnings.iter().any(|w| w["code"] == "noise-assumed"), "{warnings:?}");
    // Stated noise needs no word.
    let bench = with(|v| {
        v["sheet_sigma_px"] = json!(0.1);
        v["pair_sigma_px"] = json!(0.05);
    });
    let run = bench.run(&format!("{LINE} {IDEAL}")).ok();
    assert!(!run.stderr.contains("noise"), "{}", run.stderr);
    // From stdin, and as JSON.
    let line = format!("calibrate --observations - --json {IDEAL}");
    let args: Vec<&str> = line.split(' ').collect();
    let piped = bench.run_args(&args, bench.text("seen.json").as_bytes()).ok();
    assert_eq!(serde_json::from_str::<Value>(&piped.text()).unwrap(), rig_of(&bench));
    let published = bench.run(&format!("{LINE} --force --method two-vp --projector-pp centre")).ok();
    assert!(published.words().contains("camera"));
}

#[test]
fn the_camera_alone_is_calibrated_where_the_projector_is_null() {
    let bench = bench();
    let mut value = seen(&Scene::default(), 9, 6, 0.05);
    value["projector"] = Value::Null;
    bench.put("seen.json", value.to_string());
    let _ = bench.run(LINE).ok();
    assert_eq!(rig_of(&bench)["projector"], Value::Null);
}

#[test]
fn what_was_found_can_be_saved_and_gives_the_same_rig_bit_for_bit() {
    let scene = Scene::default();
    let checker = CheckerPattern::new([1024, 768], &CheckerConfig::default()).unwrap();
    let bench = bench();
    let _ = bench.run("pattern checker --projector 1024x768 -o checker.png").ok();
    DynamicImage::ImageRgb8(scene.photograph(Some(&checker)))
        .save_with_format(bench.path("photo.png"), ImageFormat::Png)
        .unwrap();
    let photo = "calibrate photo.png --size A2-landscape --pattern checker.json";
    let _ = bench.run(&format!("{photo} -o first.json --save-observations seen.json")).ok();
    let run = bench.run(LINE).ok();
    assert!(!run.stderr.contains("noise"), "{}", run.stderr);
    assert_eq!(bench.text("first.json"), bench.text("rig.json"));
    assert_eq!(rig_of(&bench)["views"][0]["photo"], "photo.png");
    // Not over an existing file, an input, or twice onto one.
    bench
        .run(&format!("{photo} -o a.json --save-observations seen.json"))
        .fails(1, &["seen.json", "--force"]);
    bench.run(&format!("{photo} -o a.json --save-observations a.json")).fails(2, &["a.json"]);
    bench
        .run(&format!("{photo} --force -o a.json --save-observations checker.json"))
        .fails(2, &["checker.json"]);
    bench.run(&format!("{photo} --json --save-observations -")).fails(2, &["stdout"]);
}

#[test]
fn what_was_found_is_saved_though_it_cannot_be_calibrated_from() {
    let scene = Scene { tilt_deg: [1.0, -2.0], ..Scene::default() };
    let bench = bench();
    let photo = DynamicImage::ImageRgb8(scene.photograph(None));
    photo.save_with_format(bench.path("photo.png"), ImageFormat::Png).unwrap();
    bench
        .run("calibrate photo.png --size A2-landscape -o rig.json --save-observations seen.json")
        .fails(5, &["face-on"]);
    assert_eq!(bench.names(), ["photo.png", "seen.json"]);
    bench.run(LINE).fails(5, &["seen.json", "face-on"]);
}

#[test]
fn what_needs_a_photograph_contradicts_observations() {
    let bench = with(|_| {});
    for more in [
        "photo.png",
        "--size A4",
        "--pattern checker.json",
        "--screen photo.png",
        "--gamma linear",
        "--overlay seen.png",
        "--save-observations other.json",
    ] {
        bench.run(&format!("{LINE} {more}")).fails(2, &["--observations"]);
    }
    bench.run("calibrate -o rig.json").fails(2, &["PHOTO"]);
    bench.run(&format!("{LINE} --observations other.json")).fails(2, &["--observations"]);
}

#[test]
fn files_that_are_no_observations() {
    let bench = bench();
    bench.run(LINE).fails(3, &["seen.json", "no such file"]);
    for (text, word) in [
        ("", "empty"),
        ("{", "JSON"),
        ("[]", "slcal-observations/1"),
        ("{\"schema\": \"slcal-rig/1\"}", "slcal-rig/1"),
        ("{\"schema\": \"slcal-observations/1\", \"camera\": NaN}", "JSON"),
        (&"[".repeat(1_000_000), "32 levels"),
    ] {
        bench.put("seen.json", text);
        bench.run(LINE).fails(3, &["seen.json", word]);
    }
    bench.put("seen.json", vec![0xFF_u8; 100_000_000]);
    bench.run(LINE).fails(3, &["seen.json"]);
    std::fs::remove_file(bench.path("seen.json")).unwrap();
    std::fs::create_dir(bench.path("seen.json")).unwrap();
    bench.run(LINE).fails(3, &["seen.json", "folder"]);
}

#[test]
fn observations_that_make_no_sense_are_named() {
    let refused = |change: &dyn Fn(&mut Value), words: &[&str]| {
        let bench = with(|v| change(v));
        bench.run(LINE).fails(3, words);
        assert_eq!(bench.names(), ["seen.json"]);
    };
    refused(&|v| v["sheet_corners_px"][1][0] = Value::Null, &["views[0].sheet_corners_px[1][0]", "null"]);
    refused(&|v| v["pairs"][7][3] = json!(1e20), &["views[0].pairs[7][3]"]);
    refused(&|v| v["pairs"][7][3] = json!(5000), &["panel", "1024x768"]);
    refused(
        &|v| v["pairs"] = json!([[1, 2, 3, 4], [5, 6, 7, 8], [9, 1, 2, 3]]),
        &["at least 4 pairs", "found 3"],
    );
    refused(
        &|v| v["sheet_corners_px"] = json!([[100, 100], [200, 100], [300, 100], [150, 300]]),
        &["corners", "line"],
    );
    refused(&|v| v["sheet_corners_px"].as_array_mut().unwrap().reverse(), &["mirror"]);
    refused(&|v| v["sheet_corners_px"].as_array_mut().unwrap().swap(0, 1), &["convex"]);
    refused(&|v| v["size_mm"] = json!([0.594, 0.42]), &["millimetres"]);
    let one_line: Vec<[f64; 4]> = (0..20).map(|i| [f64::from(i), 100.0, f64::from(i), 200.0]).collect();
    refused(&|v| v["pairs"] = json!(one_line), &["one line"]);
    let same = json!(vec![[400.0, 300.0, 500.0, 400.0]; 20]);
    refused(&|v| v["pairs"] = same.clone(), &["pairs"]);
    let edges = json!({"top": [[0, 0], [9, 0]], "right": [[9, 0]], "bottom": [[9, 9], [0, 9]], "left": [[0, 9], [0, 0]]});
    let with_edges = |v: &mut Value| {
        v.as_object_mut().unwrap().remove("sheet_corners_px");
        v["sheet_edges_px"] = edges.clone();
    };
    refused(&with_edges, &["view 1", "at least 2 on each side"]);
}

#[test]
fn two_points_on_each_side_do() {
    let scene = Scene::default();
    let bench = with(|v| {
        let h = scene.camera_from_sheet();
        let corners = [[0.0, 0.0], [594.0, 0.0], [594.0, 420.0], [0.0, 420.0]];
        let side = |i: usize| -> Vec<[f64; 2]> {
            let (a, b) = (corners[i], corners[(i + 1) % 4]);
            let at = |s: f64| {
                h.map(nalgebra::Point2::new(a[0] + (b[0] - a[0]) * s, a[1] + (b[1] - a[1]) * s)).unwrap()
            };
            [0.2, 0.8].map(|s| [at(s).x, at(s).y]).to_vec()
        };
        v.as_object_mut().unwrap().remove("sheet_corners_px");
        v["sheet_edges_px"] = json!({"top": side(0), "right": side(1), "bottom": side(2), "left": side(3)});
    });
    let _ = bench.run(&format!("{LINE} {IDEAL}")).ok();
    assert!((focal(&rig_of(&bench), "camera") / scene.camera_focal_px - 1.0).abs() < 0.002);
}

#[test]
fn a_wrong_pair_and_the_same_pairs_twice_do_no_harm() {
    let scene = Scene::default();
    let bench = with(|v| v["pairs"][20][0] = json!(100.0));
    let _ = bench.run(&format!("{LINE} {IDEAL}")).ok();
    assert!((focal(&rig_of(&bench), "projector") / scene.projector_focal_px - 1.0).abs() < 0.002);
    let bench = with(|v| {
        let pairs = v["pairs"].as_array_mut().unwrap();
        pairs.extend(pairs.clone());
    });
    let _ = bench.run(&format!("{LINE} {IDEAL}")).ok();
    assert!((focal(&rig_of(&bench), "projector") / scene.projector_focal_px - 1.0).abs() < 0.002);
}

#[test]
fn of_a_million_pairs_a_few_thousand_are_used() {
    let bench = bench();
    bench.put("seen.json", seen(&Scene::default(), 1000, 1000, 0.1).to_string());
    let run = bench.run(LINE).ok();
    assert!(run.stderr.contains("4000 of 1000000 pairs"), "{}", run.stderr);
    let rig = rig_of(&bench);
    assert!((focal(&rig, "projector") / Scene::default().projector_focal_px - 1.0).abs() < 0.002);
}
