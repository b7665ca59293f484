//! The keystone of a projection, and whether the rig has changed.

use std::fmt::Write as _;

use slcal_core::verify::{Change, Measured, SheetCheck, Verification};

use super::number::unsigned;
use crate::output::{BAD, GOOD, TextLayout, styled, unbroken};

/// A keystone below this is invisible, degrees: 1 mm over 0.6 m.
const INVISIBLE_DEG: f64 = 0.1;

/// An angle in degrees with two digits of σ.
fn degrees(m: Measured) -> String {
    let (value, sigma) = (m.value.to_degrees(), m.sigma.to_degrees());
    unbroken(&format!("{:.d$}° ± {sigma:.d$}°", unsigned(value, digits(sigma)), d = digits(sigma)))
}

/// Decimals that show two digits of σ, four at most.
fn digits(sigma: f64) -> usize {
    if sigma > 0.0 { (1.0 - sigma.log10().floor()).clamp(1.0, 4.0) as usize } else { 4 }
}

fn probability(p: f64) -> String {
    unbroken(&if p < 1e-6 {
        "p < 0.000001".into()
    } else {
        format!("p = {p:.*}", if p < 0.01 { 6 } else { 2 })
    })
}

/// Whether rig and sheet have moved, then the keystone.
pub(crate) fn verification(v: &Verification, as_drawn: bool) -> String {
    let mut layout = TextLayout::new();
    layout.line("rig", rig_in_words(v));
    if let Some(sheet) = v.sheet() {
        layout.line("sheet", sheet_in_words(v, sheet, as_drawn));
    }
    layout.gap();
    let k = v.keystone();
    layout.line("keystone", format!("{} for the worst side", degrees(k.worst_rad)));
    let sides = ["top", "right", "bottom", "left"].iter().zip(&k.sides_rad);
    let sides: Vec<String> =
        sides.map(|(name, side)| unbroken(&format!("{name} {:.3}°", side.value.to_degrees()))).collect();
    layout.line("", format!("{} against the sheet's sides, clockwise positive", sides.join(", ")));
    layout.line("rotation", degrees(k.rotation_rad));
    layout.line(
        "aspect",
        format!(
            "width to height differs by {}",
            unbroken(&format!("{:.3} % ± {:.3} %", 100.0 * k.aspect.value, 100.0 * k.aspect.sigma))
        ),
    );
    layout.line("test", test_in_words(v));
    layout.into_text()
}

fn sheet_in_words(v: &Verification, s: &SheetCheck, as_drawn: bool) -> String {
    if !s.moved {
        return format!("{} ({})", styled(GOOD, "has not moved"), probability(s.p_value));
    }
    if as_drawn {
        return format!(
            "{:.1} mm from its place in the rig's first view, which does not matter with --as-drawn",
            s.shift_mm
        );
    }
    format!(
        "{} by {:.1} mm and rotated by {:.2}° ({}): {}",
        styled(BAD, "has moved"),
        s.shift_mm,
        s.turn_rad.to_degrees(),
        probability(s.p_value),
        if v.worst_keystone_rad().0.to_degrees().abs() < INVISIBLE_DEG {
            "the picture still looks square"
        } else {
            "calibrate with the sheet where it is now, and rectify again"
        }
    )
}

/// Whether the rig has changed, and how.
pub(crate) fn rig_in_words(v: &Verification) -> String {
    let r = v.rig();
    if !r.moved {
        return format!(
            "{} ({}); the pattern is {:.2} mm (rms) from where the rig predicts it",
            styled(GOOD, "has not moved"),
            probability(r.p_value),
            r.pattern_off_mm
        );
    }
    let percent = |m: Measured| unbroken(&format!("{:+.2} % ± {:.2} %", 100.0 * m.value, 100.0 * m.sigma));
    let what = match r.change {
        Some(Change::Moved { turn_rad, shift_mm }) => format!(
            "the projector moved relative to the camera: rotated by {}, shifted by {:.1} ± {:.1} mm",
            degrees(turn_rad),
            shift_mm.value,
            shift_mm.sigma
        ),
        Some(Change::ProjectorFocal(m)) => {
            format!(
                "the projector's focal length changed by {}: its zoom or focus was changed",
                percent(m)
            )
        }
        Some(Change::CameraFocal(m)) => {
            format!("the camera's focal length changed by {}: its zoom or focus was changed", percent(m))
        }
        Some(Change::Several) | None => {
            "several things have changed, or the photograph is from another rig, or the pattern was not projected as expected \
             (rectified, or with --as-drawn as drawn)"
                .into()
        }
    };
    format!(
        "{}: {what} ({}); the pattern is {:.1} mm (rms) from where the rig predicts it; calibrate again",
        styled(BAD, "has moved"),
        probability(r.p_value),
        r.pattern_off_mm
    )
}

fn test_in_words(v: &Verification) -> String {
    let mut text = format!(
        "significance level {} % (the false-alarm rate); ± is one standard deviation",
        100.0 * v.significance
    );
    if !v.with_covariance {
        text.push_str(
            "; the rig has no covariance, so the test counts only the noise of the photograph: an uncertain rig \
                       appears to have moved",
        );
    }
    let worst = v.widened[0].max(v.widened[1]);
    if worst > 3.0 {
        let _ = write!(
            text,
            "; the measurements scatter {worst:.1} times more than their noise explains, which weakens the test"
        );
    }
    text
}
