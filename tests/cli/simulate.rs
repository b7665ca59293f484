//! `slcal simulate`.

use serde_json::Value;

use crate::bench;

const QUICK: &str = "simulate noise --levels 0,0.2 --draws 3";

#[test]
fn the_table_shows_both_methods_and_the_bound_at_every_level() {
    let text = bench().run(QUICK).ok().text();
    for word in ["two-vp", "ml", "bound", "3D error", "1500", "1700"] {
        assert!(text.contains(word), "no {word} in {text}");
    }
    assert_eq!(text.lines().filter(|l| l.trim_start().starts_with("bound ")).count(), 2, "{text}");
}

#[test]
fn json_and_csv_say_the_same() {
    let bench = bench();
    let run = bench.run(&format!("{QUICK} --json --csv noise.csv")).ok();
    assert_eq!(bench.names(), ["noise.csv"]);
    let json: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!(json["schema"], "slcal-simulate-noise/1");
    assert_eq!(json["config"]["seed"], 1);
    assert_eq!(json["truth"]["camera_focal_px"], 1500.0);
    let text = bench.text("noise.csv");
    let mut lines = text.lines().map(|l| l.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let rows: Vec<_> = lines.collect();
    assert_eq!(rows.len(), 4);
    let column = |name: &str| header.iter().position(|h| *h == name).unwrap();
    for (i, row) in rows.iter().enumerate() {
        assert_eq!(row.len(), header.len());
        let level = &json["levels"][i / 2];
        let method = &level["methods"][i % 2];
        assert_eq!(row[column("method")], method["method"].as_str().unwrap());
        let number = |name: &str| row[column(name)].parse::<f64>().unwrap();
        assert_eq!(number("level_px"), level["level_px"].as_f64().unwrap());
        assert_eq!(number("camera_focal_px_rms"), method["camera_focal_px"]["rms"].as_f64().unwrap());
        assert_eq!(
            number("cube_position_percent_mean"),
            method["cube_position_percent"]["mean"].as_f64().unwrap()
        );
        assert_eq!(number("translation_mm_bound"), level["bound"]["translation_mm"].as_f64().unwrap());
    }
    // Without noise both are exact; with it, neither is.
    assert!(rows[0][column("camera_focal_px_rms")].parse::<f64>().unwrap() < 1e-6);
    assert!(rows[3][column("camera_focal_px_rms")].parse::<f64>().unwrap() > 1e-2);
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let bench = bench();
    let run = |seed: u32| bench.run(&format!("{QUICK} --json --seed {seed}")).ok().stdout;
    assert_eq!(run(7), run(7));
    assert_ne!(run(7), run(8));
    let csv = bench.run(&format!("{QUICK} --csv -")).ok();
    assert!(csv.text().starts_with("level_px,method,"), "{}", csv.text());
    assert!(csv.stderr.contains("two-vp"), "the table goes to stderr then: {}", csv.stderr);
}

#[test]
fn a_tilt_about_one_axis_and_a_lens_shift_are_explained() {
    let one = bench().run("simulate noise --levels 0.3 --draws 20 --tilt 30,0").ok().words();
    assert!(one.contains("imaginary focal length") && one.contains("one axis alone"), "{one}");
    let line = "simulate noise --levels 0.1 --draws 5 --lens-shift 0.5 --principal-points prior";
    let shifted = bench().run(line).ok().words();
    assert!(shifted.contains("lens shift"), "{shifted}");
}

#[test]
fn other_rigs_run_as_well() {
    for options in [
        "--tilt 60,0",
        "--tilt -35,40",
        "--size A4",
        "--size 420x594mm",
        "--focal 2500",
        "--projector-focal 900",
        "--lens-shift -1",
        "--baseline 900",
        "--camera 640x480 --focal 700 --projector 800x600 --projector-focal 1200",
        "--camera 4000x3000 --focal 3200 --projector 1920x1080 --projector-focal 2100 --lens-shift 0.6",
    ] {
        let run = bench().run(&format!("{QUICK} {options} --json")).ok();
        let json: Value = serde_json::from_slice(&run.stdout).unwrap();
        for level in json["levels"].as_array().unwrap() {
            assert_eq!(level["methods"][1]["failed"], 0, "{options}");
            assert_eq!(level["methods"][1]["imaginary"], 0, "{options}");
        }
        let exact = &json["levels"][0]["methods"][1]["camera_focal_px"]["rms"];
        assert!(exact.as_f64().unwrap() < 1e-4, "{options}: {exact}");
    }
}

#[test]
fn nonsense_is_told_what_is_expected() {
    let cases: [(&str, &[&str]); 18] = [
        ("--levels -0.1", &["noise level", "-0.1"]),
        ("--levels nan", &["MAX/STEPS"]),
        ("--levels 1/0", &["MAX/STEPS"]),
        ("--levels 1e9", &["noise level", "100"]),
        ("--draws 0", &["draws per level"]),
        ("--draws -1", &["--draws"]),
        ("--draws 99999999999", &["draws per level"]),
        ("--tilt 90,0", &["tilt", "90"]),
        ("--tilt nan,0", &["--tilt"]),
        ("--tilt 10,20,30", &["--tilt"]),
        ("--focal nan", &["focal length of the camera"]),
        ("--focal 0", &["focal length of the camera"]),
        ("--projector-focal -5", &["focal length of the projector"]),
        ("--lens-shift 1e300", &["lens shift"]),
        ("--distance 1", &["behind the camera"]),
        ("--size 1e9x1e9mm", &["594x420mm"]),
        ("--cube 0", &["reference cube"]),
        ("--camera 1x1", &["size of the camera"]),
    ];
    for (options, words) in cases {
        let bench = bench();
        bench.run(&format!("simulate noise {options} --csv out.csv")).fails(2, words);
        assert!(bench.names().is_empty(), "{options}: {:?}", bench.names());
    }
    bench().run("simulate noise --json --csv -").fails(2, &["--json", "--csv"]);
    bench().run("simulate views --poses 0 -o a.json").fails(2, &["number of poses"]);
    bench().run("simulate views --poses 100000000 -o a.json").fails(2, &["number of poses"]);
    bench().run("simulate views --pose 25 -o a.json").fails(2, &["--pose"]);
    bench().run("simulate views --noise -1 -o a.json").fails(2, &["noise"]);
    bench().run("simulate views --edges 1 -o a.json").fails(2, &["edge points"]);
    bench().run("simulate views --size 15x10mm -o a.json").fails(2, &["projected pattern"]);
    for (options, words) in [
        ("--bend 200%", &["sag of the bent sheet", "42 mm"][..]),
        ("--bend nan%", &["--bend", "0.5%,20,wave"]),
        ("--bend 3", &["--bend"]),
        ("--bend 3mm,0,fold", &["--bend", "twist"]),
        ("--bend 3mm,45,twist", &["axis of the bend"]),
        ("--bend 3mm,1e9", &["axis of the bend"]),
        ("--pixel-aspect 0", &["pixel aspect of the camera"]),
        ("--projector-pixel-aspect nan", &["pixel aspect of the projector"]),
        ("--projector-offset 1,2,3", &["--projector-offset"]),
        ("--projector-offset 1e9", &["principal point"]),
        ("--projector-distortion 9", &["distortion of the projector"]),
        ("--projector-distortion 0,inf", &["--projector-distortion"]),
    ] {
        bench().run(&format!("simulate views {options} -o a.json")).fails(2, words);
        bench().run(&format!("simulate noise {options}")).fails(2, words);
        bench().run(&format!("simulate scene --surface sheet {options} --out a")).fails(2, words);
    }
}

#[test]
fn views_come_with_their_truth() {
    let bench = bench();
    let line = "simulate views --poses 3 --noise 0 --lens-shift 0.5 --camera-offset 9,-7 -o seen.json --truth rig.json";
    let run = bench.run(line).ok();
    assert!(run.words().contains("3 views"), "{}", run.text());
    assert_eq!(bench.names(), ["rig.json", "seen.json"]);
    let seen: Value = serde_json::from_str(&bench.text("seen.json")).unwrap();
    assert_eq!(seen["schema"], "slcal-observations/1");
    assert_eq!(seen["views"].as_array().unwrap().len(), 3);
    assert_eq!(seen["views"][2]["pairs"].as_array().unwrap().len(), 70);
    let rig: Value = serde_json::from_str(&bench.text("rig.json")).unwrap();
    assert_eq!(rig["method"], "truth");
    assert_eq!(rig["camera"]["K"][0][2], 648.5);
    assert_eq!(rig["projector"]["K"][1][2], 767.5);
    assert_eq!(rig["views"].as_array().unwrap().len(), 3);
    // Nothing is overwritten, and the same seed gives the same bytes.
    bench.run(line).fails(1, &["--force"]);
    let again = bench.run(&line.replace("seen.json", "again.json").replace("rig.json", "truth.json")).ok();
    assert_eq!(again.stdout, run.stdout);
    assert_eq!(bench.text("again.json"), bench.text("seen.json"));
}

#[test]
fn poses_of_ones_own_and_edges() {
    let bench = bench();
    let run = bench.run("simulate views --pose 25,28 --pose -20,15,5 --edges 9 -o -").ok();
    let seen: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!(seen["views"].as_array().unwrap().len(), 2);
    assert_eq!(seen["views"][1]["sheet_edges_px"]["left"].as_array().unwrap().len(), 9);
    assert!(bench.names().is_empty());
    bench.run("simulate views --pose 95,0 -o a.json").fails(2, &["tilt"]);
    bench.run("simulate views --pose 1,2 --poses 3 -o a.json").fails(2, &["--pose"]);
}

/// The residuals of a straight line through the points of a side of the sheet, px: the largest.
fn curvature(points: &Value) -> f64 {
    let points: Vec<[f64; 2]> =
        points.as_array().unwrap().iter().map(|p| [p[0].as_f64().unwrap(), p[1].as_f64().unwrap()]).collect();
    let (a, b) = (points[0], points[points.len() - 1]);
    let along = [b[0] - a[0], b[1] - a[1]];
    let off = |p: &[f64; 2]| along[0] * (p[1] - a[1]) - along[1] * (p[0] - a[0]);
    points.iter().map(|p| off(p).abs() / along[0].hypot(along[1])).fold(0.0, f64::max)
}

#[test]
fn bent_sheets_have_curved_edges_and_the_rig_keeps_its_format() {
    let bench = bench();
    let line = "simulate views --pose 25,28 --noise 0 --edges 21 --force -o seen.json --truth rig.json";
    let shape = |options: &str| {
        let run = bench.run(&format!("{line} {options}")).ok();
        let seen: Value = serde_json::from_str(&bench.text("seen.json")).unwrap();
        let rig: Value = serde_json::from_str(&bench.text("rig.json")).unwrap();
        let edges = &seen["views"][0]["sheet_edges_px"];
        (run.words(), ["top", "right"].map(|side| curvature(&edges[side])), rig)
    };
    let (words, flat, flat_rig) = shape("");
    assert!(!words.contains("bent") && flat.iter().all(|c| *c < 1e-6), "{words} {flat:?}");
    let (words, curled, rig) = shape("--bend 0.5%");
    assert!(words.contains("bent: curl with a sag of 2.970 mm, axis at 0°"), "{words}");
    // The bend runs along the width: top and bottom are curved, left and right are lines of the cylinder.
    assert!(curled[0] > 1.0 && curled[1] < 1e-6, "{curled:?}");
    let (_, turned, _) = shape("--bend 0.5%,90");
    assert!(turned[0] < 1e-6 && turned[1] > 0.5, "{turned:?}");
    // The edges of a twist are straight but for the shortening across them, of second order.
    let (_, twisted, _) = shape("--bend 0.5%,0,twist");
    assert!(twisted.iter().all(|c| *c < 0.05), "{twisted:?}");
    let keys = |rig: &Value| rig["views"][0].as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    assert_eq!(keys(&rig), keys(&flat_rig));
    assert_eq!(rig["camera"], flat_rig["camera"]);
    let (_, _, rig) = shape(
        "--pixel-aspect 1.01 --projector 912x1140 --projector-focal 850 --projector-pixel-aspect 2 --projector-offset=30,-57 \
         --projector-distortion=-0.02,0.01,3e-4,2e-4",
    );
    assert_eq!((&rig["camera"]["K"][0][0], &rig["camera"]["K"][1][1]), (&1500.0.into(), &1515.0.into()));
    let k = &rig["projector"]["K"];
    assert_eq!((&k[0][0], &k[1][1]), (&850.0.into(), &1700.0.into()));
    assert!(
        (k[0][2].as_f64().unwrap() - 485.5).abs() < 1e-9 && (k[1][2].as_f64().unwrap() - 512.5).abs() < 1e-9
    );
    assert_eq!(rig["projector"]["distortion"], serde_json::json!([-0.02, 0.01, 3e-4, 2e-4, 0.0]));
}

/// A small camera: rendering takes a moment even unoptimised.
const SMALL: &str = "--camera 320x240 --focal 375";

#[test]
fn a_scene_is_photographs_and_their_truth() {
    let bench = bench();
    let run = bench.run(&format!("simulate scene {SMALL} --surface sphere --out ball --json")).ok();
    let json: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!(json["schema"], "slcal-simulate-scene/1");
    assert_eq!(json["camera"][0], 320);
    let depth = json["depth_mm"][0].as_f64().unwrap();
    assert!((depth - 820.0).abs() < 1.0, "the ball's near side, 1000 - 180 mm away: {depth}");
    for file in json["files"].as_array().unwrap() {
        let path = bench.path("ball").join(file.as_str().unwrap());
        assert!(std::fs::metadata(&path).unwrap().len() > 100, "{}", path.display());
    }
    let column = std::fs::read(bench.path("ball/truth_column.pfm")).unwrap();
    assert!(column.starts_with(b"Pf\n320 240\n-1.0\n") && column.len() == 16 + 320 * 240 * 4);
    // The true matches lie on the ball and on the wall behind it.
    let line = "triangulate --rig ball/rig.json ball/truth_matches.csv --cull off -o ball/cloud.ply";
    let _ = bench.run(line).ok();
    let run = bench.run("evaluate sphere ball/cloud.ply --json").ok();
    let fit: Value = serde_json::from_slice(&run.stdout).unwrap();
    let radius = fit["sphere"]["radius_mm"].as_f64().unwrap();
    assert!((radius - 180.0).abs() < 0.01, "{fit}");
}

#[test]
fn a_simulated_sheet_calibrates_its_own_rig() {
    let bench = bench();
    let _ = bench.run("simulate scene --camera 960x720 --focal 1125 --surface sheet --out sheet").ok();
    let line = "calibrate sheet/photo.png --size 594x420mm --pattern sheet/pattern.json -o rig.json --json";
    let rig: Value = serde_json::from_slice(&bench.run(line).ok().stdout).unwrap();
    let focal = rig["camera"]["K"][0][0].as_f64().unwrap();
    let sigma = rig["camera"]["sigma"]["focal_px"].as_f64().unwrap();
    assert!((focal - 1125.0).abs() < 3.0 * sigma && sigma < 0.04 * 1125.0, "{focal} ± {sigma}");
}

#[test]
fn scenes_from_files_follow_the_rig_the_pattern_and_the_mesh() {
    let bench = bench();
    bench.put(
        "roof.obj",
        "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv 0 0 0.5\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n",
    );
    let _ = bench.run(&format!("simulate scene {SMALL} --out first")).ok();
    let line = "simulate scene --rig first/rig.json --pattern first/pattern.json --surface roof.obj --mesh-scale 150 \
                --noise 3 --crosstalk 0.2 --albedo 0.7,0.35,0.25 --bits 16 --out second --json";
    let json: Value = serde_json::from_slice(&bench.run(line).ok().stdout).unwrap();
    assert_eq!(json["camera"], serde_json::json!([320, 240]));
    // The tip comes 0.5 · 150 mm / 2 before the middle of the box.
    let near = json["depth_mm"][0].as_f64().unwrap();
    assert!((near - 962.5).abs() < 2.0, "{near}");
    assert_eq!(bench.text("first/rig.json"), bench.text("second/rig.json"));
    // A mesh that slcal wrote is in the camera's frame.
    let line = "simulate scene --rig first/rig.json --surface first/truth_cloud.ply --out third";
    bench.run(line).fails(3, &["truth_cloud.ply", "as a mesh"]);
}

#[test]
fn the_same_scene_gives_the_same_bytes_and_another_seed_another_noise() {
    let bench = bench();
    for (folder, seed) in [("a", 1), ("b", 1), ("c", 2)] {
        let _ =
            bench.run(&format!("simulate scene {SMALL} --surface step --seed {seed} --out {folder}")).ok();
    }
    let photo = |folder: &str| std::fs::read(bench.path(folder).join("photo.png")).unwrap();
    assert_eq!(photo("a"), photo("b"));
    assert_ne!(photo("a"), photo("c"));
    assert_eq!(bench.text("a/truth_matches.csv"), bench.text("c/truth_matches.csv"));
}

#[test]
fn real_devices_change_the_photographs_and_no_truth() {
    let bench = bench();
    let effects = "--channel-shift 0.3,-0.18,-0.24,0.3 --lateral-colour 0.0003,-0.0002 --vignetting 0.2 --flicker 0.1,170 \
                   --demosaic malvar --tone 0.25 --sharpen 0.6,1 --projector-gamma 2.2 --projector-falloff 0.15 --jpeg 88";
    let made = |folder: &str, options: &str| {
        let line = format!("simulate scene {SMALL} --surface sphere {options} --out {folder} --json");
        serde_json::from_slice::<Value>(&bench.run(&line).ok().stdout).unwrap()
    };
    let (ideal, real) = (made("ideal", ""), made("real", effects));
    assert_eq!(real["files"].as_array().unwrap()[..3], ["photo.jpg", "white.jpg", "black.jpg"]);
    assert_eq!(real["render"]["sharpen"], serde_json::json!({"amount": 0.6, "radius_px": 1.0}));
    assert_eq!(
        (&real["render"]["demosaic"], &real["render"]["jpeg_quality"]),
        (&"malvar".into(), &88.into())
    );
    assert_eq!(ideal["render"].get("demosaic"), None);
    for name in ["rig.json", "truth_matches.csv", "truth_column.pfm", "truth_depth.pfm"] {
        let bytes = |folder: &str| std::fs::read(bench.path(folder).join(name)).unwrap();
        assert_eq!(bytes("ideal"), bytes("real"), "{name}");
    }
    let photo = std::fs::read(bench.path("real").join("photo.jpg")).unwrap();
    assert_eq!(photo[..3], [0xFF, 0xD8, 0xFF]);
    let _ = bench.run("decode --pattern real/pattern.json real/photo.jpg -o matches.csv").ok();
}

#[test]
fn a_sequence_is_photographed_picture_by_picture() {
    let bench = bench();
    let _ = bench.run("pattern phase --projector 320x240 --axis both --steps 4 --out-dir shown").ok();
    let scene = |folder: &str, options: &str| {
        let line = format!(
            "simulate scene {SMALL} --projector 320x240 --projector-focal 530 --pattern shown/sequence.json {options} --out {folder}"
        );
        bench.run(&line)
    };
    let run = scene("stack", "--surface sphere --projector-gamma 2.2 --json").ok();
    let json: Value = serde_json::from_slice(&run.stdout).unwrap();
    let files: Vec<&str> = json["files"].as_array().unwrap().iter().map(|f| f.as_str().unwrap()).collect();
    let shown = std::fs::read_dir(bench.path("shown")).unwrap().count() - 1;
    let photographs: Vec<String> = (0..shown).map(|i| format!("frame_{i:03}.png")).collect();
    assert_eq!(files[..shown], photographs);
    assert_eq!(
        files[shown..],
        [
            "sequence.json",
            "rig.json",
            "truth_column.pfm",
            "truth_row.pfm",
            "truth_depth.pfm",
            "truth_surface.png"
        ]
    );
    assert_eq!(std::fs::read_dir(bench.path("stack")).unwrap().count(), files.len());
    for file in &photographs {
        let photo = image::open(bench.path("stack").join(file)).unwrap();
        assert_eq!((photo.width(), photo.height()), (320, 240));
    }
    assert_eq!(bench.text("stack/sequence.json"), bench.text("shown/sequence.json"));
    // As JPEG, with a description of these files, and in words.
    let text = scene("jpeg", "--jpeg 90").ok().words();
    assert!(text.contains(&format!("{shown} photographs, frame_000.jpg to frame_0")), "{text}");
    assert!(bench.text("jpeg/sequence.json").contains("\"frame_003.jpg\""));
    assert!(std::fs::read(bench.path("jpeg/frame_003.jpg")).unwrap().starts_with(&[0xFF, 0xD8]));
    // The pictures are not replaced by their photographs, nor photographs by others.
    scene("shown", "--force").fails(2, &["sequence.json", "input"]);
    scene("stack", "").fails(1, &["frame_000.png", "--force"]);
    let off = scene("off", "--surface sphere --wall none --aside 3000,0").ok();
    assert!(off.stderr.contains("none of the pattern"), "{}", off.stderr);
}

#[test]
fn nothing_of_a_scene_is_replaced_or_guessed() {
    let bench = bench();
    bench.put("vast.obj", "v 0 0 0\nv 1e200 0 0\nv 0 1e200 0\nf 1 2 3\n");
    let line = format!("simulate scene {SMALL} --out here");
    let _ = bench.run(&line).ok();
    bench.run(&line).fails(1, &["photo.png", "--force"]);
    let _ = bench.run(&format!("{line} --force")).ok();
    for (options, code, words) in [
        ("--surface cube", 2, vec!["cube", "plane, sphere, step, sheet"]),
        ("--surface no.ply", 3, vec!["no.ply"]),
        ("--rig none.json", 3, vec!["none.json"]),
        ("--rig here/rig.json --focal 900", 2, vec!["--focal"]),
        ("--wall 100", 2, vec!["--wall"]),
        ("--surface sphere --radius -3", 2, vec!["positive lengths"]),
        ("--albedo 1.5", 2, vec!["albedo", "0 to 1"]),
        ("--noise -1", 2, vec!["noise"]),
        ("--tilt 120,0", 2, vec!["tilt"]),
        ("--bits 12", 2, vec!["8 or 16"]),
        ("--pattern here/pattern.json --projector 800x600", 2, vec!["--projector 1024x768"]),
        ("--exact --noise 2", 2, vec!["--exact"]),
        ("--exact --jpeg 90", 2, vec!["--exact", "--jpeg"]),
        ("--bits 16 --jpeg 90", 2, vec!["bits", "8 with JPEG"]),
        ("--jpeg 0", 2, vec!["JPEG quality", "1 to 100"]),
        ("--jpeg 101", 2, vec!["JPEG quality", "1 to 100"]),
        ("--channel-shift 1,1", 2, vec!["--channel-shift", "four finite numbers"]),
        ("--channel-shift 0,0,0,99", 2, vec!["channel shift", "-20 to 20 px"]),
        ("--lateral-colour 0.5,0", 2, vec!["lateral colour"]),
        ("--demosaic nearest", 2, vec!["malvar", "bilinear"]),
        ("--sharpen 0.5,-1", 2, vec!["radius of sharpening"]),
        ("--sharpen nan,1", 2, vec!["--sharpen", "finite"]),
        ("--tone 1.5", 2, vec!["tone", "0 to 1"]),
        ("--vignetting nan", 2, vec!["vignetting", "0 to 1"]),
        ("--flicker 0.5,0", 2, vec!["period of flicker"]),
        ("--projector-gamma 0", 2, vec!["the projector's gamma"]),
        ("--projector-falloff 2", 2, vec!["the projector's falloff"]),
        ("--distance nan", 2, vec!["distance"]),
        ("--crosstalk -0.5", 2, vec!["crosstalk", "zero or more"]),
        ("--surface sphere --radius 1e9", 2, vec!["radius", "1000.0 mm"]),
        ("--surface vast.obj", 3, vec!["vast.obj", "1e9 mm"]),
        ("--bend 3mm", 2, vec!["--bend", "--surface sheet"]),
        ("--surface sphere --thickness 3mm", 2, vec!["--thickness", "--surface sheet"]),
        ("--surface sheet --thickness -3mm", 2, vec!["--thickness", "above zero"]),
        ("--surface sheet --thickness 3", 2, vec!["--thickness", "unit"]),
        ("--surface sheet --thickness 1m", 2, vec!["thickness of the sheet", "420 mm"]),
        ("--surface sheet --rig here/rig.json --pixel-aspect 1.1", 2, vec!["--pixel-aspect"]),
        ("--surface sheet --rig here/rig.json --projector-offset 5", 2, vec!["--projector-offset"]),
    ] {
        bench.run(&format!("simulate scene --out fresh {options}")).fails(code, &words);
    }
    assert!(!bench.path("fresh").exists(), "a folder was left");
}

#[test]
fn a_surface_out_of_the_light_is_said() {
    let run = bench()
        .run(&format!("simulate scene {SMALL} --surface sphere --wall none --aside 3000,0 --out off"))
        .ok();
    assert!(run.stderr.contains("none of the pattern"), "{}", run.stderr);
}

#[test]
fn bent_boards_are_rendered_and_told() {
    let bench = bench();
    let line = format!("simulate scene {SMALL} --surface sheet --bend=-30mm,20 --thickness 10mm --out board");
    let words = bench.run(&line).ok().words();
    assert!(
        words.contains("a board, 10 mm thick; bent: curl with a sag of -30.000 mm, axis at 20°"),
        "{words}"
    );
    let json: Value =
        serde_json::from_slice(&bench.run(&format!("{line} --json --force")).ok().stdout).unwrap();
    assert_eq!(json["bend"], serde_json::json!({"kind": "curl", "axis_deg": 20.0, "sag_mm": -30.0}));
    assert_eq!((&json["thickness_mm"], &json["surfaces"]), (&10.0.into(), &2.into()));
    // The same sheet before a given rig.
    let again = "simulate scene --surface sheet --rig board/rig.json --pattern board/pattern.json --bend=-30mm,20 \
                 --thickness 10mm --out again";
    let _ = bench.run(again).ok();
    let photo = |folder: &str| std::fs::read(bench.path(&format!("{folder}/photo.png"))).unwrap();
    assert_eq!(photo("again"), photo("board"));
    let flat = bench.run(&format!("simulate scene {SMALL} --surface sheet --out flat --json")).ok();
    let json: Value = serde_json::from_slice(&flat.stdout).unwrap();
    assert!(json["bend"].is_null() && json["thickness_mm"].is_null());
}
