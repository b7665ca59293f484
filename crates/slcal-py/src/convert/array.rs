//! Numbers as arrays, and array-likes as numbers.

use nalgebra::Matrix3;
use numpy::ndarray::{ArrayD, ArrayViewD};
use numpy::{AllowTypeChange, Element, IntoPyArray as _, PyArrayLikeDyn};
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyString};

use crate::errors;

/// A new array that takes over `values`, which are as many as the shape says.
pub(crate) fn shaped<'py, T: Element>(
    py: Python<'py>,
    values: Vec<T>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    let array = ArrayD::from_shape_vec(shape, values)
        .map_err(|e| errors::invalid(py, "array", "as many values as its shape holds", &e.to_string()))?;
    Ok(array.into_pyarray(py).into_any())
}

/// (N,) from one value per item.
pub(crate) fn column<'py, T: Element>(
    py: Python<'py>,
    values: impl Iterator<Item = T>,
) -> PyResult<Bound<'py, PyAny>> {
    let values: Vec<T> = values.collect();
    let n = values.len();
    shaped(py, values, &[n])
}

/// (N, K) from one row per item.
pub(crate) fn rows<'py, T: Element, const K: usize>(
    py: Python<'py>,
    rows: impl Iterator<Item = [T; K]>,
) -> PyResult<Bound<'py, PyAny>> {
    let values: Vec<T> = rows.flatten().collect();
    let n = values.len() / K;
    shaped(py, values, &[n, K])
}

/// (3, 3) from a matrix.
pub(crate) fn matrix<'py>(py: Python<'py>, m: &Matrix3<f64>) -> PyResult<Bound<'py, PyAny>> {
    rows(py, m.row_iter().map(|r| [r[0], r[1], r[2]]))
}

/// Anything that NumPy turns into numbers.
pub(crate) struct Numbers<'py>(PyArrayLikeDyn<'py, f64, AllowTypeChange>);

impl<'py> Numbers<'py> {
    /// From an array-like of real numbers, called `what` in messages.
    pub(crate) fn of(values: &Bound<'py, PyAny>, what: &str) -> PyResult<Self> {
        let refused = |found: &str| errors::wrong_type(what, "an array of real numbers", found);
        // NumPy would take it for a number that is none.
        if values.is_none() {
            return Err(refused("None"));
        }
        // NumPy reads None as NaN and text as what it says.
        if values.is_none() || values.is_instance_of::<PyString>() || values.is_instance_of::<PyBytes>() {
            return Err(refused(values.get_type().name()?.to_str()?));
        }
        // Complex numbers and dates would lose a part of themselves on the way.
        if let Some(kind) = values.getattr_opt("dtype")?.and_then(|d| d.getattr("kind").ok()) {
            let kind: String = kind.extract()?;
            if !matches!(kind.as_str(), "f" | "i" | "u" | "b" | "O") {
                return Err(refused(&format!("dtype {}", values.getattr("dtype")?)));
            }
        }
        values.extract().map(Self).map_err(|e: PyErr| {
            // Who interrupts Python has not given a wrong value.
            if !e.is_instance_of::<PyException>(values.py()) {
                return e;
            }
            refused(&values.get_type().name().map_or_else(|_| "another object".to_owned(), |n| n.to_string()))
        })
    }

    /// The values, whatever their shape.
    pub(crate) fn view(&self) -> ArrayViewD<'_, f64> {
        self.0.as_array()
    }
}

/// The shape of numbers, as Python writes it.
pub(super) fn shape_of(view: &ArrayViewD<'_, f64>) -> String {
    shape_in_words(view.shape())
}

/// A shape as Python writes it.
pub(crate) fn shape_in_words(shape: &[usize]) -> String {
    match shape {
        [n] => format!("({n},)"),
        _ => format!("{shape:?}").replace('[', "(").replace(']', ")"),
    }
}

/// Refuses what is not finite; names the first row of it.
pub(super) fn all_finite(py: Python<'_>, view: &ArrayViewD<'_, f64>, what: &str) -> PyResult<()> {
    let bad = view.iter().filter(|x| !x.is_finite()).count();
    if bad == 0 {
        return Ok(());
    }
    let first = view.iter().position(|x| !x.is_finite()).unwrap_or_default();
    let row = first / view.shape().iter().skip(1).product::<usize>().max(1);
    let found = format!("{bad} of {} that are not, the first in row {row}; leave such rows out", view.len());
    Err(errors::invalid(py, what, "finite numbers", &found))
}

/// (N, K) finite numbers; a single (K,) counts as one row.
pub(crate) fn rows_of<const K: usize>(values: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<[f64; K]>> {
    let numbers = Numbers::of(values, what)?;
    let rows = rows_in(values.py(), &numbers.view(), what)?;
    all_finite(values.py(), &numbers.view(), what)?;
    Ok(rows)
}

/// The same with numbers that may be NaN or infinite.
pub(crate) fn any_rows_of<const K: usize>(values: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<[f64; K]>> {
    rows_in(values.py(), &Numbers::of(values, what)?.view(), what)
}

fn rows_in<const K: usize>(
    py: Python<'_>,
    view: &ArrayViewD<'_, f64>,
    what: &str,
) -> PyResult<Vec<[f64; K]>> {
    let fits = match *view.shape() {
        [n] => n == K || n == 0,
        // The second form is that of OpenCV's points.
        [_, k] | [_, 1, k] => k == K,
        _ => false,
    };
    if !fits {
        let found = format!("shape {}", shape_of(view));
        return Err(errors::invalid(py, what, &format!("shape (N, {K})"), &found));
    }
    let mut flat = view.iter().copied();
    Ok(std::iter::from_fn(|| {
        let mut row = [0.0; K];
        for value in &mut row {
            *value = flat.next()?;
        }
        Some(row)
    })
    .collect())
}

/// Exactly `K` finite numbers in an array of any of the shapes (K,), (K, 1), (1, K).
pub(crate) fn vector_of<const K: usize>(values: &Bound<'_, PyAny>, what: &str) -> PyResult<[f64; K]> {
    let py = values.py();
    let numbers = Numbers::of(values, what)?;
    let view = numbers.view();
    let flat: Vec<f64> = view.iter().copied().collect();
    let flat: [f64; K] = flat.try_into().map_err(|_| {
        errors::invalid(py, what, &format!("shape ({K},)"), &format!("shape {}", shape_of(&view)))
    })?;
    all_finite(py, &view, what)?;
    Ok(flat)
}

/// A finite (3, 3) matrix, row by row.
pub(crate) fn matrix_of(values: &Bound<'_, PyAny>, what: &str) -> PyResult<[[f64; 3]; 3]> {
    let py = values.py();
    let numbers = Numbers::of(values, what)?;
    let view = numbers.view();
    if view.shape() != [3, 3] {
        return Err(errors::invalid(py, what, "shape (3, 3)", &format!("shape {}", shape_of(&view))));
    }
    all_finite(py, &view, what)?;
    let at = |i: usize, j: usize| view[[i, j]];
    Ok([0, 1, 2].map(|i| [at(i, 0), at(i, 1), at(i, 2)]))
}
