//! Rigs from and to the arrays of OpenCV's functions.

use nalgebra::Matrix3;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use slcal_core::geometry::{self, Distortion, Intrinsics};
use slcal_core::{Device, Projector, Rig as CoreRig, StereoPose};

use super::Rig;
use crate::convert::array::{matrix_of, rows, shaped};
use crate::convert::option::whole_pair;
use crate::errors::{self, Raise as _, Stage};
use crate::geometry::{distortion_of, pose_of};

const NAMES: [&str; 8] =
    ["camera_K", "camera_dist", "camera_size", "projector_K", "projector_dist", "projector_size", "R", "t"];

/// See `Rig.to_opencv`.
fn to_opencv<'py>(py: Python<'py>, rig: &CoreRig) -> PyResult<Bound<'py, PyDict>> {
    let parameters = PyDict::new(py);
    for (name, Device { model, .. }) in rig.devices() {
        let k = model.intrinsics.matrix();
        parameters.set_item(format!("{name}_K"), rows(py, k.row_iter().map(|r| [r[0], r[1], r[2]]))?)?;
        parameters
            .set_item(format!("{name}_dist"), shaped(py, model.distortion.to_array().to_vec(), &[5])?)?;
        let size = vec![i64::from(model.width), i64::from(model.height)];
        parameters.set_item(format!("{name}_size"), shaped(py, size, &[2])?)?;
    }
    if let Some(Projector { from_camera: StereoPose { pose, .. }, .. }) = &rig.projector {
        let r = pose.rotation.matrix();
        parameters.set_item("R", rows(py, r.row_iter().map(|r| [r[0], r[1], r[2]]))?)?;
        parameters.set_item("t", shaped(py, pose.translation.as_slice().to_vec(), &[3, 1])?)?;
    }
    Ok(parameters)
}

/// See `Rig.from_opencv`.
fn from_opencv(
    py: Python<'_>,
    parameters: Option<&Bound<'_, PyAny>>,
    named: Option<&Bound<'_, PyDict>>,
) -> PyResult<CoreRig> {
    let all = PyDict::new(py);
    if let Some(given) = parameters {
        all.call_method1("update", (given,)).map_err(|_| {
            errors::wrong_type("parameters", "a mapping, as Rig.to_opencv gives it", &given.to_string())
        })?;
    }
    if let Some(named) = named {
        all.call_method1("update", (named,))?;
    }
    for name in all.keys() {
        let name: String = name.extract()?;
        if !NAMES.contains(&name.as_str()) {
            return Err(errors::invalid(py, "parameters", &format!("only {}", NAMES.join(", ")), &name));
        }
    }
    let get = |name: &str| all.get_item(name).map(|value| value.filter(|v| !v.is_none()));
    let needed = |name: &str| -> PyResult<Bound<'_, PyAny>> {
        get(name)?.ok_or_else(|| errors::invalid(py, name, "its value", "nothing"))
    };
    let device = |name: &str| -> PyResult<Device> {
        let k = matrix_of(&needed(&format!("{name}_K"))?, &format!("{name}_K"))?;
        let k = Matrix3::from_fn(|i, j| k[i][j]);
        let intrinsics = Intrinsics::from_matrix(&k).raise(py, Stage::Detect)?;
        let [width, height] = whole_pair(&needed(&format!("{name}_size"))?, &format!("{name}_size"))?;
        let distortion = match get(&format!("{name}_dist"))? {
            Some(values) => distortion_of(&values)?,
            None => Distortion::NONE,
        };
        Ok(Device::from(geometry::Camera { width, height, intrinsics, distortion }))
    };
    let camera = device("camera")?;
    let names_of_projector = &NAMES[3..];
    let with_projector =
        names_of_projector.iter().try_fold(false, |any, n| get(n).map(|v| any || v.is_some()))?;
    let projector = if with_projector {
        let from_camera = pose_of(py, &needed("R")?, &needed("t")?)?.into();
        Some(Projector { device: device("projector")?, from_camera, mirrored: false })
    } else {
        None
    };
    let method = "opencv".to_owned();
    Ok(CoreRig {
        camera,
        projector,
        views: Vec::new(),
        method,
        quality: None,
        covariance: None,
        channel_registration: None,
    })
}

#[pymethods]
impl Rig {
    /// The rig as parameters of OpenCV's functions.
    ///
    /// Returns
    /// -------
    /// dict
    ///     `camera_K` (3, 3), `camera_dist` (5,), `camera_size` (2,), the same of the projector, and `R` (3, 3) and `t` (3, 1) with
    ///     X_projector = R · X_camera + t, mm: what ``cv2.stereoRectify`` calls R and T. The entries of a projector are
    ///     there only if there is one.
    ///
    /// Examples
    /// --------
    /// >>> camera = slcal.Camera.from_fov((1280, 960), 45)
    /// >>> sorted(slcal.Rig(camera).to_opencv())
    /// ['camera_K', 'camera_dist', 'camera_size']
    fn to_opencv<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        to_opencv(py, &self.rig)
    }

    /// A rig from parameters of OpenCV's functions.
    ///
    /// Parameters
    /// ----------
    /// parameters : mapping, optional
    ///     What `to_opencv` returns; or the same as keyword arguments.
    /// camera_K, projector_K : array_like
    ///     (3, 3), px.
    /// camera_dist, projector_dist : array_like, optional
    ///     Up to five of k1, k2, p1, p2, k3; none unless given.
    /// camera_size, projector_size : (int, int)
    ///     Width and height, px.
    /// R : array_like
    ///     (3, 3), or (3,) as of ``cv2.Rodrigues``.
    /// t : array_like
    ///     (3,) or (3, 1), mm: X_projector = R · X_camera + t.
    ///
    /// Returns
    /// -------
    /// Rig
    ///
    /// Raises
    /// ------
    /// Error
    ///     When something is missing or invalid.
    #[staticmethod]
    #[pyo3(signature = (parameters=None, /, **named), text_signature = "(parameters=None, /, *, camera_K=None, camera_dist=None, camera_size=None, projector_K=None, projector_dist=None, projector_size=None, R=None, t=None)")]
    fn from_opencv(
        py: Python<'_>,
        parameters: Option<&Bound<'_, PyAny>>,
        named: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        from_opencv(py, parameters, named).map(Self::from)
    }
}
