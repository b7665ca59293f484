//! What the stages found, as JSON: the objects that the command prints with `--json` and that the bindings hand out.
//!
//! Each function gives a value to serialise, with the fields in the order in which they are printed; `schema` comes with
//! it where the object stands alone. Lengths are millimetres, angles degrees, as their names say. Numbers that are not
//! finite become null.

mod advice;
mod calibration;
mod cloud;
mod decoding;
mod evaluation;
#[cfg(any(test, feature = "simulate"))]
mod noise_experiment;
#[cfg(any(test, feature = "simulate"))]
mod simulated_scene;
mod verification;

pub use advice::advice;
pub use calibration::calibration;
pub use cloud::{CloudReport, cloud};
pub use decoding::decoding;
pub use evaluation::{plane_evaluation, sphere_evaluation};
#[cfg(any(test, feature = "simulate"))]
pub use noise_experiment::noise_experiment;
#[cfg(any(test, feature = "simulate"))]
pub use simulated_scene::{SceneReport, simulated_scene};
pub use verification::verification;

#[cfg(test)]
mod tests;
