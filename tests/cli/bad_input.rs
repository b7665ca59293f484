//! Everything that can be wrong with an input: its exit code, a message that says what to do, and no file left behind.

use std::fs;
use std::io::Cursor;

use image::{DynamicImage, ImageFormat, RgbImage};
use serde_json::Value;
use slcal_tests::{Bench, Scene, repository};

use crate::bench;

const CALIBRATE: &str = "calibrate photo.png --size 594x420mm --pattern checker.json -o rig.json";

fn png(picture: RgbImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    DynamicImage::ImageRgb8(picture).write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png).unwrap();
    bytes
}

/// A folder with the default checkerboard's description.
fn with_pattern() -> Bench {
    let bench = bench();
    let _ = bench.run("pattern checker --projector 1024x768 -o checker.png").ok();
    fs::remove_file(bench.path("checker.png")).unwrap();
    bench
}

fn checker() -> slcal_core::pattern::CheckerPattern {
    slcal_core::pattern::CheckerPattern::new([1024, 768], &slcal_core::pattern::CheckerConfig::default())
        .unwrap()
}

fn demo_file(name: &str) -> Vec<u8> {
    fs::read(repository().join("crates/slcal-cli/demo").join(name)).unwrap()
}

/// Asserts that a failed run left only what was there before.
fn unchanged(bench: &Bench, expected: &[&str]) {
    assert_eq!(bench.names(), expected);
}

#[test]
fn a_missing_photograph() {
    let bench = with_pattern();
    bench.run(CALIBRATE).fails(3, &["photo.png", "no such file"]);
    unchanged(&bench, &["checker.json"]);
}

#[test]
fn a_truncated_photograph() {
    let bench = with_pattern();
    for bytes in [demo_file("sheet.jpg"), png(Scene::default().photograph(None))] {
        bench.put("photo.png", &bytes[..bytes.len() / 2]);
        bench.run(CALIBRATE).fails(3, &["photo.png", "truncated"]);
    }
    unchanged(&bench, &["checker.json", "photo.png"]);
}

#[test]
fn a_text_file_called_png() {
    let bench = with_pattern();
    bench.put("photo.png", "this is no picture");
    bench.run(CALIBRATE).fails(3, &["photo.png", "PNG, JPEG, TIFF, WebP or BMP", "text file"]);
    bench.put("photo.png", "");
    bench.run(CALIBRATE).fails(3, &["photo.png", "empty"]);
}

#[test]
fn a_heic_and_a_raw_file_are_told_how_to_be_converted() {
    let bench = with_pattern();
    bench.put("photo.png", b"\0\0\0\x18ftypheic\0\0\0\0mif1heic");
    bench.run(CALIBRATE).fails(3, &["HEIC", "convert"]);
    bench.put("photo.nef", b"MM\0*\0\0\0\x08");
    bench.run(&CALIBRATE.replace("photo.png", "photo.nef")).fails(3, &["photo.nef", "raw", "TIFF"]);
}

#[test]
fn a_photograph_that_announces_a_gigantic_picture() {
    // A PNG header of 100000x100000 pixels and nothing after it (the checksum is right).
    let bench = with_pattern();
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
    bytes.extend([0, 1, 0x86, 0xA0, 0, 1, 0x86, 0xA0, 8, 2, 0, 0, 0]);
    let crc = crc32(&bytes[12..]);
    bytes.extend(crc.to_be_bytes());
    bench.put("photo.png", bytes);
    bench.run(CALIBRATE).fails(3, &["photo.png"]);
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |c, _| if c & 1 == 1 { 0xEDB8_8320 ^ (c >> 1) } else { c >> 1 })
    })
}

#[test]
fn a_photograph_without_a_sheet() {
    let bench = with_pattern();
    // A soft gradient: nothing with straight sides.
    let picture =
        RgbImage::from_fn(640, 480, |x, y| image::Rgb([(40 + x / 8) as u8, (60 + y / 8) as u8, 90]));
    bench.put("photo.png", png(picture));
    bench.run(CALIBRATE).fails(4, &["photo.png", "not found"]);
    bench.run("calibrate photo.png --size A4 -o rig.json").fails(4, &["photo.png", "sheet not found"]);
    unchanged(&bench, &["checker.json", "photo.png"]);
}

#[test]
fn a_sheet_without_a_pattern() {
    let bench = with_pattern();
    bench.put("photo.png", png(Scene::default().photograph(None)));
    bench.run(CALIBRATE).fails(4, &["photo.png", "checkerboard not found"]);
    unchanged(&bench, &["checker.json", "photo.png"]);
}

#[test]
fn the_overlay_is_written_though_the_pattern_was_not_found() {
    let bench = with_pattern();
    bench.put("photo.png", png(Scene::default().photograph(None)));
    bench.run(&format!("{CALIBRATE} --overlay seen.png")).fails(4, &["photo.png"]);
    unchanged(&bench, &["checker.json", "photo.png", "seen.png"]);
}

#[test]
fn a_size_that_is_none() {
    let bench = with_pattern();
    for size in ["0x420mm", "NaNx420mm", "-594x420mm", "594x420", "A9", "infx420mm", ""] {
        let args = ["calibrate", "photo.png", "--size", size, "--pattern", "checker.json", "-o", "rig.json"];
        bench.run_args(&args, &[]).fails(2, &["594x420mm"]);
    }
}

#[test]
fn a_pattern_that_is_not_this_one() {
    let bench = with_pattern();
    bench.put("photo.png", png(Scene::default().photograph(Some(&checker()))));
    // Stripes instead of a checkerboard.
    let _ = bench.run("pattern stripes --projector 1024x768 -o stripes.png").ok();
    bench.run(&CALIBRATE.replace("checker.json", "stripes.json")).fails(3, &["stripes.json", "checker"]);
    // Not a pattern, not JSON, not there.
    bench.put("other.json", r#"{"schema": "slcal-rig/1"}"#);
    bench
        .run(&CALIBRATE.replace("checker.json", "other.json"))
        .fails(3, &["other.json", "this is a rig (slcal-rig/1), where a pattern is expected"]);
    bench.put("other.json", "{");
    bench.run(&CALIBRATE.replace("checker.json", "other.json")).fails(3, &["other.json"]);
    bench.run(&CALIBRATE.replace("checker.json", "none.json")).fails(3, &["none.json", "no such file"]);
    // The picture instead of its description.
    let _ = bench.run("pattern checker --projector 1024x768 -o board.png").ok();
    bench
        .run(&CALIBRATE.replace("checker.json", "board.png"))
        .fails(3, &["board.png", "a PNG picture", "did you mean board.json?"]);
    // A board with other squares than the one in the photograph.
    let _ = bench.run("pattern checker --projector 1024x768 --squares 8x7 -o small.png").ok();
    let run = bench.run(&CALIBRATE.replace("checker.json", "small.json"));
    assert!(matches!(run.code, 3..=5), "{} {}", run.code, run.stderr);
}

#[test]
fn a_pattern_for_another_panel_than_the_rigs() {
    let bench = bench();
    bench.put("rig.json", demo_file("truth_rig.json"));
    bench.put("head.jpg", demo_file("head.jpg"));
    let _ = bench.run("pattern stripes --projector 800x600 -o s.png").ok();
    let line = "reconstruct --rig rig.json --pattern s.json head.jpg -o cloud.ply";
    bench.run(line).fails(3, &["s.json", "1024x768", "800x600"]);
    let _ = bench.run("pattern checker --projector 800x600 -o c.png").ok();
    bench.run("rectify --rig rig.json --pattern c.json -o r.png").fails(3, &["c.json", "1024x768"]);
    assert!(!bench.names().iter().any(|n| n == "cloud.ply" || n == "r.png"));
}

#[test]
fn a_rig_with_a_missing_field() {
    let bench = bench();
    let whole: Value = serde_json::from_slice(&demo_file("truth_rig.json")).unwrap();
    bench.put("m.csv", "u,v,projector_column\n600,400,500\n");
    for (device, field) in [("camera", "K"), ("projector", "width"), ("projector_from_camera", "R")] {
        let mut rig = whole.clone();
        rig[device].as_object_mut().unwrap().remove(field);
        bench.put("rig.json", rig.to_string());
        bench.run("triangulate --rig rig.json m.csv -o cloud.ply").fails(3, &["rig.json", field]);
    }
    let mut rig = whole.clone();
    rig["units"] = "m".into();
    bench.put("rig.json", rig.to_string());
    bench.run("triangulate --rig rig.json m.csv -o cloud.ply").fails(3, &["rig.json", "units"]);
    unchanged(&bench, &["m.csv", "rig.json"]);
}

#[test]
fn a_rig_without_a_projector_reconstructs_nothing() {
    let bench = bench();
    let mut rig: Value = serde_json::from_slice(&demo_file("truth_rig.json")).unwrap();
    rig["projector"] = Value::Null;
    rig["projector_from_camera"] = Value::Null;
    bench.put("rig.json", rig.to_string());
    bench.put("m.csv", "u,v,projector_column\n600,400,500\n");
    bench.run("triangulate --rig rig.json m.csv -o cloud.ply").fails(3, &["rig.json", "projector"]);
}

#[test]
fn matches_and_clouds_that_are_none() {
    let bench = bench();
    bench.put("rig.json", demo_file("truth_rig.json"));
    let line = "triangulate --rig rig.json m.csv -o cloud.ply";
    for (text, word) in [("u,v\n1,2\n", "projector_column"), ("u,v,projector_column\n1,two,3\n", "two")] {
        bench.put("m.csv", text);
        bench.run(line).fails(3, &["m.csv", word]);
    }
    bench.put("cloud.ply", "ply\nformat ascii 1.0\nend_header\n");
    bench.run("evaluate plane cloud.ply").fails(3, &["cloud.ply"]);
    bench.put("cloud.ply", "no cloud");
    bench.run("evaluate plane cloud.ply").fails(3, &["cloud.ply"]);
    bench.run("evaluate plane absent.ply").fails(3, &["absent.ply", "no such file"]);
}

#[test]
fn a_photograph_without_stripes() {
    let bench = bench();
    bench.put("rig.json", demo_file("truth_rig.json"));
    bench.put("photo.png", png(Scene { camera: [1280, 960], ..Scene::default() }.photograph(None)));
    let _ = bench.run("pattern stripes --projector 1024x768 -o stripes.png").ok();
    bench
        .run("decode --pattern stripes.json photo.png -o m.csv")
        .fails(4, &["photo.png", "stripes not found"]);
    bench
        .run("reconstruct --rig rig.json --pattern stripes.json photo.png -o cloud.ply")
        .fails(4, &["photo.png", "stripes not found"]);
    assert!(!bench.names().iter().any(|n| n == "m.csv" || n == "cloud.ply"));
}

#[test]
fn a_photograph_of_another_camera_than_the_rigs() {
    let bench = bench();
    bench.put("rig.json", demo_file("truth_rig.json"));
    bench.put("photo.png", png(Scene::default().photograph(None)));
    let _ = bench.run("pattern stripes --projector 1024x768 -o stripes.png").ok();
    bench
        .run("reconstruct --rig rig.json --pattern stripes.json photo.png -o cloud.ply")
        .fails(3, &["photo.png", "1280x960", "960x720"]);
}

#[test]
fn outputs_are_checked_before_the_work() {
    let bench = with_pattern();
    // The photograph is missing as well: the output is what is complained about.
    bench.run(&CALIBRATE.replace("-o rig.json", "-o none/rig.json")).fails(1, &["none", "does not exist"]);
    bench.put("rig.json", "mine");
    bench.run(CALIBRATE).fails(1, &["rig.json", "--force"]);
    assert_eq!(bench.text("rig.json"), "mine");
    bench.run(&format!("{CALIBRATE} --force --overlay rig.json")).fails(2, &["rig.json", "two results"]);
}

#[test]
fn an_input_is_never_replaced() {
    let bench = with_pattern();
    let photo = png(Scene::default().photograph(Some(&checker())));
    bench.put("photo.png", &photo);
    bench.run(&format!("{CALIBRATE} --overlay ./photo.png --force")).fails(2, &["photo.png", "input"]);
    bench
        .run(&format!("{} --force", CALIBRATE.replace("-o rig.json", "-o checker.json")))
        .fails(2, &["checker.json"]);
    assert_eq!(fs::read(bench.path("photo.png")).unwrap(), photo);
}

#[test]
fn counts_that_do_not_match() {
    let bench = with_pattern();
    let line = "calibrate a.png b.png --size A4 --plain c.png -o rig.json";
    bench.run(line).fails(2, &["--plain", "2 photographs"]);
}
