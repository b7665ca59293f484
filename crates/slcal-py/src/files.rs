//! Bytes from and to paths and file objects.

use std::io;
use std::path::{Path, PathBuf};

use pyo3::exceptions::{PyOSError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyString};
use slcal_cli::files::{InputKind, read_input};

use crate::errors;

/// What was read, and how it is called in messages.
pub(crate) struct Contents {
    pub(crate) bytes: Vec<u8>,
    pub(crate) name: Option<String>,
}

/// The content of a path, up to the limit of this kind of files, or of a readable file object, binary or text.
pub(crate) fn read(file: &Bound<'_, PyAny>, kind: InputKind) -> PyResult<Contents> {
    let py = file.py();
    if let Some(path) = path_of(file)? {
        let bytes = py.detach(|| read_input(&path, kind)).map_err(|e| os_error(&e, &path))?;
        return Ok(Contents { bytes, name: Some(path.display().to_string()) });
    }
    let Some(read) = file.getattr_opt("read")? else { return Err(no_file(file, "read")) };
    check_open(file)?;
    let content = read.call0()?;
    let name = file.getattr_opt("name")?.and_then(|n| n.extract::<String>().ok());
    let bytes = if let Ok(text) = content.cast::<PyString>() {
        text.to_str()?.as_bytes().to_vec()
    } else if let Ok(bytes) = content.cast::<PyBytes>() {
        bytes.as_bytes().to_vec()
    } else {
        let found = format!("{} from read()", content.get_type().name()?);
        return Err(PyTypeError::new_err(format!("file: expected bytes or text, found {found}")));
    };
    Ok(Contents { bytes, name })
}

/// Writes to a path, where the file appears when it is complete and replaces an older one, or to a file object: binary, or
/// text if `is_text`.
pub(crate) fn write(file: &Bound<'_, PyAny>, bytes: &[u8], is_text: bool) -> PyResult<()> {
    let py = file.py();
    if let Some(path) = path_of(file)? {
        return py.detach(|| slcal_cli::files::write_whole(&path, bytes)).map_err(|e| os_error(&e, &path));
    }
    let Some(write) = file.getattr_opt("write")? else { return Err(no_file(file, "write")) };
    check_open(file)?;
    let text_file = file.is_instance(&py.import("io")?.getattr("TextIOBase")?)?;
    match std::str::from_utf8(bytes) {
        Ok(text) if text_file && is_text => write.call1((text,))?,
        _ if text_file => {
            return Err(errors::wrong_type(
                "file",
                "one opened for bytes (mode \"wb\")",
                "one opened for text",
            ));
        }
        _ => write.call1((PyBytes::new(py, bytes),))?,
    };
    Ok(())
}

/// The path that an argument is, if it is one.
pub(crate) fn path_of(file: &Bound<'_, PyAny>) -> PyResult<Option<PathBuf>> {
    if file.is_instance_of::<PyString>() || file.hasattr("__fspath__")? {
        return file.extract().map(Some);
    }
    Ok(None)
}

fn check_open(file: &Bound<'_, PyAny>) -> PyResult<()> {
    match file.getattr_opt("closed")? {
        Some(closed) if closed.is_truthy()? => {
            Err(errors::invalid(file.py(), "file", "an open file, or a path", "a file that is closed"))
        }
        _ => Ok(()),
    }
}

fn no_file(file: &Bound<'_, PyAny>, method: &str) -> PyErr {
    let found = file.get_type().name().map_or_else(|_| "another object".to_owned(), |n| n.to_string());
    errors::wrong_type("file", &format!("a path, or a file object with {method}()"), &found)
}

/// The exception that Python itself would raise: `FileNotFoundError` and its kin, with the file's name.
pub(crate) fn os_error(error: &io::Error, path: &Path) -> PyErr {
    let (shown, text) = (path.display().to_string(), error.to_string());
    match error.raw_os_error() {
        Some(number) => {
            let text = text.split(" (os error").next().unwrap_or_default().to_owned();
            PyOSError::new_err((number, text, shown))
        }
        // The kind still tells which of the exceptions it is.
        None => io::Error::new(error.kind(), format!("{shown}: {text}")).into(),
    }
}

/// What a writer of JSON wrote, as text.
pub(crate) fn text_of(bytes: Vec<u8>) -> PyResult<String> {
    String::from_utf8(bytes).map_err(|e| PyOSError::new_err(e.to_string()))
}
