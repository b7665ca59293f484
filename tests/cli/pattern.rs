//! `slcal pattern`.

use serde_json::Value;

use crate::bench;

#[test]
fn a_checkerboard_and_its_description_appear_together() {
    let bench = bench();
    let run = bench.run("pattern checker --projector 1024x768 -o checker.png").ok();
    assert!(run.stdout.is_empty());
    for word in [
        "checker.png: the picture to project, 1024x768 pixels",
        "full screen",
        "checker.json: the description",
        "slcal calibrate",
    ] {
        assert!(run.stderr.contains(word), "no {word} in {}", run.stderr);
    }
    assert_eq!(bench.names(), ["checker.json", "checker.png"]);
    let json: Value = serde_json::from_str(&bench.text("checker.json")).unwrap();
    assert_eq!(json["schema"], "slcal-pattern/1");
    assert_eq!(json["kind"], "checker");
    assert_eq!(json["squares"], serde_json::json!([11, 8]));
    assert_eq!(json["square_px"].as_f64(), Some(48.0));
    assert_eq!(json["origin_px"], serde_json::json!([247.5, 191.5]));
    let picture = image::open(bench.path("checker.png")).unwrap().to_rgb8();
    assert_eq!(picture.dimensions(), (1024, 768));
    // The first square is black and begins at column 248, row 192.
    assert_eq!(picture.get_pixel(248, 192).0, [0; 3]);
    assert_eq!(picture.get_pixel(247, 192).0, [255; 3]);
    assert_eq!(picture.get_pixel(248 + 48, 192).0, [255; 3]);
}

#[test]
fn stripes_follow_the_options() {
    let bench = bench();
    let _ = bench.run("pattern stripes --projector 800x600 --hues 3 --order 3 --slits 20 -o s.png").ok();
    let json: Value = serde_json::from_str(&bench.text("s.json")).unwrap();
    assert_eq!(json["kind"], "stripes");
    assert_eq!(json["palette"].as_array().map(Vec::len), Some(3));
    assert_eq!(json["centres_px"].as_array().map(Vec::len), Some(20));
    assert_eq!(json["axis"], "columns");
    let quiet = bench.run("pattern stripes --projector 800x600 --axis rows -o rows.png -q").ok();
    assert!(quiet.stderr.is_empty(), "{}", quiet.stderr);
    let json: Value = serde_json::from_str(&bench.text("rows.json")).unwrap();
    assert_eq!(json["axis"], "rows");
    let picture = image::open(bench.path("rows.png")).unwrap().to_rgb8();
    let row = json["centres_px"][30].as_f64().unwrap().round() as u32;
    assert_eq!(picture.get_pixel(10, row), picture.get_pixel(790, row));
    assert_ne!(picture.get_pixel(10, row).0, [0; 3]);
    bench.run("pattern stripes --projector 800x600 --axis diagonal -o d.png").fails(2, &["columns", "rows"]);
}

#[test]
fn a_picture_on_stdout_is_a_png_and_leaves_no_file() {
    let bench = bench();
    let run = bench.run("pattern stripes --projector 640x480 -o -").ok();
    let picture = image::load_from_memory(&run.stdout).unwrap();
    assert_eq!((picture.width(), picture.height()), (640, 480));
    assert!(bench.names().is_empty());
}

#[test]
fn nothing_is_overwritten_without_force() {
    let bench = bench();
    bench.put("checker.json", "mine");
    bench.run("pattern checker --projector 1024x768 -o checker.png").fails(1, &["checker.json", "--force"]);
    assert_eq!(bench.names(), ["checker.json"]);
    assert_eq!(bench.text("checker.json"), "mine");
    let _ = bench.run("pattern checker --projector 1024x768 -o checker.png --force").ok();
    assert!(bench.text("checker.json").contains("slcal-pattern/1"));
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let cases: [(&str, &[&str]); 8] = [
        ("pattern checker --projector 1024 -o a.png", &["1024x768"]),
        ("pattern checker --projector 0x768 -o a.png", &["1024x768"]),
        ("pattern checker --projector 1024x768 --squares 10x8 -o a.png", &["odd"]),
        ("pattern checker --projector 1024x768 --square 200 -o a.png", &["square"]),
        ("pattern checker --projector 1024x768 -o a.jpg", &["a.jpg", ".png"]),
        ("pattern stripes --projector 1024x768 --slits 5000 -o a.png", &["slits"]),
        ("pattern stripes --projector 1024x768 --hues 1 -o a.png", &["hues"]),
        ("pattern stripes --projector 1024x768 --order -3 -o a.png", &["order"]),
    ];
    for (line, words) in cases {
        let bench = bench();
        bench.run(line).fails(2, words);
        assert!(bench.names().is_empty(), "{line}: {:?}", bench.names());
    }
}

#[test]
fn an_unwritable_place_is_found_before_the_work() {
    let bench = bench();
    bench.put("file", "");
    bench.run("pattern checker --projector 1024x768 -o none/a.png").fails(1, &["none", "does not exist"]);
    bench.run("pattern checker --projector 1024x768 -o file/a.png").fails(1, &["file"]);
    std::fs::create_dir(bench.path("dir.png")).unwrap();
    bench.run("pattern checker --projector 1024x768 -o dir.png").fails(1, &["folder"]);
    assert_eq!(bench.names(), ["dir.png", "file"]);
}
