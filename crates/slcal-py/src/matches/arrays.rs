//! Matches from arrays.

use nalgebra::Point2;
use pyo3::prelude::*;
use slcal_core::Match;

use crate::convert::array::rows_of;
use crate::convert::columns::{as_many, colors_of, column_of, integers_of, within};
use crate::errors;

/// Slits have numbers below this.
const SLITS: i64 = u16::MAX as i64;

/// What the constructor and [`crate::reconstruct::triangulate`] take beside the pixels.
#[derive(Clone, Copy, Default)]
pub(crate) struct MatchArrays<'a, 'py> {
    pub(crate) columns: Option<&'a Bound<'py, PyAny>>,
    pub(crate) rows: Option<&'a Bound<'py, PyAny>>,
    pub(crate) slits: Option<&'a Bound<'py, PyAny>>,
    pub(crate) confidence: Option<&'a Bound<'py, PyAny>>,
    pub(crate) sigma_px: Option<&'a Bound<'py, PyAny>>,
    pub(crate) colors: Option<&'a Bound<'py, PyAny>>,
}

/// Matches from arrays.
pub(crate) fn matches_of(
    pixels: &Bound<'_, PyAny>,
    given: MatchArrays<'_, '_>,
) -> PyResult<slcal_core::Matches> {
    let py = pixels.py();
    let pixels = rows_of::<2>(pixels, "pixels")?;
    let n = pixels.len();
    if given.columns.is_none() && given.rows.is_none() {
        let wanted = "the projector column or row (or both) of each pixel";
        return Err(errors::invalid(py, "columns", wanted, "neither columns nor rows"));
    }
    let columns = given.columns.map(|v| coordinates_of(v, n, "columns")).transpose()?;
    let rows = given.rows.map(|v| coordinates_of(v, n, "rows")).transpose()?;
    let slits = given.slits.map(|v| slits_of(v, n)).transpose()?;
    let confidence = given.confidence.map(|v| within(v, n, "confidence", 1.0)).transpose()?;
    let sigma = given.sigma_px.map(|v| sigma_of(v, n)).transpose()?;
    let colors = given.colors.map(|v| colors_of(v, n)).transpose()?;
    let item = |(i, p): (usize, [f64; 2])| Match {
        camera: Point2::from(p),
        projector_column: columns.as_ref().and_then(|c| c[i]),
        projector_row: rows.as_ref().and_then(|r| r[i]),
        slit: slits.as_ref().and_then(|s| s[i]),
        confidence: confidence.as_ref().map_or(1.0, |c| c[i]),
        sigma_px: sigma.as_ref().map_or(Match::DEFAULT_SIGMA_PX, |s| s[i]),
        color: colors.as_ref().map_or([255; 3], |c| c[i]),
    };
    Ok(slcal_core::Matches { items: pixels.into_iter().enumerate().map(item).collect() })
}

/// (N,) coordinates; NaN is one that is not known.
fn coordinates_of(values: &Bound<'_, PyAny>, n: usize, what: &str) -> PyResult<Vec<Option<f64>>> {
    let numbers = column_of(values, n, what, false)?;
    if let Some(row) = numbers.iter().position(|x| x.is_infinite()) {
        let found = format!("{} in row {row}", numbers[row]);
        return Err(errors::invalid(values.py(), what, "finite numbers, NaN where one is not known", &found));
    }
    Ok(numbers.into_iter().map(|x| Some(x).filter(|x| !x.is_nan())).collect())
}

fn slits_of(values: &Bound<'_, PyAny>, n: usize) -> PyResult<Vec<Option<u16>>> {
    let numbers = integers_of(values, "slits", [-1, SLITS - 1])?;
    as_many(values.py(), "slits", numbers.len(), n)?;
    Ok(numbers.into_iter().map(|s| u16::try_from(s).ok()).collect())
}

/// 1σ of matches, px.
pub(crate) fn sigma_of(values: &Bound<'_, PyAny>, n: usize) -> PyResult<Vec<f64>> {
    within(values, n, "sigma_px", f64::MAX)
}
