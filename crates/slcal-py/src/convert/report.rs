//! The core's reports as the records of `slcal.reports`.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
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

/// The report that goes with a result: made a record when it is asked for, for records cost more than small results do.
pub(crate) struct Reported {
    made_of: Option<(&'static str, Value)>,
    record: PyOnceLock<Py<PyAny>>,
}

impl Default for Reported {
    /// There is none.
    fn default() -> Self {
        Self { made_of: None, record: PyOnceLock::new() }
    }
}

impl Reported {
    /// What `report` says, as the record `class`.
    pub(crate) fn of(class: &'static str, report: &impl Serialize) -> Self {
        let json = serde_json::to_value(report).unwrap_or_default();
        Self { made_of: Some((class, json)), record: PyOnceLock::new() }
    }

    /// The record that was taken out of a pickle, if there was one.
    pub(crate) fn restored(py: Python<'_>, record: Option<Py<PyAny>>) -> Self {
        let kept = PyOnceLock::new();
        if let Some(record) = record {
            // The lock is new: nothing else has set it.
            let _ = kept.set(py, record);
        }
        Self { made_of: None, record: kept }
    }

    /// The record; `None` where there is no report.
    pub(crate) fn get(&self, py: Python<'_>) -> PyResult<Option<Py<PyAny>>> {
        match &self.made_of {
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
