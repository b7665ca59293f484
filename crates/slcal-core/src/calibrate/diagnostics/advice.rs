//! What to do about a weak view, with numbers predicted from the Jacobian.

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

use crate::estimate::Solution;
use crate::geometry::{Pose, RectangleSize};
use crate::rig::Verdict;

/// The additional tilt that is advised, rad.
const MORE_TILT: f64 = 15.0 * std::f64::consts::PI / 180.0;
/// With several photographs one more is advised when it brings σ below this part of itself.
const WORTH_ANOTHER: f64 = 0.5;

/// The better of tilting the first view's sheet by 15° more about one of the camera's axes.
struct Tilt {
    axis: &'static str,
    sigma: f64,
    pose: Pose,
}

/// The tilt of 15° more that lowers the worst focal σ the most.
fn best_tilt(solution: &Solution) -> Option<Tilt> {
    let first = solution.model().views.first()?;
    let (pose, size) = (&first.pose, first.size);
    let [_, about_x, about_y] = tilt(pose);
    let options = [("horizontal", Vector3::x_axis(), about_x), ("vertical", Vector3::y_axis(), about_y)];
    let tried = options.into_iter().filter_map(|(axis, direction, now): (_, Unit<Vector3<f64>>, f64)| {
        // More of the tilt that is there; from face-on either sign will do.
        let angle = if now < 0.0 { -MORE_TILT } else { MORE_TILT };
        let pose = turned(pose, size, direction, angle);
        Some(Tilt { axis, sigma: solution.predict(&[pose])?.worst(), pose })
    });
    tried.min_by(|a, b| a.sigma.total_cmp(&b.sigma))
}

/// Per cent with two significant digits: "0.015 %", "5.4 %", "45 %"; beyond ten times the value the digits mean nothing.
pub(crate) fn percent(share: f64) -> String {
    let p = share * 100.0;
    if p > 1000.0 {
        return "more than 1000 %".into();
    }
    if p >= 10.0 || p <= 0.0 {
        return format!("{p:.0} %");
    }
    let decimals = (1.0 - p.log10().floor()).clamp(1.0, 6.0) as usize;
    format!("{p:.decimals$} %")
}

/// One sentence of advice: what more tilt and what a photograph with the tilt reversed would bring.
pub(crate) fn advise(solution: &Solution, sigma: f64) -> String {
    let [first, others @ ..] = solution.model().views.as_slice() else { return String::new() };
    let (pose, size) = (&first.pose, first.size);
    // All poses with the first as given, and one more that reverses it.
    let with_reversed = |p: &Pose| {
        let mut poses = vec![*p, reversed(p, size)];
        poses.extend(others.iter().map(|v| v.pose));
        solution.predict(&poses).map(|s| s.worst())
    };
    let now = percent(sigma);
    let (again, all) = if others.is_empty() { ("a second time", "both") } else { ("once more", "all") };
    let second =
        with_reversed(pose).filter(|s| *s < if others.is_empty() { 1.0 } else { WORTH_ANOTHER } * sigma);
    let tilt_more = || best_tilt(solution).filter(|t| t.sigma < sigma.min(Verdict::WEAK_BELOW));
    if sigma >= Verdict::FAIR_BELOW
        && others.is_empty()
        && let Some(t) = tilt_more()
    {
        let pair = with_reversed(&t.pose)
            .filter(|s| *s < t.sigma)
            .map(|s| format!(", and a second photograph with the tilt reversed brings it to {}", percent(s)));
        return format!(
            "tilt the sheet by 15° more about its {} axis: that brings σ of the focal length to {}{}",
            t.axis,
            percent(t.sigma),
            pair.unwrap_or_default()
        );
    }
    match second {
        Some(s) => format!(
            "photograph the sheet {again} with its tilt reversed, and calibrate from {all} photographs: that brings σ of the \
             focal length from {now} to {}",
            percent(s)
        ),
        None if sigma >= Verdict::FAIR_BELOW => {
            "give the principal points or a known camera, or photograph the sheet in other poses".into()
        }
        None => format!("more photographs would change little: σ of the focal length is {now}"),
    }
}

/// The pose with another rotation about the sheet's centre.
fn about_centre(pose: &Pose, size: RectangleSize, rotation: Rotation3<f64>) -> Pose {
    let turned = Pose { rotation, translation: Vector3::zeros() };
    Pose { rotation, translation: pose.lift(size.centre()) - turned.lift(size.centre()) }
}

/// The pose turned about an axis of the camera frame through the sheet's centre.
fn turned(pose: &Pose, size: RectangleSize, axis: Unit<Vector3<f64>>, angle: f64) -> Pose {
    about_centre(pose, size, Rotation3::from_axis_angle(&axis, angle) * pose.rotation)
}

/// The pose with the tilt reversed about both axes, the roll and the sheet's centre kept.
fn reversed(pose: &Pose, size: RectangleSize) -> Pose {
    let half_turn = Matrix3::from_diagonal(&Vector3::new(-1.0, -1.0, 1.0));
    let rotation = Rotation3::from_matrix_unchecked(half_turn * pose.rotation.matrix() * half_turn);
    about_centre(pose, size, rotation)
}

/// Tilt of the sheet against the image plane: in all, about the camera's horizontal axis, about its vertical axis; rad.
pub(crate) fn tilt(pose: &Pose) -> [f64; 3] {
    let n = pose.rotation * Vector3::z();
    [n.xy().norm().atan2(n.z), (-n.y).atan2(n.z), n.x.atan2(n.z)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn per_cent_have_two_digits() {
        let shown = [0.000_15, 0.054, 0.45, 3.2, 81.0, 0.0].map(percent);
        assert_eq!(shown, ["0.015 %", "5.4 %", "45 %", "320 %", "more than 1000 %", "0 %"]);
    }
}
