//! What happens to observations that are wrong, repeated, or of unusual size.

use nalgebra::Point2;
use rand::Rng;

use super::scene::{ideal, observe, pose, rig, rng};
use crate::calibrate::*;
use crate::error::{Error, ErrorClass};
use crate::format::write_rig;
use crate::geometry::RectangleSize;
use crate::observations::{Observations, SheetObservation};
use crate::rig::Verdict;

fn good() -> Observations {
    observe(&rig(768.0, vec![pose(25.0, 28.0)]), 0.2, 0.1, &mut rng(1))
}

fn with_size(width_mm: f64, height_mm: f64) -> Observations {
    let mut o = good();
    o.views[0].size = RectangleSize { width_mm, height_mm };
    o
}

fn allowing(method: Method) -> CalibrateConfig {
    CalibrateConfig { method, allow_degenerate: true, ..CalibrateConfig::default() }
}

/// Writing refuses numbers that are not finite.
fn written(calibration: &Calibration) {
    write_rig(&calibration.rig, Vec::new()).unwrap();
}

fn codes(calibration: &Calibration) -> Vec<&str> {
    let quality = calibration.rig.quality.as_ref().unwrap();
    quality.warnings.iter().map(|w| w.code.as_str()).collect()
}

#[test]
fn a_size_with_impossible_proportions_is_refused_with_those_seen() {
    for (w, h) in [(1.0, 1e5), (5940.0, 42.0)] {
        let error = calibrate_observations(&with_size(w, h), &allowing(Method::Ml)).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{error}");
        assert!(error.to_string().contains("as the sheet is seen"), "{error}");
    }
}

#[test]
fn a_size_that_does_not_fit_is_blamed_before_the_tilt() {
    match calibrate_observations(&with_size(420.0, 420.0), &CalibrateConfig::default()) {
        Ok(c) => assert!(c.rig.quality.unwrap().verdict >= Verdict::Fair),
        Err(e) => assert!(e.to_string().contains("size"), "{e}"),
    }
}

#[test]
fn the_unit_of_length_does_not_matter() {
    for method in [Method::Ml, Method::TwoVp] {
        let base = calibrate_observations(&good(), &allowing(method)).unwrap().rig;
        for unit in [1e-6, 1e6] {
            let o = with_size(594.0 * unit, 420.0 * unit);
            let c = calibrate_observations(&o, &allowing(method)).unwrap();
            written(&c);
            let (f, expected) = (c.rig.camera.model.intrinsics.fx, base.camera.model.intrinsics.fx);
            assert!((f / expected - 1.0).abs() < 1e-6, "{method:?} {unit}: {f} {expected}");
            let (b, expected) = (c.rig.baseline_mm().unwrap() / unit, base.baseline_mm().unwrap());
            assert!((b / expected - 1.0).abs() < 1e-5, "{method:?} {unit}: {b} {expected}");
        }
    }
}

#[test]
fn a_free_principal_point_is_undetermined_in_one_photograph_and_says_so() {
    let free = CalibrateConfig { camera_pp: PrincipalPointRule::Free, ..ideal() };
    let error = calibrate_observations(&good(), &free).unwrap_err();
    assert_eq!(error.class(), ErrorClass::Degenerate);
    let said = error.to_string();
    assert!(said.contains("free") && said.contains("a second time"), "{said}");
    let c = calibrate_observations(&good(), &CalibrateConfig { allow_degenerate: true, ..free }).unwrap();
    written(&c);
    assert_eq!(c.rig.quality.unwrap().verdict, Verdict::Degenerate);
}

#[test]
fn a_principal_point_far_from_its_prior_is_found_and_told() {
    // A photograph cropped by 250 px of 1280 on the left: 10 σ of the prior. Two views determine it.
    let truth = rig(768.0, vec![pose(25.0, 28.0), pose(-25.0, -28.0)]);
    let mut o = observe(&truth, 0.2, 0.1, &mut rng(4));
    for view in &mut o.views {
        if let SheetObservation::Corners { corners, .. } = &mut view.sheet {
            for c in corners {
                c.x -= 250.0;
            }
        }
        for p in &mut view.pairs {
            p.camera.x -= 250.0;
        }
    }
    let c = calibrate_observations(&o, &CalibrateConfig::default()).unwrap();
    let quality = c.rig.quality.unwrap();
    assert_eq!(quality.verdict, Verdict::Good);
    assert_eq!(quality.warnings[0].code, "cropped");
    let camera = c.rig.camera;
    let off = (camera.model.intrinsics.cx - (639.5 - 250.0)) / camera.sigma.unwrap().cx_px;
    assert!(off.abs() < 4.0, "{off} σ");
}

#[test]
fn two_vp_refuses_what_it_cannot_estimate() {
    let two_vp = || allowing(Method::TwoVp);
    for config in [
        CalibrateConfig { camera_pp: PrincipalPointRule::Free, ..two_vp() },
        CalibrateConfig { projector_pp: PrincipalPointRule::Free, ..two_vp() },
        CalibrateConfig { distortion: DistortionModel::K1, ..two_vp() },
    ] {
        let error = calibrate_observations(&good(), &config).unwrap_err();
        assert!(error.to_string().contains("two-vp"), "{error}");
    }
}

#[test]
fn the_same_photograph_twice_adds_nothing_and_says_so() {
    let mut o = good();
    let once = calibrate_observations(&o, &CalibrateConfig::default()).unwrap();
    o.views.push(o.views[0].clone());
    let twice = calibrate_observations(&o, &CalibrateConfig::default()).unwrap();
    assert!(codes(&twice).contains(&"poses-alike"), "{:?}", codes(&twice));
    let sigma = |c: &Calibration| c.rig.quality.as_ref().unwrap().focal_sigma_percent_camera;
    assert!(sigma(&twice) > 0.9 * sigma(&once), "{} {}", sigma(&twice), sigma(&once));
    for (c, expected) in
        [(once, "the sheet a second time with its tilt"), (twice, "the sheet once more with")]
    {
        assert!(c.report.advice.contains(expected), "{}", c.report.advice);
    }
}

#[test]
fn wrong_corners_by_hand_are_not_called_good() {
    let mut o = good();
    o.views[0].sheet = SheetObservation::Corners {
        corners: [(-500.0, -400.0), (1700.0, -300.0), (1800.0, 1300.0), (-600.0, 1200.0)]
            .map(|(x, y)| Point2::new(x, y)),
        sigma_px: Some(3.0),
    };
    let c = calibrate_observations(&o, &CalibrateConfig { allow_degenerate: true, ..ideal() }).unwrap();
    written(&c);
    // Either the corners do not fit, or they do with a principal point that no camera has.
    let told = ["sheet-corners-off", "principal-point-far"];
    assert!(codes(&c).iter().any(|c| told.contains(c)), "{:?}", codes(&c));
    let quality = c.rig.quality.unwrap();
    assert!(quality.verdict >= Verdict::Weak);
    assert_eq!((c.report.cause, c.report.advice), (quality.cause, quality.advice));
}

#[test]
fn nothing_panics_and_nothing_is_not_a_number() {
    let mut rng = rng(11);
    let (mut calibrated, mut refused) = (0, 0);
    for k in 0..60 {
        let mut o = good();
        let jolt = 10f64.powi(k % 5);
        let mut shake = |p: &mut Point2<f64>| {
            p.x += rng.random_range(-jolt..jolt);
            p.y += rng.random_range(-jolt..jolt);
        };
        if let SheetObservation::Corners { corners, .. } = &mut o.views[0].sheet {
            corners.iter_mut().for_each(&mut shake);
        }
        o.views[0].pairs.iter_mut().step_by(1 + k as usize % 3).for_each(|p| shake(&mut p.camera));
        let method = if k % 2 == 0 { Method::Ml } else { Method::TwoVp };
        match calibrate_observations(&o, &allowing(method)) {
            Ok(c) => {
                written(&c);
                calibrated += 1;
            }
            Err(e) => {
                assert!(!e.to_string().contains("NaN"), "{e}");
                refused += 1;
            }
        }
    }
    assert!(calibrated > 10 && refused > 5, "{calibrated} {refused}");
}
