//! The tilt of a sheet, in degrees.

use slcal_core::nalgebra::Point2;
use slcal_core::{Pose, RectangleSize};

use super::state::DemoPose;

/// Turns about the camera's horizontal and vertical axis of R = Rx·Ry·Rz; positive: the top side, or the right side, is nearer.
pub(super) fn tilt_deg(pose: &Pose) -> [f64; 2] {
    let r = pose.rotation.matrix();
    [(-r[(1, 2)]).atan2(r[(2, 2)]).to_degrees(), r[(0, 2)].clamp(-1.0, 1.0).asin().to_degrees()]
}

/// The turn about the camera's axis after these.
pub(super) fn roll_deg(pose: &Pose) -> f64 {
    let r = pose.rotation.matrix();
    (-r[(0, 1)]).atan2(r[(0, 0)]).to_degrees()
}

/// The same pose for the simulated sheet, which is placed by its middle.
pub(super) fn demo_pose(pose: &Pose, size: RectangleSize) -> DemoPose {
    let middle = pose.lift(Point2::new(size.width_mm / 2.0, size.height_mm / 2.0));
    DemoPose {
        tilt_deg: tilt_deg(pose),
        roll_deg: roll_deg(pose),
        distance_mm: middle.z,
        aside_mm: [middle.x, middle.y],
    }
}

#[cfg(test)]
mod tests {
    use slcal_core::nalgebra::{Rotation3, Vector3};

    use super::*;

    #[test]
    fn angles_of_a_known_turn_come_back() {
        let about = |axis, degrees: f64| Rotation3::from_axis_angle(&axis, degrees.to_radians());
        let rotation =
            about(Vector3::x_axis(), 20.0) * about(Vector3::y_axis(), -30.0) * about(Vector3::z_axis(), 5.0);
        let pose = Pose { rotation, translation: Vector3::z() };
        let [x, y] = tilt_deg(&pose);
        assert!((x - 20.0).abs() < 1e-9 && (y + 30.0).abs() < 1e-9 && (roll_deg(&pose) - 5.0).abs() < 1e-9);
    }
}
