//! Array-likes with one number, or a few bytes, for each of several items.

use pyo3::prelude::*;

use super::array::{Numbers, all_finite, rows_of, shape_of};
use crate::errors;

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

/// (N,) numbers from 0 to `most`, or one for all.
pub(crate) fn within(values: &Bound<'_, PyAny>, n: usize, what: &str, most: f64) -> PyResult<Vec<f64>> {
    let numbers = column_of(values, n, what, true)?;
    if let Some(row) = numbers.iter().position(|x| !(0.0..=most).contains(x)) {
        let wanted =
            if most < f64::MAX { format!("numbers from 0 to {most}") } else { "no negative numbers".into() };
        return Err(errors::invalid(values.py(), what, &wanted, &format!("{} in row {row}", numbers[row])));
    }
    Ok(numbers)
}

/// (N, 3) colours.
pub(crate) fn colors_of(values: &Bound<'_, PyAny>, n: usize) -> PyResult<Vec<[u8; 3]>> {
    let colors = bytes_of::<3>(values, "colors")?;
    as_many(values.py(), "colors", colors.len(), n)?;
    Ok(colors)
}

/// Refuses an array that has not a row for each of `n` items.
pub(crate) fn as_many(py: Python<'_>, what: &str, found: usize, n: usize) -> PyResult<()> {
    if found == n {
        return Ok(());
    }
    Err(errors::invalid(py, what, &format!("{n} rows, one for each of the others"), &found.to_string()))
}
