use nalgebra::DMatrix;

use super::model::priors;
use super::*;
use crate::calibrate::tests::scene::{observe, pose, rig, rng, with_edges};
use crate::calibrate::{CalibrateConfig, DistortionModel, PrincipalPointRule};
use crate::geometry::Distortion;

fn joint(model: &Model, config: &CalibrateConfig, edges: bool, noise: f64) -> Joint {
    let mut rng = rng(7);
    let mut observations = observe(model, noise, noise, &mut rng);
    if edges {
        observations = with_edges(observations, model, 9, noise, &mut rng);
    }
    let layout = Layout::new(config, true, model.views.len());
    let priors = priors(config, &layout, model);
    Joint::new(
        vec![observations.views[0].size; model.views.len()],
        measurements(&observations),
        layout,
        priors,
    )
}

/// Largest difference between the analytic and the numeric Jacobian, relative to the largest entry of the column.
fn largest_error(joint: &Joint, model: &Model) -> f64 {
    let analytic = joint.at(model).unwrap().jacobian;
    let full = in_full(joint, &analytic);
    let mut worst: f64 = 0.0;
    for c in 0..joint.layout.len {
        let largest = full.column(c).amax();
        // Moves the points by about a thousandth of a pixel.
        let h = 1e-3 / joint.measurements[0].sigma_px / largest;
        let at = |s: f64| {
            let mut d = DVector::zeros(joint.layout.len);
            d[c] = s * h;
            joint.at(&joint.step(model, &d).unwrap()).unwrap().residuals
        };
        let numeric = (at(1.0) - at(-1.0)) / (2.0 * h);
        worst = worst.max((numeric - full.column(c)).amax() / largest);
    }
    worst
}

/// A Jacobian with a column for every unknown.
fn in_full(joint: &Joint, jacobian: &DMatrix<f64>) -> DMatrix<f64> {
    let shared = joint.layout.views;
    let mut full = DMatrix::zeros(jacobian.nrows(), joint.layout.len);
    full.view_mut((0, 0), (jacobian.nrows(), shared)).copy_from(&jacobian.columns(POSE, shared));
    let mut at = 0;
    for (m, block) in joint.measurements.iter().zip(&joint.blocks) {
        let own = jacobian.view((at, 0), (block.len, POSE));
        full.view_mut((at, joint.layout.view(m.view)), (block.len, POSE)).copy_from(&own);
        at += block.len;
    }
    full
}

#[test]
fn jacobian_agrees_with_finite_differences() {
    let config = CalibrateConfig {
        distortion: DistortionModel::Full,
        projector_distortion: DistortionModel::Full,
        camera_pp: PrincipalPointRule::Free,
        ..CalibrateConfig::default()
    };
    let poses = || vec![pose(20.0, 25.0), pose(-15.0, 5.0)];
    for edges in [false, true] {
        // Far from the data: residuals of several pixels.
        let mut model = rig(768.0, poses());
        model.camera.intrinsics.skew = 3.0;
        model.camera.intrinsics.fy *= 1.01;
        for strength in [0.0, 0.3, 1.0] {
            let lens = Distortion { k1: -0.4, k2: 0.3, p1: 8e-3, p2: -6e-3, k3: 0.2 };
            model.camera.distortion = Distortion::from_array(lens.to_array().map(|k| k * strength));
            let mut projector = model.projector.unwrap();
            let lens = Distortion { k1: 0.2, k2: -0.1, p1: -5e-3, p2: 4e-3, k3: 0.1 };
            projector.distortion = Distortion::from_array(lens.to_array().map(|k| k * strength));
            projector.intrinsics.skew = -2.0;
            model.projector = Some(projector);
            let problem = joint(&model, &config, edges, 3.0);
            let worst = largest_error(&problem, &model);
            assert!(worst < 1e-6, "edges {edges}, strength {strength}: {worst}");
        }
    }
}
