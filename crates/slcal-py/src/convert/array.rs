//! Numbers as arrays, and array-likes as numbers.

use numpy::ndarray::{ArrayD, ArrayViewD};
use numpy::{AllowTypeChange, Element, IntoPyArray as _, PyArrayLikeDyn};
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
        values.extract().map(Self).map_err(|_| {
            refused(&values.get_type().name().map_or_else(|_| "another object".to_owned(), |n| n.to_string()))
        })
    }

    /// The values, whatever their shape.
    pub(crate) fn view(&self) -> ArrayViewD<'_, f64> {
        self.0.as_array()
    }
}

fn shape_of(view: &ArrayViewD<'_, f64>) -> String {
    shape_in_words(view.shape())
}

/// A shape as Python writes it.
pub(crate) fn shape_in_words(shape: &[usize]) -> String {
    match shape {
        [n] => format!("({n},)"),
        _ => format!("{shape:?}").replace('[', "(").replace(']', ")"),
    }
}

fn all_finite(py: Python<'_>, view: &ArrayViewD<'_, f64>, what: &str) -> PyResult<()> {
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
    let py = values.py();
    let numbers = Numbers::of(values, what)?;
    let view = numbers.view();
    let fits = match *view.shape() {
        [n] => n == K || n == 0,
        // The second form is that of OpenCV's points.
        [_, k] | [_, 1, k] => k == K,
        _ => false,
    };
    if !fits {
        return Err(errors::invalid(
            py,
            what,
            &format!("shape (N, {K})"),
            &format!("shape {}", shape_of(&view)),
        ));
    }
    all_finite(py, &view, what)?;
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

/// (N,) numbers, or one for all of `n`; finite where `finite` asks for it.
pub(crate) fn column_of(values: &Bound<'_, PyAny>, n: usize, what: &str, finite: bool) -> PyResult<Vec<f64>> {
    let py = values.py();
    let numbers = Numbers::of(values, what)?;
    let view = numbers.view();
    if finite {
        all_finite(py, &view, what)?;
    }
    match *view.shape() {
        [] => Ok(vec![view.iter().copied().next().unwrap_or_default(); n]),
        [m] | [m, 1] if m == n => Ok(view.iter().copied().collect()),
        _ => Err(errors::invalid(py, what, &format!("shape ({n},)"), &format!("shape {}", shape_of(&view)))),
    }
}

/// Whole numbers from `low` to `high`, (N,).
pub(crate) fn integers_of(
    values: &Bound<'_, PyAny>,
    what: &str,
    [low, high]: [i64; 2],
) -> PyResult<Vec<i64>> {
    let py = values.py();
    let numbers = Numbers::of(values, what)?;
    let view = numbers.view();
    if view.ndim() != 1 {
        return Err(errors::invalid(py, what, "shape (N,)", &format!("shape {}", shape_of(&view))));
    }
    view.iter()
        .map(|&x| {
            let whole = x.fract() == 0.0 && (low as f64..=high as f64).contains(&x);
            let expected = format!("whole numbers from {low} to {high}");
            if whole { Ok(x as i64) } else { Err(errors::invalid(py, what, &expected, &x.to_string())) }
        })
        .collect()
}

/// (N, K) colours or other bytes.
pub(crate) fn bytes_of<const K: usize>(values: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<[u8; K]>> {
    rows_of::<K>(values, what)?
        .into_iter()
        .map(|row| {
            if row.iter().all(|x| x.fract() == 0.0 && (0.0..=255.0).contains(x)) {
                return Ok(row.map(|x| x as u8));
            }
            Err(errors::invalid(values.py(), what, "whole numbers from 0 to 255", &format!("{row:?}")))
        })
        .collect()
}
