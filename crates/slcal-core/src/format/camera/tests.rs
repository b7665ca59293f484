use super::*;
use crate::geometry::Intrinsics;

/// As `cv2.FileStorage` of OpenCV 4 writes it (5 begins with `%YAML 1.2`).
const OPENCV: &str = "%YAML:1.0
---
calibration_time: \"Sun 22 Nov\"
image_width: 960
image_height: 720
flags: 0
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 1150.25, 0., 479.5, 0., 1148.5, 359.25, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ -0.12, 0.029999999999999999, 0.001, -0.00050000000000000001,
       0.002 ]
avg_reprojection_error: 0.20000000000000001
";

const OPENCV_XML: &str = "<?xml version=\"1.0\"?>
<opencv_storage>
<calibration_time>\"Sun 22 Nov\"</calibration_time>
<imageSize>
  960 720</imageSize>
<cameraMatrix type_id=\"opencv-matrix\">
  <rows>3</rows>
  <cols>3</cols>
  <dt>d</dt>
  <data>
    1150.25 0. 479.5 0. 1148.5 359.25 0. 0. 1.</data></cameraMatrix>
<dist_coeffs type_id=\"opencv-matrix\">
  <rows>1</rows>
  <cols>5</cols>
  <dt>d</dt>
  <data>
    -0.12 0.029999999999999999 0.001 -0.00050000000000000001 0.002</data></dist_coeffs>
</opencv_storage>
";

/// As ROS `camera_calibration_parsers` writes it.
const ROS: &str = "image_width: 960
image_height: 720
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [1150.25, 0, 479.5, 0, 1148.5, 359.25, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.12, 0.03, 0.001, -0.0005, 0.002]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
projection_matrix:
  rows: 3
  cols: 4
  data: [1100, 0, 480, 0, 0, 1100, 360, 0, 0, 0, 1, 0]
";

fn read(text: &str) -> Result<KnownCamera> {
    read_camera(text.as_bytes())
}

fn refused(text: &str, words: &[&str]) {
    let error = read(text).unwrap_err();
    assert!(matches!(error, Error::Malformed { .. }), "{error:?}");
    for word in words {
        assert!(error.to_string().contains(word), "no {word:?} in: {error}");
    }
}

#[test]
fn every_kind_of_file_gives_the_same_camera() {
    let json = r#"{"cameraMatrix": {"type_id": "opencv-matrix", "rows": 3, "cols": 3, "dt": "d",
        "data": [1150.25, 0.0, 479.5, 0.0, 1148.5, 359.25, 0.0, 0.0, 1.0]}, "image_size": [960, 720],
        "D": [[-0.12], [0.03], [0.001], [-0.0005], [0.002]]}"#;
    let message = "height: 720\nwidth: 960\ndistortion_model: 'plumb_bob'\nD: [-0.12, 0.03, 0.001, -0.0005, 0.002]\n\
                   K: [1150.25, 0.0, 479.5, 0.0, 1148.5, 359.25, 0.0, 0.0, 1.0]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n---\nheight: 1\n";
    let rig = r#"{"schema": "slcal-rig/1", "units": "mm", "pixel_centre": "integer", "projector": null,
        "projector_from_camera": null, "camera": {"width": 960, "height": 720, "distortion": [-0.12, 0.03, 0.001, -0.0005, 0.002],
        "K": [[1150.25, 0, 479.5], [0, 1148.5, 359.25], [0, 0, 1]]}}"#;
    let newer = OPENCV.replace("%YAML:1.0", "%YAML 1.2");
    for text in [OPENCV, &newer, &format!("\u{feff}{OPENCV}"), OPENCV_XML, ROS, json, message, rig] {
        let camera = read(text).unwrap_or_else(|e| panic!("{e} in {text}"));
        let k = camera.intrinsics;
        assert_eq!((k.fx, k.fy, k.skew, k.cx, k.cy), (1150.25, 1148.5, 0.0, 479.5, 359.25));
        assert_eq!(camera.distortion.to_array(), [-0.12, 0.03, 0.001, -0.0005, 0.002]);
        assert_eq!(camera.size, Some([960, 720]));
        assert!(camera.notes.is_empty());
        assert!(camera.for_image([960, 720]).is_ok());
    }
}

#[test]
fn what_a_file_does_not_say_is_told() {
    let pair = "M1: [800, 0, 320, 0, 800, 240, 0, 0, 1]\nM2: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n";
    let camera = read(pair).unwrap();
    assert_eq!((camera.size, camera.intrinsics.fx), (None, 800.0));
    assert!(
        camera.notes.iter().any(|n| n.contains("two cameras"))
            && camera.notes.iter().any(|n| n.contains("distortion"))
    );
    assert_eq!(camera.for_image([640, 480]).unwrap().width, 640);
}

#[test]
fn lens_models_beyond_five_coefficients_are_refused_unless_they_are_zero() {
    let with = |coefficients: &str, model: &str| {
        ROS.replace("-0.12, 0.03, 0.001, -0.0005, 0.002", coefficients)
            .replace("cols: 5", &format!("cols: {}", coefficients.split(',').count()))
            .replace("plumb_bob", model)
    };
    for (coefficients, count) in
        [("0.1, 0, 0, 0", 4), ("0.1, 0, 0, 0, 0, 0, 0, 0", 8), ("0.1,0,0,0,0,0,0,0,0,0,0,0,0,0", 14)]
    {
        let camera =
            read(&with(coefficients, "rational_polynomial")).unwrap_or_else(|e| panic!("{count}: {e}"));
        assert_eq!(camera.distortion.to_array(), [0.1, 0.0, 0.0, 0.0, 0.0]);
    }
    refused(
        &with("0.1, 0, 0, 0, 0, 0.5, 0, 0", "rational_polynomial"),
        &["coefficient 6", "0.5", "rational"],
    );
    refused(&with("0.1, 0, 0", "plumb_bob"), &["4, 5, 8, 12 or 14", "found 3"]);
    refused(&with("0.1, 0, 0, 0", "equidistant"), &["plumb_bob", "equidistant"]);
    assert!(read(&with("0, 0, 0, 0", "equidistant")).is_ok());
    refused(&OPENCV.replace("flags: 0", "fisheye_model: 1"), &["fisheye"]);
}

#[test]
fn files_without_a_camera_name_what_is_missing() {
    refused("", &["nothing"]);
    refused("just words", &["named values"]);
    refused("pinhole:\n  fx: 700\nmodel: pinhole\n", &["camera matrix", "pinhole, model"]);
    refused(&OPENCV.replace("479.5", ".Nan"), &["camera_matrix", "finite", ".Nan"]);
    refused(&OPENCV.replace("1150.25", "-1150.25"), &["camera_matrix", "positive"]);
    refused(&OPENCV.replace("1150.25", "1e999"), &["camera_matrix", "1e999"]);
    refused(&OPENCV.replace("cols: 3", "cols: 4"), &["camera_matrix", "3x4", "found 9"]);
    refused(&OPENCV.replace("rows: 3", "rows: 99999999999999999999"), &["camera_matrix", "rows"]);
    refused(&OPENCV.replace("image_width: 960", "image_width: -3"), &["image_width", "-3"]);
    refused(&OPENCV.replace("image_width: 960", "image_width: [1, 2]"), &["image_width"]);
    refused(&ROS.replace("0, 479.5", "479.5"), &["camera_matrix", "found 8"]);
    refused("<html></html>", &["an HTML page, where a camera is expected"]);
    refused("<opencv_storage><a></opencv_storage>", &["XML"]);
    refused(
        "{\"schema\": \"slcal-pattern/1\"}",
        &["a pattern (slcal-pattern/1), where a camera is expected"],
    );
    refused("{]", &["JSON"]);
    refused("a: [1, 2", &["YAML"]);
    assert!(
        read_camera(&[0xFF_u8, 0xD8, 0xFF, 0xE0][..]).unwrap_err().to_string().contains("a JPEG picture")
    );
}

#[test]
fn texts_made_to_exhaust_are_refused() {
    let bomb = "a: &a [x, x, x, x, x]\nb: &b [*a, *a, *a, *a, *a]\nc: &c [*b, *b, *b, *b, *b]\n";
    refused(bomb, &["alias"]);
    refused(&"[".repeat(200_000), &["camera file"]);
    refused(&"- ".repeat(2000), &["levels"]);
    refused(&"a: {".repeat(2000), &["camera file"]);
    let deep = format!("<opencv_storage>{}{}</opencv_storage>", "<a>".repeat(4000), "</a>".repeat(4000));
    refused(&deep, &["levels"]);
    refused("<!DOCTYPE x [<!ENTITY a \"b\">]><opencv_storage>&a;</opencv_storage>", &["XML"]);
}

#[test]
fn another_resolution_is_refused_with_what_the_intrinsics_would_be() {
    let camera = read(OPENCV).unwrap();
    let half = camera.for_image([480, 360]).unwrap_err().to_string();
    for word in ["480x360", "960x720", "575.1", "239.50", "179.38"] {
        assert!(half.contains(word), "no {word} in {half}");
    }
    assert!(camera.for_image([960, 540]).unwrap_err().to_string().contains("shape"));
    let unsized_camera = KnownCamera { size: None, ..camera.clone() };
    let tiny = KnownCamera { intrinsics: Intrinsics { fx: 4.2, ..camera.intrinsics }, ..camera.clone() };
    assert!(tiny.for_image([960, 720]).unwrap_err().to_string().contains("4.2"));
    assert!(unsized_camera.for_image([100, 50]).unwrap_err().to_string().contains("principal point"));
}
