//! Whole tasks in one object each: photographs → rig ([`Calibrator`]), photograph → cloud ([`Reconstructor`]),
//! photograph + rig → what has moved ([`PhotoVerifier`]).

mod calibrator;
mod cloud_report;
mod common_orientation;
#[cfg(test)]
mod mirrored_tests;
#[cfg(test)]
mod panel_border_tests;
mod photo_tags;
mod photo_verifier;
mod reconstructor;
mod sequence_reconstructor;
mod sequence_sheet;
#[cfg(test)]
mod sequence_sheet_tests;
mod sheet_photo;
mod sheet_sides;
mod tag_warnings;
mod taken;

pub use calibrator::Calibrator;
public_with! { "report": pub use cloud_report::CloudReport; }
pub use photo_tags::{FocalSource, FrameChange, Orientation, PhotoTags, TaggedFocal};
pub use photo_verifier::{PhotoVerifier, VerifiedPhoto, VerifyPhotoConfig, verify_photo};
pub use reconstructor::{ReconstructConfig, Reconstruction, Reconstructor, cloud_from_matches};
pub use sequence_reconstructor::{SequenceReconstructor, cloud_from_dense_matches};
pub use sheet_photo::SheetPhoto;
public_with! { "stages": pub use sheet_sides::observe_sheet; }
