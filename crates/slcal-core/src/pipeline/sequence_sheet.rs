//! A pose of the sheet under a sequence: the sheet in the white photograph, the pairs from the matches of all pixels.

use crate::dense_matches::DenseMatches;
use crate::detect::{DetectConfig, Detection, SheetDetection, find_lit_sheet, observe};
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::RectangleSize;
use crate::photo::PhotoView;
use crate::sheet_pairs::{SheetPairs, sheet_pairs};

/// What [`observe`] finds under a checkerboard, of a sequence for this panel. `plain`, if given, shows the sheet's sides.
///
/// # Errors
/// As [`observe`] and [`sheet_pairs`]; [`Error::Invalid`] for matches of another size than the photograph.
pub(super) fn observe_sequence(
    white: PhotoView<'_>,
    plain: Option<PhotoView<'_>>,
    size: RectangleSize,
    matches: &DenseMatches,
    panel: [u32; 2],
    config: &DetectConfig,
) -> Result<Detection> {
    let (found, expected) = ([matches.width, matches.height], [white.width(), white.height()]);
    if found != expected {
        let [[w, h], [found_w, found_h]] = [expected, found];
        let what = ErrorSubject::Named("matches of the sequence");
        let expected = format!("those of {w}x{h} pixels, as the white photograph has");
        return Err(Error::invalid(what, expected, format!("{found_w}x{found_h}")));
    }
    let mut detection = observe(white, plain, size, None, config)?;
    let view = &mut detection.observation;
    let first = sheet_pairs(matches, &view.sheet)?;
    let rough = SheetDetection {
        observation: view.sheet.clone(),
        notes: detection.notes.clone(),
        warnings: detection.warnings.clone(),
    };
    let clipped = detection.warnings.iter().find(|w| w.code == crate::detect::CLIPPED).cloned();
    let found = find_lit_sheet(plain.unwrap_or(white), rough, &first.pairs, panel, config)?;
    let SheetPairs { pairs, cells } = sheet_pairs(matches, &found.observation)?;
    detection.notes = found.notes;
    detection.warnings = found.warnings;
    if !detection.warnings.iter().any(|w| w.code == crate::detect::CLIPPED) {
        detection.warnings.extend(clipped);
    }
    if pairs.len() < cells {
        detection.notes.push(format!(
            "{} of {cells} parts of the sheet give a pair: the others are not lit, or too few of their pixels are certain",
            pairs.len()
        ));
    }
    view.sheet = found.observation;
    view.pairs = pairs;
    detection.pattern_corners = cells;
    Ok(detection)
}
