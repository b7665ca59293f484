//! A simulated scene.

use pyo3::prelude::*;
use slcal_core::pattern::Pattern;
use slcal_core::simulate::SimulatedScene;

use crate::cloud::PointCloud;
use crate::convert::array::shaped;
use crate::convert::image::array_of;
use crate::convert::report::LazyReport;
use crate::errors;
use crate::matches::Matches;
use crate::pattern::{CheckerPattern, StripePattern};
use crate::rig::Rig;

/// Photographs of a simulated scene, and the ground truth of every pixel. `slcal.simulate.scene` makes them.
///
/// Examples
/// --------
/// >>> from slcal import simulate
/// >>> scene = simulate.scene("sphere", camera=(320, 240), focal=375)
/// >>> scene
/// Scene(320x240, 2 surfaces, 10134 matches)
/// >>> scene.photo.shape, scene.depth.shape
/// ((240, 320, 3), (240, 320))
#[pyclass(frozen, module = "slcal")]
pub(crate) struct Scene {
    pub(super) scene: SimulatedScene,
    pub(super) report: LazyReport,
}

impl Scene {
    fn map<'py, T: numpy::Element>(&self, py: Python<'py>, values: Vec<T>) -> PyResult<Bound<'py, PyAny>> {
        let truth = self.scene.photographer.truth();
        shaped(py, values, &[truth.height(), truth.width()])
    }
}

#[pymethods]
impl Scene {
    /// The true rig. If it was simulated and the surface is a sheet, the sheet is its view.
    #[getter]
    fn rig(&self) -> Rig {
        self.scene.rig.clone().into()
    }

    /// What was projected.
    #[getter]
    fn pattern<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(match self.scene.pattern.clone() {
            Pattern::Checker(p) => Bound::new(py, CheckerPattern(p))?.into_any(),
            Pattern::Stripes(p) => Bound::new(py, StripePattern(p))?.into_any(),
            Pattern::Sequence(_) => {
                return Err(errors::invalid(py, "pattern", "a checkerboard or stripes", "a sequence"));
            }
        })
    }

    /// The photograph under the pattern: (H, W, 3) uint8, or uint16 with 16 bits.
    #[getter]
    fn photo<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array_of(py, self.scene.photo.clone())
    }

    /// The photograph under a white projector.
    #[getter]
    fn white<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array_of(py, self.scene.white.clone())
    }

    /// The photograph under a dark projector.
    #[getter]
    fn black<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array_of(py, self.scene.black.clone())
    }

    /// The true positions of slits or corners of the pattern in the photograph.
    #[getter]
    fn matches(&self) -> Matches {
        self.scene.matches.clone().into()
    }

    /// The true points of the matches, in the camera's frame.
    #[getter]
    fn cloud(&self) -> PointCloud {
        self.scene.cloud().into()
    }

    /// The projector column that illuminates each pixel: (H, W) float32, px; NaN in shadow and outside the projector's
    /// footprint.
    #[getter]
    fn column<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.map(py, self.scene.columns())
    }

    /// The projector row that illuminates each pixel: (H, W) float32, px; NaN in shadow and outside the projector's
    /// footprint.
    #[getter]
    fn row<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.map(py, self.scene.rows())
    }

    /// Depth of each pixel along the camera's axis: (H, W) float32, mm; NaN where there is no surface.
    #[getter]
    fn depth<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.map(py, self.scene.depths())
    }

    /// Number of the surface in each pixel: (H, W) uint8, counted from 1; 0 for none.
    #[getter]
    fn surface<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.map(py, self.scene.surfaces())
    }

    /// Counts and depths of the scene.
    #[getter]
    fn report(&self, py: Python<'_>) -> PyResult<Option<Py<PyAny>>> {
        self.report.get(py)
    }

    fn __repr__(&self) -> String {
        let (truth, surfaces) = (self.scene.photographer.truth(), self.scene.photographer.surfaces().len());
        format!(
            "Scene({}x{}, {surfaces} surface{}, {} matches)",
            truth.width(),
            truth.height(),
            if surfaces == 1 { "" } else { "s" },
            self.scene.matches.items.len()
        )
    }
}
