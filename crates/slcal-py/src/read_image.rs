//! Files of photographs.

use pyo3::prelude::*;

use crate::convert::image::array_of;
use crate::errors;
use crate::files::{self, Contents};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(read_image, module)?)
}

/// Reads a photograph: PNG, JPEG or TIFF, 8 or 16 bit, turned upright as its EXIF orientation asks.
///
/// Parameters
/// ----------
/// file : path or binary file object
///     The photograph.
///
/// Returns
/// -------
/// ndarray
///     (H, W, 3) in RGB order, or (H, W) for a grey one; uint8 or uint16. An alpha channel is left out.
///
/// Raises
/// ------
/// OSError
///     When the file cannot be read.
/// FormatError
///     When it is not such a picture, or is incomplete; the message says how to convert it.
#[pyfunction]
fn read_image<'py>(file: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = file.py();
    let Contents { bytes, name } = files::read(file)?;
    let name = name.unwrap_or_else(|| "image".to_owned());
    let photo = py
        .detach(|| slcal_cli::files::decode_photo(&bytes, &name))
        .map_err(|message| errors::malformed(py, "photograph", &message))?;
    array_of(py, photo)
}
