//! How much of the lit sheet is blown out: pixels at the end of the sensor's or the file's range.

use nalgebra::Point2;

use crate::photo::{PhotoView, Samples};
use crate::rig::Warning;

/// Rows and columns of the grid of samples on the sheet. A share of a hundredth is then known to a tenth of itself.
const GRID: usize = 160;
/// Codes of 8 bit from this one on are at the end of the range: JPEG and sharpening scatter them a little.
const FULL_BYTE: u8 = 254;
/// Largest codes of sensors with 10, 12 and 14 bit in files of 16 bit that were not scaled.
const SENSOR_FULL: [u16; 3] = [1023, 4095, 16383];
/// Of the brightest samples this share is left out of what counts as the sheet's brightness: reflections.
const REFLECTIONS: f64 = 0.05;
/// Pixels are lit that have more than this part of the sheet's brightness, in code values: the dark squares of a checkerboard
/// have less.
const LIT: f64 = 0.5;

/// From this share on edges suffer. Where the white beside an edge is clipped, the edge looks displaced into the dark by a part
/// of its blur, which tilts and bends sides that are clipped in part. In renders of two photographs with reversed tilts (blur
/// of 0.6 and 1.2 px) 0.1 % of the lit sheet cost nothing, 11 % moved the focal length by 0.1 and 0.3 %, 26 to 45 % by
/// 0.3 and 0.7 %; what is clipped altogether costs less again.
const BLOWN_OUT: f64 = 0.05;

/// The share of samples (each channel of a pixel is one) of the lit part of the sheet that are clipped, 0–1. `corners` are the
/// sheet's, px; what lies outside the frame does not count.
pub(super) fn clipped_share(photo: &PhotoView<'_>, corners: &[Point2<f64>; 4]) -> f64 {
    // Where exactly between the corners a sample lies does not matter.
    let between = |u: f64, v: f64| {
        let along = |a: usize, b: usize| corners[a] + (corners[b] - corners[a]) * u;
        along(0, 1) + (along(3, 2) - along(0, 1)) * v
    };
    let pixel = |p: Point2<f64>| {
        let within = |v: f64, count: usize| v >= 0.0 && v <= count as f64 - 1.0;
        (within(p.x, photo.width()) && within(p.y, photo.height()))
            .then(|| photo.rgb_codes(p.x.round() as usize, p.y.round() as usize))
    };
    let place = |k: usize| (k as f64 + 0.5) / GRID as f64;
    let places = (0..GRID * GRID).map(|i| between(place(i % GRID), place(i / GRID)));
    let pixels: Vec<[u16; 3]> = places.filter_map(pixel).collect();
    let full = full_scale(photo, &pixels);
    let sum = |p: &[u16; 3]| p.iter().map(|c| u32::from(*c)).sum::<u32>();
    let mut brightness: Vec<u32> = pixels.iter().map(sum).collect();
    brightness.sort_unstable();
    let Some(bright) = brightness.get((brightness.len() as f64 * (1.0 - REFLECTIONS)) as usize) else {
        return 0.0;
    };
    let lit = pixels.iter().filter(|p| f64::from(sum(p)) > LIT * f64::from(*bright));
    let [clipped, all] = lit.fold([0, 0], |[clipped, all], p| {
        [clipped + p.iter().filter(|c| **c >= full).count(), all + p.len()]
    });
    clipped as f64 / all.max(1) as f64
}

/// The smallest code that counts as clipped.
fn full_scale(photo: &PhotoView<'_>, pixels: &[[u16; 3]]) -> u16 {
    match photo.samples() {
        Samples::U8(_) => u16::from(FULL_BYTE),
        Samples::U16(_) => {
            let most = pixels.iter().flatten().copied().max().unwrap_or(0);
            if SENSOR_FULL.contains(&most) { most } else { u16::from(FULL_BYTE) * 257 }
        }
    }
}

/// Code of the warning.
pub(crate) const CLIPPED: &str = "clipped";
/// By how much a sheet that is clipped in part may move a focal length, per cent: the most that was found in renders.
pub(crate) const CLIPPED_COST_PERCENT: f64 = 0.7;

/// The warning about a sheet of which this share is clipped.
pub(super) fn clipped_warning(share: f64) -> Option<Warning> {
    (share > BLOWN_OUT).then(|| {
        Warning::new(
            CLIPPED,
            format!(
                "{:.0} % of the lit sheet is overexposed (at the end of the photograph's range): its edges and the corners of the pattern \
                 look displaced there, and may move the focal lengths by up to {CLIPPED_COST_PERCENT} % and the principal points by \
                 up to 1 % of the width",
                100.0 * share
            ),
            "take the photograph again with less exposure (a shorter time, a smaller aperture or a lower ISO; on a phone, pull the \
             brightness down) until the white of the sheet is light grey; where the exposure cannot be set, dim the projector or the room",
        )
    })
}
