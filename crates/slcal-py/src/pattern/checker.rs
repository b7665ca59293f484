//! The checkerboard for calibration.

use std::path::Path;

use pyo3::prelude::*;
use slcal_core::pattern::{self, CheckerConfig, Pattern};

use super::file::{from_file, json, parse, picture};
use crate::convert::array::rows;
use crate::convert::object::{self, Argument};
use crate::convert::option::{parsed, whole_pair};
use crate::errors::{self, Raise as _, Stage};
use crate::files;

fn checker(py: Python<'_>, pattern: Pattern) -> PyResult<CheckerPattern> {
    match pattern {
        Pattern::Checker(p) => Ok(CheckerPattern(p)),
        Pattern::Sequence(_) => {
            Err(errors::invalid(py, "pattern", "a checkerboard", "a sequence; SequencePattern.load reads it"))
        }
        Pattern::Stripes(_) => {
            Err(errors::invalid(py, "pattern", "a checkerboard", "stripes; StripePattern.load reads them"))
        }
    }
}

/// The checkerboard for calibration, centred on the projector's panel.
///
/// Parameters
/// ----------
/// projector : (int, int)
///     Width and height of the projector's panel, px: its native resolution.
/// squares : (int, int), default (11, 8)
///     Columns and rows of squares. Their sum must be odd, so that the board turned by 180° differs from itself.
/// square_px : int, optional
///     Side of a square, px; by default a sixteenth of the panel's height.
/// first_square : {"black", "white"}, default "black"
///     The colour of the top-left square.
/// background : {"black", "white"}, default "white"
///     The colour around the board.
/// marks : bool, default False
///     Whether to draw small marks at the corners of the panel and at the middles of its sides. Where they or the border of
///     the light are seen on the sheet, `calibrate` tests whether the picture was shown full screen, unscaled and not mirrored.
///
/// Raises
/// ------
/// Error
///     When the sum is even, the board does not fit on the panel, or it leaves no room for marks.
///
/// Examples
/// --------
/// >>> checker = slcal.CheckerPattern(projector=(1024, 768))
/// >>> checker
/// CheckerPattern(projector=(1024, 768), squares=(11, 8), square_px=48)
/// >>> checker.image().shape
/// (768, 1024, 3)
#[pyclass(frozen, module = "slcal", eq, hash)]
#[derive(PartialEq, Clone)]
pub(crate) struct CheckerPattern(pub(crate) pattern::CheckerPattern);

impl std::hash::Hash for CheckerPattern {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        (self.0.projector, self.0.squares, self.0.square_px.to_bits()).hash(state);
    }
}

impl Argument for CheckerPattern {
    const EXPECTED: &'static str = "a CheckerPattern";
    const OF_ARRAY: &'static str =
        "slcal.CheckerPattern(projector=(width, height)), whose image() is the picture";
    const OF_OTHER: &'static str = "slcal.CheckerPattern(projector=(width, height))";

    fn of_path(path: &Path) -> String {
        object::load_pattern("CheckerPattern", path)
    }
}

#[pymethods]
impl CheckerPattern {
    #[new]
    #[pyo3(
        signature = (projector, squares=None, square_px=None, *, first_square=None, background=None, marks=false),
        text_signature = "(projector, squares=(11, 8), square_px=None, *, first_square='black', background='white', marks=False)"
    )]
    fn new(
        projector: &Bound<'_, PyAny>,
        squares: Option<&Bound<'_, PyAny>>,
        square_px: Option<&Bound<'_, PyAny>>,
        first_square: Option<&Bound<'_, PyAny>>,
        background: Option<&Bound<'_, PyAny>>,
        marks: bool,
    ) -> PyResult<Self> {
        let py = projector.py();
        let mut config = CheckerConfig { marks, ..CheckerConfig::default() };
        if let Some(squares) = squares {
            config.squares = whole_pair(squares, "squares")?;
        }
        if let Some(side) = square_px {
            config.square_px = Some(
                side.extract()
                    .map_err(|_| errors::wrong_type("square_px", "a number of pixels", &side.to_string()))?,
            );
        }
        if let Some(color) = first_square {
            config.first_square = parsed(color, "first_square")?;
        }
        if let Some(color) = background {
            config.background = parsed(color, "background")?;
        }
        let panel = whole_pair(projector, "projector")?;
        pattern::CheckerPattern::new(panel, &config).map(Self).raise(py, Stage::Detect)
    }

    /// Width and height of the panel, px.
    #[getter]
    fn projector(&self) -> (u32, u32) {
        self.0.projector.into()
    }

    /// Columns and rows of squares.
    #[getter]
    fn squares(&self) -> (u32, u32) {
        self.0.squares.into()
    }

    /// Side of a square, px.
    #[getter]
    fn square_px(&self) -> f64 {
        self.0.square_px
    }

    /// Outer top-left corner of the top-left square, px, pixel centres at integers.
    #[getter]
    fn origin_px(&self) -> (f64, f64) {
        (self.0.origin_px.x, self.0.origin_px.y)
    }

    /// The colour of the top-left square.
    #[getter]
    fn first_square(&self) -> &'static str {
        self.0.first_square.name()
    }

    /// The colour around the board.
    #[getter]
    fn background(&self) -> &'static str {
        self.0.background.name()
    }

    /// Middles of the marks at the border of the panel: (N, 2) float64, projector px; None without marks.
    #[getter]
    fn marks<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.0.marks.as_ref().map(|m| rows(py, m.centres_px.iter().map(|c| [c.x, c.y]))).transpose()
    }

    /// The corners between four squares, row by row.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     (N, 2) float64, projector px.
    fn corners<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(py, self.0.inner_corners().into_iter().map(|c| [c.x, c.y]))
    }

    /// The same picture with left and right exchanged, as a pattern of its own: where it lies on the panel of a projector that shows
    /// pictures mirrored.
    ///
    /// Returns
    /// -------
    /// CheckerPattern
    fn mirrored(&self) -> Self {
        Self(self.0.mirrored())
    }

    /// The picture to project. Show it full screen, without scaling.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     (H, W, 3) uint8, sRGB.
    fn image<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        picture(py, || self.0.image())
    }

    /// Writes the pattern file (schema slcal-pattern/1).
    ///
    /// Parameters
    /// ----------
    /// file : path or file object
    ///     A path, where the file appears when it is complete and replaces an older one, or an object with write().
    fn save(&self, file: &Bound<'_, PyAny>) -> PyResult<()> {
        files::write(file, &json(file.py(), &Pattern::Checker(self.0.clone()))?, true)
    }

    /// Reads a pattern file; see `slcal.load_pattern` for files of any kind.
    #[staticmethod]
    fn load(file: &Bound<'_, PyAny>) -> PyResult<Self> {
        checker(file.py(), from_file(file)?)
    }

    /// The content of the pattern file.
    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        files::text_of(json(py, &Pattern::Checker(self.0.clone()))?)
    }

    /// The pattern that `to_json` wrote.
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> PyResult<Self> {
        checker(py, parse(py, text.as_bytes(), None)?)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((py.get_type::<Self>().getattr("from_json")?, (self.to_json(py)?,)))
    }

    fn __repr__(&self) -> String {
        let ([w, h], [c, r]) = (self.0.projector, self.0.squares);
        let marks = if self.0.marks.is_some() { ", marks=True" } else { "" };
        format!(
            "CheckerPattern(projector=({w}, {h}), squares=({c}, {r}), square_px={}{marks})",
            self.0.square_px
        )
    }
}
