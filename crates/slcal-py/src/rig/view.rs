//! What a rig says of its views and of its own uncertainty.

use nalgebra::Point3;
use pyo3::prelude::*;
use slcal_core::nalgebra::Vector3;

use crate::convert::array::{rows, shaped};
use crate::convert::report::record;
use crate::geometry::Pose;

/// One pose of the sheet that a rig was calibrated from.
#[pyclass(frozen, module = "slcal", eq)]
#[derive(PartialEq)]
pub(crate) struct View(pub(crate) slcal_core::View);

fn vanishing<'py>(py: Python<'py>, points: &[Vector3<f64>; 2]) -> PyResult<Bound<'py, PyAny>> {
    rows(py, points.iter().map(|p| [p.x, p.y, p.z]))
}

#[pymethods]
impl View {
    /// Name of the photograph, where it has one.
    #[getter]
    fn photo(&self) -> Option<&str> {
        self.0.photo.as_deref()
    }

    /// Width and height of the sheet, mm.
    #[getter]
    fn size_mm(&self) -> (f64, f64) {
        (self.0.size.width_mm, self.0.size.height_mm)
    }

    /// X_camera = R · X_sheet + t, mm; the sheet's origin is its top-left corner, x along its top side.
    #[getter]
    fn camera_from_sheet(&self) -> Pose {
        self.0.camera_from_sheet.into()
    }

    /// How the sheet bends out of its mean plane; None where it was taken for flat.
    #[getter]
    fn bend<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let json = |b: &slcal_core::ViewBend| {
            serde_json::json!({
                "coefficients_mm": b.shape, "sigma_mm": b.sigma_mm, "expected_sigma_mm": b.expected_mm,
                "sag_mm": b.shape.sag_mm(self.0.size).0,
            })
        };
        self.0.bend.as_ref().map(|b| record(py, "ViewBend", &json(b))).transpose()
    }

    /// X_projector = R · X_sheet + t, mm; None without a projector.
    #[getter]
    fn projector_from_sheet(&self) -> Option<Pose> {
        self.0.projector_from_sheet.map(Pose::from)
    }

    /// Vanishing points of the sheet's sides in the camera: (2, 3) float64, homogeneous px.
    #[getter]
    fn camera_vanishing_points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        vanishing(py, &self.0.camera_vanishing_points)
    }

    /// The same in the projector; None without one.
    #[getter]
    fn projector_vanishing_points<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.0.projector_vanishing_points.as_ref().map(|v| vanishing(py, v)).transpose()
    }

    /// Corners of the sheet TL, TR, BR, BL in the camera's image: (4, 2) float64, px.
    #[getter]
    fn corners_px<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(py, self.0.corners_px.iter().map(|c| [c.x, c.y]))
    }

    /// Root mean square residuals; None in rigs that do not state them.
    #[getter]
    fn rms_px<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let json = |r: &slcal_core::ViewRms| serde_json::json!({ "edges": r.edges, "corners": r.corners, "projector": r.projector });
        self.0.rms_px.as_ref().map(|r| record(py, "ViewRms", &json(r))).transpose()
    }

    /// How much of the lit sheet is overexposed in the photograph, per cent; None where nothing is, or it was not measured.
    #[getter]
    fn clipped_percent(&self) -> Option<f64> {
        self.0.clipped_percent
    }

    fn __repr__(&self) -> String {
        let size = self.0.size;
        let middle = Point3::new(size.width_mm / 2.0, size.height_mm / 2.0, 0.0);
        let distance = self.0.camera_from_sheet.transform(&middle).coords.norm();
        let photo = self.0.photo.as_deref().map_or(String::new(), |p| format!("{p}, "));
        format!("View({photo}{} x {} mm, {distance:.0} mm away)", size.width_mm, size.height_mm)
    }
}

/// Covariance of all estimated parameters.
#[pyclass(frozen, module = "slcal", eq)]
#[derive(PartialEq)]
pub(crate) struct Covariance(pub(crate) slcal_core::Covariance);

#[pymethods]
impl Covariance {
    /// Names of rows and columns.
    #[getter]
    fn parameters(&self) -> Vec<String> {
        self.0.parameters.iter().map(ToString::to_string).collect()
    }

    /// (P, P) float64, symmetric, in the units of the parameters (px, mm, rad).
    #[getter]
    fn matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        // Symmetric: which of rows and columns comes first does not matter.
        let m = &self.0.matrix;
        shaped(py, m.transpose().as_slice().to_vec(), &[m.nrows(), m.ncols()])
    }

    fn __repr__(&self) -> String {
        format!("Covariance({} parameters)", self.0.parameters.len())
    }
}
