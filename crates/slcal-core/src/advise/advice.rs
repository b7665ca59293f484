//! What is advised.

use nalgebra::Point2;

use super::predicted_covariance::Predicted;
use crate::geometry::{Pose, RectangleSize};

/// A tilt with what a photograph under it would bring.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TiltPrediction {
    /// Turn about the camera's horizontal axis, rad; positive: the top side is nearer to the camera than the bottom.
    pub tilt_x_rad: f64,
    /// Turn about its vertical axis, rad; positive: the right side is nearer to the camera than the left.
    pub tilt_y_rad: f64,
    /// σ after one photograph; `None` where the sheet would leave the frame or the pattern the sheet, or be seen too flat.
    pub one: Option<Predicted>,
    /// σ after a second one with the tilt reversed as well.
    pub pair: Option<Predicted>,
}

/// A pose of the sheet to photograph.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct NextView {
    /// X_camera = R · X_sheet + t.
    pub camera_from_sheet: Pose,
    /// As in [`TiltPrediction`].
    pub tilt_x_rad: f64,
    /// As in [`TiltPrediction`].
    pub tilt_y_rad: f64,
    /// From the camera to the sheet's middle, mm.
    pub distance_mm: f64,
    /// Where the sheet's middle is seen, px.
    pub centre_px: Point2<f64>,
    /// What is known after it (with a second photograph, its tilt reversed, when it is the first one).
    pub after: Predicted,
}

impl NextView {
    /// How to hold the sheet, for a person: which side is nearer to the camera, by what angle and by how much. Sides are as
    /// the photograph shows them.
    #[must_use]
    pub fn in_words(&self, size: RectangleSize) -> String {
        let part = |angle: f64, positive: [&str; 2], length: f64, axis: &str| {
            let degrees = angle.to_degrees().round();
            if degrees == 0.0 {
                return None;
            }
            let [near, far] = if degrees > 0.0 { positive } else { [positive[1], positive[0]] };
            Some(format!(
                "its {near} side nearer to the camera than its {far} side by {:.0} mm (a tilt of {:.0}° about its {axis} axis)",
                length * angle.sin().abs(),
                degrees.abs()
            ))
        };
        let parts: Vec<String> = [
            part(self.tilt_y_rad, ["right", "left"], size.width_mm * self.tilt_x_rad.cos(), "vertical"),
            part(self.tilt_x_rad, ["top", "bottom"], size.height_mm, "horizontal"),
        ]
        .into_iter()
        .flatten()
        .collect();
        let held =
            if parts.is_empty() { "face-on".to_owned() } else { format!("with {}", parts.join(" and ")) };
        format!(
            "hold the sheet {held}, its middle {:.0} mm from the camera and at ({:.0}, {:.0}) px of the photograph",
            self.distance_mm, self.centre_px.x, self.centre_px.y
        )
    }
}

/// What to do next.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Advice {
    /// What is known now; `None` before the first photograph.
    pub now: Option<Predicted>,
    /// The sheet.
    pub size: RectangleSize,
    /// From the camera to its middle in the table, mm.
    pub distance_mm: f64,
    /// σ of the sheet's measurement (per corner, or per eighth of a side) and of a projected corner that the prediction assumes, px.
    pub noise_px: [f64; 2],
    /// Row by row: one tilt about the horizontal axis each, all tilts about the vertical axis in it.
    pub table: Vec<TiltPrediction>,
    /// The best pose that is possible; `None` when no pose is.
    pub next: Option<NextView>,
    /// Whether it is worth taking.
    pub worth_it: bool,
}
