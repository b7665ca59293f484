//! The photographs of a sequence: arrays, files, or whatever yields them.

use numpy::{PyUntypedArray, PyUntypedArrayMethods as _};
use pyo3::prelude::*;
use pyo3::types::PyMapping;
use slcal_core::decode::{SequenceDecodeConfig, SequenceDecoder, SequenceDecoding};
use slcal_core::{
    ErrorSubject, PhotoView, Reconstruction, Result, Rig, SequencePattern, SequenceReconstructor,
};

use crate::convert::array::shape_in_words;
use crate::convert::image::{Photo, Pixels};
use crate::convert::object::named;
use crate::errors::{self, Raise as _, Stage};
use crate::files;
use crate::read_image::read_image;

/// How frames are called in messages.
const WHAT: &str = "frames";
const WANTED: &str = "the frames of the sequence in its order: an array of shape (N, H, W) or (N, H, W, 3), or an iterable of \
                      arrays and paths";

/// What takes the frames of a sequence.
pub(crate) trait Folder: Send {
    type Made: Send;

    /// The order in which the least has to be held.
    fn order(&self) -> Vec<usize>;
    fn push(&mut self, frame: usize, photo: PhotoView<'_>) -> Result<()>;
    fn finish(&mut self) -> Result<Self::Made>;
    /// The same for all frames at once.
    fn whole(&mut self, frames: &[PhotoView<'_>]) -> Result<Self::Made>;
}

/// Frames → matches.
pub(crate) struct ToMatches<'a> {
    decoder: SequenceDecoder,
    /// That of the camera, if it is known.
    rig: Option<&'a Rig>,
}

impl<'a> ToMatches<'a> {
    pub(crate) fn new(pattern: &SequencePattern, mirrored: bool, rig: Option<&'a Rig>) -> Result<Self> {
        if let Some(rig) = rig {
            rig.projector_for(ErrorSubject::Pattern, pattern.projector)?;
        }
        let mut config = SequenceDecodeConfig::default();
        config.mirrored = mirrored || rig.is_some_and(Rig::is_mirrored);
        Ok(Self { decoder: SequenceDecoder::new(pattern, config)?, rig })
    }

    fn check(&self, photo: &PhotoView<'_>) -> Result<()> {
        self.rig.map_or(Ok(()), |rig| rig.check_photo_size([photo.width(), photo.height()]))
    }
}

impl Folder for ToMatches<'_> {
    type Made = SequenceDecoding;

    fn order(&self) -> Vec<usize> {
        self.decoder.reading_order().to_vec()
    }

    fn push(&mut self, frame: usize, photo: PhotoView<'_>) -> Result<()> {
        self.check(&photo)?;
        self.decoder.push(frame, photo)
    }

    fn finish(&mut self) -> Result<SequenceDecoding> {
        self.decoder.finish()
    }

    fn whole(&mut self, frames: &[PhotoView<'_>]) -> Result<SequenceDecoding> {
        frames.iter().try_for_each(|photo| self.check(photo))?;
        self.decoder.decode(frames)
    }
}

impl Folder for SequenceReconstructor {
    type Made = Reconstruction;

    fn order(&self) -> Vec<usize> {
        self.reading_order().to_vec()
    }

    fn push(&mut self, frame: usize, photo: PhotoView<'_>) -> Result<()> {
        self.push(frame, photo)
    }

    fn finish(&mut self) -> Result<Reconstruction> {
        self.finish()
    }

    fn whole(&mut self, frames: &[PhotoView<'_>]) -> Result<Reconstruction> {
        self.reconstruct(frames)
    }
}

/// Gives the frames to `to`, without the interpreter's lock. Arrays are read where they lie. Other frames are taken one by one, so
/// that memory holds one.
pub(crate) fn fold<F: Folder>(frames: &Bound<'_, PyAny>, mut to: F) -> PyResult<F::Made> {
    let py = frames.py();
    let order = to.order();
    let n = order.len();
    if files::path_of(frames)?.is_some() {
        let found = "a path; the photographs of a folder are sorted(Path(folder).glob(\"*.png\"))";
        return Err(errors::wrong_type(WHAT, WANTED, found));
    }
    if let Ok(array) = frames.cast::<PyUntypedArray>()
        && !matches!(array.ndim(), 3 | 4)
    {
        return Err(errors::invalid(py, WHAT, WANTED, &format!("shape {}", shape_in_words(array.shape()))));
    }
    let count = if frames.cast::<PyMapping>().is_ok() || !frames.hasattr("__getitem__")? {
        None
    } else {
        frames.len().ok()
    };
    match count {
        Some(count) if count != n => return Err(other_number(frames, n, &count.to_string())),
        Some(_) => {
            if let Some(made) = whole(frames, n, &mut to)? {
                return Ok(made);
            }
            for i in order {
                push(&mut to, i, &frames.get_item(i)?)?;
            }
        }
        None => {
            let items = frames.try_iter().map_err(|_| errors::wrong_type(WHAT, WANTED, &named(frames)))?;
            let mut found = 0;
            for item in items {
                let item = item?;
                if found == n {
                    return Err(other_number(frames, n, "more"));
                }
                push(&mut to, found, &item)?;
                found += 1;
            }
            if found < n {
                return Err(other_number(frames, n, &found.to_string()));
            }
        }
    }
    py.detach(|| to.finish()).raise(py, Stage::Decode)
}

fn other_number(frames: &Bound<'_, PyAny>, expected: usize, found: &str) -> PyErr {
    let shape = frames.cast::<PyUntypedArray>().map_or_else(
        |_| String::new(),
        |array| format!(" in an array of shape {}", shape_in_words(array.shape())),
    );
    let wanted = format!("{expected}, as the pattern has");
    errors::invalid(frames.py(), WHAT, &wanted, &format!("{found}{shape}"))
}

/// All frames at once, where they lie in memory one and all.
fn whole<F: Folder>(frames: &Bound<'_, PyAny>, n: usize, to: &mut F) -> PyResult<Option<F::Made>> {
    let py = frames.py();
    let is_array = frames.cast::<PyUntypedArray>().is_ok();
    let is_list =
        frames.is_instance_of::<pyo3::types::PyList>() || frames.is_instance_of::<pyo3::types::PyTuple>();
    if !is_array && !is_list {
        // Getting an item may be work, and the item be dropped after use.
        return Ok(None);
    }
    let mut photos = Vec::with_capacity(n);
    for i in 0..n {
        let item = frames.get_item(i)?;
        if item.cast::<PyUntypedArray>().is_err() {
            return Ok(None);
        }
        photos.push(Photo::of(&item, &format!("{WHAT}[{i}]"))?);
    }
    let Some(pixels) = photos.iter().map(Photo::borrowed).collect::<Option<Vec<Pixels<'_>>>>() else {
        return Ok(None);
    };
    let views = pixels.iter().map(|p| p.view(py)).collect::<PyResult<Vec<_>>>()?;
    py.detach(|| to.whole(&views)).raise(py, Stage::Decode).map(Some)
}

fn push(to: &mut impl Folder, frame: usize, item: &Bound<'_, PyAny>) -> PyResult<()> {
    let py = item.py();
    let read = files::path_of(item)?.map(|_| read_image(item, false)).transpose()?;
    let photo = Photo::of(read.as_ref().unwrap_or(item), &format!("{WHAT}[{frame}]"))?;
    let pixels = photo.pixels();
    let view = pixels.view(py)?;
    py.detach(|| to.push(frame, view)).raise(py, Stage::Decode)
}
