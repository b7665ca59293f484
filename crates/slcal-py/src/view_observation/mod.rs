//! What was seen of one pose of the sheet.

mod arrays;

use std::path::Path;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use slcal_core::format::{read_observations, write_observations};
use slcal_core::geometry::RectangleSize;
use slcal_core::{RedBlue, SheetObservation};

pub(crate) use arrays::{edge_sigma, edges, four_corners, pair_sigma};

use crate::convert::array::rows;
use crate::convert::object::Argument;
use crate::convert::option::definite_size;
use crate::errors::{self, Raise as _, Stage};
use crate::files;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<ViewObservation>()
}

/// The observations of one pose of the sheet, by any detector: its corners or points on its sides, and the projected
/// points.
///
/// Parameters
/// ----------
/// size_mm : (float, float) or str
///     Width and height of the sheet, mm, or a text such as "A2-landscape" or "594x420mm". The width is that of the sides
///     closest to the image's x axis; the name of a paper alone is upright.
/// sheet_corners : array_like, optional
///     (4, 2), px: the corners TL, TR, BR, BL in the photograph. They may lie outside the image.
/// sheet_edges : mapping, optional
///     Points on the sides instead: (N, 2), px, for each of "top", "right", "bottom" and "left"; or (N, 3) with the 1σ of each
///     point across its side, px.
/// pairs : array_like, optional
///     (N, 4), px: camera x, camera y, projector x, projector y of each point of the pattern; or (N, 5) with the 1σ of the
///     camera's coordinates. None without a pattern.
/// sheet_sigma_px : float or mapping, optional
///     1σ of the corners or of the points on the sides, px. A mapping has it for each side, (N,) or one for all. By default
///     it is estimated from the residuals.
/// pair_sigma_px : array_like, optional
///     1σ of the camera's coordinates of the pairs, px: (N,) or one for all. By default it is estimated from the residuals.
/// panel_points : array_like, optional
///     (N, 5), px: camera x, camera y, panel x, panel y and 1σ of points whose place on the panel is known, as the property
///     `panel_points` has them.
/// channel_offsets : array_like, optional
///     (N, 10), px: how red and blue are displaced against green at corners of the pattern, as the property `channel_offsets` has
///     them.
/// photo : str, optional
///     Name of the photograph.
///
/// Raises
/// ------
/// Error
///     When neither or both of corners and edges are given, when a shape is wrong, a number is not finite, or a σ is not
///     positive.
/// TypeError
///     When something is not an array of real numbers.
///
/// Examples
/// --------
/// >>> corners = [[100, 90], [1100, 110], [1050, 800], [80, 780]]
/// >>> view = slcal.ViewObservation((594, 420), sheet_corners=corners, sheet_sigma_px=0.1)
/// >>> view
/// ViewObservation(size_mm=(594, 420), sheet by its corners, 0 pairs)
/// >>> view.sheet_corners.shape, view.pairs.shape
/// ((4, 2), (0, 4))
#[pyclass(frozen, module = "slcal", eq)]
#[derive(PartialEq, Clone)]
pub(crate) struct ViewObservation(pub(crate) slcal_core::ViewObservation);

impl Argument for ViewObservation {
    const EXPECTED: &'static str = "a ViewObservation or a Detection";
    const OF_ARRAY: &'static str = "slcal.detect(photo, size_mm, pattern)";
    const OF_OTHER: &'static str =
        "slcal.detect(photo, size_mm, pattern), or slcal.ViewObservation(size_mm, sheet_corners=...)";

    fn of_path(path: &Path) -> String {
        format!("slcal.detect(slcal.read_image({:?}), size_mm, pattern)", path.display().to_string())
    }
}

#[pymethods]
impl ViewObservation {
    #[new]
    #[pyo3(signature = (size_mm, *, sheet_corners=None, sheet_edges=None, pairs=None, sheet_sigma_px=None, pair_sigma_px=None, panel_points=None, channel_offsets=None, photo=None))]
    #[allow(clippy::too_many_arguments, reason = "keyword arguments are what a Python user expects")]
    fn new(
        size_mm: &Bound<'_, PyAny>,
        sheet_corners: Option<&Bound<'_, PyAny>>,
        sheet_edges: Option<&Bound<'_, PyAny>>,
        pairs: Option<&Bound<'_, PyAny>>,
        sheet_sigma_px: Option<&Bound<'_, PyAny>>,
        pair_sigma_px: Option<&Bound<'_, PyAny>>,
        panel_points: Option<&Bound<'_, PyAny>>,
        channel_offsets: Option<&Bound<'_, PyAny>>,
        photo: Option<String>,
    ) -> PyResult<Self> {
        let py = size_mm.py();
        let size = definite_size(size_mm)?;
        let sheet = match (sheet_corners, sheet_edges) {
            (Some(corners), None) => arrays::by_corners(corners, sheet_sigma_px)?,
            (None, Some(edges)) => arrays::by_edges(edges, sheet_sigma_px)?,
            (found, _) => {
                let found = if found.is_some() { "both" } else { "neither" };
                return Err(errors::invalid(py, "sheet", "either sheet_corners or sheet_edges", found));
            }
        };
        let pairs = pairs.map_or(Ok(Vec::new()), |p| arrays::pairs_of(p, pair_sigma_px))?;
        let panel_points = panel_points.map_or(Ok(Vec::new()), arrays::panel_points_of)?;
        let channel_offsets = channel_offsets.map_or(Ok(Vec::new()), arrays::channel_offsets_of)?;
        Ok(Self(slcal_core::ViewObservation { photo, size, sheet, pairs, panel_points, channel_offsets }))
    }

    /// Width and height of the sheet, mm.
    #[getter]
    fn size_mm(&self) -> (f64, f64) {
        (self.0.size.width_mm, self.0.size.height_mm)
    }

    /// Its corners TL, TR, BR, BL: (4, 2) float64, px; None when there are points on its sides instead.
    #[getter]
    fn sheet_corners<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        match &self.0.sheet {
            SheetObservation::Corners { corners, .. } => {
                rows(py, corners.iter().map(|c| [c.x, c.y])).map(Some)
            }
            SheetObservation::Edges(_) => Ok(None),
        }
    }

    /// Points on its sides: (N, 2) float64, px, for "top", "right", "bottom", "left"; None when there are corners instead.
    #[getter]
    fn sheet_edges<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        match &self.0.sheet {
            SheetObservation::Corners { .. } => Ok(None),
            SheetObservation::Edges(_) => edges(py, &self.0.sheet).map(Some),
        }
    }

    /// 1σ of the corners, px, or of the points on each side, (N,) float64; None where it was not given.
    #[getter]
    fn sheet_sigma_px<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        match &self.0.sheet {
            _ if !self.0.states_sheet_sigma() => Ok(None),
            SheetObservation::Corners { sigma_px, .. } => Ok(Some(sigma_px.into_pyobject(py)?)),
            SheetObservation::Edges(_) => Ok(Some(edge_sigma(py, &self.0.sheet)?.into_any())),
        }
    }

    /// Camera x, camera y, projector x, projector y of each point of the pattern: (N, 4) float64, px.
    #[getter]
    fn pairs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(py, self.0.pairs.iter().map(|p| [p.camera.x, p.camera.y, p.projector.x, p.projector.y]))
    }

    /// 1σ of the camera's coordinates of the pairs: (N,) float64, px; None where it was not given.
    #[getter]
    fn pair_sigma_px<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.0.states_pair_sigma().then(|| pair_sigma(py, &self.0.pairs)).transpose()
    }

    /// Camera x, camera y, panel x, panel y and 1σ of points on the border of the projector's light and of marks: (N, 5)
    /// float64, px. NaN stands for the coordinate along a border, and for a σ that was not given. They test whether the picture was shown pixel for pixel.
    #[getter]
    fn panel_points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(
            py,
            self.0.panel_points.iter().map(|p| {
                let [x, y] = p.expected.map(|c| c.unwrap_or(f64::NAN));
                [p.camera.x, p.camera.y, x, y, p.sigma_px.unwrap_or(f64::NAN)]
            }),
        )
    }

    /// How red and blue are displaced against green at corners of the pattern: (N, 10) float64, px. Camera x and y, projector x and
    /// y, red x and y, blue x and y, 1σ of red and of blue. None are found in grey photographs.
    #[getter]
    fn channel_offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(
            py,
            self.0.channel_offsets.iter().map(|o| {
                let (c, p, sigma) = (o.camera, o.projector, o.sigma_px);
                let RedBlue { red, blue } = o.offset_px;
                [c.x, c.y, p.x, p.y, red.x, red.y, blue.x, blue.y, sigma.red, sigma.blue]
            }),
        )
    }

    /// Name of the photograph, where it has one.
    #[getter]
    fn photo(&self) -> Option<&str> {
        self.0.photo.as_deref()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((py.get_type::<Self>().getattr("_restored")?, (self.text(py)?,)))
    }

    #[staticmethod]
    fn _restored(py: Python<'_>, text: &str) -> PyResult<Self> {
        Self::of_text(py, text)
    }

    fn __repr__(&self) -> String {
        let (size, n) = (self.0.size, self.0.pairs.len());
        let photo = self.0.photo.as_deref().map_or(String::new(), |p| format!(", photo={p:?}"));
        let sheet = match &self.0.sheet {
            SheetObservation::Corners { .. } => "sheet by its corners".to_owned(),
            SheetObservation::Edges(sides) => {
                format!("sheet by {} points on its sides", sides.iter().map(Vec::len).sum::<usize>())
            }
        };
        format!("ViewObservation(size_mm=({}, {}), {sheet}, {n} pairs{photo})", size.width_mm, size.height_mm)
    }
}

impl ViewObservation {
    /// As text that reads back to the same bits; it is pickled so.
    pub(crate) fn text(&self, py: Python<'_>) -> PyResult<String> {
        let observations = slcal_core::Observations {
            // Of no meaning here.
            camera: [1; 2],
            projector: Some([1; 2]),
            mirrored: false,
            views: vec![self.0.clone()],
        };
        let mut bytes = Vec::new();
        write_observations(&observations, &mut bytes).raise(py, Stage::Detect)?;
        files::text_of(bytes)
    }

    pub(crate) fn of_text(py: Python<'_>, text: &str) -> PyResult<Self> {
        let mut read = read_observations(text.as_bytes()).raise(py, Stage::Detect)?;
        let view = read.views.pop().map(Self);
        view.ok_or_else(|| errors::invalid(py, "pickled observation", "one view", "none"))
    }
}

/// A sheet of no size, as a view, so that it is pickled alike.
pub(crate) fn sizeless(sheet: SheetObservation) -> ViewObservation {
    let size = RectangleSize { width_mm: 1.0, height_mm: 1.0 };
    ViewObservation(slcal_core::ViewObservation {
        photo: None,
        size,
        sheet,
        pairs: Vec::new(),
        panel_points: Vec::new(),
        channel_offsets: Vec::new(),
    })
}
