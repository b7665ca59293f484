//! The extension module `slcal._slcal`: thin, frozen classes over the types of the core.
//!
//! `convert` carries values between Python and the core, `errors` its errors, `files` bytes; the other files are the verbs
//! of the work in their order, each with the classes that it takes and gives. Every call of the core runs without the
//! interpreter's lock.

mod advise;
mod calibrate;
mod cloud;
mod convert;
mod decode;
mod dense_matches;
mod detect;
mod errors;
mod evaluate;
mod files;
mod geometry;
mod matches;
mod observations;
mod observe;
mod pattern;
mod photo_tags;
mod read_image;
mod reconstruct;
mod reconstructor;
mod rectify;
mod report;
mod rig;
mod sequence_frames;
mod simulate;
mod verify;
mod view_observation;

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs a command line, the program's name first, and returns its exit code.
#[pyfunction]
#[pyo3(signature = (args, /))]
fn run_command(py: Python<'_>, args: Vec<OsString>) -> u8 {
    py.detach(|| slcal_cli::run(args))
}

/// Projector-camera calibration and one-shot structured-light reconstruction.
#[pymodule]
fn _slcal(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    read_image::register(module)?;
    photo_tags::register(module)?;
    pattern::register(module)?;
    geometry::register(module)?;
    detect::register(module)?;
    view_observation::register(module)?;
    observations::register(module)?;
    observe::register(module)?;
    rig::register(module)?;
    rectify::register(module)?;
    advise::register(module)?;
    calibrate::register(module)?;
    matches::register(module)?;
    dense_matches::register(module)?;
    decode::register(module)?;
    cloud::register(module)?;
    reconstructor::register(module)?;
    evaluate::register(module)?;
    simulate::register(module)?;
    module.add_function(wrap_pyfunction!(run_command, module)?)
}
