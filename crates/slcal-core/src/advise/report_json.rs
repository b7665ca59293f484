//! `slcal-advice/1`: which photograph to take next.

use serde_json::{Value, json};

use crate::advise::{Advice, NextView, Predicted};

impl Advice {
    /// The record as JSON. Angles are in degrees, lengths in mm; numbers that are not finite become null.
    #[must_use]
    pub fn to_json(&self) -> Value {
        json!({
            "schema": "slcal-advice/1",
            "size_mm": [self.size.width_mm, self.size.height_mm],
            "distance_mm": self.distance_mm,
            "noise_px": { "sheet": self.noise_px[0], "pattern": self.noise_px[1] },
            "sigma_now": self.now.map(figures),
            "table": self.table.iter().map(|t| json!({
                "tilt_about_horizontal_deg": t.tilt_x_rad.to_degrees(),
                "tilt_about_vertical_deg": t.tilt_y_rad.to_degrees(),
                "one": t.one.map(figures),
                "pair": t.pair.map(figures),
            })).collect::<Vec<_>>(),
            "next": self.next.as_ref().map(|n| pose(n, self)),
            "worth_it": self.worth_it,
        })
    }
}

fn figures(p: Predicted) -> Value {
    json!({
        "camera_focal_percent": 100.0 * p.camera_focal,
        "projector_focal_percent": p.projector_focal.map(|f| 100.0 * f),
        "projector_cy_px": p.projector_cy_px,
        "point_mm": p.point_mm,
    })
}

fn pose(next: &NextView, advice: &Advice) -> Value {
    let r = next.camera_from_sheet.rotation;
    let t = next.camera_from_sheet.translation;
    let rows = [0, 1, 2].map(|i| [r[(i, 0)], r[(i, 1)], r[(i, 2)]]);
    json!({
        "tilt_about_horizontal_deg": next.tilt_x_rad.to_degrees(),
        "tilt_about_vertical_deg": next.tilt_y_rad.to_degrees(),
        "distance_mm": next.distance_mm,
        "centre_px": [next.centre_px.x, next.centre_px.y],
        "camera_from_sheet": { "R": rows, "t": [t.x, t.y, t.z] },
        "in_words": next.in_words(advice.size),
        "then_reversed": advice.now.is_none(),
        "sigma_after": figures(next.after),
    })
}
