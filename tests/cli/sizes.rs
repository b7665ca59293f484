//! Sizes of sheets: by name, of another paper, in another unit.

use std::io::Cursor;

use image::{DynamicImage, ImageFormat};
use serde_json::Value;
use slcal_core::pattern::{CheckerConfig, CheckerPattern};
use slcal_tests::{Bench, IDEAL, Scene};

use crate::bench;

const TABLOID_MM: [f64; 2] = [431.8, 279.4];

/// A folder with the photographs of scenes, `a.png`, `b.png` and so on, without a pattern.
fn with_photos(scenes: &[Scene]) -> Bench {
    let bench = bench();
    for (name, scene) in ["a.png", "b.png"].iter().zip(scenes) {
        put(&bench, name, scene, None);
    }
    bench
}

fn put(bench: &Bench, name: &str, scene: &Scene, pattern: Option<&CheckerPattern>) {
    let mut bytes = Vec::new();
    let picture = DynamicImage::ImageRgb8(scene.photograph(pattern));
    picture.write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png).unwrap();
    bench.put(name, bytes);
}

fn rig(bench: &Bench) -> Value {
    serde_json::from_str(&bench.text("rig.json")).unwrap()
}

fn warning<'a>(rig: &'a Value, code: &str) -> Option<&'a str> {
    let all = rig["quality"]["warnings"].as_array().unwrap();
    all.iter().find(|w| w["code"] == code).map(|w| w["message"].as_str().unwrap())
}

fn focal_error_percent(rig: &Value, scene: &Scene) -> f64 {
    100.0 * (rig["camera"]["K"][0][0].as_f64().unwrap() / scene.camera_focal_px - 1.0).abs()
}

#[test]
fn a_paper_by_its_name_is_tried_both_ways_round() {
    let scene = Scene::default();
    let bench = bench();
    let checker = CheckerPattern::new([1024, 768], &CheckerConfig::default()).unwrap();
    let _ = bench.run("pattern checker --projector 1024x768 -o checker.png").ok();
    put(&bench, "photo.png", &scene, Some(&checker));
    let line = format!("calibrate photo.png --pattern checker.json -o rig.json --force {IDEAL}");
    let run = bench.run(&format!("{line} --size A2 --report report.html")).ok();
    let by_name = rig(&bench);
    assert_eq!(by_name["views"][0]["size_mm"], serde_json::json!([594.0, 420.0]));
    let said = warning(&by_name, "sides-swapped").unwrap();
    assert!(said.contains("photo.png") && said.contains("594 x 420 mm"), "{said}");
    assert!(run.stderr.contains("A2 is taken to lie across"), "{}", run.stderr);
    assert!(bench.text("report.html").contains("lies across"));
    // Nothing else differs from the size that says how the sheet lies.
    let _ = bench.run(&format!("{line} --size A2-landscape")).ok();
    let stated = rig(&bench);
    assert!(warning(&stated, "sides-swapped").is_none());
    assert_eq!(by_name["camera"], stated["camera"]);
    assert_eq!(by_name["quality"]["verdict"], stated["quality"]["verdict"]);
}

#[test]
fn a_stated_way_round_is_never_turned() {
    let bench = with_photos(&[Scene::default()]);
    for size in ["420x594mm", "A2-portrait"] {
        let run = bench.run(&format!("calibrate a.png --size {size} -o rig.json --force --allow-degenerate"));
        if run.text().is_empty() {
            run.fails(5, &["width and height may be swapped", "594"]);
        } else {
            let rig = rig(&bench);
            assert!(warning(&rig, "size-transposed").is_some(), "{size}: {rig:#}");
            assert_eq!(rig["views"][0]["size_mm"], serde_json::json!([420.0, 594.0]));
        }
    }
}

#[test]
fn a_sheet_may_be_turned_between_photographs() {
    let across = Scene::default();
    let upright = Scene { size_mm: [420.0, 594.0], tilt_deg: [-24.0, 26.0], ..across };
    let bench = with_photos(&[across, upright]);
    let run = bench.run(&format!("calibrate a.png b.png --size A2 -o rig.json {IDEAL}")).ok();
    let rig = rig(&bench);
    assert!(focal_error_percent(&rig, &across) < 0.1, "{rig:#}");
    let said = warning(&rig, "sides-swapped").unwrap();
    assert!(said.contains("a.png") && !said.contains("b.png"), "{said}");
    assert!(run.words().contains("lying the other way round in view 2"), "{}", run.text());
}

#[test]
fn another_paper_is_named() {
    let first = Scene { size_mm: TABLOID_MM, centre_mm: [0.0, 0.0, 800.0], ..Scene::default() };
    let second = Scene { tilt_deg: [-24.0, 26.0], ..first };
    let bench = with_photos(&[first, second]);
    for photos in ["a.png", "a.png b.png"] {
        for size in ["A3-landscape", "A3"] {
            let line = format!("calibrate {photos} --size {size} -o rig.json --force --allow-degenerate");
            let run = bench.run(&line).ok();
            let rig = rig(&bench);
            let said =
                warning(&rig, "other-size").unwrap_or_else(|| panic!("{photos} {size}: {}", run.text()));
            assert!(said.contains("tabloid (431.8 x 279.4 mm)"), "{said}");
            let verdict = rig["quality"]["verdict"].as_str().unwrap();
            assert!(["weak", "degenerate"].contains(&verdict), "{photos} {size}: {verdict}");
        }
        let _ = bench.run(&format!("calibrate {photos} --size tabloid -o rig.json --force")).ok();
        let rig = rig(&bench);
        assert!(warning(&rig, "other-size").is_none() && warning(&rig, "aspect-doubtful").is_none());
        assert!(focal_error_percent(&rig, &first) < 3.0, "{rig:#}");
    }
}

#[test]
fn numbers_without_a_unit_are_answered_with_the_likely_one() {
    let bench = with_photos(&[Scene::default()]);
    for (size, meant) in [
        ("594x420", "594x420mm?"),
        ("59.4x42", "59.4x42cm?"),
        ("8.5x11", "8.5x11in?"),
        ("0.594x0.42", "0.594x0.42m?"),
    ] {
        bench.run(&format!("calibrate a.png --size {size} -o rig.json")).fails(2, &["did you mean", meant]);
    }
    for (size, asked) in
        [("23.4x16.5mm", "measured in inches?"), ("60x42.4mm", "measured in centimetres or inches?")]
    {
        let run = bench.run(&format!("calibrate a.png --size {size} -o rig.json --force")).ok();
        assert!(run.words().contains(asked), "{}", run.text());
    }
    let run = bench.run("calibrate a.png --size 0.594x0.42m -o rig.json --force").ok();
    assert!(run.words().contains("594.0 x 420.0 mm"), "{}", run.text());
}
