//! What was found in a photograph.

use nalgebra::Point2;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use slcal_core::{CornerPair, SheetObservation, Warning, detect};

use crate::convert::array::{rows, rows_of};
use crate::view_observation::{ViewObservation, edge_sigma, edges, pair_sigma, sizeless};

/// What restores an object from a pickle, and its arguments.
type Pickled<'py, State> = (Bound<'py, PyAny>, State);

/// The sheet in a photograph: points on its sides, and the corners where the sides meet.
#[pyclass(frozen, module = "slcal", eq)]
#[derive(PartialEq)]
pub(crate) struct SheetDetection(pub(crate) detect::SheetDetection);

#[pymethods]
impl SheetDetection {
    /// Corners TL, TR, BR, BL: (4, 2) float64, px; intersections of straight lines through the sides, in a distorted
    /// photograph as accurate as the sides are straight. None where neighbouring sides are parallel.
    #[getter]
    fn corners<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.0.observation.corners().map(|four| rows(py, four.iter().map(|c| [c.x, c.y]))).transpose()
    }

    /// Points on "top", "right", "bottom" and "left": (N, 2) float64, px; empty where corners given by hand are used
    /// unchanged.
    #[getter]
    fn edges<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        edges(py, &self.0.observation)
    }

    /// 1σ of these points across their sides: (N,) float64, px. With it they may be treated as independent.
    #[getter]
    fn edge_sigma_px<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        edge_sigma(py, &self.0.observation)
    }

    /// 1σ of corners given by hand that are used unchanged, px; None where the sides were measured.
    #[getter]
    fn corner_sigma_px(&self) -> Option<f64> {
        match self.0.observation {
            SheetObservation::Corners { sigma_px, .. } => sigma_px,
            SheetObservation::Edges(_) => None,
        }
    }

    /// Notes for the user, such as corners that were given by hand or parts of a side that are covered.
    #[getter]
    fn notes(&self) -> Vec<String> {
        with_warnings(&self.0.notes, &self.0.warnings)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py, (String, Vec<String>)>> {
        let view = sizeless(self.0.observation.clone());
        Ok((py.get_type::<Self>().getattr("_restored")?, (view.text(py)?, self.notes())))
    }

    #[staticmethod]
    fn _restored(py: Python<'_>, view: &str, notes: Vec<String>) -> PyResult<Self> {
        let observation = ViewObservation::of_text(py, view)?.0.sheet;
        Ok(Self(detect::SheetDetection { observation, notes, warnings: Vec::new() }))
    }

    fn __repr__(&self) -> String {
        let corners = self.0.observation.corners().map_or("no corners".to_owned(), |four| {
            four.map(|c| format!("({:.1}, {:.1})", c.x, c.y)).join(", ")
        });
        let points = match &self.0.observation {
            SheetObservation::Edges(sides) => sides.iter().map(Vec::len).sum::<usize>(),
            SheetObservation::Corners { .. } => 0,
        };
        format!("SheetDetection({corners}; {points} points on its sides)")
    }
}

/// The corners of the pattern that were found.
#[pyclass(frozen, module = "slcal", eq)]
#[derive(PartialEq)]
pub(crate) struct CornerDetection(pub(crate) detect::CornerDetection);

#[pymethods]
impl CornerDetection {
    /// Their positions in the photograph: (N, 2) float64, px, row by row of the pattern.
    #[getter]
    fn camera_px<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(py, self.0.pairs.iter().map(|p| [p.camera.x, p.camera.y]))
    }

    /// Their positions on the projector's panel: (N, 2) float64, px, exact.
    #[getter]
    fn projector_px<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(py, self.0.pairs.iter().map(|p| [p.projector.x, p.projector.y]))
    }

    /// 1σ of each camera coordinate: (N,) float64, px.
    #[getter]
    fn sigma_px<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pair_sigma(py, &self.0.pairs)
    }

    /// Number of corners of the whole pattern.
    #[getter]
    fn expected(&self) -> usize {
        self.0.expected
    }

    fn __len__(&self) -> usize {
        self.0.pairs.len()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py, (Bound<'py, PyAny>, usize)>> {
        let sigma = |p: &CornerPair| p.sigma_px.unwrap_or(f64::NAN);
        let state =
            self.0.pairs.iter().map(|p| [p.camera.x, p.camera.y, p.projector.x, p.projector.y, sigma(p)]);
        Ok((py.get_type::<Self>().getattr("_restored")?, (rows(py, state)?, self.0.expected)))
    }

    #[staticmethod]
    fn _restored(pairs: &Bound<'_, PyAny>, expected: usize) -> PyResult<Self> {
        let pair = |[cx, cy, px, py, sigma_px]: [f64; 5]| CornerPair {
            camera: Point2::new(cx, cy),
            projector: Point2::new(px, py),
            sigma_px: Some(sigma_px),
        };
        let pairs = rows_of::<5>(pairs, "pickled corners")?.into_iter().map(pair).collect();
        Ok(Self(detect::CornerDetection { pairs, expected }))
    }

    fn __repr__(&self) -> String {
        format!("CornerDetection({} of {} corners)", self.0.pairs.len(), self.0.expected)
    }
}

/// Sheet and corners of one photograph.
#[pyclass(frozen, module = "slcal", eq)]
#[derive(PartialEq)]
pub(crate) struct Detection(pub(crate) detect::Detection);

impl Detection {
    /// As calibration takes it.
    pub(crate) fn as_view(&self) -> ViewObservation {
        ViewObservation(self.0.observation.clone())
    }
}

#[pymethods]
impl Detection {
    /// The sheet.
    #[getter]
    fn sheet(&self) -> SheetDetection {
        let observation = self.0.observation.sheet.clone();
        SheetDetection(detect::SheetDetection {
            observation,
            notes: self.0.notes.clone(),
            warnings: self.0.warnings.clone(),
        })
    }

    /// The corners of the pattern that were found on the sheet; none without a pattern.
    #[getter]
    fn corners(&self) -> CornerDetection {
        let pairs = self.0.observation.pairs.clone();
        CornerDetection(detect::CornerDetection { pairs, expected: self.0.pattern_corners })
    }

    /// Sheet and corners as an observation for calibration.
    #[getter]
    fn view(&self) -> ViewObservation {
        self.as_view()
    }

    /// Notes for the user: corners that were not found or lie outside the sheet, corners that were given by hand, sides of
    /// the sheet that are covered in part, or that show the side face of a board.
    #[getter]
    fn notes(&self) -> Vec<String> {
        with_warnings(&self.0.notes, &self.0.warnings)
    }

    /// How much of the lit sheet is overexposed, per cent.
    #[getter]
    fn clipped_percent(&self) -> f64 {
        100.0 * self.0.clipped
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py, (String, usize, Vec<String>, f64)>> {
        let state = (self.as_view().text(py)?, self.0.pattern_corners, self.notes(), self.0.clipped);
        Ok((py.get_type::<Self>().getattr("_restored")?, state))
    }

    #[staticmethod]
    fn _restored(
        py: Python<'_>,
        view: &str,
        pattern_corners: usize,
        notes: Vec<String>,
        clipped: f64,
    ) -> PyResult<Self> {
        let observation = ViewObservation::of_text(py, view)?.0;
        Ok(Self(detect::Detection { observation, pattern_corners, notes, clipped, warnings: Vec::new() }))
    }

    fn __repr__(&self) -> String {
        let sheet = match self.0.observation.sheet {
            SheetObservation::Edges(_) => "sheet found",
            SheetObservation::Corners { .. } => "sheet by the given corners",
        };
        let corners = match (self.0.pattern_corners, self.0.observation.pairs.len()) {
            (0, _) => "no pattern".to_owned(),
            (expected, seen) => format!("{seen} of {expected} corners"),
        };
        format!("Detection({sheet}, {corners})")
    }
}

/// Notes and warnings as sentences. A pickle keeps them as notes.
fn with_warnings(notes: &[String], warnings: &[Warning]) -> Vec<String> {
    let warned = warnings.iter().map(|w| format!("{}; {}", w.message, w.advice));
    notes.iter().cloned().chain(warned).collect()
}
