//! Camera pixel ↔ projector coordinate: what decoders give and triangulation takes.

mod arrays;

use std::path::Path;

use pyo3::prelude::*;
use pyo3::types::PyTuple;
use slcal_cli::files::InputKind;
use slcal_core::format::{read_matches, write_matches};

pub(crate) use arrays::{MatchArrays, matches_of, sigma_of};

use crate::convert::array::{column, rows};
use crate::convert::object::{self, Argument};
use crate::convert::report::LazyReport;
use crate::errors::{Raise as _, Stage, raised_from};
use crate::files;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Matches>()
}

/// Correspondences: which projector column or row illuminates which camera pixel.
///
/// `slcal.decode` returns them; they can also be made from the arrays of another decoder. Two of them are equal when their
/// numbers are; the report is not compared.
///
/// Parameters
/// ----------
/// pixels : array_like
///     (N, 2), camera px: x right, y down, the centre of the first pixel at (0, 0).
/// columns, rows : array_like, optional
///     (N,), projector px; NaN where it is not known. At least one of the two is needed.
/// slits : array_like, optional
///     (N,), numbers of the slits from 0 on, -1 where there is none (the default).
/// confidence : array_like, optional
///     (N,) or one for all, 0 to 1; 1 unless given.
/// sigma_px : array_like, optional
///     (N,) or one for all: 1σ of the camera position across the stripe, px; 0.1 unless given.
/// colors : array_like, optional
///     (N, 3), sRGB from 0 to 255; white unless given.
///
/// Raises
/// ------
/// Error
///     When shapes do not match, pixels are not finite, or a number is out of range.
/// TypeError
///     When something is not an array of numbers.
///
/// Examples
/// --------
/// >>> matches = slcal.Matches([[320.5, 240], [330.25, 240]], columns=[400, 416], sigma_px=0.05)
/// >>> matches
/// Matches(2 with columns)
/// >>> matches.pixels[1]
/// array([330.25, 240.  ])
/// >>> matches.rows is None
/// True
#[pyclass(frozen, module = "slcal", eq)]
pub(crate) struct Matches {
    pub(crate) matches: slcal_core::Matches,
    pub(crate) report: LazyReport,
}

impl PartialEq for Matches {
    fn eq(&self, other: &Self) -> bool {
        self.matches == other.matches
    }
}

impl From<slcal_core::Matches> for Matches {
    fn from(matches: slcal_core::Matches) -> Self {
        Self { matches, report: LazyReport::default() }
    }
}

impl Argument for Matches {
    const EXPECTED: &'static str = "Matches";
    const OF_ARRAY: &'static str = "slcal.Matches(pixels, columns)";
    const OF_OTHER: &'static str = "slcal.decode(image, pattern), or slcal.Matches(pixels, columns)";

    fn of_path(path: &Path) -> String {
        object::load("Matches", path)
    }
}

#[pymethods]
impl Matches {
    #[new]
    #[pyo3(signature = (pixels, columns=None, rows=None, *, slits=None, confidence=None, sigma_px=None, colors=None))]
    fn new(
        pixels: &Bound<'_, PyAny>,
        columns: Option<&Bound<'_, PyAny>>,
        rows: Option<&Bound<'_, PyAny>>,
        slits: Option<&Bound<'_, PyAny>>,
        confidence: Option<&Bound<'_, PyAny>>,
        sigma_px: Option<&Bound<'_, PyAny>>,
        colors: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let given = MatchArrays { columns, rows, slits, confidence, sigma_px, colors };
        matches_of(pixels, given).map(Self::from)
    }

    /// Camera pixels (x, y): (N, 2) float64. Of stripes, sub-pixel across them and integer along them.
    #[getter]
    fn pixels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(py, self.matches.items.iter().map(|m| [m.camera.x, m.camera.y]))
    }

    /// Projector columns: (N,) float64, px, NaN where one is not known; None when the matches have rows alone.
    #[getter]
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let items = &self.matches.items;
        let rows_alone = items.iter().all(|m| m.projector_column.is_none())
            && items.iter().any(|m| m.projector_row.is_some());
        if rows_alone {
            return Ok(None);
        }
        column(py, items.iter().map(|m| m.projector_column.unwrap_or(f64::NAN))).map(Some)
    }

    /// Projector rows: (N,) float64, px, NaN where one is not known; None when the matches have columns alone.
    #[getter]
    fn rows<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let items = &self.matches.items;
        if items.iter().all(|m| m.projector_row.is_none()) {
            return Ok(None);
        }
        column(py, items.iter().map(|m| m.projector_row.unwrap_or(f64::NAN))).map(Some)
    }

    /// Numbers of the slits: (N,) int32, -1 where there is none.
    #[getter]
    fn slits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        column(py, self.matches.items.iter().map(|m| m.slit.map_or(-1, i32::from)))
    }

    /// Confidence of the matches: (N,) float64, 0 to 1.
    #[getter]
    fn confidence<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        column(py, self.matches.items.iter().map(|m| m.confidence))
    }

    /// 1σ of the camera positions across the stripe: (N,) float64, px.
    #[getter]
    fn sigma_px<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        column(py, self.matches.items.iter().map(|m| m.sigma_px))
    }

    /// Colours of the photograph there: (N, 3) uint8, sRGB.
    #[getter]
    fn colors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(py, self.matches.items.iter().map(|m| m.color))
    }

    /// Counts and measurements of decoding; None for matches that were constructed or loaded.
    #[getter]
    fn report(&self, py: Python<'_>) -> PyResult<Option<Py<PyAny>>> {
        self.report.get(py)
    }

    /// Writes the matches as CSV: u, v, projector_column and/or projector_row, slit, confidence, sigma_px.
    ///
    /// Positions, confidences and σ are rounded to 1e-5; colours are not part of the file.
    ///
    /// Parameters
    /// ----------
    /// file : path or file object
    ///     A path, where the file appears when it is complete and replaces an older one, or an object with write().
    fn save(&self, file: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = file.py();
        let write = || {
            let mut bytes = Vec::new();
            write_matches(&self.matches, &mut bytes).map(|()| bytes)
        };
        files::write(file, &py.detach(write).raise(py, Stage::Decode)?, true)
    }

    /// Reads matches from `save`, ``slcal decode`` or any other decoder.
    ///
    /// Parameters
    /// ----------
    /// file : path or file object
    ///     CSV with a header. The columns u, v and at least one of projector_column and projector_row are needed; slit,
    ///     confidence and sigma_px are taken when they are there.
    ///
    /// Returns
    /// -------
    /// Matches
    ///
    /// Raises
    /// ------
    /// OSError
    ///     When the file cannot be read.
    /// FormatError
    ///     When it does not have this format; the message names the line.
    #[staticmethod]
    fn load(file: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = file.py();
        let contents = files::read(file, InputKind::Matches)?;
        let name = contents.name.as_deref();
        let read = py.detach(|| read_matches(contents.bytes.as_slice()));
        read.map(Self::from).map_err(|e| raised_from(py, &e, Stage::Decode, name))
    }

    fn __len__(&self) -> usize {
        self.matches.items.len()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let state = [
            Some(self.pixels(py)?),
            // Also where there is not a single one: which of the two a match lacks is part of it.
            Some(column(py, self.matches.items.iter().map(|m| m.projector_column.unwrap_or(f64::NAN)))?),
            self.rows(py)?,
            Some(self.slits(py)?),
            Some(self.confidence(py)?),
            Some(self.sigma_px(py)?),
            Some(self.colors(py)?),
            self.report(py)?.map(|r| r.into_bound(py)),
        ];
        Ok((py.get_type::<Self>().getattr("_restored")?, PyTuple::new(py, state)?))
    }

    #[staticmethod]
    #[allow(clippy::too_many_arguments, reason = "a pickle's state")]
    fn _restored(
        pixels: &Bound<'_, PyAny>,
        columns: &Bound<'_, PyAny>,
        rows: Option<&Bound<'_, PyAny>>,
        slits: &Bound<'_, PyAny>,
        confidence: &Bound<'_, PyAny>,
        sigma_px: &Bound<'_, PyAny>,
        colors: &Bound<'_, PyAny>,
        report: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let given = MatchArrays {
            columns: Some(columns),
            rows,
            slits: Some(slits),
            confidence: Some(confidence),
            sigma_px: Some(sigma_px),
            colors: Some(colors),
        };
        let report = LazyReport::restored(pixels.py(), report);
        Ok(Self { matches: matches_of(pixels, given)?, report })
    }

    fn __repr__(&self) -> String {
        let items = &self.matches.items;
        let n = items.len();
        let known = [
            ("columns", items.iter().any(|m| m.projector_column.is_some())),
            ("rows", items.iter().any(|m| m.projector_row.is_some())),
        ];
        let known: Vec<&str> = known.iter().filter(|k| k.1).map(|k| k.0).collect();
        if known.is_empty() {
            return format!("Matches({n})");
        }
        let mut slits: Vec<u16> = items.iter().filter_map(|m| m.slit).collect();
        slits.sort_unstable();
        slits.dedup();
        let slits = if slits.is_empty() { String::new() } else { format!(" of {} slits", slits.len()) };
        format!("Matches({n} with {}{slits})", known.join(" and "))
    }
}
