//! Photograph + rig → remaining keystone, and whether something has moved.

use std::borrow::Cow;

use nalgebra::Point2;
use serde::{Deserialize, Serialize};

use super::sheet_sides::observe_sheet;
use crate::calibrate::CalibrateConfig;
use crate::detect::{DetectConfig, Detection};
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::{SheetSize, Warp};
use crate::pattern::CheckerPattern;
use crate::photo::{Encoding, PhotoView};
use crate::rectify::rectify_checker;
use crate::rig::Rig;
use crate::verify::{Verification, VerifyConfig, outline, verify};

/// Parameters of [`verify_photo`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct VerifyPhotoConfig {
    /// The sheet's size; default that of the rig's first view. A paper by its name alone lies as it fits.
    pub size: Option<SheetSize>,
    /// The pattern is projected as it was drawn, anywhere on the sheet, and not rectified for the rig's first view.
    pub as_drawn: bool,
    /// The picture appears with left and right exchanged; it counts as such where the rig says so, too.
    pub mirrored: bool,
    /// The transfer curve of the photograph; default sRGB.
    pub encoding: Encoding,
    /// The sheet's corners TL, TR, BR, BL by hand, px, when it is not found.
    pub corners: Option<[Point2<f64>; 4]>,
    /// False-alarm rate of the test whether the rig has moved; default 0.001.
    pub significance: f64,
}

impl Default for VerifyPhotoConfig {
    fn default() -> Self {
        Self {
            size: None,
            as_drawn: false,
            mirrored: false,
            encoding: Encoding::default(),
            corners: None,
            significance: VerifyConfig::default().significance,
        }
    }
}

impl VerifyPhotoConfig {
    /// Checks all values.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the field.
    pub fn validate(&self) -> Result<()> {
        self.test().validate()?;
        self.detect(None).validate()
    }

    fn test(&self) -> VerifyConfig {
        VerifyConfig { significance: self.significance }
    }

    fn detect(&self, panel_from_pattern: Option<Warp>) -> DetectConfig {
        DetectConfig { encoding: self.encoding, corners: self.corners, panel_from_pattern }
    }
}

/// The detection in a photograph and its comparison with the rig.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct VerifiedPhoto {
    /// The sheet and the pattern; the pairs have their pixels on the panel.
    pub detection: Detection,
    /// Keystone and tests.
    pub verification: Verification,
}

/// Compares photographs of a projected checkerboard with a rig: how much keystone remains on the sheet, and whether camera
/// or projector have moved. Rig, pattern and configuration are checked once, before the first photograph.
///
/// # Examples
/// ```
/// use slcal_core::{PhotoVerifier, PhotoView, VerifyPhotoConfig};
///
/// # let checker = slcal_core::CheckerPattern::new([1024, 768], &Default::default())?;
/// # let sheet = image::open(concat!(env!("CARGO_MANIFEST_DIR"), "/../slcal-cli/demo/sheet.jpg"))?;
/// # let mut calibrator = slcal_core::Calibrator::new("594x420mm".parse()?).with_pattern(&checker);
/// # calibrator.add(slcal_core::PhotoView::try_from(&sheet)?)?;
/// # let rig = calibrator.calibrate()?.rig;
/// // The pattern is projected as it was drawn, not rectified for the sheet.
/// let config = VerifyPhotoConfig { as_drawn: true, ..VerifyPhotoConfig::default() };
/// let verifier = PhotoVerifier::new(&rig, &checker, &config)?;
/// let verified = verifier.verify(PhotoView::try_from(&sheet)?)?;
/// assert!(!verified.verification.rig_moved());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct PhotoVerifier<'a> {
    rig: &'a Rig,
    /// As it lies on the panel.
    pattern: Cow<'a, CheckerPattern>,
    size: SheetSize,
    detect: DetectConfig,
    test: VerifyConfig,
    /// The whole pattern on the panel, and the aspect that it should have.
    outline_px: [Point2<f64>; 4],
    aspect: f64,
}

impl<'a> PhotoVerifier<'a> {
    /// Works out where the pattern is projected.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a rig without a projector, a pattern for another panel, a rig without views unless the pattern
    /// is projected as drawn and the size is given, and values out of range; otherwise as [`rectify_checker`].
    pub fn new(rig: &'a Rig, pattern: &'a CheckerPattern, config: &VerifyPhotoConfig) -> Result<Self> {
        config.validate()?;
        rig.projector_for(ErrorSubject::Checkerboard, pattern.projector)?;
        let size = config.size.or_else(|| rig.views.first().map(|v| v.size.into())).ok_or_else(|| {
            Error::invalid(
                ErrorSubject::SheetSize,
                "the sheet's size, since the rig holds no view of a sheet",
                "none",
            )
        })?;
        let drawn =
            if config.as_drawn { None } else { Some(rectify_checker(rig, 0, pattern)?.panel_from_source) };
        // A rectified picture is mirrored once more when it is drawn, and lies upright on the panel.
        let mirrored = config.as_drawn && (config.mirrored || rig.is_mirrored());
        let pattern = if mirrored { Cow::Owned(pattern.mirrored()) } else { Cow::Borrowed(pattern) };
        let (outline_px, aspect) = outline(&pattern, drawn.as_ref()).ok_or_else(|| {
            Error::invalid(ErrorSubject::Pattern, "one that can be drawn on the panel", "a point at infinity")
        })?;
        let (detect, test) = (config.detect(drawn), config.test());
        Ok(Self { rig, pattern, size, detect, test, outline_px, aspect })
    }

    /// Finds sheet and pattern in a photograph and compares them with the rig.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a photograph of another size than the camera's; [`Error::NotFound`] when the checkerboard or the
    /// sheet is not seen; [`Error::Degenerate`] when the photograph and the rig do not go together at all.
    pub fn verify(&self, photo: PhotoView<'_>) -> Result<VerifiedPhoto> {
        let (camera, found) = (self.rig.camera.model, [photo.width(), photo.height()]);
        if [camera.width as usize, camera.height as usize] != found {
            return Err(Error::invalid(
                ErrorSubject::Photograph,
                format!(
                    "{}x{} pixels, as the rig's camera has (a rig holds for one camera at one resolution, uncropped)",
                    camera.width, camera.height
                ),
                format!("{}x{}", found[0], found[1]),
            ));
        }
        let known = CalibrateConfig { known_camera: Some(camera), ..CalibrateConfig::default() };
        let detection = observe_sheet(photo, None, self.size, Some(&self.pattern), &self.detect, &known)?;
        let verification =
            verify(self.rig, &detection.observation, &self.outline_px, self.aspect, self.test)?;
        Ok(VerifiedPhoto { detection, verification })
    }
}

/// How square a projected checkerboard is on the sheet, and whether the rig has moved, by one photograph of it:
/// [`PhotoVerifier`] for a single one.
///
/// # Errors
/// As [`PhotoVerifier::new`] and [`PhotoVerifier::verify`].
pub fn verify_photo(
    rig: &Rig,
    photo: PhotoView<'_>,
    pattern: &CheckerPattern,
    config: &VerifyPhotoConfig,
) -> Result<VerifiedPhoto> {
    PhotoVerifier::new(rig, pattern, config)?.verify(photo)
}

#[cfg(test)]
mod tests {
    use image::{DynamicImage, RgbImage};

    use super::*;
    use crate::pattern::CheckerConfig;
    use crate::rectify::rectify_checker_picture;
    use crate::simulate::{
        Photographer, PoseConfig, ProjectedImage, RenderConfig, RigConfig, Scene, Shape, Surface,
    };

    fn config() -> RigConfig {
        RigConfig { camera: [800, 600], camera_focal_px: 940.0, ..RigConfig::default() }
    }

    /// A rig whose first view is the sheet that it is photographed with.
    fn rig() -> Rig {
        Scene::new(&config(), &[PoseConfig::tilted(20.0, 22.0)]).unwrap().rig()
    }

    fn photograph(rig: &Rig, shown: &RgbImage) -> DynamicImage {
        let sheet = Shape::Rectangle {
            camera_from_rectangle: rig.views[0].camera_from_sheet,
            size: rig.views[0].size,
        };
        let surfaces = [Surface::object(sheet)];
        let photographer = Photographer::new(rig, &surfaces, &RenderConfig::default()).unwrap();
        photographer.photograph(ProjectedImage::Picture(shown), 0).unwrap()
    }

    /// As large as falls on the tilted sheet.
    fn pattern() -> CheckerPattern {
        let checker = CheckerConfig { square_px: Some(40.0), ..CheckerConfig::default() };
        CheckerPattern::new([1024, 768], &checker).unwrap()
    }

    #[test]
    fn a_rectified_and_a_drawn_pattern_are_told_apart() {
        let (rig, pattern) = (rig(), pattern());
        let (straight, _) = rectify_checker_picture(&rig, 0, &pattern).unwrap();
        let photo = photograph(&rig, &straight);
        let view = PhotoView::try_from(&photo).unwrap();
        let found = verify_photo(&rig, view, &pattern, &VerifyPhotoConfig::default()).unwrap();
        assert_eq!(found.detection.pattern_corners, 70);
        let v = &found.verification;
        let worst = v.keystone.worst_rad;
        assert!(worst.value.abs() < 4.0 * worst.sigma + 1e-4, "{worst:?}");
        // The true rig is certain of itself, so that hundredths of a pixel of the detector's count as moved; what they are on
        // the sheet does not.
        assert!(v.rig.pattern_off_mm < 0.1 && v.sheet.unwrap().shift_mm < 0.2, "{v:?}");

        let photo = photograph(&rig, &pattern.image().unwrap());
        let view = PhotoView::try_from(&photo).unwrap();
        let as_drawn = VerifyPhotoConfig { as_drawn: true, ..VerifyPhotoConfig::default() };
        let found = verify_photo(&rig, view, &pattern, &as_drawn).unwrap().verification;
        assert!(found.rig.pattern_off_mm < 0.1 && found.keystone.worst_rad.value.abs() > 0.05, "{found:?}");
        // Said to be rectified, it does not fit.
        let wrong = verify_photo(&rig, view, &pattern, &VerifyPhotoConfig::default()).unwrap();
        assert!(wrong.verification.rig.moved && wrong.verification.rig.pattern_off_mm > 2.0, "{wrong:?}");

        // A rig without views needs the size, and cannot have rectified anything.
        let bare = Rig { views: Vec::new(), ..rig };
        let error = verify_photo(&bare, view, &pattern, &as_drawn).unwrap_err();
        assert!(matches!(&error, Error::Invalid { what, .. } if *what == ErrorSubject::SheetSize), "{error}");
        let size = Some(config().size.into());
        let sized = VerifyPhotoConfig { size, ..as_drawn };
        let found = verify_photo(&bare, view, &pattern, &sized).unwrap().verification;
        assert!(found.rig.pattern_off_mm < 0.1 && found.sheet.is_none(), "{found:?}");
        let rectified = VerifyPhotoConfig { as_drawn: false, ..sized };
        assert!(verify_photo(&bare, view, &pattern, &rectified).is_err());
    }

    #[test]
    fn what_does_not_belong_together_is_refused() {
        let (rig, pattern) = (rig(), pattern());
        let small = DynamicImage::ImageRgb8(RgbImage::new(640, 480));
        let view = PhotoView::try_from(&small).unwrap();
        let default = VerifyPhotoConfig::default();
        let error = verify_photo(&rig, view, &pattern, &default).unwrap_err().to_string();
        assert!(error.contains("800x600") && error.contains("640x480"), "{error}");
        let other = CheckerPattern::new([800, 600], &CheckerConfig::default()).unwrap();
        let error = PhotoVerifier::new(&rig, &other, &default).unwrap_err().to_string();
        assert!(error.contains("1024x768") && error.contains("800x600"), "{error}");
        let alone = Rig { projector: None, ..rig.clone() };
        assert!(PhotoVerifier::new(&alone, &pattern, &default).is_err());
        for wrong in [
            VerifyPhotoConfig { significance: 2.0, ..default.clone() },
            VerifyPhotoConfig { corners: Some([Point2::origin(); 4]), ..default },
        ] {
            assert!(wrong.validate().is_err() && PhotoVerifier::new(&rig, &pattern, &wrong).is_err());
        }
    }
}
