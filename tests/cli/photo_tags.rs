//! What cameras write into their photographs: focal lengths of every kind, crops, orientations, and tags that lie; and
//! photographs that are overexposed.

use std::io::Cursor;

use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, ImageFormat, RgbImage};
use serde_json::Value;
use slcal_core::pattern::{CheckerConfig, CheckerPattern};
use slcal_core::photo::Encoding;
use slcal_tests::exif::{ExifValue, focal_35mm, focal_length, model, orientation, pixels, with_exif};
use slcal_tests::{Bench, Scene};

use crate::bench;

const SIZE: [u32; 2] = [960, 720];
/// The scene's 1150 px of 960 on the 7.44 mm of a Canon PowerShot G10.
const G10_MM: f64 = 1150.0 * 7.44 / 960.0;
const PAIR: &str = "calibrate a.jpg b.jpg --size A2-landscape --pattern checker.json --json";

fn scenes() -> [Scene; 2] {
    [Scene::default(), Scene { tilt_deg: [-24.0, 26.0], ..Scene::default() }]
}

fn checker() -> CheckerPattern {
    CheckerPattern::new([1024, 768], &CheckerConfig::default()).unwrap()
}

fn jpeg(photo: &DynamicImage, tags: &[(u16, ExifValue)]) -> Vec<u8> {
    let mut plain = Vec::new();
    photo.write_with_encoder(JpegEncoder::new_with_quality(Cursor::new(&mut plain), 98)).unwrap();
    with_exif(&plain, tags)
}

fn photographs(pattern: bool) -> [DynamicImage; 2] {
    let checker = checker();
    scenes().map(|s| DynamicImage::ImageRgb8(s.photograph(pattern.then_some(&checker))))
}

fn with_pattern() -> Bench {
    let bench = bench();
    let _ = bench.run("pattern checker --projector 1024x768 -o checker.png").ok();
    bench
}

fn rig(bench: &Bench, line: &str) -> Value {
    serde_json::from_str(&bench.run(line).ok().text()).unwrap()
}

/// The warnings about the photograph's file, without those about the geometry.
fn codes(rig: &Value) -> Vec<&str> {
    const OF_THE_FILE: [&str; 4] = ["exif-focal-differs", "cropped", "orientation-differs", "clipped"];
    let warnings = rig["quality"]["warnings"].as_array().unwrap();
    let all = warnings.iter().map(|w| w["code"].as_str().unwrap());
    all.filter(|code| OF_THE_FILE.contains(code)).collect()
}

fn message<'a>(rig: &'a Value, code: &str) -> &'a str {
    let warnings = rig["quality"]["warnings"].as_array().unwrap();
    let found = warnings.iter().find(|w| w["code"] == code);
    found.unwrap_or_else(|| panic!("no {code} in {:?}", codes(rig)))["message"].as_str().unwrap()
}

fn focal(rig: &Value) -> [f64; 2] {
    [&rig["camera"]["K"][0][0], &rig["camera"]["sigma"]["focal_px"]].map(|v| v.as_f64().unwrap())
}

#[test]
fn the_lens_and_the_sensor_give_a_focal_length_without_an_equivalent() {
    let face_on = Scene { tilt_deg: [1.0, -2.0], ..Scene::default() };
    let photo = DynamicImage::ImageRgb8(face_on.photograph(None));
    let bench = bench();
    let line = "calibrate photo.jpg --size A2-landscape --exif --json";
    let whole = pixels([4416, 3312]);
    let per_inch = (0xA20E, ExifValue::Rational(4_416_000, 293));
    let unit = (0xA210, ExifValue::Short(2));
    let by_table = [model("Canon PowerShot G10"), focal_length(G10_MM)].to_vec();
    let by_plane = [whole.to_vec(), vec![focal_length(G10_MM), per_inch, unit]].concat();
    for tags in [by_table, by_plane] {
        bench.put("photo.jpg", jpeg(&photo, &tags));
        let run = bench.run(line).ok();
        assert!(
            run.stderr.contains("EXIF: focal length 8.91 mm on") && run.stderr.contains("7.44 mm wide"),
            "{}",
            run.stderr
        );
        let rig: Value = serde_json::from_str(&run.text()).unwrap();
        let [f, sigma] = focal(&rig);
        assert!((f - 1150.0).abs() < 2.0 * sigma && (0.02..0.045).contains(&(sigma / f)), "{f} ± {sigma}");
    }
    bench.put("photo.jpg", jpeg(&photo, &[model("Unknown X1"), focal_length(G10_MM)]));
    bench.run(line).fails(3, &["--exif", "only the actual focal length, 8.91 mm"]);
}

#[test]
fn a_focal_length_in_the_tags_that_contradicts_the_result_is_told_unasked() {
    let [photo, _] = photographs(true);
    let bench = with_pattern();
    let line = "calibrate photo.jpg --size A2-landscape --pattern checker.json --json";
    // 41.5 mm is right; tags are good for 5 %.
    for right in [39, 41, 44] {
        bench.put("photo.jpg", jpeg(&photo, &[focal_35mm(right)]));
        let rig = rig(&bench, line);
        assert_eq!(rig["quality"]["verdict"], "good");
        assert!(codes(&rig).is_empty(), "{right}: {:?}", codes(&rig));
    }
    bench.put("photo.jpg", jpeg(&photo, &[focal_35mm(28)]));
    let zoomed = rig(&bench, line);
    let told = message(&zoomed, "exif-focal-differs");
    assert!(told.contains("photo.jpg") && told.contains("1.48 times") && told.contains("28 mm"), "{told}");
    assert_eq!(zoomed["quality"]["verdict"], "weak");
    // Tags that lie end no calibration.
    for absurd in [
        &[focal_35mm(65535)][..],
        &[focal_length(0.0)],
        &pixels([0, 0]),
        &[(0xA404, ExifValue::Rational(1, 0))],
    ] {
        bench.put("photo.jpg", jpeg(&photo, absurd));
        assert_eq!(rig(&bench, line)["quality"]["verdict"], "good");
    }
}

#[test]
fn a_crop_is_told_by_the_size_in_the_tags() {
    let [a, b] = photographs(true);
    let bench = with_pattern();
    let line = "calibrate a.jpg --size A2-landscape --pattern checker.json --json";
    let whole = pixels(SIZE);
    bench.put("a.jpg", jpeg(&a, &whole));
    assert!(codes(&rig(&bench, line)).is_empty());
    // Off the left and the top: the axis no longer meets the middle.
    let crop = |photo: &DynamicImage| photo.crop_imm(120, 60, 840, 660);
    bench.put("a.jpg", jpeg(&crop(&a), &whole));
    let cropped = rig(&bench, line);
    assert_eq!(cropped["quality"]["verdict"], "weak");
    let told = message(&cropped, "cropped");
    assert!(told.contains("840x660") && told.contains("960x720"), "{told}");
    // The principal point that a user knows leaves nothing to doubt.
    let known = rig(&bench, &format!("{line} --camera-pp 359.5,299.5"));
    assert_eq!((known["quality"]["verdict"].as_str(), codes(&known)), (Some("good"), vec![]));
    // Two photographs find it themselves.
    bench.put("b.jpg", jpeg(&crop(&b), &whole));
    let both = rig(&bench, PAIR);
    assert!(message(&both, "cropped").contains("determine"));
    let [f, sigma] = focal(&both);
    assert!((f - 1150.0).abs() < 4.0 * sigma && sigma < 0.01 * f, "{f} ± {sigma}");
    // Half the size is a resized picture, and said only.
    bench.put("a.jpg", jpeg(&a, &pixels([1920, 1440])));
    let run = bench.run(line).ok();
    assert!(run.stderr.contains("1920x1440") && run.stderr.contains("resized"), "{}", run.stderr);
    let resized: Value = serde_json::from_str(&run.text()).unwrap();
    assert!(codes(&resized).is_empty(), "{:?}", codes(&resized));
    // By its focal length it was the middle of a picture of twice the size.
    bench.put("a.jpg", jpeg(&a, &[pixels([1920, 1440]).to_vec(), vec![focal_35mm(21)]].concat()));
    assert!(message(&rig(&bench, line), "cropped").contains("cropped after"));
}

#[test]
fn photographs_that_their_tags_turn_differently_are_turned_back() {
    let [a, b] = photographs(true);
    let bench = with_pattern();
    bench.put("a.jpg", jpeg(&a, &[orientation(1)]));
    bench.put("b.jpg", jpeg(&b, &[orientation(1)]));
    let right = rig(&bench, PAIR);
    assert!(codes(&right).is_empty(), "{:?}", codes(&right));
    for tag in [3, 6, 8] {
        bench.put("b.jpg", jpeg(&b, &[orientation(tag)]));
        let turned = rig(&bench, &format!("{PAIR} --overlay o{tag}.png --report r{tag}.html"));
        let told = message(&turned, "orientation-differs");
        assert!(told.contains(&format!("b.jpg ({tag})")) && told.contains("a.jpg (1)"), "{told}");
        for part in ["camera", "projector"] {
            let [f, expected] = [&turned, &right].map(|r| r[part]["K"][0][0].as_f64().unwrap());
            assert!((f / expected - 1.0).abs() < 1e-3, "{tag}, {part}: {f} for {expected}");
        }
        assert_eq!(turned["camera"]["width"], 960);
        assert_eq!(turned["quality"]["verdict"], "good");
    }
    // It may as well be the first one, or both.
    for (tag_a, tag_b) in [(6, 1), (6, 8), (3, 1)] {
        bench.put("a.jpg", jpeg(&a, &[orientation(tag_a)]));
        bench.put("b.jpg", jpeg(&b, &[orientation(tag_b)]));
        let turned = rig(&bench, PAIR);
        assert!(message(&turned, "orientation-differs").contains(&format!("({tag_b})")));
        let [f, expected] = [&turned, &right].map(|r| r["camera"]["K"][0][0].as_f64().unwrap());
        assert!((f / expected - 1.0).abs() < 1e-3, "{tag_a} {tag_b}: {f} for {expected}");
    }
    bench.put("a.jpg", jpeg(&a, &[orientation(1)]));
    // A file whose pixels were turned and whose tag was left: the tag puts both right.
    bench.put("b.jpg", jpeg(&b.rotate180(), &[orientation(3)]));
    let kept = rig(&bench, PAIR);
    assert!(codes(&kept).is_empty(), "{:?}", codes(&kept));
    // Neither way: another scene.
    let other = Scene { camera_focal_px: 700.0, projector_mm: [300.0, -80.0, 200.0], ..Scene::default() };
    let other = DynamicImage::ImageRgb8(other.photograph(Some(&checker())));
    bench.put("b.jpg", jpeg(&other.rotate90(), &[orientation(1)]));
    bench.run(PAIR).fails(3, &["b.jpg", "960x720", "720x960"]);
}

#[test]
fn a_camera_that_was_held_upright_is_turned_together_with_its_sheet() {
    // The camera alone, turned by a quarter between the photographs, as its tag says: one sensor sees both.
    let [a, _] = photographs(false);
    let upright = Scene { size_mm: [420.0, 594.0], tilt_deg: [-24.0, 26.0], ..Scene::default() };
    let b = DynamicImage::ImageRgb8(upright.photograph(None));
    let bench = bench();
    bench.put("a.jpg", jpeg(&a, &[orientation(1)]));
    // On the sensor the sheet stands on its short side, in the upright picture it lies.
    bench.put("b.jpg", jpeg(&b, &[orientation(6)]));
    let rig = rig(&bench, "calibrate a.jpg b.jpg --size A2-landscape --json");
    let _ = message(&rig, "orientation-differs");
    let [f, sigma] = focal(&rig);
    assert!((f - 1150.0).abs() < 4.0 * sigma && sigma < 0.02 * f, "{f} ± {sigma}");
}

/// The photograph with this many times the light, in 8 bit or 16.
fn exposed(photo: &RgbImage, times: f64, deep: bool) -> DynamicImage {
    let code = |c: u8| Encoding::Srgb.from_linear(times * Encoding::Srgb.to_linear(f64::from(c) / 255.0));
    if deep {
        let samples = photo.as_raw().iter().map(|c| (code(*c) * 65535.0).round() as u16).collect();
        DynamicImage::ImageRgb16(
            image::ImageBuffer::from_raw(photo.width(), photo.height(), samples).unwrap(),
        )
    } else {
        let samples = photo.as_raw().iter().map(|c| (code(*c) * 255.0).round() as u8).collect();
        DynamicImage::ImageRgb8(RgbImage::from_raw(photo.width(), photo.height(), samples).unwrap())
    }
}

#[test]
fn an_overexposed_sheet_is_told_in_8_and_16_bit() {
    let photo = Scene::default().photograph(Some(&checker()));
    let bench = with_pattern();
    let line = "calibrate photo.png --size A2-landscape --pattern checker.json -o rig.json --force";
    for deep in [false, true] {
        for (times, blown_out) in [(1.0, false), (4.0, true)] {
            exposed(&photo, times, deep).save_with_format(bench.path("photo.png"), ImageFormat::Png).unwrap();
            let run = bench.run(line).ok();
            let rig: Value = serde_json::from_str(&bench.text("rig.json")).unwrap();
            let share = rig["views"][0]["clipped_percent"].as_f64().unwrap_or(0.0);
            assert_eq!(codes(&rig).contains(&"clipped"), blown_out, "{deep} {times}: {share}");
            assert_eq!(share > 50.0, blown_out, "{share}");
            assert_eq!(run.text().contains("of the lit sheet is overexposed"), blown_out, "{}", run.text());
            if blown_out {
                assert!(
                    message(&rig, "clipped").starts_with("photo.png: "),
                    "{:?}",
                    message(&rig, "clipped")
                );
            }
        }
    }
}
