//! Keyword arguments as the core's options, which parse and print themselves.

use std::str::FromStr;

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyString};
use slcal_core::geometry::{RectangleSize, SheetSize};
use slcal_core::{Error, Flatness, PixelAspect};

use crate::errors::{self, Raise as _, Stage, raised};

/// How a value that is not accepted is shown.
pub(crate) fn repr_of(value: &Bound<'_, PyAny>) -> String {
    value.repr().map_or_else(|_| "another object".to_owned(), |r| r.to_string())
}

/// A name, a number or a pair of numbers, as the core parses it.
fn text_of(value: &Bound<'_, PyAny>) -> String {
    if let Ok(text) = value.extract::<String>() {
        return text;
    }
    // True is a number to Python, and to nobody else.
    if !value.is_instance_of::<PyBool>() {
        if let Ok(number) = value.extract::<f64>() {
            return number.to_string();
        }
        if let Ok((x, y)) = value.extract::<(f64, f64)>() {
            return format!("{x},{y}");
        }
    }
    repr_of(value)
}

/// An option of the core; the message says what it accepts.
pub(crate) fn parsed<T: FromStr<Err = Error>>(value: &Bound<'_, PyAny>, what: &str) -> PyResult<T> {
    let py = value.py();
    text_of(value).parse().map_err(|error| match &error {
        // The core says what is wrong with a text.
        Error::Invalid { expected, found, .. } if value.is_instance_of::<PyString>() => {
            errors::invalid(py, what, expected, found)
        }
        Error::Invalid { expected, .. } => errors::invalid(py, what, expected, &repr_of(value)),
        _ => raised(py, &error, Stage::Detect),
    })
}

/// The same, or its default where it is not given.
pub(crate) fn parsed_or<T: FromStr<Err = Error>>(
    value: Option<&Bound<'_, PyAny>>,
    what: &str,
    default: T,
) -> PyResult<T> {
    value.map_or(Ok(default), |v| parsed(v, what))
}

/// How flat a sheet is: what the core parses, or a number of millimetres.
pub(crate) fn flatness(value: Option<&Bound<'_, PyAny>>) -> PyResult<Flatness> {
    let Some(value) = value else { return Ok(Flatness::default()) };
    let number = (!value.is_instance_of::<PyBool>()).then(|| value.extract::<f64>().ok()).flatten();
    match number {
        Some(mm) if mm.is_finite() && mm >= 0.0 => Ok(Flatness::Sigma(mm)),
        Some(_) => {
            let wanted = "a number of millimetres that is not negative";
            Err(errors::invalid(value.py(), "flatness", wanted, &repr_of(value)))
        }
        None => parsed(value, "flatness"),
    }
}

/// The shape of a projector's pixels: what the core parses, or a ratio.
pub(crate) fn pixel_aspect(value: Option<&Bound<'_, PyAny>>) -> PyResult<PixelAspect> {
    let Some(value) = value else { return Ok(PixelAspect::default()) };
    let number = (!value.is_instance_of::<PyBool>()).then(|| value.extract::<f64>().ok()).flatten();
    match number {
        Some(ratio) if ratio.is_finite() && ratio > 0.0 => Ok(PixelAspect::Ratio(ratio)),
        Some(_) => {
            let wanted = "a ratio above zero";
            Err(errors::invalid(value.py(), "projector_pixel_aspect", wanted, &repr_of(value)))
        }
        None => parsed(value, "projector_pixel_aspect"),
    }
}

/// One of several names that only Python has.
pub(crate) fn one_of<T: Copy>(value: &Bound<'_, PyAny>, what: &str, names: &[(&str, T)]) -> PyResult<T> {
    let given: Option<String> = value.extract().ok();
    let found = names.iter().find(|(n, _)| given.as_deref() == Some(*n)).map(|(_, v)| *v);
    found.ok_or_else(|| {
        let names: Vec<&str> = names.iter().map(|(n, _)| *n).collect();
        errors::invalid(value.py(), what, &names.join(", "), &repr_of(value))
    })
}

/// Width and height in whole pixels, or columns and rows.
pub(crate) fn whole_pair(value: &Bound<'_, PyAny>, what: &str) -> PyResult<[u32; 2]> {
    let pair: Option<[i64; 2]> = value.extract::<(i64, i64)>().ok().map(|(w, h)| [w, h]).or_else(|| {
        // NumPy's integers and arrays.
        let items = value.try_iter().ok()?.collect::<PyResult<Vec<_>>>().ok()?;
        let items = items.iter().map(|i| i.extract::<i64>().ok()).collect::<Option<Vec<_>>>()?;
        items.try_into().ok()
    });
    let whole = pair.and_then(|p| Some([u32::try_from(p[0]).ok()?, u32::try_from(p[1]).ok()?]));
    whole.filter(|p| p[0] > 0 && p[1] > 0).ok_or_else(|| {
        errors::invalid(
            value.py(),
            what,
            "two whole numbers above zero, such as (1024, 768)",
            &repr_of(value),
        )
    })
}

/// Width and height of a sheet in mm, or a size with its unit or a paper as text; a paper by its name alone is upright.
pub(crate) fn definite_size(value: &Bound<'_, PyAny>) -> PyResult<RectangleSize> {
    sheet_size(value).map(|size| size.upright())
}

/// The same in photographs, where a paper by its name alone may lie either way round.
pub(crate) fn sheet_size(value: &Bound<'_, PyAny>) -> PyResult<SheetSize> {
    const WHAT: &str = "size_mm";
    if value.is_instance_of::<PyString>() {
        return parsed(value, WHAT);
    }
    let items =
        value.try_iter().and_then(|items| items.map(|i| i?.extract::<f64>()).collect::<PyResult<Vec<_>>>());
    let sides: Option<[f64; 2]> = items.ok().and_then(|sides| sides.try_into().ok());
    let within = sides.filter(|s| s.iter().all(|side| RectangleSize::SIDE_RANGE_MM.contains(side)));
    let [width, height] = within.ok_or_else(|| {
        let wanted = "width and height of the sheet, each from 1 mm to 100 m, in millimetres, such as (594, 420), or \
                      a text such as \"A2-landscape\" or \"59.4x42cm\"";
        let size = sides.and_then(|[w, h]| RectangleSize::new(w, h).ok());
        let unit = size.and_then(|size| size.likely_units().first().copied());
        let hint = unit.map_or(String::new(), |(unit, size)| format!(" ({size} if those are {unit})"));
        errors::invalid(value.py(), WHAT, wanted, &format!("{}{hint}", repr_of(value)))
    })?;
    RectangleSize::new(width, height).map(SheetSize::from).raise(value.py(), Stage::Detect)
}

/// Photographs without the pattern: `plain`, or `screen`, its older name; with the name that was used.
pub(crate) fn plain<'a, 'py>(
    plain: Option<&'a Bound<'py, PyAny>>,
    screen: Option<&'a Bound<'py, PyAny>>,
) -> PyResult<Option<(&'a Bound<'py, PyAny>, &'static str)>> {
    match (plain, screen) {
        (Some(_), Some(screen)) => {
            Err(errors::invalid(screen.py(), "screen", "plain alone, of which it is the older name", "both"))
        }
        (plain, None) => Ok(plain.map(|p| (p, "plain"))),
        (None, screen) => Ok(screen.map(|s| (s, "screen"))),
    }
}
