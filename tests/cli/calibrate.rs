//! `slcal calibrate` and `slcal rectify` on photographs drawn by closed form.

use std::io::Cursor;

use image::{DynamicImage, ImageFormat, RgbImage};
use serde_json::Value;
use slcal_core::pattern::{CheckerConfig, CheckerPattern};
use slcal_tests::{Bench, IDEAL, Scene};

use crate::bench;

const LINE: &str = "calibrate photo.png --size A2-landscape --pattern checker.json -o rig.json";

fn checker() -> CheckerPattern {
    CheckerPattern::new([1024, 768], &CheckerConfig::default()).unwrap()
}

fn encoded(picture: RgbImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    DynamicImage::ImageRgb8(picture).write_to(&mut Cursor::new(&mut bytes), format).unwrap();
    bytes
}

fn with_photo(scene: &Scene) -> Bench {
    let bench = bench();
    let _ = bench.run("pattern checker --projector 1024x768 -o checker.png").ok();
    bench.put("photo.png", encoded(scene.photograph(Some(&checker())), ImageFormat::Png));
    bench
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

fn focal(rig: &Value, device: &str) -> f64 {
    rig[device]["K"][0][0].as_f64().unwrap()
}

/// Error of a focal length, per cent.
fn focal_error(rig: &Value, device: &str, truth: f64) -> f64 {
    100.0 * (focal(rig, device) / truth - 1.0).abs()
}

#[test]
fn one_photograph_gives_a_rig() {
    let scene = Scene::default();
    let bench = with_photo(&scene);
    let run = bench.run(&format!("{LINE} {IDEAL} --overlay seen.png")).ok();
    let rig = json(&bench.text("rig.json"));
    assert_eq!(rig["schema"], "slcal-rig/1");
    assert_eq!(rig["views"][0]["photo"], "photo.png");
    assert_eq!(rig["quality"]["verdict"], "good");
    assert!(focal_error(&rig, "camera", scene.camera_focal_px) < 0.1, "{}", focal(&rig, "camera"));
    assert!(focal_error(&rig, "projector", scene.projector_focal_px) < 0.4, "{}", focal(&rig, "projector"));
    for word in ["camera", "projector", "±", "principal point", "baseline", "tilted by", "verdict", "good"] {
        assert!(run.words().contains(word), "no {word} in {}", run.text());
    }
    let overlay = image::open(bench.path("seen.png")).unwrap();
    assert_eq!((overlay.width(), overlay.height()), (960, 720));
    assert_eq!(bench.names(), ["checker.json", "checker.png", "photo.png", "rig.json", "seen.png"]);
}

#[test]
fn several_photographs_are_drawn_on_one_sheet() {
    let bench = with_photo(&Scene::default());
    let other = Scene { tilt_deg: [-18.0, 22.0], ..Scene::default() };
    bench.put("other.png", encoded(other.photograph(Some(&checker())), ImageFormat::Png));
    let line = LINE.replace("photo.png", "photo.png other.png");
    let _ = bench.run(&format!("{line} --overlay all.png")).ok();
    let drawn = image::open(bench.path("all.png")).unwrap();
    assert!(drawn.width() > 2 * 960 && drawn.height() > 720, "{}x{}", drawn.width(), drawn.height());

    // What was found is drawn though the second photograph shows nothing.
    bench.put("none.png", encoded(RgbImage::from_pixel(960, 720, image::Rgb([90; 3])), ImageFormat::Png));
    let line = LINE.replace("photo.png", "photo.png none.png").replace("rig.json", "no.json");
    bench.run(&format!("{line} --overlay part.png")).fails(4, &["none.png"]);
    let part = image::open(bench.path("part.png")).unwrap();
    assert!(part.width() > 2 * 960, "{}", part.width());
    assert!(!bench.names().contains(&"no.json".to_owned()));
}

#[test]
fn json_is_the_rig_and_nothing_else() {
    let bench = with_photo(&Scene::default());
    let printed = bench.run(&format!("{LINE} --json")).ok();
    assert_eq!(json(&printed.text()), json(&bench.text("rig.json")));
    let without_file = bench.run(&LINE.replace("-o rig.json", "--json")).ok();
    assert_eq!(json(&without_file.text()), json(&printed.text()));
    let dash = bench.run(&LINE.replace("-o rig.json", "-o -")).ok();
    assert_eq!(json(&dash.text()), json(&printed.text()));
    assert!(dash.stderr.contains("verdict"));
    assert!(bench.run(&LINE.replace("-o rig.json", "-o - -q")).ok().stderr.is_empty());
}

#[test]
fn the_camera_alone_needs_no_pattern() {
    let scene = Scene::default();
    let bench = bench();
    bench.put("photo.png", encoded(scene.photograph(None), ImageFormat::Png));
    let _ = bench.run("calibrate photo.png --size 594x420mm -o rig.json").ok();
    let rig = json(&bench.text("rig.json"));
    assert_eq!(rig["projector"], Value::Null);
    assert_eq!(rig["projector_from_camera"], Value::Null);
    assert!(focal_error(&rig, "camera", scene.camera_focal_px) < 0.1, "{}", focal(&rig, "camera"));
}

#[test]
fn formats_depths_and_stdin_give_the_same_rig() {
    let scene = Scene::default();
    let bench = with_photo(&scene);
    let _ = bench.run(LINE).ok();
    let reference = focal(&json(&bench.text("rig.json")), "camera");
    let photo = DynamicImage::ImageRgb8(scene.photograph(Some(&checker())));
    let variants = [
        ("grey.png", photo.to_luma8().into()),
        ("deep.png", photo.to_rgb16().into()),
        ("deep.tiff", photo.to_luma16().into()),
        ("alpha.png", photo.to_rgba8().into()),
    ];
    for (name, picture) in variants {
        let picture: DynamicImage = picture;
        picture.save(bench.path(name)).unwrap();
        let run = bench.run(&LINE.replace("photo.png", name).replace("-o rig.json", "--json")).ok();
        let change = (focal(&json(&run.text()), "camera") / reference - 1.0).abs();
        assert!(change < 1e-6, "{name}: {change:e}");
    }
    let args: Vec<&str> = "calibrate - --size 594x420mm --pattern checker.json --json".split(' ').collect();
    let run = bench.run_args(&args, &std::fs::read(bench.path("photo.png")).unwrap()).ok();
    let rig = json(&run.text());
    assert!((focal(&rig, "camera") / reference - 1.0).abs() < 1e-12);
    assert_eq!(rig["views"][0]["photo"], "stdin");
}

#[test]
fn gamma_says_how_light_is_encoded() {
    let scene = Scene::default();
    let bench = with_photo(&scene);
    // The same light written with γ = 1: linear.
    let srgb = scene.photograph(Some(&checker()));
    let linear = image::ImageBuffer::<image::Rgb<u16>, _>::from_fn(srgb.width(), srgb.height(), |x, y| {
        let light = |c: u8| slcal_core::photo::Encoding::Srgb.to_linear(f64::from(c) / 255.0);
        image::Rgb(srgb.get_pixel(x, y).0.map(|c| (light(c) * 65535.0).round() as u16))
    });
    DynamicImage::ImageRgb16(linear).save(bench.path("linear.png")).unwrap();
    let line = LINE
        .replace("photo.png", "linear.png")
        .replace("-o rig.json", &format!("--json --gamma linear {IDEAL}"));
    let rig = json(&bench.run(&line).ok().text());
    assert!(focal_error(&rig, "camera", scene.camera_focal_px) < 0.1, "{}", focal(&rig, "camera"));
}

#[test]
fn a_sheet_seen_face_on_is_refused_and_written_only_when_allowed() {
    let scene = Scene { tilt_deg: [1.0, -2.0], ..Scene::default() };
    let bench = with_photo(&scene);
    bench.run(LINE).fails(5, &["photo.png", "face-on", "tilt"]);
    assert_eq!(bench.names(), ["checker.json", "checker.png", "photo.png"]);
    let run = bench.run(&format!("{LINE} --allow-degenerate")).ok();
    assert!(run.words().contains("degenerate"), "{}", run.text());
    assert_eq!(json(&bench.text("rig.json"))["quality"]["verdict"], "degenerate");
    // With exact principal points the same photograph does.
    let exact =
        bench.run(&format!("{LINE} {IDEAL} --force --camera-pp centre --projector-pp 511.5,383.5")).ok();
    assert!(exact.words().contains("good") || exact.words().contains("fair"), "{}", exact.text());
}

#[test]
fn several_photographs_are_solved_together() {
    let first = Scene::default();
    let second = Scene { tilt_deg: [-24.0, 26.0], ..first };
    let bench = with_photo(&first);
    bench.put("second.png", encoded(second.photograph(Some(&checker())), ImageFormat::Png));
    // The rig of these two differs in its projector's aim, so that only the camera is common: without the pattern.
    for (name, scene) in [("a.png", first), ("b.png", second)] {
        bench.put(name, encoded(scene.photograph(None), ImageFormat::Png));
    }
    let run =
        bench.run(&format!("calibrate a.png b.png --size A2-landscape -o rig.json --json {IDEAL}")).ok();
    let rig = json(&run.text());
    assert_eq!(rig["views"].as_array().map(Vec::len), Some(2));
    assert_eq!(rig["views"][1]["photo"], "b.png");
    assert!(focal_error(&rig, "camera", first.camera_focal_px) < 0.05);
    assert!(rig["quality"]["focal_sigma_percent"]["camera"].as_f64().unwrap() < 0.2);
}

#[test]
fn a_size_in_centimetres_is_asked_about() {
    let bench = with_photo(&Scene::default());
    let run = bench.run(&LINE.replace("A2-landscape", "59.4x42mm")).ok();
    let rig = json(&bench.text("rig.json"));
    let codes: Vec<_> = rig["quality"]["warnings"].as_array().unwrap().iter().map(|w| &w["code"]).collect();
    assert!(codes.contains(&&Value::from("size-in-centimetres")), "{codes:?}");
    assert!(run.words().contains("centimetres?"), "{}", run.text());
}

#[test]
fn a_folder_and_wildcards_stand_for_their_photographs() {
    let bench = with_photo(&Scene::default());
    std::fs::create_dir(bench.path("photos")).unwrap();
    for name in ["photos/p10.png", "photos/p9.png"] {
        std::fs::copy(bench.path("photo.png"), bench.path(name)).unwrap();
    }
    bench.put("photos/notes.txt", "not a photograph");
    let by_name = LINE.replace("photo.png", "photos/p9.png photos/p10.png");
    let expected = bench.run(&format!("{by_name} --json")).ok().text();
    assert_eq!(json(&expected)["views"][1]["photo"], "photos/p10.png");
    // The arguments go to the command as they are, without a shell.
    for input in ["photos", "photos/p*.png", "photos/p9.png photos/p1?.png"] {
        let run = bench.run(&format!("{} --json --force", LINE.replace("photo.png", input))).ok();
        assert_eq!(run.text(), expected, "{input}");
    }
    bench.run(&LINE.replace("photo.png", "none*.jpg")).fails(3, &["none*.jpg", "found none"]);
    std::fs::create_dir(bench.path("empty")).unwrap();
    bench.run(&LINE.replace("photo.png", "empty")).fails(3, &["empty", "PNG, JPEG, TIFF, WebP or BMP"]);
}

#[test]
fn corners_by_hand_and_a_photograph_without_the_pattern_are_used() {
    let scene = Scene::default();
    let bench = with_photo(&scene);
    bench.put("plain.png", encoded(scene.photograph(None), ImageFormat::Png));
    let with_plain = bench.run(&format!("{LINE} {IDEAL} --plain plain.png --json")).ok();
    // The former name of the option.
    let former = bench.run(&format!("{LINE} {IDEAL} --screen plain.png --json --force")).ok();
    assert_eq!(with_plain.stdout, former.stdout);
    assert!(!bench.run("calibrate --help").ok().text().contains("--screen"));
    let with_plain = json(&with_plain.text());
    assert!(focal_error(&with_plain, "camera", scene.camera_focal_px) < 0.1);
    let corners: Vec<String> = with_plain["views"][0]["corners_px"]
        .as_array()
        .unwrap()
        .iter()
        .map(|c| format!("{:.0},{:.0}", c[0].as_f64().unwrap(), c[1].as_f64().unwrap()))
        .collect();
    let corners = corners.join(" ");
    let args = [
        "calibrate",
        "photo.png",
        "--size",
        "594x420mm",
        "--pattern",
        "checker.json",
        "--json",
        "--corners",
        &corners,
    ];
    let by_hand = json(&bench.run_args(&args, &[]).ok().text());
    assert!(focal_error(&by_hand, "camera", scene.camera_focal_px) < 2.0);
    // A photograph of another camera is not the same pose.
    let small = RgbImage::from_pixel(64, 48, image::Rgb([90; 3]));
    bench.put("small.png", encoded(small, ImageFormat::Png));
    bench.run(&format!("{LINE} --plain small.png --force")).fails(3, &["small.png", "960x720", "64x48"]);
}

#[test]
fn a_known_camera_leaves_the_rest_to_be_solved() {
    let scene = Scene::default();
    let bench = with_photo(&scene);
    bench.put(
        "camera.json",
        r#"{"schema": "slcal-rig/1", "units": "mm", "pixel_centre": "integer", "projector": null, "projector_from_camera": null,
            "camera": {"width": 960, "height": 720, "K": [[1150, 0, 479.5], [0, 1150, 359.5], [0, 0, 1]],
                       "distortion": [0, 0, 0, 0, 0]}}"#,
    );
    let rig = json(&bench.run(&format!("{LINE} --camera camera.json --json")).ok().text());
    assert!((focal(&rig, "camera") - 1150.0).abs() < 1e-9);
    assert!(focal_error(&rig, "projector", scene.projector_focal_px) < 0.4);
    bench.put("camera.json", bench.text("camera.json").replace("960", "1920"));
    bench
        .run(&format!("{LINE} --camera camera.json --force"))
        .fails(3, &["camera.json", "960x720", "1920x720"]);
}

#[test]
fn a_pattern_whose_outer_squares_fall_off_the_sheet_is_used() {
    let scene = Scene { aim_mm: [105.0, 0.0], ..Scene::default() };
    let bench = with_photo(&scene);
    let _ = bench.run(LINE).ok();
    let rig = json(&bench.text("rig.json"));
    assert!(focal_error(&rig, "camera", scene.camera_focal_px) < 0.2, "{}", focal(&rig, "camera"));
    assert!(focal_error(&rig, "projector", scene.projector_focal_px) < 0.5, "{}", focal(&rig, "projector"));
}

#[test]
fn a_pattern_partly_off_the_sheet_is_not_guessed_at() {
    // Without its last columns the board fits the pattern in more than one place.
    let scene = Scene { aim_mm: [190.0, 0.0], ..Scene::default() };
    let bench = with_photo(&scene);
    bench.run(LINE).fails(4, &["photo.png", "checkerboard", "on the sheet"]);
    assert!(!bench.names().contains(&"rig.json".to_owned()));
}

#[test]
fn a_pattern_nearly_off_the_sheet_is_not_found() {
    let scene = Scene { aim_mm: [420.0, 0.0], ..Scene::default() };
    let bench = with_photo(&scene);
    bench.run(LINE).fails(4, &["photo.png", "checkerboard"]);
}

#[test]
fn a_pattern_off_the_frame_is_not_found() {
    let bench = with_photo(&Scene::default());
    let whole = image::open(bench.path("photo.png")).unwrap();
    whole.crop_imm(0, 0, 330, 720).save(bench.path("photo.png")).unwrap();
    let run = bench.run(LINE);
    assert!(matches!(run.code, 4 | 5), "{} {}", run.code, run.stderr);
    assert!(run.stderr.contains("photo.png"), "{}", run.stderr);
}

#[test]
fn a_rectified_picture_is_drawn_for_the_panel() {
    let bench = with_photo(&Scene::default());
    let _ = bench.run(LINE).ok();
    let run = bench.run("rectify --rig rig.json --pattern checker.json -o straight.png").ok();
    assert!(run.words().contains("mm"), "{}", run.text());
    let straight = image::open(bench.path("straight.png")).unwrap();
    assert_eq!((straight.width(), straight.height()), (1024, 768));
    let _ = bench.run("rectify --rig rig.json --image photo.png -o poster.png").ok();
    bench.run("rectify --rig rig.json --image photo.png -o poster.png").fails(1, &["poster.png", "--force"]);
    bench.run("rectify --rig rig.json --image none.png -o other.png").fails(3, &["none.png"]);
}

#[test]
fn distortion_of_the_projector_asks_for_three_photographs() {
    let bench = with_photo(&Scene::default());
    bench.run(&format!("{LINE} --projector-distortion k1")).fails(2, &["three photographs", "found 1"]);
    assert!(!bench.names().contains(&"rig.json".to_owned()));
    // Where nothing was asked, fewer do.
    let _ = bench.run(&format!("{LINE} --projector-distortion auto")).ok();
}
