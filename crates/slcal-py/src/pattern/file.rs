//! Pattern files, and drawn patterns as arrays.

use pyo3::prelude::*;
use slcal_cli::files::InputKind;
use slcal_core::format::{read_pattern, write_pattern};
use slcal_core::pattern::Pattern;

use crate::convert::array::shaped;
use crate::errors::{Raise as _, Stage, raised_from};
use crate::files;

/// A drawn pattern as an array of (H, W, 3).
pub(super) fn picture<'py>(
    py: Python<'py>,
    draw: impl Fn() -> slcal_core::Result<image::RgbImage> + Send + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let drawn = py.detach(draw).raise(py, Stage::Detect)?;
    let shape = [drawn.height() as usize, drawn.width() as usize, 3];
    shaped(py, drawn.into_raw(), &shape)
}

pub(super) fn json(py: Python<'_>, pattern: &Pattern) -> PyResult<Vec<u8>> {
    let mut bytes = Vec::new();
    write_pattern(pattern, &mut bytes).raise(py, Stage::Detect)?;
    Ok(bytes)
}

pub(super) fn parse(py: Python<'_>, bytes: &[u8], name: Option<&str>) -> PyResult<Pattern> {
    read_pattern(bytes).map_err(|e| raised_from(py, &e, Stage::Detect, name))
}

pub(super) fn from_file(file: &Bound<'_, PyAny>) -> PyResult<Pattern> {
    let contents = files::read(file, InputKind::Pattern)?;
    parse(file.py(), &contents.bytes, contents.name.as_deref())
}
