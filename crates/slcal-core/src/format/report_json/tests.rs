//! The shapes that programs rely on: names, order and units.

use nalgebra::{Point3, Unit, Vector3};
use serde::Serialize;
use serde_json::{Value, json};

use super::*;
use crate::calibrate::CalibrationReport;
use crate::cloud::PointCloud;
use crate::decode::DecodeReport;
use crate::evaluate::{FitConfig, PlaneFit, SphereFit, fit_plane, fit_sphere};
use crate::reconstruct::Reconstruction;

fn text(report: &impl Serialize) -> String {
    serde_json::to_string(report).unwrap()
}

fn value(report: &impl Serialize) -> Value {
    serde_json::to_value(report).unwrap()
}

/// Points of a plane 1 m away and of a sphere before it.
fn cloud_of(points: impl Iterator<Item = Point3<f64>>) -> PointCloud {
    let like = crate::format::test_cloud().points[0];
    let points = points.map(|position| crate::cloud::CloudPoint { position, ..like }).collect();
    PointCloud { points, ..PointCloud::default() }
}

#[test]
fn evaluations_say_shape_rule_and_figures_in_this_order() {
    let config = FitConfig { inlier_sigmas: 3.5, ..FitConfig::default() };
    let grid = (0..400).map(|i| (f64::from(i % 20) * 5.0 - 50.0, f64::from(i / 20) * 5.0 - 50.0));
    let plane: PlaneFit =
        fit_plane(&cloud_of(grid.clone().map(|(x, y)| Point3::new(x, y, 1000.0))), &config).unwrap();
    let printed = text(&plane_evaluation(&plane, &config));
    assert!(
        printed.starts_with(r#"{"schema":"slcal-evaluate/1","plane":{"normal":["#)
            && printed.contains(
                r#","rule":"inliers lie within 3.5 times their robust sigma (1.4826 x median distance)","points":400,"#
            ),
        "{printed}"
    );
    let ball = grid.map(|(x, y)| {
        let out = Unit::new_normalize(Vector3::new(x, y, -40.0)).into_inner();
        Point3::new(0.0, 0.0, 900.0) + out * 60.0
    });
    let sphere: SphereFit = fit_sphere(&cloud_of(ball), &config).unwrap();
    let sphere = value(&sphere_evaluation(&sphere, &config));
    assert!((sphere["sphere"]["radius_mm"].as_f64().unwrap() - 60.0).abs() < 1e-6, "{sphere}");
    assert_eq!(sphere["inliers"], json!(400));
}

#[test]
fn reports_of_stages_are_those_of_the_stages_with_a_schema() {
    let decode = DecodeReport { crossings: 12, decoded: 7, ..DecodeReport::default() };
    let mut printed = value(&decoding(&decode));
    assert_eq!(printed["schema"].take(), json!("slcal-decode/1"));
    printed.as_object_mut().unwrap().remove("schema");
    assert_eq!(printed, value(&decode));

    let report = CalibrationReport {
        iterations: 9,
        edge_inliers: 0.875,
        corner_inliers: 1.0,
        cause: "seen flat".into(),
        advice: "tilt it".into(),
    };
    assert_eq!(
        text(&calibration(&report)),
        r#"{"schema":"slcal-calibration-report/1","iterations":9,"edge_inliers":0.875,"corner_inliers":1.0,"cause":"seen flat","advice":"tilt it"}"#
    );
}

#[test]
fn a_cloud_is_counted() {
    let cloud = crate::format::test_cloud();
    let printed = text(&super::cloud(&Reconstruction { cloud, ..Reconstruction::default() }));
    assert!(
        printed.starts_with(r#"{"points":4,"triangles":2,"decode":null,"triangulate":{"#)
            && printed.contains(r#""cull":{"#),
        "{printed}"
    );
}

#[test]
fn a_simulated_scene_counts_its_pixels() {
    use crate::pattern::{StripeConfig, StripePattern};
    use crate::simulate::{Photographer, RenderConfig, RigConfig, Scene, Shape, Surface};
    let config = RigConfig { camera: [80, 64], camera_focal_px: 95.0, ..RigConfig::default() };
    let rig = Scene::new(&config, &[]).unwrap().rig();
    let ball = Shape::Sphere { centre: [0.0, 0.0, 1000.0].into(), radius_mm: 200.0 };
    let photographer = Photographer::new(
        &rig,
        &[Surface::object(ball)],
        &RenderConfig { bits: 16, ..RenderConfig::default() },
    )
    .unwrap();
    let stripes = StripePattern::new(config.projector, &StripeConfig::default()).unwrap();
    let report = simulated_scene(&photographer, &photographer.stripe_matches(&stripes));
    assert_eq!((report.camera, report.surfaces, report.render.bits), ([80, 64], 1, 16));
    assert!(report.lit_pixels > 0 && report.lit_pixels <= report.seen_pixels && report.matches > 0);
    // The disc of the sphere's outline: its radius is f·tan(asin(r / d)).
    let radius = 95.0 * (0.2_f64.asin()).tan();
    let disc = std::f64::consts::PI * radius * radius;
    assert!((report.seen_pixels as f64 / disc - 1.0).abs() < 0.05, "{report:?} for {disc}");
    let [near, far] = report.depth_mm.unwrap();
    assert!((800.0..802.0).contains(&near) && far < 1000.0);
    assert_eq!(value(&report)["schema"], json!("slcal-simulate-scene/1"));
}
