//! Every format against numbers that were worked out by hand, and there and back again.

use nalgebra::{DMatrix, Matrix3, Point2, Point3, Rotation3, Vector3};

use super::*;
use crate::geometry::{Camera, Distortion, Pose, RectangleSize, SheetBend};
use crate::rig::{
    Covariance, Device, DeviceSigma, Projector, Quality, StereoPose, Verdict, View, ViewBend, ViewRms,
    Warning,
};

const PHOTO: &str = "it's a \"photo\"\n<né> & 日本 😀 \\ '''.jpg";

fn device(size: [u32; 2], k: [f64; 5], distortion: [f64; 5]) -> Device {
    let [fx, fy, skew, cx, cy] = k;
    let intrinsics = Intrinsics { fx, fy, skew, cx, cy };
    let model = Camera {
        width: size[0],
        height: size[1],
        intrinsics,
        distortion: Distortion::from_array(distortion),
    };
    let sigma = Some(DeviceSigma {
        focal_px: 1.5,
        cx_px: 1.0 / 3.0,
        cy_px: 1e-7,
        distortion: [1e-6; 5],
        aspect: 0.002,
    });
    Device { model, sigma }
}

/// A quarter turn about x, so that every number of the poses is known: the projector's y is the camera's −z.
fn quarter() -> Pose {
    let rotation = Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0);
    Pose {
        rotation: Rotation3::from_matrix_unchecked(rotation),
        translation: Vector3::new(100.0, -200.0, 50.0),
    }
}

/// Lens shift, unequal focal lengths, and all else that a rig may know.
fn rig(distortion: [f64; 5], skew: f64) -> Rig {
    let camera = device([640, 480], [800.0, 1000.0, skew, 319.5, 199.5], distortion);
    let projector = device([1000, 500], [2000.0, 1600.0, 0.0, 499.5, 699.5], distortion);
    let size = RectangleSize::new(200.0, 100.0).unwrap();
    let pose = Pose {
        rotation: Rotation3::from_euler_angles(0.3, -0.2, 0.1),
        translation: Vector3::new(-80.0, -40.0, 1000.0 / 3.0),
    };
    let seen = |c: Point2<f64>| camera.model.project(&pose.transform(&Point3::new(c.x, c.y, 0.0))).unwrap();
    let view = View {
        photo: Some(PHOTO.into()),
        size,
        camera_from_sheet: pose,
        bend: Some(ViewBend {
            shape: SheetBend(std::array::from_fn(|k| 0.5 - 0.125 * k as f64)),
            sigma_mm: [0.25; 12],
            expected_mm: [1.5; 12],
        }),
        projector_from_sheet: Some(quarter().compose(&pose)),
        camera_vanishing_points: camera.model.vanishing_points(&pose),
        projector_vanishing_points: Some(projector.model.vanishing_points(&quarter().compose(&pose))),
        corners_px: size.corners().map(seen),
        rms_px: Some(ViewRms { edges: 0.1, corners: None, projector: Some(0.3) }),
        clipped_percent: None,
    };
    Rig {
        camera,
        projector: Some(Projector {
            device: projector,
            from_camera: StereoPose { pose: quarter(), sigma_t_mm: Some([0.1, 0.2, 0.3]), sigma_r_rad: None },
            mirrored: false,
        }),
        views: vec![view.clone(), View { photo: None, rms_px: None, bend: None, ..view }],
        method: "ml".into(),
        quality: Some(Quality {
            verdict: Verdict::Fair,
            focal_sigma_percent_camera: 5.0,
            focal_sigma_percent_projector: None,
            depth_sigma_percent: Some(0.4),
            expected_point_sigma_mm: Some(0.3),
            cause: "12.5".into(),
            advice: String::new(),
            warnings: vec![Warning { code: "a".into(), message: "1 < 2 & \"3\"".into(), advice: "5".into() }],
            assumptions: Vec::new(),
        }),
        covariance: Some(Covariance {
            parameters: vec!["camera.focal_px".into(), "camera.cx_px".into()],
            matrix: DMatrix::from_row_slice(2, 2, &[1.0, 1.0 / 3.0, 1.0 / 3.0, 2.0]),
        }),
        channel_registration: None,
    }
}

const LENS: [f64; 5] = [-0.1, 0.02, 1e-3, -5e-4, 0.0];
const LENS_WITH_K3: [f64; 5] = [-0.1, 0.02, 1e-3, -5e-4, 0.01];
const NO_LENS: [f64; 5] = [0.0; 5];

fn exported(rig: &Rig, format: ExchangeFormat) -> Export {
    export_rig(rig, format, &ExportConfig::default()).unwrap()
}

fn text(file: &ExportedFile) -> &str {
    std::str::from_utf8(&file.bytes).unwrap()
}

fn back(export: &Export, format: Option<ExchangeFormat>) -> Result<Imported> {
    let files: Vec<_> = export.files.iter().map(|f| NamedBytes { name: f.name, bytes: &f.bytes }).collect();
    import_rig(format, &files, &ImportConfig::default())
}

fn has(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "no {part:?} in\n{text}");
    }
}

#[test]
fn formats_that_hold_everything_lose_nothing() {
    for rig in
        [rig(LENS_WITH_K3, 0.75), Rig { views: vec![], quality: None, covariance: None, ..rig(NO_LENS, 0.0) }]
    {
        for storage in [StorageText::Yaml, StorageText::Xml, StorageText::Json] {
            let export =
                export_rig(&rig, ExchangeFormat::OpenCv, &ExportConfig { storage, lossy: false }).unwrap();
            let read = back(&export, None).unwrap();
            assert_eq!((read.format, read.rig), (ExchangeFormat::OpenCv, rig.clone()), "{storage:?}");
        }
        let export = exported(&rig, ExchangeFormat::Npz);
        let read = back(&export, None).unwrap();
        assert_eq!((read.format, read.rig), (ExchangeFormat::Npz, rig.clone()));
        assert!(export.left_out.is_empty(), "{:?}", export.left_out);
    }
    let plain = rig(NO_LENS, 0.0);
    let read = back(&exported(&plain, ExchangeFormat::Blender), None).unwrap();
    assert_eq!((read.format, read.rig), (ExchangeFormat::Blender, plain));
}

#[test]
fn empty_lists_are_read_as_nothing() {
    let mut rig = rig(NO_LENS, 0.0);
    if let Some(quality) = &mut rig.quality {
        quality.warnings.clear();
    }
    rig.views[1].photo = Some(String::new());
    rig.covariance = Some(Covariance { parameters: vec![], matrix: DMatrix::zeros(0, 0) });
    let expected = Rig { covariance: None, ..rig.clone() };
    for storage in [StorageText::Yaml, StorageText::Xml, StorageText::Json] {
        let export =
            export_rig(&rig, ExchangeFormat::OpenCv, &ExportConfig { storage, lossy: false }).unwrap();
        assert_eq!(back(&export, None).unwrap().rig, expected, "{storage:?}");
    }
    // An array of words has no place for the difference between no name and an empty one.
    let mut unnamed = expected;
    unnamed.views[1].photo = None;
    assert_eq!(back(&exported(&rig, ExchangeFormat::Npz), None).unwrap().rig, unnamed);
}

#[test]
fn every_format_gives_the_devices_back() {
    for (format, lens) in [
        (ExchangeFormat::OpenCv, LENS_WITH_K3),
        (ExchangeFormat::Ros, LENS_WITH_K3),
        (ExchangeFormat::Colmap, LENS_WITH_K3),
        (ExchangeFormat::Colmap, LENS),
        (ExchangeFormat::Colmap, NO_LENS),
        (ExchangeFormat::Kalibr, LENS),
        (ExchangeFormat::Blender, NO_LENS),
        (ExchangeFormat::Npz, LENS_WITH_K3),
    ] {
        let rig = rig(lens, 0.0);
        let read = back(&exported(&rig, format), None).unwrap();
        assert_eq!(read.format, format);
        assert_eq!(read.rig.camera.model, rig.camera.model, "{format:?}");
        assert_eq!(
            read.rig.projector.unwrap().device.model,
            rig.projector.unwrap().device.model,
            "{format:?}"
        );
        let (found, pose) = (read.rig.projector.unwrap().from_camera.pose, quarter());
        assert!((found.rotation.matrix() - pose.rotation.matrix()).amax() < 1e-15, "{format:?}");
        assert!((found.translation - pose.translation).amax() < 1e-13, "{format:?}");
        let alone = Rig { projector: None, ..rig };
        let export = exported(&alone, format);
        assert!(export.files.len() == if format == ExchangeFormat::Colmap { 3 } else { 1 });
        let read = back(&export, Some(format)).unwrap();
        assert_eq!(read.rig.camera.model, alone.camera.model, "{format:?}");
        assert!(read.rig.projector.is_none());
    }
}

#[test]
fn opencv_has_the_names_of_its_programs() {
    let export = exported(&rig(LENS, 0.0), ExchangeFormat::OpenCv);
    has(
        text(&export.files[0]),
        &[
            "%YAML:1.0\n---\n",
            "image_width: 640\nimage_height: 480\n",
            "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 800.0, 0.0, 319.5, 0.0, 1000.0, 199.5, 0.0, 0.0, 1.0 ]\n",
            "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [ -0.1, 0.02, 0.001, -0.0005, 0.0 ]\n",
            "\ncam_K: ",
            "\ncam_kc: ",
            "\nproj_kc: ",
            "proj_K: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 2000.0, 0.0, 499.5, 0.0, 1600.0, 699.5, 0.0, 0.0, 1.0 ]\n",
            "T: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ 100.0, -200.0, 50.0 ]\n",
        ],
    );
    let skewed = exported(&rig(LENS, 0.5), ExchangeFormat::OpenCv);
    has(&skewed.left_out[0], &["skew", "0.5", "cv2.projectPoints"]);
}

#[test]
fn words_that_filestorage_cannot_hold_are_mended_and_told() {
    let mut rig = rig(NO_LENS, 0.0);
    rig.views[0].photo = Some(format!("a\u{1}b\u{2028}{}", "x".repeat(5000)));
    for storage in [StorageText::Yaml, StorageText::Xml, StorageText::Json] {
        let export =
            export_rig(&rig, ExchangeFormat::OpenCv, &ExportConfig { storage, lossy: false }).unwrap();
        has(&export.left_out[0], &["control characters"]);
        let photo = back(&export, None).unwrap().rig.views[0].photo.clone().unwrap();
        assert!(photo.starts_with("a\u{fffd}b\u{fffd}xx") && photo.len() < 4100, "{storage:?}: {photo}");
    }
}

#[test]
fn ros_has_a_file_per_device() {
    let export = exported(&rig(LENS_WITH_K3, 0.0), ExchangeFormat::Ros);
    assert_eq!(export.files.iter().map(|f| f.name).collect::<Vec<_>>(), ["camera.yaml", "projector.yaml"]);
    has(
        text(&export.files[1]),
        &[
            "image_width: 1000\nimage_height: 500\ncamera_name: projector\n",
            "distortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [-0.1, 0.02, 0.001, -0.0005, 0.01]\n",
            "projection_matrix:\n  rows: 3\n  cols: 4\n  data: [2000.0, 0.0, 499.5, 0.0, 0.0, 1600.0, 699.5, 0.0, 0.0, 0.0, 1.0, 0.0]\n",
            // The projector stands at −Rᵀt = −(100, 50, 200) mm, and is turned back by a quarter about x.
            "--x -0.1 --y -0.05 --z -0.2 --qx -0.7071067811865",
            "  translation_mm: [100.0, -200.0, 50.0]\n",
        ],
    );
    has(&export.left_out[0], &["ros has no place for", "σ", "covariance", "poses of the sheet"]);
    // In whatever order, and the camera alone from its own file.
    let [camera, projector] = &export.files[..] else { panic!() };
    let named = |f: &'_ ExportedFile| (f.name, f.bytes.clone());
    let (c, p) = (named(camera), named(projector));
    let files = [NamedBytes { name: p.0, bytes: &p.1 }, NamedBytes { name: c.0, bytes: &c.1 }];
    let read = import_rig(None, &files, &ImportConfig::default()).unwrap();
    assert_eq!(read.rig.camera.model.width, 640);
    let twice = [files[1], files[1]];
    let error = import_rig(None, &twice, &ImportConfig::default()).unwrap_err().to_string();
    has(&error, &["projector_from_camera", "camera_info itself does not say"]);
}

#[test]
fn colmap_counts_from_the_corner_of_the_first_pixel() {
    let rig = rig(LENS, 0.0);
    let export = exported(&rig, ExchangeFormat::Colmap);
    has(
        text(&export.files[0]),
        &[
            "\n1 OPENCV 640 480 800.0 1000.0 320.0 200.0 -0.1 0.02 0.001 -0.0005\n",
            "\n2 OPENCV 1000 500 2000.0 1600.0 500.0 700.0 -0.1",
        ],
    );
    has(
        text(&export.files[1]),
        &[
            "\n1 1.0 0.0 0.0 0.0 0.0 0.0 0.0 1 camera.png\n",
            "\n2 0.7071067811865",
            " 100.0 -200.0 50.0 2 projector.png\n\n",
        ],
    );
    has(
        text(&exported(&self::rig(LENS_WITH_K3, 0.0), ExchangeFormat::Colmap).files[0]),
        &["1 FULL_OPENCV", "0.01 0.0 0.0 0.0\n"],
    );
    has(
        text(&exported(&self::rig(NO_LENS, 0.0), ExchangeFormat::Colmap).files[0]),
        &["1 PINHOLE 640 480 800.0 1000.0 320.0 200.0\n"],
    );
    let read = back(&export, None).unwrap().rig;
    assert_eq!(read.views.len(), 2);
    let (found, view) = (&read.views[1], &rig.views[1]);
    assert!((found.size.width_mm - 200.0).abs() + (found.size.height_mm - 100.0).abs() < 1e-10);
    assert!(found.camera_from_sheet.rotation_vector_from(&view.camera_from_sheet).norm() < 1e-13);
    assert!((found.camera_from_sheet.translation - view.camera_from_sheet.translation).norm() < 1e-10);
    assert!((found.corners_px[2] - view.corners_px[2]).norm() < 1e-10);
}

#[test]
fn colmap_models_of_other_programs() {
    let import = |cameras: &str, images: &str| {
        let files = [
            NamedBytes { name: "cameras.txt", bytes: cameras.as_bytes() },
            NamedBytes { name: "images.txt", bytes: images.as_bytes() },
        ];
        import_rig(None, &files, &ImportConfig::default())
    };
    let images = "# IMAGE_ID\n7 0.5 0 0 0 1 2 3 5 a b.jpg\n\n8 1 0 0 0 0 2 3 4 c.jpg\n1.5 2.5 -1\n";
    let read =
        import("5 SIMPLE_RADIAL 640 480 800 320 240 0.1\n4 SIMPLE_PINHOLE 64 48 80 32 24", images).unwrap();
    assert_eq!(read.rig.camera.model.intrinsics.cx, 31.5);
    assert_eq!(read.rig.projector.unwrap().device.model.distortion.k1, 0.1);
    assert_eq!(read.rig.projector.unwrap().from_camera.pose.translation, Vector3::new(1.0, 0.0, 0.0));
    assert_eq!(read.notes.len(), 2);
    assert!(import("1 RADIAL 640 480 800 320 240 0.1 0.2", "").is_ok(), "a camera alone needs no image");
    for (cameras, images, words) in [
        ("1 OPENCV_FISHEYE 640 480 1 1 1 1 0 0 0 0", "", "OPENCV_FISHEYE"),
        ("1 PINHOLE 640 480 1 1 1", "", "PINHOLE"),
        ("1 PINHOLE 640 480 -1 1 1 1", "", "positive"),
        ("1 PINHOLE 640 480 1 nan 1 1", "", "finite"),
        ("1 PINHOLE 0 480 1 1 1 1", "", "above zero"),
        ("1 PINHOLE 640", "", "nothing"),
        ("", "", "found 0"),
        ("1 FULL_OPENCV 640 480 1 1 1 1 0 0 0 0 0 1 0 0", "", "rational"),
        ("1 PINHOLE 9 9 1 1 1 1\n2 PINHOLE 9 9 1 1 1 1", "", "one image of camera"),
        ("1 PINHOLE 9 9 1 1 1 1\n2 PINHOLE 9 9 1 1 1 1", "1 1 0 0 0 0 0", "ten values"),
        ("1 PINHOLE 9 9 1 1 1 1\n2 PINHOLE 9 9 1 1 1 1", "1 0 0 0 0 0 0 0 1 a\n\n", "quaternion"),
        ("1 PINHOLE 9 9 1 1 1 1\n2 PINHOLE 9 9 1 1 1 1\n3 PINHOLE 9 9 1 1 1 1", "", "found 3"),
    ] {
        let error = import(cameras, images).unwrap_err();
        assert!(matches!(error, Error::Malformed { .. }), "{error:?}");
        has(&error.to_string(), &[words]);
    }
}

#[test]
fn kalibr_is_in_metres() {
    let export = exported(&rig(LENS, 0.0), ExchangeFormat::Kalibr);
    has(
        text(&export.files[0]),
        &[
            "cam0:\n  camera_model: pinhole\n  intrinsics: [800.0, 1000.0, 319.5, 199.5]\n  distortion_model: radtan\n  \
             distortion_coeffs: [-0.1, 0.02, 0.001, -0.0005]\n  resolution: [640, 480]\n",
            "  T_cn_cnm1:\n  - [1.0, 0.0, 0.0, 0.1]\n  - [0.0, 0.0, -1.0, -0.2]\n  - [0.0, 1.0, 0.0, 0.05]\n  - [0.0, 0.0, 0.0, 1.0]\n",
        ],
    );
    let chain = text(&export.files[0]).to_owned();
    let import = |from: &str, to: &str| {
        let changed = chain.replacen(from, to, 1);
        assert_ne!(changed, chain);
        let files = [NamedBytes { name: "c.yaml", bytes: changed.as_bytes() }];
        import_rig(Some(ExchangeFormat::Kalibr), &files, &ImportConfig::default())
    };
    assert!(
        import("radtan\n  distortion_coeffs: [-0.1, 0.02, 0.001, -0.0005]", "none\n  distortion_coeffs: []")
            .is_ok()
    );
    for (from, to, words) in [
        ("pinhole", "omni", "omni"),
        ("radtan", "equidistant", "equidistant"),
        ("800.0, ", "", "4 numbers"),
        ("[640, 480]", "[640, 0]", "resolution"),
        ("[0.0, 1.0, 0.0, 0.05]", "[0.0, 2.0, 0.0, 0.05]", "rotation"),
        ("[0.0, 0.0, 0.0, 1.0]", "[0.0, 0.0, 1.0, 1.0]", "last row"),
        ("T_cn_cnm1", "T_cam_imu", "T_cn_cnm1"),
        ("cam0:", "cam7:", "cam0"),
        ("0.0005", ".nan", "finite"),
    ] {
        let error = import(from, to).unwrap_err();
        assert!(matches!(error, Error::Malformed { .. }), "{error:?}");
        has(&error.to_string(), &[words]);
    }
}

#[test]
fn blender_has_shift_and_pixel_aspect() {
    let export = exported(&rig(NO_LENS, 0.0), ExchangeFormat::Blender);
    let script = text(&export.files[0]);
    has(
        script,
        &[
            // 800/640 · 36; the centre of the image in x; 200 − 240 = −40 rows of a pixel 0.8 wide, which Blender stretches in x.
            "\"sensor_width\": 36.0,\n    \"lens\": 45.0,\n    \"shift_x\": 0.0,\n    \"shift_y\": -0.05,\n    \
             \"pixel_aspect_x\": 1.25,\n    \"pixel_aspect_y\": 1.0,\n",
            // 2000/1000 · 36; (700 − 250)/1000 · 2000/1600.
            "\"lens\": 72.0,\n    \"shift_x\": 0.0,\n    \"shift_y\": 0.5625,\n    \"pixel_aspect_x\": 1.0,\n    \"pixel_aspect_y\": 1.25,\n",
            // x right, y up and −z forward of Blender's camera are x, z and y of its world.
            "\"matrix_world\": [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]",
            // The projector stands at (−100, −50, −200) mm of the camera's frame: (−0.1, −0.2, 0.05) m, looks along camera y = world −z,
            // and its down is camera −z = world −y, so that its up is +y.
            "\"matrix_world\": [[1.0, 0.0, 0.0, -0.1], [0.0, 1.0, 0.0, -0.2], [0.0, 0.0, 1.0, 0.05], [0.0, 0.0, 0.0, 1.0]]",
        ],
    );
    assert!(script.is_ascii(), "the script must not depend on an encoding");
    // Nothing in a name can end the literal that it stands in.
    assert_eq!(script.matches("'''").count(), 2);
    for (size, fx) in [([3, 480], 800.0), ([640, 480], 1e30), ([640, 480], 1e-30), ([70_000, 480], 800.0)] {
        let mut rig = rig(NO_LENS, 0.0);
        rig.camera = device(size, [fx, 800.0, 0.0, 1.0, 1.0], NO_LENS);
        let error = export_rig(&rig, ExchangeFormat::Blender, &ExportConfig::default()).unwrap_err();
        has(&error.to_string(), &["camera:", "Blender"]);
    }
}

#[test]
fn what_a_format_cannot_hold_is_refused_or_told() {
    for (format, lens, skew, word) in [
        (ExchangeFormat::Ros, LENS, 0.5, "skew = 0.5 px"),
        (ExchangeFormat::Colmap, LENS, 0.5, "skew"),
        (ExchangeFormat::Kalibr, LENS_WITH_K3, 0.0, "k3 = 0.01"),
        (ExchangeFormat::Kalibr, NO_LENS, 0.5, "skew"),
        (ExchangeFormat::Blender, LENS, 0.0, "k1 = -0.1, k2 = 0.02"),
        (ExchangeFormat::Blender, NO_LENS, 0.5, "skew"),
    ] {
        let rig = rig(lens, skew);
        let error = export_rig(&rig, format, &ExportConfig::default()).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{error:?}");
        has(&error.to_string(), &[format.name(), word, "pixels move by up to", " px", "opencv and npz"]);
        let lossy =
            export_rig(&rig, format, &ExportConfig { lossy: true, ..ExportConfig::default() }).unwrap();
        assert!(
            lossy.left_out.iter().any(|n| n.contains(word) && n.contains("pixels move")),
            "{:?}",
            lossy.left_out
        );
        assert!(back(&lossy, None).is_ok());
    }
}

#[test]
fn rigs_that_no_file_should_hold_are_refused() {
    for format in ExchangeFormat::ALL {
        let refused = |rig: &Rig| export_rig(rig, format, &ExportConfig::default()).unwrap_err();
        let mut broken = rig(NO_LENS, 0.0);
        broken.camera.model.intrinsics.fx = f64::NAN;
        assert!(matches!(refused(&broken), Error::Invalid { .. }));
        let mut broken = rig(NO_LENS, 0.0);
        broken.camera.model.intrinsics.fy = -1.0;
        assert!(matches!(refused(&broken), Error::Invalid { .. }));
        let mut huge = rig(NO_LENS, 0.0);
        huge.camera.model.intrinsics = Intrinsics { fx: 1e300, fy: 1e300, skew: 0.0, cx: -1e300, cy: -4.5 };
        if format != ExchangeFormat::Blender {
            let read = back(&exported(&huge, format), None).unwrap();
            assert_eq!(read.rig.camera.model, huge.camera.model, "{format:?}");
        }
    }
}

#[test]
fn every_part_of_a_file_is_refused_or_read_without_panic() {
    for format in ExchangeFormat::ALL {
        let export = exported(&rig(NO_LENS, 0.0), format);
        for part in 0..export.files.len() {
            let bytes = &export.files[part].bytes;
            for i in 0..60 {
                let mut cut = export.clone();
                cut.files[part].bytes = bytes[..bytes.len() * i / 60].to_vec();
                for format in [Some(format), None] {
                    if let Ok(read) = back(&cut, format) {
                        assert!(write_back(&read.rig), "{format:?}");
                    }
                }
                // A byte that says something else.
                let mut other = export.clone();
                other.files[part].bytes[bytes.len() * i / 60] = b"0-[\x00\xff "[i % 6];
                if let Ok(read) = back(&other, Some(format)) {
                    assert!(write_back(&read.rig), "{format:?}");
                }
            }
        }
    }
}

fn write_back(rig: &Rig) -> bool {
    crate::format::write_rig(rig, std::io::sink()).is_ok()
}

#[test]
fn files_of_other_programs() {
    let import = |text: &str, config: &ImportConfig| {
        import_rig(None, &[NamedBytes { name: "a", bytes: text.as_bytes() }], config)
    };
    let config = ImportConfig { camera_size: Some([1600, 1200]), projector_size: Some([1024, 768]) };
    // As projector-camera tools write it: no sizes.
    let pair = "%YAML:1.0\ncam_K: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 1600., 0., 800., 0., 1600., 600., 0., 0., 1. ]\n\
                cam_kc: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   data: [ 0.1, 0., 0., 0., 0. ]\n\
                proj_K: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 2000., 0., 512., 0., 2000., 900., 0., 0., 1. ]\n\
                proj_kc: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   data: [ 0., 0., 0., 0., 0. ]\n\
                R: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 1., 0., 0., 0., 1., 0., 0., 0., 1. ]\n\
                T: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ 100., 2., 3. ]\nstereo_error: 0.25\n";
    let read = import(pair, &config).unwrap();
    assert_eq!(read.rig.camera.model.distortion.k1, 0.1);
    assert_eq!(read.rig.projector.unwrap().device.model.intrinsics.cy, 900.0);
    assert_eq!(read.rig.projector.unwrap().from_camera.pose.translation, Vector3::new(100.0, 2.0, 3.0));
    has(&read.notes.join("; "), &["T is taken to be in mm"]);
    let error = import(pair, &ImportConfig::default()).unwrap_err();
    has(&error.to_string(), &["size of the camera's image"]);
    let half = ImportConfig { camera_size: Some([1600, 1200]), projector_size: None };
    has(&import(pair, &half).unwrap_err().to_string(), &["size of the projector's image"]);
    let rvec = pair.replace(
        "rows: 3\n   cols: 3\n   dt: d\n   data: [ 1., 0., 0., 0., 1., 0., 0., 0., 1. ]",
        "rows: 3\n   cols: 1\n   dt: d\n   data: [ 1.5707963267948966, 0., 0. ]",
    );
    let turned = import(&rvec, &config).unwrap().rig.projector.unwrap().from_camera.pose;
    assert!((turned.rotation.matrix() - quarter().rotation.matrix()).amax() < 1e-15);
    let no_pose = pair.split("R:").next().unwrap();
    has(&import(no_pose, &config).unwrap_err().to_string(), &["expected R"]);
    // A size that contradicts the file.
    let sized = format!("{pair}image_width: 640\nimage_height: 480\n");
    has(&import(&sized, &config).unwrap_err().to_string(), &["640x480", "1600x1200"]);
}

#[test]
fn files_of_no_format_are_named() {
    let import = |bytes: &[u8]| {
        let files = [NamedBytes { name: "a", bytes }];
        import_rig(None, &files, &ImportConfig::default()).unwrap_err().to_string()
    };
    let mut json = Vec::new();
    crate::format::write_rig(&rig(NO_LENS, 0.0), &mut json).unwrap();
    has(&import(&json), &["a rig file already"]);
    let newer = String::from_utf8(json).unwrap().replace("slcal-rig/1", "slcal-rig/2");
    has(&import(newer.as_bytes()), &["newer version"]);
    has(&import(b"just words"), &["none of the formats", "kalibr"]);
    has(&import(b""), &["none of the formats"]);
    has(&import(b"\xff\xd8\xff"), &["a JPEG picture, where a rig of another program is expected"]);
    has(&import(b"PK\x03\x04 no zip"), &["zip"]);
    has(&import(b"import bpy\nprint()"), &["slcal wrote for Blender"]);
    assert!(import_rig(None, &[], &ImportConfig::default()).is_err());
    has(&"collada".parse::<ExchangeFormat>().unwrap_err().to_string(), &["opencv, ros, colmap", "collada"]);
}
