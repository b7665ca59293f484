//! Many photographs with one rig.

use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use slcal_core::SequenceReconstructor;
use slcal_core::reconstruct::CullRule;

use crate::cloud::PointCloud;
use crate::convert::object::object;
use crate::decode::{self, Frames, Projected};
use crate::errors::{Raise as _, Stage};
use crate::reconstruct::CloudOptions;
use crate::rig::Rig;
use crate::sequence_frames::fold;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Reconstructor>()
}

/// Reconstructs many photographs with the same rig and pattern, such as the frames of a video, or many scans by a sequence. It does what
/// `Rig.reconstruct` does; rig, pattern and options are checked once, and buffers for stripes are kept from frame to frame.
///
/// Threads that share a Reconstructor for stripes wait for each other; use one per thread. With a sequence they need not.
///
/// Parameters
/// ----------
/// rig : Rig
///     With a projector.
/// pattern : StripePattern or SequencePattern
///     What is projected, drawn for that projector. With a sequence, `gamma` and `min_confidence` are not allowed.
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
    scanner: Scanner,
    what: String,
}

enum Scanner {
    Stripes(Box<Mutex<slcal_core::Reconstructor>>),
    /// It has not seen any frame. Each scan is the work of a copy: waiting for its frames, which may be what Python makes, holds up no
    /// other thread.
    Sequence(Box<SequenceReconstructor>),
}

#[pymethods]
impl Reconstructor {
    #[new]
    #[allow(clippy::too_many_arguments, reason = "keyword arguments")]
    #[pyo3(
        signature = (rig, pattern, *, gamma=None, frame=None, mesh=false, cull=None, min_confidence=None, near=None, far=None, mirror=false),
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
        min_confidence: Option<f64>,
        near: Option<f64>,
        far: Option<f64>,
        mirror: bool,
    ) -> PyResult<Self> {
        let decode = decode::config(gamma, min_confidence, mirror)?;
        let config = CloudOptions { frame, mesh, cull, near, far }.config(decode, CullRule::Auto)?;
        let rig = &object::<Rig>(rig, "rig")?.get().rig;
        let camera = [rig.camera.model.width, rig.camera.model.height];
        let named = |[w, h]: [u32; 2], shown: String| {
            format!("Reconstructor(camera {}x{}, projector {w}x{h}, {shown})", camera[0], camera[1])
        };
        Ok(match Projected::of(pattern)? {
            Projected::Stripes(pattern) => {
                let scanner = py.detach(|| slcal_core::Reconstructor::new(rig, pattern, config));
                Self {
                    scanner: Scanner::Stripes(Box::new(Mutex::new(scanner.raise(py, Stage::Decode)?))),
                    what: named(pattern.projector, format!("{} slits", pattern.centres_px.len())),
                }
            }
            Projected::Sequence(pattern) => {
                let given = [("gamma", gamma.is_some()), ("min_confidence", min_confidence.is_some())];
                decode::of_stripes_alone(py, &given)?;
                let scanner = SequenceReconstructor::new(rig, pattern, config).raise(py, Stage::Decode)?;
                Self {
                    scanner: Scanner::Sequence(Box::new(scanner)),
                    what: named(pattern.projector, format!("{} frames", pattern.frames.len())),
                }
            }
        })
    }

    /// The cloud of one photograph of the stripes, or of the photographs of a sequence.
    ///
    /// Parameters
    /// ----------
    /// image : ndarray, or iterable of ndarrays and paths
    ///     (H, W, 3), uint8 or uint16, RGB order, of the size of the rig's camera: the scene with the stripes projected. Of a sequence
    ///     its photographs in the order of the pattern, as `slcal.decode` takes them.
    /// black, white : ndarray, optional
    ///     The same scene with the projector dark and plain white; not with a sequence.
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
    ///     When its shape or size is wrong, or a sequence has another number of frames than its pattern.
    /// DecodeError
    ///     When the stripes, or the light of the projector, are not found, or cannot be those of this rig.
    #[pyo3(signature = (image, *, black=None, white=None))]
    fn reconstruct(
        &self,
        image: &Bound<'_, PyAny>,
        black: Option<&Bound<'_, PyAny>>,
        white: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PointCloud> {
        let scanner = match &self.scanner {
            Scanner::Stripes(scanner) => scanner,
            Scanner::Sequence(scanner) => {
                let given = [("black", black.is_some()), ("white", white.is_some())];
                decode::of_stripes_alone(image.py(), &given)?;
                return Ok(fold(image, (**scanner).clone())?.into());
            }
        };
        let frames = Frames::of(image, black, white)?;
        let made = frames.read(image.py(), |input| {
            // What an earlier photograph left behind is replaced: a panic within one does not spoil the next.
            let mut scanner = scanner.lock().unwrap_or_else(PoisonError::into_inner);
            scanner.reconstruct(*input)?;
            Ok(scanner.take_last())
        })?;
        Ok(made.into())
    }

    fn __repr__(&self) -> &str {
        &self.what
    }
}
