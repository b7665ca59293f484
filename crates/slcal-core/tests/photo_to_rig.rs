//! Rendered photograph → rig, against the truth of the scene; skipped where the scenes are not at hand.

#[path = "../src/for_tests/rendered_scenes.rs"]
mod rendered_scenes;

use std::path::Path;

use rendered_scenes::rendered_scenes;
use slcal_core::detect::{DetectConfig, observe};
use slcal_core::format::{read_pattern, read_rig};
use slcal_core::geometry::RectangleSize;
use slcal_core::pattern::Pattern;
use slcal_core::photo::PhotoView;
use slcal_core::{
    CalibrateConfig, DistortionModel, ErrorClass, Flatness, Method, Observations, PrincipalPointRule, Rig,
    Verdict, calibrate_observations,
};

fn seen(folder: &Path) -> Observations {
    let file = std::fs::File::open(folder.join("patterns/checker.json")).unwrap();
    let Pattern::Checker(pattern) = read_pattern(file).unwrap() else { panic!("not a checkerboard") };
    let image = ["checker.png", "checker.jpg"].map(|name| folder.join(name));
    let image = image::open(image.iter().find(|path| path.exists()).unwrap()).unwrap();
    let view = PhotoView::try_from(&image).unwrap();
    let size = RectangleSize::new(594.0, 420.0).unwrap();
    let found = observe(view, None, size, Some(&pattern), &DetectConfig::default()).unwrap();
    Observations {
        camera: [image.width(), image.height()],
        projector: Some(pattern.projector),
        mirrored: false,
        views: vec![found.observation],
    }
}

fn truth(folder: &Path) -> Rig {
    read_rig(std::fs::File::open(folder.join("truth_rig.json")).unwrap()).unwrap()
}

/// Errors of f_cam and f_proj in per cent, of cy_proj in px.
fn errors(found: &Rig, truth: &Rig) -> [f64; 3] {
    let percent = |a: f64, b: f64| 100.0 * (a / b - 1.0);
    let (p, q) =
        (found.projector.unwrap().device.model.intrinsics, truth.projector.unwrap().device.model.intrinsics);
    [
        percent(found.camera.model.intrinsics.fx, truth.camera.model.intrinsics.fx),
        percent(p.fx, q.fx),
        p.cy - q.cy,
    ]
}

#[test]
fn one_photograph_gives_the_focal_lengths() {
    for (name, limits) in [
        ("paper_tilted", [0.1, 0.4, 4.0]),
        ("paper_lensshift", [0.1, 0.5, 4.0]),
        ("dark_clutter", [0.3, 0.6, 8.0]),
    ] {
        let Some(folder) = rendered_scenes(name) else { return };
        let config = CalibrateConfig {
            flatness: Flatness::Flat,
            distortion: DistortionModel::None,
            projector_distortion: DistortionModel::None,
            ..CalibrateConfig::default()
        };
        let c = calibrate_observations(&seen(&folder), &config).unwrap();
        let found = errors(&c.rig, &truth(&folder));
        for (error, limit) in found.iter().zip(limits) {
            assert!(error.abs() <= limit, "{name}: {found:?}");
        }
    }
}

#[test]
fn two_vanishing_points_say_when_the_projector_is_shifted() {
    let two_vp = CalibrateConfig { method: Method::TwoVp, ..CalibrateConfig::default() };
    let Some(folder) = rendered_scenes("paper_tilted") else { return };
    let found = errors(&calibrate_observations(&seen(&folder), &two_vp).unwrap().rig, &truth(&folder));
    assert!(found[0].abs() < 0.5 && found[1].abs() < 1.0, "{found:?}");
    let Some(folder) = rendered_scenes("paper_lensshift") else { return };
    match calibrate_observations(&seen(&folder), &two_vp) {
        Err(e) => assert_eq!(e.class(), ErrorClass::Degenerate, "{e}"),
        Ok(c) => {
            let quality = c.rig.quality.as_ref().unwrap();
            assert!(quality.warnings.iter().any(|w| w.code == "two-vp-misfit"), "{quality:?}");
            assert!(quality.verdict >= Verdict::Weak);
            assert!(errors(&c.rig, &truth(&folder))[1].abs() > 20.0);
        }
    }
}

#[test]
fn a_face_on_photograph_needs_the_principal_points() {
    let Some(folder) = rendered_scenes("near_frontal") else { return };
    let view = seen(&folder);
    let error = calibrate_observations(&view, &CalibrateConfig::default()).unwrap_err();
    assert_eq!(error.class(), ErrorClass::Degenerate);
    let exact = CalibrateConfig {
        camera_pp: PrincipalPointRule::Exact(639.5, 479.5),
        projector_pp: PrincipalPointRule::Exact(511.5, 383.5),
        ..CalibrateConfig::default()
    };
    let c = calibrate_observations(&view, &exact).unwrap();
    let found = errors(&c.rig, &truth(&folder));
    let sigma = c.rig.quality.unwrap().focal_sigma_percent_camera;
    assert!(found[0].abs() < 3.0 * sigma, "{found:?}, σ {sigma}");
}

#[test]
fn two_views_with_the_tilt_reversed_are_taken_together() {
    let (Some(a), Some(b)) = (rendered_scenes("pair_a"), rendered_scenes("pair_b")) else { return };
    let mut both = seen(&a);
    both.views.extend(seen(&b).views);
    let c = calibrate_observations(&both, &CalibrateConfig::default()).unwrap();
    let found = errors(&c.rig, &truth(&a));
    let d = c.rig.camera.model.distortion;
    assert!(found[0].abs() < 0.1 && found[1].abs() < 0.2, "{found:?}");
    assert!((d.k1 + 0.12).abs() < 0.01, "{d:?}");
}

#[test]
fn the_channels_of_realistic_photographs_are_registered() {
    // Displacements of the channels: those of the primaries, mixed by the crosstalk that the scenes were rendered with.
    let mild = [[0.267, -0.168], [-0.209, 0.253]];
    let strong = [[0.445, -0.280], [-0.348, 0.422]];
    for (name, truth) in [
        ("real_mild_a", mild),
        ("real_mild_b", mild),
        ("real_tang_a", strong),
        ("real_tang_b", strong),
        ("real_grid", strong),
    ] {
        let Some(folder) = rendered_scenes(name) else { return };
        let rig = calibrate_observations(&seen(&folder), &CalibrateConfig::default()).unwrap().rig;
        let r = rig.channel_registration.unwrap();
        let (found, sigma) = (r.displacements.projector, r.sigma.projector);
        for (found, sigma, truth) in [(found.red, sigma.red, truth[0]), (found.blue, sigma.blue, truth[1])] {
            for k in 0..2 {
                let error = found.shift_px[k] - truth[k];
                assert!(
                    error.abs() < 0.04 && error.abs() < 2.5 * sigma.shift_px[k],
                    "{name}: {found:?} for {truth:?}"
                );
            }
        }
    }
}
