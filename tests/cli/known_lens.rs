//! What is known about the lens beforehand: `--camera` files of other programs, and `--exif`.

use std::io::Cursor;

use image::{DynamicImage, ImageFormat};
use serde_json::Value;
use slcal_core::pattern::{CheckerConfig, CheckerPattern};
use slcal_tests::{Bench, Scene};

use crate::bench;

const LINE: &str = "calibrate photo.png --size A2-landscape --pattern checker.json --json --camera";

const OPENCV: &str = "%YAML:1.0\n---\nimage_width: 960\nimage_height: 720\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   \
                      dt: d\n   data: [ 1150., 0., 479.5, 0., 1150., 359.5, 0., 0., 1. ]\ndistortion_coefficients: \
                      !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   data: [ 0., 0., 0., 0., 0. ]\n";

fn with_photo() -> Bench {
    let bench = bench();
    let _ = bench.run("pattern checker --projector 1024x768 -o checker.png").ok();
    let checker = CheckerPattern::new([1024, 768], &CheckerConfig::default()).unwrap();
    DynamicImage::ImageRgb8(Scene::default().photograph(Some(&checker)))
        .save_with_format(bench.path("photo.png"), ImageFormat::Png)
        .unwrap();
    bench
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn cameras_of_other_programs_are_known_cameras() {
    let bench = with_photo();
    let xml = "<?xml version=\"1.0\"?>\n<opencv_storage><image_width>960</image_width><image_height>720</image_height>\
               <camera_matrix type_id=\"opencv-matrix\"><rows>3</rows><cols>3</cols><dt>d</dt><data>1150. 0. 479.5 0. 1150. \
               359.5 0. 0. 1.</data></camera_matrix><distortion_coefficients type_id=\"opencv-matrix\"><rows>1</rows>\
               <cols>4</cols><dt>d</dt><data>0. 0. 0. 0.</data></distortion_coefficients></opencv_storage>";
    let ros = OPENCV
        .replace("%YAML:1.0\n---\n", "camera_name: a\ndistortion_model: plumb_bob\n")
        .replace("!!opencv-matrix", "");
    for (name, text) in [("camera.yml", OPENCV), ("camera.xml", xml), ("camera.txt", &ros)] {
        bench.put(name, text);
        let run = bench.run(&format!("{LINE} {name}")).ok();
        let rig = json(&run.text());
        assert_eq!(rig["camera"]["K"][0][0], 1150.0);
        assert_eq!(rig["camera"]["sigma"]["focal_px"], 0.0);
        let f = rig["projector"]["K"][0][0].as_f64().unwrap();
        assert!((f / Scene::default().projector_focal_px - 1.0).abs() < 0.004, "{f}");
        assert!(run.stderr.is_empty(), "{}", run.stderr);
    }
    // Without a size the photograph's is taken, and that is said.
    bench.put("camera.yml", OPENCV.replace("image_width: 960\nimage_height: 720\n", ""));
    let run = bench.run(&format!("{LINE} camera.yml")).ok();
    assert!(run.stderr.contains("camera.yml: the file does not state an image size"), "{}", run.stderr);
    let piped: Vec<&str> = LINE.split(' ').chain(["-"]).collect();
    let _ = bench.run_args(&piped, OPENCV.as_bytes()).ok();
}

#[test]
fn camera_files_that_do_not_fit_are_refused() {
    let bench = with_photo();
    let refused = |bytes: &[u8], words: &[&str]| {
        bench.put("camera.yml", bytes);
        bench.run(&format!("{LINE} camera.yml")).fails(3, &[&["camera.yml"], words].concat());
    };
    let with = |from: &str, to: &str| OPENCV.replace(from, to).into_bytes();
    refused(&with("960", "1920"), &["960x720", "1920x720", "shape"]);
    refused(&with("960\nimage_height: 720", "1920\nimage_height: 1440"), &["960x720", "1920x1440", "575.00"]);
    refused(&with("479.5", "9999"), &["principal point", "9999"]);
    refused(&with("1150.", "4.2"), &["focal", "4.2", "pixels"]);
    refused(&with("1150.", "-1150."), &["positive"]);
    refused(&with("1150.", ".Nan"), &["finite"]);
    refused(&with("cols: 3", "cols: 2"), &["3x2"]);
    refused(b"a: &a [1]\nb: [*a]\n", &["alias"]);
    refused("[".repeat(1 << 20).as_bytes(), &["camera file"]);
    refused(b"", &["empty"]);
    refused(&[0x89, b'P', b'N', b'G', 0, 0xFF], &["a PNG picture"]);
    refused(&vec![b'x'; 100_000_000], &["at most"]);
    refused(b"hello: world\n", &["camera matrix", "hello"]);
    std::fs::remove_file(bench.path("camera.yml")).unwrap();
    std::fs::create_dir(bench.path("camera.yml")).unwrap();
    bench.run(&format!("{LINE} camera.yml")).fails(3, &["camera.yml", "folder"]);
    bench.run(&format!("{LINE} none.yml")).fails(3, &["none.yml", "no such file"]);
}

/// One entry of an EXIF directory: a SHORT (3) or LONG (4), or a RATIONAL (5) by its offset.
fn entry(tag: u16, kind: u16, value: u32) -> Vec<u8> {
    [&tag.to_le_bytes()[..], &kind.to_le_bytes(), &1_u32.to_le_bytes(), &value.to_le_bytes()].concat()
}

/// A JPEG with these entries in its EXIF directory; `rational` stands at offset 8 of the block.
fn jpeg(scene: &Scene, entries: &[Vec<u8>], rational: [u32; 2]) -> Vec<u8> {
    let mut plain = Vec::new();
    let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(Cursor::new(&mut plain), 98);
    scene.photograph(None).write_with_encoder(encoder).unwrap();
    let directory = |entries: &[Vec<u8>]| {
        [&(entries.len() as u16).to_le_bytes()[..], &entries.concat(), &[0; 4]].concat()
    };
    let first = [entry(0x8769, 4, 34)];
    let tiff = [
        b"II*\0\x10\0\0\0".as_slice(),
        &rational[0].to_le_bytes(),
        &rational[1].to_le_bytes(),
        &directory(&first),
        &directory(entries),
    ]
    .concat();
    let mut segment = vec![0xFF, 0xE1];
    segment.extend_from_slice(&((tiff.len() + 8) as u16).to_be_bytes());
    segment.extend_from_slice(b"Exif\0\0");
    segment.extend_from_slice(&tiff);
    [&plain[..2], &segment, &plain[2..]].concat()
}

/// The 35 mm equivalent of the scene's 1150 px at 960x720 is 41.5 mm.
const EQUIVALENT: (u16, u16, u32) = (0xA405, 3, 41);

fn tagged(scene: &Scene, tags: &[(u16, u16, u32)]) -> Vec<u8> {
    let entries: Vec<Vec<u8>> = tags.iter().map(|(tag, kind, value)| entry(*tag, *kind, *value)).collect();
    jpeg(scene, &entries, [2, 1])
}

#[test]
fn exif_makes_a_weak_view_usable() {
    let scene = Scene { tilt_deg: [1.0, -2.0], ..Scene::default() };
    let bench = bench();
    bench.put("photo.jpg", tagged(&scene, &[(0xA002, 4, 960), (0xA003, 4, 720), EQUIVALENT]));
    let line = "calibrate photo.jpg --size A2-landscape -o rig.json";
    bench.run(line).fails(5, &["face-on"]);
    let run = bench.run(&format!("{line} --exif")).ok();
    assert!(run.stderr.contains("41 mm") && run.stderr.contains("5.0 %"), "{}", run.stderr);
    let rig = json(&bench.text("rig.json"));
    assert_eq!(rig["quality"]["verdict"], "fair");
    let f = rig["camera"]["K"][0][0].as_f64().unwrap();
    let sigma = rig["camera"]["sigma"]["focal_px"].as_f64().unwrap();
    assert!((f - 1150.0).abs() < 2.0 * sigma && sigma < 0.052 * f, "{f} ± {sigma}");
}

#[test]
fn exif_that_cannot_be_relied_on_is_refused() {
    let scene = Scene::default();
    let bench = bench();
    let line = "calibrate photo.jpg --size A2-landscape --json --exif";
    let refused = |tags: &[(u16, u16, u32)], words: &[&str]| {
        bench.put("photo.jpg", tagged(&scene, tags));
        bench.run(line).fails(3, &[&["photo.jpg", "--exif"], words].concat());
    };
    refused(&[], &["no focal length"]);
    refused(&[(0xA405, 3, 0)], &["no focal length"]);
    refused(&[(0x920A, 5, 8)], &["only the actual focal length, 2.00 mm"]);
    refused(&[(0xA404, 5, 8), EQUIVALENT], &["digital zoom of 2.00"]);
    refused(&[(0xA002, 4, 960), (0xA003, 4, 540), EQUIVALENT], &["960x720", "960x540"]);
    refused(&[(0xA405, 3, 65535)], &["65535 mm"]);
    DynamicImage::ImageRgb8(scene.photograph(None))
        .save_with_format(bench.path("photo.jpg"), ImageFormat::Png)
        .unwrap();
    bench.run(line).fails(3, &["photo.jpg", "no readable tags"]);
    // A turned photograph has the sides of its tags exchanged.
    bench.put("photo.jpg", tagged(&scene, &[(0xA002, 4, 720), (0xA003, 4, 960), EQUIVALENT]));
    let _ = bench.run(line).ok();
    bench.put("other.jpg", tagged(&scene, &[(0xA405, 3, 50)]));
    bench
        .run(&line.replace("photo.jpg", "photo.jpg other.jpg"))
        .fails(3, &["other.jpg", "photo.jpg", "41 mm", "50 mm"]);
    bench.run(&format!("{line} --camera rig.json")).fails(2, &["--exif"]);
    bench.run(&format!("{line} --method two-vp")).fails(2, &["two-vp", "--exif"]);
}
