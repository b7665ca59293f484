use nalgebra::Point2;

use super::scene::{ideal, observe, pose, rig, rng, with_edges};
use crate::calibrate::*;
use crate::error::{Error, ErrorClass};
use crate::for_tests::rendered_scenes;
use crate::geometry::RectangleSize;
use crate::observations::{CornerPair, Observations, SheetObservation, ViewObservation};
use crate::rig::{Device, Rig, Verdict};

/// Exact corners and pairs of a rendered scene; `None` where the scenes are absent.
fn rendered(scene: &str) -> Option<(Observations, Rig)> {
    let folder = rendered_scenes(scene)?;
    let truth = std::fs::File::open(folder.join("truth_rig.json")).unwrap();
    let truth = crate::format::read_rig(truth).unwrap();
    let text = std::fs::read_to_string(folder.join("checker_corners.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let points = |key: &str| -> Vec<Point2<f64>> {
        let list: Vec<[f64; 2]> = serde_json::from_value(json[key].clone()).unwrap();
        list.into_iter().map(|[x, y]| Point2::new(x, y)).collect()
    };
    let visible: Vec<bool> = serde_json::from_value(json["visible"].clone()).unwrap();
    let pairs = points("corners_camera_px").into_iter().zip(points("corners_projector_px")).zip(visible);
    let pairs = pairs
        .filter(|(_, v)| *v)
        .map(|((camera, projector), _)| CornerPair { camera, projector, sigma_px: Some(0.05) })
        .collect();
    let sheet = SheetObservation::Corners { corners: truth.views[0].corners_px, sigma_px: Some(0.05) };
    let size = |d: &Device| [d.model.width, d.model.height];
    let observations = Observations {
        camera: size(&truth.camera),
        projector: truth.projector.as_ref().map(|p| size(&p.device)),
        mirrored: false,
        views: vec![ViewObservation {
            photo: None,
            size: truth.views[0].size,
            sheet,
            pairs,
            panel_points: Vec::new(),
            channel_offsets: Vec::new(),
        }],
    };
    Some((observations, truth))
}

type Spoil = fn(&mut Observations);

fn focal(d: &Device) -> f64 {
    d.model.intrinsics.fx
}

#[test]
fn exact_corners_of_the_rendered_scenes_give_exact_rigs() {
    for scene in ["paper_tilted", "paper_lensshift", "dark_clutter"] {
        let Some((observations, truth)) = rendered(scene) else { return };
        let found = calibrate_observations(&observations, &CalibrateConfig::default()).unwrap().rig;
        let (p, q) = (found.projector.unwrap().device, truth.projector.unwrap().device);
        assert!((focal(&found.camera) / focal(&truth.camera) - 1.0).abs() < 1e-4, "{scene}");
        assert!((focal(&p) / focal(&q) - 1.0).abs() < 1e-4, "{scene}: {p:?}");
        assert!((p.model.intrinsics.cy - q.model.intrinsics.cy).abs() < 0.2, "{scene}: {p:?}");
        assert!(found.quality.unwrap().verdict <= Verdict::Fair);
    }
}

#[test]
fn nearly_face_on_is_refused_unless_the_principal_points_are_given() {
    let Some((observations, truth)) = rendered("near_frontal") else { return };
    let error = calibrate_observations(&observations, &CalibrateConfig::default()).unwrap_err();
    assert_eq!(error.class(), ErrorClass::Degenerate);
    let exact = CalibrateConfig {
        camera_pp: PrincipalPointRule::Exact(639.5, 479.5),
        projector_pp: PrincipalPointRule::Exact(511.5, 383.5),
        ..ideal()
    };
    let found = calibrate_observations(&observations, &exact).unwrap().rig;
    assert!((focal(&found.camera) / focal(&truth.camera) - 1.0).abs() < 1e-3);
    let allowed = CalibrateConfig { allow_degenerate: true, ..CalibrateConfig::default() };
    let found = calibrate_observations(&observations, &allowed).unwrap().rig;
    assert_eq!(found.quality.unwrap().verdict, Verdict::Degenerate);
}

#[test]
fn edges_with_one_sided_contamination_do_not_move_the_result() {
    let truth = rig(768.0, vec![pose(25.0, 28.0)]);
    let mut rng = rng(3);
    let observations = observe(&truth, 0.05, 0.1, &mut rng);
    let mut observations = with_edges(observations, &truth, 60, 0.1, &mut rng);
    if let SheetObservation::Edges(sides) = &mut observations.views[0].sheet {
        for p in sides[0].iter_mut().skip(40).step_by(2) {
            p.position.y -= 6.0;
        }
        for p in sides[1].iter_mut().take(12) {
            p.position.x += 1.5;
        }
    }
    let c = calibrate_observations(&observations, &ideal()).unwrap();
    assert!((focal(&c.rig.camera) / 1500.0 - 1.0).abs() < 3e-3, "{:?}", c.rig.camera);
    assert!(c.report.edge_inliers < 0.96 && c.report.edge_inliers > 0.88, "{}", c.report.edge_inliers);
}

#[test]
fn nonsense_is_refused_with_a_reason() {
    let truth = rig(768.0, vec![pose(25.0, 28.0)]);
    let good = observe(&truth, 0.2, 0.1, &mut rng(1));
    let cases: [(&str, Spoil); 10] = [
        ("at least one view", |o| o.views.clear()),
        ("finite", |o| o.views[0].pairs[3].camera.x = f64::NAN),
        ("positive σ", |o| o.views[0].pairs[3].sigma_px = Some(-1.0)),
        ("σ", |o| o.views[0].pairs[3].sigma_px = None),
        ("at least 4 pairs", |o| o.views[0].pairs.truncate(3)),
        ("on one line", |o| o.views[0].pairs.truncate(9)),
        ("another panel", |o| o.projector = Some([640, 480])),
        ("mirror", |o| swap_corners(o, [1, 0, 3, 2])),
        ("convex", |o| swap_corners(o, [0, 2, 1, 3])),
        ("positive lengths", |o| o.views[0].size = RectangleSize { width_mm: 0.0, height_mm: 420.0 }),
    ];
    for (expected, spoil) in cases {
        let mut bad = good.clone();
        spoil(&mut bad);
        let error = calibrate_observations(&bad, &CalibrateConfig::default()).unwrap_err();
        assert!(error.to_string().contains(expected), "{expected}: {error}");
        assert!(matches!(error, Error::Invalid { .. }), "{error}");
    }
}

fn swap_corners(o: &mut Observations, order: [usize; 4]) {
    if let SheetObservation::Corners { corners, .. } = &mut o.views[0].sheet {
        *corners = order.map(|i| corners[i]);
    }
}

#[test]
fn a_transposed_size_is_suspected_but_not_swapped() {
    let truth = rig(768.0, vec![pose(25.0, 28.0)]);
    let mut o = observe(&truth, 0.2, 0.1, &mut rng(1));
    o.views[0].size = o.views[0].size.transposed();
    match calibrate_observations(&o, &CalibrateConfig::default()) {
        Ok(c) => {
            let quality = c.rig.quality.unwrap();
            let swap = quality.warnings.iter().find(|w| w.code == "size-transposed").unwrap();
            assert_eq!((&quality.cause, &quality.advice), (&swap.message, &swap.advice));
            assert!(quality.verdict >= Verdict::Weak);
        }
        Err(e) => assert!(e.to_string().contains("swap"), "{e}"),
    }
}
