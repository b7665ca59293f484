//! Rays of pixels and positions on the panel.

use nalgebra::{Matrix3, Point2, Point3, Vector3};

use super::{bent_rig, block, exact, plane, rig, wall};
use crate::geometry::{Homography, Pose, Ray, RectangleSize};
use crate::pattern::{Axis, CheckerConfig, CheckerPattern, StripeConfig, StripePattern};
use crate::pipeline::{ReconstructConfig, cloud_from_matches};
use crate::reconstruct::CullRule;
use crate::simulate::{Photographer, Shape, Surface};

#[test]
fn a_plane_maps_pixels_to_the_panel_by_a_homography() {
    let rig = rig(160);
    let surface = plane(1000.0, 20.0, -25.0);
    let seen = Photographer::new(&rig, &[Surface::object(Shape::Plane(surface))], &exact()).unwrap();
    let (camera, projector) = (rig.camera.model, rig.projector.unwrap().device.model);
    let pose = rig.projector.unwrap().from_camera.pose;
    // X_p = (R − t nᵀ / d) X_c on n·X + d = 0.
    let through = pose.rotation.matrix() - pose.translation * surface.normal.transpose() / surface.offset_mm;
    let back = camera.intrinsics.matrix().try_inverse().unwrap();
    let h = Homography(projector.intrinsics.matrix() * Matrix3::from(through) * back);
    let mut lit = 0;
    for y in 0..seen.truth().height() {
        for x in 0..seen.truth().width() {
            let expected = h.map(Point2::new(x as f64, y as f64)).unwrap();
            let inside = |v: f64, n: u32| v >= -0.5 && v <= f64::from(n) - 0.5;
            let pixel = seen.truth().at(x, y).unwrap();
            match pixel.panel {
                Some(q) => assert!((q - expected).norm() < 1e-8, "{q} {expected}"),
                None => assert!(!(inside(expected.x, 1024) && inside(expected.y, 768))),
            }
            assert!(surface.signed_distance_mm(&pixel.point).abs() < 1e-9);
            lit += usize::from(pixel.panel.is_some());
        }
    }
    assert!(lit > 4000 && lit == seen.truth().lit(), "{lit}");
}

#[test]
fn a_sphere_is_visible_at_its_place() {
    let (centre, radius_mm) = (Point3::new(30.0, -20.0, 1000.0), 180.0);
    let rig = bent_rig(160);
    let ball = Surface::object(Shape::Sphere { centre, radius_mm });
    let seen = Photographer::new(&rig, &[ball, wall(1400.0)], &exact()).unwrap();
    for y in 0..seen.truth().height() {
        for x in 0..seen.truth().width() {
            let pixel = seen.truth().at(x, y).unwrap();
            // The angle between the ray and the centre shows whether the ray meets the sphere, and how far away.
            let ray = rig.camera.model.bearing(Point2::new(x as f64, y as f64)).unwrap().normalize();
            let distance = centre.coords.norm();
            let sine = ray.cross(&centre.coords).norm() / distance;
            assert_eq!(pixel.surface == 0, sine < radius_mm / distance, "{x},{y}");
            if pixel.surface == 0 {
                let depth = (1.0 - sine * sine).sqrt() * distance
                    - (radius_mm * radius_mm - (sine * distance).powi(2)).sqrt();
                assert!((pixel.point.coords - ray * depth).norm() < 1e-7);
            } else {
                assert!((pixel.point.z - 1400.0).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn shadows_fall_where_the_line_to_the_projector_is_blocked() {
    let rig = bent_rig(200);
    let (centre, radius_mm) = (Point3::new(-40.0, 10.0, 900.0), 90.0);
    let ball = Surface::object(Shape::Sphere { centre, radius_mm });
    let seen = Photographer::new(&rig, &[wall(1200.0), ball], &exact()).unwrap();
    let pose = rig.projector.unwrap().from_camera.pose;
    let projector = rig.projector.unwrap().device.model;
    let (lamp, mut shaded) = (pose.centre(), 0);
    for pixel in seen.truth().pixels().flatten() {
        let way = (pixel.point - lamp).normalize();
        let to_ball = centre - lamp;
        let blocked = pixel.surface == 0 && way.cross(&to_ball).norm() < radius_mm;
        let turned_away = pixel.surface == 1 && (pixel.point - centre).dot(&(lamp - pixel.point)) < 0.0;
        let q = projector.project(&pose.transform(&pixel.point)).unwrap();
        let beside = !(q.x >= -0.5 && q.y >= -0.5 && q.x <= 1023.5 && q.y <= 767.5);
        assert_eq!(pixel.panel.is_none(), blocked || turned_away || beside, "{pixel:?}");
        if let Some(panel) = pixel.panel {
            assert!((panel - q).norm() < 1e-9);
        }
        shaded += usize::from(blocked);
    }
    assert!(shaded > 200, "{shaded}");
}

#[test]
fn matches_are_exact_under_both_lenses_and_triangulate_onto_the_surface() {
    let rig = bent_rig(320);
    let slanted = plane(1000.0, 15.0, 30.0);
    for axis in [Axis::Columns, Axis::Rows] {
        let pattern =
            StripePattern::new([1024, 768], &StripeConfig { axis, ..StripeConfig::default() }).unwrap();
        let surfaces = [Surface::object(Shape::Plane(slanted)), Surface::object(block(-80.0, 800.0, 120.0))];
        let seen = Photographer::new(&rig, &surfaces, &exact()).unwrap();
        let matches = seen.stripe_matches(&pattern);
        assert!(matches.items.len() > 3000, "{}", matches.items.len());
        let mut on_block = 0;
        for m in &matches.items {
            let (along, across) = if axis == Axis::Columns {
                (m.camera.y, m.projector_column)
            } else {
                (m.camera.x, m.projector_row)
            };
            assert_eq!(along.fract(), 0.0);
            assert_eq!(across, Some(pattern.centres_px[usize::from(m.slit.unwrap())]));
            // The same panel position by another way: intersect the plane, transform to the projector's frame, project.
            let direction = rig.camera.model.bearing(m.camera).unwrap();
            let point = Ray { origin: Point3::origin(), direction }.meet(&slanted).unwrap();
            let local = rig.projector.unwrap().from_camera.pose.transform(&point);
            let q = rig.projector.unwrap().device.model.project(&local).unwrap();
            let off = (if axis == Axis::Columns { q.x } else { q.y }) - across.unwrap();
            let surface =
                seen.truth().at(m.camera.x.round() as usize, m.camera.y.round() as usize).unwrap().surface;
            on_block += usize::from(surface == 1);
            assert!(off.abs() < 1e-8 || surface == 1, "{off}");
        }
        assert!(on_block > 100, "{on_block}");
        let config = ReconstructConfig { cull: CullRule::Off, ..ReconstructConfig::default() };
        let flat = Photographer::new(&rig, &surfaces[..1], &exact()).unwrap();
        let cloud = cloud_from_matches(&rig, &flat.stripe_matches(&pattern), &config).unwrap().cloud;
        for p in &cloud.points {
            let off = slanted.signed_distance_mm(&p.position).abs();
            assert!(off < 1e-6, "{off}");
        }
    }
}

#[test]
fn a_camera_rotated_by_90_degrees_is_scanned_along_its_columns() {
    let mut rig = rig(160);
    let quarter = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_2);
    let turn = Pose { rotation: quarter, translation: Vector3::zeros() };
    let pose = &mut rig.projector.as_mut().unwrap().from_camera.pose;
    *pose = pose.compose(&turn);
    let pattern = StripePattern::new([1024, 768], &StripeConfig::default()).unwrap();
    let wall = [Surface::object(Shape::Plane(plane(1000.0, 0.0, 0.0)))];
    let matches = Photographer::new(&rig, &wall, &exact()).unwrap().stripe_matches(&pattern);
    assert!(matches.items.len() > 1000);
    assert!(matches.items.iter().all(|m| m.camera.x.fract() == 0.0 && m.projector_column.is_some()));
}

#[test]
fn corners_agree_with_the_simulated_observations() {
    use crate::simulate::{Draws, NoiseModel, PoseConfig, RigConfig, Scene};
    let scene = Scene::new(&RigConfig::default(), &[PoseConfig::tilted(25.0, 28.0)]).unwrap();
    let rig = scene.rig();
    let config = CheckerConfig { square_px: Some(scene.square_px), ..CheckerConfig::default() };
    let checker = CheckerPattern::new([1024, 768], &config).unwrap();
    let sheet = Shape::Rectangle {
        camera_from_rectangle: scene.views[0],
        size: RectangleSize { width_mm: 594.0, height_mm: 420.0 },
    };
    let seen = Photographer::new(&rig, &[Surface::object(sheet), wall(2000.0)], &exact()).unwrap();
    let found = seen.corner_matches(&checker).items;
    let noise = NoiseModel::uniform(0.0);
    let expected = scene.observe(&noise, &mut Draws::new(1, 0)).unwrap();
    assert_eq!(found.len(), 70);
    for (m, pair) in found.iter().zip(&expected.views[0].pairs) {
        assert!((m.camera - pair.camera).norm() < 1e-8);
        assert_eq!(m.projector_column, Some(pair.projector.x));
    }
}

#[test]
fn invalid_values_are_refused() {
    let rig = rig(96);
    let ball = |radius_mm| Surface::object(Shape::Sphere { centre: Point3::new(0.0, 0.0, 900.0), radius_mm });
    for bad in [ball(0.0), ball(f64::NAN), ball(10.0).colored([0.5, 1.5, 0.5])] {
        assert!(Photographer::new(&rig, &[bad], &exact()).is_err());
    }
    let mut alone = rig.clone();
    alone.projector = None;
    assert!(Photographer::new(&alone, &[ball(10.0)], &exact()).is_err());
    let mut empty = rig.clone();
    empty.camera.model.width = 0;
    assert!(Photographer::new(&empty, &[ball(10.0)], &exact()).is_err());
    // An empty scene is a dark photograph without matches.
    let nothing = Photographer::new(&rig, &[], &exact()).unwrap();
    assert_eq!(nothing.truth().lit(), 0);
    let pattern = StripePattern::new([1024, 768], &StripeConfig::default()).unwrap();
    assert!(nothing.stripe_matches(&pattern).items.is_empty());
}
