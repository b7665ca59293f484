//! Photographs → observations.

use pyo3::prelude::*;
use pyo3::types::PyString;
use slcal_core::photo::Encoding;
use slcal_core::{CalibrateConfig, Calibrator, SheetPhoto};

use crate::convert::array::Numbers;
use crate::convert::image::{Photo, photos_of};
use crate::convert::object::optional;
use crate::convert::option;
use crate::errors::{self, Raise as _, Stage, raised_from};
use crate::observations::Observations;
use crate::pattern::CheckerPattern;
use crate::photo_tags::tags_of;
use crate::view_observation::four_corners;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(observe, module)?)
}

/// Finds sheet and pattern in photographs of several poses: the first step of `calibrate`.
///
/// Parameters
/// ----------
/// photos : sequence of ndarray, or ndarray
///     (H, W, 3) RGB or (H, W), uint8 or uint16, all of one size: the sheet with the pattern projected on it, one for each
///     pose.
/// size_mm : (float, float) or str
///     Width and height of the sheet, mm, or a text such as "A4", "A2-landscape" or "594x420mm". The width is that of the sides
///     closest to the image's x axis. The name of a paper alone is tried both ways round, and the one that fits is taken.
/// pattern : CheckerPattern, optional
///     The projected pattern. Without it only the camera is calibrated.
/// plain : sequence of ndarray, optional
///     Photographs of the same poses without the pattern, in the same order: projector dark or plain white. The sheet's sides
///     are then measured in them.
/// corners : array_like or sequence of array_like, optional
///     (4, 2), px, for one photograph, or one such array or None for each: the sheet's corners TL, TR, BR, BL by hand,
///     where the sheet is not found. They may lie outside the image.
/// gamma : {"srgb", "linear"} or float, default "srgb"
///     The transfer curve of the photographs.
/// mirror : bool, default False
///     Whether the projector's pictures appear mirrored, left and right exchanged (rear projection): column c of the pattern
///     counts as width - 1 - c.
/// names : sequence of str, optional
///     Names of the photographs.
/// tags : sequence of PhotoTags or None, optional
///     What the camera wrote into each photograph: see `calibrate`.
/// screen : sequence of ndarray, optional
///     The older name of `plain`.
///
/// Returns
/// -------
/// Observations
///
/// Raises
/// ------
/// DetectionError
///     When sheet or pattern is not found; the message says in which photograph, what was found instead and what to do.
/// Error
///     When photographs differ in size, or lists in length.
/// TypeError
///     When a photograph is not such an array.
#[pyfunction]
#[pyo3(
    signature = (photos, size_mm, pattern=None, *, plain=None, corners=None, gamma=None, names=None, tags=None,
        mirror=false, screen=None),
    text_signature = "(photos, size_mm, pattern=None, *, plain=None, corners=None, gamma='srgb', names=None, tags=None, mirror=False, screen=None)"
)]
#[allow(clippy::too_many_arguments, reason = "keyword arguments")]
fn observe(
    photos: &Bound<'_, PyAny>,
    size_mm: &Bound<'_, PyAny>,
    pattern: Option<&Bound<'_, PyAny>>,
    plain: Option<&Bound<'_, PyAny>>,
    corners: Option<&Bound<'_, PyAny>>,
    gamma: Option<&Bound<'_, PyAny>>,
    names: Option<&Bound<'_, PyAny>>,
    tags: Option<&Bound<'_, PyAny>>,
    mirror: bool,
    screen: Option<&Bound<'_, PyAny>>,
) -> PyResult<Observations> {
    let pattern = optional::<CheckerPattern>(pattern, "pattern")?.map(|p| &p.get().0);
    let plain = option::plain(plain, screen)?;
    let asked = Request {
        photos,
        size_mm,
        pattern,
        plain,
        corners,
        gamma,
        names,
        tags,
        exif: false,
        mirror,
        focal_35mm: None,
    };
    let mut calibrator = observe_all(&asked, CalibrateConfig::default())?;
    photos.py().detach(|| calibrator.settle_orientation()).raise(photos.py(), Stage::Detect)?;
    calibrator.observations().map(Observations).raise(photos.py(), Stage::Detect)
}

/// The arguments of [`observe`].
pub(crate) struct Request<'a, 'py> {
    pub(crate) photos: &'a Bound<'py, PyAny>,
    pub(crate) size_mm: &'a Bound<'py, PyAny>,
    pub(crate) pattern: Option<&'a slcal_core::pattern::CheckerPattern>,
    /// Photographs without the pattern, and the name of their argument.
    pub(crate) plain: Option<(&'a Bound<'py, PyAny>, &'static str)>,
    pub(crate) corners: Option<&'a Bound<'py, PyAny>>,
    pub(crate) gamma: Option<&'a Bound<'py, PyAny>>,
    pub(crate) names: Option<&'a Bound<'py, PyAny>>,
    pub(crate) tags: Option<&'a Bound<'py, PyAny>>,
    /// Whether the focal length in the tags is a prior.
    pub(crate) exif: bool,
    /// Whether the projector's pictures appear mirrored.
    pub(crate) mirror: bool,
    pub(crate) focal_35mm: Option<f64>,
}

/// Finds sheet and pattern in every photograph.
pub(crate) fn observe_all(asked: &Request<'_, '_>, config: CalibrateConfig) -> PyResult<Calibrator> {
    let py = asked.photos.py();
    let photos = photos_of(asked.photos, "photos")?;
    let size = option::sheet_size(asked.size_mm)?;
    let (plain, plain_name) = match asked.plain {
        Some((given, name)) => (photos_of(given, name)?, name),
        None => (Vec::new(), "plain"),
    };
    let encoding = option::parsed_or(asked.gamma, "gamma", Encoding::default())?;
    let n = photos.len();
    if n == 0 {
        return Err(errors::invalid(py, "photos", "at least one", "none"));
    }
    let one_each = |what: &str, found: usize| match found {
        0 => Ok(()),
        found if found == n => Ok(()),
        found => {
            let expected = format!("one for each of the {n} photographs, in their order");
            Err(errors::invalid(py, what, &expected, &found.to_string()))
        }
    };
    one_each(plain_name, plain.len())?;
    let corners = asked.corners.map_or(Ok(Vec::new()), |c| corners_of(c, n))?;
    one_each("corners", corners.len())?;
    let names = asked.names.map_or(Ok(Vec::new()), names_of)?;
    one_each("names", names.len())?;
    let tags = asked.tags.map_or(Ok(Vec::new()), tags_of)?;
    one_each("tags", tags.len())?;
    if asked.exif && tags.iter().all(Option::is_none) {
        return Err(errors::invalid(py, "exif", "the tags of the photographs (tags=...)", "none"));
    }
    let mut calibrator = Calibrator::new(size).with_encoding(encoding).with_config(config);
    if let Some(pattern) = asked.pattern {
        calibrator = if asked.mirror {
            calibrator.with_mirrored_pattern(pattern)
        } else {
            calibrator.with_pattern(pattern)
        };
    }
    for (i, photo) in photos.iter().enumerate() {
        py.check_signals()?;
        let (pixels, plain) = (photo.pixels(), plain.get(i).map(Photo::pixels));
        let mut shot = SheetPhoto::new(pixels.view(py)?);
        if let Some(plain) = &plain {
            shot = shot.plain(plain.view(py)?);
        }
        if let Some(corners) = corners.get(i).copied().flatten() {
            shot = shot.corners(corners);
        }
        if let Some(mm) = asked.focal_35mm {
            shot = shot.focal_35mm(mm);
        }
        if let Some(tags) = tags.get(i).cloned().flatten() {
            shot = shot.tags(tags);
        }
        if asked.exif {
            shot = shot.focal_from_tags();
        }
        if let Some(name) = names.get(i) {
            shot = shot.name(name);
        }
        let place = (n > 1).then(|| {
            names.get(i).map_or_else(|| format!("photos[{i}]"), |name| format!("photos[{i}] ({name})"))
        });
        py.detach(|| calibrator.add(shot).map(|_| ()))
            .map_err(|e| raised_from(py, &e, Stage::Detect, place.as_deref()))?;
    }
    Ok(calibrator)
}

fn names_of(names: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    let list = if names.cast::<PyString>().is_ok() { None } else { names.extract().ok() };
    list.ok_or_else(|| errors::wrong_type("names", "a sequence of str", &names.to_string()))
}

/// (4, 2) for the only photograph, or one such array, or None, for each.
fn corners_of(corners: &Bound<'_, PyAny>, n: usize) -> PyResult<Vec<Option<[nalgebra::Point2<f64>; 4]>>> {
    let Ok(items) = corners.try_iter() else {
        let found = corners.get_type().name()?.to_string();
        return Err(errors::wrong_type(
            "corners",
            "an array of shape (4, 2), or one for each photograph",
            &found,
        ));
    };
    let items = items.collect::<PyResult<Vec<_>>>()?;
    let given = items.iter().find(|i| !i.is_none());
    let single = match given {
        Some(first) => Numbers::of(first, "corners")?.view().ndim() < 2,
        None => false,
    };
    if single {
        let four = four_corners(corners, "corners")?;
        if n == 1 {
            return Ok(vec![Some(four)]);
        }
        let expected = format!("one array of shape (4, 2), or None, for each of the {n} photographs");
        return Err(errors::invalid(corners.py(), "corners", &expected, "one array"));
    }
    let each = |(i, c): (usize, &Bound<'_, PyAny>)| {
        if c.is_none() { Ok(None) } else { four_corners(c, &format!("corners[{i}]")).map(Some) }
    };
    items.iter().enumerate().map(each).collect()
}
