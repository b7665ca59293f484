//! Places of objects.

use nalgebra::{Point3, Vector3};

use super::{exact, rig};
use crate::geometry::RectangleSize;
use crate::simulate::{
    Photographer, Placement, PoseConfig, RigConfig, SceneObject, Shape, SheetObject, TriangleMesh,
};

fn placement() -> Placement {
    Placement {
        middle_mm: [0.0, 0.0, 1000.0],
        turn_rad: [0.3, -0.4, 0.05],
        albedo: [0.8; 3],
        wall_mm: None,
        wall_albedo: 0.4,
    }
}

#[test]
fn a_sheet_has_the_pose_of_the_observations() {
    let [tilt_x_rad, tilt_y_rad, roll_rad] = placement().turn_rad;
    let pose = PoseConfig { tilt_x_rad, tilt_y_rad, roll_rad, ..PoseConfig::default() };
    let config = RigConfig::default();
    let (a, b) = (pose.camera_from_sheet(&config), placement().camera_from_sheet(config.size));
    assert!((a.translation - b.translation).norm() < 1e-9);
    assert!((a.rotation.matrix() - b.rotation.matrix()).norm() < 1e-12);
}

#[test]
fn every_object_is_visible_in_the_middle() {
    let rig = rig(96);
    let pyramid = TriangleMesh::new(
        vec![
            Point3::new(0.0, 300.0, 0.0),
            Point3::new(-200.0, 100.0, 0.0),
            Point3::new(200.0, 100.0, 0.0),
            Point3::new(0.0, 100.0, 50.0),
        ],
        vec![[0, 1, 3], [0, 3, 2], [0, 2, 1]],
    )
    .unwrap();
    let sheet = RectangleSize { width_mm: 400.0, height_mm: 300.0 };
    for object in [
        SceneObject::Plane,
        SceneObject::Sphere { radius_mm: 150.0 },
        SceneObject::Sheet(SheetObject::new(sheet, None, 0.0).unwrap()),
        SceneObject::Mesh(pyramid),
    ] {
        let flat = Placement { turn_rad: [0.1, 0.0, 0.0], wall_mm: Some(400.0), ..placement() };
        let surfaces = object.surfaces(&flat).unwrap();
        assert!(surfaces[0].is_object && !surfaces[surfaces.len() - 1].is_object);
        let seen = Photographer::new(&rig, &surfaces, &exact()).unwrap();
        let middle = seen.truth().at(47, 35).unwrap();
        assert_eq!(middle.surface, 0, "{object:?}");
        assert!((840.0..1050.0).contains(&middle.point.z), "{object:?} {middle:?}");
    }
}

#[test]
fn a_mesh_stands_upright_and_shows_its_front() {
    // An arrow that points up, its front half (z > 0) towards the viewer.
    let mesh = TriangleMesh::new(
        vec![Point3::new(-50.0, 0.0, 0.0), Point3::new(50.0, 0.0, 0.0), Point3::new(0.0, 100.0, 40.0)],
        vec![[0, 1, 2]],
    )
    .unwrap();
    let straight = Placement { turn_rad: [0.0; 3], ..placement() };
    let surfaces = SceneObject::Mesh(mesh).surfaces(&straight).unwrap();
    let Shape::Mesh(stood) = &surfaces[0].shape else { panic!("another shape") };
    let [least, most] = stood.bounds();
    assert!((least - Point3::new(-50.0, -50.0, 980.0)).norm() < 1e-9 && (most.y - 50.0).abs() < 1e-9);
    let tip = stood.vertices[2];
    assert!((tip - Point3::new(0.0, -50.0, 980.0)).norm() < 1e-9, "up and near: {tip}");
}

#[test]
fn steps_stand_on_their_wall() {
    let surfaces = SceneObject::Step.surfaces(&placement()).unwrap();
    assert_eq!(surfaces.iter().filter(|s| s.is_object).count(), 2);
    let Shape::Plane(wall) = surfaces[2].shape else { panic!("no wall") };
    for block in &surfaces[..2] {
        let Shape::Block { camera_from_block, size_mm } = &block.shape else { panic!("no block") };
        let back = camera_from_block.transform(&Point3::from(Vector3::new(0.0, 0.0, size_mm[2] / 2.0)));
        assert!(wall.signed_distance_mm(&back).abs() < 1e-9);
    }
    assert!(SceneObject::Plane.surfaces(&Placement { turn_rad: [2.0, 0.0, 0.0], ..placement() }).is_err());
    assert!(
        SceneObject::Step.surfaces(&Placement { middle_mm: [0.0, 0.0, f64::NAN], ..placement() }).is_err()
    );
}
