//! Sequences of Gray code and shifted sinusoids.

use std::path::Path;

use pyo3::prelude::*;
use slcal_core::pattern::{self, Pattern, SequenceAxes, SequenceConfig, SequencePreset, SinusoidConfig};

use super::file::{from_file, json, parse};
use crate::convert::array::shaped;
use crate::convert::object::{self, Argument};
use crate::convert::option::{one_of, parsed, parsed_or, repr_of, whole_pair};
use crate::convert::report;
use crate::errors::{self, Raise as _, Stage, raised_from};
use crate::files;

fn sequence(py: Python<'_>, pattern: Pattern) -> PyResult<SequencePattern> {
    match pattern {
        Pattern::Sequence(p) => Ok(SequencePattern(p)),
        Pattern::Checker(_) => {
            Err(errors::invalid(py, "pattern", "a sequence", "a checkerboard; CheckerPattern.load reads it"))
        }
        Pattern::Stripes(_) => {
            Err(errors::invalid(py, "pattern", "a sequence", "stripes; StripePattern.load reads them"))
        }
    }
}

/// Pictures that are shown one after another: Gray code, or Gray code and shifted sinusoids.
///
/// Parameters
/// ----------
/// projector : (int, int)
///     Width and height of the projector's panel, px: its native resolution.
/// kind : {"gray", "phase"}, default "gray"
///     "gray" for Gray code alone; "phase" for as much of it as tells the periods of a sinusoid apart, and the sinusoid's shifts.
/// axis : {"columns", "rows", "both"}, default "columns"
///     What is coded.
/// period : float, default 16
///     Period of the sinusoid, px; only with "phase".
/// steps : int, default 8
///     Shifts of the sinusoid within its period; only with "phase". From 5 on an unknown gamma does not matter.
/// bits : int, optional
///     Bits of the Gray code, the most significant ones; by default all, or with a sinusoid one more than tell its periods apart.
/// preset : {"opencv-gray", "slstudio-gray"}, optional
///     The pictures of OpenCV's GrayCodePattern or of SLStudio in their order, instead; only with "gray" and without `axis`.
///
/// Raises
/// ------
/// Error
///     When an option is out of range, or options contradict each other.
///
/// Examples
/// --------
/// >>> sequence = slcal.SequencePattern(projector=(1024, 768), kind="phase")
/// >>> sequence
/// SequencePattern(projector=(1024, 768), frames=24)
/// >>> sequence.frames[2]
/// {'axis': 'columns', 'bit': 6, 'file': 'frame_002.png', 'inverted': False, 'is': 'bit'}
/// >>> sequence.image(2).shape
/// (768, 1024)
#[pyclass(frozen, module = "slcal", eq, hash)]
#[derive(PartialEq, Clone)]
pub(crate) struct SequencePattern(pub(crate) pattern::SequencePattern);

impl std::hash::Hash for SequencePattern {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        (self.0.projector, self.0.frames.len()).hash(state);
    }
}

impl Argument for SequencePattern {
    const EXPECTED: &'static str = "a SequencePattern";
    const OF_ARRAY: &'static str =
        "slcal.SequencePattern(projector=(width, height)), whose image(i) is a picture";
    const OF_OTHER: &'static str = "slcal.SequencePattern(projector=(width, height))";

    fn of_path(path: &Path) -> String {
        object::load_pattern("SequencePattern", path)
    }
}

#[pymethods]
impl SequencePattern {
    #[new]
    #[pyo3(
        signature = (projector, kind=None, axis=None, period=None, steps=None, bits=None, preset=None),
        text_signature = "(projector, kind='gray', axis='columns', period=16.0, steps=8, bits=None, preset=None)"
    )]
    fn new(
        projector: &Bound<'_, PyAny>,
        kind: Option<&Bound<'_, PyAny>>,
        axis: Option<&Bound<'_, PyAny>>,
        period: Option<f64>,
        steps: Option<i64>,
        bits: Option<i64>,
        preset: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let py = projector.py();
        let count = |what: &str, n: i64| {
            u32::try_from(n)
                .map_err(|_| errors::invalid(py, what, "a whole number above zero", &n.to_string()))
        };
        let panel = whole_pair(projector, "projector")?;
        let has_phase = kind.map_or(Ok(false), |k| one_of(k, "kind", &[("gray", false), ("phase", true)]))?;
        let bits = bits.map(|n| count("bits", n)).transpose()?;
        for (what, is_given) in [("period", period.is_some()), ("steps", steps.is_some())] {
            if is_given && !has_phase {
                return Err(errors::invalid(py, what, "kind=\"phase\" with it", "kind=\"gray\""));
            }
        }
        if let Some(preset) = preset {
            if has_phase {
                return Err(errors::invalid(py, "preset", "kind=\"gray\" with it", "kind=\"phase\""));
            }
            if let Some(axis) = axis {
                return Err(errors::invalid(
                    py,
                    "axis",
                    "none beside a preset, which has its own",
                    &repr_of(axis),
                ));
            }
            let preset: SequencePreset = parsed(preset, "preset")?;
            return pattern::SequencePattern::preset(panel, preset, bits).map(Self).raise(py, Stage::Detect);
        }
        let usual = SinusoidConfig::default();
        let sinusoid = SinusoidConfig {
            period_px: period.unwrap_or(usual.period_px),
            steps: steps.map_or(Ok(usual.steps), |n| count("steps", n))?,
        };
        let config = SequenceConfig {
            axes: parsed_or(axis, "axis", SequenceAxes::default())?,
            bits,
            sinusoid: has_phase.then_some(sinusoid),
        };
        pattern::SequencePattern::new(panel, &config).map(Self).raise(py, Stage::Detect)
    }

    /// Width and height of the panel, px.
    #[getter]
    fn projector(&self) -> (u32, u32) {
        self.0.projector.into()
    }

    /// What each picture shows, in the order in which they are shown, as the pattern file has it: a dictionary with "is", which is
    /// "white", "black", "bit" (with "axis", "bit" and "inverted") or "sinusoid" (with "axis", "period_px", "step" and "of"), and
    /// "file" where it is known.
    #[getter]
    fn frames<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let frames = serde_json::to_value(&self.0.frames).unwrap_or_default();
        report::value(py, &frames)
    }

    /// A picture to project. Show it full screen, without scaling.
    ///
    /// Parameters
    /// ----------
    /// frame : int
    ///     Which picture, from 0.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     (H, W) uint8.
    fn image<'py>(&self, py: Python<'py>, frame: i64) -> PyResult<Bound<'py, PyAny>> {
        let index = usize::try_from(frame).map_err(|_| {
            errors::invalid(py, "frame", &format!("0 to {}", self.0.frames.len() - 1), &frame.to_string())
        })?;
        let drawn = py.detach(|| self.0.image(index)).raise(py, Stage::Detect)?;
        let shape = [drawn.height() as usize, drawn.width() as usize];
        shaped(py, drawn.into_raw(), &shape)
    }

    /// Writes the pattern file (schema slcal-pattern/1).
    ///
    /// Parameters
    /// ----------
    /// file : path or file object
    ///     A path, where the file appears when it is complete and replaces an older one, or an object with write().
    fn save(&self, file: &Bound<'_, PyAny>) -> PyResult<()> {
        files::write(file, &json(file.py(), &Pattern::Sequence(self.0.clone()))?, true)
    }

    /// Reads a pattern file; see `slcal.load_pattern` for files of any kind.
    #[staticmethod]
    fn load(file: &Bound<'_, PyAny>) -> PyResult<Self> {
        sequence(file.py(), from_file(file)?)
    }

    /// The content of the pattern file.
    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        files::text_of(json(py, &Pattern::Sequence(self.0.clone()))?)
    }

    /// The pattern that `to_json` wrote, or another program.
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> PyResult<Self> {
        sequence(py, parse(py, text.as_bytes(), None)?)
    }

    /// Which of the photographs of a folder are the frames: for each frame the index of its name.
    #[pyo3(name = "_frame_order")]
    fn frame_order(&self, py: Python<'_>, names: Vec<String>, folder: &str) -> PyResult<Vec<usize>> {
        self.0.frame_order(&names).map_err(|error| raised_from(py, &error, Stage::Decode, Some(folder)))
    }

    fn __len__(&self) -> usize {
        self.0.frames.len()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((py.get_type::<Self>().getattr("from_json")?, (self.to_json(py)?,)))
    }

    fn __repr__(&self) -> String {
        let [w, h] = self.0.projector;
        format!("SequencePattern(projector=({w}, {h}), frames={})", self.0.frames.len())
    }
}
