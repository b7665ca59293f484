//! A sequence that is being photographed, as far as it has come.

use std::sync::Arc;

use slcal_core::pattern::SequencePattern;

use crate::studio::flash::Flash;
use crate::studio::scan_folder::ScanFolder;

/// A sequence that is being photographed.
#[derive(Debug)]
pub(super) struct Sequence {
    pub(super) pattern: Arc<SequencePattern>,
    /// Where its photographs go, once it is there.
    pub(super) folder: Option<ScanFolder>,
    /// The picture that is next, or photographs that are there.
    pub(super) frame: usize,
    pub(super) phase: Phase,
}

#[derive(Debug)]
pub(super) enum Phase {
    /// The camera's delay is measured.
    Flash(Flash),
    /// The folder is made.
    Folder,
    /// The picture is on its way to the display.
    Showing,
    /// It is painted; the camera does not show it before this time.
    Settling { until_ms: u64 },
    /// The photograph is on its way, or somebody takes it.
    Shooting,
}
