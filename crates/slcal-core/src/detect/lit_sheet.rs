//! The sheet under the white light of a projector, whose border is not the sheet's.

use super::board::fit;
use super::detection::DetectConfig;
use super::downsampled::Downsampled;
use super::projector_footprint::{ProjectedEdges, ProjectorFootprint};
use super::rough_undistort::RoughLens;
use super::sheet::{self, SheetDetection};
use super::steady::Steady;
use crate::error::Result;
use crate::observations::CornerPair;
use crate::photo::PhotoView;

/// How well the outline that was found first and the border of the light are known, as a part of the frame's diagonal: 4 px at 1280×960.
const BORDER_UNCERTAINTY: f64 = 0.0025;

/// Detects the sheet again once it is known what the projector lights on it. `first` was found without that, and may be the outline of
/// the light: `lit` are pairs inside it, which lie on the sheet in any case.
///
/// # Errors
/// [`Error::NotFound`](crate::Error::NotFound) when `first` is the outline of the light and no sheet is found around it.
pub(crate) fn find_lit_sheet(
    photo: PhotoView<'_>,
    first: SheetDetection,
    lit: &[CornerPair],
    panel: [u32; 2],
    config: &DetectConfig,
) -> Result<SheetDetection> {
    let steady = Steady::new(photo, config.encoding);
    let photo = steady.photo();
    let lens = RoughLens::from_corners(photo.width(), photo.height(), lit);
    let Some((undistorted_from_projector, _)) = fit(lit, &lens) else { return Ok(first) };
    let footprint = ProjectorFootprint::new(&undistorted_from_projector, panel);
    let projected = ProjectedEdges { footprint: &footprint, lens: &lens, board: None, lit };
    let uncertainty_px = BORDER_UNCERTAINTY * (photo.width() as f64).hypot(photo.height() as f64);
    match sheet::find(&photo, &Downsampled::new(&photo), &projected, config.corners) {
        Ok(mut found) => {
            found.notes.extend(steady.notes.iter().cloned());
            found.warnings.extend(steady.warnings.iter().cloned());
            Ok(found)
        }
        Err(error) => match first.observation.corners() {
            Some(corners) if !sheet::is_along_border(&corners, &projected, uncertainty_px) => Ok(first),
            _ => Err(steady.explain(error)),
        },
    }
}
