use nalgebra::{DMatrix, DVector};

use super::assumptions::{DistortionModel, PrincipalPointRule};
use super::prior::priors;
use super::residual::POSE;
use super::unknowns::SHARED;
use super::*;
use crate::calibrate::tests::scene::{observe, pose, rig, rng, with_edges};
use crate::calibrate::{CalibrateConfig, calibrate_observations};
use crate::geometry::Distortion;
use crate::parameter::LensParameter;
use crate::solve::Problem;

fn problem(model: &Model, config: &CalibrateConfig, edges: bool, noise: f64) -> BundleAdjustment {
    let mut rng = rng(7);
    let mut observations = observe(model, noise, noise, &mut rng);
    if edges {
        observations = with_edges(observations, model, 9, noise, &mut rng);
    }
    let unknowns = Unknowns::new(&config.assumptions(), true, model.views.len());
    let priors = priors(&config.assumptions(), &unknowns, model);
    let sizes = vec![observations.views[0].size; model.views.len()];
    BundleAdjustment::new(sizes, measurements(&observations), unknowns, priors)
}

/// Largest difference between the analytic and the numeric Jacobian, relative to the largest entry of the column.
fn largest_error(problem: &BundleAdjustment, model: &Model) -> f64 {
    let analytic = problem.at(model).unwrap().jacobian;
    let full = in_full(problem, &analytic);
    let mut worst: f64 = 0.0;
    for c in 0..problem.unknowns.len() {
        let largest = full.column(c).amax();
        // Moves the points by about a thousandth of a pixel.
        let h = 1e-3 / problem.measurements[0].sigma_px / largest;
        let at = |s: f64| {
            let mut d = DVector::zeros(problem.unknowns.len());
            d[c] = s * h;
            problem.at(&problem.step(model, &d).unwrap()).unwrap().residuals
        };
        let numeric = (at(1.0) - at(-1.0)) / (2.0 * h);
        worst = worst.max((numeric - full.column(c)).amax() / largest);
    }
    worst
}

/// A Jacobian with a column for every unknown.
fn in_full(problem: &BundleAdjustment, jacobian: &DMatrix<f64>) -> DMatrix<f64> {
    let shared = problem.unknowns.shared;
    let mut full = DMatrix::zeros(jacobian.nrows(), problem.unknowns.len());
    full.view_mut((0, 0), (jacobian.nrows(), shared)).copy_from(&jacobian.columns(POSE, shared));
    let mut at = 0;
    for (m, block) in problem.measurements.iter().zip(&problem.blocks) {
        let own = jacobian.view((at, 0), (block.len, POSE));
        full.view_mut((at, problem.unknowns.view(m.view)), (block.len, POSE)).copy_from(&own);
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
            let problem = problem(&model, &config, edges, 3.0);
            let worst = largest_error(&problem, &model);
            assert!(worst < 1e-6, "edges {edges}, strength {strength}: {worst}");
        }
    }
}

#[test]
fn the_factor_of_a_rigs_covariance_gives_it_back() {
    let truth = rig(768.0, vec![pose(25.0, 28.0)]);
    let seen = observe(&truth, 0.05, 0.05, &mut rng(1));
    let found = calibrate_observations(&seen, &CalibrateConfig::default()).unwrap().rig;
    let c = covariance::of_rig(&found, &Unknowns::all(1)).unwrap();
    assert_eq!(c.nrows(), SHARED + POSE);
    let back = covariance::factor(&c);
    let back = &back * back.transpose();
    for i in 0..c.nrows() {
        for j in 0..c.ncols() {
            let scale = (c[(i, i)] * c[(j, j)]).sqrt();
            assert!((c[(i, j)] - back[(i, j)]).abs() <= 1e-9 * scale, "{i} {j}");
        }
    }
    let variance = |lens, parameter| {
        let i = Unknowns::all(1).lens(lens, parameter).unwrap();
        c[(i, i)]
    };
    // No distortion was estimated: it has no variance.
    assert_eq!(variance(Lens::Camera, LensParameter::K1), 0.0);
    let sigma = found.projector.unwrap().device.sigma.unwrap();
    let f = found.projector.unwrap().device.model.intrinsics.fx;
    assert!((variance(Lens::Projector, LensParameter::Focal).sqrt() * f / sigma.focal_px - 1.0).abs() < 1e-9);
}

#[test]
fn every_unknown_has_its_place() {
    for unknowns in [Unknowns::all(3), Unknowns::new(&CalibrateConfig::default().assumptions(), true, 2)] {
        let parameters = unknowns.parameters();
        assert_eq!(parameters.len(), unknowns.len());
        for (i, p) in parameters.iter().enumerate() {
            assert_eq!(unknowns.position(p), Some(i), "{p}");
        }
    }
}
