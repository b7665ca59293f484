//! The experiment against closed-form expectations.

use super::*;

fn run(config: NoiseConfig) -> NoiseReport {
    NoiseExperiment::new(config).unwrap().run(|_| ControlFlow::Continue(())).unwrap().unwrap()
}

fn at(level_px: f64, draws: usize) -> NoiseConfig {
    NoiseConfig { levels_px: vec![level_px], draws, ..NoiseConfig::default() }
}

#[test]
fn without_noise_both_methods_are_exact() {
    for (tilt, shift) in [((25.0, 28.0), 0.0), ((-15.0, 20.0), 0.5)] {
        let rig = RigConfig { lens_shift: shift, ..RigConfig::default() };
        let report = run(NoiseConfig { rig, pose: PoseConfig::tilted(tilt.0, tilt.1), ..at(0.0, 1) });
        for m in report.levels[0].methods {
            assert_eq!((m.imaginary, m.refused, m.failed, m.cube_missed), (0, 0, 0, 0));
            assert!(m.camera_focal_px.rms.unwrap() < 1e-6, "{m:?}");
            assert!(m.projector_focal_px.rms.unwrap() < 1e-6, "{m:?}");
            assert!(m.translation_mm.rms.unwrap() < 1e-6, "{m:?}");
            assert!(m.camera_reprojection_px.mean.unwrap() < 1e-6, "{m:?}");
            assert!(m.projector_reprojection_px.mean.unwrap() < 1e-6, "{m:?}");
            assert!(m.cube_position_percent.mean.unwrap() < 1e-6, "{m:?}");
        }
    }
}

#[test]
fn maximum_likelihood_reaches_the_bound() {
    let draws = 500;
    let report = run(at(0.2, draws));
    let level = &report.levels[0];
    let ml = level.methods[1];
    assert_eq!((ml.imaginary, ml.refused, ml.failed), (0, 0, 0));
    // An rms of n values has the relative σ 1/√(2n); the test takes four of those.
    let tolerance = 4.0 / (2.0 * draws as f64).sqrt();
    for (found, bound) in [
        (ml.camera_focal_px.rms, level.bound.camera_focal_px),
        (ml.projector_focal_px.rms, level.bound.projector_focal_px),
        (ml.translation_mm.rms, level.bound.translation_mm),
    ] {
        let ratio = found.unwrap() / bound;
        assert!((ratio - 1.0).abs() < tolerance, "{found:?} against {bound}");
    }
}

/// Least squares leaves σ²·(equations − unknowns) of the residuals: 148 equations of 14 unknowns, 74 points.
#[test]
fn residuals_of_maximum_likelihood_match_its_degrees_of_freedom() {
    let report = run(at(0.2, 200));
    let ml = report.levels[0].methods[1];
    let expected = 0.2 * ((148.0 - 14.0) / 74.0_f64).sqrt();
    // 200 draws with 134 degrees of freedom each: four standard errors are 1.7 %.
    let found = ml.camera_reprojection_px.mean.unwrap();
    assert!((found / expected - 1.0).abs() < 0.02, "{found} against {expected}");
}

#[test]
fn two_vanishing_points_fail_for_a_tilt_about_one_axis() {
    let report = run(NoiseConfig { pose: PoseConfig::tilted(30.0, 0.0), ..at(0.2, 60) });
    let [two_vp, ml] = report.levels[0].methods;
    assert!(two_vp.imaginary > 10, "{two_vp:?}");
    assert_eq!((ml.imaginary, ml.failed), (0, 0));
    assert!(ml.camera_focal_px.rms.unwrap() < 0.01 * 1500.0, "{ml:?}");
    assert!(two_vp.camera_focal_px.median.unwrap() > 0.1 * 1500.0, "{two_vp:?}");
}

#[test]
fn two_vanishing_points_fail_for_unknown_lens_shift() {
    let rig = RigConfig { lens_shift: 0.5, ..RigConfig::default() };
    let report = run(NoiseConfig { rig, principal_points: PrincipalPoints::Prior, ..at(0.1, 60) });
    let level = &report.levels[0];
    let [two_vp, ml] = level.methods;
    let off = two_vp.projector_focal_px.median.unwrap_or(f64::INFINITY);
    assert!(two_vp.imaginary > 30 || off > 0.1 * 1700.0, "{two_vp:?}");
    // 60 draws: four standard errors of an rms are 37 %.
    let ratio = ml.projector_focal_px.rms.unwrap() / level.bound.projector_focal_px;
    assert!((ratio - 1.0).abs() < 0.37, "{ratio}");
}

#[test]
fn the_same_seed_gives_the_same_numbers_and_levels_do_not_depend_on_each_other() {
    let two = NoiseConfig { levels_px: vec![0.1, 0.3], draws: 3, ..NoiseConfig::default() };
    let (a, b) = (run(two.clone()), run(two.clone()));
    assert_eq!(a, b);
    let first = run(NoiseConfig { levels_px: vec![0.1], ..two.clone() });
    assert_eq!(first.levels[0], a.levels[0]);
    assert_ne!(run(NoiseConfig { seed: 2, ..two }), a);
}

#[test]
fn a_run_can_be_stopped_between_draws() {
    let config = NoiseConfig { levels_px: vec![0.1, 0.3], draws: 3, ..NoiseConfig::default() };
    let experiment = NoiseExperiment::new(config).unwrap();
    let mut told = Vec::new();
    let stopped = experiment.run(|done| {
        told.push(done);
        if done == 4 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!((stopped, told), (Ok(None), vec![0, 1, 2, 3, 4]));
    assert_eq!(experiment.run(|_| ControlFlow::Break(())), Ok(None));
}

#[test]
fn invalid_values_are_refused() {
    let refused = |config: NoiseConfig, words: &str| {
        let error = NoiseExperiment::new(config).unwrap_err().to_string();
        assert!(error.contains(words), "no \"{words}\" in: {error}");
    };
    refused(at(-0.1, 5), "noise level");
    refused(at(f64::NAN, 5), "noise level");
    refused(at(0.1, 0), "draws per level");
    refused(at(0.1, usize::MAX), "draws per level");
    refused(NoiseConfig { levels_px: vec![], ..NoiseConfig::default() }, "noise levels");
    refused(NoiseConfig { cube_mm: Some(0.0), ..NoiseConfig::default() }, "reference cube");
}
