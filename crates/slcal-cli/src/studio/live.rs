//! What a frame of the live picture shows: sheet, corners, sharpness.

use image::{GrayImage, RgbImage};
use serde::Serialize;
use slcal_core::detect::{DetectConfig, Detection, observe};
use slcal_core::{CheckerPattern, Error, PhotoView, SheetSize};

use super::auto_shot::Quad;
use super::state::Problem;

/// More of the sheet overexposed than this makes its corners unreliable, per cent.
const CLIPPED_PERCENT: f64 = 5.0;
/// The sheet must hold this share of the pattern's corners.
const ENOUGH_CORNERS: f64 = 0.8;
/// Width of an edge in a picture that is perfectly sharp, px.
const SHARP_EDGE_PX: f64 = 1.6;

/// What was seen in a live frame, in its pixels.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Look {
    pub(super) seq: u32,
    pub(super) size: [u32; 2],
    /// Where the frame can be had, for pages that have no picture of their own.
    pub(super) url: String,
    /// The sheet's corners TL, TR, BR, BL.
    pub(super) sheet: Option<Quad>,
    /// Corners of the projected checkerboard.
    pub(super) corners: Vec<[f64; 2]>,
    pub(super) problem: Option<Problem>,
    /// 1: edges are as sharp as pixels; 0: blurred.
    pub(super) sharpness: Option<f64>,
    pub(super) clipped_percent: Option<f64>,
    /// Nearness to the guide's pose.
    pub(super) near: Option<f64>,
    pub(super) still: bool,
    pub(super) ready: bool,
    /// Points of a continuous scan.
    pub(super) stripes: Option<usize>,
    /// Mean level, as a share of full scale.
    #[serde(skip)]
    pub(super) level: f64,
}

impl Look {
    /// A frame in which nothing was searched.
    pub(super) fn at(seq: u32, frame: &RgbImage) -> Self {
        Self {
            seq,
            size: [frame.width(), frame.height()],
            url: format!("/api/live.jpg?seq={seq}"),
            sheet: None,
            corners: Vec::new(),
            problem: None,
            sharpness: None,
            clipped_percent: None,
            near: None,
            still: false,
            ready: false,
            stripes: None,
            level: level(frame),
        }
    }

    /// Looks for the sheet and the checkerboard.
    pub(super) fn for_sheet(seq: u32, frame: &RgbImage, sheet: SheetSize, checker: &CheckerPattern) -> Self {
        let mut look = Self::at(seq, frame);
        let found = PhotoView::try_from(frame)
            .and_then(|view| observe(view, None, sheet.upright(), Some(checker), &DetectConfig::default()));
        match found {
            Ok(found) => look.take(&found, frame),
            Err(error) => look.problem = Some(not_found(&error)),
        }
        look
    }

    fn take(&mut self, found: &Detection, frame: &RgbImage) {
        self.sheet = found.observation.sheet.corners().map(|quad| quad.map(|p| [p.x, p.y]));
        self.corners = found.observation.pairs.iter().map(|p| [p.camera.x, p.camera.y]).collect();
        self.sharpness = self.sheet.map(|quad| sharpness(frame, &quad));
        let percent = 100.0 * found.clipped;
        self.clipped_percent = Some(percent);
        self.problem = if percent > CLIPPED_PERCENT {
            Some(Problem::new(
                "clipped",
                format!("{percent:.0} % of the sheet is overexposed"),
                "lower the exposure of the camera or dim the projector",
            ))
        } else if (self.corners.len() as f64) < ENOUGH_CORNERS * found.pattern_corners as f64 {
            Some(Problem::new(
                "pattern-beside-sheet",
                format!(
                    "{} of {} corners of the pattern are seen on the sheet",
                    self.corners.len(),
                    found.pattern_corners
                ),
                "move the sheet so that the whole checkerboard lies on it, or make the pattern smaller",
            ))
        } else {
            None
        };
    }

    /// Whether all that a calibration needs is there.
    pub(super) fn is_complete(&self) -> bool {
        self.sheet.is_some() && self.problem.is_none()
    }
}

/// The mean of every few pixels: enough to see a flash.
fn level(frame: &RgbImage) -> f64 {
    const EVERY: usize = 7;
    let (mut sum, mut count) = (0_u64, 0_u64);
    for pixel in frame.pixels().step_by(EVERY) {
        sum += pixel.0.iter().map(|c| u64::from(*c)).sum::<u64>();
        count += 1;
    }
    sum as f64 / (3.0 * 255.0 * count.max(1) as f64)
}

/// What the live picture lacks, briefly: the page shows it while the sheet is moved.
fn not_found(error: &Error) -> Problem {
    match error {
        Error::NotFound { what, .. } => {
            let what = what.to_string();
            let (code, advice) = if what.contains("sheet") {
                ("sheet-not-found", "show all four sides of the white sheet before a darker background")
            } else {
                (
                    "pattern-not-found",
                    "put the sheet where the projected checkerboard falls, and focus the camera on it",
                )
            };
            Problem::new(code, format!("{} is not seen", with_article(&what)), advice)
        }
        other => Problem::new("not-measured", other.to_string(), "move the sheet"),
    }
}

fn with_article(what: &str) -> String {
    if what.starts_with("the ") { what.to_owned() } else { format!("the {what}") }
}

/// How sharp the sheet's sides are: the width of a pixel's edge over the median width of theirs.
fn sharpness(frame: &RgbImage, quad: &Quad) -> f64 {
    /// Places along each side.
    const PLACES: [f64; 5] = [0.2, 0.35, 0.5, 0.65, 0.8];
    /// Half the length of a profile across the side, px.
    const REACH: i32 = 8;
    let grey: GrayImage = image::imageops::grayscale(frame);
    let mut widths = Vec::new();
    for side in 0..4 {
        let ([ax, ay], [bx, by]) = (quad[side], quad[(side + 1) % 4]);
        let (dx, dy) = (bx - ax, by - ay);
        let length = dx.hypot(dy).max(1.0);
        for t in PLACES {
            let (x, y) = (ax + t * dx, ay + t * dy);
            let profile: Vec<f64> = (-REACH..=REACH)
                .filter_map(|k| {
                    let (u, v) = (x - f64::from(k) * dy / length, y + f64::from(k) * dx / length);
                    image::imageops::sample_bilinear(
                        &grey,
                        ((u + 0.5) / f64::from(grey.width())) as f32,
                        ((v + 0.5) / f64::from(grey.height())) as f32,
                    )
                    .map(|p| f64::from(p.0[0]))
                })
                .collect();
            widths.extend(edge_width(&profile));
        }
    }
    widths.sort_by(f64::total_cmp);
    widths.get(widths.len() / 2).map_or(0.0, |w| (SHARP_EDGE_PX / w).min(1.0))
}

/// Contrast over steepest slope, samples; `None` without an edge.
fn edge_width(profile: &[f64]) -> Option<f64> {
    const LEAST_CONTRAST: f64 = 20.0;
    let low = profile.iter().copied().fold(f64::INFINITY, f64::min);
    let high = profile.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let slope = profile.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
    (high - low > LEAST_CONTRAST).then(|| (high - low) / slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blurred_sides_are_less_sharp() {
        let sheet = |x: u32, y: u32| (100..500).contains(&x) && (80..380).contains(&y);
        let frame = RgbImage::from_fn(640, 480, |x, y| image::Rgb([if sheet(x, y) { 220 } else { 30 }; 3]));
        let quad = [[99.5, 79.5], [499.5, 79.5], [499.5, 379.5], [99.5, 379.5]];
        let blurred = image::imageops::blur(&frame, 4.0);
        let (sharp, soft) = (sharpness(&frame, &quad), sharpness(&blurred, &quad));
        assert!(sharp > 0.75 && soft < 0.3, "{sharp} {soft}");
    }

    #[test]
    fn a_frame_without_a_sheet_says_what_is_missing() {
        let frame = RgbImage::from_pixel(320, 240, image::Rgb([40; 3]));
        let checker = CheckerPattern::new([1024, 768], &slcal_core::CheckerConfig::default()).unwrap();
        let look = Look::for_sheet(1, &frame, "A4".parse().unwrap(), &checker);
        let problem = look.problem.as_ref().unwrap();
        assert!(!look.is_complete() && problem.message.contains("not seen"), "{problem:?}");
    }
}
