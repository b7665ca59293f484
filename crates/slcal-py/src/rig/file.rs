//! The rig file, and pickles.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use slcal_cli::files::InputKind;
use slcal_core::format::{read_rig, write_rig};

use super::Rig;
use crate::errors::{Raise as _, Stage, raised_from};
use crate::files;

impl Rig {
    fn json(&self, py: Python<'_>) -> PyResult<Vec<u8>> {
        let mut bytes = Vec::new();
        write_rig(&self.rig, &mut bytes).raise(py, Stage::Detect)?;
        Ok(bytes)
    }

    fn parse(py: Python<'_>, bytes: &[u8], name: Option<&str>) -> PyResult<Self> {
        read_rig(bytes).map(Self::from).map_err(|e| raised_from(py, &e, Stage::Detect, name))
    }
}

#[pymethods]
impl Rig {
    /// Writes the rig file (schema slcal-rig/1), which the command line and other programs read.
    ///
    /// Parameters
    /// ----------
    /// file : path or file object
    ///     A path, where the file appears when it is complete and replaces an older one, or an object with write().
    fn save(&self, file: &Bound<'_, PyAny>) -> PyResult<()> {
        files::write(file, &self.json(file.py())?, true)
    }

    /// Reads a rig file.
    ///
    /// Parameters
    /// ----------
    /// file : path or file object
    ///     The JSON file (schema slcal-rig/1).
    ///
    /// Returns
    /// -------
    /// Rig
    ///
    /// Raises
    /// ------
    /// OSError
    ///     When the file cannot be read.
    /// FormatError
    ///     When it does not follow its schema; the message names the field.
    #[staticmethod]
    fn load(file: &Bound<'_, PyAny>) -> PyResult<Self> {
        let contents = files::read(file, InputKind::Rig)?;
        Self::parse(file.py(), &contents.bytes, contents.name.as_deref())
    }

    /// The content of the rig file.
    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        files::text_of(self.json(py)?)
    }

    /// The rig that `to_json` wrote.
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> PyResult<Self> {
        Self::parse(py, text.as_bytes(), None)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String, Option<String>))> {
        let report = self.report.as_ref().map(serde_json::to_string).transpose().map_err(pickled)?;
        Ok((py.get_type::<Self>().getattr("_restored")?, (self.to_json(py)?, report)))
    }

    #[staticmethod]
    fn _restored(py: Python<'_>, rig: &str, report: Option<&str>) -> PyResult<Self> {
        let report = report.map(serde_json::from_str).transpose().map_err(pickled)?;
        Ok(Self { report, ..Self::from_json(py, rig)? })
    }
}

/// A pickle whose report cannot be written or read.
fn pickled(error: serde_json::Error) -> PyErr {
    PyValueError::new_err(format!("pickled rig: {error}"))
}
