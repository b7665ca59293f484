//! Arrays with a value per pixel that are kept and shown, but not changed.

use numpy::ndarray::{Array2, Array3};
use numpy::{
    AllowTypeChange, IntoPyArray as _, PyArray2, PyArray3, PyArrayDescrMethods as _, PyArrayLike2,
    PyArrayMethods as _, PyReadonlyArray2, PyUntypedArray, PyUntypedArrayMethods as _,
};
use pyo3::prelude::*;

use crate::convert::array::{Numbers, shape_in_words};
use crate::errors;

/// 1σ of positions that were given without, projector px.
const USUAL_SIGMA_PX: f32 = 0.1;

/// (H, W).
pub(super) struct Floats(Py<PyArray2<f32>>);

impl Floats {
    /// An array that takes over `values`, as many as the shape says, and cannot be written to.
    pub(super) fn taken(py: Python<'_>, values: Vec<f32>, shape: [usize; 2]) -> PyResult<Self> {
        let array = Array2::from_shape_vec(shape, values).map_err(|e| misshaped(py, &e))?.into_pyarray(py);
        array.readwrite().make_nonwriteable();
        Ok(Self(array.unbind()))
    }

    pub(super) fn array<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        self.0.bind(py).clone().into_any()
    }

    pub(super) fn read<'py>(&self, py: Python<'py>) -> PyReadonlyArray2<'py, f32> {
        self.0.bind(py).readonly()
    }

    pub(super) fn values(&self, py: Python<'_>) -> PyResult<Vec<f32>> {
        Ok(self.read(py).as_slice()?.to_vec())
    }
}

/// (H, W, 3).
pub(super) struct Bytes(Py<PyArray3<u8>>);

impl Bytes {
    pub(super) fn taken(py: Python<'_>, values: Vec<[u8; 3]>, [h, w]: [usize; 2]) -> PyResult<Self> {
        let array = Array3::from_shape_vec([h, w, 3], values.into_flattened());
        let array = array.map_err(|e| misshaped(py, &e))?.into_pyarray(py);
        array.readwrite().make_nonwriteable();
        Ok(Self(array.unbind()))
    }

    pub(super) fn array<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        self.0.bind(py).clone().into_any()
    }

    pub(super) fn values(&self, py: Python<'_>) -> PyResult<Vec<[u8; 3]>> {
        let read = self.0.bind(py).readonly();
        Ok(read.as_slice()?.as_chunks().0.to_vec())
    }
}

fn misshaped(py: Python<'_>, error: &impl ToString) -> PyErr {
    errors::invalid(py, "array", "as many values as its shape holds", &error.to_string())
}

/// Whether two planes are both missing, or have the same numbers.
pub(super) fn same_floats(py: Python<'_>, a: Option<&Floats>, b: Option<&Floats>) -> PyResult<bool> {
    let (Some(a), Some(b)) = (a, b) else { return Ok(a.is_none() && b.is_none()) };
    let (a, b) = (a.read(py), b.read(py));
    let (a, b) = (a.as_slice()?, b.as_slice()?);
    let same = |(x, y): (&f32, &f32)| x == y || (x.is_nan() && y.is_nan());
    Ok(py.detach(|| a.len() == b.len() && a.iter().zip(b).all(same)))
}

/// (H, W) float32, without a check of its values.
fn plane_of<'py>(
    values: &Bound<'py, PyAny>,
    what: &str,
) -> PyResult<PyArrayLike2<'py, f32, AllowTypeChange>> {
    // Refuses what is no array of real numbers with the messages of other arrays.
    let shape = match values.cast::<PyUntypedArray>() {
        Ok(array) if matches!(array.dtype().kind(), b'f' | b'i' | b'u') => array.shape().to_vec(),
        _ => Numbers::of(values, what)?.view().shape().to_vec(),
    };
    if shape.len() != 2 || shape.contains(&0) {
        let found = format!("shape {}", shape_in_words(&shape));
        return Err(errors::invalid(values.py(), what, "shape (H, W), with a value for each pixel", &found));
    }
    values.extract().map_err(|_| errors::wrong_type(what, "an array of real numbers", "another object"))
}

/// (H, W) coordinates; NaN is one that is not known.
pub(super) fn values_of(values: &Bound<'_, PyAny>, what: &str) -> PyResult<(Vec<f32>, [usize; 2])> {
    let plane = plane_of(values, what)?;
    let view = plane.as_array();
    if let Some(((y, x), value)) = view.indexed_iter().find(|(_, x)| x.is_infinite()) {
        let found = format!("{value} at [{y}, {x}]");
        return Err(errors::invalid(values.py(), what, "finite numbers, NaN where one is not known", &found));
    }
    Ok((view.iter().copied().collect(), [view.nrows(), view.ncols()]))
}

/// (H, W) numbers within limits, or one for all.
pub(super) fn floats(
    values: &Bound<'_, PyAny>,
    shape: [usize; 2],
    what: &str,
    [low, high]: [f32; 2],
) -> PyResult<Vec<f32>> {
    let list = given(values, shape, what)?;
    match list.iter().find(|x| !(low..=high).contains(*x)) {
        Some(x) => {
            Err(errors::invalid(values.py(), what, &format!("numbers from {low} to {high}"), &x.to_string()))
        }
        None => Ok(list),
    }
}

/// 1σ of `values`: above zero where there is a value, NaN where there is none.
pub(super) fn sigma_of(
    py: Python<'_>,
    sigma: Option<&Bound<'_, PyAny>>,
    shape: [usize; 2],
    what: &str,
    values: &[f32],
) -> PyResult<Vec<f32>> {
    let mut list =
        sigma.map_or_else(|| Ok(vec![USUAL_SIGMA_PX; values.len()]), |sigma| given(sigma, shape, what))?;
    for (i, (sigma, value)) in list.iter_mut().zip(values).enumerate() {
        if value.is_nan() {
            *sigma = f32::NAN;
        } else if !(sigma.is_finite() && *sigma > 0.0) {
            let found = format!("{sigma} at [{}, {}]", i / shape[1], i % shape[1]);
            let wanted = "numbers above zero where there is a position";
            return Err(errors::invalid(py, what, wanted, &found));
        }
    }
    Ok(list)
}

/// (H, W) numbers, or one for all.
fn given(values: &Bound<'_, PyAny>, [height, width]: [usize; 2], what: &str) -> PyResult<Vec<f32>> {
    if let Ok(one) = values.extract::<f32>() {
        return Ok(vec![one; height * width]);
    }
    let plane = plane_of(values, what)?;
    let view = plane.as_array();
    if view.dim() != (height, width) {
        let found = format!("shape {}", shape_in_words(view.shape()));
        return Err(errors::invalid(values.py(), what, &format!("shape ({height}, {width})"), &found));
    }
    Ok(view.iter().copied().collect())
}

/// (H, W, 3) colours.
pub(super) fn color_of(values: &Bound<'_, PyAny>, [height, width]: [usize; 2]) -> PyResult<Vec<[u8; 3]>> {
    let wanted = format!("an array of uint8 with shape ({height}, {width}, 3)");
    let Ok(array) = values.cast::<PyArray3<u8>>() else {
        let found = match values.cast::<PyUntypedArray>() {
            Ok(a) => format!("dtype {}, shape {}", a.dtype(), shape_in_words(a.shape())),
            Err(_) => crate::convert::object::named(values),
        };
        return Err(errors::wrong_type("color", &wanted, &found));
    };
    if array.shape() != [height, width, 3] {
        let found = format!("shape {}", shape_in_words(array.shape()));
        return Err(errors::invalid(values.py(), "color", &wanted, &found));
    }
    let read = array.readonly();
    let bytes: Vec<u8> = read.as_array().iter().copied().collect();
    Ok(bytes.as_chunks().0.to_vec())
}
