//! Whether 95 % intervals hold the truth in 95 % of draws, by draws of the noise, and of what the priors leave open,
//! through the public function.

use super::scene::ideal;
use super::study::{Drawn, Scenario, run};
use crate::calibrate::{CalibrateConfig, DistortionModel, PrincipalPointRule};

const DRAWS: usize = 2000;
/// What is promised. The share of 2000 draws is itself known to 0.5 %.
const TRUE: std::ops::RangeInclusive<f64> = 0.93..=0.97;
/// Of the baseline where the principal points are uncertain, see [`one_photograph_with_principal_points_drawn`].
const BASELINE_OF_ONE: std::ops::RangeInclusive<f64> = 0.93..=0.99;

/// 95 % of so many draws less and more three binomial σ of 1.1 %.
const FEW: usize = 400;
const TRUE_OF_FEW: std::ops::RangeInclusive<f64> = 0.917..=0.983;
const BASELINE_OF_ORDINARY_ONE: std::ops::RangeInclusive<f64> = 0.917..=0.999;

const WELL_TILTED: [(f64, f64); 2] = [(25.0, 28.0), (-25.0, -28.0)];

/// Principal points held at the truth.
fn held() -> CalibrateConfig {
    CalibrateConfig {
        camera_pp: PrincipalPointRule::Centre,
        projector_pp: PrincipalPointRule::Exact(511.5, 768.0),
        ..ideal()
    }
}

fn with(distortion: DistortionModel, config: &CalibrateConfig) -> CalibrateConfig {
    CalibrateConfig { distortion, ..config.clone() }
}

fn drawn(pp_share: f64, k1: f64, scenario: Scenario) -> Scenario {
    Scenario { drawn: Drawn { pp_share, k: [k1, 0.0], ..Drawn::default() }, ..scenario }
}

type Range = std::ops::RangeInclusive<f64>;

fn check(scenario: &Scenario, config: &CalibrateConfig, baseline: &Range) {
    held_in(DRAWS, scenario, config, [&TRUE, baseline]);
}

fn ordinary(scenario: &Scenario, baseline: &Range) {
    held_in(FEW, scenario, &CalibrateConfig::default(), [&TRUE_OF_FEW, baseline]);
}

fn held_in(draws: usize, scenario: &Scenario, config: &CalibrateConfig, [all, baseline]: [&Range; 2]) {
    let outcome = run(scenario, config, draws, 2);
    assert_eq!(outcome.failed, 0, "{:?}", outcome.first_error);
    for t in &outcome.tallies {
        let range = if t.name == "baseline" { baseline } else { all };
        assert!(
            range.contains(&t.held),
            "{} at {:?} with {:?}: {:.1} % of {}, rms/σ {:.3}, bias/rms {:.3}",
            t.name,
            scenario.tilts,
            scenario.drawn,
            100.0 * t.held,
            t.draws,
            t.rms / t.mean_sigma,
            t.bias / t.rms
        );
    }
}

#[test]
fn one_photograph_with_principal_points_held() {
    for tilt in [(25.0, 28.0), (-15.0, 20.0)] {
        check(&Scenario::corners(&[tilt]), &held(), &TRUE);
    }
    check(&Scenario::edges(&WELL_TILTED[..1]), &held(), &TRUE);
}

/// The baseline's intervals hold the truth somewhat too often here: focal lengths known to 2 % leave both devices' distance
/// from the sheet uncertain by 20 mm, at right angles to a baseline of 340 mm, whose length that changes to second order
/// only; the first-order σ at the estimate, which is off to one side, takes it for more. (Where the baseline leans along the
/// view the same effect is too small by as much.)
#[test]
fn one_photograph_with_principal_points_drawn() {
    for tilt in [(25.0, 28.0), (-20.0, 30.0)] {
        let scenario = drawn(0.02, 0.0, Scenario::corners(&[tilt]));
        check(&scenario, &ideal(), &BASELINE_OF_ONE);
    }
}

#[test]
fn one_photograph_with_edges_principal_points_and_distortion_drawn() {
    let scenario = drawn(0.02, 0.1, Scenario::edges(&WELL_TILTED[..1]));
    check(&scenario, &with(DistortionModel::K1, &ideal()), &BASELINE_OF_ONE);
}

#[test]
fn two_photographs() {
    check(&Scenario::corners(&WELL_TILTED), &with(DistortionModel::None, &held()), &TRUE);
    let scenario = drawn(0.02, 0.1, Scenario::corners(&WELL_TILTED));
    check(&scenario, &with(DistortionModel::K1, &ideal()), &TRUE);
}

/// Sheets that bend as paper does and lenses as they are, drawn from what is assumed of them.
#[test]
fn one_photograph_of_ordinary_things() {
    let scenario = Scenario { drawn: Drawn::ORDINARY, ..Scenario::edges(&WELL_TILTED[..1]) };
    ordinary(&scenario, &BASELINE_OF_ORDINARY_ONE);
}

#[test]
fn two_photographs_of_ordinary_things() {
    ordinary(&Scenario { drawn: Drawn::ORDINARY, ..Scenario::edges(&WELL_TILTED) }, &TRUE_OF_FEW);
}
