//! Photographs: arrays of uint8 or uint16, read where they lie.

use std::borrow::Cow;

use numpy::ndarray::{ArrayViewD, Axis};
use numpy::{
    Element, PyArrayDyn, PyArrayMethods as _, PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods as _,
};
use pyo3::prelude::*;
use slcal_core::photo::{Layout, PhotoView, Samples};

use crate::errors::{self, Raise as _, Stage};
use crate::files;

/// An array that is a photograph.
pub(crate) enum Photo<'py> {
    Bytes(PyReadonlyArrayDyn<'py, u8>),
    Words(PyReadonlyArrayDyn<'py, u16>),
}

/// Its samples: those of the array itself wherever rows follow each other, be it in RGB or in BGR order. Parts cut out of
/// larger pictures, and pictures that are upside down in memory, are copied.
pub(crate) enum Pixels<'a> {
    Bytes(Stored<'a, u8>),
    Words(Stored<'a, u16>),
}

pub(crate) struct Stored<'a, T: Clone> {
    samples: Cow<'a, [T]>,
    height: usize,
    width: usize,
    layout: Layout,
}

impl<'py> Photo<'py> {
    /// Checks that `array` has the shape (H, W, 3) or (H, W) and the dtype uint8 or uint16; it is called `what` in messages.
    pub(crate) fn of(array: &Bound<'py, PyAny>, what: &str) -> PyResult<Self> {
        const WANTED: &str = "an array of uint8 or uint16 with shape (H, W, 3), RGB, or (H, W)";
        let py = array.py();
        let Ok(untyped) = array.cast::<PyUntypedArray>() else {
            return Err(errors::wrong_type(what, WANTED, &described(array)?));
        };
        let photo = if let Ok(bytes) = array.cast::<PyArrayDyn<u8>>() {
            Self::Bytes(bytes.readonly())
        } else if let Ok(words) = array.cast::<PyArrayDyn<u16>>() {
            Self::Words(words.readonly())
        } else {
            let dtype = untyped.dtype().to_string();
            return Err(errors::wrong_type(
                what,
                WANTED,
                &format!("dtype {dtype}{}", advice_on_dtype(&dtype)),
            ));
        };
        let shape = untyped.shape();
        if let [_, _] | [_, _, 3] = shape {
            return Ok(photo);
        }
        let advice = match shape {
            [_, _, 4] => "; leave the alpha channel out: image[..., :3]",
            [_, _, 1] => "; take the channel: image[..., 0]",
            [3, _, _] => "; put the channels last: image.transpose(1, 2, 0)",
            [_, _, _, _] => "; give one photograph at a time",
            _ => "",
        };
        let shown = super::array::shape_in_words(shape);
        Err(errors::invalid(py, what, "shape (H, W, 3) or (H, W)", &format!("shape {shown}{advice}")))
    }

    /// The samples, borrowed where that is possible.
    pub(crate) fn pixels(&self) -> Pixels<'_> {
        match self {
            Self::Bytes(array) => Pixels::Bytes(stored(array.as_array())),
            Self::Words(array) => Pixels::Words(stored(array.as_array())),
        }
    }

    /// The samples where they lie; `None` where they would have to be copied.
    pub(crate) fn borrowed(&self) -> Option<Pixels<'_>> {
        Some(match self {
            Self::Bytes(array) => Pixels::Bytes(borrowed(array.as_array())?),
            Self::Words(array) => Pixels::Words(borrowed(array.as_array())?),
        })
    }
}

/// Several photographs, or one.
pub(crate) fn photos_of<'py>(photos: &Bound<'py, PyAny>, what: &str) -> PyResult<Vec<Photo<'py>>> {
    if let Ok(array) = photos.cast::<PyUntypedArray>()
        && array.ndim() < 4
    {
        return Ok(vec![Photo::of(photos, what)?]);
    }
    let items = match photos.try_iter() {
        Ok(items) if files::path_of(photos)?.is_none() => items,
        _ => return Err(errors::wrong_type(what, "a sequence of images", &described(photos)?)),
    };
    items.enumerate().map(|(i, photo)| Photo::of(&photo?, &format!("{what}[{i}]"))).collect()
}

fn described(object: &Bound<'_, PyAny>) -> PyResult<String> {
    let name = object.get_type().name()?.to_string();
    Ok(if object.is_none() {
        "None (cv2.imread returns None for a file that it cannot read)".to_owned()
    } else if files::path_of(object).is_ok_and(|p| p.is_some()) {
        format!("{name}; read the file first: slcal.read_image(path)")
    } else if name == "Scene" {
        "a Scene; its photograph is scene.photo".to_owned()
    } else {
        format!("{name}; make it an array first: np.asarray(image)")
    })
}

fn advice_on_dtype(dtype: &str) -> &'static str {
    if dtype.starts_with("float") {
        "; scale it and round: (image * 255).round().astype(np.uint8) for values from 0 to 1"
    } else if dtype == "bool" || dtype.starts_with("int") || dtype.starts_with("uint") {
        "; convert it: image.astype(np.uint8) for values from 0 to 255"
    } else if dtype.starts_with('>') {
        "; bring its bytes into this machine's order: image.astype(np.uint16)"
    } else {
        ""
    }
}

fn borrowed<T: Element + Copy>(mut view: ArrayViewD<'_, T>) -> Option<Stored<'_, T>> {
    let (height, width) = (view.shape()[0], view.shape()[1]);
    let color = view.ndim() == 3;
    let layout = if color { Layout::Rgb } else { Layout::Grey };
    if let Some(samples) = view.to_slice() {
        return Some(Stored { samples: samples.into(), height, width, layout });
    }
    if !color {
        return None;
    }
    // What image[..., ::-1] makes of OpenCV's order.
    view.invert_axis(Axis(2));
    let samples = view.to_slice()?;
    Some(Stored { samples: samples.into(), height, width, layout: Layout::Bgr })
}

fn stored<T: Element + Copy>(view: ArrayViewD<'_, T>) -> Stored<'_, T> {
    borrowed(view.clone()).unwrap_or_else(|| {
        let layout = if view.ndim() == 3 { Layout::Rgb } else { Layout::Grey };
        let (height, width) = (view.shape()[0], view.shape()[1]);
        Stored { samples: view.iter().copied().collect(), height, width, layout }
    })
}

impl Pixels<'_> {
    /// The photograph as the core takes it.
    pub(crate) fn view(&self, py: Python<'_>) -> PyResult<PhotoView<'_>> {
        self.in_layout(py, |layout| layout)
    }

    /// The same with red for blue and blue for red.
    pub(crate) fn swapped(&self, py: Python<'_>) -> PyResult<PhotoView<'_>> {
        self.in_layout(py, |layout| match layout {
            Layout::Rgb => Layout::Bgr,
            Layout::Bgr => Layout::Rgb,
            other => other,
        })
    }

    fn in_layout(&self, py: Python<'_>, of: impl Fn(Layout) -> Layout) -> PyResult<PhotoView<'_>> {
        match self {
            Self::Bytes(s) => s.view(py, Samples::U8(&s.samples), of(s.layout)),
            Self::Words(s) => s.view(py, Samples::U16(&s.samples), of(s.layout)),
        }
    }
}

impl<T: Clone> Stored<'_, T> {
    fn view<'b>(&self, py: Python<'_>, samples: Samples<'b>, layout: Layout) -> PyResult<PhotoView<'b>> {
        let stride = self.width * if self.layout.has_color() { 3 } else { 1 };
        PhotoView::new(samples, self.width, self.height, stride, layout).raise(py, Stage::Detect)
    }
}

/// A photograph of the core as an array; an alpha channel is left out.
pub(crate) fn array_of<'py>(py: Python<'py>, photo: image::DynamicImage) -> PyResult<Bound<'py, PyAny>> {
    use super::array::shaped;
    let (width, height) = (photo.width() as usize, photo.height() as usize);
    let color = photo.color();
    let deep = color.bytes_per_pixel() > color.channel_count();
    let (of_grey, of_color) = ([height, width], [height, width, 3]);
    match (color.has_color(), deep) {
        (true, false) => shaped(py, py.detach(|| photo.into_rgb8()).into_raw(), &of_color),
        (true, true) => shaped(py, py.detach(|| photo.into_rgb16()).into_raw(), &of_color),
        (false, false) => shaped(py, py.detach(|| photo.into_luma8()).into_raw(), &of_grey),
        (false, true) => shaped(py, py.detach(|| photo.into_luma16()).into_raw(), &of_grey),
    }
}
