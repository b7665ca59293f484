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

/// What the frames of a description are.
fn lights(json: &Value) -> Vec<&str> {
    json["frames"].as_array().unwrap().iter().map(|f| f["is"].as_str().unwrap()).collect()
}

#[test]
fn a_sequence_is_a_folder_of_pictures_and_their_description() {
    let bench = bench();
    let run = bench.run("pattern phase --projector 640x480 --period 20 --steps 5 --out-dir shifts").ok();
    assert!(run.stdout.is_empty());
    for word in ["21 pictures to project, frame_000.png to frame_020.png, 640x480 pixels", "sequence.json"] {
        assert!(run.stderr.contains(word), "no {word} in {}", run.stderr);
    }
    let json: Value = serde_json::from_str(&bench.text("shifts/sequence.json")).unwrap();
    assert_eq!((&json["schema"], &json["kind"]), (&"slcal-pattern/1".into(), &"sequence".into()));
    assert_eq!(json["projector"], serde_json::json!([640, 480]));
    // 640 columns in cells of 8, half of a period that is the next power of two below: 80 of them, 7 bits, each with its inverse.
    let expected = [vec!["white", "black"], vec!["bit"; 14], vec!["sinusoid"; 5]].concat();
    assert_eq!(lights(&json), expected);
    assert_eq!(
        json["frames"][2],
        serde_json::json!({"file": "frame_002.png", "is": "bit", "axis": "columns", "bit": 6, "inverted": false})
    );
    assert_eq!(
        json["frames"][20],
        serde_json::json!({"file": "frame_020.png", "is": "sinusoid", "axis": "columns", "period_px": 20.0, "step": 4, "of": 5})
    );
    for i in 0..21 {
        let picture = image::open(bench.path(&format!("shifts/frame_{i:03}.png"))).unwrap();
        assert_eq!((picture.color(), picture.width(), picture.height()), (image::ColorType::L8, 640, 480));
        // Nothing changes along columns.
        let picture = picture.to_luma8();
        assert!((0..640).all(|x| picture.get_pixel(x, 0) == picture.get_pixel(x, 479)));
    }
    let level = |step: u32, x: u32| {
        let name = format!("shifts/frame_{:03}.png", 16 + step);
        f64::from(image::open(bench.path(&name)).unwrap().to_luma8().get_pixel(x, 7).0[0])
    };
    for (step, x) in [(0, 0), (0, 10), (1, 4), (3, 37)] {
        let turns = f64::from(x) / 20.0 - f64::from(step) / 5.0;
        let expected = 127.5 * (1.0 + (std::f64::consts::TAU * turns).cos());
        assert!((level(step, x) - expected).abs() <= 0.5, "{step} {x}");
    }
}

#[test]
fn gray_code_follows_its_options_and_the_orders_of_other_programs() {
    let bench = bench();
    let made = |options: &str| {
        let _ = bench.run(&format!("pattern gray --projector 640x480 {options} --out-dir g --force")).ok();
        serde_json::from_str::<Value>(&bench.text("g/sequence.json")).unwrap()
    };
    assert_eq!(made("").as_object().unwrap()["frames"].as_array().unwrap().len(), 2 + 2 * 10);
    let rows = made("--axis rows --bits 4");
    assert_eq!((lights(&rows).len(), &rows["frames"][2]["axis"]), (10, &"rows".into()));
    assert_eq!(made("--axis both")["frames"].as_array().unwrap().len(), 2 + 2 * 10 + 2 * 9);
    let opencv = made("--preset opencv-gray");
    assert_eq!(lights(&opencv)[38..], ["white", "black"]);
    let other = made("--preset slstudio-gray --bits 9 --no-frames");
    assert_eq!(lights(&other)[..3], ["white", "black", "bit"]);
    assert_eq!((lights(&other).len(), other["frames"][0].get("file")), (11, None));

    let alone = self::bench();
    let run = alone.run("pattern gray --projector 640x480 --no-frames --out-dir new").ok();
    assert!(run.stderr.contains("new/sequence.json") && !run.stderr.contains("frame_0"), "{}", run.stderr);
    assert_eq!(std::fs::read_dir(alone.path("new")).unwrap().count(), 1);
}

#[test]
fn sequences_replace_nothing_and_are_whole() {
    let bench = bench();
    std::fs::create_dir(bench.path("g")).unwrap();
    bench.put("g/frame_007.png", "mine");
    let line = "pattern gray --projector 640x480 --out-dir g";
    bench.run(line).fails(1, &["frame_007.png", "--force"]);
    assert_eq!(std::fs::read_dir(bench.path("g")).unwrap().count(), 1);
    let _ = bench.run(&format!("{line} --force")).ok();
    assert!(image::open(bench.path("g/frame_007.png")).is_ok());
    // What is left of a longer one is named.
    let run = bench.run(&format!("{line} --bits 3 --force")).ok();
    assert!(run.stderr.contains("frame_008.png and what may follow"), "{}", run.stderr);
    for (options, words) in [
        ("gray --projector 640x480", vec!["--out-dir"]),
        ("gray --projector 640x480 --bits 11 --out-dir n", vec!["bits", "1 to 10"]),
        ("gray --projector 640x480 --bits 0 --out-dir n", vec!["bits", "1 to 10"]),
        ("gray --projector 640x480 --period 16 --out-dir n", vec!["--period"]),
        ("gray --projector 640x480 --axis rows --preset opencv-gray --out-dir n", vec!["--axis", "--preset"]),
        ("gray --projector 640x480 --preset other --out-dir n", vec!["opencv-gray", "slstudio-gray"]),
        ("phase --projector 640x480 --preset opencv-gray --out-dir n", vec!["--preset"]),
        ("phase --projector 640x480 --period 3 --out-dir n", vec!["period", "4 to 640 px"]),
        ("phase --projector 640x480 --period nan --out-dir n", vec!["period", "4 to 640 px"]),
        ("phase --projector 640x480 --period 700 --out-dir n", vec!["period", "4 to 640 px"]),
        ("phase --projector 640x480 --steps 2 --out-dir n", vec!["steps", "3 to 64"]),
        ("phase --projector 640x480 --bits 2 --out-dir n", vec!["cells", "16 px"]),
    ] {
        bench.run(&format!("pattern {options}")).fails(2, &words);
    }
    assert!(!bench.path("n").exists(), "a folder was left");
}
