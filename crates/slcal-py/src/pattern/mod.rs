//! What is projected: the patterns, and their drawing as arrays.

mod checker;
mod file;
mod sequence;
mod stripes;

use pyo3::prelude::*;
use slcal_core::pattern::Pattern;

pub(crate) use checker::CheckerPattern;
pub(crate) use sequence::SequencePattern;
pub(crate) use stripes::StripePattern;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<CheckerPattern>()?;
    module.add_class::<StripePattern>()?;
    module.add_class::<SequencePattern>()?;
    module.add_function(wrap_pyfunction!(load_pattern, module)?)
}

/// Reads a pattern file of any kind.
///
/// Parameters
/// ----------
/// file : path or file object
///     The JSON file (schema slcal-pattern/1) that `save` or ``slcal pattern`` wrote.
///
/// Returns
/// -------
/// CheckerPattern, StripePattern or SequencePattern
///
/// Raises
/// ------
/// OSError
///     When the file cannot be read.
/// FormatError
///     When it does not follow its schema; the message names the field.
#[pyfunction]
fn load_pattern<'py>(file: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = file.py();
    Ok(match file::from_file(file)? {
        Pattern::Checker(p) => Bound::new(py, CheckerPattern(p))?.into_any(),
        Pattern::Stripes(p) => Bound::new(py, StripePattern(p))?.into_any(),
        Pattern::Sequence(p) => Bound::new(py, SequencePattern(p))?.into_any(),
    })
}
