//! Recognises patterns of touching stripes: another family of coloured patterns, without dark bands between the stripes, which this
//! decoder does not read.

use super::noise::Noise;
use super::scanlines::{Scanline, ScanlineReader};
use super::stripe_edges::{Scratch, peaks_of};
use super::tracks::same_hue;
use crate::error::{Error, ErrorSubject};

/// Scanlines that are sampled, and valleys on them that are enough.
const LINES: usize = 12;
const MIN_VALLEYS: usize = 40;
/// Between touching stripes the light stays above this share of theirs,
const MIN_LIGHT: f32 = 0.2;
/// and has a colour: the weakest channel has at most this share of the strongest. Room light, which fills dark bands too,
/// has little.
const MAX_GREY: f32 = 0.5;
/// Share of the valleys that are so, between bands of different hues: a coloured surface has many that are alike.
const MOST: f32 = 0.6;

/// Whether the valleys between bright bands are bright and coloured themselves.
pub(super) fn stripes_touch(reader: &ScanlineReader<'_>, noise: &Noise) -> bool {
    let (mut line, mut scratch) = (Scanline::default(), Scratch::default());
    let (mut valleys, mut lit) = (0_usize, 0_usize);
    let lines = LINES.min(reader.count());
    for k in 0..lines {
        reader.read(reader.spread(k, lines), &mut line);
        let peaks = peaks_of(&line.total, 1, noise, &mut scratch);
        for pair in peaks.windows(2) {
            let lower = line.total[pair[0].top as usize].min(line.total[pair[1].top as usize]);
            let valley = line.rgb[pair[1].before as usize];
            let (weakest, strongest) =
                valley.iter().fold((f32::INFINITY, 0.0_f32), |(l, h), &c| (l.min(c), h.max(c)));
            valleys += 1;
            let bright = line.total[pair[1].before as usize] > MIN_LIGHT * lower;
            let hues_differ = !same_hue(line.rgb[pair[0].top as usize], line.rgb[pair[1].top as usize]);
            lit += usize::from(bright && weakest < MAX_GREY * strongest && hues_differ);
        }
    }
    valleys >= MIN_VALLEYS && lit as f32 > MOST * valleys as f32
}

pub(super) fn touching() -> Error {
    Error::NotFound {
        what: ErrorSubject::Stripes,
        seen: "coloured stripes that touch, without dark bands between them".into(),
        advice: "project a pattern with black between the stripes; patterns of touching stripes are another family, which is not decoded".into(),
    }
}
