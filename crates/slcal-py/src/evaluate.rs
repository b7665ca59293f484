//! How far the points of a cloud lie from a plane or a sphere.

use nalgebra::Point3;
use pyo3::prelude::*;
use serde_json::{Value, json};
use slcal_core::evaluate::{FitConfig, fit_plane, fit_sphere};
use slcal_core::{CloudPoint, Result};

use crate::cloud::PointCloud;
use crate::convert::array::rows_of;
use crate::convert::object::refused;
use crate::convert::option::one_of;
use crate::convert::report::record;
use crate::errors::{Raise as _, Stage};
use crate::files;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(evaluate, module)?)
}

/// A function that fits one shape and gives its record.
type Fit = for<'py> fn(Python<'py>, &slcal_core::PointCloud) -> PyResult<Bound<'py, PyAny>>;

/// Fits a plane or a sphere to a cloud and reports the distances of its points, as ``slcal evaluate`` does.
///
/// The fit is robust: the cloud may contain other surfaces as well. Inliers lie within four times the robust σ, and the
/// report is about the inliers.
///
/// Parameters
/// ----------
/// cloud : PointCloud or array_like
///     The points; an array is (N, 3), mm, in the camera's frame.
/// shape : {"plane", "sphere"}
///     What to fit.
///
/// Returns
/// -------
/// PlaneFit or SphereFit
///
/// Raises
/// ------
/// Error
///     When there are too few points, they are not finite, or no such shape is found.
///
/// Examples
/// --------
/// >>> x, y = np.meshgrid(np.arange(20.0), np.arange(20.0))
/// >>> fit = slcal.evaluate(np.stack([x, y, 1000 + 0.5 * x], axis=-1).reshape(-1, 3), "plane")
/// >>> fit.report.inliers, bool(fit.report.rms_mm < 1e-9)
/// (400, True)
#[pyfunction]
fn evaluate<'py>(cloud: &Bound<'py, PyAny>, shape: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = cloud.py();
    let fit = one_of(shape, "shape", &[("plane", plane as Fit), ("sphere", sphere as Fit)])?;
    if let Ok(cloud) = cloud.cast::<PointCloud>() {
        return fit(py, &cloud.get().cloud);
    }
    let point = |p: [f64; 3]| CloudPoint {
        position: Point3::from(p),
        pixel: Point3::from([f64::NAN; 3]).xy(),
        color: [0; 3],
        sigma_mm: 0.0,
        noise_mm: 0.0,
        slit: None,
        confidence: 1.0,
    };
    if files::path_of(cloud)?.is_some() || cloud.is_none() {
        return Err(refused::<PointCloud>(cloud, "cloud", "a PointCloud, or an array of shape (N, 3)"));
    }
    let points = rows_of::<3>(cloud, "cloud")?.into_iter().map(point).collect();
    fit(py, &slcal_core::PointCloud { points, ..slcal_core::PointCloud::default() })
}

#[pymethods]
impl PointCloud {
    /// Fits a plane to the points, which may contain other surfaces as well.
    ///
    /// Returns
    /// -------
    /// PlaneFit
    ///     The plane, and the distances of its inliers.
    ///
    /// Raises
    /// ------
    /// Error
    ///     When there are fewer than three points, or no plane is found.
    fn fit_plane<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        plane(py, &self.cloud)
    }

    /// Fits a sphere to the points, which may contain a wall as well.
    ///
    /// Returns
    /// -------
    /// SphereFit
    ///     The sphere, and the distances of its inliers.
    ///
    /// Raises
    /// ------
    /// Error
    ///     When there are fewer than four points, or no sphere that the camera could see is found.
    fn fit_sphere<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        sphere(py, &self.cloud)
    }
}

/// The plane of a cloud.
fn plane<'py>(py: Python<'py>, cloud: &slcal_core::PointCloud) -> PyResult<Bound<'py, PyAny>> {
    fitted(py, "PlaneFit", "plane", |config| fit_plane(cloud, config).map(|fit| json!(fit.to_json(config))))
}

/// The sphere of a cloud.
fn sphere<'py>(py: Python<'py>, cloud: &slcal_core::PointCloud) -> PyResult<Bound<'py, PyAny>> {
    fitted(py, "SphereFit", "sphere", |config| {
        fit_sphere(cloud, config).map(|fit| json!(fit.to_json(config)))
    })
}

/// The record of a fit, from what the command says of it: {shape: {parameters}, figures}.
fn fitted<'py>(
    py: Python<'py>,
    class: &str,
    shape: &str,
    fit: impl FnOnce(&FitConfig) -> Result<Value> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let mut report = py.detach(|| fit(&FitConfig::default())).raise(py, Stage::Evaluate)?;
    let mut fields = report.get_mut(shape).map(Value::take).unwrap_or_default();
    fields["report"] = report;
    record(py, class, &fields)
}
