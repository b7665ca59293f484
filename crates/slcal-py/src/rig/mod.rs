//! The rig: what calibration gives and reconstruction takes.

mod display;
mod exchange;
mod file;
mod opencv;
mod view;

use std::path::Path;

use pyo3::prelude::*;
use slcal_core::{CalibrationReport, Projector, StereoPose};

pub(crate) use view::{Covariance, View};

use crate::convert::object::{self, Argument};
use crate::convert::report::record;
use crate::errors;
use crate::geometry::{Camera, Pose};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Rig>()?;
    module.add_class::<View>()?;
    module.add_class::<Covariance>()
}

/// A calibrated camera, and a projector if there was a pattern, with their uncertainty.
///
/// `slcal.calibrate` returns rigs. The constructor makes one from devices that are known otherwise.
///
/// Parameters
/// ----------
/// camera : Camera
///     The camera.
/// projector : Camera, optional
///     The projector, modelled as a camera.
/// projector_from_camera : Pose, optional
///     X_projector = R · X_camera + t, mm; given exactly when the projector is.
/// method : str, default "external"
///     How the rig was made, in one word.
/// mirrored : bool, default False
///     Whether the projector's pictures appear mirrored, left and right exchanged.
///
/// Raises
/// ------
/// Error
///     When only one of projector and projector_from_camera is given.
///
/// Examples
/// --------
/// >>> camera = slcal.Camera.from_fov((1280, 960), 45)
/// >>> projector = slcal.Camera.from_throw((1024, 768), 1.6)
/// >>> rig = slcal.Rig(camera, projector, slcal.Pose(np.eye(3), [-200, 0, 0]))
/// >>> rig.baseline_mm
/// 200.0
/// >>> slcal.Rig.from_json(rig.to_json()) == rig
/// True
#[pyclass(frozen, module = "slcal")]
pub(crate) struct Rig {
    pub(crate) rig: slcal_core::Rig,
    /// How it came about, when it was calibrated here.
    pub(crate) report: Option<CalibrationReport>,
}

impl From<slcal_core::Rig> for Rig {
    fn from(rig: slcal_core::Rig) -> Self {
        Self { rig, report: None }
    }
}

impl Argument for Rig {
    const EXPECTED: &'static str = "a Rig";
    const OF_ARRAY: &'static str = "slcal.Rig.from_opencv(camera_K=..., camera_size=..., ...), or slcal.calibrate(photos, size_mm, pattern)";
    const OF_OTHER: &'static str =
        "slcal.calibrate(photos, size_mm, pattern), or slcal.Rig.from_opencv(parameters)";

    fn of_path(path: &Path) -> String {
        object::load("Rig", path)
    }
}

#[pymethods]
impl Rig {
    #[new]
    #[pyo3(
        signature = (camera, projector=None, projector_from_camera=None, *, method=None, mirrored=false),
        text_signature = "(camera, projector=None, projector_from_camera=None, *, method='external', mirrored=False)"
    )]
    fn new(
        py: Python<'_>,
        camera: &Bound<'_, PyAny>,
        projector: Option<&Bound<'_, PyAny>>,
        projector_from_camera: Option<&Bound<'_, PyAny>>,
        method: Option<String>,
        mirrored: bool,
    ) -> PyResult<Self> {
        let camera = object::object::<Camera>(camera, "camera")?.get();
        let projector = object::optional::<Camera>(projector, "projector")?.map(Bound::get);
        let pose = object::optional::<Pose>(projector_from_camera, "projector_from_camera")?.map(Bound::get);
        let projector = match (projector, pose) {
            (Some(device), Some(p)) => Some(Projector {
                device: device.0,
                from_camera: StereoPose {
                    pose: p.pose,
                    sigma_t_mm: p.sigma_t_mm,
                    sigma_r_rad: p.sigma_r_rad,
                },
                mirrored,
            }),
            (None, None) => None,
            (given, _) => {
                let given = if given.is_some() { "projector" } else { "projector_from_camera" };
                let wanted = "both a projector and its projector_from_camera, or neither";
                return Err(errors::invalid(py, "rig", wanted, &format!("{given} alone")));
            }
        };
        let rig = slcal_core::Rig {
            camera: camera.0,
            projector,
            views: Vec::new(),
            method: method.unwrap_or_else(|| "external".to_owned()),
            quality: None,
            covariance: None,
            channel_registration: None,
        };
        Ok(rig.into())
    }

    /// The camera.
    #[getter]
    fn camera(&self) -> Camera {
        Camera(self.rig.camera)
    }

    /// The projector; None when the camera alone was calibrated.
    #[getter]
    fn projector(&self) -> Option<Camera> {
        self.rig.projector.map(|p| Camera(p.device))
    }

    /// X_projector = R · X_camera + t, mm; None without a projector.
    #[getter]
    fn projector_from_camera(&self) -> Option<Pose> {
        let StereoPose { pose, sigma_t_mm, sigma_r_rad } = self.rig.projector?.from_camera;
        Some(Pose { pose, sigma_t_mm, sigma_r_rad })
    }

    /// The poses of the sheet that it was calibrated from.
    #[getter]
    fn views(&self) -> Vec<View> {
        self.rig.views.iter().cloned().map(View).collect()
    }

    /// How it was made: "ml", "two-vp", or another word for rigs from other programs.
    #[getter]
    fn method(&self) -> &str {
        &self.rig.method
    }

    /// Verdict, expected accuracy and warnings; None for rigs from other programs that have none.
    #[getter]
    fn quality<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.rig.quality.as_ref().map(|q| record(py, "Quality", &display::quality(q))).transpose()
    }

    /// Covariance of all estimated parameters; None for rigs from other programs.
    #[getter]
    fn covariance(&self) -> Option<Covariance> {
        self.rig.covariance.clone().map(Covariance)
    }

    /// How red and blue are displaced against green in projector and camera; None where it is not known, as in rigs that
    /// were calibrated from grey photographs.
    #[getter]
    fn channel_registration<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let known = self.rig.channel_registration.as_ref();
        known.map(|r| record(py, "ChannelRegistration", &display::registration(r))).transpose()
    }

    /// Iterations and inliers of the calibration; None for a rig that was not calibrated in this program.
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.report.as_ref().map(|r| record(py, "CalibrationReport", &r.to_json())).transpose()
    }

    /// Whether the projector's pictures appear mirrored, left and right exchanged, as in rear projection: column c of a picture counts
    /// as column width - 1 - c of the panel.
    #[getter]
    fn mirrored(&self) -> bool {
        self.rig.is_mirrored()
    }

    /// Distance between the optical centres, mm; None without a projector.
    #[getter]
    fn baseline_mm(&self) -> Option<f64> {
        self.rig.baseline_mm()
    }

    /// 1σ of it, mm; None without a covariance.
    #[getter]
    fn baseline_sigma_mm(&self) -> Option<f64> {
        self.rig.baseline_sigma_mm()
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        // How a rig came about is no part of what it is.
        other.cast::<Self>().is_ok_and(|o| o.get().rig == self.rig)
    }

    fn __repr__(&self) -> String {
        display::in_a_line(&self.rig)
    }

    fn _repr_html_(&self) -> String {
        display::as_html(&self.rig)
    }
}
