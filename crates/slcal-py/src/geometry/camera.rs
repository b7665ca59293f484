//! Cameras: intrinsics and distortion.

use std::path::Path;

use nalgebra::{Matrix3, Point2, Point3};
use pyo3::prelude::*;
use slcal_cli::files::InputKind;
use slcal_core::format::read_camera;
use slcal_core::geometry::{self, Distortion, Intrinsics};
use slcal_core::{Device, DeviceSigma};

use crate::convert::array::{Numbers, column, matrix, matrix_of, rows, rows_of};
use crate::convert::object::{self, Argument};
use crate::convert::option::whole_pair;
use crate::convert::report::record;
use crate::errors::{self, Raise as _, Stage, raised_from};
use crate::files;

/// A camera or a projector: a pinhole model with distortion that maps points onto pixels, as in OpenCV.
///
/// Parameters
/// ----------
/// K : array_like
///     (3, 3), upper triangular, px: the camera matrix.
/// size : (int, int)
///     Width and height of the image or panel, px.
/// distortion : array_like, optional
///     Up to five of k1, k2, p1, p2, k3 in this order (OpenCV's "plumb bob"); none unless given.
///
/// Raises
/// ------
/// Error
///     When K is not a camera matrix, or a number is not finite.
///
/// Examples
/// --------
/// >>> camera = slcal.Camera([[1500, 0, 639.5], [0, 1500, 479.5], [0, 0, 1]], size=(1280, 960))
/// >>> camera.project([[0, 0, 1000], [100, 0, 1000]])
/// array([[639.5, 479.5],
///        [789.5, 479.5]])
#[pyclass(frozen, module = "slcal", eq)]
#[derive(PartialEq, Clone)]
pub(crate) struct Camera(pub(crate) Device);

impl Camera {
    fn of(model: geometry::Camera) -> Self {
        Self(Device { model, sigma: None })
    }
}

impl Argument for Camera {
    const EXPECTED: &'static str = "a Camera";
    const OF_ARRAY: &'static str = "slcal.Camera(K, size=(width, height))";

    fn of_path(path: &Path) -> String {
        object::load("Camera", path)
    }
}

#[pymethods]
impl Camera {
    #[new]
    #[pyo3(signature = (K, size, distortion=None))]
    #[allow(non_snake_case, reason = "the name that the field has for it")]
    fn new(
        K: &Bound<'_, PyAny>,
        size: &Bound<'_, PyAny>,
        distortion: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let py = K.py();
        let k = matrix_of(K, "K")?;
        let k = Matrix3::from_fn(|i, j| k[i][j]);
        let intrinsics = Intrinsics::from_matrix(&k).raise(py, Stage::Detect)?;
        let [width, height] = whole_pair(size, "size")?;
        let distortion = distortion.map_or(Ok(Distortion::NONE), distortion_of)?;
        Ok(Self::of(geometry::Camera { width, height, intrinsics, distortion }))
    }

    /// Reads a camera's intrinsics.
    ///
    /// Parameters
    /// ----------
    /// file : path or file object
    ///     A YAML or XML file of OpenCV, a camera_info of ROS, or a rig's JSON file, whose camera is taken. It must state
    ///     the size of the image.
    ///
    /// Returns
    /// -------
    /// Camera
    #[staticmethod]
    fn load(file: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = file.py();
        let contents = files::read(file, InputKind::Camera)?;
        let name = contents.name.as_deref();
        let known =
            read_camera(contents.bytes.as_slice()).map_err(|e| raised_from(py, &e, Stage::Detect, name))?;
        let Some([width, height]) = known.size else {
            return Err(errors::invalid(
                py,
                name.unwrap_or("camera file"),
                "an image size (image_width and image_height)",
                "none; give K, size and distortion to slcal.Camera instead",
            ));
        };
        let (intrinsics, distortion) = (known.intrinsics, known.distortion);
        Ok(Self::of(geometry::Camera { width, height, intrinsics, distortion }))
    }

    /// A camera without distortion, from its horizontal angle of view.
    ///
    /// Parameters
    /// ----------
    /// size : (int, int)
    ///     Width and height of the image, px.
    /// fov_deg : float
    ///     Angle of view across the width, degrees.
    ///
    /// Returns
    /// -------
    /// Camera
    #[staticmethod]
    fn from_fov(py: Python<'_>, size: &Bound<'_, PyAny>, fov_deg: f64) -> PyResult<Self> {
        let size = whole_pair(size, "size")?;
        geometry::Camera::from_fov(size, fov_deg).map(Self::of).raise(py, Stage::Detect)
    }

    /// A camera without distortion, from the 35 mm equivalent of its focal length, as EXIF tags state it.
    #[staticmethod]
    fn from_35mm(py: Python<'_>, size: &Bound<'_, PyAny>, focal_35mm: f64) -> PyResult<Self> {
        let size = whole_pair(size, "size")?;
        geometry::Camera::from_35mm(size, focal_35mm).map(Self::of).raise(py, Stage::Detect)
    }

    /// A projector, from its throw ratio (distance over width of the picture). Its principal point is on the lower edge of
    /// the panel, as with most lens shifts.
    #[staticmethod]
    fn from_throw(py: Python<'_>, size: &Bound<'_, PyAny>, throw: f64) -> PyResult<Self> {
        let size = whole_pair(size, "size")?;
        geometry::Camera::from_throw(size, throw).map(Self::of).raise(py, Stage::Detect)
    }

    /// The camera matrix: (3, 3) float64, px.
    #[getter]
    #[pyo3(name = "K")]
    fn k<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        matrix(py, &self.0.model.intrinsics.matrix())
    }

    /// k1, k2, p1, p2, k3: (5,) float64.
    #[getter]
    fn distortion<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        column(py, self.0.model.distortion.to_array().into_iter())
    }

    /// Width of the image, px.
    #[getter]
    fn width(&self) -> u32 {
        self.0.model.width
    }

    /// Height of the image, px.
    #[getter]
    fn height(&self) -> u32 {
        self.0.model.height
    }

    /// Width and height of the image, px.
    #[getter]
    fn size(&self) -> (u32, u32) {
        (self.0.model.width, self.0.model.height)
    }

    /// 1σ of the parameters, zero for those that were held fixed; None where it is not known.
    #[getter]
    fn sigma<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let json = |s: &DeviceSigma| {
            serde_json::json!({
                "focal_px": s.focal_px, "cx_px": s.cx_px, "cy_px": s.cy_px, "distortion": s.distortion,
                "aspect": s.aspect,
            })
        };
        self.0.sigma.as_ref().map(|s| record(py, "DeviceSigma", &json(s))).transpose()
    }

    /// Projects points onto pixels, as ``cv2.projectPoints`` without rotation and translation.
    ///
    /// Parameters
    /// ----------
    /// points : array_like
    ///     (N, 3), mm, in the camera's frame.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     (N, 2) float64, px.
    ///
    /// Raises
    /// ------
    /// Error
    ///     When a point lies behind the camera, or outside the range of the distortion model.
    fn project<'py>(&self, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = points.py();
        let points = rows_of::<3>(points, "points")?;
        let project = || each(&points, |p| self.0.model.project(&Point3::from(*p)).map(|q| [q.x, q.y]));
        let pixels = py.detach(project).map_err(|(i, p)| {
            let found = format!("[{}, {}, {}] in row {i}", p[0], p[1], p[2]);
            errors::invalid(py, "points", "points before the camera that its lens has pixels for", &found)
        })?;
        rows(py, pixels.into_iter())
    }

    /// Normalised image coordinates of pixels, without distortion: ``cv2.undistortPoints``, iterated until it converges.
    ///
    /// Parameters
    /// ----------
    /// pixels : array_like
    ///     (N, 2), px.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     (N, 2) float64: x/z and y/z.
    ///
    /// Raises
    /// ------
    /// Error
    ///     When a pixel lies outside the range of the distortion model.
    fn undistort<'py>(&self, pixels: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = pixels.py();
        let pixels = rows_of::<2>(pixels, "pixels")?;
        let undistort = || each(&pixels, |p| self.0.model.undistort(Point2::from(*p)).map(|n| [n.x, n.y]));
        let directions = py.detach(undistort).map_err(|(i, p)| unreached(py, i, p))?;
        rows(py, directions.into_iter())
    }

    /// Viewing directions of pixels: unit vectors (N, 3) float64, from (N, 2) px.
    fn rays<'py>(&self, pixels: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = pixels.py();
        let pixels = rows_of::<2>(pixels, "pixels")?;
        let bearings =
            || each(&pixels, |p| self.0.model.bearing(Point2::from(*p)).map(|b| b.normalize().into()));
        let rays: Vec<[f64; 3]> = py.detach(bearings).map_err(|(i, p)| unreached(py, i, p))?;
        rows(py, rays.into_iter())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, CameraState)> {
        let model = &self.0.model;
        let k = &model.intrinsics;
        let sigma =
            self.0.sigma.as_ref().map(|s| (vec![s.focal_px, s.cx_px, s.cy_px, s.aspect], s.distortion));
        let state = (self.size(), [k.fx, k.fy, k.skew, k.cx, k.cy], model.distortion.to_array(), sigma);
        Ok((py.get_type::<Self>().getattr("_restored")?, state))
    }

    #[staticmethod]
    fn _restored(
        size: (u32, u32),
        k: [f64; 5],
        distortion: [f64; 5],
        sigma: Option<(Vec<f64>, [f64; 5])>,
    ) -> Self {
        let [fx, fy, skew, cx, cy] = k;
        let intrinsics = Intrinsics { fx, fy, skew, cx, cy };
        let (width, height) = size;
        let distortion = Distortion::from_array(distortion);
        let sigma = sigma.map(|(numbers, distortion)| {
            // Pickles of earlier versions have no aspect.
            let number = |i: usize| numbers.get(i).copied().unwrap_or_default();
            DeviceSigma {
                focal_px: number(0),
                cx_px: number(1),
                cy_px: number(2),
                distortion,
                aspect: number(3),
            }
        });
        Self(Device { model: geometry::Camera { width, height, intrinsics, distortion }, sigma })
    }

    fn __repr__(&self) -> String {
        let (m, k) = (&self.0.model, &self.0.model.intrinsics);
        let sigma = self.0.sigma.as_ref().map_or(String::new(), |s| format!(" ± {:.1}", s.focal_px));
        format!(
            "Camera({}x{}, focal length {:.1}{sigma} px, principal point {:.1}, {:.1})",
            m.width, m.height, k.fx, k.cx, k.cy
        )
    }
}

type CameraState = ((u32, u32), [f64; 5], [f64; 5], Option<(Vec<f64>, [f64; 5])>);

/// All results, or the first item that has no finite one.
fn each<const N: usize, const K: usize>(
    items: &[[f64; N]],
    of: impl Fn(&[f64; N]) -> Option<[f64; K]>,
) -> Result<Vec<[f64; K]>, (usize, [f64; N])> {
    let finite = |p| of(p).filter(|r| r.iter().all(|x| x.is_finite()));
    items.iter().enumerate().map(|(i, p)| finite(p).ok_or((i, *p))).collect()
}

fn unreached(py: Python<'_>, i: usize, p: [f64; 2]) -> PyErr {
    let found = format!("[{}, {}] in row {i}, which its model does not reach", p[0], p[1]);
    errors::invalid(py, "pixels", "pixels that the lens's distortion has a direction for", &found)
}

/// k1, k2, p1, p2, k3, or as many of them as are not zero.
pub(crate) fn distortion_of(values: &Bound<'_, PyAny>) -> PyResult<Distortion> {
    let py = values.py();
    let numbers = Numbers::of(values, "distortion")?;
    let given: Vec<f64> = numbers.view().iter().copied().collect();
    let mut coefficients = [0.0; 5];
    let beyond = given.iter().skip(5).any(|c| *c != 0.0);
    if beyond || given.iter().any(|c| !c.is_finite()) {
        let wanted = "up to five finite numbers k1, k2, p1, p2, k3 (no rational or fisheye model)";
        return Err(errors::invalid(py, "distortion", wanted, &format!("{given:?}")));
    }
    for (c, g) in coefficients.iter_mut().zip(&given) {
        *c = *g;
    }
    Ok(Distortion::from_array(coefficients))
}
