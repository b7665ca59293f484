//! Files of photographs.

use std::ffi::CString;

use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict as _, PyBytes};
use slcal_cli::files::{DecodedPhoto, ForeignPhoto, InputKind};

use crate::convert::image::array_of;
use crate::errors;
use crate::files::{self, Contents};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(read_image, module)?)
}

/// Reads a photograph: PNG, JPEG, TIFF, WebP or BMP, 8 or 16 bit, turned upright as its EXIF orientation asks.
///
/// HEIC and AVIF are read, too, where pillow-heif is installed: ``pip install slcal[heif]``.
///
/// Parameters
/// ----------
/// file : path or binary file object
///     The photograph.
/// as_stored : bool, default False
///     Take the samples as they are in the file, for `gamma` of what follows. By default samples that the file says to be
///     coded otherwise than sRGB (gAMA or cICP of a PNG, the curve of a colour profile) are converted to sRGB with 16
///     bit, with a UserWarning.
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
#[pyo3(signature = (file, *, as_stored=false))]
pub(crate) fn read_image<'py>(file: &Bound<'py, PyAny>, as_stored: bool) -> PyResult<Bound<'py, PyAny>> {
    let py = file.py();
    let Contents { bytes, name } = files::read(file, InputKind::Photo)?;
    let name = name.unwrap_or_else(|| "image".to_owned());
    if let Some(format) = ForeignPhoto::of(&bytes) {
        let read = py.import("slcal._heif")?.getattr("read")?;
        let avif = [("avif", format == ForeignPhoto::Avif)].into_py_dict(py)?;
        return read.call((PyBytes::new(py, &bytes), name), Some(&avif));
    }
    let DecodedPhoto { photo, converted, .. } = py
        .detach(|| slcal_cli::files::decode_photo(&bytes, &name, as_stored))
        .map_err(|message| errors::malformed(py, "photograph", &message))?;
    if let Some(converted) = converted {
        // Names of profiles may contain anything but a zero by now.
        let told = CString::new(format!("{name}: {converted}; as_stored=True takes them as they are stored"));
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &told.unwrap_or_default(), 1)?;
    }
    array_of(py, photo)
}
