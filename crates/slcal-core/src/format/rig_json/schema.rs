//! The fields of the file, as serde reads and writes them.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::assumption::Assumption;
use crate::channel_registration::{
    ChannelDisplacements, LateralColor, PanelDisplacement, RedBlue, RegistrationSource,
};
use crate::error::{Error, ErrorSubject};
use crate::rig::{Verdict, Warning};

pub(super) const SCHEMA: &str = "slcal-rig/1";
pub(super) const UNITS: &str = "mm";
pub(super) const PIXEL_CENTRE: &str = "integer";

pub(super) type Rows3 = [[f64; 3]; 3];

/// The fields, of which those of several values are moved and not read.
#[derive(Deserialize)]
pub(super) struct RigDto {
    pub(super) schema: String,
    pub(super) units: String,
    pub(super) pixel_centre: String,
    #[serde(default)]
    pub(super) method: Option<String>,
    #[serde(skip)]
    pub(super) camera: Value,
    #[serde(skip)]
    pub(super) projector: Value,
    #[serde(skip)]
    pub(super) projector_from_camera: Value,
    #[serde(skip)]
    pub(super) views: Vec<Value>,
    #[serde(skip)]
    pub(super) quality: Value,
    #[serde(skip)]
    pub(super) covariance: Value,
    #[serde(skip)]
    pub(super) channel_registration: Value,
}

#[derive(Serialize, Deserialize)]
pub(super) struct DeviceDto {
    pub(super) width: u32,
    pub(super) height: u32,
    #[serde(rename = "K")]
    pub(super) k: Rows3,
    pub(super) distortion: [f64; 5],
    #[serde(default)]
    pub(super) sigma: Option<SigmaDto>,
    /// Of the projector alone.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(super) mirrored: bool,
}

#[derive(Serialize, Deserialize)]
pub(super) struct SigmaDto {
    pub(super) focal_px: Option<f64>,
    pub(super) cx_px: Option<f64>,
    pub(super) cy_px: Option<f64>,
    pub(super) distortion: Option<[f64; 5]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) aspect: Option<f64>,
}

#[derive(Serialize, Deserialize)]
pub(super) struct StereoDto {
    #[serde(rename = "R")]
    pub(super) r: Rows3,
    pub(super) t: [f64; 3],
    #[serde(default)]
    pub(super) sigma_t_mm: Option<[f64; 3]>,
    #[serde(default)]
    pub(super) sigma_r_rad: Option<[f64; 3]>,
}

#[derive(Serialize, Deserialize)]
pub(super) struct PoseDto {
    #[serde(rename = "R")]
    pub(super) r: Rows3,
    pub(super) t: [f64; 3],
}

#[derive(Serialize, Deserialize)]
pub(super) struct VanishingDto {
    pub(super) camera: Option<[[f64; 3]; 2]>,
    pub(super) projector: Option<[[f64; 3]; 2]>,
}

#[derive(Serialize, Deserialize)]
pub(super) struct RmsDto {
    pub(super) edges: Option<f64>,
    pub(super) corners: Option<f64>,
    pub(super) projector: Option<f64>,
}

#[derive(Serialize, Deserialize)]
#[expect(clippy::struct_field_names, reason = "the keys of the file")]
pub(super) struct BendDto {
    pub(super) coefficients_mm: [f64; 12],
    pub(super) sigma_mm: Option<[f64; 12]>,
    #[serde(default)]
    pub(super) expected_sigma_mm: Option<[f64; 12]>,
    /// Written for the reader; it follows from the coefficients.
    #[serde(default)]
    pub(super) sag_mm: Option<f64>,
}

#[derive(Serialize, Deserialize)]
pub(super) struct ViewDto {
    pub(super) photo: Option<String>,
    pub(super) size_mm: Option<[f64; 2]>,
    pub(super) camera_from_sheet: Option<PoseDto>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) bend: Option<BendDto>,
    pub(super) projector_from_sheet: Option<PoseDto>,
    pub(super) vanishing_points: Option<VanishingDto>,
    pub(super) corners_px: Option<[[f64; 2]; 4]>,
    pub(super) rms_px: Option<RmsDto>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) clipped_percent: Option<f64>,
}

#[derive(Serialize, Deserialize)]
pub(super) struct FocalSigmaDto {
    pub(super) camera: Option<f64>,
    pub(super) projector: Option<f64>,
}

#[derive(Serialize, Deserialize)]
pub(super) struct QualityDto {
    pub(super) verdict: Option<Verdict>,
    pub(super) focal_sigma_percent: Option<FocalSigmaDto>,
    #[serde(default)]
    pub(super) depth_sigma_percent: Option<f64>,
    pub(super) expected_point_sigma_mm: Option<f64>,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub(super) cause: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub(super) advice: String,
    #[serde(default)]
    pub(super) warnings: Vec<Warning>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) assumptions: Vec<Assumption>,
}

#[derive(Serialize, Deserialize)]
pub(super) struct CovarianceDto {
    pub(super) parameters: Vec<String>,
    pub(super) matrix: Vec<Vec<f64>>,
}

pub(super) fn malformed(detail: impl Into<String>) -> Error {
    Error::malformed(ErrorSubject::RigFile, detail)
}

/// What the others are displaced against.
pub(super) const REFERENCE: &str = "green";

#[derive(Serialize, Deserialize)]
pub(super) struct RegistrationDto {
    pub(super) reference: String,
    pub(super) projector: RedBlue<PanelDisplacement>,
    pub(super) camera: RedBlue<LateralColor>,
    pub(super) sigma: ChannelDisplacements,
    pub(super) from: RegistrationSource,
}
