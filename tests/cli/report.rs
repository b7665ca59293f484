//! `slcal report`: what stands in the file. `tests/browser` looks at it in a browser.

use image::{DynamicImage, ImageFormat};
use serde_json::{Value, json};
use slcal_core::pattern::{CheckerConfig, CheckerPattern};
use slcal_tests::{Bench, Scene};

use crate::bench;

/// Two photographs, the rig that they give and the checkerboard.
fn calibrated() -> Bench {
    let bench = bench();
    let _ = bench.run("pattern checker --projector 1024x768 -o checker.png").ok();
    let checker = CheckerPattern::new([1024, 768], &CheckerConfig::default()).unwrap();
    let scene = Scene::default();
    let reversed = Scene { tilt_deg: [-24.0, 26.0], ..scene };
    for (name, scene) in [("a.png", scene), ("b.png", reversed)] {
        DynamicImage::ImageRgb8(scene.photograph(Some(&checker)))
            .save_with_format(bench.path(name), ImageFormat::Png)
            .unwrap();
    }
    let _ = bench.run("calibrate a.png b.png --size A2-landscape --pattern checker.json -o rig.json").ok();
    bench
}

/// A rig as one would write it by hand.
fn by_hand() -> Value {
    let device = |w: u32, h: u32| {
        json!({ "width": w, "height": h, "K": [[1200.5, 0, 319.5], [0, 1210.25, 239.5], [0, 0, 1]],
                "distortion": [0.1, 0, 0, 0, 0] })
    };
    json!({
        "schema": "slcal-rig/1", "units": "mm", "pixel_centre": "integer", "camera": device(640, 480),
        "projector": device(1024, 768), "views": [], "method": "by hand",
        "projector_from_camera": { "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "t": [-200.125, 3, 1e-7] },
    })
}

/// Every number with the field that it is said to be.
fn fields(html: &str) -> Vec<(String, f64)> {
    let attribute = |tag: &str, name: &str| {
        let rest = tag.split_once(&format!("{name}=\""))?.1;
        Some(rest.split_once('"')?.0.to_owned())
    };
    html.split("<span")
        .filter_map(|tag| {
            Some((attribute(tag, "data-field")?, attribute(tag, "data-value")?.parse().unwrap()))
        })
        .collect()
}

fn at<'a>(rig: &'a Value, path: &str) -> &'a Value {
    path.split('.').fold(rig, |v, key| key.parse::<usize>().map_or_else(|_| &v[key], |i| &v[i]))
}

#[test]
fn every_number_is_that_of_the_rig() {
    let bench = calibrated();
    let run = bench.run("report --rig rig.json --pattern checker.json -o report.html").ok();
    assert!(run.text().is_empty() && run.stderr.contains("a.png: shown"), "{}", run.stderr);
    let (html, rig): (String, Value) =
        (bench.text("report.html"), serde_json::from_str(&bench.text("rig.json")).unwrap());
    let found = fields(&html);
    assert!(found.len() > 30, "{found:?}");
    for (path, value) in &found {
        assert_eq!(at(&rig, path).as_f64(), Some(*value), "{path}");
    }
    for path in
        ["camera.K.0.0", "projector.sigma.cy_px", "views.1.rms_px.edges", "quality.expected_point_sigma_mm"]
    {
        assert!(found.iter().any(|(p, _)| p == path), "{path} is missing");
    }
    for words in
        ["Good", "residuals-image", "expected-slice", "slcal advise --rig rig.json --pattern checker.json"]
    {
        assert!(html.contains(words), "no {words}");
    }
    // Nothing is loaded, and the same inputs give the same file.
    for address in [" src=\"http", "url(http", "<link rel=\"stylesheet\"", "@import"] {
        assert!(!html.contains(address), "{address}");
    }
    std::fs::remove_file(bench.path("report.html")).unwrap();
    let _ = bench.run("report --rig rig.json --pattern checker.json -o report.html").ok();
    assert!(bench.text("report.html") == html);
    bench.run("report --rig rig.json -o report.html").fails(1, &["report.html", "--force"]);
    bench.run("report --rig rig.json -o rig.json --force").fails(2, &["rig.json"]);
}

#[test]
fn what_is_missing_is_said_in_a_line() {
    let bench = calibrated();
    // No photographs: the rig alone.
    std::fs::create_dir(bench.path("else")).unwrap();
    bench.put(
        "else/rig.json",
        bench.text("rig.json").replace("a.png", "gone a.png").replace("b.png", "gone b.png"),
    );
    let run = bench.run("report --rig else/rig.json -o alone.html").ok();
    assert!(run.stderr.contains("gone a.png: not found"), "{}", run.stderr);
    let html = bench.text("alone.html");
    assert!(html.contains("Plots of the residuals are not shown") && html.contains("views.0.rms_px.edges"));
    // A rig from elsewhere, with and without a projector.
    bench.put("hand.json", by_hand().to_string());
    let _ = bench.run("report --rig hand.json -o hand.html").ok();
    let html = bench.text("hand.html");
    for words in
        ["No verdict", "states no ±", "lists no photographs", "1200.5", "has no covariance", "to the right"]
    {
        assert!(html.contains(words), "no {words}");
    }
    let mut alone = by_hand();
    (alone["projector"], alone["projector_from_camera"]) = (Value::Null, Value::Null);
    bench.put("camera.json", alone.to_string());
    let _ = bench.run("report --rig camera.json -o camera.html").ok();
    assert!(bench.text("camera.html").contains("This rig has no projector"));
}

#[test]
fn other_verbs_write_reports_in_the_same_run() {
    let bench = calibrated();
    let line =
        "calibrate a.png b.png --size A2-landscape --pattern checker.json -o again.json --report cal.html";
    let _ = bench.run(line).ok();
    let html = bench.text("cal.html");
    // Both photographs with what was measured in them, and the line that was typed.
    assert_eq!(html.matches("data:image/jpeg;base64,").count(), 2);
    for words in
        ["residuals-image", &format!("slcal {line}"), "slcal verify --rig again.json --pattern checker.json"]
    {
        assert!(html.contains(words), "no {words}");
    }
    bench.run(line).fails(1, &["again.json", "--force"]);
    bench.run("calibrate a.png --size A4 -o new.json --report cal.html").fails(1, &["cal.html", "--force"]);
    bench.run("calibrate a.png --size A4 -o new.json --report -").fails(2, &["--report"]);
    bench
        .run("reconstruct --rig again.json --pattern s.json a.png b.png --out-dir d --report r.html")
        .fails(2, &["--report takes one photograph"]);
    let observations = "--save-observations seen.json --force";
    let _ = bench.run(&format!("{line} {observations}")).ok();
    let _ = bench.run("report --rig again.json --observations seen.json -o seen.html").ok();
    assert!(bench.text("seen.html").contains("residuals-distribution"));
    // Those of another rig: two views where this one has one.
    let _ = bench.run("calibrate a.png --size A2-landscape --pattern checker.json -o one.json").ok();
    bench
        .run("report --rig one.json --observations seen.json -o one.html")
        .fails(3, &["seen.json", "2 view(s)"]);
}

#[test]
fn what_is_no_rig_is_refused() {
    let bench = bench();
    let mut newer = by_hand();
    newer["schema"] = json!("slcal-rig/2");
    bench.put("newer.json", newer.to_string());
    bench.put("nan.json", by_hand().to_string().replace("1200.5", "NaN"));
    bench.put("hand.json", by_hand().to_string());
    bench.run("report --rig newer.json -o r.html").fails(3, &["newer.json", "slcal-rig/2"]);
    bench.run("report --rig nan.json -o r.html").fails(3, &["nan.json"]);
    bench.run("report --rig none.json -o r.html").fails(3, &["none.json", "no such file"]);
    bench.run("report --rig hand.json --photo a.png -o r.html").fails(2, &["--photo", "0 views", "found 1"]);
    bench.run("report --rig hand.json --cloud hand.json -o r.html").fails(3, &["hand.json", "PLY"]);
    assert_eq!(bench.names(), ["hand.json", "nan.json", "newer.json"]);
}

#[test]
fn names_cannot_put_anything_into_the_page() {
    let bench = bench();
    let hostile = "</script><script>document.title='hacked'</script><!--\"'é& .json";
    let name = hostile.replace('/', "_");
    let mut rig = by_hand();
    rig["views"] = json!([{
        "photo": hostile, "size_mm": [594, 420],
        "camera_from_sheet": { "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "t": [-300, -200, 1000] },
        "corners_px": [[10, 10], [600, 10], [600, 400], [10, 400]],
    }]);
    rig["quality"] = json!({
        "verdict": "good", "focal_sigma_percent": { "camera": 1.0, "projector": 1.0 }, "expected_point_sigma_mm": 1.0,
        "cause": hostile, "advice": hostile, "warnings": [{ "code": hostile, "message": hostile, "advice": hostile }],
    });
    bench.put(&name, rig.to_string());
    let _ = bench.run_args(&["report", "--rig", &name, "-o", "r.html"], b"").ok();
    let html = bench.text("r.html");
    // The scripts are the scene and the page's own.
    assert_eq!((html.matches("<script").count(), html.matches("</script").count()), (2, 2));
    assert!(!html.contains("<!--"));
}
