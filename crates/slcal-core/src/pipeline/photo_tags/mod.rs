//! What a camera wrote into its photograph (EXIF), and what follows from it for a calibration.

mod focal;
mod focal_check;
mod frame;
mod frame_check;
mod orientation;
mod sensors;
mod tags;

pub use focal::{FocalSource, TaggedFocal};
pub(super) use focal_check::contradiction;
pub use frame::FrameChange;
pub(super) use frame_check::{Finding, examine};
pub use orientation::Orientation;
pub(super) use orientation::Turn;
pub use tags::PhotoTags;
