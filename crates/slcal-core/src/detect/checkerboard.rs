//! Detection and labelling of the projected checkerboard by `calib-targets`, over a range of scales.
//!
//! The labelled positions are 0.2–0.3 px from the truth; [`super::corner`] refines them.

use calib_targets_chessboard::{
    ChessboardDetector, ChessboardParams, DetectorConfig, GrayImageView, default_chess_config, detect_corners,
};
use nalgebra::Point2;

use super::downsampled::Downsampled;
use crate::photo::{Encoding, GreyImage, LinearPhoto};

/// A corner of a grid that is not registered to the pattern yet.
#[derive(Debug, Clone, Copy)]
pub(super) struct LabelledCorner {
    /// Column and row in the detector's own numbering.
    pub(super) label: [i32; 2],
    /// Position in the photograph, px.
    pub(super) position: Point2<f64>,
}

/// The corner detector samples a ring of 5 px radius, so squares of 20 to 60 px suit it best. Most boards have such squares
/// in the downsampled image. These multiples of its reduction are tried when the board is not detected there: finer ones
/// for small squares, a coarser one for blurred ones.
const OTHER_SCALES: [(usize, usize); 3] = [(1, 2), (1, 4), (2, 1)];

/// Corner strengths (in grey levels of the stretched image) below which corners are rejected, in the order of
/// the attempts: the detector's default for sharp boards first, then lower ones for blurred or faint boards.
const STRENGTH_FLOORS: [f32; 3] = [33.0, 12.0, 4.0];

/// All grids in the photograph, best first, at most a few. Stops at the first scale at which a grid
/// has `enough` corners.
pub(super) fn labelled_grids(
    photo: &LinearPhoto<'_>,
    downsampled: &Downsampled,
    enough: usize,
) -> Vec<Vec<LabelledCorner>> {
    let mut grids: Vec<Vec<LabelledCorner>> = Vec::new();
    for factor in scales(downsampled.factor) {
        let reduced;
        let image = if factor == downsampled.factor {
            &downsampled.image
        } else {
            reduced = photo.reduced(factor);
            &reduced
        };
        let (width, height) = (image.width(), image.height());
        if width < 16 || height < 16 {
            continue;
        }
        let pixels = stretched(image);
        let view = GrayImageView { width, height, data: &pixels };
        for floor in STRENGTH_FLOORS {
            let mut found = grids_at(view, floor, factor);
            grids.append(&mut found);
            if grids.iter().any(|g| g.len() >= enough) {
                break;
            }
        }
        if grids.iter().any(|g| g.len() >= enough) {
            break;
        }
    }
    grids.sort_by_key(|g| std::cmp::Reverse(g.len()));
    grids
}

/// Reduction factors, the one of the downsampled image first.
fn scales(own: usize) -> Vec<usize> {
    let mut scales = vec![own];
    for (by, to) in OTHER_SCALES {
        let other = own * by / to;
        if other >= 1 && !scales.contains(&other) {
            scales.push(other);
        }
    }
    scales
}

fn grids_at(view: GrayImageView<'_>, floor: f32, factor: usize) -> Vec<Vec<LabelledCorner>> {
    let config: DetectorConfig =
        default_chess_config().with_threshold(floor.min(default_chess_config().threshold));
    let corners = detect_corners(&view, &config);
    let mut params = ChessboardParams::default();
    params.min_corner_strength = floor;
    let Ok(detector) = ChessboardDetector::new(params) else { return Vec::new() };
    // Pixel (x, y) of the reduced image is centred at x·factor + (factor − 1)/2 of the photograph.
    let (scale, offset) = (factor as f64, (factor as f64 - 1.0) / 2.0);
    let labelled = |c: &calib_targets_chessboard::ChessboardCorner| LabelledCorner {
        label: [c.grid.u, c.grid.v],
        position: Point2::new(f64::from(c.position.x), f64::from(c.position.y)) * scale
            + nalgebra::Vector2::repeat(offset),
    };
    detector.detect_all(&corners).iter().map(|d| d.corners.iter().map(labelled).collect()).collect()
}

/// An image stretched so that its bright parts use all of 8 bits, sRGB-encoded.
fn stretched(image: &GreyImage) -> Vec<u8> {
    let white = quantile(image.data(), 0.995).max(f32::MIN_POSITIVE);
    // 4096 steps of linear light keep the dark end of the curve smooth in 8 bits.
    let table: Vec<u8> = (0..=4096)
        .map(|i| (Encoding::Srgb.from_linear(f64::from(i) / 4096.0) * 255.0).round() as u8)
        .collect();
    image.data().iter().map(|&l| table[((l / white).clamp(0.0, 1.0) * 4096.0) as usize]).collect()
}

/// The value below which the fraction `q` of at most some 10⁵ evenly taken samples lies.
pub(super) fn quantile(data: &[f32], q: f64) -> f32 {
    let step = (data.len() / 100_000).max(1);
    let mut samples: Vec<f32> = data.iter().copied().step_by(step).collect();
    if samples.is_empty() {
        return 0.0;
    }
    let at = ((samples.len() - 1) as f64 * q) as usize;
    *samples.select_nth_unstable_by(at, f32::total_cmp).1
}
