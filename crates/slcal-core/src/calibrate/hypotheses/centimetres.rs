//! Whether the size of the sheet was given in centimetres where millimetres are meant.

use crate::observations::Observations;
use crate::rig::Warning;

/// The question, for the first sheet whose size looks like centimetres. The photographs cannot answer it, because a common
/// factor of all lengths changes no pixel.
pub(crate) fn hint(observations: &Observations) -> Option<Warning> {
    let (size, larger) = observations.views.iter().find_map(|v| Some((v.size, v.size.in_centimetres()?)))?;
    Some(Warning {
        code: "size-in-centimetres".to_owned(),
        message: format!(
            "the sheet is {:.1} x {:.1} mm: was its size measured in centimetres?",
            size.width_mm, size.height_mm
        ),
        advice: format!(
            "if it is {:.0} x {:.0} mm, calibrate again with that size, because all lengths are ten times too small now; \
             otherwise ignore this",
            larger.width_mm, larger.height_mm
        ),
    })
}
