use super::*;
use crate::calibrate::tests::scene::{ideal, observe, pose, rig, rng, with_edges};
use crate::calibrate::{PrincipalPointRule, calibrate_observations, residuals};
use crate::rig::Device;

fn unstated(mut observations: Observations) -> Observations {
    observations.views.iter_mut().for_each(|v| v.map_sigma(|_| None, |_| None));
    observations
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
                let seen = unstated(observe(&truth, 0.2, sigma, &mut rng));
                let done = calibrate_observations(&seen, &ideal()).unwrap();
                let corners = found(&done.noise, NoiseOf::SheetCorners);
                assert_eq!((corners.redundancy, corners.sigma_px), (None, ASSUMED * 1600.0));
                let warnings = done.rig.quality.unwrap().warnings;
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
        let seen = unstated(observe(&truth, sigma, 0.1, &mut rng(8)));
        let (_, noise) = measure_noise(&seen, &ideal());
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
    let (_, noise) = measure_noise(&independent, &CalibrateConfig::default());
    let alone = found(&noise, NoiseOf::SheetEdges).sigma_px;
    assert!((alone / 0.04 - 1.0).abs() < 0.1, "{alone}");
    // Each point five times: the same information, five times the points.
    let SheetObservation::Edges(sides) = &mut independent.views[0].sheet else { panic!() };
    for side in sides {
        *side = side.iter().flat_map(|p| [*p; 5]).collect();
    }
    let (_, noise) = measure_noise(&independent, &CalibrateConfig::default());
    let repeated = found(&noise, NoiseOf::SheetEdges).sigma_px;
    assert!((0.8..1.6).contains(&(repeated / (0.04 * 5_f64.sqrt()))), "{repeated}");
}

#[test]
fn what_is_stated_stays_and_filled_in_observations_give_the_same_rig() {
    let truth = rig(768.0, vec![pose(25.0, 28.0)]);
    let mut seen = observe(&truth, 0.2, 0.1, &mut rng(9));
    seen.views[0].map_sigma(|s| s, |_| None);
    let config = CalibrateConfig::default();
    let done = calibrate_observations(&seen, &config).unwrap();
    let SheetObservation::Corners { sigma_px, .. } = done.observations.views[0].sheet else { panic!() };
    assert_eq!(sigma_px, Some(0.2));
    assert_eq!(done.noise.len(), 1);
    let again = calibrate_observations(&done.observations, &config).unwrap();
    assert_eq!((&again.rig, again.observations), (&done.rig, done.observations));
    assert!(again.noise.is_empty());
}

#[test]
fn intervals_hold_the_truth_though_no_noise_was_stated() {
    // Exact principal points, so that the noise alone decides; six views, so that all of it is measured.
    let config = CalibrateConfig {
        camera_pp: PrincipalPointRule::Centre,
        projector_pp: PrincipalPointRule::Exact(511.5, 768.0),
        ..ideal()
    };
    let poses: Vec<_> = [25.0, -25.0, 12.0].iter().flat_map(|x| [28.0, -20.0].map(|y| pose(*x, y))).collect();
    let truth = rig(768.0, poses);
    let mut rng = rng(31);
    let n = 150;
    let mut held = [0; 2];
    for _ in 0..n {
        let done = calibrate_observations(&unstated(observe(&truth, 0.2, 0.1, &mut rng)), &config).unwrap();
        assert!(done.noise.iter().all(|n| n.redundancy.is_some()), "{:?}", done.noise);
        let holds = |d: &Device, f: f64| (d.model.intrinsics.fx - f).abs() < 1.96 * d.sigma.unwrap().focal_px;
        held[0] += i32::from(holds(&done.rig.camera, 1500.0));
        held[1] += i32::from(holds(&done.rig.projector.unwrap().device, 1700.0));
    }
    // 95 % less three binomial σ (1.8 %).
    assert!(held.iter().all(|h| f64::from(*h) / f64::from(n) > 0.895), "{held:?} of {n}");
}

#[test]
fn one_wrong_pair_does_not_count_as_noise() {
    let truth = rig(768.0, vec![pose(25.0, 28.0)]);
    let mut seen = unstated(observe(&truth, 0.2, 0.1, &mut rng(12)));
    seen.views[0].pairs[20].camera.x += 40.0;
    let (_, noise) = measure_noise(&seen, &CalibrateConfig::default());
    let pairs = found(&noise, NoiseOf::Pairs).sigma_px;
    assert!((pairs / 0.1 - 1.0).abs() < 0.25, "{pairs}");
}

#[test]
fn four_pairs_tell_nothing_of_their_noise() {
    let truth = rig(768.0, vec![pose(25.0, 28.0)]);
    let mut seen = unstated(observe(&truth, 0.2, 0.1, &mut rng(12)));
    let pairs = &mut seen.views[0].pairs;
    *pairs = [0, 8, 45, 53].map(|i| pairs[i]).to_vec();
    let done = calibrate_observations(
        &seen,
        &CalibrateConfig { allow_degenerate: true, ..CalibrateConfig::default() },
    )
    .unwrap();
    assert!(done.noise.iter().all(|n| n.redundancy.is_none()), "{:?}", done.noise);
    seen.views[0].pairs.clear();
    assert!(calibrate_observations(&seen, &CalibrateConfig::default()).is_err());
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
    let seen = unstated(stated.clone());
    let rig = calibrate_observations(&stated, &CalibrateConfig::default()).unwrap().rig;
    for found in residuals(&rig, &seen).unwrap() {
        let [edges, pairs] = [found.sheet[0].sigma_px, found.pairs[0].camera.sigma_px];
        assert!((edges / 0.06 - 1.0).abs() < 0.15 && (pairs / 0.02 - 1.0).abs() < 0.2, "{edges} {pairs}");
        assert!((0.8..1.25).contains(&found.sheet_scatter), "{}", found.sheet_scatter);
        assert!((0.8..1.25).contains(&found.pair_scatter.unwrap()));
    }
    // What is stated stays.
    let views = residuals(&rig, &stated).unwrap();
    assert!(views.iter().all(|v| v.sheet[0].sigma_px == 0.06 && v.pairs[0].camera.sigma_px == 0.02));
}
