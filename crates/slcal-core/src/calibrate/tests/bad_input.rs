//! Observations that contradict each other or their configuration.

use nalgebra::Point2;

use super::scene::{ideal, observe, pose, rig, rng};
use crate::calibrate::*;
use crate::error::Error;
use crate::observations::{Observations, SheetObservation};
use crate::rig::Verdict;

const POSES: [(f64, f64); 4] = [(25.0, 28.0), (-25.0, -20.0), (20.0, -25.0), (-15.0, 25.0)];

fn truth(views: usize) -> crate::estimate::Model {
    rig(768.0, POSES[..views].iter().map(|&(x, y)| pose(x, y)).collect())
}

fn seen(views: usize, seed: u64) -> Observations {
    observe(&truth(views), 0.2, 0.1, &mut rng(seed))
}

fn exact() -> CalibrateConfig {
    CalibrateConfig {
        camera_pp: PrincipalPointRule::Centre,
        projector_pp: PrincipalPointRule::Exact(511.5, 768.0),
        allow_degenerate: true,
        ..ideal()
    }
}

fn lenient() -> CalibrateConfig {
    CalibrateConfig { allow_degenerate: true, ..CalibrateConfig::default() }
}

fn warning_of<'a>(c: &'a Calibration, code: &str) -> Option<&'a crate::rig::Warning> {
    c.rig.quality.as_ref().unwrap().warnings.iter().find(|w| w.code == code)
}

fn codes(c: &Calibration) -> Vec<&str> {
    c.rig.quality.as_ref().unwrap().warnings.iter().map(|w| w.code.as_str()).collect()
}

fn contradicted(o: &Observations) -> Calibration {
    let c = calibrate_observations(o, &lenient()).unwrap();
    assert!(warning_of(&c, "view-contradicts").is_some(), "{:?}", codes(&c));
    assert!(c.rig.quality.as_ref().unwrap().verdict >= Verdict::Weak);
    c
}

#[test]
fn views_that_agree_are_not_suspected() {
    for seed in 0..40 {
        for config in [lenient(), exact()] {
            let c = calibrate_observations(&seen(1 + seed as usize % 4, seed), &config).unwrap();
            for code in ["view-contradicts", "aspect-doubtful", "photograph-repeated"] {
                assert!(warning_of(&c, code).is_none(), "{seed} {:?}", codes(&c));
            }
        }
    }
}

#[test]
fn a_sheet_of_centimetres_is_asked_about() {
    let code = "size-in-centimetres";
    let mut o = seen(2, 3);
    assert!(warning_of(&calibrate_observations(&o, &lenient()).unwrap(), code).is_none());
    for view in &mut o.views {
        view.size.width_mm /= 10.0;
        view.size.height_mm /= 10.0;
    }
    let two_vp = CalibrateConfig { method: Method::TwoVp, ..lenient() };
    o.views.truncate(1);
    for config in [lenient(), two_vp] {
        let c = calibrate_observations(&o, &config).unwrap();
        let warning = warning_of(&c, code).unwrap();
        assert!(warning.message.contains("59.4 x 42.0 mm"), "{}", warning.message);
        assert!(warning.advice.contains("594 x 420 mm"), "{}", warning.advice);
    }
}

#[test]
fn a_view_of_another_sheet_is_named() {
    for odd in 0..4 {
        let mut o = seen(4, 3);
        // The other sheet is a tenth larger: its picture alone is as good as any.
        o.views[odd].size.width_mm *= 1.1;
        o.views[odd].size.height_mm *= 1.1;
        let c = contradicted(&o);
        let said = &warning_of(&c, "view-contradicts").unwrap().message;
        assert!(said.contains(&format!("photograph {} ", odd + 1)), "{said}");
    }
    let mut two = seen(2, 3);
    two.views[1].size.width_mm *= 1.1;
    two.views[1].size.height_mm *= 1.1;
    let said = warning_of(&contradicted(&two), "view-contradicts").unwrap().message.clone();
    assert!(said.contains("1 and 2"), "{said}");
}

#[test]
fn a_view_of_another_pattern_is_named() {
    let mut o = seen(3, 4);
    for p in &mut o.views[1].pairs {
        // Squares of 48 px where 60 were drawn, about the same middle.
        p.projector = Point2::new(511.5, 383.5) + (p.projector - Point2::new(511.5, 383.5)) * 0.8;
    }
    let said = warning_of(&contradicted(&o), "view-contradicts").unwrap().message.clone();
    assert!(said.contains("photograph 2 "), "{said}");
}

#[test]
fn the_same_photograph_counts_once_even_where_noise_decides() {
    let mut o = seen(1, 5);
    let once = calibrate_observations(&o, &exact()).unwrap();
    for _ in 0..3 {
        o.views.push(o.views[0].clone());
    }
    let often = calibrate_observations(&o, &exact()).unwrap();
    assert!(warning_of(&often, "photograph-repeated").is_some(), "{:?}", codes(&often));
    let sigma = |c: &Calibration| {
        let q = c.rig.quality.as_ref().unwrap();
        [q.focal_sigma_percent_camera, q.focal_sigma_percent_projector.unwrap()]
    };
    for (a, b) in sigma(&once).into_iter().zip(sigma(&often)) {
        assert!((b / a - 1.0).abs() < 0.05, "{a} {b}");
    }
    // Two photographs of one pose with noise of their own are two measurements.
    let mut apart = seen(1, 5);
    apart.views.push(seen(1, 6).views[0].clone());
    let c = calibrate_observations(&apart, &exact()).unwrap();
    assert!(warning_of(&c, "photograph-repeated").is_none());
    assert!(sigma(&c)[0] < 0.8 * sigma(&once)[0]);
}

#[test]
fn a_known_camera_of_another_resolution_is_refused() {
    let mut camera = truth(1).camera;
    camera.width *= 2;
    camera.height *= 2;
    let known = CalibrateConfig { known_camera: Some(camera), ..lenient() };
    let error = calibrate_observations(&seen(1, 1), &known).unwrap_err();
    assert!(matches!(error, Error::Invalid { .. }), "{error}");
    assert!(error.to_string().contains("2560x1920") && error.to_string().contains("1280x960"), "{error}");
}

#[test]
fn corners_on_a_line_and_numbers_that_are_none_are_refused_with_the_views_number() {
    let spoil: [fn(&mut [Point2<f64>; 4]); 2] =
        [|c| c[1] = c[0] + (c[2] - c[0]) * 0.5, |c| c[3].y = f64::NAN];
    for spoil in spoil {
        let mut o = seen(2, 1);
        let SheetObservation::Corners { corners, .. } = &mut o.views[1].sheet else { unreachable!() };
        spoil(corners);
        let error = calibrate_observations(&o, &lenient()).unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }), "{error}");
        assert!(error.to_string().contains("view 2"), "{error}");
    }
}

/// The projected corners thinned to a grid of 4×3.
fn few_corners(o: &mut Observations) {
    for view in &mut o.views {
        let all = std::mem::take(&mut view.pairs);
        let keep = |k: usize| [0, 3, 5, 8].contains(&(k % 9)) && [0, 2, 5].contains(&(k / 9));
        view.pairs = all.into_iter().enumerate().filter(|(k, _)| keep(*k)).map(|(_, p)| p).collect();
        assert_eq!(view.pairs.len(), 12);
    }
}

#[test]
fn a_wrong_label_is_outvoted() {
    for (views, few) in [(1, false), (1, true), (3, true)] {
        let mut clean = seen(views, 8);
        if few {
            few_corners(&mut clean);
        }
        let expected = calibrate_observations(&clean, &exact()).unwrap();
        for k in 0..clean.views[0].pairs.len() {
            let mut o = clean.clone();
            let n = o.views[0].pairs.len();
            // The light of a neighbour, and of a corner far away.
            for other in [(k + 1) % n, (k + n / 2) % n] {
                o.views[0].pairs[k].projector = clean.views[0].pairs[other].projector;
                let c = calibrate_observations(&o, &exact()).unwrap();
                let (p, q) = (c.rig.projector.unwrap().device, expected.rig.projector.unwrap().device);
                let off = (p.model.intrinsics.fx - q.model.intrinsics.fx).abs() / q.sigma.unwrap().focal_px;
                assert!(off < 1.0, "{views} views, corner {k} as {other}: {off} σ");
                assert!(c.report.corner_inliers < 1.0, "{views} views, corner {k} as {other} was kept");
            }
        }
    }
}

#[test]
fn wrong_proportions_are_noticed_where_the_principal_point_is_held() {
    for wrong in [0.95, 0.98, 1.01, 1.05] {
        for views in [1, 2] {
            let mut o = seen(views, 9);
            for view in &mut o.views {
                view.size.width_mm *= wrong;
            }
            let c = calibrate_observations(&o, &exact()).unwrap();
            let w = warning_of(&c, "aspect-doubtful");
            let Some(w) = w else { panic!("{wrong} {views}: {:?}", codes(&c)) };
            // "width to height of the sheet is 1.4143 ± 0.0020 as it is seen"
            let numbers: Vec<f64> = w.message.split_whitespace().filter_map(|s| s.parse().ok()).collect();
            let (fits, sigma) = (numbers[0], numbers[1]);
            assert!((fits - 594.0 / 420.0).abs() < 4.0 * sigma, "{wrong} {views}: {}", w.message);
            assert!(c.rig.quality.as_ref().unwrap().verdict >= Verdict::Weak);
        }
    }
}

#[test]
fn a_common_scale_is_never_noticed() {
    let mut o = seen(2, 9);
    for view in &mut o.views {
        view.size.width_mm *= 1.05;
        view.size.height_mm *= 1.05;
    }
    let c = calibrate_observations(&o, &exact()).unwrap();
    assert_eq!(codes(&c), Vec::<&str>::new());
    assert!(
        (c.rig.baseline_mm().unwrap() / truth(1).projector_from_camera.translation.norm() - 1.05).abs()
            < 0.01
    );
}
