//! A prior of the focal length: what it improves, and the warning when it is wrong.

use super::scene::{ideal, observe, pose, rig, rng};
use crate::calibrate::*;
use crate::observations::Observations;
use crate::rig::Verdict;

fn expecting(focal_px: f64, sigma_share: f64) -> CalibrateConfig {
    CalibrateConfig { focal_prior: Some(FocalPrior { focal_px, sigma_share }), ..ideal() }
}

fn seen(tilt_x: f64, tilt_y: f64) -> Observations {
    let mut o = observe(&rig(768.0, vec![pose(tilt_x, tilt_y)]), 0.2, 0.1, &mut rng(5));
    o.projector = None;
    o
}

fn sigma(c: &Calibration) -> f64 {
    c.rig.quality.as_ref().unwrap().focal_sigma_percent_camera / 100.0
}

fn codes(c: &Calibration) -> Vec<&str> {
    c.rig.quality.as_ref().unwrap().warnings.iter().map(|w| w.code.as_str()).collect()
}

#[test]
fn an_expected_focal_length_adds_its_information() {
    let without = calibrate_observations(&seen(25.0, 28.0), &ideal()).unwrap();
    let with = calibrate_observations(&seen(25.0, 28.0), &expecting(1520.0, 0.01)).unwrap();
    let expected = (sigma(&without).powi(-2) + 0.01f64.powi(-2)).powf(-0.5);
    assert!((sigma(&with) / expected - 1.0).abs() < 0.05, "{} {expected}", sigma(&with));
    let advised = |c: &Calibration| c.report.advice.clone();
    assert_ne!(advised(&with), advised(&without));
    // What it already knows is not blamed on the principal point.
    assert!(codes(&without).contains(&"principal-point-limited"), "{:?}", codes(&without));
    let narrow = calibrate_observations(&seen(25.0, 28.0), &expecting(1500.0, 0.003)).unwrap();
    assert!(!codes(&narrow).contains(&"principal-point-limited"), "{:?}", codes(&narrow));
}

#[test]
fn an_expected_focal_length_saves_a_view_that_is_degenerate_without() {
    let o = seen(2.0, 1.0);
    assert!(calibrate_observations(&o, &ideal()).is_err());
    let c = calibrate_observations(&o, &expecting(1540.0, 0.03)).unwrap();
    let camera = c.rig.camera;
    assert!((0.028..=0.03).contains(&sigma(&c)), "{}", sigma(&c));
    assert!((camera.model.intrinsics.fx - 1500.0).abs() < 2.0 * camera.sigma.unwrap().focal_px);
    assert!(c.rig.quality.unwrap().warnings.iter().all(|w| w.code != "focal-far-from-prior"));
}

#[test]
fn a_wrong_expectation_is_named() {
    let exact = |c| CalibrateConfig { camera_pp: PrincipalPointRule::Centre, ..c };
    let c = calibrate_observations(&seen(25.0, 28.0), &exact(expecting(1350.0, 0.03))).unwrap();
    assert!(codes(&c).contains(&"focal-far-from-prior"), "{:?}", codes(&c));
    let far = calibrate_observations(&seen(25.0, 28.0), &exact(expecting(1000.0, 0.03))).unwrap();
    assert_eq!(far.rig.quality.unwrap().verdict, Verdict::Weak);
}

#[test]
fn a_known_camera_needs_no_expectation() {
    let truth = rig(768.0, vec![pose(25.0, 28.0)]);
    let known = CalibrateConfig { known_camera: Some(truth.camera), ..expecting(900.0, 0.01) };
    let c = calibrate_observations(&observe(&truth, 0.2, 0.1, &mut rng(5)), &known).unwrap();
    assert_eq!(c.rig.camera.model, truth.camera);
    assert!(!codes(&c).contains(&"focal-far-from-prior"));
}
