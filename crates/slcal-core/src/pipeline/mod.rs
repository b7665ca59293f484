//! Whole tasks in one object each: photographs → rig ([`Calibrator`]), photograph → cloud ([`Reconstructor`]),
//! photograph + rig → what has moved ([`PhotoVerifier`]).

mod calibrator;
mod cloud_report;
mod photo_verifier;
mod reconstructor;

pub use calibrator::{Calibrator, SheetPhoto};
public_with! { "report": pub use cloud_report::CloudReport; }
pub use photo_verifier::{PhotoVerifier, VerifiedPhoto, VerifyPhotoConfig, verify_photo};
pub use reconstructor::{ReconstructConfig, Reconstruction, Reconstructor, cloud_from_matches};
