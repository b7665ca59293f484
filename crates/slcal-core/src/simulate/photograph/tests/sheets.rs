//! Bent sheets and boards.

use nalgebra::Point2;

use crate::detect::{DetectConfig, find_sheet};
use crate::observations::SheetObservation;
use crate::pattern::Pattern;
use crate::photo::PhotoView;
use crate::simulate::{
    BentSheet, NoiseModel, PoseConfig, RenderConfig, RigConfig, Scene, SceneSetup, Shape, SurfaceKind,
    WallKind,
};

fn setup(bend: &str, thickness_mm: f64) -> SceneSetup {
    let bend = (!bend.is_empty()).then(|| bend.parse().unwrap());
    let rig = RigConfig {
        camera: [640, 480],
        camera_focal_px: 750.0,
        distortion: [-0.08, 0.02, 4e-4, -3e-4, 0.0],
        projector_distortion: [-0.02, 0.01, 3e-4, 2e-4, 0.0],
        bend,
        ..RigConfig::default()
    };
    let render = RenderConfig { noise_levels: 0.0, bits: 16, ..RenderConfig::default() };
    let surface = SurfaceKind::Sheet;
    SceneSetup { rig, surface, thickness_mm, wall: WallKind::Behind(300.0), render, ..SceneSetup::default() }
}

/// What `detect` measures on the sides of a rendered bent sheet lies on the image of its edges.
#[test]
fn the_detected_outline_is_the_projected_edge() {
    for bend in ["0mm", "3mm,20", "-0.4%,0,wave", "3mm,0,twist"] {
        // By daylight: the border of the projector's light runs close to the corners.
        let mut setup = setup(bend, 0.0);
        setup.render.ambient = [0.5; 3];
        let scene = setup.photograph().unwrap();
        let photo = PhotoView::try_from(&scene.black).unwrap();
        let found = find_sheet(photo, &DetectConfig::default()).unwrap();
        let SheetObservation::Edges(sides) = found.observation else { panic!("{bend}: {found:?}") };
        let sheet = BentSheet::new(&setup.rig.bend.unwrap(), setup.rig.size).unwrap();
        let (camera, pose) = (scene.rig.camera.model, scene.rig.views[0].camera_from_sheet);
        let corners = setup.rig.size.corners();
        let (mut worst, mut straight) = (0.0_f64, 0.0_f64);
        for (i, side) in sides.iter().enumerate() {
            let (a, b) = (corners[i], corners[(i + 1) % 4]);
            let curve: Vec<Point2<f64>> = (0..=400)
                .map(|k| a + (b - a) * (f64::from(k) / 400.0))
                .map(|p| camera.project(&pose.transform(&sheet.point(p))).unwrap())
                .collect();
            assert!(side.len() > 20, "{bend}: {} points", side.len());
            for point in side {
                let chord = |c: &[Point2<f64>]| {
                    let along = (c[1] - c[0]).normalize();
                    let off = point.position - c[0];
                    let within = off.dot(&along).clamp(0.0, (c[1] - c[0]).norm());
                    (off - along * within).norm()
                };
                worst = worst.max(curve.windows(2).map(chord).fold(f64::INFINITY, f64::min));
                straight = straight.max(chord(&[curve[0], curve[400]]));
            }
        }
        assert!(
            worst < 0.05 && straight > 0.5,
            "{bend}: {worst} px from the curve, {straight} px from chords"
        );
    }
}

#[test]
fn rendered_corners_are_those_of_the_simulated_views() {
    for bend in ["8mm,20", "-1%,0,wave", "3mm,0,twist"] {
        let setup = setup(bend, 0.0);
        let scene = setup.photograph().unwrap();
        let Pattern::Checker(pattern) = &scene.pattern else { panic!("{:?}", scene.pattern) };
        let views = Scene::new(&setup.rig, &[PoseConfig::tilted(25.0, 28.0)]).unwrap();
        let mut draws = crate::simulate::Draws::new(1, 0);
        let seen = views.observe(&NoiseModel::uniform(0.0), &mut draws).unwrap();
        assert_eq!(pattern.inner_corners().len(), scene.matches.items.len());
        for (pair, m) in seen.views[0].pairs.iter().zip(&scene.matches.items) {
            assert!((pair.camera - m.camera).norm() < 1e-8, "{bend}: {} {}", pair.camera, m.camera);
        }
        let bend = scene.report.bend.unwrap();
        assert_eq!((bend.kind, bend.sag_mm), {
            let wanted = setup.rig.bend.unwrap();
            (wanted.kind, wanted.sag_mm(setup.rig.size))
        });
        assert_eq!(scene.report.thickness_mm, None);
    }
}

#[test]
fn a_board_shows_the_side_faces_that_are_turned_to_the_camera() {
    for bend in ["", "20mm,30", "-42mm,0"] {
        let thin = setup(bend, 0.0).photograph().unwrap();
        let thick = setup(bend, 10.0).photograph().unwrap();
        let (a, b) = (thin.surfaces(), thick.surfaces());
        assert_eq!(thick.photographer.surfaces().len(), 3);
        // The front is the same; the side faces, 2 of 3 surfaces, are seen only where the wall was seen.
        let mut faces = 0;
        for (thin, thick) in a.iter().zip(&b) {
            match (thin, thick) {
                (1, 1) | (2, 3) | (0, 0) => {}
                (2, 2) => faces += 1,
                other => panic!("{bend}: {other:?}"),
            }
        }
        assert!((200..6000).contains(&faces), "{bend}: {faces} px");
        assert_eq!(thick.report.thickness_mm, Some(10.0));
    }
}

/// A flat board's side faces are those of a block.
#[test]
fn a_flat_board_is_a_block() {
    let setup = setup("", 10.0);
    let board = setup.set_up().unwrap();
    let middle = crate::geometry::Pose {
        rotation: nalgebra::Rotation3::identity(),
        translation: nalgebra::Vector3::new(297.0, 210.0, 5.0),
    };
    let camera_from_block = board.rig.views[0].camera_from_sheet.compose(&middle);
    let mut block = board.clone();
    let shape = Shape::Block { camera_from_block, size_mm: [594.0, 420.0, 10.0] };
    block.surfaces =
        vec![crate::simulate::Surface { shape, ..board.surfaces[0].clone() }, board.surfaces[2].clone()];
    let (board, block) = (board.photograph().unwrap(), block.photograph().unwrap());
    let differ = board.depths().iter().zip(block.depths()).filter(|(a, b)| (*a - b).abs() > 1e-3).count();
    assert_eq!(differ, 0);
}

#[test]
fn bends_and_thicknesses_of_other_things_are_refused() {
    let refused = |setup: SceneSetup, words: &str| {
        let error = setup.set_up().err().map(|e| e.to_string()).unwrap_or_default();
        assert!(error.contains(words), "{words}: {error}");
    };
    refused(SceneSetup { surface: SurfaceKind::Plane, wall: WallKind::None, ..setup("3mm", 0.0) }, "bend");
    refused(SceneSetup { surface: SurfaceKind::Step, wall: WallKind::None, ..setup("", 5.0) }, "thickness");
    refused(setup("200%", 0.0), "sag of the bent sheet");
    for thickness in [-1.0, f64::NAN, f64::INFINITY, 421.0] {
        refused(setup("", thickness), "thickness of the sheet");
    }
}
