//! Whether a sequence shows a scene under its pattern at all.

use super::report::SequenceDecodeReport;
use crate::dense_matches::DenseMatches;
use crate::error::{Error, ErrorSubject, Result};
use crate::solve::median;

/// The projector lights at least this share of the pixels.
const LEAST_LIT: f64 = 1e-4;
/// Displacements are looked at in about this many pixels, spread evenly.
const SAMPLE: usize = 1 << 14;

/// Refuses the pictures of the pattern themselves, and screenshots of them: every pixel sees the light of its own place.
pub(super) fn check_parallax(matches: &DenseMatches, panel: [u32; 2]) -> Result<()> {
    if panel != [matches.width as u32, matches.height as u32] {
        return Ok(());
    }
    let own = |of: &[f32], place: &dyn Fn(usize) -> usize| {
        let step = of.len().div_ceil(SAMPLE).max(1);
        let known = (0..of.len()).step_by(step).filter(|i| of[*i].is_finite());
        let mut off: Vec<f64> = known.map(|i| f64::from((of[i] - place(i) as f32).abs())).collect();
        median(&mut off).is_none_or(|m| m < 0.5)
    };
    let is_own = own(&matches.column, &|i| i % matches.width) && own(&matches.row, &|i| i / matches.width);
    if !is_own {
        return Ok(());
    }
    Err(Error::NotFound {
        what: ErrorSubject::Named("a scene under the pattern"),
        seen: "frames in which every pixel shows the pattern's pixel of the same place: there is no parallax"
            .into(),
        advice: "give photographs that a camera took of the scene, not the pictures that are projected"
            .into(),
    })
}

/// Refuses sequences of which nothing can be read.
pub(super) fn check_seen(report: &SequenceDecodeReport) -> Result<()> {
    // Noise alone is beyond the threshold on one pixel in a million.
    let is_dark = (report.lit as f64) < LEAST_LIT * report.pixels as f64 && report.decoded == 0;
    if report.lit == 0 || is_dark {
        return Err(Error::NotFound {
            what: ErrorSubject::Named("the light of the projector"),
            seen: format!("{} frames that are alike, but for noise, on all but {} of {} pixels", report.frames, report.lit, report.pixels),
            advice: "check that the frames are photographs of the scene, that the projector showed the pictures while they were taken, and that they are exposed well".into(),
        });
    }
    if report.decoded == 0 {
        return Err(Error::NotFound {
            what: ErrorSubject::Named("the code of the sequence"),
            seen: format!(
                "{} lit pixels, of which {} have undecided bits or no amplitude and {} have bits that mean no place on the panel",
                report.lit, report.undecided, report.contradicting
            ),
            advice: "check that the pattern file is that of these frames, and that frames are in its order"
                .into(),
        });
    }
    Ok(())
}
