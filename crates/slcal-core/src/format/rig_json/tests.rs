use nalgebra::{DMatrix, Point2, Rotation3, Vector3};

use super::read::project_corners;
use super::*;
use crate::assumption::{Assumption, AssumptionStatus, Moves};
use crate::for_tests::rendered_scenes;
use crate::geometry::{Camera, Distortion, Intrinsics, Pose, RectangleSize, SheetBend};
use crate::rig::{Covariance, Device, DeviceSigma, Projector, Quality, StereoPose, View, ViewBend, ViewRms};
use crate::rig::{Verdict, Warning};

fn rig() -> Rig {
    let size = RectangleSize::new(594.0, 420.0).unwrap();
    let camera = Camera {
        width: 1280,
        height: 960,
        intrinsics: Intrinsics { fx: 1500.1, fy: 1499.0 / 7.0, skew: 0.1, cx: 1.0 / 3.0, cy: -4.0 },
        distortion: Distortion { k1: -0.1, k2: 1e-17, p1: 0.1 + 0.2, p2: 0.0, k3: 0.0 },
    };
    let pose = Pose {
        rotation: Rotation3::from_euler_angles(0.3, -0.2, 0.1),
        translation: Vector3::new(-20.0, 1.0 / 7.0, 900.0),
    };
    let sigma =
        Some(DeviceSigma { focal_px: 1.5, cx_px: 2.0, cy_px: 3.0, distortion: [0.1; 5], aspect: 0.002 });
    Rig {
        camera: Device { model: camera, sigma },
        projector: Some(Projector {
            device: camera.into(),
            from_camera: StereoPose {
                pose: pose.inverse(),
                sigma_t_mm: Some([0.1, 0.2, 0.3]),
                sigma_r_rad: None,
            },
            mirrored: true,
        }),
        views: vec![View {
            photo: Some("a.png".into()),
            size,
            camera_from_sheet: pose,
            bend: Some(ViewBend {
                shape: SheetBend(std::array::from_fn(|k| 0.1 * k as f64 - 1.0 / 3.0)),
                sigma_mm: [0.1; 12],
                expected_mm: [1.4; 12],
            }),
            projector_from_sheet: Some(pose.inverse()),
            camera_vanishing_points: camera.vanishing_points(&pose),
            projector_vanishing_points: None,
            corners_px: project_corners(&camera, &pose, size).unwrap(),
            rms_px: Some(ViewRms { edges: 0.1, corners: None, projector: Some(0.3) }),
            clipped_percent: Some(1.5),
        }],
        method: "ml".into(),
        quality: Some(Quality {
            verdict: Verdict::Fair,
            focal_sigma_percent_camera: 5.0,
            focal_sigma_percent_projector: Some(0.1),
            depth_sigma_percent: Some(0.4),
            expected_point_sigma_mm: Some(0.3),
            cause: "seen flat".into(),
            advice: String::new(),
            warnings: vec![Warning { code: "a".into(), message: "b".into(), advice: "c".into() }],
            assumptions: vec![Assumption {
                code: "shown-1:1".into(),
                text: "the pattern was shown pixel by pixel".into(),
                value: 100.0,
                unit: "%".into(),
                sigma: None,
                if_off_by: 5.0,
                moves_percent: Moves { f_cam: Some(0.1), f_proj: Some(5.3), baseline: None },
                status: AssumptionStatus::Assumed,
            }],
        }),
        covariance: Some(Covariance {
            parameters: vec!["camera.focal_px".into(), "camera.cx_px".into()],
            matrix: DMatrix::from_row_slice(2, 2, &[1.0, 1.0 / 3.0, 1.0 / 3.0, 2.0]),
        }),
        channel_registration: None,
    }
}

fn text(rig: &Rig) -> String {
    let mut out = Vec::new();
    write_rig(rig, &mut out).unwrap();
    String::from_utf8(out).unwrap()
}

#[test]
fn a_rig_survives_writing_and_reading_bit_by_bit() {
    let mut rig = rig();
    // A missing value is derived on reading, so give every one for the comparison.
    rig.views[0].projector_vanishing_points =
        Some(rig.camera.model.vanishing_points(&rig.views[0].camera_from_sheet));
    assert_eq!(read_rig(text(&rig).as_bytes()).unwrap(), rig);
    let alone = Rig { projector: None, views: vec![], quality: None, covariance: None, ..rig };
    let written = text(&alone);
    assert!(written.contains("\"projector\": null") && written.contains("\"projector_from_camera\": null"));
    assert_eq!(read_rig(written.as_bytes()).unwrap(), alone);
}

#[test]
fn a_rig_from_before_bends_and_aspects_reads() {
    let mut old: Value = serde_json::from_str(&text(&rig())).unwrap();
    let mut remove = |place: &str, field: &str| {
        old.pointer_mut(place).unwrap().as_object_mut().unwrap().remove(field).unwrap()
    };
    let bend = remove("/views/0", "bend");
    assert_eq!(remove("/camera/sigma", "aspect"), 0.002);
    let read = read_rig(old.to_string().as_bytes()).unwrap();
    assert_eq!((read.views[0].bend, read.camera.sigma.unwrap().aspect), (None, 0.0));
    assert_eq!(read.camera.sigma.unwrap().distortion, [0.1; 5]);
    // What the file states for its reader is how far the surface reaches, by its own points.
    let shape = rig().views[0].bend.unwrap().shape;
    let heights = (0..=32).flat_map(|i| (0..=32).map(move |j| (f64::from(i) / 32.0, f64::from(j) / 32.0)));
    let heights: Vec<f64> =
        heights.map(|(a, b)| shape.point(rig().views[0].size, Point2::new(594.0 * a, 420.0 * b)).z).collect();
    let [low, high] = [f64::min, f64::max].map(|f| heights.iter().copied().reduce(f).unwrap());
    assert!((bend["sag_mm"].as_f64().unwrap() - (high - low)).abs() < 1e-12);
    // Coefficients alone will do; a bend of other terms will not.
    let with = |bend: &str| {
        let mut new = old.clone();
        new["views"][0]["bend"] = serde_json::from_str(bend).unwrap();
        read_rig(new.to_string().as_bytes())
    };
    let twelve = r#"{"coefficients_mm": [1,0,0,0,0,0,0,0,0,0,0,2]}"#;
    let bend = with(twelve).unwrap().views[0].bend.unwrap();
    assert_eq!((bend.shape.0[0], bend.shape.0[11], bend.sigma_mm), (1.0, 2.0, [0.0; 12]));
    assert!(with(&twelve.replace(",2]", "]")).unwrap_err().to_string().contains("views[0]"));
    assert_eq!(with("null").unwrap().views[0].bend, None);
}

#[test]
fn every_required_field_is_named_when_it_is_missing() {
    let full: Value = serde_json::from_str(&text(&rig())).unwrap();
    for (path, name) in [
        ("", "schema"),
        ("", "units"),
        ("", "pixel_centre"),
        ("", "camera"),
        ("", "projector"),
        ("", "projector_from_camera"),
        ("/camera", "width"),
        ("/camera", "K"),
        ("/projector", "height"),
        ("/projector", "distortion"),
        ("/projector_from_camera", "R"),
        ("/projector_from_camera", "t"),
    ] {
        let mut cut = full.clone();
        cut.pointer_mut(path).unwrap().as_object_mut().unwrap().remove(name).unwrap();
        let message = read_rig(cut.to_string().as_bytes()).unwrap_err().to_string();
        assert!(message.contains(&format!("`{name}`")), "{path}/{name}: {message}");
        assert!(message.contains(path.trim_start_matches('/')), "{path}/{name}: {message}");
    }
}

#[test]
fn the_required_fields_suffice_and_unknown_ones_are_skipped() {
    let minimal = r#"{"schema": "slcal-rig/1", "units": "mm", "pixel_centre": "integer", "mine": [1],
        "camera": {"width": 4, "height": 3, "K": [[5,0,1],[0,5,1],[0,0,1]], "distortion": [0,0,0,0,0], "x": 1},
        "projector": {"width": 4, "height": 3, "K": [[5,0,1],[0,5,1],[0,0,1]], "distortion": [0,0,0,0,0]},
        "projector_from_camera": {"R": [[1,0,0],[0,1,0],[0,0,1]], "t": [1,2,3]},
        "views": [{"photo": "no pose"}]}"#;
    let rig = read_rig(minimal.as_bytes()).unwrap();
    assert_eq!(rig.baseline_mm(), Some(14f64.sqrt()));
    assert!(rig.views.is_empty() && rig.quality.is_none());
    for (from, to) in [
        ("slcal-rig/1", "slcal-rig/2"),
        ("\"mm\"", "\"m\""),
        ("\"integer\"", "\"half\""),
        ("[[1,0,0],[0,1,0],[0,0,1]]", "[[1,0,0],[0,1,0],[0,0,-1]]"),
        ("[[5,0,1],[0,5,1],[0,0,1]]", "[[-5,0,1],[0,5,1],[0,0,1]]"),
        ("[1,2,3]", "[1,2,NaN]"),
        ("[1,2,3]", "[1,2,null]"),
        ("[1,2,3]", "[1,2,1e999]"),
        ("\"width\": 4", "\"width\": 0"),
    ] {
        let broken = minimal.replace(from, to);
        let error = read_rig(broken.as_bytes()).unwrap_err();
        assert!(matches!(error, Error::Malformed { .. }), "{to}: {error}");
    }
    let newer = read_rig(minimal.replace("slcal-rig/1", "slcal-rig/2").as_bytes()).unwrap_err().to_string();
    assert!(newer.contains("newer version") && newer.contains("update"), "{newer}");
    assert!(read_rig(&b"PNG"[..]).is_err());
    assert!(read_rig(&b"[]"[..]).is_err());
}

#[test]
fn numbers_that_json_cannot_hold_are_refused() {
    let mut rig = rig();
    rig.quality.as_mut().unwrap().focal_sigma_percent_camera = f64::INFINITY;
    assert!(write_rig(&rig, Vec::new()).unwrap_err().to_string().contains("quality"));
}

#[test]
fn the_rendered_truth_reads() {
    let Some(folder) = rendered_scenes("") else { return };
    let mut compared = 0;
    for scene in std::fs::read_dir(folder).unwrap() {
        let path = scene.unwrap().path().join("truth_rig.json");
        let Ok(file) = std::fs::File::open(&path) else { continue };
        let rig = read_rig(file).unwrap();
        // Scenes of one surface state no pose of a sheet.
        let posed = std::fs::read_to_string(&path).unwrap().contains("camera_from_sheet");
        assert_eq!(rig.views.len(), usize::from(posed));
        // Those with effects may have a bent sheet, whose corners lie off the plane.
        let Some(view) = rig.views.first().filter(|_| !path.with_file_name("effects.json").exists()) else {
            continue;
        };
        let seen = project_corners(&rig.camera.model, &view.camera_from_sheet, view.size).unwrap();
        for (a, b) in seen.iter().zip(view.corners_px) {
            assert!((a - b).norm() < 1e-6, "{}", path.display());
        }
        compared += 1;
    }
    assert!(compared >= 6, "{compared}");
}

/// A registration as the file has it.
fn registration() -> Value {
    let projector = serde_json::json!({"red": {"shift_px": [0.25, -0.125], "scale": 1e-4}, "blue": {"shift_px": [-0.3, 0.4]}});
    let camera = serde_json::json!({"red": {"radial": 3e-4}, "blue": {"radial": -2e-4}});
    let sigma = serde_json::json!({"projector": projector_sigma(), "camera": {"red": {"radial": 1e-4}, "blue": {"radial": 1e-4}}});
    serde_json::json!({"reference": "green", "projector": projector, "camera": camera, "sigma": sigma, "from": "checker"})
}

fn projector_sigma() -> Value {
    let one = serde_json::json!({"shift_px": [0.02, 0.02], "scale": 1e-4});
    serde_json::json!({"red": one, "blue": one})
}

#[test]
fn the_registration_of_the_channels_is_kept_with_the_centres_of_the_devices() {
    let mut value: Value = serde_json::from_str(&text(&rig())).unwrap();
    assert!(value.get("channel_registration").is_none());
    let with = |value: &Value| read_rig(value.to_string().as_bytes());
    value["channel_registration"] = registration();
    let read = with(&value).unwrap();
    let r = read.channel_registration.unwrap();
    assert_eq!(r.displacements.projector.blue.shift_px, [-0.3, 0.4]);
    assert_eq!(r.displacements.projector.blue.scale, 0.0);
    assert_eq!(r.camera_centre, read.camera.model.intrinsics.principal_point());
    let [w, h] = read.projector.unwrap().device.model.size();
    assert_eq!(r.panel_centre, Camera::image_centre(w, h));
    assert_eq!(read_rig(text(&read).as_bytes()).unwrap().channel_registration, Some(r));

    let refused = |change: &dyn Fn(&mut Value), words: &str| {
        let mut wrong = value.clone();
        change(&mut wrong);
        let message = with(&wrong).unwrap_err().to_string();
        assert!(message.contains("channel_registration") && message.contains(words), "{message}");
    };
    refused(&|v| v["channel_registration"]["reference"] = "red".into(), "green");
    refused(&|v| v["channel_registration"]["camera"]["red"]["radial"] = "x".into(), "invalid type");
    refused(
        &|v| v["channel_registration"]["sigma"]["camera"]["red"]["radial"] = (-1.0).into(),
        "not negative",
    );
    refused(&|v| v["channel_registration"]["from"] = "guess".into(), "checker");
    let alone = |v: &mut Value| {
        v["projector"] = Value::Null;
        v["projector_from_camera"] = Value::Null;
    };
    refused(&alone, "camera alone");
}
