//! Many frames at a time, streams of frames, and photographs that are none of stripes.

use std::collections::HashMap;
use std::fs;
use std::io::Cursor;

use image::{DynamicImage, ImageFormat, RgbImage};
use serde_json::Value;
use slcal_tests::{Bench, Run, Scene, process, repository};

use crate::bench;

/// Frames of a stream that outlasts a test.
const MOST_FRAMES: usize = 1000;

const MANY: &str = "reconstruct --rig rig.json --pattern stripes.json";

fn file(path: &str) -> Vec<u8> {
    fs::read(repository().join(path)).unwrap()
}

fn sphere() -> RgbImage {
    image::load_from_memory(&file("fixtures/sphere.jpg")).unwrap().to_rgb8()
}

fn png(picture: impl Into<DynamicImage>) -> Vec<u8> {
    let mut bytes = Vec::new();
    picture.into().write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png).unwrap();
    bytes
}

/// A folder with the rig and the stripes of the rendered photographs, and these photographs.
fn with_photos(photos: &[(&str, &str)]) -> Bench {
    let bench = bench();
    bench.put("rig.json", file("crates/slcal-cli/demo/truth_rig.json"));
    let _ = bench.run("pattern stripes --projector 1024x768 -o stripes.png").ok();
    for (name, path) in photos {
        bench.put(name, file(path));
    }
    bench
}

const THREE: [(&str, &str); 3] = [
    ("a.jpg", "fixtures/sphere.jpg"),
    ("b.jpg", "crates/slcal-cli/demo/board.jpg"),
    ("c.jpg", "crates/slcal-cli/demo/head.jpg"),
];

/// Names in a folder of the bench, sorted, hidden ones too.
fn names(bench: &Bench, folder: &str) -> Vec<String> {
    let entries = fs::read_dir(bench.path(folder)).unwrap();
    let mut names: Vec<String> =
        entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn bytes(bench: &Bench, name: &str) -> Vec<u8> {
    fs::read(bench.path(name)).unwrap()
}

fn json(run: &Run) -> Value {
    serde_json::from_slice(&run.stdout).unwrap_or_else(|e| panic!("{e}: {}", run.text()))
}

#[test]
fn the_number_of_jobs_changes_nothing() {
    let bench = with_photos(&THREE);
    let said: Vec<String> = [1, 4]
        .map(|jobs| {
            let run = bench.run(&format!("{MANY} a.jpg b.jpg c.jpg --out-dir d{jobs} --jobs {jobs}")).ok();
            assert_eq!(names(&bench, &format!("d{jobs}")), ["a.ply", "b.ply", "c.ply"]);
            run.text().replace(&format!("d{jobs}/"), "")
        })
        .into();
    for name in ["a.ply", "b.ply", "c.ply"] {
        assert_eq!(bytes(&bench, &format!("d1/{name}")), bytes(&bench, &format!("d4/{name}")), "{name}");
    }
    // Reports come in the order of the photographs, whoever is done first.
    assert_eq!(said[0], said[1]);
    let order: Vec<&str> = said[0].lines().filter_map(|l| l.split(" -> ").next()).collect();
    assert_eq!(order, ["a.jpg", "b.jpg", "c.jpg"]);
    // One photograph alone gives the same cloud.
    let _ = bench.run(&format!("{MANY} b.jpg -o alone.ply")).ok();
    assert_eq!(bytes(&bench, "alone.ply"), bytes(&bench, "d1/b.ply"));
}

#[test]
fn a_bad_frame_does_not_stop_the_others() {
    let bench = with_photos(&[("a.jpg", "fixtures/sphere.jpg"), ("z.jpg", "fixtures/sphere.jpg")]);
    bench.put("dark.png", png(RgbImage::new(1280, 960)));
    bench.put("text.jpg", "no picture");
    let run = bench.run(&format!("{MANY} a.jpg dark.png text.jpg none.jpg z.jpg --out-dir clouds --jobs 3"));
    // The first error's code, each error with its file's name.
    assert_eq!(run.code, 4, "{}", run.stderr);
    let place = |word: &str| run.stderr.find(word).unwrap_or_else(|| panic!("no {word}: {}", run.stderr));
    assert!(place("slcal: dark.png: ") < place("slcal: text.jpg: "));
    assert!(place("slcal: text.jpg: ") < place("slcal: none.jpg: "));
    assert!(
        run.stderr.contains("2 clouds written") && run.stderr.contains("3 frames failed"),
        "{}",
        run.stderr
    );
    assert_eq!(run.text().lines().count(), 2);
    assert_eq!(names(&bench, "clouds"), ["a.ply", "z.ply"]);
    let run = bench.run(&format!("{MANY} a.jpg text.jpg dark.png --out-dir clouds --force --json -q"));
    assert_eq!(run.code, 3, "{}", run.stderr);
    let report = json(&run);
    assert_eq!(report["schema"], "slcal-reconstruct/1");
    let clouds = report["clouds"].as_array().unwrap();
    assert_eq!(
        clouds.iter().map(|c| c["image"].as_str().unwrap()).collect::<Vec<_>>(),
        ["a.jpg", "text.jpg", "dark.png"]
    );
    assert!(clouds[0]["points"].as_u64().unwrap() > 10_000 && clouds[0].get("error").is_none());
    assert_eq!(clouds[0]["output"], "clouds/a.ply");
    assert_eq!((&clouds[1]["output"], &clouds[1]["error"]["exit_code"]), (&Value::Null, &3.into()));
    assert_eq!(clouds[2]["error"]["exit_code"], 4);
    assert!(clouds[2]["error"]["message"].as_str().unwrap().contains("dark.png"));
}

#[test]
fn resuming_leaves_what_is_complete() {
    let bench = with_photos(&THREE);
    for format in ["ply", "pcd", "glb"] {
        let line = format!("{MANY} a.jpg b.jpg c.jpg --out-dir {format} --format {format}");
        let _ = bench.run(&format!("{line} -q")).ok();
        bench.run(&line).fails(1, &["a.", "--force"]);
        let [a, b, c] = ["a", "b", "c"].map(|n| format!("{format}/{n}.{format}"));
        let whole = [bytes(&bench, &a), bytes(&bench, &b)];
        // One is gone, one was cut off by something else.
        fs::remove_file(bench.path(&a)).unwrap();
        bench.put(&b, &whole[1][..whole[1].len() - 7]);
        let before = fs::metadata(bench.path(&c)).unwrap().modified().unwrap();
        let run = bench.run(&format!("{line} --resume --json")).ok();
        assert!(run.stderr.contains(&format!("c.jpg -> {c}: skipped")), "{}", run.stderr);
        let report = json(&run);
        assert!(report["clouds"][0]["points"].is_u64() && report["clouds"][1]["points"].is_u64());
        assert_eq!(report["clouds"][2]["resumed"], true);
        assert_eq!([bytes(&bench, &a), bytes(&bench, &b)], whole);
        assert_eq!(fs::metadata(bench.path(&c)).unwrap().modified().unwrap(), before);
        assert_eq!(names(&bench, format).len(), 3);
    }
}

#[test]
fn depth_limits_leave_out_what_is_nearer_and_farther() {
    let bench = with_photos(&THREE[..1]);
    let depths = |options: &str| -> Vec<f64> {
        let _ = bench.run(&format!("{MANY} a.jpg -o c.xyz --cull off --force {options}")).ok();
        let text = bench.text("c.xyz");
        let rows = text.lines().filter(|l| !l.starts_with('#')).filter_map(|l| l.split_whitespace().nth(2));
        rows.map(|z| z.parse().unwrap()).collect()
    };
    let mut all = depths("");
    all.sort_by(f64::total_cmp);
    let limit = all[all.len() / 2].round();
    let (near, far) = (depths(&format!("--near {limit}mm")), depths(&format!("--far {}cm", limit / 10.0)));
    assert!(near.len() > 1000 && near.iter().all(|z| *z >= limit));
    assert!(far.len() > 1000 && far.iter().all(|z| *z <= limit));
    assert_eq!(near.len() + far.len(), all.len());
    bench.run(&format!("{MANY} a.jpg -o d.ply --near 900")).fails(2, &["--near", "unit"]);
    bench.run(&format!("{MANY} a.jpg -o d.ply --near 900mm --far 80cm")).fails(2, &["--far", "--near"]);
    assert!(!bench.path("d.ply").exists());
}

#[test]
fn photographs_of_one_name_are_refused() {
    let bench = with_photos(&[("x.jpg", "fixtures/sphere.jpg")]);
    fs::create_dir(bench.path("sub")).unwrap();
    bench.put("sub/x.png", png(sphere()));
    bench
        .run(&format!("{MANY} x.jpg sub/x.png --out-dir clouds"))
        .fails(2, &["x.jpg", "sub/x.png", "clouds/x.ply", "rename"]);
    // Dots within a name are part of it.
    fs::copy(bench.path("x.jpg"), bench.path("scan.1.jpg")).unwrap();
    fs::copy(bench.path("x.jpg"), bench.path("scan.2.jpg")).unwrap();
    let _ = bench.run(&format!("{MANY} scan.1.jpg scan.2.jpg --out-dir clouds --format xyz")).ok();
    assert_eq!(names(&bench, "clouds"), ["scan.1.xyz", "scan.2.xyz"]);
}

#[test]
fn a_photograph_comes_through_stdin() {
    let bench = with_photos(&[("a.jpg", "fixtures/sphere.jpg")]);
    let run = |line: &str, stdin: &[u8]| bench.run_args(&line.split(' ').collect::<Vec<_>>(), stdin);
    let photo = file("fixtures/sphere.jpg");
    let _ = run(&format!("{MANY} a.jpg -o a.pcd"), &[]).ok();
    let piped = run(&format!("{MANY} - -o piped.pcd"), &photo).ok();
    assert!(piped.words().contains("points"));
    assert_eq!(bytes(&bench, "a.pcd"), bytes(&bench, "piped.pcd"));
    let _ = run(&format!("{MANY} - a.jpg --out-dir clouds"), &photo).ok();
    assert_eq!(bytes(&bench, "clouds/stdin.ply"), bytes(&bench, "clouds/a.ply"));
    run(&format!("{MANY} - -o c.ply"), &[]).fails(3, &["stdin", "no data"]);
    run(&format!("{MANY} - -o c.ply"), b"no picture").fails(3, &["stdin", "text file"]);
    run(&format!("{MANY} - - --out-dir d"), &photo).fails(2, &["stdin"]);
    assert!(!bench.names().iter().any(|n| n == "c.ply" || n == "d"));
}

/// The frame of a stream in one of its formats.
fn raw(picture: &RgbImage, format: &str) -> Vec<u8> {
    let samples = picture.as_raw();
    match format {
        "rgb24" => samples.clone(),
        "bgr24" => samples.as_chunks::<3>().0.iter().flat_map(|[r, g, b]| [*b, *g, *r]).collect(),
        "rgb48le" => samples.iter().flat_map(|c| (u16::from(*c) * 257).to_le_bytes()).collect(),
        other => panic!("{other}"),
    }
}

#[test]
fn a_stream_of_frames_becomes_a_folder_of_clouds() {
    let bench = with_photos(&[]);
    bench.put("a.png", png(sphere()));
    let _ = bench.run(&format!("{MANY} a.png -o a.ply")).ok();
    for format in ["rgb24", "bgr24", "rgb48le"] {
        let line = format!("{MANY} --raw 1280x960:{format} --out-dir {format} --jobs 2");
        let frame = raw(&sphere(), format);
        let run = bench.run_args(&line.split(' ').collect::<Vec<_>>(), &frame.repeat(2)).ok();
        assert_eq!(names(&bench, format), ["frame_000000.ply", "frame_000001.ply"]);
        assert!(
            run.words().contains(&format!("stdin, frame 1 -> {format}/frame_000001.ply")),
            "{}",
            run.text()
        );
        let [first, second] = [0, 1].map(|n| bytes(&bench, &format!("{format}/frame_00000{n}.ply")));
        assert_eq!(first, second);
        // 16 bit in 257 steps is the same light, and 8 bit the same bytes, up to rounding in single precision.
        assert_eq!(first.len(), bytes(&bench, "a.ply").len(), "{format}");
        if format != "rgb48le" {
            assert_eq!(first, bytes(&bench, "a.ply"), "{format}");
        }
    }
}

#[test]
fn a_stream_that_is_cut_off_keeps_its_finished_clouds() {
    let bench = with_photos(&[]);
    let frame = raw(&sphere(), "rgb24");
    let run = |line: &str, stdin: &[u8]| bench.run_args(&line.split(' ').collect::<Vec<_>>(), stdin);
    let line = format!("{MANY} --raw 1280x960:rgb24 --out-dir clouds");
    let cut = run(&line, &frame.repeat(2)[..frame.len() + 1000]);
    assert_eq!(cut.code, 3, "{}", cut.stderr);
    for word in ["stdin, frame 1", "1000", "3686400", "truncated"] {
        assert!(cut.stderr.contains(word), "no {word}: {}", cut.stderr);
    }
    assert_eq!(names(&bench, "clouds"), ["frame_000000.ply"]);
    run(&line, &frame).fails(1, &["frame_000000.ply", "--force"]);
    let resumed = run(&format!("{line} --resume --json"), &frame.repeat(2)).ok();
    let report = json(&resumed);
    assert_eq!(report["clouds"][0]["resumed"], true);
    assert_eq!((&report["clouds"][1]["image"], &report["clouds"][1]["frame"]), (&"-".into(), &1.into()));
    assert_eq!(names(&bench, "clouds"), ["frame_000000.ply", "frame_000001.ply"]);
    // Any frame that is there counts, not the first alone.
    fs::remove_file(bench.path("clouds/frame_000000.ply")).unwrap();
    run(&line, &frame).fails(1, &["frame_000001.ply", "--force"]);
    run(&format!("{MANY} --raw 1280x960:rgb24 --out-dir none"), &[]).fails(3, &["stdin", "empty stream"]);
    run(&format!("{MANY} --raw 640x480:rgb24 --out-dir none"), &frame).fails(3, &["640x480", "1280x960"]);
    run(&format!("{MANY} --raw 1280x960:gray --out-dir none"), &frame).fails(2, &["colour"]);
    run(&format!("{MANY} a.jpg --raw 1280x960:rgb24 --out-dir none"), &frame).fails(2, &["--raw"]);
}

#[test]
fn all_clouds_are_made_though_nobody_reads_what_is_said() {
    use std::process::Stdio;

    let bench = with_photos(&THREE);
    let mut child = bench
        .command()
        .args(format!("{MANY} a.jpg b.jpg c.jpg --out-dir clouds --jobs 1").split(' '))
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert_eq!(process::wait(&mut child).code(), Some(0));
    assert_eq!(names(&bench, "clouds"), ["a.ply", "b.ply", "c.ply"]);
}

// Elsewhere than on Linux, signals but SIGTERM are left alone where stderr is no terminal.
#[cfg(target_os = "linux")]
#[test]
fn an_interrupt_leaves_finished_clouds_and_nothing_else() {
    use std::io::Write as _;
    use std::process::Stdio;
    use std::time::{Duration, Instant};

    let bench = with_photos(&[]);
    let frame = raw(&sphere(), "rgb24");
    let args: Vec<String> =
        format!("{MANY} --raw 1280x960:rgb24 --out-dir clouds").split(' ').map(str::to_owned).collect();
    let mut child = bench
        .command()
        .args(&args)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut pipe = child.stdin.take().unwrap();
    // A stream that is longer than the test waits.
    let feeder = std::thread::spawn(move || (0..MOST_FRAMES).all(|_| pipe.write_all(&frame).is_ok()));
    let started = Instant::now();
    // In whatever order: two are worked on at a time.
    let finished = || {
        let entries = fs::read_dir(bench.path("clouds")).into_iter().flatten().flatten();
        entries.filter(|e| e.file_name().to_string_lossy().starts_with("frame_")).count()
    };
    while finished() < 3 && started.elapsed() < Duration::from_mins(1) {
        std::thread::sleep(Duration::from_millis(5));
    }
    process::signal(&child, "INT");
    let status = process::wait(&mut child);
    assert_eq!(status.code(), Some(130), "{status}");
    feeder.join().unwrap();
    let names = names(&bench, "clouds");
    assert!(names.len() >= 3);
    let length = bytes(&bench, &format!("clouds/{}", names[0])).len();
    for name in names {
        assert!(name.starts_with("frame_"), "{name}");
        assert_eq!(bytes(&bench, &format!("clouds/{name}")).len(), length, "{name}");
    }
}

/// Asserts that a photograph is refused by both verbs, for a reason with one of these words, and leaves nothing.
fn refused(bench: &Bench, photo: &str, pattern: &str, codes: &[i32], words: &[&str]) {
    let before = bench.names();
    for line in [
        format!(
            "reconstruct --rig rig.json --pattern {pattern} {photo} -o cloud.ply --overlay seen.png --json"
        ),
        format!("decode --pattern {pattern} {photo} -o m.csv --json"),
    ] {
        let run = bench.run(&line);
        assert!(codes.contains(&run.code), "{photo}, {pattern}: exit code {}: {}", run.code, run.stderr);
        run.fails(run.code, &[photo]);
        assert!(
            words.iter().any(|w| run.stderr.contains(w)),
            "{photo}, {pattern}: none of {words:?} in {}",
            run.stderr
        );
        assert_eq!(bench.names(), before);
    }
}

#[test]
fn what_is_no_photograph_of_stripes_gives_no_cloud() {
    let bench = with_photos(&[]);
    fs::create_dir(bench.path("folder")).unwrap();
    refused(&bench, "folder", "stripes.json", &[3], &["folder"]);
    let full = Scene { camera: [1280, 960], ..Scene::default() };
    // Grey in a grey file, and in a file that could hold colours.
    bench.put("grey.png", png(DynamicImage::ImageRgb8(sphere()).to_luma8()));
    refused(&bench, "grey.png", "stripes.json", &[3, 4], &["grey", "colour"]);
    bench.put(
        "grey_rgb.png",
        png(DynamicImage::ImageLuma8(DynamicImage::ImageRgb8(sphere()).to_luma8()).to_rgb8()),
    );
    refused(&bench, "grey_rgb.png", "stripes.json", &[3, 4], &["grey", "colour"]);
    // White light, a dark room, a glaring one, noise.
    bench.put("white.png", png(full.photograph(None)));
    refused(&bench, "white.png", "stripes.json", &[4], &["not found"]);
    bench.put("black.png", png(RgbImage::new(1280, 960)));
    refused(&bench, "black.png", "stripes.json", &[4], &["not found"]);
    bench.put("glare.png", png(RgbImage::from_pixel(1280, 960, image::Rgb([255; 3]))));
    refused(&bench, "glare.png", "stripes.json", &[4], &["not found"]);
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    bench.put(
        "noise.png",
        png(RgbImage::from_fn(1280, 960, |_, _| image::Rgb([random(), random(), random()]))),
    );
    refused(&bench, "noise.png", "stripes.json", &[4], &["not found"]);
    // The checkerboard instead of the stripes.
    bench.put("board.jpg", file("crates/slcal-cli/demo/sheet.jpg"));
    refused(&bench, "board.jpg", "stripes.json", &[4], &["not found"]);
    // A single pixel.
    bench.put("dot.png", png(RgbImage::new(1, 1)));
    refused(&bench, "dot.png", "stripes.json", &[3, 4], &["dot.png"]);
}

#[test]
fn a_saturated_photograph_gives_no_cloud_of_nonsense() {
    let bench = with_photos(&[]);
    // Every stripe clipped to white: no colour is left.
    let mut white = sphere();
    for p in white.pixels_mut() {
        *p = image::Rgb([if p.0.iter().any(|c| *c > 40) { 255 } else { 0 }; 3]);
    }
    bench.put("white.png", png(white));
    refused(&bench, "white.png", "stripes.json", &[3, 4], &["saturated", "overexposed", "grey", "colour"]);
    // Every channel clipped: what is left of the colours may do, and then the numbers are those of the good photograph.
    let mut burnt = sphere();
    for c in burnt.iter_mut() {
        *c = if *c > 60 { 255 } else { *c };
    }
    bench.put("burnt.png", png(burnt));
    bench.put("good.png", png(sphere()));
    let _ = bench.run("decode --pattern stripes.json good.png -o good.csv").ok();
    let run = bench.run("decode --pattern stripes.json burnt.png -o burnt.csv");
    if run.code != 0 {
        assert!(matches!(run.code, 3 | 4), "{}", run.stderr);
        return run.fails(run.code, &["burnt.png"]);
    }
    assert!(run.words().contains("overexposed"), "{}", run.text());
    let [good, burnt] = ["good.csv", "burnt.csv"].map(|name| stripes(&bench.text(name)));
    let near = |key: &(u64, u64), u: f64| good.get(key).map(|all| all.iter().any(|x| (x - u).abs() < 4.0));
    let judged: Vec<bool> =
        burnt.iter().flat_map(|(key, all)| all.iter().filter_map(|u| near(key, *u))).collect();
    let right = judged.iter().filter(|r| **r).count();
    assert!(judged.len() > 1000 && right * 100 >= judged.len() * 99, "{right} of {}", judged.len());
}

/// The places of each slit in each row, of a table of matches.
fn stripes(table: &str) -> HashMap<(u64, u64), Vec<f64>> {
    let mut stripes: HashMap<(u64, u64), Vec<f64>> = HashMap::new();
    for line in table.lines().skip(1) {
        let fields: Vec<f64> = line.split(',').map(|f| f.parse().unwrap()).collect();
        stripes.entry((fields[1] as u64, fields[3] as u64)).or_default().push(fields[0]);
    }
    stripes
}

#[test]
fn stripes_that_run_the_wrong_way_give_no_cloud() {
    let bench = with_photos(&[("a.jpg", "fixtures/sphere.jpg")]);
    let mut rows: Value = serde_json::from_str(&bench.text("stripes.json")).unwrap();
    rows["axis"] = "rows".into();
    for c in rows["centres_px"].as_array_mut().unwrap() {
        *c = (c.as_f64().unwrap() * 0.75).into();
    }
    rows["width_px"] = (rows["width_px"].as_f64().unwrap() * 0.75).into();
    bench.put("rows.json", rows.to_string());
    // A camera may lie on its side, so that decoding alone cannot know; the rig does.
    let before = bench.names();
    let run = bench.run("reconstruct --rig rig.json --pattern rows.json a.jpg -o cloud.ply --json");
    run.fails(4, &["a.jpg", "not found", "pattern"]);
    assert_eq!(bench.names(), before);
    // A photograph that lies on its side, for a rig whose camera stood upright.
    bench.put("turned.png", png(image::imageops::rotate90(&sphere())));
    bench.run(&format!("{MANY} turned.png -o cloud.ply")).fails(3, &["turned.png", "1280x960", "960x1280"]);
}

#[test]
fn black_and_white_photographs_of_another_size_are_named() {
    let bench = with_photos(&[("a.jpg", "fixtures/sphere.jpg")]);
    bench.put("small.png", png(RgbImage::new(640, 480)));
    for option in ["--black", "--white"] {
        bench
            .run(&format!("{MANY} a.jpg {option} small.png -o cloud.ply"))
            .fails(3, &["small.png: ", "640x480"]);
        bench.run(&format!("{MANY} a.jpg {option} - -o cloud.ply")).fails(2, &["stdin"]);
        bench.run(&format!("{MANY} a.jpg {option} none.png -o cloud.ply")).fails(3, &["none.png"]);
    }
    assert!(!bench.names().iter().any(|n| n == "cloud.ply"));
}

#[test]
fn a_folder_that_cannot_be_made_is_found_before_the_work() {
    let bench = with_photos(&[]);
    bench.run(&format!("{MANY} none.jpg --out-dir no/such")).fails(1, &["no/such"]);
    bench.put("taken", "a file");
    bench.run(&format!("{MANY} none.jpg --out-dir taken")).fails(1, &["taken"]);
    bench.run(&format!("{MANY} none.jpg --out-dir d --overlay d/none.ply")).fails(2, &["two results"]);
}

// The file system of macOS takes no such names.
#[cfg(target_os = "linux")]
#[test]
fn a_name_that_is_no_unicode_is_no_reason_to_say_nothing() {
    use std::os::unix::ffi::OsStrExt as _;

    let bench = with_photos(&[]);
    let name = std::ffi::OsStr::from_bytes(b"caf\xe9.png");
    fs::write(bench.path("").join(name), png(RgbImage::new(1280, 960))).unwrap();
    let run = bench
        .command()
        .args(format!("{MANY} --out-dir clouds --json").split(' '))
        .arg(name)
        .output()
        .unwrap();
    assert_eq!(run.status.code(), Some(4));
    let said: Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!(said["clouds"][0]["image"], "caf\u{fffd}.png");
}

#[test]
fn a_drawing_is_not_mixed_with_what_is_said() {
    let bench = with_photos(&[]);
    for verb in [format!("{MANY} none.jpg -o"), "decode --pattern stripes.json none.jpg -o".into()] {
        for more in ["", " --json"] {
            bench.run(&format!("{verb} out.ply --overlay -{more}")).fails(2, &["--overlay", "a file"]);
        }
    }
}

#[test]
fn a_report_names_only_files_that_there_are() {
    let bench = with_photos(&THREE[1..2]);
    let words = "reconstruct --rig - --pattern stripes.json b.jpg -o c.ply --report c.html";
    let words: Vec<&str> = words.split(' ').collect();
    let _ = bench.run_args(&words, &bytes(&bench, "rig.json")).ok();
    let page = bench.text("c.html");
    assert!(page.contains("slcal evaluate plane c.ply") && !page.contains("--rig stdin"));
    let _ = bench.run(&format!("{MANY} b.jpg -o c.ply --report c.html --force")).ok();
    assert!(bench.text("c.html").contains("slcal report --rig rig.json --cloud c.ply"));
}

/// The truth of the rendered photographs with the camera moved in its own frame, mm.
fn moved_rig(by_mm: [f64; 3]) -> Vec<u8> {
    let mut rig: Value = serde_json::from_slice(&file("crates/slcal-cli/demo/truth_rig.json")).unwrap();
    let pose = &mut rig["projector_from_camera"];
    for row in 0..3 {
        let by: f64 = (0..3).map(|k| pose["R"][row][k].as_f64().unwrap() * by_mm[k]).sum();
        pose["t"][row] = (pose["t"][row].as_f64().unwrap() + by).into();
    }
    serde_json::to_vec(&rig).unwrap()
}

#[test]
fn a_rig_that_moved_is_told_by_the_stripes() {
    let bench = with_photos(&THREE[..1]);
    bench.put("moved.json", moved_rig([-10.0, 10.0, 0.0]));
    let right = json(&bench.run(&format!("{MANY} a.jpg -o right.ply --json -q")).ok());
    assert_eq!(right["clouds"][0]["warnings"], serde_json::json!([]));
    assert!(right["clouds"][0]["rig_check"]["slits"].as_u64().unwrap() > 50);
    let line = "reconstruct --rig moved.json --pattern stripes.json a.jpg";
    let wrong = json(&bench.run(&format!("{line} -o wrong.ply --json -q")).ok());
    let warning = &wrong["clouds"][0]["warnings"][0];
    assert_eq!(warning["code"], "rig-moved");
    // The cloud is written nevertheless, and the summary, the line of many frames and the report say it.
    assert!(bench.path("wrong.ply").exists());
    let run = bench.run(&format!("{line} -o wrong.ply --force --report report.html")).ok();
    let said = run.text().split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains(warning["message"].as_str().unwrap()) && said.contains("(rig-moved)"), "{said}");
    assert!(said.contains(warning["advice"].as_str().unwrap()), "{said}");
    let page = String::from_utf8(bytes(&bench, "report.html")).unwrap();
    assert!(page.contains("Does the rig fit?") && page.contains("rig-moved"));
    let many = bench.run(&format!("{line} --out-dir clouds")).ok();
    assert!(many.text().contains("(rig-moved)"), "{}", many.text());
}

#[test]
fn stripes_that_are_too_fine_are_refused_for_that_reason() {
    let bench = bench();
    for (focal, words) in [(330, "too fine to tell their colours"), (280, "3 px wide or more")] {
        let scene = format!(
            "simulate scene --surface plane --camera 640x480 --focal {focal} --blur 1.2 --out far --force"
        );
        let _ = bench.run(&scene).ok();
        bench.run("decode --pattern far/pattern.json far/photo.png -o m.csv").fails(4, &[words]);
    }
}
