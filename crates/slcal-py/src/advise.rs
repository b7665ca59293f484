//! Which photograph to take next.

use pyo3::prelude::*;
use slcal_core::advise::{Advice, CameraPlan, advise_first, advise_next};
use slcal_core::{CalibrateConfig, DistortionModel, PrincipalPointRule};

use crate::convert::object::{object, optional};
use crate::convert::option;
use crate::convert::report::record;
use crate::errors::{Raise as _, Stage};
use crate::geometry::Camera;
use crate::pattern::CheckerPattern;
use crate::rig::Rig;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(advise, module)?)
}

fn advice_record<'py>(py: Python<'py>, advice: slcal_core::Result<Advice>) -> PyResult<Bound<'py, PyAny>> {
    record(py, "Advice", &advice.raise(py, Stage::Detect)?.to_json())
}

/// Plans the first photographs: how to hold the sheet, and the expected σ of the focal lengths against its tilt.
///
/// Parameters
/// ----------
/// camera : Camera
///     Approximate intrinsics: see `Camera.from_fov` and `Camera.from_35mm`.
/// size_mm : (float, float) or str
///     Width and height of the sheet, mm, or a text such as "A2-landscape" or "594x420mm".
/// projector : Camera, optional
///     Approximate intrinsics: see `Camera.from_throw`. Without a projector the plan is for the camera alone. The projector
///     is assumed to stand to the right of the camera, at a quarter of the distance.
/// distance_mm : float, optional
///     Distance from the camera to the sheet's centre. By default the sheet fills 60 % of the image.
/// noise_px : float, default 0.05
///     1σ of a corner of the sheet and of the pattern in the photograph, px.
/// camera_pp : {"prior", "centre", "free", "shift"} or (float, float), default "prior"
///     What will be known of the camera's principal point.
/// projector_pp : {"shift", "prior", "centre", "free"} or (float, float), default "shift"
///     What will be known of the projector's.
/// distortion : {"auto", "none", "k1", "k1k2", "full"}, default "auto"
///     Which distortion of the camera will be estimated, as for `calibrate`.
/// flatness : {"paper", "board", "flat"}, str or float, default "paper"
///     How flat the sheet is, as for `calibrate`.
///
/// Returns
/// -------
/// Advice
///     A `table` over tilts, and the `next` photograph in numbers and in words.
///
/// Raises
/// ------
/// Error
///     For numbers that are not finite and positive.
///
/// Examples
/// --------
/// >>> camera = slcal.Camera.from_fov((1280, 960), 50)
/// >>> advice = slcal.advise(camera, size_mm=(594, 420))
/// >>> advice.next.then_reversed
/// True
/// >>> advice.next.in_words.startswith("hold the sheet with its")
/// True
#[pyfunction]
#[pyo3(
    signature = (camera, size_mm, *, projector=None, distance_mm=None, noise_px=0.05, camera_pp=None, projector_pp=None, distortion=None,
        flatness=None),
    text_signature = "(camera, size_mm, *, projector=None, distance_mm=None, noise_px=0.05, camera_pp='prior', projector_pp='shift', distortion='auto', flatness='paper')"
)]
#[allow(clippy::too_many_arguments, reason = "they are named in Python")]
fn advise<'py>(
    camera: &Bound<'py, PyAny>,
    size_mm: &Bound<'py, PyAny>,
    projector: Option<&Bound<'py, PyAny>>,
    distance_mm: Option<f64>,
    noise_px: f64,
    camera_pp: Option<&Bound<'py, PyAny>>,
    projector_pp: Option<&Bound<'py, PyAny>>,
    distortion: Option<&Bound<'py, PyAny>>,
    flatness: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = size_mm.py();
    let config = CalibrateConfig {
        camera_pp: option::parsed_or(camera_pp, "camera_pp", PrincipalPointRule::Prior)?,
        projector_pp: option::parsed_or(projector_pp, "projector_pp", PrincipalPointRule::Shift)?,
        distortion: option::parsed_or(distortion, "distortion", DistortionModel::Auto)?,
        flatness: option::flatness(flatness)?,
        ..CalibrateConfig::default()
    };
    config.validate().raise(py, Stage::Detect)?;
    let plan = CameraPlan {
        camera: object::<Camera>(camera, "camera")?.get().0.model,
        projector: optional::<Camera>(projector, "projector")?.map(|p| p.get().0.model),
        size: option::definite_size(size_mm)?,
        distance_mm,
        noise_px: [noise_px; 2],
        config,
    };
    advice_record(py, py.detach(|| advise_first(&plan)))
}

#[pymethods]
impl Rig {
    /// Predicts what one more photograph would improve, and says which one to take.
    ///
    /// Parameters
    /// ----------
    /// pattern : CheckerPattern, optional
    ///     The pattern that will be projected; by default the standard checkerboard for the rig's panel.
    ///
    /// Returns
    /// -------
    /// Advice
    ///     σ now and after a photograph with each of several tilts, and the `next` photograph in numbers and in words.
    ///
    /// Raises
    /// ------
    /// Error
    ///     For a rig without views or covariance (see `slcal.advise` for these), or a pattern for another panel.
    #[pyo3(signature = (pattern=None))]
    fn advise<'py>(
        &self,
        py: Python<'py>,
        pattern: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let pattern = optional::<CheckerPattern>(pattern, "pattern")?.map(|p| &p.get().0);
        advice_record(py, py.detach(|| advise_next(&self.rig, pattern)))
    }
}
