//! Many photographs with one rig.

use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use slcal_core::reconstruct::CullRule;

use crate::cloud::PointCloud;
use crate::convert::object::object;
use crate::decode::{self, Frames};
use crate::errors::{Raise as _, Stage};
use crate::pattern::StripePattern;
use crate::reconstruct::CloudOptions;
use crate::rig::Rig;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Reconstructor>()
}

/// Reconstructs many photographs with the same rig and pattern, such as the frames of a video. It does what
/// `Rig.reconstruct` does, and keeps its buffers from frame to frame.
///
/// Threads that share a Reconstructor wait for each other; use one per thread.
///
/// Parameters
/// ----------
/// rig : Rig
///     With a projector.
/// pattern : StripePattern
///     The stripes, drawn for that projector.
/// gamma : {"srgb", "linear"} or float, default "srgb"
///     The transfer curve of the images.
/// frame : {"camera", "plane"}, default "camera"
///     The coordinate frame of the clouds: the camera's, or that of the sheet in the rig's first view.
/// mesh : bool, default False
///     Whether the clouds keep the triangles between their points.
/// cull : {"auto", "off"} or float, default "auto"
///     Largest area of a triangle on a surface, mm², or how this limit is chosen. Points without such a triangle are
///     removed.
/// min_confidence : float, default 0.4
///     Matches with a lower confidence are rejected, 0 to 1.
/// near, far : float, optional
///     Limits of the depth along the camera's axis, mm. Points outside are removed and counted in the report.
/// mirror : bool, default False
///     Whether the projector's pictures appear mirrored, left and right exchanged (rear projection): column c of the pattern
///     counts as width - 1 - c.
///     A rig that was calibrated so says it (`Rig.mirrored`), and nothing is needed.
///
/// Raises
/// ------
/// Error
///     When the rig has no projector (or, for "plane", no view), the pattern is for another panel, or an option is out of
///     range.
///
/// Examples
/// --------
/// >>> from slcal import simulate
/// >>> scene = simulate.scene("plane")
/// >>> scanner = slcal.Reconstructor(scene.rig, scene.pattern)
/// >>> cloud = scanner.reconstruct(scene.photo)
/// >>> bool(cloud.fit_plane().report.rms_mm < 1)
/// True
#[pyclass(frozen, module = "slcal")]
pub(crate) struct Reconstructor {
    scanner: Mutex<slcal_core::Reconstructor>,
    what: String,
}

#[pymethods]
impl Reconstructor {
    #[new]
    #[allow(clippy::too_many_arguments, reason = "keyword arguments")]
    #[pyo3(
        signature = (rig, pattern, *, gamma=None, frame=None, mesh=false, cull=None, min_confidence=0.4, near=None, far=None, mirror=false),
        text_signature = "(rig, pattern, *, gamma='srgb', frame='camera', mesh=False, cull='auto', min_confidence=0.4, near=None, far=None, mirror=False)"
    )]
    fn new(
        py: Python<'_>,
        rig: &Bound<'_, PyAny>,
        pattern: &Bound<'_, PyAny>,
        gamma: Option<&Bound<'_, PyAny>>,
        frame: Option<&Bound<'_, PyAny>>,
        mesh: bool,
        cull: Option<&Bound<'_, PyAny>>,
        min_confidence: f64,
        near: Option<f64>,
        far: Option<f64>,
        mirror: bool,
    ) -> PyResult<Self> {
        let decode = decode::config(gamma, Some(min_confidence), mirror)?;
        let config = CloudOptions { frame, mesh, cull, near, far }.config(decode, CullRule::Auto)?;
        let rig = &object::<Rig>(rig, "rig")?.get().rig;
        let pattern = &object::<StripePattern>(pattern, "pattern")?.get().0;
        let scanner = py.detach(|| slcal_core::Reconstructor::new(rig, pattern, config));
        let camera = &rig.camera.model;
        let [w, h] = pattern.projector;
        let what = format!(
            "Reconstructor(camera {}x{}, projector {w}x{h}, {} slits)",
            camera.width,
            camera.height,
            pattern.centres_px.len()
        );
        Ok(Self { scanner: Mutex::new(scanner.raise(py, Stage::Decode)?), what })
    }

    /// The cloud of one photograph.
    ///
    /// Parameters
    /// ----------
    /// image : ndarray
    ///     (H, W, 3), uint8 or uint16, RGB order, of the size of the rig's camera: the scene with the stripes projected.
    /// black, white : ndarray, optional
    ///     The same scene with the projector dark and plain white.
    ///
    /// Returns
    /// -------
    /// PointCloud
    ///     Later frames do not change it.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     When the image is not an array of uint8 or uint16.
    /// Error
    ///     When its shape or size is wrong.
    /// DecodeError
    ///     When the stripes are not found, or cannot be those of this rig.
    #[pyo3(signature = (image, *, black=None, white=None))]
    fn reconstruct(
        &self,
        image: &Bound<'_, PyAny>,
        black: Option<&Bound<'_, PyAny>>,
        white: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PointCloud> {
        let frames = Frames::of(image, black, white)?;
        let made = frames.read(image.py(), |input| {
            // What an earlier photograph left behind is replaced: a panic within one does not spoil the next.
            let mut scanner = self.scanner.lock().unwrap_or_else(PoisonError::into_inner);
            scanner.reconstruct(*input)?;
            Ok(scanner.take_last())
        })?;
        Ok(made.into())
    }

    fn __repr__(&self) -> &str {
        &self.what
    }
}
