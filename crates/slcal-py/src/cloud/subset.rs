//! Parts of a cloud: by index, and within a box.

use numpy::{PyArrayLike1, PyUntypedArray, PyUntypedArrayMethods as _};
use pyo3::prelude::*;

use super::PointCloud;
use crate::convert::array::{Numbers, shape_in_words};
use crate::convert::object::named;
use crate::errors;

/// The points with these indices, in their order, and the triangles whose corners are all among them.
fn subset(cloud: &slcal_core::PointCloud, indices: &[usize]) -> slcal_core::PointCloud {
    let mut new_index = vec![None; cloud.points.len()];
    for (new, &old) in indices.iter().enumerate() {
        new_index[old].get_or_insert(new as u32);
    }
    let triangle = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| new_index[i as usize]);
        Some([a?, b?, c?])
    };
    slcal_core::PointCloud {
        points: indices.iter().map(|&i| cloud.points[i]).collect(),
        triangles: cloud.triangles.iter().filter_map(triangle).collect(),
        normals: indices.iter().filter_map(|&i| cloud.normals.get(i).copied()).collect(),
        frame: cloud.frame,
        camera_centre: cloud.camera_centre,
    }
}

/// A corner of a box; infinite where a side is open.
fn corner_of(values: &Bound<'_, PyAny>, what: &str) -> PyResult<[f64; 3]> {
    let numbers = Numbers::of(values, what)?;
    let view = numbers.view();
    match view.iter().copied().collect::<Vec<_>>()[..] {
        [x, y, z] if !(x.is_nan() || y.is_nan() || z.is_nan()) => Ok([x, y, z]),
        _ => {
            let wanted = "three coordinates in mm, infinite where a side of the box is open";
            let found = format!("shape {}", shape_in_words(view.shape()));
            let found = if view.len() == 3 { "NaN" } else { &found };
            Err(errors::invalid(values.py(), what, wanted, found))
        }
    }
}

#[pymethods]
impl PointCloud {
    fn __getitem__(&self, py: Python<'_>, index: &Bound<'_, PyAny>) -> PyResult<Self> {
        // NumPy knows what an index means, and what is wrong with it.
        let all = py.import("numpy")?.call_method1("arange", (self.cloud.points.len(),))?;
        let chosen = all.get_item(index)?;
        if !chosen.cast::<PyUntypedArray>().is_ok_and(|a| a.ndim() == 1) {
            let wanted = "a boolean mask, an array of integers or a slice";
            let found = format!("{}; the coordinates of one point are cloud.points[i]", named(index));
            return Err(errors::wrong_type("index", wanted, &found));
        }
        let chosen: PyArrayLike1<'_, i64> = chosen.extract()?;
        let indices: Vec<usize> = chosen.as_array().iter().map(|&i| i as usize).collect();
        Ok(py.detach(|| subset(&self.cloud, &indices)).into())
    }

    /// The points within a box whose sides are parallel to the axes of the cloud's own `frame`.
    ///
    /// Triangles are kept where all three corners are. The `report` is None.
    ///
    /// Parameters
    /// ----------
    /// min, max : array_like
    ///     (3,), mm: least and greatest x, y and z, both included; infinite where a side is open.
    ///
    /// Returns
    /// -------
    /// PointCloud
    ///     In the same frame and order; without points when there are none in the box.
    ///
    /// Raises
    /// ------
    /// Error
    ///     When a coordinate is NaN, or one of `min` exceeds that of `max`.
    ///
    /// Examples
    /// --------
    /// >>> cloud = slcal.PointCloud([[0, 0, 900], [0, 0, 1100], [300, 0, 1000]])
    /// >>> cloud.crop([-100, -100, 0], [100, 100, 1000]).points
    /// array([[  0.,   0., 900.]])
    /// >>> len(cloud.crop([-np.inf, -np.inf, 1000], [np.inf, np.inf, np.inf]))
    /// 2
    fn crop(&self, py: Python<'_>, min: &Bound<'_, PyAny>, max: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (low, high) = (corner_of(min, "min")?, corner_of(max, "max")?);
        if let Some(i) = (0..3).find(|&i| low[i] > high[i]) {
            let wanted = format!("no {} below the {} of min", ["x", "y", "z"][i], low[i]);
            return Err(errors::invalid(py, "max", &wanted, &high[i].to_string()));
        }
        let inside = |i: &usize| {
            let p = &self.cloud.points[*i].position;
            (0..3).all(|k| (low[k]..=high[k]).contains(&p[k]))
        };
        let cropped = || {
            let indices: Vec<usize> = (0..self.cloud.points.len()).filter(inside).collect();
            subset(&self.cloud, &indices)
        };
        Ok(py.detach(cropped).into())
    }
}
