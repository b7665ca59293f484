//! The core's reports as the records of `slcal.reports`.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde::Serialize;
use serde_json::Value;

/// The record `class` of what `report` says.
pub(crate) fn record<'py>(
    py: Python<'py>,
    class: &str,
    report: &impl Serialize,
) -> PyResult<Bound<'py, PyAny>> {
    let report = serde_json::to_value(report).map_err(|e| PyValueError::new_err(e.to_string()))?;
    py.import("slcal.reports")?.getattr(class)?.call_method1("_of", (value(py, &report)?,))
}

/// JSON as Python's own values.
pub(crate) fn value<'py>(py: Python<'py>, json: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match json {
        Value::Null => py.None().into_bound(py),
        Value::Bool(b) => b.into_pyobject(py)?.to_owned().into_any(),
        Value::Number(n) => match (n.as_u64(), n.as_i64()) {
            (Some(n), _) => n.into_pyobject(py)?.into_any(),
            (_, Some(n)) => n.into_pyobject(py)?.into_any(),
            _ => n.as_f64().into_pyobject(py)?.into_any(),
        },
        Value::String(s) => s.into_pyobject(py)?.into_any(),
        Value::Array(items) => {
            let items = items.iter().map(|v| value(py, v)).collect::<PyResult<Vec<_>>>()?;
            PyList::new(py, items)?.into_any()
        }
        Value::Object(fields) => {
            let dict = PyDict::new(py);
            for (name, field) in fields {
                dict.set_item(name, value(py, field)?)?;
            }
            dict.into_any()
        }
    })
}
