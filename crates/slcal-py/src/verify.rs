//! Rig + photograph → how square the projection is, and whether the rig has moved.

use pyo3::prelude::*;
use slcal_core::photo::Encoding;
use slcal_core::{VerifyPhotoConfig, verify_photo};

use crate::convert::image::Photo;
use crate::convert::object::object;
use crate::convert::option;
use crate::convert::report::record;
use crate::errors::{Raise as _, Stage};
use crate::pattern::CheckerPattern;
use crate::rig::Rig;
use crate::view_observation::four_corners;

#[pymethods]
impl Rig {
    /// Measures the keystone of a projected checkerboard on the sheet, and tests whether projector, camera or sheet have
    /// moved.
    ///
    /// Parameters
    /// ----------
    /// photo : ndarray
    ///     (H, W, 3) RGB or (H, W), uint8 or uint16, by the rig's camera: the sheet with the pattern projected on it.
    /// pattern : CheckerPattern
    ///     The projected pattern, as `rectify` draws it for the rig's first view unless `as_drawn`.
    /// size_mm : (float, float) or str, optional
    ///     Size of the sheet, when it is not that of the rig's first view. The name of a paper alone is tried both ways round.
    /// as_drawn : bool, default False
    ///     Whether the pattern is projected as it was drawn, not rectified. The sheet may then be anywhere.
    /// corners : array_like, optional
    ///     (4, 2), px: the sheet's corners TL, TR, BR, BL by hand, when it is not found.
    /// gamma : {"srgb", "linear"} or float, default "srgb"
    ///     The transfer curve of the photograph.
    /// mirror : bool, default False
    ///     Whether the projector's pictures appear mirrored, left and right exchanged (rear projection): column c of the pattern
    ///     counts as width - 1 - c.
    ///     A rig that was calibrated so says it (`Rig.mirrored`), and nothing is needed.
    /// significance : float, default 0.001
    ///     The false-alarm rate: the probability that an unmoved rig is reported as moved.
    ///
    /// Returns
    /// -------
    /// Verification
    ///     `keystone` with its σ, `rig.moved` and what has changed, `sheet.moved`.
    ///
    /// Raises
    /// ------
    /// DetectionError
    ///     When sheet or pattern is not found.
    /// CalibrationError
    ///     When photograph and rig do not fit each other at all.
    /// Error
    ///     When the photograph has another size, the pattern is for another panel, the rig has no projector, or it has no
    ///     views and `as_drawn` and `size_mm` are not given.
    /// TypeError
    ///     When the photograph is not such an array.
    #[pyo3(
        signature = (photo, pattern, *, size_mm=None, as_drawn=false, corners=None, gamma=None, mirror=false, significance=0.001),
        text_signature = "($self, photo, pattern, *, size_mm=None, as_drawn=False, corners=None, gamma='srgb', mirror=False, significance=0.001)"
    )]
    #[allow(clippy::too_many_arguments, reason = "they are named in Python")]
    fn verify<'py>(
        &self,
        photo: &Bound<'py, PyAny>,
        pattern: &Bound<'py, PyAny>,
        size_mm: Option<&Bound<'py, PyAny>>,
        as_drawn: bool,
        corners: Option<&Bound<'py, PyAny>>,
        gamma: Option<&Bound<'py, PyAny>>,
        mirror: bool,
        significance: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = photo.py();
        let pattern = &object::<CheckerPattern>(pattern, "pattern")?.get().0;
        let config = VerifyPhotoConfig {
            size: size_mm.map(option::sheet_size).transpose()?,
            as_drawn,
            mirrored: mirror,
            encoding: option::parsed_or(gamma, "gamma", Encoding::default())?,
            corners: corners.map(|c| four_corners(c, "corners")).transpose()?,
            significance,
        };
        config.validate().raise(py, Stage::Detect)?;
        let photo = Photo::of(photo, "photo")?;
        let pixels = photo.pixels();
        let view = pixels.view(py)?;
        let found = py.detach(|| verify_photo(&self.rig, view, pattern, &config)).raise(py, Stage::Detect)?;
        let corners = found.detection.pattern_corners;
        record(py, "Verification", &found.verification.to_json(None, as_drawn, corners))
    }
}
