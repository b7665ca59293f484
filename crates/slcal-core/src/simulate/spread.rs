//! Seeded poses spread over all tilt directions, in which sheet and pattern are completely visible.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::draws::Draws;
use super::poses::{PoseConfig, STEEPEST_RAD};
use super::rig_config::RigConfig;
use super::scene::Scene;
use crate::error::{Error, Result, within};

/// Largest number of poses.
const MOST_POSES: usize = 1000;
/// Draws per pose until sheet and pattern are completely visible.
const TRIES: usize = 300;
/// Poses are rejected in which the pattern would have to be smaller than this share of its default.
const SMALLEST_SHARE: f64 = 0.5;

/// How poses spread.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SpreadConfig {
    /// Tilt from the camera's axis, rad; default 15° to 35°. Its directions cover the whole circle.
    pub tilt_rad: [f64; 2],
    /// Largest rotation in the sheet's plane, rad; default 10°.
    pub roll_rad: f64,
    /// Largest offset along the sheet's sides, as a share of them; default 0.05.
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

/// `count` poses whose tilt directions cover the whole circle. Sheet and pattern are completely visible in all of them.
///
/// # Errors
/// [`Error::Invalid`] for a count or spread out of range, and when no such pose shows sheet and pattern completely.
pub fn spread_poses(
    rig: &RigConfig,
    count: usize,
    spread: &SpreadConfig,
    seed: u64,
) -> Result<Vec<PoseConfig>> {
    within("number of poses", count, [1, MOST_POSES], "")?;
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
    // One direction per sector; neighbours in the list are in opposite halves, so that a short list is well spread,
    // too.
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
