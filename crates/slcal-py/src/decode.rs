//! Photograph of stripes → matches.

use pyo3::prelude::*;
use slcal_core::decode::{DecodeConfig, DecodeInput};
use slcal_core::photo::Encoding;
use slcal_core::{Error, ErrorSubject, Result};

use crate::convert::image::Photo;
use crate::convert::object::{optional, refused};
use crate::convert::option;
use crate::convert::report::LazyReport;
use crate::dense_matches::DenseMatches;
use crate::errors::{self, Raise as _, Stage, raised};
use crate::matches::Matches;
use crate::pattern::{SequencePattern, StripePattern};
use crate::rig::Rig;
use crate::sequence_frames::{ToMatches, fold};

pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(decode, module)?)
}

/// The photographs of one scene.
pub(crate) struct Frames<'py> {
    image: Photo<'py>,
    black: Option<Photo<'py>>,
    white: Option<Photo<'py>>,
}

impl<'py> Frames<'py> {
    pub(crate) fn of(
        image: &Bound<'py, PyAny>,
        black: Option<&Bound<'py, PyAny>>,
        white: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Self> {
        Ok(Self {
            image: Photo::of(image, "image")?,
            black: black.map(|b| Photo::of(b, "black")).transpose()?,
            white: white.map(|w| Photo::of(w, "white")).transpose()?,
        })
    }

    /// What `work` makes of the photographs, without the interpreter's lock. When it does not find what it looks for, it
    /// is tried once more with red for blue, so that the message can name the usual reason.
    pub(crate) fn read<T: Send>(
        &self,
        py: Python<'_>,
        work: impl Fn(&DecodeInput<'_>) -> Result<T> + Send + Sync,
    ) -> PyResult<T> {
        let image = self.image.pixels();
        let [black, white] = [&self.black, &self.white].map(|p| p.as_ref().map(Photo::pixels));
        let given = DecodeInput {
            photo: image.view(py)?,
            black: black.as_ref().map(|p| p.view(py)).transpose()?,
            white: white.as_ref().map(|p| p.view(py)).transpose()?,
        };
        let swapped = DecodeInput {
            photo: image.swapped(py)?,
            black: black.as_ref().map(|p| p.swapped(py)).transpose()?,
            white: white.as_ref().map(|p| p.swapped(py)).transpose()?,
        };
        let done = py.detach(|| {
            work(&given).map_err(|error| {
                let missing = matches!(error, Error::NotFound { .. });
                if missing && work(&swapped).is_ok() { with_channels_swapped(error) } else { error }
            })
        });
        done.map_err(|error| raised(py, &error, Stage::Decode))
    }
}

/// The error of a photograph in which the stripes are found once red and blue change places.
fn with_channels_swapped(error: Error) -> Error {
    match error {
        Error::NotFound { what, seen, .. } => Error::NotFound {
            what,
            seen: format!("{seen}; but they are there when red and blue are swapped"),
            advice: "the image seems to be in OpenCV's BGR order: give image[..., ::-1] or \
                     cv2.cvtColor(image, cv2.COLOR_BGR2RGB)"
                .into(),
        },
        other => other,
    }
}

/// How photographs are read.
pub(crate) fn config(
    gamma: Option<&Bound<'_, PyAny>>,
    min_confidence: Option<f64>,
    mirrored: bool,
) -> PyResult<DecodeConfig> {
    Ok(DecodeConfig {
        encoding: option::parsed_or(gamma, "gamma", Encoding::default())?,
        mirrored,
        min_confidence: min_confidence.unwrap_or(DecodeConfig::default().min_confidence),
        ..DecodeConfig::default()
    })
}

/// What was projected.
pub(crate) enum Projected<'a> {
    Stripes(&'a slcal_core::StripePattern),
    Sequence(&'a slcal_core::SequencePattern),
}

impl<'a> Projected<'a> {
    pub(crate) fn of(pattern: &'a Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(stripes) = pattern.cast::<StripePattern>() {
            return Ok(Self::Stripes(&stripes.get().0));
        }
        match pattern.cast::<SequencePattern>() {
            Ok(sequence) => Ok(Self::Sequence(&sequence.get().0)),
            Err(_) => {
                Err(refused::<StripePattern>(pattern, "pattern", "a StripePattern or a SequencePattern"))
            }
        }
    }
}

/// Refuses options of stripes beside a sequence.
pub(crate) fn of_stripes_alone(py: Python<'_>, given: &[(&str, bool)]) -> PyResult<()> {
    match given.iter().find(|(_, is_given)| *is_given) {
        Some((what, _)) => {
            let wanted = "none with a SequencePattern: its frames are all that is needed";
            Err(errors::invalid(py, what, wanted, "one"))
        }
        None => Ok(()),
    }
}

/// Finds the stripes in a photograph and identifies their slits; or decodes the photographs of a sequence pixel by pixel.
///
/// Parameters
/// ----------
/// image : ndarray, or iterable of ndarrays and paths
///     (H, W, 3), uint8 or uint16, RGB order: the scene with the stripes projected. Of a sequence its photographs in the order of
///     the pattern: (N, H, W) or (N, H, W, 3), or an iterable of arrays and paths. Paths are read, and items of an iterator
///     taken, one by one, so that memory holds few.
/// pattern : StripePattern or SequencePattern
///     What was projected. With a sequence, `black`, `white`, `gamma` and `min_confidence` are not allowed.
/// black, white : ndarray, optional
///     The same view with the projector dark (ambient light is subtracted) and plain white (surface colours are divided
///     out).
/// gamma : {"srgb", "linear"} or float, default "srgb"
///     The transfer curve of the image.
/// min_confidence : float, default 0.4
///     Matches with a lower confidence are rejected and counted, 0 to 1.
/// rig : Rig, optional
///     The calibrated rig of the camera that took the image: its registration of the colour channels is used. Without it the registration is estimated from the
///     stripes where they show it.
/// mirror : bool, default False
///     Whether the projector's pictures appear mirrored, left and right exchanged (rear projection): column c of the pattern
///     counts as width - 1 - c.
///     A rig that was calibrated so says it (`Rig.mirrored`), and nothing is needed.
///
/// Returns
/// -------
/// Matches or DenseMatches
///     Of stripes, `Matches`: one per slit and image row (image column, where the stripes are horizontal). Of a sequence,
///     `DenseMatches`: the column, the row, or both of every pixel. Its `report` counts what was found, and what was rejected
///     and why.
///
/// Raises
/// ------
/// TypeError
///     When the image is not an array of uint8 or uint16.
/// Error
///     When the shape is wrong, an image of stripes is grey, images differ in size, a sequence has another number of frames than its
///     pattern, or an option is out of range.
/// DecodeError
///     When the stripes are not found, or are not those of the pattern. The message says so when they are found with red
///     and blue swapped. When nothing can be read from a sequence.
///
/// Examples
/// --------
/// >>> stripes = slcal.StripePattern(projector=(1024, 768))
/// >>> matches = slcal.decode(stripes.image(), stripes)  # The projected picture itself.
/// >>> bool(np.abs(matches.pixels[:, 0] - matches.columns).max() < 0.05)
/// True
/// >>> matches.report.slits
/// 64
/// >>> shifts = slcal.SequencePattern(projector=(320, 240), kind="phase")
/// >>> frames = (shifts.image(i)[:, 20:] for i in range(len(shifts)))  # A part of the projected pictures.
/// >>> dense = slcal.decode(frames, shifts)
/// >>> bool(np.nanmax(np.abs(dense.column - np.arange(20, 320))) < 0.1)
/// True
#[pyfunction]
#[pyo3(
    signature = (image, pattern, *, black=None, white=None, gamma=None, min_confidence=None, rig=None, mirror=false),
    text_signature = "(image, pattern, *, black=None, white=None, gamma='srgb', min_confidence=0.4, rig=None, mirror=False)"
)]
#[allow(clippy::too_many_arguments, reason = "keyword arguments")]
fn decode<'py>(
    image: &Bound<'py, PyAny>,
    pattern: &Bound<'py, PyAny>,
    black: Option<&Bound<'py, PyAny>>,
    white: Option<&Bound<'py, PyAny>>,
    gamma: Option<&Bound<'py, PyAny>>,
    min_confidence: Option<f64>,
    rig: Option<&Bound<'py, PyAny>>,
    mirror: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let py = image.py();
    let pattern = Projected::of(pattern)?;
    let rig = optional::<Rig>(rig, "rig")?.map(|rig| &rig.get().rig);
    let pattern = match pattern {
        Projected::Stripes(pattern) => pattern,
        Projected::Sequence(pattern) => {
            of_stripes_alone(
                py,
                &[
                    ("black", black.is_some()),
                    ("white", white.is_some()),
                    ("gamma", gamma.is_some()),
                    ("min_confidence", min_confidence.is_some()),
                ],
            )?;
            let decoding = fold(image, ToMatches::new(pattern, mirror, rig).raise(py, Stage::Decode)?)?;
            return Ok(Bound::new(py, DenseMatches::of(py, decoding)?)?.into_any());
        }
    };
    let frames = Frames::of(image, black, white)?;
    if let Some(rig) = rig {
        rig.projector_for(ErrorSubject::StripePattern, pattern.projector)
            .map_err(|e| raised(py, &e, Stage::Decode))?;
    }
    let registration = rig.and_then(|rig| rig.channel_registration);
    let mirrored = mirror || rig.is_some_and(slcal_core::Rig::is_mirrored);
    let config = DecodeConfig { registration, ..config(gamma, min_confidence, mirrored)? };
    let decoding = frames.read(py, |input| {
        if let Some(rig) = rig {
            rig.check_photo_size([input.photo.width(), input.photo.height()])?;
        }
        slcal_core::decode::decode(*input, pattern, &config)
    })?;
    let report = LazyReport::of("DecodeReport", &decoding.report);
    Ok(Bound::new(py, Matches { matches: decoding.matches, report })?.into_any())
}
