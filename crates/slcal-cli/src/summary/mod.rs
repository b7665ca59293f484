//! Results in words, for people: the verdict first, then numbers, and what to do at the end, where the eye lies.

mod advice;
mod calibration;
mod cloud;
mod decoding;
mod noise_experiment;
mod number;
mod surface_fit;
mod verdict;
mod verification;

pub(crate) use advice::advice;
pub(crate) use calibration::calibration;
pub(crate) use cloud::{cloud, cloud_in_a_line, reconstruction};
pub(crate) use decoding::{decoding, remarks};
pub(crate) use noise_experiment::noise_experiment;
pub(crate) use number::unsigned;
pub(crate) use surface_fit::{plane_fit, sphere_fit};
pub(crate) use verdict::verdict;
pub(crate) use verification::{rig_in_words, verification};
