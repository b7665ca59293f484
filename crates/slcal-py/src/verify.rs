//! Rig + photograph → how square the projection is, and whether the rig has moved.

use pyo3::prelude::*;
use slcal_core::{Rig, VerifyPhotoConfig, verify_photo};

use crate::convert::image::Photo;
use crate::convert::option;
use crate::convert::report::record;
use crate::errors::{Looking, Raise as _};
use crate::observations::four_corners;
use crate::pattern::CheckerPattern;

/// What is known beside the photograph: the keyword arguments of `Rig.verify`.
pub(crate) struct Known<'a, 'py> {
    pub(crate) size_mm: Option<&'a Bound<'py, PyAny>>,
    pub(crate) as_drawn: bool,
    pub(crate) corners: Option<&'a Bound<'py, PyAny>>,
    pub(crate) gamma: Option<&'a Bound<'py, PyAny>>,
    pub(crate) significance: f64,
}

/// See `Rig.verify`.
pub(crate) fn verify<'py>(
    rig: &Rig,
    photo: &Bound<'py, PyAny>,
    pattern: &CheckerPattern,
    known: &Known<'_, 'py>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = photo.py();
    let config = VerifyPhotoConfig {
        size: known.size_mm.map(option::sheet_size).transpose()?,
        as_drawn: known.as_drawn,
        encoding: option::gamma(known.gamma)?,
        corners: known.corners.map(|c| four_corners(c, "corners")).transpose()?,
        significance: known.significance,
    };
    config.validate().raise(py, Looking::ForSheet)?;
    let photo = Photo::of(photo, "photo")?;
    let pixels = photo.pixels();
    let view = pixels.view(py)?;
    let found = py.detach(|| verify_photo(rig, view, &pattern.0, &config)).raise(py, Looking::ForSheet)?;
    let corners = found.detection.pattern_corners;
    record(py, "Verification", &found.verification.to_json(None, known.as_drawn, corners))
}
