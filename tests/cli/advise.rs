//! `slcal advise`, from rigs and from rough descriptions.

use serde_json::Value;
use slcal_core::pattern::{CheckerConfig, CheckerPattern};
use slcal_tests::{Bench, Scene};

use crate::bench;

fn json(bench: &Bench, line: &str) -> Value {
    serde_json::from_str(&bench.run(&format!("advise {line} --json")).ok().text()).unwrap()
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or_else(|| panic!("{v} is no number"))
}

fn row(found: &Value, a: f64, b: f64) -> &Value {
    let near = |t: &Value, name: &str, deg: f64| (number(&t[name]) - deg).abs() < 1e-6;
    let table = found["table"].as_array().unwrap();
    table
        .iter()
        .find(|t| near(t, "tilt_about_horizontal_deg", a) && near(t, "tilt_about_vertical_deg", b))
        .unwrap()
}

#[test]
fn a_rough_camera_gives_a_table_and_a_first_pair() {
    let bench = bench();
    let line = "--image 1280x960 --focal 1500 --size 594x420mm --distance 1000mm --noise 0.2 --flatness flat --distortion none";
    let found = json(&bench, &format!("{line} --camera-pp centre"));
    assert_eq!(found["schema"], "slcal-advice/1");
    // Exact principal point, tilts of one axis: the bound is known to be 0.27 % and 0.29 % at 30°.
    for (a, b, bound) in [(30.0, 0.0, 0.27), (0.0, 30.0, 0.29), (0.0, -30.0, 0.29)] {
        let sigma = number(&row(&found, a, b)["one"]["camera_focal_percent"]);
        assert!((sigma / bound - 1.0).abs() < 0.05, "{a} {b}: {sigma}");
    }
    assert_eq!((&found["sigma_now"], &found["next"]["then_reversed"]), (&Value::Null, &Value::Bool(true)));
    let uncertain = json(&bench, line);
    let of = |v: &Value, which: &str| number(&row(v, 20.0, 20.0)[which]["camera_focal_percent"]);
    assert!(
        of(&uncertain, "one") > 4.0 * of(&found, "one"),
        "{} {}",
        of(&uncertain, "one"),
        of(&found, "one")
    );
    assert!(of(&uncertain, "pair") < 1.5 * of(&found, "pair"));
    // The same lens told in other ways.
    for lens in ["--fov 46.2127", "--focal-35mm 40.5624"] {
        let other = json(&bench, &line.replace("--focal 1500", lens));
        assert!((of(&other, "one") / of(&uncertain, "one") - 1.0).abs() < 1e-4, "{lens}");
    }
    let said = bench.run(&format!("advise {line} --projector 1024x768 --throw 1.66")).ok().words();
    for words in [
        "camera, after one",
        "projector, after two",
        "+30°",
        "nearer to the camera",
        "tilts reversed",
        "after both",
    ] {
        assert!(said.contains(words), "no {words} in {said}");
    }
}

#[test]
fn a_rig_is_told_its_next_photograph_and_the_photograph_brings_it() {
    let scene = Scene::default();
    let bench = bench();
    let _ = bench.run("pattern checker --projector 1024x768 -o checker.png").ok();
    let panel = CheckerPattern::new([1024, 768], &CheckerConfig::default()).unwrap().image().unwrap();
    scene.photograph_of(&panel, &scene, 0.0).save(bench.path("a.png")).unwrap();
    let calibrate = "--size A2-landscape --pattern checker.json --distortion none -o";
    let _ = bench.run(&format!("calibrate a.png {calibrate} one.json")).ok();
    let advice = json(&bench, "--rig one.json --pattern checker.json");
    assert_eq!(advice["worth_it"], true, "{advice:#}");
    let next = &advice["next"];
    // Taken as told: the scene turns about x first, so its tilts follow from the sheet's normal.
    let r = &next["camera_from_sheet"]["R"];
    let normal = [0, 1, 2].map(|i| number(&r[i][2]));
    let (a, b) = ((-normal[1]).asin(), normal[0].atan2(normal[2]));
    let t = &next["camera_from_sheet"]["t"];
    let half = [297.0, 210.0];
    let centre: [f64; 3] =
        std::array::from_fn(|i| number(&t[i]) + number(&r[i][0]) * half[0] + number(&r[i][1]) * half[1]);
    let taken = Scene { tilt_deg: [a.to_degrees(), b.to_degrees()], centre_mm: centre, ..scene };
    taken.photograph_of(&panel, &scene, 0.0).save(bench.path("b.png")).unwrap();
    let _ = bench.run(&format!("calibrate a.png b.png {calibrate} two.json")).ok();
    let two: Value = serde_json::from_str(&bench.text("two.json")).unwrap();
    for device in ["camera", "projector"] {
        let told = number(&next["sigma_after"][format!("{device}_focal_percent")]);
        let came = number(&two["quality"]["focal_sigma_percent"][device]);
        // Edges that are foreshortened otherwise are measured otherwise: the order is right.
        assert!(told / came > 0.5 && told / came < 2.0, "{device}: told {told}, came {came}");
    }
    let said = bench.run("advise --rig two.json").ok().words();
    assert!(said.contains("now ") && said.contains("next "), "{said}");
}

#[test]
fn what_is_missing_is_said() {
    let bench = bench();
    for (line, words) in [
        ("advise", vec!["--rig"]),
        ("advise --image 640x480 --size A4", vec!["--focal"]),
        ("advise --image 640x480 --focal 800", vec!["--size"]),
        ("advise --image 640x480 --focal -800 --size A4", vec!["--focal"]),
        ("advise --image 640x480 --fov 180 --size A4", vec!["--fov", "179"]),
        ("advise --image 640x480 --focal 800 --size A4 --projector 800x600", vec!["--throw"]),
        ("advise --image 640x480 --focal 800 --size A4 --distance 4", vec!["unit"]),
        ("advise --image 640x480 --focal 800 --size A4 --noise 0", vec!["positive"]),
        ("advise --rig rig.json --image 640x480 --focal 3", vec!["--rig"]),
    ] {
        bench.run(line).fails(2, &words);
    }
    bench.put(
        "camera.json",
        r#"{"schema": "slcal-rig/1", "units": "mm", "pixel_centre": "integer", "projector": null, "projector_from_camera": null,
            "camera": {"width": 960, "height": 720, "K": [[1150, 0, 479.5], [0, 1150, 359.5], [0, 0, 1]],
                       "distortion": [0, 0, 0, 0, 0]}}"#,
    );
    bench.run("advise --rig camera.json").fails(3, &["camera.json", "views"]);
    let _ = json(&bench, "--camera camera.json --size A2-landscape");
    bench.run("advise --rig none.json").fails(3, &["none.json"]);
}
