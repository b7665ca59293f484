//! Sequences of frames: decoded, reconstructed, triangulated, and what is said of frames that do not fit.

use std::fs;

use serde_json::Value;
use slcal_tests::Bench;

use crate::bench;

/// White and black, six bits with their inverses, eight steps.
const FRAMES: usize = 22;

/// A simulated stack of a sphere before a wall, in `stack`.
fn stack() -> Bench {
    let bench = bench();
    let _ = bench.run("pattern phase --projector 320x240 --out-dir shown").ok();
    let scene = "--surface sphere --camera 320x240 --focal 375 --projector 320x240 --projector-focal 530";
    let _ = bench.run(&format!("simulate scene {scene} --pattern shown/sequence.json --out stack")).ok();
    bench
}

const RECONSTRUCT: &str = "reconstruct --rig stack/rig.json --pattern stack/sequence.json";

/// The numbers of a PFM, the first row first.
fn pfm(bench: &Bench, name: &str) -> Vec<f32> {
    let bytes = fs::read(bench.path(name)).unwrap();
    let values = &bytes[bytes.len() - 4 * 320 * 240..];
    let rows = values.chunks_exact(4 * 320).rev();
    rows.flat_map(|row| row.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b))).collect()
}

#[test]
fn a_folder_of_frames_becomes_a_cloud_with_a_point_per_pixel() {
    let bench = stack();
    let run = bench.run(&format!("{RECONSTRUCT} stack -o cloud.ply --mesh --depth depth.pfm")).ok();
    assert!(run.words().contains("decoded"), "{}", run.words());
    let [depth, truth] = ["depth.pfm", "stack/truth_depth.pfm"].map(|name| pfm(&bench, name));
    let mut errors: Vec<f32> =
        depth.iter().zip(&truth).map(|(a, b)| (a - b).abs()).filter(|e| e.is_finite()).collect();
    errors.sort_unstable_by(f32::total_cmp);
    assert!(
        errors.len() > 10_000 && errors[errors.len() / 2] < 0.5,
        "{} {}",
        errors.len(),
        errors[errors.len() / 2]
    );
    let _ = bench.run(&format!("{RECONSTRUCT} stack -o again.ply --depth depth.png")).ok();

    // By the matches of every pixel, the same points as without culling.
    let decode = "decode --pattern stack/sequence.json stack";
    let json = bench.run(&format!("{decode} -o matches.npz --json")).ok().text();
    let report: Value = serde_json::from_str(json.trim()).unwrap();
    assert!(report["frames"] == FRAMES && report["decoded"].as_u64() > Some(10_000), "{report}");
    let _ = bench.run("triangulate matches.npz --rig stack/rig.json -o points.ply").ok();
    let _ = bench.run(&format!("{RECONSTRUCT} stack -o all.ply --cull off")).ok();
    assert_eq!(fs::read(bench.path("points.ply")).unwrap(), fs::read(bench.path("all.ply")).unwrap());
    let _ = bench.run(&format!("{decode} -o matches.csv")).ok();
    assert!(bench.text("matches.csv").lines().count() > 10_000);
}

#[test]
fn folders_are_scans_and_what_does_not_fit_is_named() {
    let bench = stack();
    for name in ["a", "b"] {
        fs::create_dir_all(bench.path(name)).unwrap();
        for i in 0..FRAMES {
            let frame = format!("frame_{i:03}.png");
            fs::copy(bench.path(&format!("stack/{frame}")), bench.path(&format!("{name}/{frame}"))).unwrap();
        }
    }
    fs::remove_file(bench.path("b/frame_003.png")).unwrap();
    let run = bench.run(&format!("{RECONSTRUCT} a b --out-dir clouds"));
    run.fails(3, &["b: frames: expected frame_003.png (frame 3, bit", "among the photographs"]);
    let _ = bench.run(&format!("{RECONSTRUCT} a --out-dir clouds")).ok();
    assert!(bench.path("clouds/a.ply").is_file());
    fs::copy(bench.path("a/frame_004.png"), bench.path("a/frame_005.png")).unwrap();
    bench.run(&format!("{RECONSTRUCT} a -o x.ply")).fails(3, &["frames 4", "same pixels"]);
    let copy = |from: &str, to: &str| fs::copy(bench.path(from), bench.path(to)).unwrap();
    let (white, black) = ("a/frame_000.png", "a/frame_001.png");
    let _ = copy("stack/frame_005.png", "a/frame_005.png");
    let _ = (copy("stack/frame_001.png", white), copy("stack/frame_000.png", black));
    bench
        .run(&format!("{RECONSTRUCT} a -o x.ply"))
        .fails(3, &["order of the pattern", "white is darker than black"]);
    let _ = (copy("stack/frame_000.png", white), copy("stack/frame_001.png", black));
    let _ = copy(white, "a/frame_005.jpg");
    bench
        .run(&format!("{RECONSTRUCT} a -o x.ply"))
        .fails(3, &["one photograph of frame 5", "frame_005.jpg and frame_005.png"]);
    // The pictures of the pattern are no photographs of a scene.
    bench.run(&format!("{RECONSTRUCT} shown -o x.ply")).fails(4, &["parallax"]);
    assert!(!bench.path("x.ply").exists());
    bench.run(&format!("{RECONSTRUCT} a -o x.ply --black a/frame_001.png")).fails(2, &["--black"]);
    bench
        .run(&format!("{RECONSTRUCT} a/frame_000.png -o x.ply"))
        .fails(3, &["frames of the pattern", "found 1"]);
    bench.run(&format!("{RECONSTRUCT} - -o x.ply")).fails(2, &["not from stdin"]);
    bench.run(&format!("{RECONSTRUCT} stack -o x.ply --depth d.tif")).fails(2, &[".pfm or .png"]);
}

#[test]
fn a_scan_is_drawn_pixel_by_pixel_and_has_its_report() {
    let bench = stack();
    let run = format!("{RECONSTRUCT} stack -o cloud.ply --overlay seen.png --report page.html --fit sphere");
    let _ = bench.run(&run).ok();
    let _ = bench.run("decode --pattern stack/sequence.json stack -o m.npz --overlay decoded.png").ok();
    let [seen, decoded] =
        ["seen.png", "decoded.png"].map(|name| image::open(bench.path(name)).unwrap().into_rgb8());
    // Of the same matches the same picture, under another name or none.
    assert_eq!(seen.as_raw(), decoded.as_raw());
    // The picture is enlarged, as it is tiny; columns grow brighter from left to right, where they are decoded.
    let truth = pfm(&bench, "stack/truth_column.pfm");
    let k = seen.width() / 320;
    let green = |x: usize, y: usize| f64::from(seen.get_pixel(k * x as u32, k * y as u32).0[1]);
    let (mut low, mut high) = (Vec::new(), Vec::new());
    for y in (60..180).step_by(3) {
        for x in (20..300).step_by(3) {
            match truth[320 * y + x] {
                column if column < 100.0 => low.push(green(x, y)),
                column if column > 220.0 => high.push(green(x, y)),
                _ => {}
            }
        }
    }
    let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64;
    assert!(
        low.len() > 100 && high.len() > 100 && mean(&high) > mean(&low) + 30.0,
        "{} {}",
        mean(&low),
        mean(&high)
    );

    let page = bench.text("page.html");
    for part in [
        "of the lit pixels decoded",
        "Where each pixel lies on the projector",
        "undecided",
        "Distance of the points",
        "1σ of the column",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("their stripes") && !page.contains("The stripes where"), "a sequence has none");
}

#[test]
fn a_pattern_from_stdin_is_read_once() {
    let bench = bench();
    bench.put("sphere.jpg", fs::read(slcal_tests::repository().join("fixtures/sphere.jpg")).unwrap());
    let _ = bench.run("pattern stripes --projector 1024x768 -o stripes.png").ok();
    let stripes = fs::read(bench.path("stripes.json")).unwrap();
    let decode = ["decode", "--pattern", "-", "sphere.jpg", "-o", "matches.csv"];
    let _ = bench.run_args(&decode, &stripes).ok();
    assert!(bench.text("matches.csv").lines().count() > 1000);
}
