//! Scenes as a few numbers.

use nalgebra::Point3;

use crate::Projector;
use crate::pattern::{CheckerConfig, CheckerPattern, Pattern, StripeConfig, StripePattern};
use crate::simulate::{PatternKind, RenderConfig, RigConfig, SceneSetup, SurfaceKind, WallKind};

fn small(surface: SurfaceKind) -> SceneSetup {
    let rig = RigConfig { camera: [160, 120], camera_focal_px: 190.0, ..RigConfig::default() };
    SceneSetup { rig, surface, render: RenderConfig::exact(), ..SceneSetup::default() }
}

#[test]
fn a_sphere_stands_before_its_wall() {
    let scene = small(SurfaceKind::Sphere { radius_mm: None }).photograph().unwrap();
    let Pattern::Stripes(_) = &scene.pattern else { panic!("{:?}", scene.pattern) };
    let (width, middle) = (160, 60 * 160 + 80);
    assert_eq!(scene.depths().len(), width * 120);
    // 0.18 and 1.5 · 0.18 of the distance; the middle of the picture lies half a pixel beside that pixel.
    assert!((scene.depths()[middle] - 820.0).abs() < 0.1, "{}", scene.depths()[middle]);
    assert!((scene.depths()[0] - 1270.0).abs() < 1e-3, "{}", scene.depths()[0]);
    assert_eq!([scene.surfaces()[middle], scene.surfaces()[0]], [1, 2]);
    let cloud = scene.cloud();
    assert!(cloud.points.len() > 500 && cloud.points.len() == scene.matches.items.len());
    for p in &cloud.points {
        let on_sphere = (p.position - Point3::new(0.0, 0.0, 1000.0)).norm() - 180.0;
        assert!(on_sphere.abs() < 1e-6 || (p.position.z - 1270.0).abs() < 1e-6, "{:?}", p.position);
    }
    // The maps of a lit pixel contain the projection of its point into the projector.
    let (columns, rows) = (scene.columns(), scene.rows());
    let Projector { device, from_camera, .. } = scene.rig.projector.unwrap();
    let point = scene.photographer.truth().at(80, 60).unwrap().point;
    let q = device.model.project(&from_camera.pose.transform(&point)).unwrap();
    assert!((f64::from(columns[middle]) - q.x).abs() < 1e-3 && (f64::from(rows[middle]) - q.y).abs() < 1e-3);
    assert!(columns.iter().zip(&rows).all(|(c, r)| c.is_nan() == r.is_nan()));
}

#[test]
fn a_sheet_is_a_view_of_its_rig_and_holds_the_whole_checkerboard() {
    let scene = small(SurfaceKind::Sheet).set_up().unwrap();
    let Pattern::Checker(checker) = &scene.pattern else { panic!("{:?}", scene.pattern) };
    assert_eq!((scene.rig.views.len(), scene.picture.width()), (1, 1024));
    let tilt = scene.rig.tilt_rad(0).unwrap();
    let expected = 25_f64.to_radians().cos() * 28_f64.to_radians().cos();
    assert!((tilt.cos() - expected).abs() < 1e-12);
    let Projector { device, from_camera, .. } = scene.rig.projector.unwrap();
    let pose = scene.rig.views[0].camera_from_sheet;
    for q in checker.inner_corners() {
        // The ray of the corner meets the sheet's plane inside the sheet.
        let inverse = pose.inverse();
        let from = inverse.transform(&from_camera.pose.centre());
        let ray = inverse.rotation * (from_camera.pose.rotation.inverse() * device.model.bearing(q).unwrap());
        let at = from - ray * (from.z / ray.z);
        assert!((0.0..594.0).contains(&at.x) && (0.0..420.0).contains(&at.y), "{at}");
    }
    let striped = SceneSetup { pattern: PatternKind::Stripes, ..small(SurfaceKind::Sheet) }.set_up().unwrap();
    assert!(matches!(striped.pattern, Pattern::Stripes(_)));
    assert_eq!(striped.rig.views.len(), 1);
}

#[test]
fn given_rigs_and_patterns_must_go_together() {
    let stripes = |w, h| Pattern::Stripes(StripePattern::new([w, h], &StripeConfig::default()).unwrap());
    let with = |pattern| SceneSetup { pattern: PatternKind::Known(pattern), ..small(SurfaceKind::Plane) };
    assert_eq!(with(stripes(1024, 768)).set_up().unwrap().pattern, stripes(1024, 768));
    let error = with(stripes(800, 600)).set_up().unwrap_err().to_string();
    assert!(error.contains("1024x768") && error.contains("800x600"), "{error}");

    let rig = small(SurfaceKind::Sheet).set_up().unwrap().rig;
    let known = SceneSetup {
        known_rig: Some(rig.clone()),
        pattern: PatternKind::Checker,
        ..small(SurfaceKind::Step)
    };
    let scene = known.set_up().unwrap();
    let default = CheckerPattern::new([1024, 768], &CheckerConfig::default()).unwrap();
    assert_eq!((scene.rig, scene.pattern), (rig.clone(), Pattern::Checker(default)));
    let alone = crate::Rig { projector: None, ..rig };
    assert!(SceneSetup { known_rig: Some(alone), ..SceneSetup::default() }.set_up().is_err());
}

#[test]
fn walls_are_optional_and_invalid_values_are_refused() {
    let surfaces = |surface, wall| SceneSetup { wall, ..small(surface) }.set_up().map(|s| s.surfaces.len());
    let sphere = || SurfaceKind::Sphere { radius_mm: Some(100.0) };
    assert_eq!(surfaces(sphere(), WallKind::None), Ok(1));
    assert_eq!(surfaces(sphere(), WallKind::Behind(150.0)), Ok(2));
    assert_eq!(surfaces(SurfaceKind::Sheet, WallKind::Usual), Ok(1));
    assert_eq!(surfaces(SurfaceKind::Plane, WallKind::None), Ok(1));
    for (surface, wall) in [
        (SurfaceKind::Plane, WallKind::Behind(20.0)),
        (SurfaceKind::Step, WallKind::Behind(20.0)),
        (sphere(), WallKind::Behind(f64::NAN)),
        (SurfaceKind::Sphere { radius_mm: Some(f64::NAN) }, WallKind::Usual),
        (SurfaceKind::Sphere { radius_mm: Some(5000.0) }, WallKind::Usual),
    ] {
        assert!(surfaces(surface.clone(), wall).is_err(), "{surface:?} {wall:?}");
    }
    let turned = SceneSetup { turn_rad: Some([1.8, 0.0, 0.0]), ..small(SurfaceKind::Plane) };
    assert!(turned.set_up().is_err());
    let flat = SceneSetup { aside_mm: [f64::NAN, 0.0], ..small(SurfaceKind::Plane) };
    assert!(flat.set_up().is_err());
}
