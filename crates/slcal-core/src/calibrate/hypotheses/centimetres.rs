//! Whether the size of the sheet was given in centimetres, inches or metres where millimetres are meant.

use crate::observations::Observations;
use crate::rig::Warning;

/// The question, for the first sheet whose size looks like one in another unit. The photographs cannot answer it, because a
/// common factor of all lengths changes no pixel.
pub(crate) fn hint(observations: &Observations) -> Option<Warning> {
    let asked = observations.views.iter().find_map(|v| {
        let likely = v.size.likely_units();
        (!likely.is_empty()).then_some((v.size, likely))
    });
    let (size, likely) = asked?;
    let units: Vec<&str> = likely.iter().map(|(unit, _)| *unit).collect();
    let sizes: Vec<String> = likely
        .iter()
        .map(|(unit, s)| format!("{:.0} x {:.0} mm ({unit})", s.width_mm, s.height_mm))
        .collect();
    Some(Warning::new(
        &format!("size-in-{}", units[0]),
        format!(
            "the sheet is {:.1} x {:.1} mm: was its size measured in {}?",
            size.width_mm,
            size.height_mm,
            units.join(" or ")
        ),
        format!(
            "if it is {}, calibrate again with that size, because all lengths are too small now by that factor; otherwise ignore \
             this",
            sizes.join(" or ")
        ),
    ))
}
