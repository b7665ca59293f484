//! Projector–camera calibration from one photograph, and one-shot structured-light reconstruction.
//!
//! The folders are the verbs of the work, in the order in which data passes through them:
//! [`pattern`] (what is projected), [`detect`] (photograph → [`Observations`]), [`mod@calibrate`] (observations → [`Rig`]),
//! [`decode`] (photograph → [`Matches`]), [`reconstruct`] (matches + rig → [`PointCloud`]), [`evaluate`] (cloud → plane,
//! sphere). They meet in the plain types at the top of the crate and rest on [`geometry`] (values) and [`solve`]
//! (numerics). `simulate` (a cargo feature) makes observations with known truth. [`mod@format`] reads and writes those types as JSON, CSV and clouds (PLY, PCD, XYZ, OBJ, GLB) on any `Read` and `Write`.
//!
//! The crate opens no files, prints nothing, starts no threads, reads no clock and keeps no global state. Lengths are
//! millimetres, angles radians, pixels have integer centres; see [`geometry`] for the frames.

pub mod advise;
pub mod calibrate;
pub mod decode;
pub mod detect;
mod estimate;
pub mod evaluate;
pub mod format;
pub mod geometry;
pub mod pattern;
pub mod photo;
mod pipeline;
pub mod reconstruct;
pub mod rectify;
#[cfg(any(test, feature = "simulate"))]
pub mod simulate;
pub mod solve;
pub mod verify;

mod cloud;
mod error;
mod matches;
mod named;
mod observations;
mod parameter;
#[cfg(test)]
mod rendered_scenes;
mod rig;

pub use calibrate::{
    CalibrateConfig, Calibration, CalibrationReport, DistortionModel, FocalPrior, Method, NoiseFound,
    NoiseOf, PairResidual, PointResidual, PrincipalPointRule, ViewResiduals, calibrate_observations,
    residuals,
};
pub use cloud::{CloudPoint, Frame, PointCloud};
pub use error::{Access, Cause, Error, ErrorClass, ErrorSubject, Result};
pub use matches::{Match, Matches};
pub use observations::{CornerPair, EdgePoint, Observations, SheetObservation, ViewObservation};
pub use parameter::{LensParameter, Parameter, PoseParameter};
pub use pipeline::{
    Calibrator, CloudReport, PhotoVerifier, ReconstructConfig, Reconstruction, Reconstructor, SheetPhoto,
    VerifiedPhoto, VerifyPhotoConfig, cloud_from_matches, verify_photo,
};
pub use rectify::{Rectification, rectify, rectify_checker, rectify_checker_picture, rectify_picture};
pub use rig::{
    Covariance, Device, DeviceSigma, Projector, Quality, Rig, StereoPose, Verdict, View, ViewRms, Warning,
};
