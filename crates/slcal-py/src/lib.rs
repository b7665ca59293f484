//! The extension module `slcal._slcal`: thin classes over the types of the core.

mod pattern;

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
    module.add_class::<pattern::CheckerPattern>()?;
    module.add_class::<pattern::StripePattern>()?;
    module.add_function(wrap_pyfunction!(run_command, module)?)
}
