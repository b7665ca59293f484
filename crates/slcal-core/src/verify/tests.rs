//! Known truth: rigs that have moved by known amounts, and ones that have not.

use nalgebra::{Point2, Rotation3, Vector3};

use super::*;
use crate::CornerPair;
use crate::calibrate::tests::scene::{flat, ideal, observe, pose, rig as truth, rng, with_edges};
use crate::calibrate::{CalibrateConfig, Flatness, calibrate_observations};
use crate::geometry::SheetBend;
use crate::pattern::{CheckerConfig, CheckerPattern};
use crate::rectify_checker;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

const NOISE_PX: f64 = 0.05;

fn two_views() -> Model {
    truth(768.0, vec![pose(25.0, 28.0), pose(-25.0, -28.0)])
}

fn calibrated(model: &Model, rng: &mut ChaCha8Rng) -> Rig {
    calibrated_under(&ideal(), model, rng)
}

fn calibrated_under(config: &CalibrateConfig, model: &Model, rng: &mut ChaCha8Rng) -> Rig {
    let seen = with_edges(observe(model, NOISE_PX, NOISE_PX, rng), model, 12, NOISE_PX, rng);
    calibrate_observations(&seen, config).unwrap().rig
}

/// A photograph of the first view.
fn photograph(model: &Model, rng: &mut ChaCha8Rng) -> ViewObservation {
    let one = Model { views: vec![model.views[0]], ..model.clone() };
    with_edges(observe(&one, NOISE_PX, NOISE_PX, rng), &one, 12, NOISE_PX, rng).views.remove(0)
}

fn panel() -> [Point2<f64>; 4] {
    [(-0.5, -0.5), (1023.5, -0.5), (1023.5, 767.5), (-0.5, 767.5)].map(|(x, y)| Point2::new(x, y))
}

fn run(rig: &Rig, seen: &ViewObservation) -> Verification {
    verify(rig, seen, &panel(), 4.0 / 3.0, VerifyConfig::default()).unwrap()
}

/// The largest distance of the sorted values from those of a uniform distribution (Kolmogorov and Smirnov).
fn from_uniform(mut p: Vec<f64>) -> f64 {
    p.sort_by(f64::total_cmp);
    let n = p.len() as f64;
    p.iter().enumerate().map(|(i, p)| (p - (i as f64 + 0.5) / n).abs()).fold(0.0, f64::max)
}

#[test]
fn the_false_alarm_rate_is_the_stated_one() {
    const DRAWS: usize = 250;
    let mut rng = rng(31);
    let model = two_views();
    let (mut of_rig, mut of_sheet) = (Vec::new(), Vec::new());
    for _ in 0..DRAWS {
        let rig = calibrated(&model, &mut rng);
        let found = run(&rig, &photograph(&model, &mut rng));
        of_rig.push(found.rig.p_value);
        of_sheet.push(found.sheet.unwrap().p_value);
    }
    for p in [of_rig, of_sheet] {
        // 2.5 are expected below 1 %, 12.5 below 5 %; more than 9 or 25 happen once in a thousand.
        let below = |limit: f64| p.iter().filter(|v| **v < limit).count();
        assert!(below(0.01) <= 9 && (3..=25).contains(&below(0.05)), "{} {}", below(0.01), below(0.05));
        // The 0.1 % point of the statistic is 1.95/√n.
        let d = from_uniform(p.clone());
        assert!(d < 1.95 / (DRAWS as f64).sqrt(), "{d}");
    }
}

#[test]
fn an_uncertain_rig_raises_no_false_alarms() {
    // One photograph, its principal points off by what the priors allow: the rig is 2 % off, and knows it.
    let lenses_alone = CalibrateConfig { flatness: Flatness::Flat, ..CalibrateConfig::default() };
    let mut rng = rng(7);
    let (mut alarms, mut blind_alarms) = (0, 0);
    for _ in 0..60 {
        let mut model = truth(768.0, vec![pose(25.0, 28.0)]);
        let mut draw = |sigma: f64| Normal::new(0.0, sigma).unwrap().sample(&mut rng);
        model.camera.intrinsics.cx += draw(12.0);
        model.camera.intrinsics.cy += draw(12.0);
        let rig = calibrated_under(&lenses_alone, &model, &mut rng);
        // The sheet somewhere else, so that an error of the rig would show.
        let elsewhere = Model { views: vec![flat(pose(-12.0, 20.0))], ..model.clone() };
        let found = run(&rig, &photograph(&elsewhere, &mut rng));
        alarms += usize::from(found.rig.p_value < 0.01);
        let mut blind = rig;
        blind.covariance = None;
        let blind = run(&blind, &photograph(&elsewhere, &mut rng));
        assert!(!blind.with_covariance);
        blind_alarms += usize::from(blind.rig.p_value < 0.01);
    }
    // More than 4 of 60 at 1 % happen less than once in a thousand; without the covariance nearly all do.
    assert!(alarms <= 4 && blind_alarms > 40, "{alarms} and {blind_alarms} of 60");
}

#[test]
fn a_turned_projector_is_noticed_and_measured() {
    let mut rng = rng(3);
    let model = two_views();
    let rig = calibrated(&model, &mut rng);
    for (axis, degrees) in [(Vector3::x_axis(), 0.3), (Vector3::y_axis(), -0.3), (Vector3::z_axis(), 0.3)] {
        let mut turned = model.clone();
        let turn = Rotation3::from_axis_angle(&axis, f64::to_radians(degrees));
        let p = turned.projector_from_camera;
        turned.projector_from_camera =
            Pose { rotation: turn * p.rotation, translation: turn * p.translation };
        let found = run(&rig, &photograph(&turned, &mut rng));
        assert!(found.rig.moved && found.rig.p_value < 1e-6, "{axis:?}: {:?}", found.rig);
        let Some(Change::Moved { turn_rad, shift_mm }) = found.rig.change else {
            panic!("{:?}", found.rig.change)
        };
        assert!((turn_rad.value.to_degrees() - 0.3).abs() < 0.03 + 4.0 * turn_rad.sigma.to_degrees());
        assert!(shift_mm.value < 5.0 * shift_mm.sigma + 0.5, "{shift_mm:?}");
        let sheet = found.sheet.unwrap();
        assert!(!sheet.moved, "{sheet:?}");
        assert!(found.rig.pattern_off_mm > 1.0 && found.rig.corner_rms_px[0] > found.rig.corner_rms_px[1]);
    }
}

#[test]
fn a_moved_sheet_is_distinguished_from_a_moved_rig() {
    let mut rng = rng(4);
    let model = two_views();
    let rig = calibrated(&model, &mut rng);
    let mut moved = model.clone();
    moved.views[0].pose.translation += Vector3::new(9.0, 0.0, 8.0);
    let found = run(&rig, &photograph(&moved, &mut rng));
    let sheet = found.sheet.unwrap();
    assert!(!found.rig.moved && found.rig.change.is_none(), "{:?}", found.rig);
    assert!(sheet.moved && (sheet.shift_mm - 145.0f64.sqrt()).abs() < 0.5, "{sheet:?}");
    // Any pose will do for the rig.
    let elsewhere = Model { views: vec![flat(pose(-10.0, 35.0))], ..model.clone() };
    let found = run(&rig, &photograph(&elsewhere, &mut rng));
    assert!(!found.rig.moved, "{:?}", found.rig);
    // A bumped camera has moved against both.
    let mut bumped = model;
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), 0.01);
    bumped.views[0].pose.rotation = turn * bumped.views[0].pose.rotation;
    bumped.views[0].pose.translation = turn * bumped.views[0].pose.translation;
    bumped.projector_from_camera.rotation *= turn.inverse();
    let found = run(&rig, &photograph(&bumped, &mut rng));
    assert!(found.rig.moved && found.sheet.unwrap().moved);
}

#[test]
fn a_turned_zoom_is_named() {
    let mut rng = rng(5);
    let model = two_views();
    let rig = calibrated(&model, &mut rng);
    let mut zoomed = model.clone();
    let mut projector = zoomed.projector.unwrap();
    projector.intrinsics.fx *= 1.01;
    projector.intrinsics.fy *= 1.01;
    zoomed.projector = Some(projector);
    match run(&rig, &photograph(&zoomed, &mut rng)).rig.change {
        Some(Change::ProjectorFocal(f)) => {
            assert!((f.value - 0.01).abs() < 5.0 * f.sigma && f.sigma < 1e-3, "{f:?}");
        }
        other => panic!("{other:?}"),
    }
    let mut zoomed = model;
    zoomed.camera.intrinsics.fx *= 1.01;
    zoomed.camera.intrinsics.fy *= 1.01;
    match run(&rig, &photograph(&zoomed, &mut rng)).rig.change {
        Some(Change::CameraFocal(f)) => assert!((f.value - 0.01).abs() < 5.0 * f.sigma, "{f:?}"),
        other => panic!("{other:?}"),
    }
}

/// What the camera sees of the rectified pattern's corners.
fn rectified(model: &Model, at: &[Point2<f64>], rng: &mut ChaCha8Rng) -> ViewObservation {
    let mut seen = photograph(model, rng);
    let noise = Normal::new(0.0, NOISE_PX).unwrap();
    seen.pairs = at
        .iter()
        .map(|&q| {
            let p = model.lit(&model.views[0], q);
            let c = model.camera.project(&p.unwrap()).unwrap();
            let camera = Point2::new(c.x + noise.sample(rng), c.y + noise.sample(rng));
            CornerPair { camera, projector: q, sigma_px: Some(NOISE_PX) }
        })
        .collect();
    seen
}

#[test]
fn a_rectified_pattern_has_no_keystone_left_and_a_moved_sheet_has_what_geometry_says() {
    let mut rng = rng(6);
    let model = two_views();
    let rig = calibrated(&model, &mut rng);
    let pattern = CheckerPattern::new([1024, 768], &CheckerConfig::default()).unwrap();
    let h = rectify_checker(&rig, 0, &pattern).unwrap().panel_from_source;
    let (corners, aspect) = outline(&pattern, Some(&h)).unwrap();
    let at: Vec<_> = pattern.inner_corners().into_iter().map(|p| h.map(p).unwrap()).collect();
    let check = |model: &Model, rng: &mut ChaCha8Rng| {
        verify(&rig, &rectified(model, &at, rng), &corners, aspect, VerifyConfig::default()).unwrap()
    };
    let found = check(&model, &mut rng);
    let k = found.keystone;
    assert!(k.worst_rad.value.to_degrees().abs() < 0.05, "{k:?}");
    // Which side is the worst is chance where all are within their σ.
    assert!(k.sides_rad.iter().any(|s| s.sigma.to_degrees() < 0.02), "{k:?}");
    for side in k.sides_rad {
        assert!(side.value.abs() < 4.5 * side.sigma, "{k:?}");
    }
    assert!(k.aspect.value.abs() < 4.5 * k.aspect.sigma && !found.rig.moved && !found.sheet.unwrap().moved);
    // The sheet turned under the light, by hand: where the truth throws the corners is the truth.
    let mut moved = model.clone();
    moved.views[0].pose.rotation *= Rotation3::from_euler_angles(0.02, -0.05, 0.01);
    let found = check(&moved, &mut rng);
    let on_sheet = corners.map(|q| {
        let p = moved.lit(&moved.views[0], q).unwrap();
        moved.views[0].pose.inverse().transform(&p).xy()
    });
    let top = on_sheet[1] - on_sheet[0];
    let truth = top.y.atan2(top.x);
    let side = found.keystone.sides_rad[0];
    assert!(truth.abs() > 0.005 && (side.value - truth).abs() < 4.5 * side.sigma, "{truth} {side:?}");
    assert!(found.sheet.unwrap().moved && !found.rig.moved);
}

#[test]
fn one_wrong_corner_is_left_out() {
    let mut rng = rng(8);
    let model = two_views();
    let rig = calibrated(&model, &mut rng);
    let mut seen = photograph(&model, &mut rng);
    seen.pairs[20].projector.x += 60.0;
    let found = run(&rig, &seen);
    assert!(!found.rig.moved && found.left_out >= 1, "{:?}", found.rig);
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let mut rng = rng(9);
    let model = two_views();
    let rig = calibrated(&model, &mut rng);
    let seen = photograph(&model, &mut rng);
    let with = |rig: &Rig, seen: &ViewObservation| verify(rig, seen, &panel(), 1.0, VerifyConfig::default());
    let alone = Rig { projector: None, ..rig.clone() };
    assert!(with(&alone, &seen).unwrap_err().to_string().contains("projector"));
    let few = ViewObservation { pairs: seen.pairs[..3].to_vec(), ..seen.clone() };
    assert!(with(&rig, &few).is_err());
    let mut nan = seen.clone();
    nan.pairs[3].camera.x = f64::NAN;
    assert!(with(&rig, &nan).is_err());
    let wrong = VerifyConfig { significance: f64::NAN };
    assert!(verify(&rig, &seen, &panel(), 1.0, wrong).is_err());
    // Another sheet has no first view to be compared with.
    let other = Rig { views: Vec::new(), ..rig };
    assert!(with(&other, &seen).unwrap().sheet.is_none());
}

/// The same sheets, each bent as paper is.
fn bent(model: &Model, rng: &mut ChaCha8Rng) -> Model {
    let mut bent = model.clone();
    for view in &mut bent.views {
        let draw = |sigma: f64| Normal::new(0.0, sigma).unwrap().sample(rng);
        view.bend = SheetBend(Flatness::Paper.sigmas_mm(view.size).map(draw));
    }
    bent
}

#[test]
fn a_bent_photograph_against_a_rig_of_bent_photographs_is_not_called_moved() {
    let mut rng = rng(12);
    let (mut alarms, mut alarms_of_flat) = (0, 0);
    let flat_sheets = CalibrateConfig { flatness: Flatness::Flat, ..CalibrateConfig::default() };
    for _ in 0..6 {
        let model = bent(&two_views(), &mut rng);
        let elsewhere = bent(&Model { views: vec![flat(pose(-12.0, 20.0))], ..model.clone() }, &mut rng);
        let seen = photograph(&elsewhere, &mut rng);
        let rig = calibrated_under(&CalibrateConfig::default(), &model, &mut rng);
        alarms += usize::from(run(&rig, &seen).rig.moved);
        alarms_of_flat +=
            usize::from(run(&calibrated_under(&flat_sheets, &model, &mut rng), &seen).rig.moved);
        // A turn of half a degree shows all the same.
        let mut turned = elsewhere;
        let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), 0.5_f64.to_radians());
        let p = turned.projector_from_camera;
        turned.projector_from_camera =
            Pose { rotation: turn * p.rotation, translation: turn * p.translation };
        assert!(run(&rig, &photograph(&turned, &mut rng)).rig.moved);
    }
    // More than one of 6 at 1 % happens in 1.5 of a thousand.
    assert!(alarms <= 1 && alarms_of_flat >= 4, "{alarms} and {alarms_of_flat} of 6");
}
