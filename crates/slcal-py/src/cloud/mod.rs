//! Points in space.

mod display;
mod file;
mod subset;

use std::path::Path;

use nalgebra::{Point2, Point3, Vector3};
use numpy::PyReadonlyArray2;
use numpy::ndarray::ArrayView1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use slcal_core::{CloudPoint, Frame};

use crate::convert::array::{Numbers, column, rows, rows_of, shape_in_words, vector_of};
use crate::convert::columns::{as_many, colors_of, integers_of, within};
use crate::convert::object::{self, Argument};
use crate::convert::option::{parsed, parsed_or};
use crate::convert::report::LazyReport;
use crate::errors;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PointCloud>()
}

/// Points in space with their properties, and the triangles of a mesh where one was requested.
///
/// `Rig.reconstruct` and `Rig.triangulate` return clouds; they can also be made from arrays. Two of them are equal when
/// their numbers are (NaN equals NaN); the report is not compared. ``np.asarray(cloud)`` gives the points.
///
/// ``cloud[index]`` is the cloud of some of the points, by a boolean mask, an array of integers or a slice. It keeps the
/// triangles whose three corners are all among them, with new indices; of a point that is given twice the first counts. Its
/// `report` is None.
///
/// Parameters
/// ----------
/// points : array_like
///     (N, 3), mm.
/// colors : array_like, optional
///     (N, 3), sRGB from 0 to 255; black unless given.
/// sigma : array_like, optional
///     (N,) or one for all: 1σ along the camera's ray, mm; 0 unless given.
/// noise : array_like, optional
///     (N,) or one for all: the part of `sigma` that varies from point to point, mm; 0 unless given.
/// pixels : array_like, optional
///     (N, 2): the camera pixels of the points; NaN unless given.
/// slits : array_like, optional
///     (N,): numbers of the slits; 0 unless given.
/// confidence : array_like, optional
///     (N,) or one for all, 0 to 1; 1 unless given.
/// triangles : array_like, optional
///     (M, 3): indices into the points, counter-clockwise as the camera sees them.
/// normals : array_like, optional
///     (N, 3): unit vectors towards the camera, zero where one is not known.
/// frame : {"camera", "plane"}, default "camera"
///     The coordinate frame: the camera's, or that of the sheet in the rig's first view.
/// camera_centre : array_like, optional
///     (3,): the position of the camera in these coordinates, mm; the origin unless given.
///
/// Raises
/// ------
/// Error
///     When shapes do not match, points are not finite, or a number is out of range.
/// TypeError
///     When something is not an array of numbers.
///
/// Examples
/// --------
/// >>> cloud = slcal.PointCloud([[0, 0, 1000], [3, 4, 1000]], sigma=0.2)
/// >>> cloud
/// PointCloud(2 points, 1000.0 to 1000.0 mm from the camera, median σ 0.200 mm)
/// >>> np.asarray(cloud).shape
/// (2, 3)
/// >>> cloud[cloud.points[:, 0] > 1].points
/// array([[   3.,    4., 1000.]])
#[pyclass(frozen, module = "slcal", eq, mapping)]
pub(crate) struct PointCloud {
    pub(crate) cloud: slcal_core::PointCloud,
    pub(crate) report: LazyReport,
}

impl PartialEq for PointCloud {
    fn eq(&self, other: &Self) -> bool {
        let (a, b) = (&self.cloud, &other.cloud);
        a.triangles == b.triangles
            && a.normals == b.normals
            && a.frame == b.frame
            && a.camera_centre == b.camera_centre
            && a.points.len() == b.points.len()
            && a.points.iter().zip(&b.points).all(|(p, q)| same_point(p, q))
    }
}

/// What is a number of a point.
const NUMBERS: usize = 8;

fn numbers(p: &CloudPoint) -> [f64; NUMBERS] {
    let (x, u) = (p.position, p.pixel);
    [x.x, x.y, x.z, u.x, u.y, p.sigma_mm, p.noise_mm, p.confidence]
}

fn same_point(p: &CloudPoint, q: &CloudPoint) -> bool {
    let same = |(a, b): (&f64, &f64)| a == b || (a.is_nan() && b.is_nan());
    p.color == q.color
        && p.slit.unwrap_or(0) == q.slit.unwrap_or(0)
        && numbers(p).iter().zip(&numbers(q)).all(same)
}

impl From<slcal_core::PointCloud> for PointCloud {
    fn from(cloud: slcal_core::PointCloud) -> Self {
        Self { cloud, report: LazyReport::default() }
    }
}

/// (M, 3) indices of `n` points.
fn triangles_of(values: &Bound<'_, PyAny>, n: usize) -> PyResult<Vec<[u32; 3]>> {
    let index = |x: f64| (x.fract() == 0.0 && x >= 0.0 && x < n as f64).then_some(x as u32);
    let triangle = |(i, t): (usize, [f64; 3])| {
        if let [Some(a), Some(b), Some(c)] = t.map(index) {
            return Ok([a, b, c]);
        }
        let found = format!("{t:?} in row {i}");
        Err(errors::invalid(values.py(), "triangles", &format!("indices of the {n} points"), &found))
    };
    rows_of::<3>(values, "triangles")?.into_iter().enumerate().map(triangle).collect()
}

fn normals_of(values: &Bound<'_, PyAny>, n: usize) -> PyResult<Vec<Vector3<f32>>> {
    let normals = rows_of::<3>(values, "normals")?;
    as_many(values.py(), "normals", normals.len(), n)?;
    Ok(normals.into_iter().map(|n| Vector3::from(n).cast()).collect())
}

fn slits_of(values: &Bound<'_, PyAny>, n: usize) -> PyResult<Vec<u16>> {
    let slits = integers_of(values, "slits", [0, i64::from(u16::MAX)])?;
    as_many(values.py(), "slits", slits.len(), n)?;
    Ok(slits.into_iter().map(|s| s as u16).collect())
}

/// (N, 2) pixels, NaN where a point was seen in none.
fn pixels_of(values: &Bound<'_, PyAny>, n: usize) -> PyResult<Vec<[f64; 2]>> {
    let numbers = Numbers::of(values, "pixels")?;
    let view = numbers.view();
    if view.shape() != [n, 2] {
        let found = shape_in_words(view.shape());
        let wanted = format!("shape ({n}, 2)");
        return Err(errors::invalid(values.py(), "pixels", &wanted, &format!("shape {found}")));
    }
    Ok((0..n).map(|i| [view[[i, 0]], view[[i, 1]]]).collect())
}

impl Argument for PointCloud {
    const EXPECTED: &'static str = "a PointCloud";
    const OF_ARRAY: &'static str = "slcal.PointCloud(points)";
    const OF_OTHER: &'static str = "slcal.PointCloud(points), or rig.reconstruct(image, pattern)";

    fn of_path(path: &Path) -> String {
        object::load("PointCloud", path)
    }
}

#[pymethods]
impl PointCloud {
    #[new]
    #[pyo3(
        signature = (
            points, *, colors=None, sigma=None, noise=None, pixels=None, slits=None, confidence=None, triangles=None,
            normals=None, frame=None, camera_centre=None
        ),
        text_signature = "(points, *, colors=None, sigma=None, noise=None, pixels=None, slits=None, confidence=None, \
                          triangles=None, normals=None, frame='camera', camera_centre=None)"
    )]
    #[allow(clippy::too_many_arguments, reason = "what is known of points")]
    fn new(
        points: &Bound<'_, PyAny>,
        colors: Option<&Bound<'_, PyAny>>,
        sigma: Option<&Bound<'_, PyAny>>,
        noise: Option<&Bound<'_, PyAny>>,
        pixels: Option<&Bound<'_, PyAny>>,
        slits: Option<&Bound<'_, PyAny>>,
        confidence: Option<&Bound<'_, PyAny>>,
        triangles: Option<&Bound<'_, PyAny>>,
        normals: Option<&Bound<'_, PyAny>>,
        frame: Option<&Bound<'_, PyAny>>,
        camera_centre: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let points = rows_of::<3>(points, "points")?;
        let n = points.len();
        let colors = colors.map(|v| colors_of(v, n)).transpose()?;
        let sigma = sigma.map(|v| within(v, n, "sigma", f64::MAX)).transpose()?;
        let noise = noise.map(|v| within(v, n, "noise", f64::MAX)).transpose()?;
        let pixels = pixels.map(|v| pixels_of(v, n)).transpose()?;
        let slits = slits.map(|v| slits_of(v, n)).transpose()?;
        let confidence = confidence.map(|v| within(v, n, "confidence", 1.0)).transpose()?;
        let triangles = triangles.map_or(Ok(Vec::new()), |v| triangles_of(v, n))?;
        let normals = normals.map_or(Ok(Vec::new()), |v| normals_of(v, n))?;
        let camera_centre = camera_centre.map_or(Ok([0.0; 3]), |v| vector_of(v, "camera_centre"))?;
        let point = |(i, p): (usize, [f64; 3])| CloudPoint {
            position: Point3::from(p),
            pixel: Point2::from(pixels.as_ref().map_or([f64::NAN; 2], |u| u[i])),
            color: colors.as_ref().map_or([0; 3], |c| c[i]),
            sigma_mm: sigma.as_ref().map_or(0.0, |s| s[i]),
            noise_mm: noise.as_ref().map_or(0.0, |s| s[i]),
            slit: slits.as_ref().map(|s| s[i]),
            confidence: confidence.as_ref().map_or(1.0, |c| c[i]),
        };
        let points = points.into_iter().enumerate().map(point).collect();
        let (frame, camera_centre) = (parsed_or(frame, "frame", Frame::Camera)?, Point3::from(camera_centre));
        Ok(slcal_core::PointCloud { points, triangles, normals, frame, camera_centre }.into())
    }

    /// Positions: (N, 3) float64, mm.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(py, self.cloud.points.iter().map(|p| p.position.into()))
    }

    /// Colours: (N, 3) uint8, sRGB.
    #[getter]
    fn colors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(py, self.cloud.points.iter().map(|p| p.color))
    }

    /// 1σ along the camera's ray: (N,) float64, mm; of the match and of the rig together.
    #[getter]
    fn sigma<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        column(py, self.cloud.points.iter().map(|p| p.sigma_mm))
    }

    /// The part of `sigma` that varies from point to point: (N,) float64, mm. The rest is common to the whole cloud.
    #[getter]
    fn noise<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        column(py, self.cloud.points.iter().map(|p| p.noise_mm))
    }

    /// Camera pixels (x, y) of the points: (N, 2) float64, NaN in clouds from files.
    #[getter]
    fn pixels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(py, self.cloud.points.iter().map(|p| [p.pixel.x, p.pixel.y]))
    }

    /// Numbers of the slits: (N,) uint16, 0 where the matches were not of stripes.
    #[getter]
    fn slits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        column(py, self.cloud.points.iter().map(|p| p.slit.unwrap_or(0)))
    }

    /// Confidence of the matches: (N,) float64, 0 to 1.
    #[getter]
    fn confidence<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        column(py, self.cloud.points.iter().map(|p| p.confidence))
    }

    /// Indices into the points: (M, 3) uint32, counter-clockwise as the camera sees them; (0, 3) without a mesh.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(py, self.cloud.triangles.iter().copied())
    }

    /// Unit vectors perpendicular to the surface, towards the camera: (N, 3) float32, zero for a point without neighbours; None where they
    /// are not known. Clouds of a sequence have them.
    #[getter]
    fn normals<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let known = self.cloud.known_normals();
        known.map(|n| rows(py, n.iter().map(|n| [n.x, n.y, n.z]))).transpose()
    }

    /// The coordinate frame: "camera", or "plane" for that of the sheet in the rig's first view.
    #[getter]
    fn frame(&self) -> &'static str {
        self.cloud.frame.name()
    }

    /// The position of the camera in these coordinates: (3,) float64, mm.
    #[getter]
    fn camera_centre<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        column(py, self.cloud.camera_centre.iter().copied())
    }

    /// Counts and measurements of the reconstruction; None for a cloud that was constructed, loaded or is a part of
    /// another.
    #[getter]
    fn report(&self, py: Python<'_>) -> PyResult<Option<Py<PyAny>>> {
        self.report.get(py)
    }

    fn __len__(&self) -> usize {
        self.cloud.points.len()
    }

    /// The points as NumPy takes them: ``np.asarray(cloud)`` is (N, 3) float64, mm.
    #[pyo3(signature = (dtype=None, copy=None))]
    fn __array__<'py>(
        &self,
        py: Python<'py>,
        dtype: Option<&Bound<'py, PyAny>>,
        copy: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if copy == Some(false) {
            return Err(PyValueError::new_err("a cloud's points cannot be an array without a copy"));
        }
        let points = self.points(py)?;
        let Some(dtype) = dtype else { return Ok(points) };
        let options = PyDict::new(py);
        options.set_item("copy", false)?;
        points.call_method("astype", (dtype,), Some(&options))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let state = [
            rows(py, self.cloud.points.iter().map(numbers))?,
            self.colors(py)?,
            self.slits(py)?,
            self.triangles(py)?,
            self.frame().into_pyobject(py)?.into_any(),
            self.camera_centre(py)?,
            self.report(py)?.into_pyobject(py)?,
            self.normals(py)?.into_pyobject(py)?,
        ];
        Ok((py.get_type::<Self>().getattr("_restored")?, PyTuple::new(py, state)?))
    }

    #[staticmethod]
    #[pyo3(signature = (numbers, colors, slits, triangles, frame, camera_centre, report, normals=None))]
    #[allow(clippy::too_many_arguments, reason = "a pickle's state")]
    fn _restored(
        numbers: PyReadonlyArray2<'_, f64>,
        colors: &Bound<'_, PyAny>,
        slits: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
        frame: &Bound<'_, PyAny>,
        camera_centre: [f64; 3],
        report: Option<Py<PyAny>>,
        normals: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let py = colors.py();
        let numbers = numbers.as_array();
        let n = numbers.nrows();
        as_many(py, "columns of a pickle", numbers.ncols(), NUMBERS)?;
        let (colors, slits) = (colors_of(colors, n)?, slits_of(slits, n)?);
        let point = |((row, color), slit): ((ArrayView1<'_, f64>, [u8; 3]), u16)| CloudPoint {
            position: Point3::new(row[0], row[1], row[2]),
            pixel: Point2::new(row[3], row[4]),
            color,
            sigma_mm: row[5],
            noise_mm: row[6],
            slit: Some(slit),
            confidence: row[7],
        };
        let points = numbers.rows().into_iter().zip(colors).zip(slits).map(point).collect();
        let cloud = slcal_core::PointCloud {
            points,
            triangles: triangles_of(triangles, n)?,
            frame: parsed(frame, "frame")?,
            camera_centre: Point3::from(camera_centre),
            normals: normals.map_or(Ok(Vec::new()), |v| normals_of(v, n))?,
        };
        Ok(Self { cloud, report: LazyReport::restored(py, report) })
    }
}
