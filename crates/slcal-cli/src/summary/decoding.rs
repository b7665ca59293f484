//! What decoding saw.

use slcal_core::decode::{DecodeReport, ScanDirection};

use crate::output::{BOLD, FAIR, TextLayout, unbroken};

/// Above this share of clipped stripes the user is told to expose less.
const SATURATED_SHARE: f64 = 0.05;
/// Above this share of bright stripes without a number the pattern is doubted: the right one leaves 2 % in a clean
/// photograph and 18 % in a compressed one of a head; a pattern that shares parts of the code, on surfaces too broken for
/// decoding to refuse it, mostly 28 % to 80 %.
const UNNUMBERED_SHARE: f64 = 0.25;
/// Channels that spill more than this into each other are told: hues get closer.
const CROSSTALK_SHARE: f64 = 0.1;
/// Above this noise, in 8-bit grey levels, centres are told to be the worse for it.
const NOISE_LEVELS: f64 = 4.0;

/// What decoding saw and why it left some of it out.
pub(crate) fn decoding(report: &DecodeReport) -> String {
    let mut layout = TextLayout::new();
    add_counts(&mut layout, report);
    add_remarks(&mut layout, report);
    layout.into_text()
}

/// Of the crossings that were seen.
pub(super) fn decoded_percent(report: &DecodeReport) -> f64 {
    100.0 * report.decoded as f64 / report.crossings.max(1) as f64
}

/// The numbers.
pub(super) fn add_counts(layout: &mut TextLayout, report: &DecodeReport) {
    let share = decoded_percent(report);
    let parts = [
        format!("{} crossings seen,", report.crossings),
        format!("{} decoded ({share:.1} %),", report.decoded),
        format!("{} different slits,", report.slits),
        format!("{:.1} px wide", report.stripe_width_px),
    ];
    layout.line("stripes", parts.map(|p| unbroken(&p)).join(" "));
    let d = &report.rejected;
    let parts = [
        format!("{} weak,", d.low_contrast),
        format!("{} ambiguous,", d.ambiguous),
        format!("{} inconsistent,", d.duplicate),
        format!("{} cut,", d.truncated),
        format!("{} unsure", d.low_confidence),
    ];
    layout.line("dropped", parts.map(|p| unbroken(&p)).join(" "));
}

/// What to know or to do.
pub(super) fn add_remarks(layout: &mut TextLayout, report: &DecodeReport) {
    for (label, remark) in remarks(report) {
        layout.styled_line(if label == "warning" { FAIR } else { BOLD }, label, remark);
    }
}

/// What the user should know or do about a photograph of stripes: "warning" or "note", and the sentence.
pub(crate) fn remarks(report: &DecodeReport) -> Vec<(&'static str, String)> {
    let mut remarks = Vec::new();
    if report.saturated > SATURATED_SHARE {
        let percent = 100.0 * report.saturated;
        let sentence = format!(
            "{percent:.0} % of the crossings are overexposed and their colours unreliable: expose less"
        );
        remarks.push(("warning", sentence));
    }
    let bright = report.crossings.saturating_sub(report.rejected.low_contrast).max(1);
    let unnumbered = report.rejected.ambiguous as f64 / bright as f64;
    if unnumbered > UNNUMBERED_SHARE {
        let percent = 100.0 * unnumbered;
        let sentence = format!(
            "{percent:.0} % of the stripes have no place in the code: is the pattern file the one that was projected?"
        );
        remarks.push(("warning", sentence));
    }
    if report.reversed {
        let sentence = "the slits run backwards: the projector stands upside down or behind a mirror";
        remarks.push(("note", sentence.to_owned()));
    }
    if report.turned {
        let way = match report.lines {
            ScanDirection::Rows => "down",
            ScanDirection::Columns => "across",
        };
        let sentence = format!(
            "the stripes run {way} the photograph, a quarter turn from the pattern's: the camera or the projector is turned"
        );
        remarks.push(("note", sentence));
    }
    if let Some((into, of, share)) = largest_crosstalk(report)
        && share > CROSSTALK_SHARE
    {
        let percent = 100.0 * share;
        let sentence = format!("crosstalk: the camera's {into} sees {percent:.0} % of the projector's {of}");
        remarks.push(("note", sentence));
    }
    if report.noise_levels > NOISE_LEVELS {
        let sentence = format!(
            "noise of {:.1} grey levels (1σ) scatters the centres: more light or a lower gain makes them surer",
            report.noise_levels
        );
        remarks.push(("note", sentence));
    }
    remarks
}

/// The camera's channel that sees most of another primary's light, that primary, and the share.
fn largest_crosstalk(report: &DecodeReport) -> Option<(&'static str, &'static str, f64)> {
    const NAMES: [&str; 3] = ["red", "green", "blue"];
    let matrix = report.crosstalk.as_ref()?;
    let others = (0..9).map(|i| (i / 3, i % 3)).filter(|(row, column)| row != column);
    others
        .map(|(row, column)| (NAMES[row], NAMES[column], matrix[row][column]))
        .max_by(|a, b| a.2.total_cmp(&b.2))
}

#[cfg(test)]
mod tests {
    use slcal_core::decode::Rejected;

    use super::*;

    #[test]
    fn remarks_say_what_is_out_of_the_ordinary_and_nothing_else() {
        let plain = DecodeReport {
            crosstalk: Some([[1.0, 0.05, 0.0], [0.02, 1.0, 0.08], [0.0, 0.03, 1.0]]),
            noise_levels: 1.2,
            ..DecodeReport::default()
        };
        assert!(remarks(&plain).is_empty());
        let odd = DecodeReport {
            crosstalk: Some([[1.0, 0.2, 0.0], [0.02, 1.0, 0.08], [0.0, 0.31, 1.0]]),
            noise_levels: 7.0,
            turned: true,
            lines: ScanDirection::Columns,
            crossings: 45_000,
            rejected: Rejected { low_contrast: 5, ambiguous: 16_200, ..Rejected::default() },
            ..plain
        };
        let said: Vec<String> = remarks(&odd).into_iter().map(|(_, s)| s).collect();
        assert_eq!(said.len(), 4);
        assert!(said[0].contains("36 % of the stripes") && said[0].contains("pattern file"));
        assert!(said[1].contains("run across the photograph"));
        assert!(said[2].contains("blue sees 31 % of the projector's green"));
        assert!(said[3].contains("7.0 grey levels"));
    }
}
