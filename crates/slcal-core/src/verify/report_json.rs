//! `slcal-verify/1`: how square a projection is, and whether the rig has moved.

use serde_json::{Value, json};

use super::{Change, Keystone, Measured, RigCheck, SheetCheck, Verification};

impl Verification {
    /// The record of this verification. `photo` is the name of the photograph, if it has one; `as_drawn` says that the pattern
    /// was projected as it was drawn, not rectified; `pattern_corners` is the number of corners of the whole pattern.
    #[must_use]
    pub fn to_json(&self, photo: Option<&str>, as_drawn: bool, pattern_corners: usize) -> Value {
        json!({
            "schema": "slcal-verify/1",
            "photo": photo,
            "pattern": if as_drawn { "as-drawn" } else { "rectified" },
            "significance": self.significance,
            "with_covariance": self.with_covariance,
            "keystone": keystone(&self.keystone),
            "rig": rig(&self.rig),
            "sheet": self.sheet.as_ref().map(sheet),
            "corners": self.corners,
            "pattern_corners": pattern_corners,
            "left_out": self.left_out,
            "noise_factor": { "sheet": self.widened[0], "pattern": self.widened[1] },
        })
    }
}

fn angle(m: Measured) -> Value {
    json!({ "value": m.value.to_degrees(), "sigma": m.sigma.to_degrees() })
}

fn plain(m: Measured) -> Value {
    json!({ "value": m.value, "sigma": m.sigma })
}

fn percent(m: Measured) -> Value {
    json!({ "value": 100.0 * m.value, "sigma": 100.0 * m.sigma })
}

fn keystone(k: &Keystone) -> Value {
    json!({
        "worst_deg": angle(k.worst_rad),
        "top_deg": angle(k.sides_rad[0]),
        "right_deg": angle(k.sides_rad[1]),
        "bottom_deg": angle(k.sides_rad[2]),
        "left_deg": angle(k.sides_rad[3]),
        "bottom_against_top_deg": angle(k.top_bottom_rad),
        "right_against_left_deg": angle(k.left_right_rad),
        "rotation_deg": angle(k.rotation_rad),
        "aspect_percent": percent(k.aspect),
        "corners_mm": k.corners_mm.map(|c| [c.x, c.y]),
    })
}

fn rig(r: &RigCheck) -> Value {
    let change = r.change.map(|c| match c {
        Change::Moved { turn_rad, shift_mm } => {
            json!({ "what": "projector-moved", "turn_deg": angle(turn_rad), "shift_mm": plain(shift_mm) })
        }
        Change::ProjectorFocal(m) => json!({ "what": "projector-focal", "focal_percent": percent(m) }),
        Change::CameraFocal(m) => json!({ "what": "camera-focal", "focal_percent": percent(m) }),
        Change::Several => json!({ "what": "several" }),
    });
    json!({
        "moved": r.moved,
        "p_value": r.p_value,
        "chi_squared": r.chi_squared,
        "degrees_of_freedom": r.freedom,
        "pattern_off_mm": r.pattern_off_mm,
        "corner_rms_px": { "under_rig": r.corner_rms_px[0], "projector_free": r.corner_rms_px[1] },
        "change": change,
    })
}

fn sheet(s: &SheetCheck) -> Value {
    json!({
        "moved": s.moved,
        "p_value": s.p_value,
        "chi_squared": s.chi_squared,
        "turn_deg": s.turn_rad.to_degrees(),
        "shift_mm": s.shift_mm,
        "largest_mm": s.largest_mm,
    })
}
