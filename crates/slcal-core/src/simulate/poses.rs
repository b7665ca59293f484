//! Poses of the sheet: given, or a seeded spread of them.

use std::f64::consts::{PI, TAU};

use nalgebra::{Rotation3, Vector3};
use serde::{Deserialize, Serialize};

use super::draws::Draws;
use super::rig_config::RigConfig;
use super::scene::Scene;
use crate::error::{Error, Result};
use crate::geometry::Pose;

/// Edge-on the sheet is a line: tilts stay this far below 90°.
const STEEPEST_RAD: f64 = 89.0 * PI / 180.0;
/// Beyond this roll another corner would be the sheet's top left one.
const MOST_ROLL_RAD: f64 = PI / 4.0;
/// Most poses that are drawn at once.
const MOST_POSES: usize = 1000;
/// Draws per pose until sheet and pattern are seen whole.
const TRIES: usize = 300;
/// Poses in which the pattern would have to be smaller than this part of its default are passed over.
const SMALLEST_SHARE: f64 = 0.5;

/// How the sheet stands: turned about its own middle, X_camera = Rx·Ry·Rz·X about the camera's axes.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PoseConfig {
    /// Tilt about the camera's horizontal axis, rad.
    pub tilt_x_rad: f64,
    /// Tilt about its vertical axis, rad.
    pub tilt_y_rad: f64,
    /// Turn in the sheet's own plane, rad.
    pub roll_rad: f64,
    /// Where the middle stands beside the camera's axis, mm.
    pub aside_mm: [f64; 2],
    /// How much further than the rig's distance it stands, mm.
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
    /// [`Error::Invalid`] for a sheet seen edge-on or from behind, or rolled so far that its corners change their names.
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

/// How poses spread.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SpreadConfig {
    /// Tilt from the camera's axis, rad; default 15° to 35°. Its direction goes round the clock.
    pub tilt_rad: [f64; 2],
    /// Largest turn in the sheet's plane, rad; default 10°.
    pub roll_rad: f64,
    /// Largest way aside along the sheet's sides, as a share of them; default 0.05.
    pub aside: f64,
    /// Largest change of the distance, as a share of it; default 0.1.
    pub farther: f64,
}

impl Default for SpreadConfig {
    fn default() -> Self {
        Self {
            tilt_rad: [15_f64.to_radians(), 35_f64.to_radians()],
            roll_rad: 10_f64.to_radians(),
            aside: 0.05,
            farther: 0.1,
        }
    }
}

/// `count` poses whose tilts point in directions spread over the whole circle, in all of which sheet and pattern are seen
/// whole.
///
/// # Errors
/// [`Error::Invalid`] for a count or spread out of range, and when no such pose shows sheet and pattern whole.
pub fn spread_poses(
    rig: &RigConfig,
    count: usize,
    spread: &SpreadConfig,
    seed: u64,
) -> Result<Vec<PoseConfig>> {
    if !(1..=MOST_POSES).contains(&count) {
        return Err(Error::invalid("number of poses", format!("1 to {MOST_POSES}"), count));
    }
    let [least, most] = spread.tilt_rad;
    if !(0.0 <= least && least <= most && most <= STEEPEST_RAD) {
        let found = format!("{}° to {}°", least.to_degrees(), most.to_degrees());
        return Err(Error::invalid("range of tilts", "two angles from 0° to 89°, the smaller first", found));
    }
    for (name, share) in [("way aside", spread.aside), ("change of the distance", spread.farther)] {
        if !(0.0..1.0).contains(&share) {
            return Err(Error::invalid(name, "0 to 1", share));
        }
    }
    let largest = Scene::new(rig, &[])?.square_px;
    let mut poses = Vec::with_capacity(count);
    for i in 0..count {
        let mut draws = Draws::new(seed, i as u64);
        let mut tries = 0;
        let pose = loop {
            let pose = draw_pose(rig, spread, (i, count), &mut draws);
            let error = match Scene::new(rig, &[pose]) {
                Ok(scene) if scene.outside_picture() > 0 => Error::invalid(
                    "the sheet in the camera's picture",
                    format!(
                        "all of it inside {}x{} px (a smaller or more distant sheet, a shorter lens)",
                        rig.camera[0], rig.camera[1]
                    ),
                    "corners outside in every pose that was tried",
                ),
                Ok(scene) if scene.square_px < SMALLEST_SHARE * largest => Error::invalid(
                    "the projected pattern",
                    "a sheet that holds it in poses all round (a larger or nearer sheet, a longer focal length of the projector)",
                    format!("room for squares of {} px only, in every pose that was tried", scene.square_px),
                ),
                Ok(_) => break pose,
                Err(error) => error,
            };
            tries += 1;
            if tries == TRIES {
                return Err(error);
            }
        };
        poses.push(pose);
    }
    Ok(poses)
}

fn draw_pose(
    rig: &RigConfig,
    spread: &SpreadConfig,
    (i, count): (usize, usize),
    draws: &mut Draws,
) -> PoseConfig {
    let tilt = draws.between(spread.tilt_rad[0], spread.tilt_rad[1]);
    // One direction per sector; neighbours in the list stand in opposite halves, so that a short list is well spread, too.
    let sector = if i % 2 == 0 { i / 2 } else { i / 2 + count.div_ceil(2) };
    let direction = TAU * (sector as f64 + draws.uniform()) / count as f64;
    let mut either_way = |most: f64| draws.between(-most, most);
    PoseConfig {
        tilt_x_rad: tilt * libm::cos(direction),
        tilt_y_rad: tilt * libm::sin(direction),
        roll_rad: either_way(spread.roll_rad),
        aside_mm: [
            either_way(spread.aside * rig.size.width_mm),
            either_way(spread.aside * rig.size.height_mm),
        ],
        farther_mm: either_way(spread.farther * rig.distance_mm),
    }
}
