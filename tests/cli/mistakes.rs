//! Ordinary mistakes on photographs: what the summary, the exit code and the file say of each, and how far the numbers are off.

use serde_json::Value;
use slcal_tests::Bench;

use crate::bench;

const PANEL: &str = "--projector 1024x768";
const TILTS: [(&str, &str); 2] = [("a", "25,28"), ("b", "-25,-28")];

/// A photograph of the sheet with one tilt or the other, as NAME.png, and the true rig.
fn photograph(bench: &Bench, name: &str, tilt: &str, more: &str) -> Value {
    let scene = format!(
        "simulate scene --surface sheet --size A2-landscape --distance 1100 --bend 0.1%,30 --tilt {tilt} --out {name} -q {more}"
    );
    let _ = bench.run(&scene).ok();
    std::fs::copy(bench.path(name).join("photo.png"), bench.path(&format!("{name}.png"))).unwrap();
    serde_json::from_str(&bench.text(&format!("{name}/rig.json"))).unwrap()
}

/// Both photographs of a rig under one pattern, checker.json, and the truth. `panel` are the pattern's options.
fn pair(bench: &Bench, panel: &str, more: &str) -> Value {
    let _ = bench.run(&format!("pattern checker {panel} -o checker.png -q")).ok();
    let more = format!("--pattern checker.json {more}");
    let truths = TILTS.map(|(name, tilt)| photograph(bench, name, tilt, &more));
    truths[0].clone()
}

fn calibrated(bench: &Bench, photos: &str) -> Value {
    let line =
        format!("calibrate {photos} --size A2-landscape --pattern checker.json -o rig.json --force --json");
    serde_json::from_slice(&bench.run(&line).ok().stdout).unwrap()
}

fn codes(result: &Value) -> Vec<String> {
    let warnings = rig(result)["quality"]["warnings"].as_array().unwrap();
    warnings.iter().map(|w| w["code"].as_str().unwrap().to_owned()).collect()
}

fn rig(result: &Value) -> &Value {
    if result["rig"].is_null() { result } else { &result["rig"] }
}

/// Errors of fx, cx and cy of a device in their σ.
fn errors(found: &Value, truth: &Value, device: &str) -> [f64; 3] {
    let (found, truth) = (&rig(found)[device], &truth[device]);
    let of = |i: usize, j: usize, sigma: &str| {
        let number = |v: &Value| v.as_f64().unwrap();
        (number(&found["K"][i][j]) - number(&truth["K"][i][j])) / number(&found["sigma"][sigma])
    };
    [of(0, 0, "focal_px"), of(0, 2, "cx_px"), of(1, 2, "cy_px")]
}

fn right_and_good(found: &Value, truth: &Value) {
    assert_eq!(rig(found)["quality"]["verdict"], "good");
    for device in ["camera", "projector"] {
        let off = errors(found, truth, device);
        assert!(off.iter().all(|e| e.abs() < 4.0), "{device}: {off:.1?}");
    }
}

#[test]
fn right_photographs_get_no_warning_of_a_mistake() {
    let bench = bench();
    let truth = pair(&bench, PANEL, "--lens-shift 0.5");
    let found = calibrated(&bench, "a.png b.png");
    right_and_good(&found, &truth);
    assert_eq!(codes(&found), [""; 0]);
}

#[test]
fn a_sideways_shift_is_priced_from_one_photograph_and_estimated_from_two() {
    let bench = bench();
    let truth = pair(&bench, PANEL, "--lens-shift 0.5 --projector-offset 102");
    let one = calibrated(&bench, "a.png");
    let assumptions = rig(&one)["quality"]["assumptions"].as_array().unwrap();
    let told = assumptions.iter().find(|a| a["code"] == "projector-sideways-shift").unwrap();
    assert_eq!((&told["status"], &told["if_off_by"]), (&"assumed".into(), &5.0.into()));
    let f = |v: &Value| rig(v)["projector"]["K"][0][0].as_f64().unwrap();
    let error = 100.0 * (f(&one) / f(&truth) - 1.0).abs();
    // The lens is off by twice what is priced.
    let cost = 2.0 * told["moves_percent"]["f_proj"].as_f64().unwrap().abs();
    assert!(error > 3.0 && error < 1.5 * cost, "{error} {cost}");
    let summary = bench.run("calibrate a.png --size A2-landscape --pattern checker.json -o one.json").ok();
    let words = summary.words();
    assert!(words.contains("good, if what it assumes is true (below)"), "{words}");
    assert!(
        words.contains("the projector's lens is not shifted sideways (5 % of the width would move"),
        "{words}"
    );

    let two = calibrated(&bench, "a.png b.png");
    assert_eq!(codes(&two), ["projector-sideways-shift"]);
    right_and_good(&two, &truth);
}

#[test]
fn a_projector_on_its_side_is_right_from_one_photograph() {
    let bench = bench();
    let truth = pair(&bench, "--projector 768x1024", "--projector 768x1024 --projector-offset 384");
    for photos in ["a.png", "a.png b.png"] {
        let found = calibrated(&bench, photos);
        assert!(codes(&found).contains(&"projector-on-its-side".to_owned()), "{:?}", codes(&found));
        right_and_good(&found, &truth);
    }
}

#[test]
fn diamond_pixels_are_known_and_stretched_pictures_estimated() {
    let bench = bench();
    let diamonds = "--projector 912x1140 --projector-focal 850 --projector-pixel-aspect 2 --lens-shift 0.5";
    let truth = pair(&bench, "--projector 912x1140 --square 30", diamonds);
    right_and_good(&calibrated(&bench, "a.png b.png"), &truth);
    let one = calibrated(&bench, "a.png");
    let off = errors(&one, &truth, "projector");
    assert!(off.iter().all(|e| e.abs() < 4.0), "{off:.1?}");

    let bench = crate::bench();
    let truth = pair(&bench, PANEL, "--projector-focal 1417 --projector-pixel-aspect 1.2 --lens-shift 0.5");
    let found = calibrated(&bench, "a.png b.png");
    assert!(codes(&found).contains(&"projector-pixel-aspect".to_owned()), "{:?}", codes(&found));
    right_and_good(&found, &truth);
    let given = "calibrate a.png --size A2-landscape --pattern checker.json -o one.json --projector-pixel-aspect 1.2 --json";
    let one: Value = serde_json::from_slice(&bench.run(given).ok().stdout).unwrap();
    let off = errors(&one, &truth, "projector");
    assert!(off.iter().all(|e| e.abs() < 4.0), "{off:.1?}");
    for wrong in ["0", "-1", "wide"] {
        let line = format!("calibrate a.png --size A2-landscape -o x.json --projector-pixel-aspect={wrong}");
        bench.run(&line).fails(2, &["pixel"]);
    }
}

#[test]
fn photographs_that_were_stretched_are_right_from_two() {
    let bench = bench();
    let truth = pair(&bench, PANEL, "--lens-shift 0.5 --pixel-aspect 1.03");
    let found = calibrated(&bench, "a.png b.png");
    assert_eq!(codes(&found), ["camera-pixel-aspect"]);
    right_and_good(&found, &truth);
}

#[test]
fn a_photograph_of_a_stabilised_camera_is_named_and_refused() {
    let bench = bench();
    let _ = pair(&bench, PANEL, "--lens-shift 0.5");
    let photo = image::open(bench.path("b.png")).unwrap().to_rgb8();
    let (w, h) = photo.dimensions();
    let displaced = image::RgbImage::from_fn(w, h, |x, y| *photo.get_pixel((x + w - 15) % w, (y + 10) % h));
    displaced.save(bench.path("b.png")).unwrap();
    let run = bench.run("calibrate a.png b.png --size A2-landscape --pattern checker.json -o rig.json");
    run.fails(5, &["photograph 2 is displaced", "15.0 px to the right", "10.0 px up", "stabiliser"]);
    assert!(!bench.names().contains(&"rig.json".to_owned()));
}
