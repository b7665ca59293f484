//! What a camera wrote into a photograph.

use pyo3::prelude::*;
use pyo3::types::PyString;
use slcal_cli::files::InputKind;
use slcal_core::{FocalSource, Orientation};

use crate::errors::{self, Raise as _, Stage};
use crate::files;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PhotoTags>()?;
    module.add_function(wrap_pyfunction!(read_tags, module)?)
}

/// What a camera wrote into a photograph (EXIF), for `calibrate`. Nothing is checked: programs that edit photographs leave
/// tags that are no longer true.
///
/// Parameters
/// ----------
/// make, model : str, optional
///     The camera.
/// focal_mm : float, optional
///     FocalLength: the lens's own focal length, mm.
/// focal_35mm : float, optional
///     FocalLengthIn35mmFilm, mm.
/// focal_plane_x_resolution : float, optional
///     FocalPlaneXResolution: pixels of the whole picture per unit.
/// focal_plane_unit : int, optional
///     FocalPlaneResolutionUnit: 2 inches (default), 3 centimetres, 4 millimetres, 5 micrometres.
/// pixels : (int, int), optional
///     PixelXDimension and PixelYDimension: the size of the picture as the camera stored it.
/// digital_zoom : float, optional
///     DigitalZoomRatio; 0 and 1 stand for none.
/// orientation : int
///     Orientation, 1 to 8, by which the pixels were turned upright.
///
/// Examples
/// --------
/// >>> tags = slcal.PhotoTags(model="Canon PowerShot G10", focal_mm=6.1)
/// >>> tags.focal((4416, 3312))["source"]
/// 'sensor-table'
#[pyclass(frozen, module = "slcal", eq)]
#[derive(PartialEq, Clone)]
pub(crate) struct PhotoTags(pub(crate) slcal_core::PhotoTags);

type State = (
    (Option<String>, Option<String>),
    (Option<f64>, Option<f64>, Option<f64>, Option<u16>),
    Option<(u32, u32)>,
    (Option<f64>, u16),
);

#[pymethods]
impl PhotoTags {
    #[new]
    #[pyo3(signature = (*, make=None, model=None, focal_mm=None, focal_35mm=None, focal_plane_x_resolution=None, focal_plane_unit=None,
        pixels=None, digital_zoom=None, orientation=1))]
    #[allow(clippy::too_many_arguments, reason = "keyword arguments")]
    fn new(
        make: Option<String>,
        model: Option<String>,
        focal_mm: Option<f64>,
        focal_35mm: Option<f64>,
        focal_plane_x_resolution: Option<f64>,
        focal_plane_unit: Option<u16>,
        pixels: Option<(u32, u32)>,
        digital_zoom: Option<f64>,
        orientation: u16,
    ) -> Self {
        let mut tags = slcal_core::PhotoTags::default();
        tags.make = make;
        tags.model = model;
        tags.focal_mm = focal_mm;
        tags.focal_35mm = focal_35mm;
        tags.focal_plane_x_resolution = focal_plane_x_resolution;
        tags.focal_plane_unit = focal_plane_unit;
        tags.pixels = pixels.map(|(w, h)| [w, h]);
        tags.digital_zoom = digital_zoom;
        tags.orientation = Orientation::of_tag(orientation);
        Self(tags)
    }

    /// The maker of the camera.
    #[getter]
    fn make(&self) -> Option<&str> {
        self.0.make.as_deref()
    }

    /// The camera.
    #[getter]
    fn model(&self) -> Option<&str> {
        self.0.model.as_deref()
    }

    /// The lens's own focal length, mm.
    #[getter]
    fn focal_mm(&self) -> Option<f64> {
        self.0.focal_mm
    }

    /// Its equivalent on 35 mm film, mm.
    #[getter]
    fn focal_35mm(&self) -> Option<f64> {
        self.0.focal_35mm
    }

    /// Pixels of the whole picture per unit of the focal plane.
    #[getter]
    fn focal_plane_x_resolution(&self) -> Option<f64> {
        self.0.focal_plane_x_resolution
    }

    /// That unit: 2 inches, 3 centimetres, 4 millimetres, 5 micrometres.
    #[getter]
    fn focal_plane_unit(&self) -> Option<u16> {
        self.0.focal_plane_unit
    }

    /// Width and height of the picture as the camera stored it.
    #[getter]
    fn pixels(&self) -> Option<(u32, u32)> {
        self.0.pixels.map(|[w, h]| (w, h))
    }

    /// The digital zoom; 0 and 1 stand for none.
    #[getter]
    fn digital_zoom(&self) -> Option<f64> {
        self.0.digital_zoom
    }

    /// How the pixels were turned upright, 1 to 8.
    #[getter]
    fn orientation(&self) -> u16 {
        self.0.orientation.tag()
    }

    /// The focal length that the tags state for an uncropped photograph.
    ///
    /// Parameters
    /// ----------
    /// size : (int, int)
    ///     Width and height of the photograph, px.
    ///
    /// Returns
    /// -------
    /// dict
    ///     "focal_px"; "sigma_share", its relative 1σ; "mm", the focal length of the tag that was used; "source":
    ///     "equivalent", "focal-plane" or "sensor-table".
    ///
    /// Raises
    /// ------
    /// Error
    ///     When the tags state none that is plausible, or the photograph was cropped or zoomed digitally.
    fn focal<'py>(&self, py: Python<'py>, size: (u32, u32)) -> PyResult<Bound<'py, pyo3::types::PyDict>> {
        let found = self.0.focal([size.0, size.1]).raise(py, Stage::Detect)?;
        let source = match found.source {
            FocalSource::Equivalent => "equivalent",
            FocalSource::FocalPlane { .. } => "focal-plane",
            _ => "sensor-table",
        };
        let dict = pyo3::types::PyDict::new(py);
        dict.set_item("focal_px", found.prior.focal_px)?;
        dict.set_item("sigma_share", found.prior.sigma_share)?;
        dict.set_item("mm", found.mm)?;
        dict.set_item("source", source)?;
        Ok(dict)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, State)> {
        let t = &self.0;
        let state = (
            (t.make.clone(), t.model.clone()),
            (t.focal_mm, t.focal_35mm, t.focal_plane_x_resolution, t.focal_plane_unit),
            t.pixels.map(|[w, h]| (w, h)),
            (t.digital_zoom, t.orientation.tag()),
        );
        Ok((py.get_type::<Self>().getattr("_restored")?, state))
    }

    #[staticmethod]
    fn _restored(
        camera: (Option<String>, Option<String>),
        focal: (Option<f64>, Option<f64>, Option<f64>, Option<u16>),
        pixels: Option<(u32, u32)>,
        rest: (Option<f64>, u16),
    ) -> Self {
        let ((make, model), (mm, equivalent, resolution, unit), (zoom, orientation)) = (camera, focal, rest);
        Self::new(make, model, mm, equivalent, resolution, unit, pixels, zoom, orientation)
    }

    fn __repr__(&self) -> String {
        let t = &self.0;
        let texts = [("make", &t.make), ("model", &t.model)];
        let texts = texts.into_iter().filter_map(|(name, v)| v.as_ref().map(|v| format!("{name}={v:?}")));
        let numbers = [
            ("focal_mm", t.focal_mm),
            ("focal_35mm", t.focal_35mm),
            ("focal_plane_x_resolution", t.focal_plane_x_resolution),
            ("focal_plane_unit", t.focal_plane_unit.map(f64::from)),
            ("digital_zoom", t.digital_zoom),
        ];
        let numbers = numbers.into_iter().filter_map(|(name, v)| v.map(|v| format!("{name}={v}")));
        let pixels = t.pixels.map(|[w, h]| format!("pixels=({w}, {h})"));
        let all = texts.chain(numbers).chain(pixels).chain([format!("orientation={}", t.orientation.tag())]);
        format!("PhotoTags({})", all.collect::<Vec<_>>().join(", "))
    }
}

/// Reads the EXIF tags of a photograph, for `calibrate(tags=...)`.
///
/// Parameters
/// ----------
/// file : path or binary file object
///     The photograph: JPEG, PNG, TIFF, WebP or HEIC.
///
/// Returns
/// -------
/// PhotoTags or None
///     None where it has no tags that can be read.
///
/// Raises
/// ------
/// OSError
///     When the file cannot be read.
#[pyfunction]
fn read_tags(file: &Bound<'_, PyAny>) -> PyResult<Option<PhotoTags>> {
    let files::Contents { bytes, .. } = files::read(file, InputKind::Photo)?;
    Ok(file.py().detach(|| slcal_cli::files::read_tags(&bytes)).map(PhotoTags))
}

/// One of each photograph, or None: the argument `tags`.
pub(crate) fn tags_of(given: &Bound<'_, PyAny>) -> PyResult<Vec<Option<slcal_core::PhotoTags>>> {
    let wrong = || {
        let found = given.get_type().name().map_or_else(|_| "another object".to_owned(), |n| n.to_string());
        errors::wrong_type("tags", "a sequence of PhotoTags or None, one for each photograph", &found)
    };
    if given.cast::<PyString>().is_ok() {
        return Err(wrong());
    }
    let items = given.try_iter().map_err(|_| wrong())?;
    items
        .map(|item| {
            let item = item?;
            if item.is_none() {
                return Ok(None);
            }
            item.cast::<PhotoTags>().map(|tags| Some(tags.get().0.clone())).map_err(|_| wrong())
        })
        .collect()
}
