//! Poses: a rotation and a translation.

use std::path::Path;

use nalgebra::{Matrix3, Point3, Rotation3, Vector3};
use pyo3::prelude::*;
use slcal_core::geometry;

use crate::convert::array::{Numbers, column, matrix, matrix_of, rows, rows_of, vector_of};
use crate::convert::object::Argument;
use crate::errors::{Raise as _, Stage};

/// A pose by a rotation matrix or vector, and a translation.
pub(crate) fn pose_of(
    py: Python<'_>,
    r: &Bound<'_, PyAny>,
    t: &Bound<'_, PyAny>,
) -> PyResult<geometry::Pose> {
    let translation = Vector3::from(vector_of::<3>(t, "t")?);
    if Numbers::of(r, "R")?.view().len() == 3 {
        let rotation = Rotation3::new(Vector3::from(vector_of::<3>(r, "R")?));
        return Ok(geometry::Pose { rotation, translation });
    }
    let rows = matrix_of(r, "R")?;
    let matrix = Matrix3::from_fn(|i, j| rows[i][j]);
    geometry::Pose::from_matrix(&matrix, translation).raise(py, Stage::Detect)
}

/// A rotation and a translation: X_a = R · X_b + t.
///
/// Parameters
/// ----------
/// R : array_like
///     (3, 3) rotation matrix, or (3,) rotation vector (axis times angle in rad, as of ``cv2.Rodrigues``).
/// t : array_like
///     (3,), mm.
///
/// Raises
/// ------
/// Error
///     When R is not a rotation, or a number is not finite.
///
/// Examples
/// --------
/// >>> pose = slcal.Pose(R=np.eye(3), t=[200, 10, -5])
/// >>> pose.inverse().t
/// array([-200.,  -10.,    5.])
/// >>> (pose @ pose).t
/// array([400.,  20., -10.])
#[pyclass(frozen, module = "slcal", eq)]
#[derive(PartialEq, Clone)]
#[allow(clippy::struct_field_names, reason = "it is the core's pose, with its σ beside")]
pub(crate) struct Pose {
    pub(crate) pose: geometry::Pose,
    pub(crate) sigma_t_mm: Option<[f64; 3]>,
    pub(crate) sigma_r_rad: Option<[f64; 3]>,
}

impl From<geometry::Pose> for Pose {
    fn from(pose: geometry::Pose) -> Self {
        Self { pose, sigma_t_mm: None, sigma_r_rad: None }
    }
}

impl Pose {
    /// As axis times angle; not NaN for the smallest of angles either.
    fn rotation_vector(&self) -> Vector3<f64> {
        self.pose.rotation_vector_from(&geometry::Pose::identity())
    }
}

impl Argument for Pose {
    const EXPECTED: &'static str = "a Pose";
    const OF_ARRAY: &'static str = "slcal.Pose(R, t)";

    fn of_path(path: &Path) -> String {
        format!("slcal.Rig.load({:?}).projector_from_camera", path.display().to_string())
    }
}

#[pymethods]
impl Pose {
    #[new]
    #[allow(non_snake_case, reason = "the name that the field has for it")]
    fn new(R: &Bound<'_, PyAny>, t: &Bound<'_, PyAny>) -> PyResult<Self> {
        pose_of(R.py(), R, t).map(Self::from)
    }

    /// The rotation matrix: (3, 3) float64.
    #[getter]
    #[pyo3(name = "R")]
    fn r<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        matrix(py, self.pose.rotation.matrix())
    }

    /// The translation: (3,) float64, mm.
    #[getter]
    fn t<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        column(py, self.pose.translation.iter().copied())
    }

    /// The rotation as axis times angle: (3,) float64, rad, as of ``cv2.Rodrigues``.
    #[getter]
    fn rvec<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        column(py, self.rotation_vector().iter().copied())
    }

    /// Both as one homogeneous matrix: (4, 4) float64.
    #[getter]
    fn matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mut m = self.pose.rotation.to_homogeneous();
        m.fixed_view_mut::<3, 1>(0, 3).copy_from(&self.pose.translation);
        rows(py, m.row_iter().map(|r| [r[0], r[1], r[2], r[3]]))
    }

    /// 1σ of t: (3,) float64, mm; None where it is not known.
    #[getter]
    fn sigma_t_mm<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.sigma_t_mm.map(|s| column(py, s.into_iter())).transpose()
    }

    /// 1σ of a small rotation about the axes of frame a: (3,) float64, rad; None where it is not known.
    #[getter]
    fn sigma_r_rad<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.sigma_r_rad.map(|s| column(py, s.into_iter())).transpose()
    }

    /// The inverse: X_b = Rᵀ · X_a − Rᵀ · t. It has no σ.
    fn inverse(&self) -> Self {
        self.pose.inverse().into()
    }

    /// R · X + t for each point: (N, 3) float64 from (N, 3), mm.
    fn transform<'py>(&self, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = points.py();
        let points = rows_of::<3>(points, "points")?;
        rows(py, points.into_iter().map(|p| <[f64; 3]>::from(self.pose.transform(&Point3::from(p)))))
    }

    /// Composition: (a from b) @ (b from c) is (a from c). It has no σ.
    fn __matmul__(&self, other: &Self) -> Self {
        self.pose.compose(&other.pose).into()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, PoseState)> {
        let r = self.pose.rotation.matrix();
        let rows = [0, 1, 2].map(|i| [r[(i, 0)], r[(i, 1)], r[(i, 2)]]);
        let state = (rows, self.pose.translation.into(), self.sigma_t_mm, self.sigma_r_rad);
        Ok((py.get_type::<Self>().getattr("_restored")?, state))
    }

    #[staticmethod]
    fn _restored(
        r: [[f64; 3]; 3],
        t: [f64; 3],
        sigma_t_mm: Option<[f64; 3]>,
        sigma_r_rad: Option<[f64; 3]>,
    ) -> Self {
        let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_fn(|i, j| r[i][j]));
        Self { pose: geometry::Pose { rotation, translation: t.into() }, sigma_t_mm, sigma_r_rad }
    }

    fn __repr__(&self) -> String {
        let (angle, t) = (self.rotation_vector().norm().to_degrees(), self.pose.translation);
        format!("Pose(rotation {angle:.2}°, t = [{:.1}, {:.1}, {:.1}] mm)", t.x, t.y, t.z)
    }
}

type PoseState = ([[f64; 3]; 3], [f64; 3], Option<[f64; 3]>, Option<[f64; 3]>);
