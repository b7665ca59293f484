//! Projector–camera calibration from one photograph, and one-shot structured-light reconstruction.
//!
//! A camera photographs a white sheet of known size, on which a projector shows a checkerboard. One such photograph of a
//! tilted sheet determines focal lengths and poses of both devices: a [`Rig`]. Then the projector shows coloured stripes,
//! and every photograph of an object under them becomes a [`PointCloud`] in millimetres.
//!
//! ```
//! use slcal_core::{
//!     Calibrator, CheckerConfig, CheckerPattern, PhotoView, ReconstructConfig, Reconstructor, SheetSize, StripeConfig,
//!     StripePattern,
//! };
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../slcal-cli/demo"))?;
//! let panel = [1024, 768];
//! let checker = CheckerPattern::new(panel, &CheckerConfig::default())?; // checker.image()? is what to project
//! let sheet: SheetSize = "594x420mm".parse()?;
//! let photo = image::open("sheet.jpg")?;
//! let mut calibrator = Calibrator::new(sheet).with_pattern(&checker);
//! calibrator.add(PhotoView::try_from(&photo)?)?;
//! let rig = calibrator.calibrate()?.rig;
//!
//! let stripes = StripePattern::new(panel, &StripeConfig::default())?;
//! let mut reconstructor = Reconstructor::new(&rig, &stripes, ReconstructConfig::default())?;
//! let photo = image::open("board.jpg")?;
//! let cloud = &reconstructor.reconstruct(PhotoView::try_from(&photo)?)?.cloud;
//! assert!(cloud.points.len() > 10_000);
//! # Ok(())
//! # }
//! ```
//!
//! # What to begin with
//!
//! | task | begin with |
//! |---|---|
//! | photographs → rig | [`Calibrator`] |
//! | corners and pairs of another detector → rig | [`Observations`], [`calibrate_observations`] |
//! | how good a rig is | [`Rig::quality`], [`Verdict`] |
//! | photograph → cloud, frame after frame | [`Reconstructor`] |
//! | matches of another decoder → cloud | [`Matches`], [`cloud_from_matches`] |
//! | has anything moved? | [`PhotoVerifier`] |
//! | a picture without keystone | [`rectify_picture`], [`rectify_checker_picture`] |
//! | files | [`mod@format`] |
//!
//! # Features
//!
//! By default the crate has what a program needs that calibrates, reconstructs and verifies. Cargo features add the rest:
//!
//! | feature | what it adds |
//! |---|---|
//! | `rayon` | several threads where a configuration asks for them; the results are the same, bit for bit |
//! | `report` | what reports print and draw: residuals, counts of every stage, tests in detail, expected uncertainty |
//! | `advise` | which pose to photograph next, and how much that would improve a rig |
//! | `evaluate` | planes and spheres fitted to clouds |
//! | `exchange` | rigs and cameras as files of OpenCV, ROS, COLMAP, Kalibr and Blender |
//! | `npz` | the same as arrays of NumPy; includes `exchange` |
//! | `stages` | the single stages: detect, decode, triangulate, cull; includes `report` |
//! | `simulate` | photographs and observations with known truth; includes `stages` |
//!
//! The stages are [`pattern`] → [`detect`] → [`mod@calibrate`] → [`decode`] → [`mod@reconstruct`]. They meet in the types at
//! the root.
//!
//! # Conventions
//!
//! Lengths are millimetres, angles radians, pixels have integer centres; see [`geometry`] for the frames. Every estimate
//! comes with its standard deviation (1σ). Errors say what was expected, what was found and what to do ([`Error`]).
//!
//! The crate opens no files, prints nothing, starts no threads unless asked (feature `rayon`), reads no clock and keeps no
//! global state. The same input gives the same output, bit for bit. Configurations have `Default`; write
//! `Config { field: value, ..Config::default() }`, since fields may be added.

// What only a feature uses is idle without it; the build with all of them finds what nothing uses.
#![cfg_attr(
    not(all(
        feature = "advise",
        feature = "evaluate",
        feature = "npz",
        feature = "report",
        feature = "simulate"
    )),
    allow(dead_code, unreachable_pub, unused_imports)
)]

/// Names that are public with a cargo feature, and the crate's own without it.
macro_rules! public_with {
    ($feature:literal: pub use $($names:tt)+) => {
        #[cfg(feature = $feature)]
        pub use $($names)+
        #[cfg(not(feature = $feature))]
        pub(crate) use $($names)+
    };
}

#[cfg(feature = "advise")]
pub mod advise;
pub mod calibrate;
pub mod decode;
pub mod detect;
mod estimate;
#[cfg(feature = "evaluate")]
pub mod evaluate;
pub mod format;
pub mod geometry;
pub mod pattern;
pub mod photo;
mod pipeline;
pub mod reconstruct;
pub mod rectify;
#[cfg(feature = "simulate")]
pub mod simulate;
mod solve;
pub mod verify;

mod assumption;
mod channel_registration;
mod cloud;
mod dense_matches;
mod error;
#[cfg(test)]
mod for_tests;
mod matches;
mod named;
mod observations;
mod parameter;
mod rig;
mod sheet_pairs;

pub use assumption::{Assumption, AssumptionStatus, Moves};
pub use calibrate::{
    CalibrateConfig, Calibration, DistortionModel, Flatness, FocalPrior, Method, PixelAspect,
    PrincipalPointRule, calibrate_observations,
};
#[cfg(feature = "report")]
pub use calibrate::{CalibrationReport, NoiseFound, PairResidual, PointResidual, ViewResiduals, residuals};
pub use channel_registration::{
    ChannelDisplacements, ChannelRegistration, LateralColor, PanelDisplacement, RedBlue, RegistrationSource,
};
pub use cloud::{CloudPoint, Frame, PointCloud};
pub use dense_matches::DenseMatches;
pub use error::{Cause, Error, ErrorClass, ErrorSubject, Result};
pub use geometry::{Camera, Distortion, Intrinsics, Pose, RectangleSize, SheetBend, SheetSize};
pub use matches::{Match, Matches};
pub use observations::{
    ChannelOffset, CornerPair, EdgePoint, Observations, PanelPoint, SheetObservation, ViewObservation,
};
pub use parameter::{LensParameter, Parameter, PoseParameter};
pub use pattern::{
    CheckerConfig, CheckerPattern, Pattern, SequenceConfig, SequencePattern, StripeConfig, StripePattern,
};
pub use photo::{Encoding, PhotoView};
#[cfg(feature = "report")]
pub use pipeline::CloudReport;
#[cfg(feature = "stages")]
pub use pipeline::observe_sheet;
pub use pipeline::{
    Calibrator, FocalSource, FrameChange, Orientation, PhotoTags, PhotoVerifier, ReconstructConfig,
    Reconstruction, Reconstructor, SequenceReconstructor, SheetPhoto, TaggedFocal, VerifiedPhoto,
    VerifyPhotoConfig, cloud_from_dense_matches, cloud_from_matches, verify_photo,
};
pub use rectify::{Rectification, rectify, rectify_checker, rectify_checker_picture, rectify_picture};
pub use rig::{
    Covariance, Device, DeviceSigma, Projector, Quality, Rig, Sag, StereoPose, Verdict, View, ViewBend,
    ViewRms, Warning,
};
#[cfg(feature = "stages")]
pub use sheet_pairs::{SheetPairs, sheet_pairs};

// Their types are part of the interface: points, matrices and pictures.
pub use image;
pub use nalgebra;

/// Runs the programs of the guide.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/rust.md")]
struct RustGuide;
