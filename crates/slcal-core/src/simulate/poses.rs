//! The pose of the sheet as a few numbers.

use std::f64::consts::PI;

use nalgebra::{Rotation3, Vector3};
use serde::{Deserialize, Serialize};

use super::rig_config::RigConfig;
use crate::error::{Error, Result};
use crate::geometry::Pose;

/// Largest tilt: a sheet at 90° is a line.
pub(super) const STEEPEST_RAD: f64 = 89.0 * PI / 180.0;
/// Largest roll: beyond it another corner would be the sheet's top left one.
const MOST_ROLL_RAD: f64 = PI / 4.0;

/// The pose of the sheet: rotated about its own middle, X_camera = Rx·Ry·Rz·X about the camera's axes.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PoseConfig {
    /// Tilt about the camera's horizontal axis, rad.
    pub tilt_x_rad: f64,
    /// Tilt about its vertical axis, rad.
    pub tilt_y_rad: f64,
    /// Rotation in the sheet's own plane, rad.
    pub roll_rad: f64,
    /// Offset of the middle from the camera's axis, mm.
    pub aside_mm: [f64; 2],
    /// Distance in addition to the rig's, mm.
    pub farther_mm: f64,
}

impl PoseConfig {
    /// A tilt in degrees about the horizontal, then the vertical axis.
    #[must_use]
    pub fn tilted(x_deg: f64, y_deg: f64) -> Self {
        Self { tilt_x_rad: x_deg.to_radians(), tilt_y_rad: y_deg.to_radians(), ..Self::default() }
    }

    /// Checks the values.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a sheet seen edge-on or from behind, or rolled so far that the names of its corners
    /// change.
    pub fn validate(&self) -> Result<()> {
        for (name, angle, most) in [
            ("tilt about the horizontal axis", self.tilt_x_rad, STEEPEST_RAD),
            ("tilt about the vertical axis", self.tilt_y_rad, STEEPEST_RAD),
            ("roll", self.roll_rad, MOST_ROLL_RAD),
        ] {
            if !(-most..=most).contains(&angle) {
                let most = most.to_degrees();
                return Err(Error::invalid(
                    name,
                    format!("-{most}° to {most}°"),
                    format!("{}°", angle.to_degrees()),
                ));
            }
        }
        if !self.aside_mm.iter().chain([&self.farther_mm]).all(|x| x.is_finite()) {
            return Err(Error::invalid("place of the sheet", "finite lengths", format!("{self:?}")));
        }
        Ok(())
    }

    /// The pose in front of a rig.
    #[must_use]
    pub fn camera_from_sheet(&self, rig: &RigConfig) -> Pose {
        let about = |axis, angle| Rotation3::from_axis_angle(&axis, angle);
        let rotation = about(Vector3::x_axis(), self.tilt_x_rad)
            * about(Vector3::y_axis(), self.tilt_y_rad)
            * about(Vector3::z_axis(), self.roll_rad);
        let middle = Vector3::new(rig.size.width_mm / 2.0, rig.size.height_mm / 2.0, 0.0);
        let [x, y] = self.aside_mm;
        let at = Vector3::new(x, y, rig.distance_mm + self.farther_mm);
        Pose { rotation, translation: at - rotation * middle }
    }
}
