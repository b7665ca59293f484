//! The size of a projector panel.

use crate::error::{Error, ErrorSubject, Result};

/// Largest panel side, px: larger than any projector, and small enough that a mistyped size does not exhaust the memory.
const MAX_PANEL_PX: u32 = 16384;

/// Refuses panels without pixels or of absurd size.
pub(super) fn check_panel([w, h]: [u32; 2]) -> Result<()> {
    if (1..=MAX_PANEL_PX).contains(&w) && (1..=MAX_PANEL_PX).contains(&h) {
        return Ok(());
    }
    Err(Error::invalid(
        ErrorSubject::Panel,
        format!("a width and a height from 1 to {MAX_PANEL_PX} px"),
        format!("{w}x{h}"),
    ))
}
