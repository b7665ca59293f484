//! What decoding found in a photograph of stripes.

use slcal_core::decode::{ChannelShift, DecodeReport, ScanDirection};

use crate::output::{BOLD, FAIR, TextLayout, unbroken};

/// A warning above this share of overexposed crossings.
const SATURATED_SHARE: f64 = 0.05;
/// A warning above this share of ambiguous crossings among those with enough contrast: the pattern may be another one. The right one
/// leaves 2 % in a clean photograph and 18 % in a compressed one of a head. A pattern that shares parts of the code leaves 28 % to 80 %
/// on most surfaces that are too broken for decoding to refuse it.
const AMBIGUOUS_SHARE: f64 = 0.25;
/// A note from this displacement of red and blue on, in σ, and this magnification.
const SHIFT_SIGMAS: f64 = 3.0;
const MAGNIFIED: f64 = 3e-4;
/// A note from this crosstalk between channels on: it brings hues closer together.
const CROSSTALK_SHARE: f64 = 0.1;
/// A note above this noise, 8-bit grey levels: it scatters the stripes' centres.
const NOISE_LEVELS: f64 = 4.0;

/// Counts of decoded and rejected crossings, then warnings and notes.
pub(crate) fn decoding(report: &DecodeReport) -> String {
    let mut layout = TextLayout::new();
    add_counts(&mut layout, report);
    add_remarks(&mut layout, report);
    layout.into_text()
}

/// The share of decoded crossings, per cent.
pub(super) fn decoded_percent(report: &DecodeReport) -> f64 {
    100.0 * report.decoded as f64 / report.crossings.max(1) as f64
}

/// Counts of decoded and rejected crossings.
pub(super) fn add_counts(layout: &mut TextLayout, report: &DecodeReport) {
    let share = decoded_percent(report);
    let parts = [
        format!("{} stripe crossings on scanlines,", report.crossings),
        format!("{} decoded ({share:.1} %),", report.decoded),
        format!("{} different slits,", report.slits),
        format!("median width {:.1} px", report.stripe_width_px),
    ];
    layout.line("stripes", parts.map(|p| unbroken(&p)).join(" "));
    let reasons = report.rejected.reasons().map(|(reason, count)| unbroken(&format!("{reason} {count}")));
    layout.line("rejected", reasons.join(", "));
}

/// Warnings and notes.
pub(super) fn add_remarks(layout: &mut TextLayout, report: &DecodeReport) {
    for (label, remark) in remarks(report) {
        layout.styled_line(if label == "warning" { FAIR } else { BOLD }, label, remark);
    }
}

/// Warnings and notes on a photograph of stripes: the label ("warning", "note") and the sentence.
pub(crate) fn remarks(report: &DecodeReport) -> Vec<(&'static str, String)> {
    let mut remarks = Vec::new();
    if report.saturated > SATURATED_SHARE {
        let percent = 100.0 * report.saturated;
        let sentence = format!(
            "{percent:.0} % of the stripe crossings are overexposed, so their colours are unreliable: expose less"
        );
        remarks.push(("warning", sentence));
    }
    let with_contrast = report.crossings.saturating_sub(report.rejected.low_contrast).max(1);
    let ambiguous = report.rejected.ambiguous as f64 / with_contrast as f64;
    if ambiguous > AMBIGUOUS_SHARE {
        let percent = 100.0 * ambiguous;
        let sentence = format!(
            "{percent:.0} % of the stripe crossings fit no place in the code: is the pattern file the one that was projected?"
        );
        remarks.push(("warning", sentence));
    }
    if report.reversed {
        let sentence = "the slits are in reverse order: the projector is upside down, or there is a mirror";
        remarks.push(("note", sentence.to_owned()));
    }
    if report.turned {
        let way = match report.lines {
            ScanDirection::Rows => "down",
            ScanDirection::Columns => "across",
        };
        let sentence = format!(
            "the stripes run {way} the photograph, rotated by 90° from the pattern: the camera or the projector is rotated"
        );
        remarks.push(("note", sentence));
    }
    if let Some(shift) = report.channel_shift.filter(is_worth_telling) {
        let [red, blue] = shift.sigma_px;
        let [r, b] = shift.radial.map(|r| 1e4 * r);
        let sentence = format!(
            "red is seen {:+.2} ± {red:.2} and blue {:+.2} ± {blue:.2} projector px beside green, and the lens magnifies them by              {r:+.1} and {b:+.1} parts in 10,000 more; that is removed",
            shift.red_px, shift.blue_px
        );
        remarks.push(("note", sentence));
    }
    if let Some((into, of, share)) = largest_crosstalk(report)
        && share > CROSSTALK_SHARE
    {
        let percent = 100.0 * share;
        let sentence = format!(
            "crosstalk: the camera's {into} channel responds to {percent:.0} % of the projector's {of}"
        );
        remarks.push(("note", sentence));
    }
    if report.noise_levels > NOISE_LEVELS {
        let sentence = format!(
            "noise of {:.1} grey levels (1σ) scatters the stripes' centres: use more light or a lower gain",
            report.noise_levels
        );
        remarks.push(("note", sentence));
    }
    remarks
}

/// Displacements of a calibration are removed however small they are.
fn is_worth_telling(shift: &ChannelShift) -> bool {
    let shifts = [shift.red_px, shift.blue_px].into_iter().zip(shift.sigma_px);
    let shifted = shifts.into_iter().any(|(px, sigma)| px.abs() > SHIFT_SIGMAS * sigma);
    shift.used && (shifted || shift.radial.iter().any(|r| r.abs() > MAGNIFIED))
}

/// The largest crosstalk: the camera's channel, the projector's primary that it responds to, and the share.
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
    fn only_unusual_measures_are_remarked_upon() {
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
        let sentences: Vec<String> = remarks(&odd).into_iter().map(|(_, s)| s).collect();
        assert_eq!(sentences.len(), 4);
        assert!(
            sentences[0].contains("36 % of the stripe crossings") && sentences[0].contains("pattern file")
        );
        assert!(sentences[1].contains("run across the photograph"));
        assert!(sentences[2].contains("blue channel responds to 31 % of the projector's green"));
        assert!(sentences[3].contains("7.0 grey levels"));
    }
}
