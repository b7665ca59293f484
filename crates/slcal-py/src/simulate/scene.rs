//! A simulated scene.

use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use slcal_core::pattern::Pattern;
use slcal_core::simulate::SimulatedScene;

use crate::cloud::PointCloud;
use crate::convert::array::shaped;
use crate::convert::image::array_of;
use crate::convert::report::LazyReport;
use crate::errors::{Raise as _, Stage};
use crate::matches::Matches;
use crate::pattern::{CheckerPattern, SequencePattern, StripePattern};
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
            Pattern::Sequence(p) => Bound::new(py, SequencePattern(p))?.into_any(),
        })
    }

    /// The photograph under the pattern: (H, W, 3) uint8, or uint16 with 16 bits. Of a sequence, that under a white projector.
    #[getter]
    fn photo<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array_of(py, self.scene.photo.clone())
    }

    /// The photographs under the pictures of a sequence, in its order; none of other patterns.
    #[getter]
    fn frames(slf: Bound<'_, Self>) -> SceneFrames {
        SceneFrames(slf.unbind())
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

    /// The true positions of slits or corners of the pattern in the photograph; none of a sequence, for which `column` and `row` are
    /// the truth.
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

/// The photographs of a scene under the pictures of a sequence. Each is rendered when it is asked for, so that memory holds those that are
/// kept; asked for again, it is the same.
///
/// Examples
/// --------
/// >>> from slcal import simulate
/// >>> sequence = slcal.SequencePattern(projector=(1024, 768), bits=3)
/// >>> scene = simulate.scene("sphere", sequence, camera=(320, 240), focal=375)
/// >>> len(scene.frames), scene.frames[0].shape
/// (8, (240, 320, 3))
/// >>> stack = [frame.mean(axis=2) for frame in scene.frames]
#[pyclass(frozen, module = "slcal")]
pub(crate) struct SceneFrames(Py<Scene>);

#[pymethods]
impl SceneFrames {
    fn __len__(&self) -> usize {
        self.0.get().scene.frame_count()
    }

    fn __getitem__<'py>(&self, py: Python<'py>, index: isize) -> PyResult<Bound<'py, PyAny>> {
        let scene = &self.0.get().scene;
        let n = scene.frame_count();
        let from_start = if index < 0 { n.checked_add_signed(index) } else { Some(index.unsigned_abs()) };
        let frame = from_start.filter(|i| *i < n).ok_or_else(|| {
            PyIndexError::new_err(format!("frames: expected an index below {n}, found {index}"))
        })?;
        let exposure = py.detach(|| scene.frame(frame)).raise(py, Stage::Detect)?;
        array_of(py, exposure.picture)
    }

    fn __iter__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let builtins = slf.py().import("builtins")?;
        let indices = builtins.call_method1("range", (slf.len()?,))?;
        builtins.call_method1("map", (slf.getattr("__getitem__")?, indices))
    }

    fn __repr__(&self) -> String {
        format!("SceneFrames({})", self.__len__())
    }
}
