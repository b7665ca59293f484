//! Photograph → sheet and projected corners, as results of their own.

mod detection;

use pyo3::prelude::*;
use slcal_core::detect::{self, DetectConfig};

pub(crate) use detection::{CornerDetection, Detection, SheetDetection};
use slcal_core::photo::Encoding;
use slcal_core::{CalibrateConfig, observe_sheet};

use crate::convert::image::Photo;
use crate::convert::object::{object, optional};
use crate::convert::option;
use crate::errors::{Raise as _, Stage};
use crate::pattern::CheckerPattern;
use crate::view_observation::four_corners;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<SheetDetection>()?;
    module.add_class::<CornerDetection>()?;
    module.add_class::<Detection>()?;
    module.add_function(wrap_pyfunction!(detect_both, module)?)?;
    module.add_function(wrap_pyfunction!(detect_sheet, module)?)?;
    module.add_function(wrap_pyfunction!(detect_corners, module)?)
}

fn config(corners: Option<&Bound<'_, PyAny>>, gamma: Option<&Bound<'_, PyAny>>) -> PyResult<DetectConfig> {
    let corners = corners.map(|c| four_corners(c, "corners")).transpose()?;
    Ok(DetectConfig {
        encoding: option::parsed_or(gamma, "gamma", Encoding::default())?,
        corners,
        ..DetectConfig::default()
    })
}

/// Finds the sheet, and the pattern when there is one, in a photograph.
///
/// Parameters
/// ----------
/// photo : ndarray
///     (H, W, 3) RGB or (H, W), uint8 or uint16: the sheet with the pattern projected on it.
/// size_mm : (float, float) or str
///     Width and height of the sheet, mm, or a text such as "A4", "A2-landscape" or "594x420mm". The width is that of the sides
///     closest to the image's x axis. The name of a paper alone is tried both ways round, and the one that fits is taken.
/// pattern : CheckerPattern, optional
///     The projected pattern. Without it the brightest large quadrilateral with straight sides is taken for the sheet.
/// plain : ndarray, optional
///     A photograph of the same pose and size without the pattern: projector dark or plain white. The sheet's sides are then
///     measured in it.
/// corners : array_like, optional
///     (4, 2), px: the sheet's corners TL, TR, BR, BL by hand, when the sheet is not found. They may lie outside the image;
///     where the sides are visible they are still measured.
/// gamma : {"srgb", "linear"} or float, default "srgb"
///     The transfer curve of the photograph.
/// screen : ndarray, optional
///     The older name of `plain`.
///
/// Returns
/// -------
/// Detection
///     `sheet`, `corners`, and both as the `view` that calibration takes.
///
/// Raises
/// ------
/// DetectionError
///     When sheet or pattern is not found; `seen` says what was found instead and `advice` what to do.
/// Error
///     When photographs differ in size, or the corners are not a convex quadrilateral in this order.
/// TypeError
///     When a photograph is not such an array.
///
/// See Also
/// --------
/// observe : the same for photographs of several poses.
///
/// Examples
/// --------
/// A drawing of a sheet in front of a dark wall:
///
/// >>> photo = np.full((480, 640), 30, np.uint8)
/// >>> photo[100:380, 120:520] = 220
/// >>> found = slcal.detect(photo, size_mm=(400, 280))
/// >>> found
/// Detection(sheet found, no pattern)
/// >>> found.sheet.corners.round(1)
/// array([[119.5,  99.5],
///        [519.5,  99.5],
///        [519.5, 379.5],
///        [119.5, 379.5]])
#[pyfunction]
#[pyo3(
    name = "detect",
    signature = (photo, size_mm, pattern=None, *, plain=None, corners=None, gamma=None, screen=None),
    text_signature = "(photo, size_mm, pattern=None, *, plain=None, corners=None, gamma='srgb', screen=None)"
)]
fn detect_both(
    photo: &Bound<'_, PyAny>,
    size_mm: &Bound<'_, PyAny>,
    pattern: Option<&Bound<'_, PyAny>>,
    plain: Option<&Bound<'_, PyAny>>,
    corners: Option<&Bound<'_, PyAny>>,
    gamma: Option<&Bound<'_, PyAny>>,
    screen: Option<&Bound<'_, PyAny>>,
) -> PyResult<Detection> {
    let py = photo.py();
    let photo = Photo::of(photo, "photo")?;
    let plain = option::plain(plain, screen)?.map(|(p, name)| Photo::of(p, name)).transpose()?;
    let (size, config) = (option::sheet_size(size_mm)?, config(corners, gamma)?);
    let (photo, plain) = (photo.pixels(), plain.as_ref().map(Photo::pixels));
    let (photo, plain) = (photo.view(py)?, plain.as_ref().map(|s| s.view(py)).transpose()?);
    let pattern = optional::<CheckerPattern>(pattern, "pattern")?.map(|p| &p.get().0);
    let assumed = CalibrateConfig::default();
    py.detach(|| observe_sheet(photo, plain, size, pattern, &config, &assumed))
        .map(Detection)
        .raise(py, Stage::Detect)
}

/// Finds only the sheet, of any size: the brightest large quadrilateral with straight sides.
///
/// Parameters
/// ----------
/// photo : ndarray
///     (H, W, 3) RGB or (H, W), uint8 or uint16: the sheet, with the projector dark or plain white. `detect` can tell the
///     pattern's edges from those of the sheet.
/// corners : array_like, optional
///     (4, 2), px: its corners TL, TR, BR, BL by hand, when the sheet is not found. They may lie outside the image; where
///     the sides are visible they are still measured.
/// gamma : {"srgb", "linear"} or float, default "srgb"
///     The transfer curve of the photograph.
///
/// Returns
/// -------
/// SheetDetection
///
/// Raises
/// ------
/// DetectionError
///     When no sheet is found; `seen` says what was found instead and `advice` what to do.
/// Error
///     When the corners are not a convex quadrilateral in this order.
/// TypeError
///     When the photograph is not such an array.
///
/// Examples
/// --------
/// >>> photo = np.full((480, 640), 30, np.uint8)
/// >>> photo[100:380, 120:520] = 220
/// >>> sheet = slcal.detect_sheet(photo)
/// >>> float(sheet.edges["top"][:, 1].mean().round(1))
/// 99.5
#[pyfunction]
#[pyo3(signature = (photo, *, corners=None, gamma=None), text_signature = "(photo, *, corners=None, gamma='srgb')")]
fn detect_sheet(
    photo: &Bound<'_, PyAny>,
    corners: Option<&Bound<'_, PyAny>>,
    gamma: Option<&Bound<'_, PyAny>>,
) -> PyResult<SheetDetection> {
    let py = photo.py();
    let photo = Photo::of(photo, "photo")?;
    let (pixels, config) = (photo.pixels(), config(corners, gamma)?);
    let view = pixels.view(py)?;
    py.detach(|| detect::find_sheet(view, &config)).map(SheetDetection).raise(py, Stage::Detect)
}

/// Finds only the corners of the projected checkerboard, on the sheet or outside it.
///
/// Parameters
/// ----------
/// photo : ndarray
///     (H, W, 3) RGB or (H, W), uint8 or uint16.
/// pattern : CheckerPattern
///     What is projected.
/// gamma : {"srgb", "linear"} or float, default "srgb"
///     The transfer curve of the photograph.
///
/// Returns
/// -------
/// CornerDetection
///
/// Raises
/// ------
/// DetectionError
///     When the checkerboard is not found; `seen` says what was found instead and `advice` what to do.
/// TypeError
///     When the photograph is not such an array.
///
/// Examples
/// --------
/// The projected picture itself, as a photograph:
///
/// >>> checker = slcal.CheckerPattern(projector=(1024, 768))
/// >>> corners = slcal.detect_corners(checker.image(), checker)
/// >>> len(corners), corners.expected
/// (70, 70)
/// >>> bool(np.abs(corners.camera_px - corners.projector_px).max() < 0.01)
/// True
#[pyfunction]
#[pyo3(signature = (photo, pattern, *, gamma=None), text_signature = "(photo, pattern, *, gamma='srgb')")]
fn detect_corners(
    photo: &Bound<'_, PyAny>,
    pattern: &Bound<'_, PyAny>,
    gamma: Option<&Bound<'_, PyAny>>,
) -> PyResult<CornerDetection> {
    let py = photo.py();
    let pattern = &object::<CheckerPattern>(pattern, "pattern")?.get().0;
    let photo = Photo::of(photo, "photo")?;
    let (pixels, config) = (photo.pixels(), config(None, gamma)?);
    let view = pixels.view(py)?;
    py.detach(|| detect::find_corners(view, pattern, &config)).map(CornerDetection).raise(py, Stage::Detect)
}
