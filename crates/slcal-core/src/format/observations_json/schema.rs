//! Constants and messages of reading and writing.

use crate::error::{Error, ErrorSubject};

pub(super) const SCHEMA: &str = "slcal-observations/1";
/// Names of the sheet's sides, in the order of [`Side::ALL`](crate::geometry::Side::ALL).
pub(super) const SIDES: [&str; 4] = ["top", "right", "bottom", "left"];

pub(super) fn malformed(detail: impl Into<String>) -> Error {
    Error::malformed(ErrorSubject::ObservationsFile, detail)
}
