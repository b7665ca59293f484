//! Results in words: the verdict first, then numbers, and what to do at the end, next to the prompt.

mod advice;
mod calibration;
mod cloud;
mod decoding;
mod noise_experiment;
mod number;
mod sequence;
mod surface_fit;
mod verdict;
mod verification;
pub(crate) mod working_volume;

pub(crate) use advice::advice;
pub(crate) use calibration::{calibration, holds_while};
pub(crate) use cloud::{cloud, cloud_in_a_line, left_out, reconstruction};
pub(crate) use decoding::{decoding, remarks};
pub(crate) use noise_experiment::noise_experiment;
pub(crate) use number::unsigned;
pub(crate) use sequence::sequence;
pub(crate) use surface_fit::surface_fit;
pub(crate) use verdict::verdict;
pub(crate) use verification::{rig_in_words, verification};
