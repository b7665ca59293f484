//! `slcal-simulate-noise/1`: the synthetic experiment, with its configuration.

use serde::Serialize;

use crate::simulate::{NoiseConfig, NoiseReport};

#[derive(Serialize)]
struct Experiment<'a> {
    schema: &'static str,
    config: &'a NoiseConfig,
    #[serde(flatten)]
    report: &'a NoiseReport,
}

/// The experiment that `config` describes and what came out of it.
#[must_use]
pub fn noise_experiment<'a>(config: &'a NoiseConfig, report: &'a NoiseReport) -> impl Serialize + use<'a> {
    Experiment { schema: "slcal-simulate-noise/1", config, report }
}
