//! What to do about a weak view, with numbers predicted from the Jacobian.

use nalgebra::{Unit, Vector3};

use super::joint::Joint;
use super::predict::{MORE_TILT, predict, reversed, tilt, turned};
use super::refine::Fit;
use crate::geometry::Pose;

/// The better of tilting the first view's sheet by 15° more about one of the camera's axes.
pub(crate) struct Tilt {
    pub(crate) axis: &'static str,
    pub(crate) sigma: f64,
    pose: Pose,
}

/// The tilt of 15° more that lowers the worst focal σ the most.
pub(crate) fn best_tilt(joint: &Joint, fit: &Fit) -> Option<Tilt> {
    let (pose, size) = (fit.model.views.first()?, *joint.sizes.first()?);
    let [_, about_x, about_y] = tilt(pose);
    let options = [("horizontal", Vector3::x_axis(), about_x), ("vertical", Vector3::y_axis(), about_y)];
    let tried = options.into_iter().filter_map(|(axis, direction, now): (_, Unit<Vector3<f64>>, f64)| {
        // More of the tilt that is there; from face-on either sign will do.
        let angle = if now < 0.0 { -MORE_TILT } else { MORE_TILT };
        let pose = turned(pose, size, direction, angle);
        Some(Tilt { axis, sigma: predict(joint, fit, &[pose])?.worst(), pose })
    });
    tried.min_by(|a, b| a.sigma.total_cmp(&b.sigma))
}

/// Per cent with two significant digits: "0.015 %", "5.4 %", "45 %".
pub(crate) fn percent(share: f64) -> String {
    let p = share * 100.0;
    if p >= 10.0 || p <= 0.0 {
        return format!("{p:.0} %");
    }
    let decimals = (1.0 - p.log10().floor()).clamp(1.0, 6.0) as usize;
    format!("{p:.decimals$} %")
}

/// One sentence of advice: what more tilt and what a second photograph with the tilt reversed would bring.
pub(crate) fn advise(joint: &Joint, fit: &Fit, sigma: f64, enough: bool) -> String {
    let (Some(pose), Some(&size)) = (fit.model.views.first(), joint.sizes.first()) else {
        return String::new();
    };
    let pair = |p: &Pose| predict(joint, fit, &[*p, reversed(p, size)]).map(|s| s.worst());
    let now = percent(sigma);
    if enough || joint.sizes.len() > 1 {
        return match pair(pose) {
            Some(s) if joint.sizes.len() == 1 && s < sigma => format!(
                "σ of the focal length is {now}; a second photograph with the tilt reversed brings it to {}",
                percent(s)
            ),
            _ => format!("σ of the focal length is {now}"),
        };
    }
    let better = best_tilt(joint, fit).filter(|t| t.sigma < sigma);
    match better {
        Some(t) => {
            let second = pair(&t.pose)
                .filter(|s| *s < t.sigma)
                .map(|s| {
                    format!(", add a second photograph with the tilt reversed and it falls to {}", percent(s))
                })
                .unwrap_or_default();
            format!(
                "tilt the sheet by 15° more about its {} axis and it falls to {}{second}",
                t.axis,
                percent(t.sigma)
            )
        }
        None => match pair(pose).filter(|s| *s < sigma) {
            Some(s) => {
                format!("add a second photograph with the tilt reversed and it falls to {}", percent(s))
            }
            None => {
                "give the principal points or a known camera, or photograph the sheet in other poses".into()
            }
        },
    }
}
