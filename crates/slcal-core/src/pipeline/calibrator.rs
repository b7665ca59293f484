//! Photographs → rig: one object that takes the photographs one by one.

use nalgebra::Point2;

use crate::calibrate::{CalibrateConfig, Calibration, FocalPrior, calibrate_observations};
use crate::detect::{DetectConfig, Detection, observe};
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::RectangleSize;
use crate::observations::Observations;
use crate::pattern::CheckerPattern;
use crate::photo::{Encoding, PhotoView};
use crate::rig::Warning;

/// A photograph of the sheet and what is known about it.
#[derive(Debug, Clone)]
pub struct SheetPhoto<'a> {
    view: PhotoView<'a>,
    name: Option<String>,
    plain: Option<PhotoView<'a>>,
    corners: Option<[Point2<f64>; 4]>,
    focal_35mm: Option<f64>,
}

impl<'a> SheetPhoto<'a> {
    /// A photograph of which nothing else is known.
    #[must_use]
    pub fn new(view: PhotoView<'a>) -> Self {
        Self { view, name: None, plain: None, corners: None, focal_35mm: None }
    }

    /// Its name, for messages and for the rig's view.
    #[must_use]
    pub fn name(mut self, name: impl Into<String>) -> Self {
        self.name = Some(name.into());
        self
    }

    /// The same pose with a dark or plain projection, in the same size: the sheet's sides are measured there.
    #[must_use]
    pub fn plain(mut self, plain: PhotoView<'a>) -> Self {
        self.plain = Some(plain);
        self
    }

    /// The sheet's corners TL, TR, BR, BL by hand, px, where it is not found; they may lie outside the frame.
    #[must_use]
    pub fn corners(mut self, corners: [Point2<f64>; 4]) -> Self {
        self.corners = Some(corners);
        self
    }

    /// The 35 mm equivalent of the focal length, mm, as the EXIF tag `FocalLengthIn35mmFilm` states it: a prior for the
    /// camera's focal length.
    #[must_use]
    pub fn focal_35mm(mut self, mm: f64) -> Self {
        self.focal_35mm = Some(mm);
        self
    }
}

impl<'a> From<PhotoView<'a>> for SheetPhoto<'a> {
    fn from(view: PhotoView<'a>) -> Self {
        Self::new(view)
    }
}

/// Calibrates a camera and a projector from photographs of a white sheet with a checkerboard projected on it; without a
/// pattern, the camera alone.
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
    sheet: RectangleSize,
    pattern: Option<CheckerPattern>,
    encoding: Encoding,
    config: CalibrateConfig,
    /// Width and height of the first photograph, px, and its name.
    first: Option<([u32; 2], String)>,
    /// The 35 mm equivalent, mm, and the first photograph that states it.
    focal_35mm: Option<(f64, String)>,
    detections: Vec<Detection>,
}

impl Calibrator {
    /// For a sheet of this size. The width belongs to the side that runs most nearly along the image's x axis.
    #[must_use]
    pub fn new(sheet: RectangleSize) -> Self {
        Self {
            sheet,
            pattern: None,
            encoding: Encoding::default(),
            config: CalibrateConfig::default(),
            first: None,
            focal_35mm: None,
            detections: Vec::new(),
        }
    }

    /// The checkerboard that is projected; without it the camera alone is calibrated.
    #[must_use]
    pub fn with_pattern(mut self, pattern: &CheckerPattern) -> Self {
        self.pattern = Some(pattern.clone());
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
    /// [`Error::NotFound`] when the checkerboard or the sheet is not seen; [`Error::Invalid`] for a photograph of another
    /// size or focal length than the first or of another size than the known camera's images, a plain photograph of another
    /// size than its twin, and corners that are no convex quadrilateral.
    pub fn add<'a>(&mut self, photo: impl Into<SheetPhoto<'a>>) -> Result<&Detection> {
        let SheetPhoto { view, name, plain, corners, focal_35mm } = photo.into();
        let title = name.clone().unwrap_or_else(|| title(self.detections.len()));
        let size = [view.width() as u32, view.height() as u32];
        self.check_size(size)?;
        if let Some(mm) = focal_35mm {
            self.check_focal_length(mm)?;
        }
        let detect = DetectConfig { encoding: self.encoding, corners, ..DetectConfig::default() };
        let mut found = observe(view, plain, self.sheet, self.pattern.as_ref(), &detect)?;
        if let Some(mm) = focal_35mm {
            self.config.focal_prior = Some(FocalPrior::from_35mm_equivalent(mm, size));
            self.focal_35mm.get_or_insert_with(|| (mm, title.clone()));
        }
        self.first.get_or_insert((size, title));
        found.observation.photo = name;
        self.detections.push(found);
        Ok(&self.detections[self.detections.len() - 1])
    }

    fn check_size(&self, size: [u32; 2]) -> Result<()> {
        let found = format!("{}x{}", size[0], size[1]);
        if let Some(([w, h], first)) = self.first.as_ref().filter(|(expected, _)| *expected != size) {
            let expected = format!(
                "{w}x{h} pixels like {first} (all photographs come from one camera at one setting, uncropped)"
            );
            return Err(Error::invalid(ErrorSubject::Photograph, expected, found));
        }
        if let Some(known) = self.config.known_camera.filter(|k| k.size() != size) {
            let [w, h] = known.size();
            let expected =
                format!("{w}x{h} pixels like the known camera (intrinsics hold for one resolution)");
            return Err(Error::invalid(ErrorSubject::Photograph, expected, found));
        }
        Ok(())
    }

    fn check_focal_length(&self, mm: f64) -> Result<()> {
        match &self.focal_35mm {
            Some((expected, first)) if (expected - mm).abs() >= 1e-9 => {
                let expected = format!(
                    "that of {first}, {expected} mm (35 mm equivalent; all photographs come from one camera at one setting of \
                     its zoom)"
                );
                Err(Error::invalid(ErrorSubject::FocalLength, expected, format!("{mm} mm")))
            }
            _ => Ok(()),
        }
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
        let (camera, _) = self
            .first
            .as_ref()
            .ok_or_else(|| Error::invalid(ErrorSubject::Photographs, "at least one", "none"))?;
        Ok(Observations {
            camera: *camera,
            projector: self.pattern.as_ref().map(|p| p.projector),
            views: self.detections.iter().map(|d| d.observation.clone()).collect(),
        })
    }

    /// Estimates the rig from all photographs that were added.
    ///
    /// # Errors
    /// [`Error::Invalid`] when no photograph was added; otherwise as
    /// [`calibrate_observations`](crate::calibrate_observations).
    pub fn calibrate(&self) -> Result<Calibration> {
        let mut calibration = calibrate_observations(&self.observations()?, &self.config)?;
        if let Some(quality) = &mut calibration.rig.quality {
            quality.warnings.extend(self.warnings());
        }
        Ok(calibration)
    }

    /// What detection warns of in the photographs so far, each with the photograph's name. [`calibrate`](Self::calibrate)
    /// adds it to the rig's warnings.
    #[must_use]
    pub fn warnings(&self) -> Vec<Warning> {
        let named = |(i, found): (usize, &Detection)| {
            let title = found.observation.photo.clone().unwrap_or_else(|| title(i));
            let prefixed = |w: &Warning| Warning { message: format!("{title}: {}", w.message), ..w.clone() };
            found.warnings.iter().map(prefixed).collect::<Vec<_>>()
        };
        self.detections.iter().enumerate().flat_map(named).collect()
    }
}

/// Stands for the name of a photograph that has none.
fn title(index: usize) -> String {
    format!("photograph {}", index + 1)
}

#[cfg(test)]
mod tests {
    use image::{DynamicImage, RgbImage};

    use super::*;

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
        let mut calibrator = Calibrator::new(RectangleSize::new(400.0, 280.0).unwrap());
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
