//! The coloured stripes for reconstruction.

use std::path::Path;

use pyo3::prelude::*;
use slcal_core::pattern::{self, Axis, Pattern, StripeConfig};

use super::file::{from_file, json, parse, picture};
use crate::convert::array::{column, rows};
use crate::convert::columns::{bytes_of, column_of, integers_of};
use crate::convert::object::{self, Argument};
use crate::convert::option::{parsed_or, whole_pair};
use crate::errors::{self, Raise as _, Stage};
use crate::files;

fn stripes(py: Python<'_>, pattern: Pattern) -> PyResult<StripePattern> {
    match pattern {
        Pattern::Stripes(p) => Ok(StripePattern(p)),
        Pattern::Sequence(_) => {
            Err(errors::invalid(py, "pattern", "stripes", "a sequence; SequencePattern.load reads it"))
        }
        Pattern::Checker(_) => {
            Err(errors::invalid(py, "pattern", "stripes", "a checkerboard; CheckerPattern.load reads it"))
        }
    }
}

/// Coloured slits in a De Bruijn sequence: every window of `order` neighbouring slits is unique.
///
/// Parameters
/// ----------
/// projector : (int, int)
///     Width and height of the projector's panel, px: its native resolution.
/// hues : int, default 4
///     Colours.
/// order : int, default 3
///     Length of the unique windows.
/// slits : int, optional
///     Number of slits; by default hues to the power of order.
/// axis : {"columns", "rows"}, default "columns"
///     "columns" for vertical slits, whose positions are columns of the panel; "rows" for horizontal ones.
///
/// Raises
/// ------
/// Error
///     When the colours and the order do not allow that many slits, or when they do not fit on the panel.
///
/// Examples
/// --------
/// >>> stripes = slcal.StripePattern(projector=(1024, 768))
/// >>> stripes
/// StripePattern(projector=(1024, 768), hues=4, order=3, slits=64)
/// >>> stripes.palette.shape, stripes.centres_px.shape
/// ((4, 3), (64,))
#[pyclass(frozen, module = "slcal", eq, hash)]
#[derive(PartialEq, Clone)]
pub(crate) struct StripePattern(pub(crate) pattern::StripePattern);

impl std::hash::Hash for StripePattern {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        (self.0.projector, &self.0.palette, &self.0.sequence, self.0.width_px.to_bits()).hash(state);
    }
}

impl Argument for StripePattern {
    const EXPECTED: &'static str = "a StripePattern";
    const OF_ARRAY: &'static str =
        "slcal.StripePattern(projector=(width, height)), whose image() is the picture";
    const OF_OTHER: &'static str = "slcal.StripePattern(projector=(width, height))";

    fn of_path(path: &Path) -> String {
        object::load_pattern("StripePattern", path)
    }
}

#[pymethods]
impl StripePattern {
    #[new]
    #[pyo3(
        signature = (projector, hues=4, order=3, slits=None, *, axis=None),
        text_signature = "(projector, hues=4, order=3, slits=None, *, axis='columns')"
    )]
    fn new(
        projector: &Bound<'_, PyAny>,
        hues: i64,
        order: i64,
        slits: Option<i64>,
        axis: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let py = projector.py();
        let count = |what: &str, n: i64| {
            u32::try_from(n)
                .map_err(|_| errors::invalid(py, what, "a whole number above zero", &n.to_string()))
        };
        let config = StripeConfig {
            hues: count("hues", hues)?,
            order: count("order", order)?,
            slits: slits.map(|n| count("slits", n)).transpose()?,
            axis: parsed_or(axis, "axis", Axis::Columns)?,
            ..StripeConfig::default()
        };
        let panel = whole_pair(projector, "projector")?;
        pattern::StripePattern::new(panel, &config).map(Self).raise(py, Stage::Detect)
    }

    /// A pattern of slits that another program draws.
    ///
    /// Parameters
    /// ----------
    /// projector : (int, int)
    ///     Width and height of the panel, px.
    /// palette : array_like
    ///     (hues, 3), sRGB from 0 to 255.
    /// sequence : array_like
    ///     (slits,), the colour of each slit: indices into the palette.
    /// centres_px : array_like
    ///     (slits,), ascending: projector column (or row) of each slit's centre, px.
    /// width_px : float
    ///     Width of a slit, px.
    /// axis : {"columns", "rows"}, default "columns"
    ///     Whether `centres_px` are columns or rows.
    /// order : int, default 3
    ///     Length of the unique windows of the sequence.
    ///
    /// Raises
    /// ------
    /// Error
    ///     When slits overlap or leave the panel, or no window is unique.
    #[staticmethod]
    #[pyo3(
        signature = (projector, palette, sequence, centres_px, width_px, *, axis=None, order=3),
        text_signature = "(projector, palette, sequence, centres_px, width_px, *, axis='columns', order=3)"
    )]
    fn from_slits(
        projector: &Bound<'_, PyAny>,
        palette: &Bound<'_, PyAny>,
        sequence: &Bound<'_, PyAny>,
        centres_px: &Bound<'_, PyAny>,
        width_px: f64,
        axis: Option<&Bound<'_, PyAny>>,
        order: u32,
    ) -> PyResult<Self> {
        let sequence: Vec<u8> =
            integers_of(sequence, "sequence", [0, 255])?.into_iter().map(|i| i as u8).collect();
        let made = pattern::StripePattern {
            projector: whole_pair(projector, "projector")?,
            axis: parsed_or(axis, "axis", Axis::Columns)?,
            palette: bytes_of(palette, "palette")?,
            centres_px: column_of(centres_px, sequence.len(), "centres_px", true)?,
            sequence,
            width_px,
            order,
        };
        made.validate().raise(projector.py(), Stage::Detect)?;
        Ok(Self(made))
    }

    /// Width and height of the panel, px.
    #[getter]
    fn projector(&self) -> (u32, u32) {
        self.0.projector.into()
    }

    /// "columns" for vertical slits, whose positions are columns of the panel; "rows" for horizontal ones.
    #[getter]
    fn axis(&self) -> &'static str {
        self.0.axis.name()
    }

    /// The colours: (hues, 3) uint8, sRGB.
    #[getter]
    fn palette<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(py, self.0.palette.iter().copied())
    }

    /// The colour of each slit: (slits,) uint8, indices into the palette.
    #[getter]
    fn sequence<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        column(py, self.0.sequence.iter().copied())
    }

    /// Projector column (or row) of each slit's centre: (slits,) float64, px.
    #[getter]
    fn centres_px<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        column(py, self.0.centres_px.iter().copied())
    }

    /// Width of a slit, px.
    #[getter]
    fn width_px(&self) -> f64 {
        self.0.width_px
    }

    /// Length of the unique windows of the sequence.
    #[getter]
    fn order(&self) -> u32 {
        self.0.order
    }

    /// The same picture with left and right exchanged, as a pattern of its own: where it lies on the panel of a projector that shows
    /// pictures mirrored.
    ///
    /// Returns
    /// -------
    /// StripePattern
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
        files::write(file, &json(file.py(), &Pattern::Stripes(self.0.clone()))?, true)
    }

    /// Reads a pattern file; see `slcal.load_pattern` for files of any kind.
    #[staticmethod]
    fn load(file: &Bound<'_, PyAny>) -> PyResult<Self> {
        stripes(file.py(), from_file(file)?)
    }

    /// The content of the pattern file.
    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        files::text_of(json(py, &Pattern::Stripes(self.0.clone()))?)
    }

    /// The pattern that `to_json` wrote.
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> PyResult<Self> {
        stripes(py, parse(py, text.as_bytes(), None)?)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((py.get_type::<Self>().getattr("from_json")?, (self.to_json(py)?,)))
    }

    fn __repr__(&self) -> String {
        let [w, h] = self.0.projector;
        format!(
            "StripePattern(projector=({w}, {h}), hues={}, order={}, slits={})",
            self.0.palette.len(),
            self.0.order,
            self.0.centres_px.len()
        )
    }
}
