//! Photographs, or the observations of any detector, in; rig out.

use pyo3::prelude::*;
use slcal_core::{CalibrateConfig, Calibration, DistortionModel, FocalPrior, PrincipalPointRule};

use crate::convert::object::optional;
use crate::convert::option;
use crate::errors::{Raise as _, Stage};
use crate::geometry::Camera;
use crate::observations::observations_of;
use crate::observe::{Request, observe_all};
use crate::pattern::CheckerPattern;
use crate::rig::Rig;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(calibrate, module)?)?;
    module.add_function(wrap_pyfunction!(calibrate_observations, module)?)
}

/// What the keyword arguments of both functions say.
struct Options<'a, 'py> {
    camera: Option<&'a Camera>,
    camera_pp: Option<&'a Bound<'py, PyAny>>,
    projector_pp: Option<&'a Bound<'py, PyAny>>,
    distortion: Option<&'a Bound<'py, PyAny>>,
    projector_distortion: Option<&'a Bound<'py, PyAny>>,
    projector_pixel_aspect: Option<&'a Bound<'py, PyAny>>,
    flatness: Option<&'a Bound<'py, PyAny>>,
    method: Option<&'a Bound<'py, PyAny>>,
    allow_degenerate: bool,
}

impl Options<'_, '_> {
    /// All of it but what depends on the image's size.
    fn config(&self) -> PyResult<CalibrateConfig> {
        let default = CalibrateConfig::default();
        Ok(CalibrateConfig {
            camera_pp: option::parsed_or(self.camera_pp, "camera_pp", PrincipalPointRule::Prior)?,
            projector_pp: option::parsed_or(self.projector_pp, "projector_pp", PrincipalPointRule::Shift)?,
            method: option::parsed_or(self.method, "method", default.method)?,
            distortion: option::parsed_or(self.distortion, "distortion", DistortionModel::Auto)?,
            projector_distortion: option::parsed_or(
                self.projector_distortion,
                "projector_distortion",
                DistortionModel::Auto,
            )?,
            projector_pixel_aspect: option::pixel_aspect(self.projector_pixel_aspect)?,
            flatness: option::flatness(self.flatness)?,
            allow_degenerate: self.allow_degenerate,
            known_camera: self.camera.map(|c| c.0.model),
            ..default
        })
    }
}

impl From<Calibration> for Rig {
    fn from(done: Calibration) -> Self {
        let report = Some(done.report().clone());
        Self { rig: done.rig, report }
    }
}

/// Calibrates a camera and a projector from photographs of one white sheet with a checkerboard projected on it.
///
/// Parameters
/// ----------
/// photos : sequence of ndarray, or ndarray
///     One photograph per pose of the sheet: (H, W, 3) in RGB order or (H, W), uint8 or uint16, all of one size. One
///     photograph of a tilted sheet is enough; two with opposite tilts are far better.
/// size_mm : (float, float) or str
///     Width and height of the sheet, mm, or a text such as "A4", "A2-landscape" or "594x420mm". The width is that of the sides
///     closest to the image's x axis. The name of a paper alone is tried both ways round, and the one that fits is taken.
/// pattern : CheckerPattern, optional
///     The projected pattern. Without it only the camera is calibrated.
/// plain : sequence of ndarray, optional
///     Photographs of the same poses without the pattern, in the same order: projector dark or plain white. The sheet's sides
///     are then measured in them.
/// corners : array_like, optional
///     The sheet's corners TL, TR, BR, BL by hand, where the sheet is not found: (4, 2), px, for one photograph, or one
///     such array for each. They may lie outside the image.
/// camera : Camera, optional
///     Known intrinsics: they are held fixed, and the rest is estimated.
/// camera_pp, projector_pp : {"prior", "shift", "centre", "free"} or (float, float)
///     What is known of the principal points. "prior": near the centre. "shift": its column near the centre, its row free
///     (lens shift). "centre": exactly the centre. "free": nothing. Two numbers: exactly this pixel.
/// distortion, projector_distortion : {"auto", "none", "k1", "k1k2", "full"}
///     Which coefficients are estimated. "auto" estimates all five, and the ratio of fy to fx, near what ordinary lenses have.
///     The others take square pixels; those of the projector need three photographs.
/// projector_pixel_aspect : {"auto", "square"} or float
///     Width of a pixel of the projector over its height. "auto": 2 for the diamond pixels of 912×1140 and 608×684, else 1.
/// flatness : {"paper", "board", "flat"}, str or float
///     How flat the sheet is. "paper" bends out of its plane by 0.2 % of its diagonal (1σ), "board" by 0.02 %, "flat" not at
///     all. A length such as "0.5mm", or a number of millimetres, is 1σ itself. The bend is estimated: see `View.bend`.
/// method : {"ml", "two-vp"}
///     Maximum likelihood, or the method of two vanishing points of R. Orghidan et al., "Structured light self-calibration
///     with vanishing points", Machine Vision and Applications 25:489-500 (2014).
/// focal_35mm : float, optional
///     The camera's focal length as its 35 mm equivalent, as EXIF tags state it. It is a prior with a σ of about 5 %.
/// gamma : {"srgb", "linear"} or float
///     The transfer curve of the photographs.
/// mirror : bool, default False
///     Whether the projector's pictures appear mirrored, left and right exchanged (rear projection): column c of the pattern
///     counts as width - 1 - c.
/// allow_degenerate : bool
///     Return a rig with the verdict "degenerate" instead of raising an error.
/// names : sequence of str, optional
///     Names of the photographs, for the rig's views and for messages.
/// tags : sequence of PhotoTags or None, optional
///     What the camera wrote into each photograph: `slcal.read_tags(file)`. The pixels are expected upright, as `read_image`
///     gives them. A crop and a focal length that contradicts the result are warned of; photographs whose orientation differs
///     are turned alike where they fit together only so.
/// exif : bool
///     Use the focal length in `tags` as a prior, as `focal_35mm` is one.
/// screen : sequence of ndarray, optional
///     The older name of `plain`.
///
/// Returns
/// -------
/// Rig
///     With σ, covariance and verdict; `rig.report` says how the calibration went.
///
/// Raises
/// ------
/// DetectionError
///     When the checkerboard or the sheet is not found in a photograph.
/// CalibrationError
///     When the photographs do not determine the focal lengths, as with a sheet seen face-on.
/// Error
///     When a value or a shape is invalid.
/// TypeError
///     When a photograph is not an array of uint8 or uint16.
///
/// Examples
/// --------
/// >>> checker = slcal.CheckerPattern(projector=(1024, 768))
/// >>> scene = slcal.simulate.scene("sheet", pattern=checker)
/// >>> rig = slcal.calibrate([scene.photo], size_mm=(594, 420), pattern=checker)
/// >>> rig.quality.verdict
/// 'good'
#[pyfunction]
#[pyo3(
    signature = (photos, size_mm, pattern=None, *, plain=None, corners=None, camera=None, camera_pp=None, projector_pp=None,
        distortion=None, projector_distortion=None, projector_pixel_aspect=None, flatness=None, method=None, focal_35mm=None, gamma=None, allow_degenerate=false,
        names=None, tags=None, exif=false, mirror=false, screen=None),
    text_signature = "(photos, size_mm, pattern=None, *, plain=None, corners=None, camera=None, camera_pp='prior', projector_pp='shift', distortion='auto', projector_distortion='auto', projector_pixel_aspect='auto', flatness='paper', method='ml', focal_35mm=None, gamma='srgb', allow_degenerate=False, names=None, tags=None, exif=False, mirror=False, screen=None)"
)]
#[allow(clippy::too_many_arguments, reason = "keyword arguments are what a Python user expects")]
fn calibrate(
    photos: &Bound<'_, PyAny>,
    size_mm: &Bound<'_, PyAny>,
    pattern: Option<&Bound<'_, PyAny>>,
    plain: Option<&Bound<'_, PyAny>>,
    corners: Option<&Bound<'_, PyAny>>,
    camera: Option<&Bound<'_, PyAny>>,
    camera_pp: Option<&Bound<'_, PyAny>>,
    projector_pp: Option<&Bound<'_, PyAny>>,
    distortion: Option<&Bound<'_, PyAny>>,
    projector_distortion: Option<&Bound<'_, PyAny>>,
    projector_pixel_aspect: Option<&Bound<'_, PyAny>>,
    flatness: Option<&Bound<'_, PyAny>>,
    method: Option<&Bound<'_, PyAny>>,
    focal_35mm: Option<f64>,
    gamma: Option<&Bound<'_, PyAny>>,
    allow_degenerate: bool,
    names: Option<&Bound<'_, PyAny>>,
    tags: Option<&Bound<'_, PyAny>>,
    exif: bool,
    mirror: bool,
    screen: Option<&Bound<'_, PyAny>>,
) -> PyResult<Rig> {
    let py = photos.py();
    let options = Options {
        camera: optional::<Camera>(camera, "camera")?.map(Bound::get),
        camera_pp,
        projector_pp,
        distortion,
        projector_distortion,
        projector_pixel_aspect,
        flatness,
        method,
        allow_degenerate,
    };
    // Before the work on the photographs begins.
    let config = options.config()?;
    let pattern = optional::<CheckerPattern>(pattern, "pattern")?.map(|p| &p.get().0);
    let plain = option::plain(plain, screen)?;
    let asked =
        Request { photos, size_mm, pattern, plain, corners, gamma, names, tags, exif, mirror, focal_35mm };
    let calibrator = observe_all(&asked, config)?;
    py.detach(|| calibrator.calibrate()).raise(py, Stage::Detect).map(Rig::from)
}

/// Calibrates from observations: those of `slcal.observe`, or of any other detector.
///
/// Parameters
/// ----------
/// observations : Observations or mapping
///     A mapping has the fields of the file (schema slcal-observations/1), with arrays or lists. A σ that is not given is
///     estimated from the residuals, or assumed where there are too few.
/// camera, camera_pp, projector_pp, distortion, projector_distortion, projector_pixel_aspect, flatness, method, focal_35mm, allow_degenerate
///     As for `calibrate`.
///
/// Returns
/// -------
/// Rig
///
/// Raises
/// ------
/// CalibrationError
///     When the observations do not determine the focal lengths.
/// FormatError
///     When a mapping does not follow the schema; the message names the field.
/// Error
///     When numbers are not finite, corners are collinear, or values contradict each other.
#[pyfunction]
#[pyo3(
    signature = (observations, *, camera=None, camera_pp=None, projector_pp=None, distortion=None,
        projector_distortion=None, projector_pixel_aspect=None, flatness=None, method=None, focal_35mm=None, allow_degenerate=false),
    text_signature = "(observations, *, camera=None, camera_pp='prior', projector_pp='shift', distortion='auto', projector_distortion='auto', projector_pixel_aspect='auto', flatness='paper', method='ml', focal_35mm=None, allow_degenerate=False)"
)]
#[allow(clippy::too_many_arguments, reason = "keyword arguments are what a Python user expects")]
fn calibrate_observations(
    observations: &Bound<'_, PyAny>,
    camera: Option<&Bound<'_, PyAny>>,
    camera_pp: Option<&Bound<'_, PyAny>>,
    projector_pp: Option<&Bound<'_, PyAny>>,
    distortion: Option<&Bound<'_, PyAny>>,
    projector_distortion: Option<&Bound<'_, PyAny>>,
    projector_pixel_aspect: Option<&Bound<'_, PyAny>>,
    flatness: Option<&Bound<'_, PyAny>>,
    method: Option<&Bound<'_, PyAny>>,
    focal_35mm: Option<f64>,
    allow_degenerate: bool,
) -> PyResult<Rig> {
    let options = Options {
        camera: optional::<Camera>(camera, "camera")?.map(Bound::get),
        camera_pp,
        projector_pp,
        distortion,
        projector_distortion,
        projector_pixel_aspect,
        flatness,
        method,
        allow_degenerate,
    };
    let (py, mut config) = (observations.py(), options.config()?);
    let seen = observations_of(observations)?;
    config.focal_prior = focal_35mm.map(|mm| FocalPrior::from_35mm_equivalent(mm, seen.camera));
    py.detach(|| slcal_core::calibrate_observations(&seen, &config)).raise(py, Stage::Detect).map(Rig::from)
}
