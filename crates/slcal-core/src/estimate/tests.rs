use nalgebra::{DMatrix, DVector};

use super::assumptions::{DistortionModel, PrincipalPointRule};
use super::residual::{BEND, POSE};
use super::unknowns::SHARED;
use super::*;
use crate::calibrate::tests::scene::{bend, ideal, observe, pose, rig, rng, size, with_edges};
use crate::calibrate::{CalibrateConfig, calibrate_observations};
use crate::geometry::Distortion;
use crate::parameter::{LensParameter, Parameter};
use crate::rig::Device;
use crate::solve::Problem;

fn problem(model: &Model, config: &CalibrateConfig, edges: bool, noise: f64) -> BundleAdjustment {
    let mut rng = rng(7);
    let mut observations = observe(model, noise, noise, &mut rng);
    if edges {
        observations = with_edges(observations, model, 9, noise, &mut rng);
    }
    let unknowns = Unknowns::new(&config.assumptions(), true, model.views.len());
    let priors = Priors::new(&config.assumptions(), &unknowns, model);
    BundleAdjustment::new(measurements(&observations), unknowns, priors)
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
    let (shared, width) = (problem.unknowns.shared, problem.unknowns.width());
    let mut full = DMatrix::zeros(jacobian.nrows(), problem.unknowns.len());
    full.view_mut((0, 0), (jacobian.nrows(), shared)).copy_from(&jacobian.columns(width, shared));
    let of_bends = (0..problem.priors.bends.len()).flat_map(|view| [view; BEND]);
    let views = problem.measurements.iter().map(|m| m.view).chain(of_bends);
    let mut at = 0;
    for (view, block) in views.zip(&problem.blocks) {
        let own = jacobian.view((at, 0), (block.len, width));
        full.view_mut((at, problem.unknowns.view(view)), (block.len, width)).copy_from(&own);
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

/// Two bent sheets, seen and lit by lenses of which nothing is zero.
fn bent_model() -> Model {
    let mut model = rig(768.0, vec![pose(20.0, 25.0), pose(-15.0, 5.0)]);
    for (view, share) in model.views.iter_mut().zip([0.005, 0.01]) {
        view.bend = bend(share * view.size.width_mm);
    }
    model.camera.intrinsics.fy *= 1.004;
    model.camera.distortion = Distortion { k1: -0.2, k2: 0.15, p1: 1e-3, p2: -8e-4, k3: 0.1 };
    let projector = model.projector.as_mut().unwrap();
    projector.intrinsics.fy *= 0.997;
    projector.distortion = Distortion { k1: 0.03, k2: -0.02, p1: -4e-4, p2: 3e-4, k3: 0.01 };
    model
}

#[test]
fn jacobian_of_bent_sheets_agrees_with_finite_differences() {
    let model = bent_model();
    for flatness in [Flatness::Paper, Flatness::Flat] {
        let config = CalibrateConfig { flatness, ..CalibrateConfig::default() };
        for edges in [false, true] {
            // Of the data themselves, and far from them.
            for noise in [0.05, 3.0] {
                let problem = problem(&model, &config, edges, noise);
                let worst = largest_error(&problem, &model);
                assert!(worst < 1e-6, "{flatness}, edges {edges}, {noise} px: {worst}");
            }
        }
    }
}

#[test]
fn an_edge_points_distance_is_that_from_the_image_of_the_bent_side() {
    let model = bent_model();
    let problem = problem(&model, &CalibrateConfig::default(), true, 2.0);
    for (m, miss) in problem.measurements.iter().zip(problem.misses_px(&model).unwrap()) {
        let Target::Edge(side) = m.of else { continue };
        let corners = size().corners();
        let (a, b) = (corners[side as usize], corners[(side as usize + 1) % 4]);
        let seen = |k: i32| {
            let p = a + (b - a) * (f64::from(k) / 20_000.0);
            model.camera.project(&model.views[m.view].lift_fixed(p)).unwrap()
        };
        let nearest = (0..=20_000).map(|k| (seen(k) - m.seen).norm()).fold(f64::MAX, f64::min);
        // Points 0.04 px apart.
        assert!((nearest - miss.norm()).abs() < 1e-3 + 4e-4 / nearest, "{nearest} {}", miss.norm());
    }
}

#[test]
fn bends_are_held_by_their_priors() {
    let model = bent_model();
    let problem = problem(&model, &CalibrateConfig::default(), true, 0.1);
    let at = problem.at(&model).unwrap();
    let (first, lenses) =
        (problem.rows() - problem.priors.lenses.len() - 2 * BEND, problem.priors.lenses.len());
    // 0.2 % of A2's diagonal for the three terms of order 2, half of it for the next four, a quarter for the last five.
    let sigma =
        |k: usize| 0.002 * 594f64.hypot(420.0) * [1.0, 0.5, 0.25][usize::from(k > 2) + usize::from(k > 6)];
    for i in 0..2 * BEND {
        let (view, k) = (i / BEND, i % BEND);
        let mut row = in_full(&problem, &at.jacobian).row(first + i).into_owned();
        assert!((at.residuals[first + i] - model.views[view].bend.0[k] / sigma(k)).abs() < 1e-12);
        let c = problem.unknowns.position(&Parameter::Bend(view, k)).unwrap();
        assert!((row[c] - 1.0 / sigma(k)).abs() < 1e-12);
        row[c] = 0.0;
        assert_eq!(row.amax(), 0.0);
    }
    let of_priors = at.residuals.rows(first, 2 * BEND + lenses).norm_squared();
    assert!((problem.priors.chi_squared(&model) / of_priors - 1.0).abs() < 1e-12);
}

#[test]
fn the_covariance_by_blocks_is_that_of_the_full_problem() {
    let model = bent_model();
    for edges in [false, true] {
        let problem = problem(&model, &CalibrateConfig::default(), edges, 0.1);
        let jacobian = problem.at(&model).unwrap().jacobian;
        let full = in_full(&problem, &jacobian);
        let lengths = DVector::from_fn(full.ncols(), |c, _| full.column(c).norm());
        let unit = &full * DMatrix::from_diagonal(&lengths.map(f64::recip));
        let expected = (unit.transpose() * &unit).try_inverse().unwrap();
        let found = crate::solve::covariance(&problem.structure(), &jacobian, &[]).unwrap();
        for i in 0..found.nrows() {
            for k in 0..found.ncols() {
                let scale = (expected[(i, i)] * expected[(k, k)]).sqrt();
                let off = found[(i, k)] * lengths[i] * lengths[k] - expected[(i, k)];
                assert!(off.abs() < 1e-6 * scale, "edges {edges}, {i} {k}: {}", off / scale);
            }
        }
    }
}

#[test]
fn the_factor_of_a_rigs_covariance_gives_it_back() {
    let truth = rig(768.0, vec![pose(25.0, 28.0)]);
    let seen = observe(&truth, 0.05, 0.05, &mut rng(1));
    for (config, width) in [(ideal(), POSE), (CalibrateConfig::default(), POSE + BEND)] {
        let found = calibrate_observations(&seen, &config).unwrap().rig;
        let unknowns = Unknowns::all(1, width > POSE);
        let c = covariance::of_rig(&found, &unknowns).unwrap();
        assert_eq!(c.nrows(), SHARED + width);
        let back = covariance::factor(&c);
        let back = &back * back.transpose();
        for i in 0..c.nrows() {
            for j in 0..c.ncols() {
                let scale = (c[(i, i)] * c[(j, j)]).sqrt();
                assert!((c[(i, j)] - back[(i, j)]).abs() <= 1e-9 * scale, "{i} {j}");
            }
        }
        let sigma = |lens, parameter| {
            let i = unknowns.lens(lens, parameter).unwrap();
            c[(i, i)].sqrt()
        };
        let Device { model, sigma: stated } = found.projector.unwrap().device;
        let stated = stated.unwrap();
        let focal = sigma(Lens::Projector, LensParameter::Focal) * model.intrinsics.fx;
        assert!((focal / stated.focal_px - 1.0).abs() < 1e-9);
        // What was not estimated has no variance.
        assert_eq!(sigma(Lens::Camera, LensParameter::K1) == 0.0, width == POSE);
        assert_eq!(sigma(Lens::Projector, LensParameter::Aspect) == 0.0, width == POSE);
        assert_eq!(sigma(Lens::Projector, LensParameter::Aspect), stated.aspect);
    }
}

#[test]
fn every_unknown_has_its_place() {
    let of = |config: CalibrateConfig| Unknowns::new(&config.assumptions(), true, 2);
    for unknowns in
        [Unknowns::all(3, false), Unknowns::all(3, true), of(ideal()), of(CalibrateConfig::default())]
    {
        let parameters = unknowns.parameters();
        assert_eq!(parameters.len(), unknowns.len());
        for (i, p) in parameters.iter().enumerate() {
            assert_eq!(unknowns.position(p), Some(i), "{p}");
        }
        assert_eq!(unknowns.position(&Parameter::Bend(3, 0)), None);
        assert_eq!(unknowns.position(&Parameter::Bend(0, BEND)), None);
    }
}
