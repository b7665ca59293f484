//! What a calibration takes for given, and what it would cost if it were otherwise.

use serde::{Deserialize, Serialize};

/// How well an assumption is supported.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AssumptionStatus {
    /// Nothing in the photographs confirms it.
    Assumed,
    /// The photographs would contradict a departure of [`Assumption::if_off_by`] by five σ or more, and do not.
    Tested,
    /// The photographs determine the value themselves.
    Estimated,
}

/// By how much results move when an assumption is wrong, per cent, signed; `None` for what was not calibrated.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Moves {
    /// The camera's focal length.
    pub f_cam: Option<f64>,
    /// The projector's focal length.
    pub f_proj: Option<f64>,
    /// The distance between camera and projector, with which all lengths of point clouds grow.
    pub baseline: Option<f64>,
}

impl Moves {
    /// The largest of the three, without its sign.
    #[must_use]
    pub fn worst(&self) -> f64 {
        [self.f_cam, self.f_proj, self.baseline].into_iter().flatten().map(f64::abs).fold(0.0, f64::max)
    }
}

/// Something that a calibration takes for given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Assumption {
    /// Stable identifier.
    pub code: String,
    /// What is assumed, as a clause: "the camera's pixels are square".
    pub text: String,
    /// The value that is assumed, or estimated, in `unit`.
    pub value: f64,
    /// Unit of `value`, `sigma` and `if_off_by`; the name of a quantity that has none.
    pub unit: String,
    /// 1σ of the value: what was assumed of it, or what the photographs say; `None` where it is taken for exact.
    pub sigma: Option<f64>,
    /// An ordinary departure from the value.
    pub if_off_by: f64,
    /// By how much the results would move if the value were off by that, to the side that costs more. Found by solving
    /// again.
    pub moves_percent: Moves,
    /// How well it is supported.
    pub status: AssumptionStatus,
}

impl Assumption {
    /// What a departure would do to what it moves most, as a clause: "5 % of the width would move the projector's focal
    /// length by 5.4 %".
    #[must_use]
    pub fn cost(&self) -> String {
        let m = &self.moves_percent;
        let parts = [
            ("the camera's focal length", m.f_cam),
            ("the projector's focal length", m.f_proj),
            ("the baseline", m.baseline),
        ];
        let worst = parts.into_iter().filter_map(|(name, v)| Some((name, v?.abs())));
        let (what, by) = worst.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or(("nothing", 0.0));
        let digits = if by < 0.1 {
            3
        } else if by < 1.0 {
            2
        } else {
            1
        };
        format!("{} would move {what} by {by:.digits$} %", self.departure())
    }

    fn departure(&self) -> String {
        let off = format!("{}", (self.if_off_by * 1e4).round() / 1e4);
        match self.code.as_str() {
            "projector-undistorted" => format!("a k1 of {off}"),
            "sheet-flat" => format!("a curl of {:.1} mm", self.if_off_by),
            "size" => format!("a width that is {:.1} mm off", self.if_off_by),
            "steady-light" => format!("bands of light that shift edges by {off} px"),
            "shown-1:1" => format!("a picture that is scaled by {off} %"),
            "square-pixels-camera" | "square-pixels-projector" => {
                format!("a ratio that is {} % off", (self.if_off_by / self.value * 1e3).round() / 10.0)
            }
            _ => format!("{off} {}", self.unit),
        }
    }

    /// What checks it: "a second photograph with the tilt reversed".
    #[must_use]
    pub fn check(&self) -> &'static str {
        match self.code.as_str() {
            "size" => "a ruler",
            "sheet-flat" => "a straightedge, or a stiff board",
            "shown-1:1" => {
                "the border of the picture lies where the light of the projector ends; a pattern with marks, seen on the sheet"
            }
            "steady-light" => "a photograph that is exposed for a whole number of mains periods",
            _ => "a second photograph with the tilt reversed",
        }
    }
}
