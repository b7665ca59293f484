//! A calibrated rig: the hand-over from `calibrate` to everything that uses it.

use nalgebra::{DMatrix, Point2, Vector3};
use serde::{Deserialize, Serialize};

use crate::geometry::{Camera, Pose, RectangleSize, VanishingPoints};

/// 1σ of a device's parameters; zero for what was held fixed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DeviceSigma {
    /// Focal length, px.
    pub focal_px: f64,
    /// Principal point, px.
    pub cx_px: f64,
    /// Principal point, px.
    pub cy_px: f64,
    /// k1, k2, p1, p2, k3.
    pub distortion: [f64; 5],
}

/// A camera or projector with the uncertainty of its parameters (`None` when unknown, as in rigs from elsewhere).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Device {
    /// The model.
    pub model: Camera,
    /// 1σ of its parameters.
    pub sigma: Option<DeviceSigma>,
}

/// The rigid transform between the devices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StereoPose {
    /// X_projector = R · X_camera + t.
    pub projector_from_camera: Pose,
    /// 1σ of t, mm.
    pub sigma_t_mm: Option<[f64; 3]>,
    /// 1σ of a small rotation about the projector's axes, rad.
    pub sigma_r_rad: Option<[f64; 3]>,
}

/// Root mean square residuals of one view.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ViewRms {
    /// Distance of the sheet's edge points (or corners) from the model, camera px.
    pub edges: f64,
    /// Distance of the projected corners from the model, camera px.
    pub corners: Option<f64>,
    /// The same distance carried to the projector's image, projector px.
    pub projector: Option<f64>,
}

/// One pose of the sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// Name of the photograph, as the caller gave it.
    pub photo: Option<String>,
    /// Size of the sheet.
    pub size: RectangleSize,
    /// X_camera = R · X_sheet + t.
    pub camera_from_sheet: Pose,
    /// X_projector = R · X_sheet + t.
    pub projector_from_sheet: Option<Pose>,
    /// Vanishing points of the sheet's directions in the camera.
    pub camera_vanishing_points: VanishingPoints,
    /// The same in the projector.
    pub projector_vanishing_points: Option<VanishingPoints>,
    /// Corners of the sheet TL, TR, BR, BL in the camera image, px.
    pub corners_px: [Point2<f64>; 4],
    /// Residuals; `None` in rigs from elsewhere that do not state them.
    pub rms_px: Option<ViewRms>,
}

/// How far the result can be trusted; from the predicted σ of the focal lengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// σ_f below 4 %.
    Good,
    /// Below 10 %.
    Fair,
    /// Below 25 %.
    Weak,
    /// The view does not determine the focal length.
    Degenerate,
}

/// Something the user should know about a result, and what to do about it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Warning {
    /// Stable identifier.
    pub code: String,
    /// What was noticed, with numbers.
    pub message: String,
    /// What to do.
    pub advice: String,
}

/// The judgement on a calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct Quality {
    /// In one word.
    pub verdict: Verdict,
    /// 1σ of the camera's focal length, per cent.
    pub focal_sigma_percent_camera: f64,
    /// 1σ of the projector's focal length, per cent.
    pub focal_sigma_percent_projector: Option<f64>,
    /// Expected 1σ of a reconstructed point at the sheet's distance, mm.
    pub expected_point_sigma_mm: Option<f64>,
    /// What else was noticed.
    pub warnings: Vec<Warning>,
}

/// Covariance of all estimated parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariance {
    /// Names of rows and columns.
    pub parameters: Vec<String>,
    /// Symmetric, in the units of the parameters (px, mm, rad).
    pub matrix: DMatrix<f64>,
}

/// A calibrated camera, and projector if a pattern was seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    /// The camera.
    pub camera: Device,
    /// The projector.
    pub projector: Option<Device>,
    /// Between them.
    pub stereo: Option<StereoPose>,
    /// The poses that it was calibrated from.
    pub views: Vec<View>,
    /// How it was made: "ml", "two-vp", or anything else for rigs from elsewhere.
    pub method: String,
    /// The judgement on it.
    pub quality: Option<Quality>,
    /// Covariance of the estimate.
    pub covariance: Option<Covariance>,
}

impl Rig {
    /// Distance between the optical centres, mm; `None` without a projector.
    #[must_use]
    pub fn baseline_mm(&self) -> Option<f64> {
        self.stereo.map(|s| s.projector_from_camera.translation.norm())
    }

    /// The camera's viewing direction onto the sheet of view `i`: angle between optical axis and the sheet's normal, rad.
    #[must_use]
    pub fn tilt_rad(&self, i: usize) -> Option<f64> {
        let view = self.views.get(i)?;
        Some((view.camera_from_sheet.rotation * Vector3::z()).angle(&Vector3::z()))
    }
}
