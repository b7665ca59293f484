//! What was seen of one pose of the sheet.

use nalgebra::Point2;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};
use slcal_core::format::{read_observations, write_observations};
use slcal_core::geometry::RectangleSize;
use slcal_core::{CornerPair, EdgePoint, ExternalObservations, SheetObservation, Unstated};

use crate::convert::array::{Numbers, column, column_of, rows, rows_of};
use crate::convert::option::sheet_size;
use crate::errors::{self, Looking, Raise as _};
use crate::files;

/// Names of the sheet's sides, in the order of the core.
const SIDES: [&str; 4] = ["top", "right", "bottom", "left"];
const UNSTATED: f64 = slcal_core::ViewObservation::UNSTATED_SIGMA_PX;

/// What was seen of one pose of the sheet, by any detector: its corners or points on its sides, and the projected points.
///
/// Parameters
/// ----------
/// size_mm : (float, float)
///     Width and height of the sheet, mm; the width belongs to the sides that run most nearly along the image's x axis.
/// sheet_corners : array_like, optional
///     (4, 2), px: the corners TL, TR, BR, BL as the camera sees them. They may lie outside the frame.
/// sheet_edges : mapping, optional
///     Points on the sides instead: (N, 2), px, for each of "top", "right", "bottom" and "left"; or (N, 3) with the 1σ of each
///     point across its side, px.
/// pairs : array_like, optional
///     (N, 4), px: camera x, camera y, projector x, projector y of each point of the pattern; or (N, 5) with the 1σ of the
///     camera's coordinates. None when nothing is projected.
/// sheet_sigma_px : float or mapping, optional
///     1σ of the corners or of the points on the sides, px; a mapping gives it side by side, (N,) or one for all. Unless
///     it is given, calibration works it out from the residuals.
/// pair_sigma_px : array_like, optional
///     1σ of the camera's coordinates of the pairs, px: (N,) or one for all. Unless it is given, calibration works it out
///     from the residuals.
/// photo : str, optional
///     Name of the photograph.
///
/// Raises
/// ------
/// Error
///     When neither or both of corners and edges are given, for other shapes, for numbers that are not finite, for a σ that
///     is not positive.
/// TypeError
///     When something is no array of real numbers.
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
pub(crate) struct ViewObservation {
    pub(crate) seen: slcal_core::ViewObservation,
    pub(crate) unstated: Unstated,
    pub(crate) photo: Option<String>,
}

#[pymethods]
impl ViewObservation {
    #[new]
    #[pyo3(signature = (size_mm, *, sheet_corners=None, sheet_edges=None, pairs=None, sheet_sigma_px=None, pair_sigma_px=None, photo=None))]
    fn new(
        size_mm: &Bound<'_, PyAny>,
        sheet_corners: Option<&Bound<'_, PyAny>>,
        sheet_edges: Option<&Bound<'_, PyAny>>,
        pairs: Option<&Bound<'_, PyAny>>,
        sheet_sigma_px: Option<&Bound<'_, PyAny>>,
        pair_sigma_px: Option<&Bound<'_, PyAny>>,
        photo: Option<String>,
    ) -> PyResult<Self> {
        let py = size_mm.py();
        let size = sheet_size(size_mm)?;
        let (sheet, sheet_unstated) = match (sheet_corners, sheet_edges) {
            (Some(corners), None) => by_corners(corners, sheet_sigma_px)?,
            (None, Some(edges)) => by_edges(edges, sheet_sigma_px)?,
            (found, _) => {
                let found = if found.is_some() { "both" } else { "neither" };
                return Err(errors::invalid(py, "sheet", "either sheet_corners or sheet_edges", found));
            }
        };
        let (pairs, pairs_unstated) =
            pairs.map_or(Ok((Vec::new(), false)), |p| pairs_of(p, pair_sigma_px))?;
        let unstated = Unstated { sheet: sheet_unstated, pairs: pairs_unstated };
        Ok(Self { seen: slcal_core::ViewObservation { size, sheet, pairs }, unstated, photo })
    }

    /// Width and height of the sheet, mm.
    #[getter]
    fn size_mm(&self) -> (f64, f64) {
        (self.seen.size.width_mm, self.seen.size.height_mm)
    }

    /// Its corners TL, TR, BR, BL: (4, 2) float64, px; None when points on its sides are known instead.
    #[getter]
    fn sheet_corners<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        match &self.seen.sheet {
            SheetObservation::Corners { corners, .. } => {
                rows(py, corners.iter().map(|c| [c.x, c.y])).map(Some)
            }
            SheetObservation::Edges(_) => Ok(None),
        }
    }

    /// Points on its sides: (N, 2) float64, px, for "top", "right", "bottom", "left"; None when its corners are known instead.
    #[getter]
    fn sheet_edges<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        match &self.seen.sheet {
            SheetObservation::Corners { .. } => Ok(None),
            SheetObservation::Edges(_) => edges(py, &self.seen.sheet).map(Some),
        }
    }

    /// 1σ of the corners, px, or of the points on each side, (N,) float64; None where it was not stated.
    #[getter]
    fn sheet_sigma_px<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        match &self.seen.sheet {
            _ if self.unstated.sheet => Ok(None),
            SheetObservation::Corners { sigma_px, .. } => Ok(Some(sigma_px.into_pyobject(py)?.into_any())),
            SheetObservation::Edges(_) => Ok(Some(edge_sigma(py, &self.seen.sheet)?.into_any())),
        }
    }

    /// Camera x, camera y, projector x, projector y of each point of the pattern: (N, 4) float64, px.
    #[getter]
    fn pairs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(py, self.seen.pairs.iter().map(|p| [p.camera.x, p.camera.y, p.projector.x, p.projector.y]))
    }

    /// 1σ of the camera's coordinates of the pairs: (N,) float64, px; None where it was not stated.
    #[getter]
    fn pair_sigma_px<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        if self.unstated.pairs {
            return Ok(None);
        }
        column(py, self.seen.pairs.iter().map(|p| p.sigma_px)).map(Some)
    }

    /// Name of the photograph, where it has one.
    #[getter]
    fn photo(&self) -> Option<&str> {
        self.photo.as_deref()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((py.get_type::<Self>().getattr("_restored")?, (self.text(py)?,)))
    }

    #[staticmethod]
    fn _restored(py: Python<'_>, text: &str) -> PyResult<Self> {
        Self::of_text(py, text)
    }

    fn __repr__(&self) -> String {
        let (size, n) = (self.seen.size, self.seen.pairs.len());
        let photo = self.photo.as_deref().map_or(String::new(), |p| format!(", photo={p:?}"));
        let sheet = match &self.seen.sheet {
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
            views: vec![self.seen.clone()],
        };
        let external = ExternalObservations {
            observations,
            unstated: vec![self.unstated],
            photos: vec![self.photo.clone()],
        };
        let mut bytes = Vec::new();
        write_observations(&external, &mut bytes).raise(py, Looking::ForSheet)?;
        files::text_of(bytes)
    }

    pub(crate) fn of_text(py: Python<'_>, text: &str) -> PyResult<Self> {
        let read = read_observations(text.as_bytes()).raise(py, Looking::ForSheet)?;
        views_of(read).pop().ok_or_else(|| errors::invalid(py, "pickled observation", "one view", "none"))
    }
}

/// The views, each with what is known of it.
pub(super) fn views_of(external: ExternalObservations) -> Vec<ViewObservation> {
    let unstated: Vec<Unstated> =
        (0..external.observations.views.len()).map(|i| external.unstated(i)).collect();
    let photos = external.photos.into_iter().chain(std::iter::repeat(None));
    let views = external.observations.views.into_iter().zip(unstated).zip(photos);
    views.map(|((seen, unstated), photo)| ViewObservation { seen, unstated, photo }).collect()
}

/// A sheet of no size, as a view, so that it is pickled alike.
pub(crate) fn sizeless(sheet: SheetObservation) -> ViewObservation {
    let size = RectangleSize { width_mm: 1.0, height_mm: 1.0 };
    let unstated = Unstated { sheet: false, pairs: false };
    ViewObservation {
        seen: slcal_core::ViewObservation { size, sheet, pairs: Vec::new() },
        unstated,
        photo: None,
    }
}

fn by_side<'py>(
    py: Python<'py>,
    sheet: &SheetObservation,
    of: impl Fn(&[EdgePoint]) -> PyResult<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (i, name) in SIDES.iter().enumerate() {
        let points: &[EdgePoint] = match sheet {
            SheetObservation::Edges(sides) => &sides[i],
            SheetObservation::Corners { .. } => &[],
        };
        dict.set_item(name, of(points)?)?;
    }
    Ok(dict)
}

/// (N, 2) for each side; none where corners are known instead.
pub(crate) fn edges<'py>(py: Python<'py>, sheet: &SheetObservation) -> PyResult<Bound<'py, PyDict>> {
    by_side(py, sheet, |points| rows(py, points.iter().map(|p| [p.position.x, p.position.y])))
}

/// (N,) for each side.
pub(crate) fn edge_sigma<'py>(py: Python<'py>, sheet: &SheetObservation) -> PyResult<Bound<'py, PyDict>> {
    by_side(py, sheet, |points| column(py, points.iter().map(|p| p.sigma_px)))
}

/// Rows of `N` coordinates, or of one number more that is their σ.
fn with_sigma<const N: usize, const WITH: usize>(
    values: &Bound<'_, PyAny>,
    what: &str,
) -> PyResult<(Vec<[f64; N]>, Option<Vec<f64>>)> {
    let py = values.py();
    let last = Numbers::of(values, what)?.view().shape().last().copied();
    let (points, sigma) = if last == Some(WITH) {
        let full = rows_of::<WITH>(values, what)?;
        let points: Vec<[f64; N]> = full.iter().map(|row| std::array::from_fn(|k| row[k])).collect();
        (points, Some(full.iter().map(|row| row[WITH - 1]).collect::<Vec<f64>>()))
    } else {
        (rows_of::<N>(values, what)?, None)
    };
    let limit = slcal_core::ViewObservation::MAX_COORDINATE_PX;
    for (i, row) in points.iter().enumerate() {
        if let Some(far) = row.iter().find(|x| x.abs() > limit) {
            return Err(errors::invalid(py, what, "pixels up to 1e9", &format!("{far} in row {i}")));
        }
    }
    if let Some(sigma) = &sigma {
        check_sigma(py, sigma, &format!("{what}, last column"))?;
    }
    Ok((points, sigma))
}

fn check_sigma(py: Python<'_>, sigma: &[f64], what: &str) -> PyResult<()> {
    match sigma.iter().position(|s| !slcal_core::ViewObservation::SIGMA_RANGE_PX.contains(s)) {
        None => Ok(()),
        Some(i) => {
            let found = format!("{} in row {i}", sigma[i]);
            Err(errors::invalid(py, what, "1σ in pixels, a number above zero", &found))
        }
    }
}

fn stated(sigma: &Bound<'_, PyAny>, n: usize, what: &str) -> PyResult<Vec<f64>> {
    let sigma = (sigma.py(), column_of(sigma, n, what, true)?);
    check_sigma(sigma.0, &sigma.1, what)?;
    Ok(sigma.1)
}

/// Exactly four corners.
pub(crate) fn four_corners(values: &Bound<'_, PyAny>, what: &str) -> PyResult<[Point2<f64>; 4]> {
    let rows = rows_of::<2>(values, what)?;
    let found = format!("{} corners", rows.len());
    let limit = slcal_core::ViewObservation::MAX_COORDINATE_PX;
    if let Some(i) = rows.iter().position(|r| r.iter().any(|x| x.abs() > limit)) {
        let found = format!("{:?} in row {i}", rows[i]);
        return Err(errors::invalid(values.py(), what, "pixels up to 1e9", &found));
    }
    let four: [[f64; 2]; 4] = rows.try_into().map_err(|_| {
        errors::invalid(values.py(), what, "the four corners TL, TR, BR, BL, shape (4, 2)", &found)
    })?;
    Ok(four.map(Point2::from))
}

fn by_corners(
    corners: &Bound<'_, PyAny>,
    sigma: Option<&Bound<'_, PyAny>>,
) -> PyResult<(SheetObservation, bool)> {
    let corners = four_corners(corners, "sheet_corners")?;
    let sigma = sigma.map(|s| {
        if s.cast::<PyMapping>().is_ok() {
            let found = "a mapping, which belongs to sheet_edges";
            return Err(errors::invalid(s.py(), "sheet_sigma_px", "one number for the corners", found));
        }
        let found = stated(s, 1, "sheet_sigma_px")?;
        Ok(found.first().copied().unwrap_or(UNSTATED))
    });
    let sigma = sigma.transpose()?;
    let sheet = SheetObservation::Corners { corners, sigma_px: sigma.unwrap_or(UNSTATED) };
    Ok((sheet, sigma.is_none()))
}

/// The entry of each side.
fn four_sides<'py>(values: &Bound<'py, PyAny>, what: &str) -> PyResult<[Bound<'py, PyAny>; 4]> {
    let py = values.py();
    let Ok(mapping) = values.cast::<PyMapping>() else {
        let wanted = "a mapping with \"top\", \"right\", \"bottom\" and \"left\"";
        return Err(errors::wrong_type(what, wanted, &values.get_type().name()?.to_string()));
    };
    let wanted = "the sides \"top\", \"right\", \"bottom\" and \"left\"";
    for key in mapping.keys()?.iter() {
        if !key.extract::<String>().is_ok_and(|k| SIDES.contains(&k.as_str())) {
            return Err(errors::invalid(py, what, wanted, &key.repr()?.to_string()));
        }
    }
    let mut sides = Vec::with_capacity(4);
    for name in SIDES {
        if !mapping.contains(name)? {
            return Err(errors::invalid(py, what, wanted, &format!("no \"{name}\"")));
        }
        sides.push(mapping.get_item(name)?);
    }
    sides.try_into().map_err(|_| errors::invalid(py, what, wanted, "others"))
}

fn by_edges(
    edges: &Bound<'_, PyAny>,
    sigma: Option<&Bound<'_, PyAny>>,
) -> PyResult<(SheetObservation, bool)> {
    const SIGMA: &str = "sheet_sigma_px";
    let py = edges.py();
    let by_side = match sigma {
        Some(s) if s.cast::<PyMapping>().is_ok() => Some(four_sides(s, SIGMA)?),
        Some(s) => Some(std::array::from_fn(|_| s.clone())),
        None => None,
    };
    let mut sides: [Vec<EdgePoint>; 4] = Default::default();
    let (mut with, mut without) = (None, None);
    for (i, values) in four_sides(edges, "sheet_edges")?.iter().enumerate() {
        let (points, own) = with_sigma::<2, 3>(values, &format!("sheet_edges[\"{}\"]", SIDES[i]))?;
        let of_side = by_side.as_ref().map(|s| {
            let of_mapping = sigma.is_some_and(|s| s.cast::<PyMapping>().is_ok());
            let what = if of_mapping { format!("{SIGMA}[\"{}\"]", SIDES[i]) } else { SIGMA.to_owned() };
            stated(&s[i], points.len(), &what)
        });
        // What a point says of itself counts first, as in files.
        let sigma = own.or(of_side.transpose()?);
        if !points.is_empty() {
            *(if sigma.is_some() { &mut with } else { &mut without }) = Some(SIDES[i]);
        }
        let sigma = sigma.unwrap_or_else(|| vec![UNSTATED; points.len()]);
        let point = |(xy, sigma_px): (&[f64; 2], f64)| EdgePoint { position: Point2::from(*xy), sigma_px };
        sides[i] = points.iter().zip(sigma).map(point).collect();
    }
    if let (Some(with), Some(without)) = (with, without) {
        let found = format!("it for \"{with}\" and not for \"{without}\"; give the rest as {SIGMA}");
        return Err(errors::invalid(
            py,
            "sheet_edges",
            "σ as a third column for every side or for none",
            &found,
        ));
    }
    Ok((SheetObservation::Edges(sides), with.is_none()))
}

fn pairs_of(
    values: &Bound<'_, PyAny>,
    sigma: Option<&Bound<'_, PyAny>>,
) -> PyResult<(Vec<CornerPair>, bool)> {
    let (points, own) = with_sigma::<4, 5>(values, "pairs")?;
    let given = sigma.map(|s| stated(s, points.len(), "pair_sigma_px")).transpose()?;
    let sigma = own.or(given);
    let unstated = sigma.is_none() && !points.is_empty();
    let sigma = sigma.unwrap_or_else(|| vec![UNSTATED; points.len()]);
    let pair = |([cx, cy, px, py], sigma_px): ([f64; 4], f64)| CornerPair {
        camera: Point2::new(cx, cy),
        projector: Point2::new(px, py),
        sigma_px,
    };
    Ok((points.into_iter().zip(sigma).map(pair).collect(), unstated))
}
