//! Observations as plain dictionaries whose leaves may be arrays.

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyInt, PyList, PyMapping, PyString, PyTuple};
use serde_json::{Map, Number, Value};

use crate::errors;

/// Observations have four levels; what is deeper holds itself.
const DEEPEST: usize = 16;

/// A mapping as JSON, its NaN refused by their place.
pub(super) fn json_of(value: &Bound<'_, PyAny>) -> PyResult<Value> {
    walk(value, "", DEEPEST)
}

fn walk(value: &Bound<'_, PyAny>, place: &str, deep: usize) -> PyResult<Value> {
    let py = value.py();
    let what = if place.is_empty() { "observations" } else { place };
    if deep == 0 {
        return Err(errors::invalid(py, what, "at most four levels", "more: does it hold itself?"));
    }
    if value.is_none() {
        return Ok(Value::Null);
    }
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(Value::Bool(flag.is_true()));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Value::String(text.to_str()?.to_owned()));
    }
    if let Ok(number) = value.cast::<PyInt>()
        && let Ok(whole) = number.extract::<i64>()
    {
        return Ok(Value::Number(whole.into()));
    }
    if value.cast::<PyFloat>().is_ok() || value.cast::<PyInt>().is_ok() {
        let number: f64 = value.extract()?;
        return Number::from_f64(number).map(Value::Number).ok_or_else(|| {
            errors::invalid(py, what, "a finite number", &format!("{number}; leave such rows out"))
        });
    }
    if value.cast::<PyList>().is_ok() || value.cast::<PyTuple>().is_ok() {
        let items = value.try_iter()?.enumerate();
        let items = items.map(|(i, item)| walk(&item?, &format!("{place}[{i}]"), deep - 1));
        return items.collect::<PyResult<Vec<_>>>().map(Value::Array);
    }
    if let Ok(mapping) = value.cast::<PyMapping>() {
        let mut fields = Map::new();
        for entry in mapping.items()?.iter() {
            let (name, field): (Bound<'_, PyAny>, Bound<'_, PyAny>) = entry.extract()?;
            let Ok(name) = name.extract::<String>() else {
                return Err(errors::wrong_type(what, "names of fields as keys", &name.repr()?.to_string()));
            };
            let place = if place.is_empty() { name.clone() } else { format!("{place}.{name}") };
            fields.insert(name, walk(&field, &place, deep - 1)?);
        }
        return Ok(Value::Object(fields));
    }
    // Arrays and numbers of NumPy.
    if let Some(plain) = value.getattr_opt("tolist")? {
        return walk(&plain.call0()?, place, deep - 1);
    }
    let found = value.get_type().name()?.to_string();
    Err(errors::wrong_type(what, "numbers, arrays, lists, mappings, text or None", &found))
}
