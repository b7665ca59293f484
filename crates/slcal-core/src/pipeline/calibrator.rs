//! Photographs → rig: one object that takes the photographs one by one.

use super::common_orientation::{Outcome, differ, settle, warning};
use super::photo_tags::{Finding, PhotoTags, TaggedFocal, Turn};
use super::sequence_sheet::observe_sequence;
use super::sheet_photo::SheetPhoto;
use super::sheet_sides::SheetSides;
use super::tag_warnings::of_tags;
use super::taken::Taken;
use crate::assumption::AssumptionStatus;
use crate::calibrate::{CalibrateConfig, Calibration, calibrate_observations};
use crate::dense_matches::DenseMatches;
use crate::detect::{CLIPPED, CLIPPED_COST_PERCENT, DetectConfig, Detection, observe};
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::SheetSize;
use crate::observations::{Observations, ViewObservation};
use crate::pattern::{CheckerPattern, SequencePattern};
use crate::photo::{Encoding, PhotoView};
use crate::rig::{Rig, Warning};

/// Calibrates a camera and a projector from photographs of a white sheet with a checkerboard projected on it; without a
/// pattern, the camera alone. Instead of the checkerboard it may be a sequence ([`with_sequence`](Self::with_sequence)).
///
/// [`add`](Self::add) finds sheet and pattern in one photograph per pose and keeps what it found, not the pixels: each
/// photograph can be loaded, added and dropped before the next. [`calibrate`](Self::calibrate) estimates the rig from all
/// of them.
///
/// # Examples
/// ```
/// use slcal_core::{Calibrator, CheckerPattern, PhotoView, SheetPhoto, Verdict};
///
/// let checker = CheckerPattern::new([1024, 768], &Default::default())?;
/// let mut calibrator = Calibrator::new("594x420mm".parse()?).with_pattern(&checker);
/// for path in [concat!(env!("CARGO_MANIFEST_DIR"), "/../slcal-cli/demo/sheet.jpg")] {
///     let photo = image::open(path)?;
///     let found = calibrator.add(SheetPhoto::new(PhotoView::try_from(&photo)?).name(path))?;
///     assert_eq!(found.observation.pairs.len(), 70);
/// }
/// let calibration = calibrator.calibrate()?;
/// let quality = calibration.rig.quality.as_ref().expect("every calibration is assessed");
/// assert!(quality.verdict <= Verdict::Fair, "{}", quality.cause);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Calibrator {
    sheet: SheetSize,
    sides: SheetSides,
    projected: Option<Projected>,
    mirrored: bool,
    encoding: Encoding,
    config: CalibrateConfig,
    /// The focal length that is a prior, and the first photograph that states it.
    focal: Option<(TaggedFocal, String)>,
    /// One of each photograph.
    taken: Vec<Taken>,
    detections: Vec<Detection>,
    /// What was done with photographs that their tags turn differently, and the views before that.
    turning: Option<(Outcome, Vec<ViewObservation>)>,
}

/// What the projector shows.
#[derive(Debug, Clone)]
enum Projected {
    /// As it lies on the panel.
    Checker(CheckerPattern),
    /// A sequence for this panel.
    Sequence([u32; 2]),
}

impl Projected {
    fn panel(&self) -> [u32; 2] {
        match self {
            Self::Checker(pattern) => pattern.projector,
            Self::Sequence(panel) => *panel,
        }
    }
}

impl Calibrator {
    /// For a sheet of this size. The width belongs to the side that runs most nearly along the image's x axis; a paper by its
    /// name alone is tried both ways round in every photograph.
    #[must_use]
    pub fn new(sheet: SheetSize) -> Self {
        Self {
            sheet,
            sides: SheetSides::default(),
            projected: None,
            mirrored: false,
            encoding: Encoding::default(),
            config: CalibrateConfig::default(),
            focal: None,
            taken: Vec::new(),
            detections: Vec::new(),
            turning: None,
        }
    }

    /// The checkerboard that is projected; without it the camera alone is calibrated.
    #[must_use]
    pub fn with_pattern(mut self, pattern: &CheckerPattern) -> Self {
        self.projected = Some(Projected::Checker(pattern.clone()));
        self.mirrored = false;
        self
    }

    /// The same where the projector's pictures appear with left and right exchanged, as in rear projection: column c of the pattern
    /// counts as width − 1 − c, and the rig says so ([`Projector::mirrored`](crate::Projector::mirrored)).
    #[must_use]
    pub fn with_mirrored_pattern(mut self, pattern: &CheckerPattern) -> Self {
        self.projected = Some(Projected::Checker(pattern.mirrored()));
        self.mirrored = true;
        self
    }

    /// The sequence that is projected instead of a checkerboard: in every pose a photograph under white light, with the
    /// [matches](SheetPhoto::matches) that were decoded from all of them. The sequence must code columns and rows.
    #[must_use]
    pub fn with_sequence(mut self, pattern: &SequencePattern) -> Self {
        self.projected = Some(Projected::Sequence(pattern.projector));
        self.mirrored = false;
        self
    }

    /// The same where the projector's pictures appear with left and right exchanged. The matches must be decoded so, too
    /// ([`SequenceDecodeConfig::mirrored`](crate::decode::SequenceDecodeConfig::mirrored)): they are of the panel.
    #[must_use]
    pub fn with_mirrored_sequence(mut self, pattern: &SequencePattern) -> Self {
        self.projected = Some(Projected::Sequence(pattern.projector));
        self.mirrored = true;
        self
    }

    /// The transfer curve of the photographs; sRGB unless it is given.
    #[must_use]
    pub fn with_encoding(mut self, encoding: Encoding) -> Self {
        self.encoding = encoding;
        self
    }

    /// What is assumed and what is estimated.
    #[must_use]
    pub fn with_config(mut self, config: CalibrateConfig) -> Self {
        self.config = config;
        self
    }

    /// What is assumed and what is estimated, with the focal length that the photographs' tags state.
    #[must_use]
    pub fn config(&self) -> &CalibrateConfig {
        &self.config
    }

    /// The same, to set what follows from the photographs: a known camera for their size, for instance.
    pub fn config_mut(&mut self) -> &mut CalibrateConfig {
        &mut self.config
    }

    /// Finds sheet and pattern in one photograph. After an error the photograph is left out, and others can be added.
    ///
    /// # Errors
    /// [`Error::NotFound`] when the checkerboard, the code of the sequence or the sheet is not seen; [`Error::Invalid`] for a photograph of another
    /// size or focal length than the first or of another size than the known camera's images, a plain photograph of another
    /// size than its twin, and corners that are no convex quadrilateral.
    pub fn add<'a>(&mut self, photo: impl Into<SheetPhoto<'a>>) -> Result<&Detection> {
        let SheetPhoto { view, name, plain, matches, corners, tags, focal_from_tags, focal_35mm } =
            photo.into();
        let title = name.clone().unwrap_or_else(|| title(self.detections.len()));
        let size = [view.width() as u32, view.height() as u32];
        let taken = Taken { title, size, tags, turn: Turn(0) };
        self.check_size(&taken)?;
        let equivalent = focal_35mm.map(|mm| PhotoTags { focal_35mm: Some(mm), ..PhotoTags::default() });
        let stated = equivalent.as_ref().or_else(|| taken.tags.as_ref().filter(|_| focal_from_tags));
        let focal = stated.map(|tags| tags.focal(size)).transpose()?;
        if let Some(focal) = &focal {
            self.check_focal_length(focal)?;
        }
        let detect = DetectConfig { encoding: self.encoding, corners, ..DetectConfig::default() };
        let mut found = self.observe(view, plain, matches, &detect)?;
        if let Some(focal) = focal {
            self.config.focal_prior = Some(focal.prior);
            self.focal.get_or_insert_with(|| (focal, taken.title.clone()));
        }
        found.notes.extend(taken.resized());
        found.observation.photo = name;
        self.unsettle();
        self.taken.push(taken);
        self.detections.push(found);
        self.sides.settle(self.sheet, size, &mut self.detections, &self.config);
        Ok(&self.detections[self.detections.len() - 1])
    }

    fn observe(
        &self,
        view: PhotoView<'_>,
        plain: Option<PhotoView<'_>>,
        matches: Option<&DenseMatches>,
        detect: &DetectConfig,
    ) -> Result<Detection> {
        let size = self.sheet.upright();
        let expected = match (&self.projected, matches) {
            (Some(Projected::Sequence(panel)), Some(matches)) => {
                return observe_sequence(view, plain, size, matches, *panel, detect);
            }
            (Some(Projected::Checker(pattern)), None) => {
                return observe(view, plain, size, Some(pattern), detect);
            }
            (None, None) => return observe(view, plain, size, None, detect),
            (Some(Projected::Sequence(_)), None) => "the matches of the sequence with every white photograph",
            (_, Some(_)) => "photographs without matches, because no sequence is projected",
        };
        let found = if matches.is_some() { "matches" } else { "none" };
        Err(Error::invalid(ErrorSubject::Photograph, expected, found))
    }

    fn check_size(&self, taken: &Taken) -> Result<()> {
        let size = taken.size;
        let found = format!("{}x{}", size[0], size[1]);
        // Turned by its tags, a photograph may have the sides of the others exchanged: whether it fits is seen later.
        let turnable = |first: &Taken| {
            let turn = taken.orientation().turn_to(first.orientation());
            turn.is_some_and(|t| t.size(size) == first.size)
        };
        if let Some(first) = self.taken.first().filter(|first| first.size != size && !turnable(first)) {
            let ([w, h], first) = (first.size, &first.title);
            let expected = format!(
                "{w}x{h} pixels like {first} (all photographs come from one camera at one setting, uncropped)"
            );
            return Err(Error::invalid(ErrorSubject::Photograph, expected, found));
        }
        if let Some(known) = self.config.known_camera.filter(|k| self.taken.is_empty() && k.size() != size) {
            let [w, h] = known.size();
            let expected =
                format!("{w}x{h} pixels like the known camera (intrinsics hold for one resolution)");
            return Err(Error::invalid(ErrorSubject::Photograph, expected, found));
        }
        Ok(())
    }

    fn check_focal_length(&self, focal: &TaggedFocal) -> Result<()> {
        match &self.focal {
            Some((expected, first)) if (expected.mm - focal.mm).abs() >= 1e-9 => {
                let expected = format!(
                    "that of {first}, {expected}; all photographs come from one camera at one setting of its zoom"
                );
                Err(Error::invalid(ErrorSubject::FocalLength, expected, focal))
            }
            _ => Ok(()),
        }
    }

    /// Leaves out a photograph that was added: the one at this place in [`detections`](Self::detections). Does nothing where there is
    /// none.
    pub fn remove(&mut self, index: usize) {
        if index >= self.detections.len() {
            return;
        }
        self.unsettle();
        self.taken.remove(index);
        self.detections.remove(index);
        self.sides.remove(index);
    }

    /// What was found in the photographs so far, in their order.
    #[must_use]
    pub fn detections(&self) -> &[Detection] {
        &self.detections
    }

    /// What a calibration is computed from; it can be stored, and calibrated from later.
    ///
    /// # Errors
    /// [`Error::Invalid`] when no photograph was added.
    pub fn observations(&self) -> Result<Observations> {
        let first = self
            .taken
            .first()
            .ok_or_else(|| Error::invalid(ErrorSubject::Photographs, "at least one", "none"))?;
        Ok(Observations {
            camera: first.turned_size(),
            projector: self.projected.as_ref().map(Projected::panel),
            mirrored: self.mirrored,
            views: self.detections.iter().map(|d| d.observation.clone()).collect(),
        })
    }

    /// Turns photographs whose tags turn them differently so that all lie alike, where they fit together only so; what was
    /// found in them is turned along. Nothing happens where the tags agree. [`calibrate`](Self::calibrate) does this as well;
    /// call it before [`observations`](Self::observations) are stored.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the photographs have different sizes and fit neither way.
    pub fn settle_orientation(&mut self) -> Result<()> {
        if self.turning.is_some() || !differ(&self.taken) {
            return Ok(());
        }
        let (observations, turns, outcome) = settle(&self.observations()?, &self.taken, &self.config)?;
        self.taken.iter_mut().zip(turns).for_each(|(taken, turn)| taken.turn = turn);
        let settled = self.detections.iter_mut().zip(observations.views);
        let before = settled.map(|(found, view)| std::mem::replace(&mut found.observation, view)).collect();
        self.turning = Some((outcome, before));
        Ok(())
    }

    /// Turns everything back: another photograph may change which way is right.
    fn unsettle(&mut self) {
        let Some((_, before)) = self.turning.take() else { return };
        for ((found, taken), view) in self.detections.iter_mut().zip(&mut self.taken).zip(before) {
            found.observation = view;
            taken.turn = Turn(0);
        }
    }

    /// By how many quarter turns clockwise each photograph was turned to lie like the others; zero for all unless
    /// [`settle_orientation`](Self::settle_orientation) found that they fit together only so.
    pub fn quarter_turns(&self) -> impl Iterator<Item = u8> {
        self.taken.iter().map(|t| t.turn.0)
    }

    /// Estimates the rig from all photographs that were added.
    ///
    /// # Errors
    /// [`Error::Invalid`] when no photograph was added, or when photographs that are turned differently fit neither way;
    /// otherwise as [`calibrate_observations`](crate::calibrate_observations).
    pub fn calibrate(&self) -> Result<Calibration> {
        if self.turning.is_none() && differ(&self.taken) {
            let mut settled = self.clone();
            settled.settle_orientation()?;
            return settled.calibrate_settled();
        }
        self.calibrate_settled()
    }

    fn calibrate_settled(&self) -> Result<Calibration> {
        let mut calibration = calibrate_observations(&self.observations()?, &self.config)?;
        for (view, found) in calibration.rig.views.iter_mut().zip(&self.detections) {
            view.clipped_percent = Some(100.0 * found.clipped).filter(|percent| *percent > 0.0);
        }
        let (clipped, of_sides): (Vec<_>, Vec<_>) =
            self.warnings().into_iter().partition(|w| w.code == CLIPPED);
        // One photograph is more uncertain than what clipping costs.
        let doubtful = focal_sigma_percent(&calibration.rig) < CLIPPED_COST_PERCENT;
        let mut findings = of_tags(&calibration.rig, &self.config, &self.taken);
        // What the photographs themselves have shown is not told again.
        let told: Vec<String> =
            calibration.rig.quality.iter().flat_map(|q| &q.warnings).map(|w| w.code.clone()).collect();
        findings.retain(|f| !told.contains(&f.warning.code));
        findings.extend(clipped.into_iter().map(|warning| Finding { warning, doubtful }));
        findings.extend(self.turning_warning().map(|warning| Finding { warning, doubtful: false }));
        let (doubts, remarks): (Vec<_>, Vec<_>) = findings.into_iter().partition(|f| f.doubtful);
        doubts.into_iter().rev().for_each(|f| calibration.doubt(f.warning));
        if let Some(quality) = &mut calibration.rig.quality {
            quality.warnings.extend(remarks.into_iter().map(|f| f.warning).chain(of_sides));
            if self.taken.iter().all(Taken::is_whole) {
                let crop = quality.assumptions.iter_mut().filter(|a| a.code == "not-cropped");
                crop.for_each(|a| a.status = AssumptionStatus::Tested);
            }
        }
        Ok(calibration)
    }

    fn turning_warning(&self) -> Option<Warning> {
        let (outcome, _) = self.turning.as_ref()?;
        warning(&self.taken, outcome, self.config.known_camera.is_some())
    }

    /// What detection warns of in the photographs so far, each with the photograph's name. [`calibrate`](Self::calibrate)
    /// adds it to the rig's warnings.
    #[must_use]
    pub fn warnings(&self) -> Vec<Warning> {
        let named = |(i, found): (usize, &Detection)| {
            let title = title_of(found, i);
            let prefixed = |w: &Warning| Warning { message: format!("{title}: {}", w.message), ..w.clone() };
            found.warnings.iter().map(prefixed).collect::<Vec<_>>()
        };
        let titles: Vec<String> = self.detections.iter().enumerate().map(|(i, d)| title_of(d, i)).collect();
        let of_detection = self.detections.iter().enumerate().flat_map(named);
        of_detection.chain(self.sides.warnings(self.sheet, &titles)).collect()
    }
}

/// The larger σ of the two focal lengths, per cent.
fn focal_sigma_percent(rig: &Rig) -> f64 {
    rig.quality.as_ref().map_or(f64::INFINITY, |q| {
        q.focal_sigma_percent_projector.unwrap_or(0.0).max(q.focal_sigma_percent_camera)
    })
}

/// The name of a photograph.
fn title_of(found: &Detection, index: usize) -> String {
    found.observation.photo.clone().unwrap_or_else(|| title(index))
}

/// Stands for the name of a photograph that has none.
fn title(index: usize) -> String {
    format!("photograph {}", index + 1)
}

#[cfg(test)]
mod tests {
    use image::{DynamicImage, RgbImage};

    use super::*;
    use crate::photo::PhotoView;

    /// A sheet before a dark wall.
    fn photograph(width: u32, height: u32) -> DynamicImage {
        let sheet = |x: u32, y: u32| (120..520).contains(&x) && (100..380).contains(&y);
        let shade = |x, y| if sheet(x, y) { 220 } else { 30 };
        DynamicImage::ImageRgb8(RgbImage::from_fn(width, height, |x, y| image::Rgb([shade(x, y); 3])))
    }

    #[test]
    fn photographs_of_another_size_or_lens_are_refused_and_left_out() {
        let photo = photograph(640, 480);
        let view = PhotoView::try_from(&photo).unwrap();
        let mut calibrator = Calibrator::new("400x280mm".parse().unwrap());
        assert!(calibrator.observations().is_err() && calibrator.calibrate().is_err());
        let first = SheetPhoto::new(view).name("a.jpg").focal_35mm(28.0);
        assert_eq!(calibrator.add(first).unwrap().pattern_corners, 0);
        assert!(calibrator.config().focal_prior.is_some());

        let small = photograph(600, 480);
        let error = calibrator.add(PhotoView::try_from(&small).unwrap()).unwrap_err().to_string();
        assert!(error.contains("640x480 pixels like a.jpg") && error.contains("600x480"), "{error}");
        let error = calibrator.add(SheetPhoto::new(view).focal_35mm(31.0)).unwrap_err().to_string();
        assert!(error.contains("28 mm") && error.contains("31 mm"), "{error}");
        let blank = DynamicImage::new_rgb8(640, 480);
        let error = calibrator.add(PhotoView::try_from(&blank).unwrap()).unwrap_err();
        assert!(matches!(error, Error::NotFound { .. }));

        calibrator.add(view).unwrap();
        assert_eq!(calibrator.detections().len(), 2);
        let views = calibrator.observations().unwrap().views;
        assert_eq!((views[0].photo.as_deref(), views[1].photo.as_deref()), (Some("a.jpg"), None));
    }

    #[test]
    fn warnings_about_a_side_name_the_photograph() {
        let mut image = photograph(640, 480).into_rgb8();
        // A clip over a sixth of the upper side.
        for (x, y) in (200..260).flat_map(|x| (80..112).map(move |y| (x, y))) {
            image.put_pixel(x, y, image::Rgb([90; 3]));
        }
        let image = DynamicImage::ImageRgb8(image);
        let mut calibrator = Calibrator::new("594x420mm".parse().unwrap());
        for name in [Some("first.jpg"), None] {
            let shot = SheetPhoto::new(PhotoView::try_from(&image).unwrap());
            calibrator.add(name.map_or(shot.clone(), |name| shot.name(name))).unwrap();
        }
        let warnings = calibrator.warnings();
        assert_eq!(warnings.len(), 2, "{warnings:?}");
        for (warning, name) in warnings.iter().zip(["first.jpg", "photograph 2"]) {
            assert_eq!(warning.code, "side-covered");
            assert!(
                warning.message.starts_with(&format!("{name}: ")) && warning.message.contains("top side")
            );
        }
    }
}
