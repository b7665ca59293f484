//! Rig + picture → what to project so that it appears upright on the sheet.

use image::{DynamicImage, ImageBuffer, RgbImage};
use nalgebra::{Matrix3, Point2};
use numpy::{PyUntypedArray, PyUntypedArrayMethods as _};
use pyo3::prelude::*;
use slcal_core::geometry::RectangleSize;
use slcal_core::{
    Device, ErrorSubject, Rig as CoreRig, rectify, rectify_checker, rectify_checker_picture, rectify_picture,
};

use crate::convert::array::{rows, rows_of, shaped};
use crate::convert::image::Photo;
use crate::convert::object::refused;
use crate::errors::{self, Raise as _, Stage};
use crate::geometry::Camera;
use crate::pattern::CheckerPattern;
use crate::rig::Rig;

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Rectification>()
}

/// What is to appear upright.
enum Source {
    Checker(slcal_core::pattern::CheckerPattern),
    Picture(RgbImage),
}

impl Source {
    fn of(source: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(checker) = source.cast::<CheckerPattern>() {
            return Ok(Self::Checker(checker.get().0.clone()));
        }
        if source.cast::<PyUntypedArray>().is_err() {
            let wanted = "a CheckerPattern, or an array of uint8 or uint16 with shape (H, W, 3) or (H, W)";
            return Err(refused::<CheckerPattern>(source, "source", wanted));
        }
        picture(&Photo::of(source, "source")?).map(Self::Picture).ok_or_else(|| {
            errors::invalid(
                source.py(),
                "source",
                "a picture of at most 2³² pixels on a side",
                "a larger one",
            )
        })
    }
}

/// A copy of it, as the core draws with.
fn picture(photo: &Photo<'_>) -> Option<RgbImage> {
    fn buffer<P: image::Pixel>(
        shape: &[usize],
        samples: Vec<P::Subpixel>,
    ) -> Option<ImageBuffer<P, Vec<P::Subpixel>>> {
        let [h, w] = [shape[0], shape[1]].map(|n| u32::try_from(n).ok());
        ImageBuffer::from_raw(w?, h?, samples)
    }
    let dynamic = match photo {
        Photo::Bytes(array) => {
            let samples = array.as_array().iter().copied().collect();
            match array.shape() {
                shape @ [_, _] => DynamicImage::ImageLuma8(buffer(shape, samples)?),
                shape => DynamicImage::ImageRgb8(buffer(shape, samples)?),
            }
        }
        Photo::Words(array) => {
            let samples = array.as_array().iter().copied().collect();
            match array.shape() {
                shape @ [_, _] => DynamicImage::ImageLuma16(buffer(shape, samples)?),
                shape => DynamicImage::ImageRgb16(buffer(shape, samples)?),
            }
        }
    };
    Some(dynamic.into_rgb8())
}

fn view_index(py: Python<'_>, view: i64, rig: &CoreRig) -> PyResult<usize> {
    let n = rig.views.len();
    usize::try_from(view).ok().filter(|i| *i < n).ok_or_else(|| {
        let found = if n == 0 { "a rig without views".to_owned() } else { format!("{view} of {n}") };
        errors::invalid(py, "view", "the number of a view of the rig, from 0", &found)
    })
}

/// See `Rig.rectify`.
fn drawn<'py>(rig: &CoreRig, source: &Bound<'py, PyAny>, view: i64) -> PyResult<Bound<'py, PyAny>> {
    let py = source.py();
    let (source, view) = (Source::of(source)?, view_index(py, view, rig)?);
    let draw = || match &source {
        Source::Checker(pattern) => rectify_checker_picture(rig, view, pattern),
        Source::Picture(picture) => rectify_picture(rig, view, picture),
    };
    let picture = py.detach(draw).raise(py, Stage::Detect)?.0;
    let shape = [picture.height() as usize, picture.width() as usize, 3];
    shaped(py, picture.into_raw(), &shape)
}

/// See `Rig.rectification`.
fn place(rig: &CoreRig, source: &Bound<'_, PyAny>, view: i64) -> PyResult<Rectification> {
    let py = source.py();
    let (source, view) = (Source::of(source)?, view_index(py, view, rig)?);
    let place = || match &source {
        Source::Checker(pattern) => {
            rig.projector_for(ErrorSubject::Checkerboard, pattern.projector)?;
            rectify_checker(rig, view, pattern)
        }
        Source::Picture(picture) => {
            let [w, h] = [picture.width(), picture.height()].map(|n| f64::from(n) - 0.5);
            rectify(rig, view, Point2::new(-0.5, -0.5), Point2::new(w, h))
        }
    };
    py.detach(place).map(Rectification).raise(py, Stage::Detect)
}

/// The position of a picture on the projector's panel and on the sheet, where it appears without keystone distortion.
#[pyclass(frozen, module = "slcal", eq)]
#[derive(PartialEq)]
pub(crate) struct Rectification(slcal_core::Rectification);

/// Matrix, lens, corners on the panel, origin and size on the sheet.
type State = ([[f64; 3]; 3], Option<Camera>, [[f64; 2]; 4], [f64; 2], [f64; 2]);

#[pymethods]
impl Rectification {
    /// (3, 3) float64: the homography from pixels of the source to pixels of the panel, without lens distortion; `map`
    /// includes the distortion.
    #[getter]
    fn panel_from_source<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let m = self.0.homography();
        rows(py, m.row_iter().map(|r| [r[0], r[1], r[2]]))
    }

    /// Corners TL, TR, BR, BL of the picture on the panel: (4, 2) float64, px.
    #[getter]
    fn corners_px<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        rows(py, self.0.corners_px.iter().map(|c| [c.x, c.y]))
    }

    /// Width and height of the picture on the sheet, mm.
    #[getter]
    fn size_mm(&self) -> (f64, f64) {
        (self.0.size_mm.width_mm, self.0.size_mm.height_mm)
    }

    /// Its top-left corner on the sheet, mm from the sheet's own.
    #[getter]
    fn origin_mm(&self) -> (f64, f64) {
        (self.0.origin_mm.x, self.0.origin_mm.y)
    }

    /// Pixels of the panel that show pixels of the source.
    ///
    /// Parameters
    /// ----------
    /// pixels : array_like
    ///     (N, 2), px of the source.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     (N, 2) float64, px of the panel.
    ///
    /// Raises
    /// ------
    /// Error
    ///     When a point lies at infinity on the panel.
    fn map<'py>(&self, pixels: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = pixels.py();
        let mapped = rows_of::<2>(pixels, "pixels")?.into_iter().enumerate().map(|(i, p)| {
            self.0.map(Point2::from(p)).map(|q| [q.x, q.y]).ok_or_else(|| {
                let found = format!("[{}, {}] in row {i}", p[0], p[1]);
                errors::invalid(py, "pixels", "pixels that the panel can show", &found)
            })
        });
        rows(py, mapped.collect::<PyResult<Vec<_>>>()?.into_iter())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, State)> {
        let m = self.0.homography();
        let state = (
            [0, 1, 2].map(|i| [m[(i, 0)], m[(i, 1)], m[(i, 2)]]),
            self.0.lens().map(|&model| Camera(Device { model, sigma: None })),
            self.0.corners_px.map(|c| [c.x, c.y]),
            self.origin_mm().into(),
            self.size_mm().into(),
        );
        Ok((py.get_type::<Self>().getattr("_restored")?, state))
    }

    #[staticmethod]
    fn _restored(
        m: [[f64; 3]; 3],
        lens: Option<&Camera>,
        corners: [[f64; 2]; 4],
        origin: [f64; 2],
        size: [f64; 2],
    ) -> Self {
        Self(slcal_core::Rectification::new(
            Matrix3::from_fn(|i, j| m[i][j]),
            lens.map(|c| c.0.model),
            corners.map(Point2::from),
            origin.into(),
            RectangleSize { width_mm: size[0], height_mm: size[1] },
        ))
    }

    fn __repr__(&self) -> String {
        let (size, origin) = (self.0.size_mm, self.0.origin_mm);
        format!(
            "Rectification({:.1} x {:.1} mm, {:.1} mm from the sheet's left and {:.1} mm from its top)",
            // Without the sign of a zero.
            size.width_mm,
            size.height_mm,
            (10.0 * origin.x).round() / 10.0 + 0.0,
            (10.0 * origin.y).round() / 10.0 + 0.0
        )
    }
}

#[pymethods]
impl Rig {
    /// Returns the picture to project so that `source` appears without keystone distortion and as large as possible on the
    /// sheet.
    ///
    /// Parameters
    /// ----------
    /// source : CheckerPattern or ndarray
    ///     A checkerboard, drawn with sharp edges and half a square of its background around it, or any picture: (H, W, 3)
    ///     RGB or (H, W), uint8 (uint16 is brought to 8 bits).
    /// view : int, default 0
    ///     Which of the rig's views has the pose of the sheet.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     (H, W, 3) uint8, as large as the projector's panel.
    ///
    /// Raises
    /// ------
    /// Error
    ///     When the rig has no projector or no such view, or the pattern is for another panel.
    /// CalibrationError
    ///     When the projector does not light the sheet.
    /// TypeError
    ///     When the source is not one of these.
    #[pyo3(signature = (source, *, view=0))]
    fn rectify<'py>(&self, source: &Bound<'py, PyAny>, view: i64) -> PyResult<Bound<'py, PyAny>> {
        drawn(&self.rig, source, view)
    }

    /// The position of the picture that `rectify` draws: on the panel, and on the sheet in millimetres.
    ///
    /// Parameters
    /// ----------
    /// source : CheckerPattern or ndarray
    ///     As for `rectify`.
    /// view : int, default 0
    ///     As for `rectify`.
    ///
    /// Returns
    /// -------
    /// Rectification
    #[pyo3(signature = (source, *, view=0))]
    fn rectification(&self, source: &Bound<'_, PyAny>, view: i64) -> PyResult<Rectification> {
        place(&self.rig, source, view)
    }
}
