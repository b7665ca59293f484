//! The core's reports as the records of `slcal.reports`.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyList};
use serde::Serialize;
use serde_json::Value;

/// The record of class `class` with the fields of `report`.
pub(crate) fn record<'py>(
    py: Python<'py>,
    class: &str,
    report: &impl Serialize,
) -> PyResult<Bound<'py, PyAny>> {
    let report = serde_json::to_value(report).map_err(|e| PyValueError::new_err(e.to_string()))?;
    py.import("slcal.reports")?.getattr(class)?.call_method1("_of", (value(py, &report)?,))
}

/// The report of a result. It becomes a record on first access, since records cost more than small results do.
pub(crate) struct LazyReport {
    source: Option<(&'static str, Value)>,
    record: PyOnceLock<Py<PyAny>>,
}

impl Default for LazyReport {
    /// No report.
    fn default() -> Self {
        Self { source: None, record: PyOnceLock::new() }
    }
}

impl LazyReport {
    /// A record of class `class` with the fields of `report`.
    pub(crate) fn of(class: &'static str, report: &impl Serialize) -> Self {
        let json = serde_json::to_value(report).unwrap_or_default();
        Self { source: Some((class, json)), record: PyOnceLock::new() }
    }

    /// The record from a pickle, if there is one.
    pub(crate) fn restored(py: Python<'_>, record: Option<Py<PyAny>>) -> Self {
        let kept = PyOnceLock::new();
        if let Some(record) = record {
            // The lock is new, so nothing else has set it.
            let _ = kept.set(py, record);
        }
        Self { source: None, record: kept }
    }

    /// The record; `None` where there is no report.
    pub(crate) fn get(&self, py: Python<'_>) -> PyResult<Option<Py<PyAny>>> {
        match &self.source {
            None => Ok(self.record.get(py).map(|r| r.clone_ref(py))),
            Some((class, json)) => {
                let made = self.record.get_or_try_init(py, || record(py, class, json).map(Bound::unbind))?;
                Ok(Some(made.clone_ref(py)))
            }
        }
    }
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
