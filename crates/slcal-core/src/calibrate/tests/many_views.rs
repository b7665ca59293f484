//! Ten poses of the sheet at once: what they add, in which order they come, and the projector's distortion.

use super::scene::{ideal, observe, pose, rig, rng, with_edges};
use crate::calibrate::*;
use crate::geometry::Distortion;
use crate::observations::Observations;
use crate::rig::Rig;

/// Ten poses around the camera's axis, tilted by 15° to 35°.
fn ten_poses() -> Vec<crate::geometry::Pose> {
    let at = |k: i32| {
        let (turn, tilt) = (2.4 * f64::from(k), 15.0 + 20.0 * f64::from(k) / 9.0);
        pose(tilt * turn.cos(), tilt * turn.sin())
    };
    (0..10).map(at).collect()
}

fn calibrated(o: &Observations, projector_distortion: DistortionModel) -> Rig {
    calibrate_observations(o, &CalibrateConfig { projector_distortion, ..ideal() }).unwrap().rig
}

/// The error of the projector's focal length, in per cent and in its own σ.
fn projector_focal_error(rig: &Rig) -> (f64, f64) {
    let p = rig.projector.unwrap().device;
    let off = p.model.intrinsics.fx - 1700.0;
    (off / 17.0, off / p.sigma.unwrap().focal_px)
}

#[test]
fn the_projectors_distortion_is_found_and_biases_where_it_is_left_out() {
    let mut truth = rig(768.0, ten_poses());
    let mut projector = truth.projector.unwrap();
    projector.distortion = Distortion { k1: -0.08, ..Distortion::NONE };
    truth.projector = Some(projector);
    let mut rng = rng(5);
    let o = observe(&truth, 0.05, 0.05, &mut rng);
    let o = with_edges(o, &truth, 40, 0.1, &mut rng);
    for model in [DistortionModel::Auto, DistortionModel::K1, DistortionModel::Full] {
        let found = calibrated(&o, model);
        let p = found.projector.unwrap().device;
        let sigma = p.sigma.unwrap().distortion[0];
        let off = (p.model.distortion.k1 + 0.08) / sigma;
        assert!(sigma > 0.0 && sigma < 0.02 && off.abs() < 3.0, "{model:?}: {off} σ of {sigma}");
        let (percent, sigmas) = projector_focal_error(&found);
        assert!(percent.abs() < 0.1 && sigmas.abs() < 3.0, "{model:?}: {percent} %, {sigmas} σ");
        let off = p.model.intrinsics.cy - 768.0;
        assert!(off.abs() < 3.0 && off.abs() < 3.0 * p.sigma.unwrap().cy_px, "{model:?}: {off} px");
        assert!(found.covariance.unwrap().parameters.contains(&"projector.k1".into()));
        assert!(found.camera.model.distortion.is_none());
    }
    // Left out, it moves the principal point, far beyond what σ says.
    let p = calibrated(&o, DistortionModel::None).projector.unwrap().device;
    let off = p.model.intrinsics.cy - 768.0;
    assert!(off.abs() > 20.0 && off.abs() > 10.0 * p.sigma.unwrap().cy_px, "{off} px");
}

#[test]
fn coefficients_by_name_ask_for_three_photographs() {
    let truth = rig(768.0, ten_poses());
    let mut o = observe(&truth, 0.2, 0.1, &mut rng(6));
    o.views.truncate(2);
    let asking = CalibrateConfig { projector_distortion: DistortionModel::K1, ..CalibrateConfig::default() };
    let error = calibrate_observations(&o, &asking).unwrap_err();
    assert!(error.to_string().contains("three photographs"), "{error}");
    o.projector = None;
    assert!(calibrate_observations(&o, &asking).is_ok(), "nothing to distort");
}

#[test]
fn the_order_of_the_photographs_does_not_matter() {
    let named = CalibrateConfig { projector_distortion: DistortionModel::K1K2, ..ideal() };
    order_does_not_matter(&named, 0.0);
    // Where bends are estimated the last digits are left to rounding.
    order_does_not_matter(&CalibrateConfig::default(), 1e-4);
}

/// To a billionth, and to this part of σ.
fn order_does_not_matter(config: &CalibrateConfig, of_sigma: f64) {
    let truth = rig(768.0, ten_poses());
    let mut rng = rng(7);
    let o = observe(&truth, 0.2, 0.1, &mut rng);
    let o = with_edges(o, &truth, 12, 0.2, &mut rng);
    let first = calibrate_observations(&o, config).unwrap().rig;
    let mut orders: Vec<Vec<usize>> = vec![(0..10).rev().collect(), (0..10).map(|i| i * 7 % 10).collect()];
    orders.push((0..10).map(|i| (i * 3 + 4) % 10).collect());
    for order in orders {
        let views = order.iter().map(|&i| o.views[i].clone()).collect();
        let other = calibrate_observations(&Observations { views, ..o.clone() }, config).unwrap().rig;
        let pairs = [
            (first.camera, other.camera),
            (first.projector.unwrap().device, other.projector.unwrap().device),
        ];
        for (a, b) in pairs {
            let sigma = a.sigma.unwrap();
            let off = (a.model.intrinsics.matrix() - b.model.intrinsics.matrix()).amax();
            assert!(off < 1e-6 + of_sigma * sigma.focal_px, "{off}");
            let lens = a.model.distortion.to_array().into_iter().zip(b.model.distortion.to_array());
            for ((a, b), sigma) in lens.zip(sigma.distortion) {
                assert!((a - b).abs() < 1e-9 + of_sigma * sigma, "{a} {b}, {sigma}");
            }
            let [a, b] = [a, b].map(|d| d.sigma.unwrap().focal_px);
            assert!((a / b - 1.0).abs() < 1e-6 + of_sigma, "{a} {b}");
        }
        let [a, b] = [&first, &other].map(|r| r.projector.unwrap().from_camera.pose);
        // Poses are known to a thousandth at best.
        let near = 1e-9 + 1e-3 * of_sigma;
        assert!(a.rotation_vector_from(&b).norm() < near);
        assert!((a.translation - b.translation).norm() < near * a.translation.norm());
        for (k, &i) in order.iter().enumerate() {
            let (a, b) = (first.views[i].camera_from_sheet, other.views[k].camera_from_sheet);
            assert!((a.translation - b.translation).norm() < near * a.translation.norm());
        }
        let [a, b] = [&first, &other].map(|r| r.quality.clone().unwrap());
        assert_eq!(a.verdict, b.verdict);
        let [a, b] = [a, b].map(|q| q.expected_point_sigma_mm.unwrap());
        assert!((a / b - 1.0).abs() < 1e-6 + of_sigma, "{a} {b}");
    }
}

#[test]
fn ten_poses_at_once_beat_the_best_single_one_by_the_root_of_five_and_more() {
    let truth = rig(768.0, ten_poses());
    let o = observe(&truth, 0.2, 0.1, &mut rng(8));
    let sigmas = |o: &Observations| {
        let config = CalibrateConfig { allow_degenerate: true, ..CalibrateConfig::default() };
        let q = calibrate_observations(o, &config).unwrap().rig.quality.unwrap();
        [q.focal_sigma_percent_camera, q.focal_sigma_percent_projector.unwrap()]
    };
    let all = sigmas(&o);
    for view in &o.views {
        let single = sigmas(&Observations { views: vec![view.clone()], ..o.clone() });
        for (one, ten) in single.into_iter().zip(all) {
            assert!(one / ten > 5f64.sqrt(), "{one} {ten}");
        }
    }
}

#[test]
fn views_that_contradict_each_other_are_told_and_never_panic() {
    let truth = rig(768.0, ten_poses());
    let good = observe(&truth, 0.2, 0.1, &mut rng(9));
    // A view of another camera, one of a sheet of half the size, one whose projector was moved, a mirrored pattern.
    let mut other = rig(768.0, ten_poses());
    other.camera.intrinsics.fx *= 0.7;
    other.camera.intrinsics.fy *= 0.7;
    let mut moved = rig(768.0, ten_poses());
    moved.projector_from_camera.translation.x += 120.0;
    let [other, moved] = [other, moved].map(|m| observe(&m, 0.2, 0.1, &mut rng(10)).views[4].clone());
    let mut small = good.views[4].clone();
    small.size = crate::geometry::RectangleSize { width_mm: 297.0, height_mm: 210.0 };
    let mut mirrored = good.views[4].clone();
    for p in &mut mirrored.pairs {
        p.projector.x = 1023.0 - p.projector.x;
    }
    let config = CalibrateConfig {
        projector_distortion: DistortionModel::Auto,
        allow_degenerate: true,
        ..CalibrateConfig::default()
    };
    for (name, strange) in [("other", other), ("moved", moved), ("small", small), ("mirrored", mirrored)] {
        for count in [1, 2, 5] {
            let mut o = good.clone();
            o.views.truncate(count);
            o.views.push(strange.clone());
            match calibrate_observations(&o, &config) {
                Ok(c) => {
                    // Writing refuses what is no number.
                    crate::format::write_rig(&c.rig, Vec::new()).unwrap();
                    let q = c.rig.quality.unwrap();
                    assert!(!q.warnings.is_empty(), "{name} beside {count}: {q:?}");
                }
                Err(e) => assert!(!e.to_string().contains("NaN"), "{e}"),
            }
        }
    }
}
