//! What decoding found in the frames of a sequence.

use slcal_core::decode::SequenceDecodeReport;

use crate::output::{TextLayout, unbroken};

/// White of 8 bit: noise and contrast are told in its code values.
const CODE_VALUES: f64 = 255.0;

/// Counts of decoded pixels, σ, noise.
pub(crate) fn sequence(report: &SequenceDecodeReport) -> String {
    let mut layout = TextLayout::new();
    add_sequence(&mut layout, report);
    layout.into_text()
}

/// The share of the lit pixels that is decoded, per cent.
pub(super) fn sequence_percent(report: &SequenceDecodeReport) -> f64 {
    100.0 * report.decoded as f64 / report.lit.max(1) as f64
}

pub(super) fn add_sequence(layout: &mut TextLayout, report: &SequenceDecodeReport) {
    let parts = [
        format!("{} in {} frames,", report.pixels, report.frames),
        format!("{} lit by the projector,", report.lit),
        format!("{} decoded ({:.1} % of the lit)", report.decoded, sequence_percent(report)),
    ];
    layout.line("pixels", parts.map(|p| unbroken(&p)).join(" "));
    if report.undecided + report.contradicting > 0 {
        let parts = [
            unbroken(&format!("undecided {}", report.undecided)),
            unbroken(&format!("contradicting {}", report.contradicting)),
        ];
        layout.line("rejected", parts.join(", "));
    }
    let sigmas = [("columns", report.median_sigma_column_px), ("rows", report.median_sigma_row_px)];
    let known =
        sigmas.into_iter().filter_map(|(name, sigma)| Some(unbroken(&format!("{name} ± {:.3} px", sigma?))));
    layout.line("panel", known.collect::<Vec<_>>().join(", "));
    let contrast = report.contrast.map(|c| format!(", white less black {:.0}", c * CODE_VALUES));
    layout.line("noise", format!("{:.1} of 255{}", report.noise * CODE_VALUES, contrast.unwrap_or_default()));
}
