//! The core's errors as the exceptions of `slcal._errors`.

use pyo3::exceptions::{PyOSError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict as _, PyDict};
use slcal_core::Error;

/// The stage of the work, which decides the exception where something is not found.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Stage {
    /// Sheet and checkerboard.
    Detect,
    /// Stripes.
    Decode,
    /// A plane or a sphere in a cloud.
    Evaluate,
}

impl Stage {
    fn class(self) -> &'static str {
        match self {
            Self::Detect => "DetectionError",
            Self::Decode => "DecodeError",
            Self::Evaluate => "Error",
        }
    }
}

/// The exception for an error of the core.
pub(crate) fn raised(py: Python<'_>, error: &Error, stage: Stage) -> PyErr {
    raised_from(py, error, stage, None)
}

/// The same for one that arose from a file, which the message then names.
pub(crate) fn raised_from(py: Python<'_>, error: &Error, stage: Stage, file: Option<&str>) -> PyErr {
    let message = file.map_or_else(|| error.to_string(), |name| format!("{name}: {error}"));
    let fields = PyDict::new(py);
    let class = match fill(&fields, error, stage) {
        Ok(class) => class,
        Err(failed) => return failed,
    };
    match class {
        Some(class) => exception(py, class, &message, &fields),
        None => PyOSError::new_err(message),
    }
}

/// Sets the error's fields and returns its class; `None` for one of the operating system.
fn fill(fields: &Bound<'_, PyDict>, error: &Error, stage: Stage) -> PyResult<Option<&'static str>> {
    Ok(Some(match error {
        Error::Invalid { what, expected, found } => {
            fields.set_item("what", what.to_string())?;
            fields.set_item("expected", expected)?;
            fields.set_item("found", found)?;
            "Error"
        }
        Error::NotFound { what, seen, advice } => {
            fields.set_item("what", what.to_string())?;
            fields.set_item("seen", seen)?;
            fields.set_item("advice", advice)?;
            stage.class()
        }
        Error::Degenerate { what, measure, limit, advice } => {
            fields.set_item("what", what.to_string())?;
            fields.set_item("measure", measure)?;
            fields.set_item("limit", limit)?;
            fields.set_item("advice", advice)?;
            "CalibrationError"
        }
        Error::ImaginaryFocal { device, f_squared, advice } => {
            fields.set_item("device", device.to_string())?;
            fields.set_item("f_squared", f_squared)?;
            fields.set_item("advice", advice)?;
            "CalibrationError"
        }
        Error::Malformed { what, detail, .. } => {
            fields.set_item("what", what.to_string())?;
            fields.set_item("detail", detail)?;
            "FormatError"
        }
        Error::Io { .. } => return Ok(None),
        _ => "Error",
    }))
}

/// An exception of `slcal._errors`.
fn exception(py: Python<'_>, class: &str, message: &str, fields: &Bound<'_, PyDict>) -> PyErr {
    let made = || {
        let class = py.import("slcal._errors")?.getattr(class)?;
        class.call((message,), Some(fields))
    };
    made().map_or_else(|failed| failed, PyErr::from_value)
}

/// A value that is not what was expected.
pub(crate) fn invalid(py: Python<'_>, what: &str, expected: &str, found: &str) -> PyErr {
    let message = format!("{what}: expected {expected}, found {found}");
    match [("what", what), ("expected", expected), ("found", found)].into_py_dict(py) {
        Ok(fields) => exception(py, "Error", &message, &fields),
        Err(failed) => failed,
    }
}

/// A value of a type that is not what was expected.
pub(crate) fn wrong_type(what: &str, expected: &str, found: &str) -> PyErr {
    PyTypeError::new_err(format!("{what}: expected {expected}, found {found}"))
}

/// A file that is no such picture.
pub(crate) fn malformed(py: Python<'_>, what: &str, message: &str) -> PyErr {
    match [("what", what), ("detail", message)].into_py_dict(py) {
        Ok(fields) => exception(py, "FormatError", message, &fields),
        Err(failed) => failed,
    }
}

/// Results of the core as results of Python.
pub(crate) trait Raise<T> {
    /// See [`raised`].
    fn raise(self, py: Python<'_>, stage: Stage) -> PyResult<T>;
}

impl<T> Raise<T> for slcal_core::Result<T> {
    fn raise(self, py: Python<'_>, stage: Stage) -> PyResult<T> {
        self.map_err(|error| raised(py, &error, stage))
    }
}
