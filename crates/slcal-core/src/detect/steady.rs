//! A photograph as it is measured: with bands of flicker divided out of it, where there are any.

use super::row_flicker::{RowFlicker, gains};
use crate::error::Error;
use crate::photo::{DividedPhoto, Encoding, LinearPhoto, PhotoView};
use crate::rig::Warning;

/// Lamps and a colour wheel may both make bands; a third kind is none that a model of bands describes.
const SOURCES: usize = 2;
/// From this depth on the darkest rows have so little light that noise and rounding displace what is measured there.
const TOO_DEEP: f64 = 0.95;

const ADVICE: &str = "take the photograph again with a shutter time of a multiple of 1/100 s (where the mains has 50 Hz) or 1/120 s \
                      (60 Hz), or with a longer exposure";

/// A photograph and, if it has bands, a copy without them.
pub(super) struct Steady<'a> {
    original: LinearPhoto<'a>,
    divided: Option<DividedPhoto>,
    /// All bands that were seen.
    seen: Vec<String>,
    /// What was divided out.
    pub(super) notes: Vec<String>,
    /// Bands that are left, or are too deep.
    pub(super) warnings: Vec<Warning>,
}

impl<'a> Steady<'a> {
    pub(super) fn new(photo: PhotoView<'a>, encoding: Encoding) -> Self {
        let original = LinearPhoto::new(photo, encoding);
        let (mut all, mut notes, mut warnings) = (Vec::new(), Vec::new(), Vec::new());
        let mut divided_out = Vec::new();
        while let Some(bands) = RowFlicker::find(&original, &divided_out) {
            let percent = 100.0 * bands.depth;
            let seen = format!("bands of flicker, {percent:.0} % deep and {:.0} px apart", bands.period_px);
            all.push(seen.clone());
            if divided_out.len() == SOURCES || !bands.periodic {
                let left = "are left in the photograph: they do not repeat so regularly that they could be divided out";
                warnings.push(flicker_warning(&format!("{seen}, {left}")));
                break;
            }
            if bands.depth > TOO_DEEP {
                let light = 100.0 - percent;
                warnings.push(flicker_warning(&format!(
                    "{seen}, were divided out, but the darkest rows have only {light:.0} % of the light of the brightest"
                )));
            } else {
                notes.push(format!("{seen}, were divided out"));
            }
            divided_out.push(bands);
        }
        let divided =
            (!divided_out.is_empty()).then(|| original.with_rows_divided(|y| gains(&divided_out, y)));
        Self { original, divided, seen: all, notes, warnings }
    }

    /// What was not found, with the bands that may have hidden it.
    pub(super) fn explain(&self, error: Error) -> Error {
        match error {
            Error::NotFound { what, seen, advice } if !self.seen.is_empty() => Error::NotFound {
                what,
                seen: format!("{seen}; the photograph has {}", self.seen.join(" and ")),
                advice: format!("{ADVICE}; {advice}"),
            },
            other => other,
        }
    }

    /// The photograph to measure in.
    pub(super) fn photo(&self) -> LinearPhoto<'_> {
        match &self.divided {
            Some(divided) => LinearPhoto::new(divided.view(), Encoding::Linear),
            None => self.original.clone(),
        }
    }
}

fn flicker_warning(message: &str) -> Warning {
    Warning::new("flicker", format!("{message}; sides and corners may be displaced there"), ADVICE)
}
