//! Arguments that are objects of this package; where something else is given, the message names the call that makes one.

use std::path::Path;

use numpy::PyUntypedArray;
use pyo3::PyClass;
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::errors;
use crate::files;

/// A class whose objects are arguments.
pub(crate) trait Argument: PyClass {
    /// The class, with its article.
    const EXPECTED: &'static str;
    /// The call that makes one of an array.
    const OF_ARRAY: &'static str;
    /// The call that makes one of anything else.
    const OF_OTHER: &'static str = Self::OF_ARRAY;

    /// The call that makes one of a file.
    fn of_path(path: &Path) -> String;
}

/// The call of a class's own `load`.
pub(crate) fn load(class: &str, path: &Path) -> String {
    format!("slcal.{class}.load({:?})", path.display().to_string())
}

/// The same for a pattern, whose picture has its data in a JSON file beside it.
pub(crate) fn load_pattern(class: &str, path: &Path) -> String {
    let is_picture = |e: &std::ffi::OsStr| !e.eq_ignore_ascii_case("json");
    match path.extension() {
        Some(e) if is_picture(e) => {
            format!(
                "the pattern's data are in the JSON file beside it: {}",
                load(class, &path.with_extension("json"))
            )
        }
        _ => load(class, path),
    }
}

/// The object, called `what` in messages.
pub(crate) fn object<'a, 'py, T: Argument>(
    value: &'a Bound<'py, PyAny>,
    what: &str,
) -> PyResult<&'a Bound<'py, T>> {
    value.cast::<T>().map_err(|_| refused::<T>(value, what, T::EXPECTED))
}

/// The same where it may be left out.
pub(crate) fn optional<'a, 'py, T: Argument>(
    value: Option<&'a Bound<'py, PyAny>>,
    what: &str,
) -> PyResult<Option<&'a Bound<'py, T>>> {
    value.map(|v| object(v, what)).transpose()
}

/// The error for an argument that is neither a `T` nor anything else that is `wanted`.
pub(crate) fn refused<T: Argument>(value: &Bound<'_, PyAny>, what: &str, wanted: &str) -> PyErr {
    let (found, call) = match files::path_of(value) {
        Ok(Some(path)) => ("a path".to_owned(), T::of_path(&path)),
        Err(error) => return error,
        Ok(None) if value.cast::<PyUntypedArray>().is_ok() => ("an array".to_owned(), T::OF_ARRAY.to_owned()),
        Ok(None) => (named(value), T::OF_OTHER.to_owned()),
    };
    errors::wrong_type(what, wanted, &format!("{found}: {call}"))
}

/// What an object is, in words.
pub(crate) fn named(value: &Bound<'_, PyAny>) -> String {
    let name =
        |class: &Bound<'_, PyType>| class.name().map_or_else(|_| "object".to_owned(), |n| n.to_string());
    if value.is_none() {
        return "None".to_owned();
    }
    if let Ok(class) = value.cast::<PyType>() {
        return format!("the class {} itself", name(class));
    }
    let name = name(&value.get_type());
    let article = if name.starts_with(|c: char| "aeiouAEIOU".contains(c)) { "an" } else { "a" };
    format!("{article} {name}")
}
