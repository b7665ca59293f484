//! `slcal verify` on photographs of a rectified picture, drawn by closed form.

use image::RgbImage;
use serde_json::Value;
use slcal_core::pattern::{CheckerConfig, CheckerPattern};
use slcal_tests::{Bench, Scene};

use crate::bench;

const LINE: &str = "verify --rig rig.json --pattern checker.json";

fn photo(bench: &Bench, name: &str, picture: &RgbImage) {
    picture.save(bench.path(name)).unwrap();
}

fn checker() -> CheckerPattern {
    CheckerPattern::new([1024, 768], &CheckerConfig::default()).unwrap()
}

/// A rig of two photographs, and the picture that it rectifies.
fn rectified() -> (Bench, Scene, RgbImage) {
    let scene = Scene::default();
    let bench = bench();
    let _ = bench.run("pattern checker --projector 1024x768 -o checker.png").ok();
    let panel = checker().image().unwrap();
    photo(&bench, "a.png", &scene.photograph_of(&panel, &scene, 0.0));
    let reversed = Scene { tilt_deg: [-24.0, 26.0], ..scene };
    photo(&bench, "b.png", &reversed.photograph_of(&panel, &scene, 0.0));
    let _ = bench.run("calibrate a.png b.png --size A2-landscape --pattern checker.json -o rig.json").ok();
    let _ = bench.run("rectify --rig rig.json --pattern checker.json -o straight.png").ok();
    let straight = image::open(bench.path("straight.png")).unwrap().to_rgb8();
    (bench, scene, straight)
}

fn json(bench: &Bench, line: &str) -> Value {
    serde_json::from_str(&bench.run(&format!("{LINE} {line} --json")).ok().text()).unwrap()
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or_else(|| panic!("{v} is no number"))
}

#[test]
fn an_unmoved_rig_is_square_and_unmoved() {
    let (bench, scene, straight) = rectified();
    photo(&bench, "now.png", &scene.photograph_of(&straight, &scene, 0.0));
    let found = json(&bench, "now.png");
    assert_eq!(found["schema"], "slcal-verify/1");
    assert!(number(&found["keystone"]["worst_deg"]["value"]).abs() < 0.05, "{found:#}");
    assert_eq!(
        (&found["rig"]["moved"], &found["sheet"]["moved"]),
        (&Value::Bool(false), &Value::Bool(false)),
        "{found:#}"
    );
    assert_eq!(found["with_covariance"], true);
    assert_eq!(found["rig"]["change"], Value::Null);
    let said = bench.run(&format!("{LINE} now.png --overlay seen.png --fail-if-moved")).ok();
    for words in ["keystone", "rig has not moved (p = ", "sheet has not moved (p = ", "0.1 %"] {
        assert!(said.words().contains(words), "no {words} in {}", said.text());
    }
    let overlay = image::open(bench.path("seen.png")).unwrap();
    assert_eq!((overlay.width(), overlay.height()), (960, 720));
    bench.run(&format!("{LINE} now.png --overlay seen.png")).fails(1, &["seen.png", "--force"]);
}

#[test]
fn a_turned_projector_is_told_from_a_moved_sheet() {
    let (bench, scene, straight) = rectified();
    photo(&bench, "turned.png", &scene.photograph_of(&straight, &scene, 0.3));
    let found = json(&bench, "turned.png");
    assert_eq!(
        (&found["rig"]["moved"], &found["sheet"]["moved"]),
        (&Value::Bool(true), &Value::Bool(false)),
        "{found:#}"
    );
    assert_eq!(found["rig"]["change"]["what"], "projector-moved", "{found:#}");
    assert!((number(&found["rig"]["change"]["turn_deg"]["value"]) - 0.3).abs() < 0.1, "{found:#}");
    let said = bench.run(&format!("{LINE} turned.png")).ok();
    assert!(said.words().contains("calibrate again"), "{}", said.text());
    let failing = bench.run(&format!("{LINE} turned.png --fail-if-moved"));
    assert_eq!(failing.code, 1, "{}", failing.stderr);
    assert!(failing.stderr.contains("the rig has moved") && failing.words().contains("projector moved"));

    let moved = Scene { centre_mm: [10.0, -4.0, 1105.0], tilt_deg: [24.0, -24.0], ..scene };
    photo(&bench, "sheet.png", &moved.photograph_of(&straight, &scene, 0.0));
    let found = json(&bench, "sheet.png");
    assert_eq!(
        (&found["rig"]["moved"], &found["sheet"]["moved"]),
        (&Value::Bool(false), &Value::Bool(true)),
        "{found:#}"
    );
    let shift = (100.0_f64 + 16.0 + 25.0).sqrt();
    assert!((number(&found["sheet"]["shift_mm"]) - shift).abs() < 0.5, "{found:#}");
    assert!((number(&found["sheet"]["turn_deg"]) - 2.0).abs() < 0.1, "{found:#}");
    let said = bench.run(&format!("{LINE} sheet.png")).ok();
    assert!(said.words().contains("rectify again"), "{}", said.text());

    // The drawn pattern checks the rig at any time, with the sheet anywhere.
    let panel = checker().image().unwrap();
    let elsewhere = Scene { tilt_deg: [-5.0, 30.0], ..scene };
    photo(&bench, "drawn.png", &elsewhere.photograph_of(&panel, &scene, 0.0));
    let found = json(&bench, "drawn.png --as-drawn --fail-if-moved");
    assert_eq!(
        (&found["rig"]["moved"], &found["pattern"]),
        (&Value::Bool(false), &Value::from("as-drawn")),
        "{found:#}"
    );
    photo(&bench, "drawn.png", &elsewhere.photograph_of(&panel, &scene, -0.3));
    assert_eq!(json(&bench, "drawn.png --as-drawn")["rig"]["moved"], true);
}

#[test]
fn a_rig_without_covariance_says_so() {
    let (bench, scene, straight) = rectified();
    photo(&bench, "now.png", &scene.photograph_of(&straight, &scene, 0.0));
    let mut rig: Value = serde_json::from_str(&bench.text("rig.json")).unwrap();
    rig.as_object_mut().unwrap().remove("covariance");
    bench.put("rig.json", rig.to_string());
    assert_eq!(json(&bench, "now.png")["with_covariance"], false);
    assert!(bench.run(&format!("{LINE} now.png")).ok().words().contains("no covariance"));
}

#[test]
fn what_does_not_belong_together_is_refused() {
    let (bench, scene, straight) = rectified();
    let now = scene.photograph_of(&straight, &scene, 0.0);
    photo(&bench, "now.png", &now);
    // Another camera's photograph.
    photo(&bench, "small.png", &image::imageops::thumbnail(&now, 480, 360));
    bench.run(&format!("{LINE} small.png")).fails(3, &["small.png", "960x720", "480x360"]);
    // No sheet, no pattern.
    photo(&bench, "dark.png", &RgbImage::from_pixel(960, 720, image::Rgb([9; 3])));
    bench.run(&format!("{LINE} dark.png")).fails(4, &["dark.png", "checkerboard"]);
    // Another pattern, of this panel and of another one.
    let _ = bench.run("pattern checker --projector 1024x768 --squares 8x5 -o other.png").ok();
    bench.run(&LINE.replace("checker.json", "other.json now.png")).fails(4, &["now.png", "8x5"]);
    let _ = bench.run("pattern checker --projector 800x600 -o wide.png").ok();
    bench
        .run(&LINE.replace("checker.json", "wide.json now.png"))
        .fails(3, &["wide.json", "1024x768", "800x600"]);
    // Files and options.
    bench.run(&format!("{LINE} none.png")).fails(3, &["none.png"]);
    bench.run("verify --rig checker.json --pattern checker.json now.png").fails(3, &["checker.json"]);
    bench.run(&format!("{LINE} now.png --significance 2")).fails(2, &["significance"]);
    // A rig without a projector, or without the view that was rectified for.
    let mut rig: Value = serde_json::from_str(&bench.text("rig.json")).unwrap();
    rig["views"] = Value::Array(Vec::new());
    bench.put("empty.json", rig.to_string());
    bench
        .run("verify --rig empty.json --pattern checker.json now.png --size A2-landscape")
        .fails(3, &["empty.json", "view"]);
    bench.run("verify --rig empty.json --pattern checker.json now.png").fails(2, &["--size"]);
    rig["projector"] = Value::Null;
    rig["projector_from_camera"] = Value::Null;
    bench.put("alone.json", rig.to_string());
    bench
        .run("verify --rig alone.json --pattern checker.json now.png")
        .fails(3, &["alone.json", "projector"]);
}
