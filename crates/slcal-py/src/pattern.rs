//! The patterns, and their drawing as arrays.

use numpy::ndarray::{Array2, Array3};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use slcal_core::format::write_pattern;
use slcal_core::pattern::{self, CheckerConfig, Pattern, StripeConfig};

fn value_error(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// A drawn pattern as an array of (height, width, 3).
fn as_array(py: Python<'_>, picture: image::RgbImage) -> PyResult<Bound<'_, PyArray3<u8>>> {
    let shape = (picture.height() as usize, picture.width() as usize, 3);
    let array = Array3::from_shape_vec(shape, picture.into_raw()).map_err(value_error)?;
    Ok(array.into_pyarray(py))
}

fn json(pattern: &Pattern) -> PyResult<String> {
    let mut bytes = Vec::new();
    write_pattern(pattern, &mut bytes).map_err(value_error)?;
    String::from_utf8(bytes).map_err(value_error)
}

/// The checkerboard that calibration needs, centred on the projector's panel.
#[pyclass(frozen, module = "slcal", eq)]
#[derive(PartialEq)]
pub(crate) struct CheckerPattern(pattern::CheckerPattern);

#[pymethods]
impl CheckerPattern {
    #[new]
    #[pyo3(signature = (projector, squares=(11, 8), square_px=None))]
    fn new(projector: (u32, u32), squares: (u32, u32), square_px: Option<u32>) -> PyResult<Self> {
        let config = CheckerConfig {
            squares: squares.into(),
            square_px: square_px.map(f64::from),
            ..CheckerConfig::default()
        };
        pattern::CheckerPattern::new(projector.into(), &config).map(Self).map_err(value_error)
    }

    /// Width and height of the panel, px.
    #[getter]
    fn projector(&self) -> (u32, u32) {
        self.0.projector.into()
    }

    /// Columns and rows of squares.
    #[getter]
    fn squares(&self) -> (u32, u32) {
        self.0.squares.into()
    }

    /// Side of a square, px.
    #[getter]
    fn square_px(&self) -> f64 {
        self.0.square_px
    }

    /// Outer top-left corner of the top-left square, px, pixel centres at integers.
    #[getter]
    fn origin_px(&self) -> (f64, f64) {
        (self.0.origin_px.x, self.0.origin_px.y)
    }

    /// The picture to project: (height, width, 3), sRGB.
    fn image<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<u8>>> {
        as_array(py, py.detach(|| self.0.image()).map_err(value_error)?)
    }

    /// The pattern file (schema slcal-pattern/1).
    fn to_json(&self) -> PyResult<String> {
        json(&Pattern::Checker(self.0.clone()))
    }

    fn __repr__(&self) -> String {
        let ([w, h], [c, r]) = (self.0.projector, self.0.squares);
        format!("CheckerPattern(projector=({w}, {h}), squares=({c}, {r}), square_px={})", self.0.square_px)
    }
}

/// Coloured vertical slits in a De Bruijn sequence.
#[pyclass(frozen, module = "slcal", eq)]
#[derive(PartialEq)]
pub(crate) struct StripePattern(pattern::StripePattern);

#[pymethods]
impl StripePattern {
    #[new]
    #[pyo3(signature = (projector, hues=4, order=3, slits=None))]
    fn new(projector: (u32, u32), hues: u32, order: u32, slits: Option<u32>) -> PyResult<Self> {
        let config = StripeConfig { hues, order, slits, ..StripeConfig::default() };
        pattern::StripePattern::new(projector.into(), &config).map(Self).map_err(value_error)
    }

    /// Width and height of the panel, px.
    #[getter]
    fn projector(&self) -> (u32, u32) {
        self.0.projector.into()
    }

    /// The colours: (hues, 3), sRGB.
    #[getter]
    fn palette<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u8>>> {
        let shape = (self.0.palette.len(), 3);
        let array = Array2::from_shape_vec(shape, self.0.palette.concat()).map_err(value_error)?;
        Ok(array.into_pyarray(py))
    }

    /// The colour of each slit: indices into the palette.
    #[getter]
    fn sequence<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        PyArray1::from_slice(py, &self.0.sequence)
    }

    /// Projector column of each slit's centre, px.
    #[getter]
    fn centres_px<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.0.centres_px)
    }

    /// Width of a slit, px.
    #[getter]
    fn width_px(&self) -> f64 {
        self.0.width_px
    }

    /// The picture to project: (height, width, 3), sRGB.
    fn image<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<u8>>> {
        as_array(py, py.detach(|| self.0.image()).map_err(value_error)?)
    }

    /// The pattern file (schema slcal-pattern/1).
    fn to_json(&self) -> PyResult<String> {
        json(&Pattern::Stripes(self.0.clone()))
    }

    fn __repr__(&self) -> String {
        let [w, h] = self.0.projector;
        format!(
            "StripePattern(projector=({w}, {h}), hues={}, order={}, slits={})",
            self.0.palette.len(),
            self.0.order,
            self.0.centres_px.len()
        )
    }
}
