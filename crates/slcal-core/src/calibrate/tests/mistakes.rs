//! Ordinary mistakes: named where two photographs tell, told as assumptions with their cost where one does not.

use nalgebra::{Point2, Vector2};
use rand_chacha::ChaCha8Rng;

use super::scene::{observe, pose, rig, rng, with_edges};
use crate::assumption::AssumptionStatus;
use crate::calibrate::{CalibrateConfig, Calibration, PixelAspect, calibrate_observations};
use crate::error::Result;
use crate::estimate::Model;
use crate::observations::{Observations, SheetObservation};
use crate::rig::{DeviceSigma, Verdict};

const NEW: [&str; 5] = [
    "projector-sideways-shift",
    "projector-pixel-aspect",
    "camera-pixel-aspect",
    "cropped",
    "photograph-offset",
];

fn seen(truth: &Model, rng: &mut ChaCha8Rng) -> Observations {
    let o = observe(truth, 0.1, 0.1, rng);
    with_edges(o, truth, 40, 0.1, rng)
}

fn pair() -> Model {
    rig(768.0, vec![pose(25.0, 28.0), pose(-25.0, -28.0)])
}

fn calibrated(o: &Observations) -> Result<Calibration> {
    calibrate_observations(o, &CalibrateConfig::default())
}

fn codes(c: &Calibration) -> Vec<&str> {
    c.rig.quality.as_ref().unwrap().warnings.iter().map(|w| w.code.as_str()).collect()
}

/// Errors of both devices' fx, cx and cy in their own σ.
fn errors(c: &Calibration, truth: &Model) -> Vec<f64> {
    let found = c.rig.projector.unwrap().device;
    let of = |model: crate::geometry::Camera, sigma: Option<DeviceSigma>, truth: crate::geometry::Camera| {
        let (k, t, s) = (model.intrinsics, truth.intrinsics, sigma.unwrap());
        [(k.fx - t.fx) / s.focal_px, (k.cx - t.cx) / s.cx_px, (k.cy - t.cy) / s.cy_px]
    };
    let camera = of(c.rig.camera.model, c.rig.camera.sigma, truth.camera);
    let projector = of(found.model, found.sigma, truth.projector.unwrap());
    camera.into_iter().chain(projector).collect()
}

fn check(c: &Calibration, truth: &Model, code: &str) {
    assert!(codes(c).contains(&code), "{code}: {:?}", codes(c));
    assert_eq!(c.rig.quality.as_ref().unwrap().verdict, Verdict::Good, "{code}");
    let off = errors(c, truth);
    assert!(off.iter().all(|e| e.abs() < 4.0), "{code}: {off:.1?}");
}

/// The projector's principal point moved, and its beam turned back onto the sheet.
fn shifted_sideways(mut truth: Model, px: f64) -> Model {
    let projector = truth.projector.as_mut().unwrap();
    projector.intrinsics.cx += px;
    let turn = nalgebra::Rotation3::from_axis_angle(&nalgebra::Vector3::y_axis(), (px / 1700.0).atan());
    truth.projector_from_camera.rotation = turn * truth.projector_from_camera.rotation;
    truth.projector_from_camera.translation = turn * truth.projector_from_camera.translation;
    truth
}

#[test]
fn a_sideways_shift_is_estimated_from_two_photographs_and_told() {
    for (seed, px) in [(1, 103.0), (2, -150.0), (3, 220.0)] {
        let truth = shifted_sideways(pair(), px);
        let found = calibrated(&seen(&truth, &mut rng(seed))).unwrap();
        check(&found, &truth, "projector-sideways-shift");
    }
}

#[test]
fn one_photograph_tells_what_a_sideways_shift_would_cost() {
    let truth = shifted_sideways(rig(768.0, vec![pose(25.0, 28.0)]), 102.4);
    let found = calibrated(&seen(&truth, &mut rng(4))).unwrap();
    let quality = found.rig.quality.as_ref().unwrap();
    let told = quality.rests_on().find(|a| a.code == "projector-sideways-shift").unwrap();
    assert_eq!(told.status, AssumptionStatus::Assumed);
    let f = found.rig.projector.unwrap().device.model.intrinsics.fx;
    let error = 100.0 * (f / 1700.0 - 1.0).abs();
    // Twice the departure that is priced.
    let cost = 2.0 * told.moves_percent.f_proj.unwrap().abs();
    assert!(error > 3.0 && error < 1.5 * cost, "{error} % against {cost} %");
}

#[test]
fn the_cost_of_an_assumption_is_what_calibrating_under_the_other_one_gives() {
    let truth = rig(768.0, vec![pose(25.0, 28.0)]);
    let o = seen(&truth, &mut rng(5));
    let found = calibrated(&o).unwrap();
    let quality = found.rig.quality.as_ref().unwrap();
    let f = |c: &Calibration| c.rig.projector.unwrap().device.model.intrinsics.fx;
    let of = |code: &str| quality.assumptions.iter().find(|a| a.code == code).unwrap();
    let told = of("shown-1:1").moves_percent.f_proj.unwrap();
    let scaled = |scale: f64| {
        let mut scaled = o.clone();
        for pair in &mut scaled.views[0].pairs {
            let middle = Point2::new(511.5, 383.5);
            pair.projector = middle + (pair.projector - middle) * scale;
        }
        100.0 * (f(&calibrated(&scaled).unwrap()) / f(&found) - 1.0)
    };
    let moved = [scaled(1.0 / 0.95), scaled(2.0 - 1.0 / 0.95)]
        .into_iter()
        .max_by(|a, b| a.abs().total_cmp(&b.abs()))
        .unwrap();
    assert!((told - moved).abs() < 0.1 * moved.abs(), "{told} against {moved}");

    let told = of("size").moves_percent;
    let mut wider = o.clone();
    wider.views[0].size.width_mm *= 1.01;
    let wider = calibrated(&wider).unwrap();
    let moved = 100.0 * (wider.rig.baseline_mm().unwrap() / found.rig.baseline_mm().unwrap() - 1.0);
    assert!(told.worst() > 0.9 * moved.abs(), "{told:?} against {moved}");
}

#[test]
fn two_photographs_turn_assumptions_into_estimates() {
    let statuses = |views| {
        let c = calibrated(&seen(&rig(768.0, views), &mut rng(6))).unwrap();
        let quality = c.rig.quality.unwrap();
        let open = quality.assumptions.iter().filter(|a| a.status == AssumptionStatus::Assumed).count();
        let estimated = |code: &str| {
            quality.assumptions.iter().any(|a| a.code == code && a.status == AssumptionStatus::Estimated)
        };
        (open, ["projector-sideways-shift", "not-cropped"].map(estimated), quality.assumptions.len())
    };
    let (one, of_one, all) = statuses(vec![pose(25.0, 28.0)]);
    let (two, of_two, _) = statuses(vec![pose(25.0, 28.0), pose(-25.0, -28.0)]);
    assert_eq!((of_one, of_two, all), ([false; 2], [true; 2], 9));
    assert!(two + 2 <= one, "{two} {one}");
}

#[test]
fn a_stretched_picture_is_estimated_from_two_photographs_and_told() {
    for (seed, aspect) in [(7, 1.2), (8, 0.8), (9, 1.03)] {
        let mut truth = pair();
        let projector = truth.projector.as_mut().unwrap();
        projector.intrinsics.fx /= aspect;
        let found = calibrated(&seen(&truth, &mut rng(seed))).unwrap();
        check(&found, &truth, "projector-pixel-aspect");
    }
}

#[test]
fn a_ratio_that_is_given_is_held() {
    let mut truth = rig(768.0, vec![pose(25.0, 28.0)]);
    truth.projector.as_mut().unwrap().intrinsics.fx /= 1.2;
    let o = seen(&truth, &mut rng(10));
    let config =
        CalibrateConfig { projector_pixel_aspect: PixelAspect::Ratio(1.2), ..CalibrateConfig::default() };
    let found = calibrate_observations(&o, &config).unwrap();
    let k = found.rig.projector.unwrap().device.model.intrinsics;
    assert!((k.fy / k.fx - 1.2).abs() < 1e-12);
    let off = errors(&found, &truth);
    assert!(off.iter().all(|e| e.abs() < 4.0), "{off:.1?}");
}

/// The panel turned by 90°: what was the row counts as the column.
fn on_its_side(mut truth: Model) -> (Model, impl Fn(Point2<f64>) -> Point2<f64>) {
    let turn =
        nalgebra::Rotation3::from_axis_angle(&nalgebra::Vector3::z_axis(), -std::f64::consts::FRAC_PI_2);
    let projector = truth.projector.as_mut().unwrap();
    let cy = projector.intrinsics.cy;
    (projector.width, projector.height) = (768, 1024);
    (projector.intrinsics.cx, projector.intrinsics.cy) = (cy, 1023.0 - 511.5);
    truth.projector_from_camera.rotation = turn * truth.projector_from_camera.rotation;
    truth.projector_from_camera.translation = turn * truth.projector_from_camera.translation;
    (truth, |q| Point2::new(q.y, 1023.0 - q.x))
}

#[test]
fn a_projector_on_its_side_is_shifted_along_its_rows() {
    for views in [vec![pose(25.0, 28.0)], vec![pose(25.0, 28.0), pose(-25.0, -28.0)]] {
        let upright = rig(768.0, views);
        let mut o = seen(&upright, &mut rng(11));
        let (truth, turned) = on_its_side(upright);
        o.projector = Some([768, 1024]);
        o.views.iter_mut().flat_map(|v| &mut v.pairs).for_each(|p| p.projector = turned(p.projector));
        let found = calibrated(&o).unwrap();
        let off = errors(&found, &truth);
        assert!(off.iter().all(|e| e.abs() < 4.0), "{off:.1?}");
        assert_eq!(found.rig.quality.as_ref().unwrap().verdict, Verdict::Good);
    }
}

#[test]
fn diamond_pixels_are_twice_as_dense_along_y() {
    for views in [vec![pose(25.0, 28.0)], vec![pose(25.0, 28.0), pose(-25.0, -28.0)]] {
        let mut truth = rig(768.0, views);
        let projector = truth.projector.as_mut().unwrap();
        (projector.width, projector.height) = (912, 1140);
        projector.intrinsics =
            crate::geometry::Intrinsics { fx: 850.0, fy: 1700.0, skew: 0.0, cx: 455.5, cy: 1139.5 };
        let mut random = rng(12);
        let o = seen(&truth, &mut random);
        let found = calibrated(&o).unwrap();
        let off = errors(&found, &truth);
        assert!(off.iter().all(|e| e.abs() < 4.0), "{off:.1?}");
        assert!(!codes(&found).contains(&"projector-pixel-aspect"));
    }
}

fn moved(o: &mut Observations, view: usize, by: Vector2<f64>) {
    let view = &mut o.views[view];
    view.pairs.iter_mut().for_each(|p| p.camera += by);
    if let SheetObservation::Edges(sides) = &mut view.sheet {
        sides.iter_mut().flatten().for_each(|p| p.position += by);
    }
}

#[test]
fn photographs_that_were_cropped_off_centre_are_right_from_two() {
    // 1.5 σ of what is expected of principal points, 3.3 σ and 6.4 σ.
    for (left, code) in [(70, None), (150, Some("principal-point-far")), (260, Some("cropped"))] {
        let mut truth = pair();
        let mut o = seen(&truth, &mut rng(13));
        for view in 0..2 {
            moved(&mut o, view, Vector2::new(-f64::from(left), -40.0));
        }
        o.camera = [1280 - left, 920];
        [truth.camera.width, truth.camera.height] = o.camera;
        truth.camera.intrinsics.cx -= f64::from(left);
        truth.camera.intrinsics.cy -= 40.0;
        let found = calibrated(&o).unwrap();
        assert_eq!(codes(&found).first().copied(), code, "{left}");
        let off = errors(&found, &truth);
        assert!(off.iter().all(|e| e.abs() < 4.0), "{left}: {off:.1?}");
    }
}

#[test]
fn stretched_photographs_are_estimated_and_told() {
    let mut truth = pair();
    truth.camera.intrinsics.fy *= 1.02;
    let found = calibrated(&seen(&truth, &mut rng(14))).unwrap();
    check(&found, &truth, "camera-pixel-aspect");
}

#[test]
fn a_photograph_that_is_displaced_is_named_and_refused() {
    for (seed, by) in [(15, Vector2::new(15.0, -10.0)), (16, Vector2::new(-3.0, 2.0))] {
        let mut o = seen(&pair(), &mut rng(seed));
        moved(&mut o, 1, by);
        let error = calibrated(&o).unwrap_err().to_string();
        assert!(error.contains("photograph 2 is displaced"), "{error}");
        let px: Vec<f64> = error.split_whitespace().filter_map(|w| w.parse().ok()).collect();
        let near = |found: f64, true_px: f64| (found - true_px.abs()).abs() < 0.4;
        assert!(near(px[2], by.x) && near(px[3], by.y), "{px:?} {error}");
        let to = if by.x < 0.0 { "to the left" } else { "to the right" };
        assert!(error.contains(to), "{error}");
        let config = CalibrateConfig { allow_degenerate: true, ..CalibrateConfig::default() };
        let found = calibrate_observations(&o, &config).unwrap();
        assert!(codes(&found).contains(&"photograph-offset"));
        assert_eq!(found.rig.quality.unwrap().verdict, Verdict::Degenerate);
    }
    let mut three =
        seen(&rig(768.0, vec![pose(25.0, 28.0), pose(-25.0, -28.0), pose(30.0, -20.0)]), &mut rng(17));
    moved(&mut three, 1, Vector2::new(6.0, 4.0));
    let error = calibrated(&three).unwrap_err().to_string();
    assert!(error.contains("photograph 2 is displaced against those of the others"), "{error}");
}

#[test]
fn two_mistakes_at_once_are_both_named() {
    let mut truth = shifted_sideways(pair(), 150.0);
    truth.projector.as_mut().unwrap().intrinsics.fx /= 1.2;
    let found = calibrated(&seen(&truth, &mut rng(18))).unwrap();
    check(&found, &truth, "projector-sideways-shift");
    check(&found, &truth, "projector-pixel-aspect");
}

#[test]
fn stretched_pictures_and_stretched_photographs_are_not_called_good() {
    let mut truth = pair();
    truth.projector.as_mut().unwrap().intrinsics.fx /= 0.9;
    truth.camera.intrinsics.fy *= 1.03;
    let found = calibrated(&seen(&truth, &mut rng(19))).unwrap();
    // Beside a stretched picture, a sheet of other proportions explains the photographs as well as stretched photographs do.
    assert!(codes(&found).contains(&"camera-pixel-aspect"), "{:?}", codes(&found));
    assert!(found.rig.quality.unwrap().verdict > Verdict::Fair);
}

#[test]
fn right_photographs_are_not_accused() {
    for seed in 0..30 {
        let truth = shifted_sideways(pair(), 20.0 * ((seed as f64) * 0.7).sin());
        let found = calibrated(&seen(&truth, &mut rng(100 + seed))).unwrap();
        assert!(codes(&found).iter().all(|c| !NEW.contains(c)), "{seed}: {:?}", codes(&found));
    }
}
