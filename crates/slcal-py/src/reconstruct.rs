//! Matches and photographs of stripes → clouds.

use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use slcal_core::Rig as CoreRig;
use slcal_core::decode::DecodeConfig;
use slcal_core::reconstruct::CullRule;
use slcal_core::{ReconstructConfig, Reconstruction, cloud_from_matches};

use crate::cloud::PointCloud;
use crate::convert::option;
use crate::convert::report::Reported;
use crate::decode::{self, Frames};
use crate::errors::{self, Looking, Raise as _};
use crate::matches::{Given, Matches, matches_of, sigma_of};
use crate::pattern::StripePattern;
use crate::rig::Rig;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Reconstructor>()
}

impl From<Reconstruction> for PointCloud {
    fn from(made: Reconstruction) -> Self {
        let report = Reported::of("CloudReport", &made.report());
        Self { cloud: made.cloud, report }
    }
}

/// What clouds are to be, as given from Python.
#[derive(Clone, Copy)]
struct Shape<'a, 'py> {
    frame: Option<&'a Bound<'py, PyAny>>,
    mesh: bool,
    cull: Option<&'a Bound<'py, PyAny>>,
}

impl Shape<'_, '_> {
    fn config(&self, decode: DecodeConfig, cull: CullRule) -> PyResult<ReconstructConfig> {
        Ok(ReconstructConfig {
            decode,
            frame: option::frame(self.frame)?,
            mesh: self.mesh,
            cull: option::cull(self.cull, cull)?,
            ..ReconstructConfig::default()
        })
    }
}

/// The cloud of one photograph.
fn reconstruct(
    py: Python<'_>,
    rig: &CoreRig,
    frames: &Frames<'_>,
    pattern: &StripePattern,
    decode: DecodeConfig,
    shape: Shape<'_, '_>,
) -> PyResult<PointCloud> {
    let config = shape.config(decode, CullRule::Auto)?;
    let made = frames.read(py, |input| {
        let mut scanner = slcal_core::Reconstructor::new(rig, &pattern.0, config)?;
        scanner.reconstruct(*input)?;
        Ok(scanner.take_last())
    })?;
    Ok(made.into())
}

/// The cloud of matches, or of pixels and what lights them.
fn triangulate(
    rig: &CoreRig,
    pixels: &Bound<'_, PyAny>,
    given: Given<'_, '_>,
    shape: Shape<'_, '_>,
) -> PyResult<PointCloud> {
    let py = pixels.py();
    let config = shape.config(DecodeConfig::default(), CullRule::Off)?;
    let work = |matches: &slcal_core::Matches| cloud_from_matches(rig, matches, &config);
    let made = if let Ok(matches) = pixels.cast::<Matches>() {
        if given.columns.is_some() || given.rows.is_some() {
            let wanted = "pixels, or Matches alone";
            return Err(errors::invalid(
                py,
                "columns",
                wanted,
                "Matches, which hold columns and rows already",
            ));
        }
        let matches = &matches.get().matches;
        match given.sigma_px {
            None => py.detach(|| work(matches)),
            Some(sigma) => {
                let mut matches = matches.clone();
                let sigma = sigma_of(sigma, matches.items.len())?;
                matches.items.iter_mut().zip(sigma).for_each(|(m, s)| m.sigma_px = s);
                py.detach(|| work(&matches))
            }
        }
    } else {
        let matches = matches_of(pixels, given)?;
        py.detach(|| work(&matches))
    };
    Ok(made.raise(py, Looking::ForStripes)?.into())
}

/// One photograph after another with the same rig and pattern, as of a video: what `Rig.reconstruct` does, with buffers that
/// are kept from frame to frame.
///
/// Several threads may use one, but they wait for each other; for two at a time take two.
///
/// Parameters
/// ----------
/// rig : Rig
///     With a projector.
/// pattern : StripePattern
///     The stripes, drawn for that projector.
/// gamma : {"srgb", "linear"} or float, default "srgb"
///     How the values of the images follow the light.
/// frame : {"camera", "plane"}, default "camera"
///     Whose coordinates the clouds have: the camera's, or those of the sheet of the rig's first view.
/// mesh : bool, default False
///     Whether the clouds keep the triangles between their points.
/// cull : {"auto", "off"} or float, default "auto"
///     Largest area of a triangle that is surface, mm², or how it is chosen; points without such triangles are left out.
/// min_confidence : float, default 0.4
///     Matches below it are left out, 0 to 1.
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
        signature = (rig, pattern, *, gamma=None, frame=None, mesh=false, cull=None, min_confidence=0.4),
        text_signature = "(rig, pattern, *, gamma='srgb', frame='camera', mesh=False, cull='auto', min_confidence=0.4)"
    )]
    fn new(
        py: Python<'_>,
        rig: &Bound<'_, Rig>,
        pattern: &Bound<'_, StripePattern>,
        gamma: Option<&Bound<'_, PyAny>>,
        frame: Option<&Bound<'_, PyAny>>,
        mesh: bool,
        cull: Option<&Bound<'_, PyAny>>,
        min_confidence: f64,
    ) -> PyResult<Self> {
        let decode = decode::config(gamma, min_confidence)?;
        let config = Shape { frame, mesh, cull }.config(decode, CullRule::Auto)?;
        let (rig, pattern) = (&rig.get().rig, &pattern.get().0);
        let scanner = py.detach(|| slcal_core::Reconstructor::new(rig, pattern, config));
        let camera = &rig.camera.model;
        let [w, h] = pattern.projector;
        let what = format!(
            "Reconstructor(camera {}x{}, projector {w}x{h}, {} slits)",
            camera.width,
            camera.height,
            pattern.centres_px.len()
        );
        Ok(Self { scanner: Mutex::new(scanner.raise(py, Looking::ForStripes)?), what })
    }

    /// The cloud of one photograph.
    ///
    /// Parameters
    /// ----------
    /// image : ndarray
    ///     (H, W, 3), uint8 or uint16, RGB order, of the size of the rig's camera: the scene with the stripes projected.
    /// black, white : ndarray, optional
    ///     The same scene with a dark projector and with plain white.
    ///
    /// Returns
    /// -------
    /// PointCloud
    ///     Its own, whatever comes next.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     When the image is no array of uint8 or uint16.
    /// Error
    ///     When its shape or size is another one.
    /// DecodeError
    ///     When the stripes are not in it, or cannot be those of this rig.
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

#[pymethods]
impl Rig {
    /// The cloud of one photograph of the stripes on whatever stands before the rig. `Reconstructor` is for many.
    ///
    /// Parameters
    /// ----------
    /// image : ndarray
    ///     (H, W, 3), uint8 or uint16, RGB order, of the size of the rig's camera: the scene with the stripes projected.
    /// pattern : StripePattern
    ///     The stripes, drawn for the rig's projector.
    /// black, white : ndarray, optional
    ///     The same scene with a dark projector (the room's light is taken off) and with plain white (the surface's own
    ///     colours are divided out).
    /// gamma : {"srgb", "linear"} or float, default "srgb"
    ///     How the image's values follow the light.
    /// frame : {"camera", "plane"}, default "camera"
    ///     Whose coordinates the cloud has: the camera's, or those of the sheet of the rig's first view.
    /// mesh : bool, default False
    ///     Whether the cloud keeps the triangles between its points.
    /// cull : {"auto", "off"} or float, default "auto"
    ///     Largest area of a triangle that is surface, mm², or how it is chosen; points without such triangles are left
    ///     out.
    /// min_confidence : float, default 0.4
    ///     Matches below it are left out, 0 to 1.
    ///
    /// Returns
    /// -------
    /// PointCloud
    ///     Its `report` says what was seen and what became of it.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     When the image is no array of uint8 or uint16.
    /// Error
    ///     When its shape or size is another one, the rig has no projector (or, for "plane", no view), the pattern is for
    ///     another panel, or an option is out of range.
    /// DecodeError
    ///     When the stripes are not in it, or cannot be those of this rig. The message says so when they are found as soon
    ///     as red and blue change places.
    ///
    /// Examples
    /// --------
    /// >>> from slcal import simulate
    /// >>> scene = simulate.scene("sphere")
    /// >>> cloud = scene.rig.reconstruct(scene.photo, scene.pattern)
    /// >>> cloud.points.shape == (len(cloud), 3)
    /// True
    #[pyo3(
        signature = (
            image, pattern, *, black=None, white=None, gamma=None, frame=None, mesh=false, cull=None, min_confidence=0.4
        ),
        text_signature = "($self, image, pattern, *, black=None, white=None, gamma='srgb', frame='camera', mesh=False, \
                          cull='auto', min_confidence=0.4)"
    )]
    #[allow(clippy::too_many_arguments, reason = "keyword arguments")]
    fn reconstruct(
        &self,
        image: &Bound<'_, PyAny>,
        pattern: &Bound<'_, StripePattern>,
        black: Option<&Bound<'_, PyAny>>,
        white: Option<&Bound<'_, PyAny>>,
        gamma: Option<&Bound<'_, PyAny>>,
        frame: Option<&Bound<'_, PyAny>>,
        mesh: bool,
        cull: Option<&Bound<'_, PyAny>>,
        min_confidence: f64,
    ) -> PyResult<PointCloud> {
        let frames = Frames::of(image, black, white)?;
        let decode = decode::config(gamma, min_confidence)?;
        let shape = Shape { frame, mesh, cull };
        reconstruct(image.py(), &self.rig, &frames, pattern.get(), decode, shape)
    }

    /// Points from camera pixels and the projector columns (or rows) that light them, of whatever decoder.
    ///
    /// Parameters
    /// ----------
    /// pixels : Matches or array_like
    ///     Matches, or (N, 2) camera px.
    /// columns, rows : array_like, optional
    ///     (N,), projector px, NaN where one is not known; at least one of the two beside an array of pixels.
    /// sigma_px : array_like, optional
    ///     (N,) or one for all: 1σ of the camera position across the stripe, px. Unless given, that of the matches, or 0.1.
    /// frame : {"camera", "plane"}, default "camera"
    ///     Whose coordinates the cloud has: the camera's, or those of the sheet of the rig's first view.
    /// mesh : bool, default False
    ///     Whether the cloud keeps the triangles between its points.
    /// cull : {"auto", "off"} or float, default "off"
    ///     Largest area of a triangle that is surface, mm², or how it is chosen; points without such triangles are left
    ///     out. With "off" every match that can be a point becomes one, in the order given.
    ///
    /// Returns
    /// -------
    /// PointCloud
    ///     Its `report` counts the matches that are no points: without coordinates ("invalid"), behind the devices, lit from
    ///     outside the panel, and so on.
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     When something is no array of numbers.
    /// Error
    ///     When the shapes do not fit each other, pixels are not finite, or the rig has no projector (or, for "plane", no
    ///     view).
    /// DecodeError
    ///     When no match is a point.
    ///
    /// Examples
    /// --------
    /// >>> camera = slcal.Camera.from_fov((1280, 960), 45)
    /// >>> projector = slcal.Camera([[1600, 0, 511.5], [0, 1600, 383.5], [0, 0, 1]], size=(1024, 768))
    /// >>> rig = slcal.Rig(camera, projector, slcal.Pose(np.eye(3), [-200, 0, 0]))
    /// >>> pixel = camera.project([[20, 30, 1000]])
    /// >>> column = projector.project([[20 - 200, 30, 1000]])[:, 0]
    /// >>> rig.triangulate(pixel, column).points.round(6)
    /// array([[  20.,   30., 1000.]])
    #[pyo3(
        signature = (
            pixels, columns=None, rows=None, *, sigma_px=None, frame=None, mesh=false, cull=None
        ),
        text_signature = "($self, pixels, columns=None, rows=None, *, sigma_px=None, frame='camera', mesh=False, \
                          cull='off')"
    )]
    #[allow(clippy::too_many_arguments, reason = "keyword arguments")]
    fn triangulate(
        &self,
        pixels: &Bound<'_, PyAny>,
        columns: Option<&Bound<'_, PyAny>>,
        rows: Option<&Bound<'_, PyAny>>,
        sigma_px: Option<&Bound<'_, PyAny>>,
        frame: Option<&Bound<'_, PyAny>>,
        mesh: bool,
        cull: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PointCloud> {
        let given = Given { columns, rows, sigma_px, ..Given::default() };
        triangulate(&self.rig, pixels, given, Shape { frame, mesh, cull })
    }
}
