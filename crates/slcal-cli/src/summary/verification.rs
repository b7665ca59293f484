//! How square a projection is, and whether the rig has moved.

use std::fmt::Write as _;

use slcal_core::verify::{Change, Measured, SheetCheck, Verification};

use super::number::unsigned;
use crate::output::{BAD, GOOD, TextLayout, styled, unbroken};

/// A keystone below this is not seen by the eye, degrees: 1 mm over 0.6 m.
const UNSEEN_DEG: f64 = 0.1;

/// An angle in degrees with two digits of its σ.
fn degrees(m: Measured) -> String {
    let (value, sigma) = (m.value.to_degrees(), m.sigma.to_degrees());
    unbroken(&format!("{:.d$}° ± {sigma:.d$}°", unsigned(value, digits(sigma)), d = digits(sigma)))
}

/// Decimals that show two digits of a σ, and no more than anybody needs.
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

/// Whether anything has moved, then how square the projection is.
pub(crate) fn verification(v: &Verification, as_drawn: bool) -> String {
    let mut layout = TextLayout::new();
    layout.line("rig", rig_in_words(v));
    if let Some(sheet) = &v.sheet {
        layout.line("sheet", sheet_in_words(v, sheet, as_drawn));
    }
    layout.gap();
    let k = &v.keystone;
    layout.line("keystone", format!("{} at worst", degrees(k.worst_rad)));
    let sides = ["top", "right", "bottom", "left"].iter().zip(&k.sides_rad);
    let sides: Vec<String> =
        sides.map(|(name, side)| unbroken(&format!("{name} {:.3}°", side.value.to_degrees()))).collect();
    layout.line("", format!("{} against the sheet's sides, clockwise counts up", sides.join(", ")));
    layout.line("turned", format!("by {}", degrees(k.rotation_rad)));
    layout.line(
        "aspect",
        format!(
            "width to height off by {}",
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
            "stands {:.1} mm from its place in the rig's first view, which does no harm here",
            s.shift_mm
        );
    }
    format!(
        "{} by {:.1} mm and turned by {:.2}° ({}): {}",
        styled(BAD, "has moved"),
        s.shift_mm,
        s.turn_rad.to_degrees(),
        probability(s.p_value),
        if v.keystone.worst_rad.value.to_degrees().abs() < UNSEEN_DEG {
            "the picture is still square to the eye"
        } else {
            "calibrate with the sheet where it is now, and rectify again"
        }
    )
}

/// Whether the rig has moved, and what of it.
pub(crate) fn rig_in_words(v: &Verification) -> String {
    let r = &v.rig;
    if !r.moved {
        return format!(
            "{} ({}); the pattern lies within {:.2} mm (rms) of where the rig puts it",
            styled(GOOD, "has not moved"),
            probability(r.p_value),
            r.pattern_off_mm
        );
    }
    let percent = |m: Measured| unbroken(&format!("{:+.2} % ± {:.2} %", 100.0 * m.value, 100.0 * m.sigma));
    let what = match r.change {
        Some(Change::Moved { turn_rad, shift_mm }) => format!(
            "projector moved against the camera: turned by {}, shifted by {:.1} ± {:.1} mm",
            degrees(turn_rad),
            shift_mm.value,
            shift_mm.sigma
        ),
        Some(Change::ProjectorFocal(m)) => {
            format!(
                "the projector's focal length has changed by {}: its zoom or focus was turned",
                percent(m)
            )
        }
        Some(Change::CameraFocal(m)) => {
            format!("the camera's focal length has changed by {}: its zoom or focus was turned", percent(m))
        }
        Some(Change::Several) | None => {
            "more than one thing has changed, or the photograph is not by this rig, or the pattern is not projected as said (rectified, \
             or with --as-drawn as it was drawn)"
                .into()
        }
    };
    format!(
        "{}: {what} ({}); the pattern lies {:.1} mm (rms) from where the rig puts it; calibrate again",
        styled(BAD, "has moved"),
        probability(r.p_value),
        r.pattern_off_mm
    )
}

fn test_in_words(v: &Verification) -> String {
    let mut text = format!(
        "at a significance of {} %: so often would an unmoved rig be called moved",
        100.0 * v.significance
    );
    if !v.with_covariance {
        text.push_str(
            "; the rig has no covariance, so that only the noise of the photograph counts: an uncertain rig \
                       looks moved",
        );
    }
    let worst = v.widened[0].max(v.widened[1]);
    if worst > 3.0 {
        let _ = write!(
            text,
            "; what was seen scatters {worst:.1} times more than its noise explains, which weakens the test"
        );
    }
    text
}
