//! observations.json (`"schema": "slcal-observations/1"`): corners and pairs of any detector as text.
//!
//! Required: schema, camera {width, height}, projector {width, height} or null, and for each view `size_mm` and either
//! `sheet_corners_px` or `sheet_edges_px`; with a projector also `pairs`. σ may be stated for a view (`sheet_sigma_px`,
//! `pair_sigma_px`), or for a point as an additional number after its coordinates. Otherwise it is unknown.
//! `panel_points` of a view (optional) are points on the border of the projector's light and marks: `[camera_x, camera_y, panel_x,
//! panel_y]`, with null for the coordinate that a border does not have, and σ behind them where it is known. `channel_offsets`
//! (optional) has how red and blue are displaced against green at corners: `[camera_x, camera_y, projector_x, projector_y, red_x, red_y,
//! blue_x, blue_y, σ_red, σ_blue]`. Unknown
//! fields are skipped. Numbers are written with the fewest digits that read back to the same
//! `f64`.

mod read;
mod schema;
mod write;

use std::io::{Read, Write};

use super::recognise::read_json;
use crate::error::{Error, ErrorSubject, Result};
use crate::observations::Observations;

/// Reads observations.
///
/// # Errors
/// [`Error::Malformed`] naming the view, the field and the point when the text is not JSON, the schema is another, a
/// required field is missing, or a value is not what the schema says (null in the place of a number, coordinates beyond
/// 10⁹ px, σ that are not positive, σ for a part of the points only); [`Error::Io`] when the stream fails. This does not check
/// whether a calibration can be computed from them.
pub fn read_observations(input: impl Read) -> Result<Observations> {
    read::observations(&read_json(input, ErrorSubject::ObservationsFile, "a file of observations")?)
}

/// Writes observations as JSON with a final newline, one line per point. Unknown σ are not written.
///
/// # Errors
/// [`Error::Invalid`] when a number is not finite; [`Error::Io`] when the stream fails.
pub fn write_observations(observations: &Observations, mut output: impl Write) -> Result<()> {
    let text = write::text(observations)?;
    let written = output.write_all(text.as_bytes()).and_then(|()| output.flush());
    written.map_err(|e| Error::writing(ErrorSubject::ObservationsFile, e))
}

#[cfg(test)]
mod tests;
