use super::*;
use crate::calibrate::tests::scene::{observe, pose, rig, rng, with_edges};
use crate::calibrate::{PrincipalPointRule, calibrate_external, calibrate_observations, external_residuals};
use crate::rig::Device;

fn unstated(observations: Observations) -> ExternalObservations {
    let n = observations.views.len();
    let unstated = vec![Unstated { sheet: true, pairs: true }; n];
    ExternalObservations { unstated, ..observations.into() }
}

fn found(noise: &[NoiseFound], of: NoiseOf) -> NoiseFound {
    *noise.iter().find(|n| n.of == of).unwrap()
}

#[test]
fn the_noise_of_pairs_is_measured_and_that_of_four_corners_assumed() {
    let truth = rig(768.0, vec![pose(25.0, 28.0)]);
    for sigma in [0.03, 0.1, 0.5] {
        let mut rng = rng(5);
        // 54 pairs with 8 unknowns: √(2/100)/2 = 7 % per draw, a third of that over ten.
        let draws: Vec<f64> = (0..10)
            .map(|_| {
                let external = unstated(observe(&truth, 0.2, sigma, &mut rng));
                let done = calibrate_external(&external, &CalibrateConfig::default()).unwrap();
                let corners = found(&done.noise, NoiseOf::SheetCorners);
                assert_eq!((corners.redundancy, corners.sigma_px), (None, ASSUMED * 1600.0));
                let warnings = done.calibration.rig.quality.unwrap().warnings;
                assert_eq!(warnings.iter().filter(|w| w.code == "noise-assumed").count(), 1);
                let pairs = found(&done.noise, NoiseOf::Pairs);
                assert!((95.0..=101.0).contains(&pairs.redundancy.unwrap()), "{pairs:?}");
                assert!((pairs.sigma_px / sigma - 1.0).abs() < 0.25, "{pairs:?} for {sigma}");
                (pairs.sigma_px / sigma).powi(2)
            })
            .collect();
        let mean = (draws.iter().sum::<f64>() / 10.0).sqrt();
        assert!((mean - 1.0).abs() < 0.1, "{mean} of {sigma}");
    }
}

#[test]
fn the_noise_of_corners_is_measured_where_there_are_many() {
    let poses =
        [25.0, -25.0, 12.0, -12.0].iter().flat_map(|x| [28.0, -20.0, 5.0].map(|y| pose(*x, y))).collect();
    let truth = rig(768.0, poses);
    for sigma in [0.05, 0.2, 1.0] {
        let external = unstated(observe(&truth, sigma, 0.1, &mut rng(8)));
        let (_, noise) = measure_noise(&external, &CalibrateConfig::default()).unwrap();
        let corners = found(&noise, NoiseOf::SheetCorners);
        // 96 numbers, less about 72 + 5 unknowns where the pairs help little: √(1/2r) is 16 %.
        assert!(corners.redundancy.unwrap() > 10.0, "{corners:?}");
        assert!((corners.sigma_px / sigma - 1.0).abs() < 0.35, "{corners:?} for {sigma}");
        assert!((found(&noise, NoiseOf::Pairs).sigma_px / 0.1 - 1.0).abs() < 0.1, "{noise:?}");
    }
}

#[test]
fn the_noise_of_edges_is_measured_with_what_neighbours_share() {
    let truth = rig(768.0, vec![pose(25.0, 28.0)]);
    let mut rng = rng(3);
    let seen = observe(&truth, 0.2, 0.1, &mut rng);
    let mut independent = unstated(with_edges(seen, &truth, 150, 0.04, &mut rng));
    let (_, noise) = measure_noise(&independent, &CalibrateConfig::default()).unwrap();
    let alone = found(&noise, NoiseOf::SheetEdges).sigma_px;
    assert!((alone / 0.04 - 1.0).abs() < 0.1, "{alone}");
    // Each point five times: the same information, five times the points.
    let SheetObservation::Edges(sides) = &mut independent.observations.views[0].sheet else { panic!() };
    for side in sides {
        *side = side.iter().flat_map(|p| [*p; 5]).collect();
    }
    let (_, noise) = measure_noise(&independent, &CalibrateConfig::default()).unwrap();
    let repeated = found(&noise, NoiseOf::SheetEdges).sigma_px;
    assert!((0.8..1.6).contains(&(repeated / (0.04 * 5_f64.sqrt()))), "{repeated}");
}

#[test]
fn what_is_stated_stays_and_filled_in_observations_give_the_same_rig() {
    let truth = rig(768.0, vec![pose(25.0, 28.0)]);
    let mut external = unstated(observe(&truth, 0.2, 0.1, &mut rng(9)));
    external.unstated[0].sheet = false;
    let config = CalibrateConfig::default();
    let done = calibrate_external(&external, &config).unwrap();
    let SheetObservation::Corners { sigma_px, .. } = done.observations.views[0].sheet else { panic!() };
    assert_eq!(sigma_px, 0.2);
    assert_eq!(done.noise.len(), 1);
    assert_eq!(calibrate_observations(&done.observations, &config).unwrap().rig, done.calibration.rig);
    let stated = ExternalObservations::from(done.observations.clone());
    assert_eq!(calibrate_external(&stated, &config).unwrap().calibration, done.calibration);
}

#[test]
fn intervals_hold_the_truth_though_no_noise_was_stated() {
    // Exact principal points, so that the noise alone decides; six views, so that all of it is measured.
    let config = CalibrateConfig {
        camera_pp: PrincipalPointRule::Centre,
        projector_pp: PrincipalPointRule::Exact(511.5, 768.0),
        distortion: DistortionModel::None,
        ..CalibrateConfig::default()
    };
    let poses: Vec<_> = [25.0, -25.0, 12.0].iter().flat_map(|x| [28.0, -20.0].map(|y| pose(*x, y))).collect();
    let truth = rig(768.0, poses);
    let mut rng = rng(31);
    let n = 150;
    let mut held = [0; 2];
    for _ in 0..n {
        let done = calibrate_external(&unstated(observe(&truth, 0.2, 0.1, &mut rng)), &config).unwrap();
        assert!(done.noise.iter().all(|n| n.redundancy.is_some()), "{:?}", done.noise);
        let holds = |d: &Device, f: f64| (d.model.intrinsics.fx - f).abs() < 1.96 * d.sigma.unwrap().focal_px;
        held[0] += i32::from(holds(&done.calibration.rig.camera, 1500.0));
        held[1] += i32::from(holds(&done.calibration.rig.projector.unwrap().device, 1700.0));
    }
    // 95 % less three binomial σ (1.8 %).
    assert!(held.iter().all(|h| f64::from(*h) / f64::from(n) > 0.895), "{held:?} of {n}");
}

#[test]
fn one_wrong_pair_does_not_count_as_noise() {
    let truth = rig(768.0, vec![pose(25.0, 28.0)]);
    let mut external = unstated(observe(&truth, 0.2, 0.1, &mut rng(12)));
    external.observations.views[0].pairs[20].camera.x += 40.0;
    let (_, noise) = measure_noise(&external, &CalibrateConfig::default()).unwrap();
    let pairs = found(&noise, NoiseOf::Pairs).sigma_px;
    assert!((pairs / 0.1 - 1.0).abs() < 0.25, "{pairs}");
}

#[test]
fn four_pairs_tell_nothing_of_their_noise() {
    let truth = rig(768.0, vec![pose(25.0, 28.0)]);
    let mut external = unstated(observe(&truth, 0.2, 0.1, &mut rng(12)));
    let pairs = &mut external.observations.views[0].pairs;
    *pairs = [0, 8, 45, 53].map(|i| pairs[i]).to_vec();
    let done = calibrate_external(
        &external,
        &CalibrateConfig { allow_degenerate: true, ..CalibrateConfig::default() },
    )
    .unwrap();
    assert!(done.noise.iter().all(|n| n.redundancy.is_none()), "{:?}", done.noise);
    external.observations.views[0].pairs.clear();
    assert!(calibrate_external(&external, &CalibrateConfig::default()).is_err());
}

#[test]
fn thinning_a_grid_keeps_its_rows_and_columns() {
    let mut grid: Vec<(usize, usize)> = (0..1_000_000).map(|i| (i / 1000, i % 1000)).collect();
    thin(&mut grid, 10_000);
    assert_eq!(grid.len(), 10_000);
    let distinct =
        |k: fn(&(usize, usize)) -> usize| grid.iter().map(k).collect::<std::collections::HashSet<_>>().len();
    assert!(
        distinct(|p| p.0) > 990 && distinct(|p| p.1) > 990,
        "{} {}",
        distinct(|p| p.0),
        distinct(|p| p.1)
    );
}

#[test]
fn residuals_of_unstated_noise_are_as_many_sigma_as_of_stated() {
    let truth = rig(768.0, vec![pose(25.0, 28.0), pose(-25.0, -28.0)]);
    let mut rng = rng(12);
    let stated = with_edges(observe(&truth, 0.2, 0.02, &mut rng), &truth, 150, 0.06, &mut rng);
    let mut external = unstated(stated.clone());
    // What a reader puts there.
    for view in &mut external.observations.views {
        view.pairs.iter_mut().for_each(|p| p.sigma_px = 1.0);
        let SheetObservation::Edges(sides) = &mut view.sheet else { panic!() };
        sides.iter_mut().flatten().for_each(|p| p.sigma_px = 1.0);
    }
    let rig = calibrate_observations(&stated, &CalibrateConfig::default()).unwrap().rig;
    let (filled, views) = external_residuals(&rig, &external).unwrap();
    for (view, found) in filled.views.iter().zip(&views) {
        let SheetObservation::Edges(sides) = &view.sheet else { panic!() };
        assert!((sides[0][0].sigma_px / 0.06 - 1.0).abs() < 0.15, "{}", sides[0][0].sigma_px);
        assert!((view.pairs[0].sigma_px / 0.02 - 1.0).abs() < 0.2, "{}", view.pairs[0].sigma_px);
        assert!((0.8..1.25).contains(&found.sheet_scatter), "{}", found.sheet_scatter);
        assert!((0.8..1.25).contains(&found.pair_scatter.unwrap()));
    }
    // What is stated stays.
    let (same, _) = external_residuals(&rig, &stated.clone().into()).unwrap();
    assert_eq!(same, stated);
}
