//! Detection in one photograph: what is known of it, what was found.

use nalgebra::Point2;
use serde::{Deserialize, Serialize};

use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::{RectangleSize, Warp};
use crate::observations::{CornerPair, SheetObservation, ViewObservation};
use crate::pattern::CheckerPattern;
use crate::photo::{Encoding, PhotoView};
use crate::rig::Warning;

use super::board::Board;
use super::channel_offsets::channel_offsets;
use super::clipping::{clipped_share, clipped_warning};
use super::downsampled::Downsampled;
use super::panel_points::PanelBorder;
use super::projector_footprint::{ProjectedEdges, ProjectorFootprint};
use super::rough_undistort::RoughLens;
use super::sheet::{self, SheetDetection};
use super::steady::Steady;

/// What is known of a photograph before detection.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DetectConfig {
    /// The transfer curve of the photographs.
    pub encoding: Encoding,
    /// The sheet's corners TL, TR, BR, BL given by hand, px. They may lie outside the frame. The sides are still measured
    /// in the photograph where they are visible.
    pub corners: Option<[Point2<f64>; 4]>,
    /// Map from pattern pixels to panel pixels, when the pattern was not projected where its description says. For a
    /// rectified pattern [`rectify_checker`](crate::rectify_checker) gives it. The projector pixels of
    /// [`ViewObservation::pairs`] are then panel pixels.
    pub panel_from_pattern: Option<Warp>,
}

impl DetectConfig {
    /// Checks all values.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the field.
    pub fn validate(&self) -> Result<()> {
        self.encoding.validate()?;
        if self.panel_from_pattern.is_some_and(|w| w.homography.inverse().is_none()) {
            return Err(Error::invalid("panel_from_pattern", "an invertible map", "a singular one"));
        }
        match &self.corners {
            Some(corners) => sheet::check_corners(corners),
            None => Ok(()),
        }
    }
}

/// The result of detection in one photograph.
#[derive(Debug, Clone, PartialEq)]
pub struct Detection {
    /// The measurements for calibration.
    pub observation: ViewObservation,
    /// Number of corners of the whole pattern. `observation.pairs` are those detected on the sheet.
    pub pattern_corners: usize,
    /// Remarks for the user: parts that are not visible, corners taken from the user.
    pub notes: Vec<String>,
    /// Share of the lit part of the sheet that is overexposed, 0–1: samples at the end of the range. Of two photographs of the
    /// same pose, that of the worse one.
    pub clipped: f64,
    /// Parts of the sheet's outline that are not the plain edge of a sheet, and what was done about them:
    /// `side-face`, `side-covered`, `side-curled`; and `clipped` and `flicker`.
    pub warnings: Vec<Warning>,
}

/// The projected corners, on the sheet or beside it.
#[derive(Debug, Clone, PartialEq)]
pub struct CornerDetection {
    /// The detected corners, row by row of the pattern.
    pub pairs: Vec<CornerPair>,
    /// Number of corners of the whole pattern.
    pub expected: usize,
}

/// Detects the sheet, and the pattern when there is one, in a photograph.
///
/// `photo` shows the sheet with the pattern projected on it. `plain`, if given, shows the same pose with a dark or plain
/// projector; the sheet's sides are then measured there. Without a pattern the sheet is the brightest large
/// quadrilateral with straight sides.
///
/// # Errors
/// [`Error::NotFound`] when the checkerboard or the sheet is not detected, with what was detected instead; [`Error::Invalid`] when
/// the two photographs differ in size or the configuration is wrong.
///
/// # Examples
/// ```
/// use slcal_core::detect::{DetectConfig, observe};
/// use slcal_core::{CheckerPattern, PhotoView};
///
/// let checker = CheckerPattern::new([1024, 768], &Default::default())?;
/// let photo = image::open(concat!(env!("CARGO_MANIFEST_DIR"), "/../slcal-cli/demo/sheet.jpg"))?;
/// let found =
///     observe(PhotoView::try_from(&photo)?, None, "594x420mm".parse()?, Some(&checker), &DetectConfig::default())?;
/// assert_eq!((found.observation.pairs.len(), found.pattern_corners), (70, 70));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn observe(
    photo: PhotoView<'_>,
    plain: Option<PhotoView<'_>>,
    size: RectangleSize,
    pattern: Option<&CheckerPattern>,
    config: &DetectConfig,
) -> Result<Detection> {
    config.validate()?;
    if let Some(plain) = &plain
        && (plain.width(), plain.height()) != (photo.width(), photo.height())
    {
        return Err(Error::invalid(
            ErrorSubject::PlainPhotograph,
            format!("the size of the photograph with the pattern, {}x{}", photo.width(), photo.height()),
            format!("{}x{}", plain.width(), plain.height()),
        ));
    }
    let Some(pattern) = pattern else {
        let photo = plain.unwrap_or(photo);
        let SheetDetection { observation: sheet, notes, mut warnings } = find_sheet(photo, config)?;
        let clipped = clipped(&sheet, &[photo], &mut warnings);
        let observation = ViewObservation {
            photo: None,
            size,
            sheet,
            pairs: Vec::new(),
            panel_points: Vec::new(),
            channel_offsets: Vec::new(),
        };
        return Ok(Detection { observation, pattern_corners: 0, notes, clipped, warnings });
    };
    let photographs: Vec<PhotoView<'_>> = [photo].into_iter().chain(plain).collect();
    let steady = Steady::new(photo, config.encoding);
    let photo = steady.photo();
    let downsampled = Downsampled::new(&photo);
    let board = Board::find(&photo, &downsampled, pattern).map_err(|e| steady.explain(e))?;
    // The board was fitted in pattern pixels, whereas the footprint ends at the border of the panel.
    let pattern_from_panel = config.panel_from_pattern.and_then(|w| w.homography.inverse());
    let straight = board.undistorted_from_projector;
    let footprint = ProjectorFootprint::new(
        &pattern_from_panel.map_or(straight, |h| straight.compose(&h)),
        pattern.projector,
    );
    let plain = plain.map(|plain| Steady::new(plain, config.encoding));
    let steadies: Vec<&Steady<'_>> = [&steady].into_iter().chain(&plain).collect();
    let plain = plain.as_ref().map(Steady::photo);
    let of_plain = plain.as_ref().map(Downsampled::new);
    let outline = (plain.as_ref().unwrap_or(&photo), of_plain.as_ref().unwrap_or(&downsampled));
    let find_sheet = |footprint: &ProjectorFootprint| {
        let projected = ProjectedEdges {
            footprint,
            lens: &board.lens,
            board: Some((&board, pattern)),
            lit: &board.pairs,
        };
        sheet::find(outline.0, outline.1, &projected, config.corners)
    };
    let mut found = find_sheet(&footprint);
    let mut border = PanelBorder::default();
    // A pattern that is not projected where its description says has no marks, and its board tells nothing of the panel.
    if config.panel_from_pattern.is_none() {
        let rough = found.clone().or_else(|_| find_sheet(&ProjectorFootprint::none()));
        border = rough
            .map(|sheet| PanelBorder::find(&photo, &board, pattern, &sheet.observation))
            .unwrap_or_default();
        if let Some(footprint) = border.moved_footprint(&board, pattern) {
            // Edges along a border that is elsewhere were taken for the sheet's, and the other way round.
            found = find_sheet(&footprint).or(found);
        }
    }
    let of_sheet = steadies[steadies.len() - 1];
    let SheetDetection { observation: sheet, mut notes, mut warnings } =
        found.map_err(|e| of_sheet.explain(e))?;
    for steady in steadies {
        notes.extend(steady.notes.iter().cloned());
        warnings.extend(steady.warnings.iter().cloned());
    }
    let pattern_corners = board.expected;
    let board = on_sheet(board, &sheet, &mut notes)?;
    let mut channel_offsets = channel_offsets(&photo.view(), &board, pattern.square_px);
    if let Some(warp) = &config.panel_from_pattern {
        channel_offsets.retain_mut(|o| warp.map(o.projector).map(|q| o.projector = q).is_some());
    }
    let pairs = on_panel(board.pairs, config);
    let clipped = clipped(&sheet, &photographs, &mut warnings);
    let panel_points = border.points;
    let observation = ViewObservation { photo: None, size, sheet, pairs, panel_points, channel_offsets };
    Ok(Detection { observation, pattern_corners, notes, clipped, warnings })
}

/// The share of the sheet that is overexposed in the worst of these photographs, with a warning where it matters.
fn clipped(sheet: &SheetObservation, photographs: &[PhotoView<'_>], warnings: &mut Vec<Warning>) -> f64 {
    let Some(corners) = sheet.corners() else { return 0.0 };
    let share = photographs.iter().map(|p| clipped_share(p, &corners)).fold(0.0, f64::max);
    warnings.extend(clipped_warning(share));
    share
}

/// Detects the sheet alone, of any size: the brightest large quadrilateral with straight sides, or the sides near the
/// corners given by hand. The projected picture is unknown here, so take the photograph with a dark or plain projector.
///
/// # Errors
/// [`Error::NotFound`] when no sheet is detected, with what was detected instead; [`Error::Invalid`] when the configuration is wrong.
///
/// # Examples
/// ```
/// use slcal_core::PhotoView;
/// use slcal_core::detect::{DetectConfig, find_sheet};
/// use slcal_core::image::{DynamicImage, GrayImage, Luma};
///
/// // A white sheet in front of a dark wall.
/// let shade = |x, y| if (120..520).contains(&x) && (100..380).contains(&y) { 220 } else { 30 };
/// let photo = DynamicImage::ImageLuma8(GrayImage::from_fn(640, 480, |x, y| Luma([shade(x, y)])));
/// let sheet = find_sheet(PhotoView::try_from(&photo)?, &DetectConfig::default())?;
/// let [top_left, ..] = sheet.observation.corners().unwrap();
/// assert!((top_left.x - 119.5).abs() < 0.1 && (top_left.y - 99.5).abs() < 0.1);
/// # Ok::<(), slcal_core::Error>(())
/// ```
pub fn find_sheet(photo: PhotoView<'_>, config: &DetectConfig) -> Result<SheetDetection> {
    config.validate()?;
    let steady = Steady::new(photo, config.encoding);
    let photo = steady.photo();
    let lens = RoughLens::none(photo.width(), photo.height());
    let projected =
        ProjectedEdges { footprint: &ProjectorFootprint::none(), lens: &lens, board: None, lit: &[] };
    let mut found = sheet::find(&photo, &Downsampled::new(&photo), &projected, config.corners)
        .map_err(|e| steady.explain(e))?;
    found.notes.extend(steady.notes.iter().cloned());
    found.warnings.extend(steady.warnings.iter().cloned());
    Ok(found)
}

/// Detects the corners of the projected checkerboard alone, on the sheet or beside it. [`DetectConfig::corners`] is not
/// used.
///
/// # Errors
/// [`Error::NotFound`] when the checkerboard is not detected, with what was detected instead; [`Error::Invalid`] when the
/// configuration is wrong.
///
/// # Examples
/// ```
/// use slcal_core::detect::{DetectConfig, find_corners};
/// use slcal_core::image::DynamicImage;
/// use slcal_core::{CheckerPattern, PhotoView};
///
/// // As a camera would see it that stands where the projector does.
/// let checker = CheckerPattern::new([1024, 768], &Default::default())?;
/// let photo = DynamicImage::ImageRgb8(checker.image()?);
/// let found = find_corners(PhotoView::try_from(&photo)?, &checker, &DetectConfig::default())?;
/// assert_eq!((found.pairs.len(), found.expected), (70, 70));
/// assert!(found.pairs.iter().all(|p| (p.camera - p.projector).norm() < 0.05));
/// # Ok::<(), slcal_core::Error>(())
/// ```
pub fn find_corners(
    photo: PhotoView<'_>,
    pattern: &CheckerPattern,
    config: &DetectConfig,
) -> Result<CornerDetection> {
    config.validate()?;
    let steady = Steady::new(photo, config.encoding);
    let photo = steady.photo();
    let board = Board::find(&photo, &Downsampled::new(&photo), pattern).map_err(|e| steady.explain(e))?;
    Ok(CornerDetection { expected: board.expected, pairs: on_panel(board.pairs, config) })
}

/// The pairs with their projector pixels on the panel.
fn on_panel(mut pairs: Vec<CornerPair>, config: &DetectConfig) -> Vec<CornerPair> {
    if let Some(warp) = &config.panel_from_pattern {
        pairs.retain_mut(|pair| warp.map(pair.projector).map(|q| pair.projector = q).is_some());
    }
    pairs
}

/// Removes the corners beside the sheet: they lie on another surface.
fn on_sheet(board: Board, sheet: &SheetObservation, notes: &mut Vec<String>) -> Result<Board> {
    let Some(corners) = sheet.corners() else { return Ok(board) };
    let seen = board.pairs.len();
    let expected = board.expected;
    let board = board.retain(|p| sheet::contains(&corners, p)).ok_or_else(|| Error::NotFound {
        what: ErrorSubject::Checkerboard,
        seen: format!("{seen} of {expected} corners were seen, but too few of them on the sheet"),
        advice: "move the projector or the sheet so that the whole pattern falls on the sheet".into(),
    })?;
    if board.pairs.len() < expected {
        notes.push(format!(
            "{} of {expected} corners of the pattern are used: the others are hidden, outside the frame or beside the sheet",
            board.pairs.len()
        ));
    }
    Ok(board)
}
