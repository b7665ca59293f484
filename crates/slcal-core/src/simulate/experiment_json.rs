//! `slcal-simulate-noise/1`: the synthetic experiment, with its configuration.

use serde::Serialize;

use super::{NoiseConfig, NoiseReport};

#[derive(Serialize)]
struct Experiment<'a> {
    schema: &'static str,
    config: &'a NoiseConfig,
    #[serde(flatten)]
    report: &'a NoiseReport,
}

impl NoiseReport {
    /// The record of the experiment that `config` describes.
    #[must_use]
    pub fn to_json<'a>(&'a self, config: &'a NoiseConfig) -> impl Serialize + use<'a> {
        Experiment { schema: "slcal-simulate-noise/1", config, report: self }
    }
}
