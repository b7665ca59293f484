//! What photographs show, as calibration takes it: from the detector here or from any other.

mod mapping;

use std::path::Path;

use pyo3::prelude::*;
use pyo3::types::PyMapping;
use serde_json::Value;
use slcal_cli::files::InputKind;
use slcal_core::format::{read_observations, write_observations};

use crate::convert::object::{self, Argument};
use crate::convert::option::whole_pair;
use crate::detect::Detection;
use crate::errors::{Raise as _, Stage, raised_from};
use crate::files;
use crate::view_observation::ViewObservation;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Observations>()
}

/// The input of a calibration.
///
/// Parameters
/// ----------
/// camera : (int, int)
///     Width and height of the camera's image, px.
/// projector : (int, int) or None
///     Width and height of the projector's panel, px; None to calibrate the camera alone.
/// views : iterable of ViewObservation or Detection
///     One for each pose of the sheet.
/// mirrored : bool, default False
///     Whether the projector's pictures appear mirrored. The projector px of the views are then those of the panel, as
///     `pattern.mirrored()` has them.
///
/// Raises
/// ------
/// Error
///     When a size is not two whole numbers above zero.
/// TypeError
///     When a view is not one of these.
///
/// Examples
/// --------
/// >>> corners = [[100, 90], [1100, 110], [1050, 800], [80, 780]]
/// >>> view = slcal.ViewObservation((594, 420), sheet_corners=corners)
/// >>> seen = slcal.Observations((1280, 960), None, [view])
/// >>> seen
/// Observations(camera=(1280, 960), projector=None, views=1, pairs=0)
/// >>> slcal.Observations.from_json(seen.to_json()) == seen
/// True
#[pyclass(frozen, module = "slcal", eq)]
#[derive(PartialEq)]
pub(crate) struct Observations(pub(crate) slcal_core::Observations);

impl Argument for Observations {
    const EXPECTED: &'static str = "Observations or a mapping like their JSON file";
    const OF_ARRAY: &'static str = "slcal.observe(photos, size_mm, pattern)";
    const OF_OTHER: &'static str =
        "slcal.observe(photos, size_mm, pattern), or slcal.Observations(camera, projector, views)";

    fn of_path(path: &Path) -> String {
        object::load("Observations", path)
    }
}

#[pymethods]
impl Observations {
    #[new]
    #[pyo3(signature = (camera, projector, views, *, mirrored=false))]
    fn new(
        camera: &Bound<'_, PyAny>,
        projector: Option<&Bound<'_, PyAny>>,
        views: &Bound<'_, PyAny>,
        mirrored: bool,
    ) -> PyResult<Self> {
        const WANTED: &str = "ViewObservation or Detection objects in a list, one for each pose";
        let mut observations = slcal_core::Observations {
            camera: whole_pair(camera, "camera")?,
            projector: projector.map(|p| whole_pair(p, "projector")).transpose()?,
            mirrored,
            views: Vec::new(),
        };
        let items = match views.try_iter() {
            Ok(items) if files::path_of(views)?.is_none() => items,
            _ => return Err(object::refused::<ViewObservation>(views, "views", WANTED)),
        };
        for (i, item) in items.enumerate() {
            let item = item?;
            observations.views.push(if let Ok(view) = item.cast::<ViewObservation>() {
                view.get().0.clone()
            } else if let Ok(detection) = item.cast::<Detection>() {
                detection.get().0.observation.clone()
            } else {
                return Err(object::refused::<ViewObservation>(&item, &format!("views[{i}]"), WANTED));
            });
        }
        Ok(Self(observations))
    }

    /// Width and height of the camera's image, px.
    #[getter]
    fn camera(&self) -> (u32, u32) {
        self.0.camera.into()
    }

    /// Width and height of the projector's panel, px; None for the camera alone.
    #[getter]
    fn projector(&self) -> Option<(u32, u32)> {
        self.0.projector.map(Into::into)
    }

    /// Whether the projector's pictures appear mirrored: see `Rig.mirrored`.
    #[getter]
    fn mirrored(&self) -> bool {
        self.0.mirrored
    }

    /// One for each pose of the sheet.
    #[getter]
    fn views(&self) -> Vec<ViewObservation> {
        self.0.views.iter().cloned().map(ViewObservation).collect()
    }

    /// Writes the file (schema slcal-observations/1), which ``slcal calibrate --observations`` reads.
    ///
    /// Parameters
    /// ----------
    /// file : path or file object
    ///     A path, where the file appears when it is complete and replaces an older one, or an object with write().
    fn save(&self, file: &Bound<'_, PyAny>) -> PyResult<()> {
        files::write(file, &self.json(file.py())?, true)
    }

    /// Reads a file of observations.
    ///
    /// Parameters
    /// ----------
    /// file : path or file object
    ///     The JSON file (schema slcal-observations/1).
    ///
    /// Returns
    /// -------
    /// Observations
    ///
    /// Raises
    /// ------
    /// OSError
    ///     When the file cannot be read.
    /// FormatError
    ///     When it does not follow its schema; the message names the view, the field and the point.
    #[staticmethod]
    fn load(file: &Bound<'_, PyAny>) -> PyResult<Self> {
        let contents = files::read(file, InputKind::Observations)?;
        let name = contents.name.as_deref();
        read_observations(contents.bytes.as_slice())
            .map(Self)
            .map_err(|e| raised_from(file.py(), &e, Stage::Detect, name))
    }

    /// The content of the file.
    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        files::text_of(self.json(py)?)
    }

    /// The observations that `to_json` wrote.
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> PyResult<Self> {
        read_observations(text.as_bytes()).map(Self).raise(py, Stage::Detect)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((py.get_type::<Self>().getattr("from_json")?, (self.to_json(py)?,)))
    }

    fn __len__(&self) -> usize {
        self.0.views.len()
    }

    fn __repr__(&self) -> String {
        let o = &self.0;
        let pairs: usize = o.views.iter().map(|v| v.pairs.len()).sum();
        let projector = o.projector.map_or("None".to_owned(), |[w, h]| format!("({w}, {h})"));
        let ([w, h], n) = (o.camera, o.views.len());
        format!("Observations(camera=({w}, {h}), projector={projector}, views={n}, pairs={pairs})")
    }
}

impl Observations {
    fn json(&self, py: Python<'_>) -> PyResult<Vec<u8>> {
        let mut bytes = Vec::new();
        write_observations(&self.0, &mut bytes).raise(py, Stage::Detect)?;
        Ok(bytes)
    }
}

/// Observations, or a mapping in the shape of their file whose leaves may be arrays; it may leave out its schema.
pub(crate) fn observations_of(value: &Bound<'_, PyAny>) -> PyResult<slcal_core::Observations> {
    let py = value.py();
    if let Ok(observations) = value.cast::<Observations>() {
        return Ok(observations.get().0.clone());
    }
    if value.cast::<PyMapping>().is_err() {
        return Err(object::refused::<Observations>(value, "observations", Observations::EXPECTED));
    }
    let mut json = mapping::json_of(value)?;
    if let Value::Object(fields) = &mut json {
        fields.entry("schema").or_insert_with(|| "slcal-observations/1".into());
    }
    read_observations(json.to_string().as_bytes()).raise(py, Stage::Detect)
}
