//! Scenes, poses and the cube against closed forms.

use nalgebra::{Point2, Point3};

use super::{
    BendConfig, BentSheet, Cube, Draws, NoiseModel, PoseConfig, RigConfig, Scene, SpreadConfig, bound,
    spread_poses,
};
use crate::calibrate::tests::scene::ideal;
use crate::calibrate::{CalibrateConfig, PrincipalPointRule, calibrate_observations};
use crate::error::Error;
use crate::geometry::RectangleSize;
use crate::observations::SheetObservation;

fn shifted() -> RigConfig {
    RigConfig {
        lens_shift: 0.5,
        camera_offset_px: [9.0, -7.0],
        projector_offset_px: -8.0,
        ..RigConfig::default()
    }
}

fn invalid<T: std::fmt::Debug>(result: crate::Result<T>, words: &str) {
    match result {
        Err(error @ Error::Invalid { .. }) => {
            assert!(error.to_string().contains(words), "no \"{words}\" in: {error}");
        }
        other => panic!("{words}: {other:?}"),
    }
}

#[test]
fn the_middle_of_the_pattern_falls_on_the_middle_of_the_sheet() {
    for rig in [RigConfig::default(), shifted()] {
        let scene = Scene::new(&rig, &[PoseConfig::tilted(20.0, -15.0)]).unwrap();
        let outline = rig.pattern().unwrap().outline();
        let middle = Point2::from((outline[0].coords + outline[2].coords) / 2.0);
        let at = scene.projector_from_camera.transform(&Point3::new(0.0, 0.0, rig.distance_mm));
        assert!((scene.projector.project(&at).unwrap() - middle).norm() < 1e-9);
        let centre = scene.projector_from_camera.centre();
        assert!((centre.x - rig.baseline_mm).abs() < 1e-9 && centre.z.abs() < 1e-9);
        assert!(rig.lens_shift == 0.0 || centre.y > 200.0, "a shifted projector stands lower: {centre}");
    }
}

/// The pairs of a plane obey one homography, whose equations use neither poses nor rays.
#[test]
fn without_noise_the_pairs_obey_a_homography_and_the_edges_are_straight() {
    let scene = Scene::new(&shifted(), &[PoseConfig::tilted(25.0, 28.0)]).unwrap();
    let quiet = NoiseModel { edge_points: Some(7), ..NoiseModel::uniform(0.0) };
    let seen = scene.observe(&quiet, &mut Draws::new(1, 0)).unwrap();
    let pairs: Vec<_> = seen.views[0].pairs.iter().map(|p| (p.projector, p.camera)).collect();
    assert_eq!(pairs.len(), 70);
    let h = crate::solve::homography_from_points(&pairs).unwrap();
    assert!(pairs.iter().all(|(a, b)| (h.map(*a).unwrap() - b).norm() < 1e-8));
    let of_corners = scene.observe(&NoiseModel::uniform(0.0), &mut Draws::new(1, 0)).unwrap();
    let corners = of_corners.views[0].sheet.corners().unwrap();
    for (a, b) in seen.views[0].sheet.corners().unwrap().iter().zip(corners) {
        assert!((a - b).norm() < 1e-8);
    }
}

#[test]
fn noise_has_the_requested_sigma() {
    let scene = Scene::new(&RigConfig::default(), &vec![PoseConfig::tilted(25.0, 28.0); 100]).unwrap();
    let clean = scene.observe(&NoiseModel::uniform(0.0), &mut Draws::new(1, 0)).unwrap();
    let noise = NoiseModel { sheet_px: 0.3, pattern_px: 0.07, edge_points: None };
    let seen = scene.observe(&noise, &mut Draws::new(1, 0)).unwrap();
    let (mut sheet, mut pattern, mut n) = (0.0, 0.0, [0.0_f64; 2]);
    for (a, b) in seen.views.iter().zip(&clean.views) {
        for (p, q) in a.sheet.corners().unwrap().iter().zip(b.sheet.corners().unwrap()) {
            sheet += (p - q).norm_squared();
            n[0] += 2.0;
        }
        for (p, q) in a.pairs.iter().zip(&b.pairs) {
            assert_eq!(p.sigma_px, Some(0.07));
            pattern += (p.camera - q.camera).norm_squared();
            n[1] += 2.0;
        }
    }
    // Five standard errors of a σ from n values: 1/√(2n).
    for (sum, n, sigma) in [(sheet, n[0], 0.3), (pattern, n[1], 0.07)] {
        assert!(((sum / n).sqrt() / sigma - 1.0).abs() < 5.0 / (2.0 * n).sqrt());
    }
}

#[test]
fn squares_shrink_until_they_fall_on_the_sheet_and_truncated_sheets_are_counted() {
    let tilted = |x, y| [PoseConfig::tilted(x, y)];
    let default = Scene::new(&RigConfig::default(), &tilted(25.0, 28.0)).unwrap();
    assert_eq!((default.square_px, default.outside_picture()), (48.0, 0));
    let steep = Scene::new(&RigConfig::default(), &tilted(60.0, 0.0)).unwrap();
    assert!((20.0..48.0).contains(&steep.square_px), "{}", steep.square_px);
    let upright = RectangleSize { width_mm: 420.0, height_mm: 594.0 };
    let cut = Scene::new(&RigConfig { size: upright, ..RigConfig::default() }, &tilted(25.0, 28.0)).unwrap();
    assert!((1..=4).contains(&cut.outside_picture()), "{}", cut.outside_picture());
}

#[test]
fn spread_poses_cover_all_tilt_directions_and_show_everything() {
    let rig = shifted();
    let poses = spread_poses(&rig, 8, &SpreadConfig::default(), 3).unwrap();
    assert_eq!(poses, spread_poses(&rig, 8, &SpreadConfig::default(), 3).unwrap());
    assert_ne!(poses, spread_poses(&rig, 8, &SpreadConfig::default(), 4).unwrap());
    assert_eq!(Scene::new(&rig, &poses).unwrap().views.len(), 8);
    for sign in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
        let here = |p: &&PoseConfig| p.tilt_x_rad * sign[0] > 0.0 && p.tilt_y_rad * sign[1] > 0.0;
        assert_eq!(poses.iter().filter(here).count(), 2);
    }
    for p in &poses {
        let tilt = p.tilt_x_rad.hypot(p.tilt_y_rad).to_degrees();
        assert!((15.0..=35.0).contains(&tilt), "{tilt}");
    }
}

/// The true rig triangulates the cube exactly, and a rig that is too large triangulates it too large.
#[test]
fn the_true_rig_triangulates_the_true_cube() {
    let scene = Scene::new(&shifted(), &[PoseConfig::tilted(25.0, 28.0)]).unwrap();
    let cube = Cube::new(&scene, 100.0).unwrap();
    assert!((4..=7).contains(&cube.visible()), "{}", cube.visible());
    let error = cube.error(&scene.rig(), 0.0, &mut Draws::new(1, 0)).unwrap().unwrap();
    assert!(error.position_percent < 1e-9 && error.length_percent < 1e-9, "{error:?}");
    // A rig in which every length is one per cent too long makes a cube one per cent too large.
    let mut longer = scene.rig();
    if let Some(projector) = &mut longer.projector {
        projector.from_camera.pose.translation *= 1.01;
    }
    let error = cube.error(&longer, 0.0, &mut Draws::new(1, 0)).unwrap().unwrap();
    assert!((error.length_percent - 1.0).abs() < 1e-9, "{error:?}");
}

/// For σ → 2σ every bound doubles. It agrees with the estimator's own σ, whose Jacobians are independent.
#[test]
fn the_bound_is_proportional_to_noise_and_equals_the_estimators_covariance() {
    let scene = Scene::new(&RigConfig::default(), &[PoseConfig::tilted(25.0, 28.0)]).unwrap();
    let of = |level| bound(&scene, &NoiseModel::uniform(level), [0.0; 4]).unwrap();
    let (one, two) = (of(0.1), of(0.2));
    assert!((two.camera_focal_px / one.camera_focal_px - 2.0).abs() < 1e-6);
    assert!((two.translation_mm / one.translation_mm - 2.0).abs() < 1e-6);
    let mut seen = scene.observe(&NoiseModel::uniform(0.0), &mut Draws::new(1, 0)).unwrap();
    for view in &mut seen.views {
        view.map_sigma(|_| Some(0.1), |_| Some(0.1));
    }
    let centre = PrincipalPointRule::Centre;
    let config = CalibrateConfig { camera_pp: centre, projector_pp: centre, ..ideal() };
    let rig = calibrate_observations(&seen, &config).unwrap().rig;
    // The robust loss may cost 5 % of the variance.
    let near = |a: f64, b: f64| assert!((0.999..1.027).contains(&(a / b)), "{a} {b}");
    near(rig.camera.sigma.unwrap().focal_px, one.camera_focal_px);
    near(rig.projector.unwrap().device.sigma.unwrap().focal_px, one.projector_focal_px);
    let t = rig.projector.unwrap().from_camera.sigma_t_mm.unwrap().map(|s| s * s).iter().sum::<f64>().sqrt();
    near(t, one.translation_mm);
}

#[test]
fn invisible_scenes_are_refused_with_the_reason() {
    let tilted = [PoseConfig::tilted(25.0, 28.0)];
    let rig = |change: &dyn Fn(&mut RigConfig)| {
        let mut rig = RigConfig::default();
        change(&mut rig);
        Scene::new(&rig, &tilted)
    };
    invalid(rig(&|r| r.camera_focal_px = f64::NAN), "focal length of the camera");
    invalid(rig(&|r| r.projector_focal_px = -1.0), "focal length of the projector");
    invalid(rig(&|r| r.camera = [0, 960]), "size of the camera");
    invalid(rig(&|r| r.projector = [u32::MAX, 768]), "size of the projector");
    invalid(rig(&|r| r.lens_shift = 1e9), "lens shift");
    invalid(rig(&|r| r.baseline_mm = f64::INFINITY), "baseline");
    invalid(rig(&|r| r.distance_mm = 0.0), "distance");
    invalid(rig(&|r| r.distance_mm = 150.0), "a corner behind the camera");
    invalid(rig(&|r| r.size = RectangleSize { width_mm: 15.0, height_mm: 10.0 }), "beside it");
    invalid(rig(&|r| r.checker.square_px = Some(80.0)), "beside it");
    let small = RigConfig { size: RectangleSize { width_mm: 15.0, height_mm: 10.0 }, ..RigConfig::default() };
    invalid(spread_poses(&small, 3, &SpreadConfig::default(), 1), "projected pattern");
    let near = RigConfig { distance_mm: 400.0, ..RigConfig::default() };
    invalid(spread_poses(&near, 3, &SpreadConfig::default(), 1), "the camera's picture");
    invalid(rig(&|r| r.distortion[0] = f64::NAN), "distortion");
    for tilt in [90.0, -90.0, f64::NAN, f64::INFINITY] {
        invalid(Scene::new(&RigConfig::default(), &[PoseConfig::tilted(tilt, 0.0)]), "tilt");
    }
    invalid(spread_poses(&RigConfig::default(), 0, &SpreadConfig::default(), 1), "number of poses");
    let scene = Scene::new(&RigConfig::default(), &tilted).unwrap();
    for edge in [0.0, -5.0, f64::NAN, 1e9] {
        invalid(Cube::new(&scene, edge), "reference cube");
    }
    invalid(scene.observe(&NoiseModel::uniform(-1.0), &mut Draws::new(1, 0)), "noise");
    invalid(scene.observe(&NoiseModel::uniform(f64::NAN), &mut Draws::new(1, 0)), "noise");
}

fn bend(text: &str) -> BendConfig {
    text.parse().unwrap()
}

/// The corners and sides of a bent sheet are images of its surface, and projected corners lie on the projector's rays
/// and on the surface: checked without the intersection, by the camera's ray to where the pair was seen.
#[test]
fn observations_of_a_bent_sheet_lie_on_it() {
    let rig = RigConfig {
        bend: Some(bend("8mm,20")),
        distortion: [-0.12, 0.03, 4e-4, -3e-4, 0.0],
        projector_distortion: [-0.02, 0.01, 3e-4, 2e-4, 0.0],
        camera_pixel_aspect: 1.002,
        projector_pixel_aspect: 0.997,
        ..shifted()
    };
    let scene =
        Scene::new(&rig, &[PoseConfig::tilted(25.0, 28.0), PoseConfig::tilted(-20.0, -25.0)]).unwrap();
    let quiet = NoiseModel { edge_points: Some(9), ..NoiseModel::uniform(0.0) };
    let seen = scene.observe(&quiet, &mut Draws::new(1, 0)).unwrap();
    let bent = BentSheet::new(&rig.bend.unwrap(), rig.size).unwrap();
    for (view, pose) in seen.views.iter().zip(&scene.views) {
        let SheetObservation::Edges(sides) = &view.sheet else { panic!("{:?}", view.sheet) };
        for (i, side) in sides.iter().enumerate() {
            let (a, b) = (rig.size.corners()[i], rig.size.corners()[(i + 1) % 4]);
            for (k, point) in side.iter().enumerate() {
                let place = a + (b - a) * ((k as f64 + 0.5) / 9.0);
                let expected = scene.camera.project(&pose.transform(&bent.point(place))).unwrap();
                assert!((point.position - expected).norm() < 1e-9);
            }
        }
        // By Newton's method on the sheet: the place whose image is the pair's, and its position on the panel.
        for pair in &view.pairs {
            let image = |p: Point2<f64>| {
                let at = pose.transform(&bent.point(p));
                (
                    scene.camera.project(&at).unwrap(),
                    scene.projector.project(&scene.projector_from_camera.transform(&at)).unwrap(),
                )
            };
            let mut p = Point2::new(297.0, 210.0);
            for _ in 0..20 {
                let off = image(p).0 - pair.camera;
                let step = 1e-4;
                let x = (image(Point2::new(p.x + step, p.y)).0 - image(p).0) / step;
                let y = (image(Point2::new(p.x, p.y + step)).0 - image(p).0) / step;
                p -= nalgebra::Matrix2::from_columns(&[x, y]).try_inverse().unwrap() * off;
            }
            assert!((image(p).0 - pair.camera).norm() < 1e-8);
            assert!((image(p).1 - pair.projector).norm() < 1e-6, "{} {}", image(p).1, pair.projector);
        }
    }
}

#[test]
fn a_bend_of_zero_is_a_flat_sheet_and_a_bend_moves_every_side() {
    let poses = [PoseConfig::tilted(25.0, 28.0)];
    let quiet = NoiseModel { edge_points: Some(5), ..NoiseModel::uniform(0.0) };
    let observed = |bend| {
        let scene = Scene::new(&RigConfig { bend, ..shifted() }, &poses).unwrap();
        scene.observe(&quiet, &mut Draws::new(1, 0)).unwrap().views.remove(0)
    };
    let distances = |bend| {
        let (flat, bent) = (observed(None), observed(bend));
        let (SheetObservation::Edges(a), SheetObservation::Edges(b)) = (&flat.sheet, &bent.sheet) else {
            panic!("{flat:?}")
        };
        let edges = a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a.position - b.position).norm());
        let pairs = flat.pairs.iter().zip(&bent.pairs).map(|(a, b)| (a.camera - b.camera).norm());
        [edges.fold(0.0, f64::max), pairs.fold(0.0, f64::max)]
    };
    for zero in ["0mm", "0%,30,wave", "0mm,0,twist"] {
        assert!(distances(Some(bend(zero))).iter().all(|d| *d < 1e-9), "{zero}");
    }
    for kind in ["curl", "wave", "twist"] {
        let [edges, pairs] = distances(Some(bend(&format!("3mm,0,{kind}"))));
        assert!(edges > 0.5 && edges < 5.0 && pairs > 0.2, "{kind}: {edges} {pairs}");
    }
}

#[test]
fn pixel_aspects_and_offsets_are_those_of_the_matrices() {
    let rig = RigConfig {
        camera_pixel_aspect: 1.01,
        projector: [912, 1140],
        projector_focal_px: 850.0,
        projector_pixel_aspect: 2.0,
        projector_distortion: [-0.02, 0.0, 0.0, 0.0, 0.01],
        lens_shift: 0.1,
        ..RigConfig::default()
    }
    .with_projector_offset([30.0, -57.0]);
    let (camera, projector) = (rig.camera().intrinsics, rig.projector());
    assert_eq!((camera.fx, camera.fy), (1500.0, 1515.0));
    assert_eq!((projector.intrinsics.fx, projector.intrinsics.fy), (850.0, 1700.0));
    assert!((projector.intrinsics.cx - 485.5).abs() < 1e-9 && (projector.intrinsics.cy - 626.5).abs() < 1e-9);
    assert_eq!(projector.distortion.to_array(), [-0.02, 0.0, 0.0, 0.0, 0.01]);
    // The middle of the pattern still falls on the middle of the sheet.
    let outline = rig.pattern().unwrap().outline();
    let middle = Point2::from((outline[0].coords + outline[2].coords) / 2.0);
    let at = rig.projector_from_camera().unwrap().transform(&Point3::new(0.0, 0.0, rig.distance_mm));
    assert!((projector.project(&at).unwrap() - middle).norm() < 1e-8);
    let refused = |change: &dyn Fn(&mut RigConfig), words: &str| {
        let mut rig = RigConfig::default();
        change(&mut rig);
        invalid(Scene::new(&rig, &[PoseConfig::tilted(25.0, 28.0)]), words);
    };
    refused(&|r| r.camera_pixel_aspect = 0.0, "pixel aspect of the camera");
    refused(&|r| r.projector_pixel_aspect = f64::NAN, "pixel aspect of the projector");
    refused(&|r| r.projector_distortion[1] = f64::INFINITY, "distortion of the projector");
    refused(&|r| r.bend = Some(bend("200%")), "sag");
    refused(&|r| *r = r.clone().with_projector_offset([1e9, 0.0]), "principal point");
    // A lens that folds before the middle of the pattern.
    refused(&|r| (r.projector_distortion[0], r.lens_shift) = (-2.0, 0.7), "distortion of the projector");
}

/// The old configurations print as before: the experiment's JSON holds them.
#[test]
fn unused_effects_are_not_in_the_configuration() {
    let json = serde_json::to_value(RigConfig::default()).unwrap();
    let keys: Vec<_> = json.as_object().unwrap().keys().map(String::as_str).collect();
    for new in ["bend", "camera_pixel_aspect", "projector_pixel_aspect", "projector_distortion"] {
        assert!(!keys.contains(&new), "{new}");
    }
    let bent =
        RigConfig { bend: Some(bend("0.5%,20,wave")), projector_pixel_aspect: 2.0, ..RigConfig::default() };
    let json = serde_json::to_value(&bent).unwrap();
    assert_eq!((&json["bend"], &json["projector_pixel_aspect"]), (&"0.5%,20,wave".into(), &2.0.into()));
    assert_eq!(serde_json::from_value::<RigConfig>(json).unwrap(), bent);
}
