//! Panel coordinates of every camera pixel: the result of decoding a sequence.

mod planes;

use std::path::Path;

use pyo3::prelude::*;
use pyo3::types::PyTuple;
use slcal_cli::files::InputKind;
use slcal_core::decode::SequenceDecoding;
use slcal_core::format::{read_dense_matches, write_dense_matches};

use self::planes::{Bytes, Floats, color_of, floats, same_floats, sigma_of, values_of};
use crate::convert::object::{self, Argument};
use crate::convert::report::LazyReport;
use crate::errors::{self, Raise as _, Stage, raised_from};
use crate::files;
use crate::matches::Matches;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<DenseMatches>()
}

/// Which projector column and row illuminate each camera pixel.
///
/// `slcal.decode` returns them for a sequence; they can also be made from the arrays of another decoder. The arrays are those of the
/// object itself: they are not copied, and cannot be written to. Two of them are equal when their numbers are (NaN equals NaN); the
/// report is not compared. The length is the number of pixels with a column, a row, or both.
///
/// Parameters
/// ----------
/// column, row : array_like, optional
///     (H, W), projector px; NaN where it is not known. At least one of the two is needed.
/// sigma_column, sigma_row : array_like, optional
///     (H, W) or one for all: 1σ of them, projector px; 0.1 unless given.
/// confidence : array_like, optional
///     (H, W) or one for all, 0 to 1; 1 unless given.
/// color : ndarray, optional
///     (H, W, 3) uint8, sRGB: the colour of each pixel under white light.
///
/// Raises
/// ------
/// Error
///     When shapes do not match, or a number is out of range.
/// TypeError
///     When something is not an array of numbers.
///
/// Examples
/// --------
/// >>> matches = slcal.DenseMatches([[400, 401.5], [np.nan, 402]], sigma_column=0.02)
/// >>> matches
/// DenseMatches(2x2 px, 3 with columns)
/// >>> len(matches), matches.row is None
/// (3, True)
/// >>> matches.column.dtype, matches.column.flags.writeable
/// (dtype('float32'), False)
#[pyclass(frozen, module = "slcal")]
pub(crate) struct DenseMatches {
    width: usize,
    height: usize,
    column: Option<Floats>,
    sigma_column: Option<Floats>,
    row: Option<Floats>,
    sigma_row: Option<Floats>,
    confidence: Floats,
    color: Option<Bytes>,
    report: LazyReport,
}

impl Argument for DenseMatches {
    const EXPECTED: &'static str = "DenseMatches";
    const OF_ARRAY: &'static str = "slcal.DenseMatches(column, row)";
    const OF_OTHER: &'static str = "slcal.decode(frames, pattern), or slcal.DenseMatches(column, row)";

    fn of_path(path: &Path) -> String {
        object::load("DenseMatches", path)
    }
}

impl DenseMatches {
    /// Takes the arrays over.
    pub(crate) fn of(py: Python<'_>, decoding: SequenceDecoding) -> PyResult<Self> {
        let report = LazyReport::of("SequenceDecodeReport", &decoding.report);
        Self::taken(py, decoding.matches, report)
    }

    fn taken(py: Python<'_>, matches: slcal_core::DenseMatches, report: LazyReport) -> PyResult<Self> {
        let slcal_core::DenseMatches {
            width,
            height,
            column,
            sigma_column,
            row,
            sigma_row,
            mut confidence,
            color,
        } = matches;
        if confidence.is_empty() {
            confidence.resize(width * height, 1.0);
        }
        let plane = |values: Vec<f32>| {
            (!values.is_empty()).then(|| Floats::taken(py, values, [height, width])).transpose()
        };
        Ok(Self {
            width,
            height,
            column: plane(column)?,
            sigma_column: plane(sigma_column)?,
            row: plane(row)?,
            sigma_row: plane(sigma_row)?,
            confidence: Floats::taken(py, confidence, [height, width])?,
            color: (!color.is_empty()).then(|| Bytes::taken(py, color, [height, width])).transpose()?,
            report,
        })
    }

    /// The same as the core has it: a copy.
    pub(crate) fn core(&self, py: Python<'_>) -> PyResult<slcal_core::DenseMatches> {
        let values = |of: &Option<Floats>| of.as_ref().map_or(Ok(Vec::new()), |f| f.values(py));
        Ok(slcal_core::DenseMatches {
            width: self.width,
            height: self.height,
            column: values(&self.column)?,
            sigma_column: values(&self.sigma_column)?,
            row: values(&self.row)?,
            sigma_row: values(&self.sigma_row)?,
            confidence: self.confidence.values(py)?,
            color: self.color.as_ref().map_or(Ok(Vec::new()), |c| c.values(py))?,
        })
    }

    fn planes(&self) -> [Option<&Floats>; 5] {
        let Self { column, sigma_column, row, sigma_row, confidence, .. } = self;
        [column.as_ref(), sigma_column.as_ref(), row.as_ref(), sigma_row.as_ref(), Some(confidence)]
    }

    /// Pixels with a column, with a row, and with one of them.
    fn known(&self, py: Python<'_>) -> PyResult<[usize; 3]> {
        let column = self.column.as_ref().map(|f| f.read(py));
        let row = self.row.as_ref().map(|f| f.read(py));
        let [columns, rows] = [&column, &row].map(|f| f.as_ref().map(|f| f.as_slice()).transpose());
        let (columns, rows) = (columns?.unwrap_or_default(), rows?.unwrap_or_default());
        let finite = |of: &[f32], i: usize| of.get(i).is_some_and(|x| x.is_finite());
        let count =
            |is: &(dyn Fn(usize) -> bool + Sync)| (0..self.width * self.height).filter(|i| is(*i)).count();
        Ok(py.detach(|| {
            [
                count(&|i| finite(columns, i)),
                count(&|i| finite(rows, i)),
                count(&|i| finite(columns, i) || finite(rows, i)),
            ]
        }))
    }
}

#[pymethods]
impl DenseMatches {
    #[new]
    #[pyo3(signature = (column=None, row=None, *, sigma_column=None, sigma_row=None, confidence=None, color=None))]
    fn new(
        py: Python<'_>,
        column: Option<&Bound<'_, PyAny>>,
        row: Option<&Bound<'_, PyAny>>,
        sigma_column: Option<&Bound<'_, PyAny>>,
        sigma_row: Option<&Bound<'_, PyAny>>,
        confidence: Option<&Bound<'_, PyAny>>,
        color: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let columns = column.map(|v| values_of(v, "column")).transpose()?;
        let rows = row.map(|v| values_of(v, "row")).transpose()?;
        let shape = match (&columns, &rows) {
            (None, None) => {
                let wanted = "the projector column or row (or both) of each pixel";
                return Err(errors::invalid(py, "column", wanted, "neither column nor row"));
            }
            (Some((_, shape)), Some((_, other))) if shape != other => {
                let [wanted, found] = [shape, other].map(|[h, w]| format!("shape ({h}, {w})"));
                return Err(errors::invalid(py, "row", &format!("{wanted}, as column"), &found));
            }
            (Some((_, shape)), _) | (None, Some((_, shape))) => *shape,
        };
        for (what, sigma, of) in [("sigma_column", sigma_column, &columns), ("sigma_row", sigma_row, &rows)] {
            if sigma.is_some() && of.is_none() {
                let of = &what["sigma_".len()..];
                return Err(errors::invalid(py, what, &format!("none without {of}"), "an array"));
            }
        }
        let [sigma_column, sigma_row] =
            [(&columns, sigma_column, "sigma_column"), (&rows, sigma_row, "sigma_row")].map(
                |(values, sigma, what)| match values {
                    None => Ok(Vec::new()),
                    Some((values, _)) => sigma_of(py, sigma, shape, what, values),
                },
            );
        let [height, width] = shape;
        let confidence = match confidence {
            None => vec![1.0; width * height],
            Some(v) => floats(v, shape, "confidence", [0.0, 1.0])?,
        };
        let matches = slcal_core::DenseMatches {
            width,
            height,
            column: columns.map_or_else(Vec::new, |c| c.0),
            sigma_column: sigma_column?,
            row: rows.map_or_else(Vec::new, |r| r.0),
            sigma_row: sigma_row?,
            confidence,
            color: color.map_or(Ok(Vec::new()), |c| color_of(c, shape))?,
        };
        Self::taken(py, matches, LazyReport::default())
    }

    /// Projector column of each pixel: (H, W) float32, px, NaN where there is none; None when columns are not coded.
    #[getter]
    fn column<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.column.as_ref().map(|f| f.array(py))
    }

    /// 1σ of `column`: (H, W) float32, projector px, NaN where there is none; None when columns are not coded.
    #[getter]
    fn sigma_column<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.sigma_column.as_ref().map(|f| f.array(py))
    }

    /// Projector row of each pixel: (H, W) float32, px, NaN where there is none; None when rows are not coded.
    #[getter]
    fn row<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.row.as_ref().map(|f| f.array(py))
    }

    /// 1σ of `row`: (H, W) float32, projector px, NaN where there is none; None when rows are not coded.
    #[getter]
    fn sigma_row<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.sigma_row.as_ref().map(|f| f.array(py))
    }

    /// Confidence of each pixel: (H, W) float32, 0 to 1.
    #[getter]
    fn confidence<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        self.confidence.array(py)
    }

    /// Colour of each pixel under white light: (H, W, 3) uint8, sRGB; None when the sequence has no white picture.
    #[getter]
    fn color<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyAny>> {
        self.color.as_ref().map(|c| c.array(py))
    }

    /// Counts and measurements of decoding; None for matches that were constructed or loaded.
    #[getter]
    fn report(&self, py: Python<'_>) -> PyResult<Option<Py<PyAny>>> {
        self.report.get(py)
    }

    /// The pixels that have a match, as a list without gaps.
    ///
    /// `Matches.sigma_px` is in camera px. It is set to the σ of the projector's position, as if pixels of both had the same size on the
    /// surface; `Rig.triangulate` of the dense matches themselves needs no such assumption.
    ///
    /// Returns
    /// -------
    /// Matches
    ///     In the order of the pixels, row by row.
    fn to_matches(&self, py: Python<'_>) -> PyResult<Matches> {
        let matches = self.core(py)?;
        Ok(py.detach(|| matches.to_matches()).into())
    }

    /// Writes the pixels that have a match as NumPy's .npz: u, v, projector_column, sigma_column_px, projector_row, sigma_row_px,
    /// confidence, color, image_size.
    ///
    /// Parameters
    /// ----------
    /// file : path or binary file object
    ///     A path, where the file appears when it is complete and replaces an older one, or an object with write().
    fn save(&self, file: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = file.py();
        let matches = self.core(py)?;
        let write = || {
            let mut bytes = Vec::new();
            write_dense_matches(&matches, &mut bytes).map(|()| bytes)
        };
        files::write(file, &py.detach(write).raise(py, Stage::Decode)?, false)
    }

    /// Reads matches from `save`, ``slcal decode`` or another program.
    ///
    /// Parameters
    /// ----------
    /// file : path or binary file object
    ///     A .npz. The arrays u, v and at least one of projector_column and projector_row are needed; the others are taken when they are
    ///     there.
    ///
    /// Returns
    /// -------
    /// DenseMatches
    ///
    /// Raises
    /// ------
    /// OSError
    ///     When the file cannot be read.
    /// FormatError
    ///     When it does not have this format; the message names the array.
    #[staticmethod]
    fn load(file: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = file.py();
        let contents = files::read(file, InputKind::Matches)?;
        let name = contents.name.as_deref();
        let read = py.detach(|| read_dense_matches(&contents.bytes));
        let matches = read.map_err(|e| raised_from(py, &e, Stage::Decode, name))?;
        Self::taken(py, matches, LazyReport::default())
    }

    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        self.known(py).map(|[_, _, any]| any)
    }

    fn __eq__(&self, py: Python<'_>, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        let Ok(other) = other.cast::<Self>() else { return Ok(py.NotImplemented()) };
        let other = other.get();
        let mut same = (self.width, self.height) == (other.width, other.height);
        for (a, b) in self.planes().into_iter().zip(other.planes()) {
            same = same && same_floats(py, a, b)?;
        }
        let colors = [&self.color, &other.color].map(|c| c.as_ref().map(|c| c.values(py)).transpose());
        let [a, b] = colors;
        same = same && a? == b?;
        Ok(same.into_pyobject(py)?.to_owned().into_any().unbind())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let state = [
            self.column(py),
            self.sigma_column(py),
            self.row(py),
            self.sigma_row(py),
            Some(self.confidence(py)),
            self.color(py),
            self.report(py)?.map(|r| r.into_bound(py)),
        ];
        Ok((py.get_type::<Self>().getattr("_restored")?, PyTuple::new(py, state)?))
    }

    #[staticmethod]
    #[allow(clippy::too_many_arguments, reason = "a pickle's state")]
    fn _restored(
        py: Python<'_>,
        column: Option<&Bound<'_, PyAny>>,
        sigma_column: Option<&Bound<'_, PyAny>>,
        row: Option<&Bound<'_, PyAny>>,
        sigma_row: Option<&Bound<'_, PyAny>>,
        confidence: &Bound<'_, PyAny>,
        color: Option<&Bound<'_, PyAny>>,
        report: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let made = Self::new(py, column, row, sigma_column, sigma_row, Some(confidence), color)?;
        Ok(Self { report: LazyReport::restored(py, report), ..made })
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let [columns, rows, any] = self.known(py)?;
        let (w, h) = (self.width, self.height);
        Ok(match (&self.column, &self.row) {
            (Some(_), Some(_)) if columns == any && rows == any => {
                format!("DenseMatches({w}x{h} px, {any} with columns and rows)")
            }
            (Some(_), Some(_)) => {
                format!("DenseMatches({w}x{h} px, {columns} with columns, {rows} with rows)")
            }
            (None, Some(_)) => format!("DenseMatches({w}x{h} px, {rows} with rows)"),
            _ => format!("DenseMatches({w}x{h} px, {columns} with columns)"),
        })
    }
}
