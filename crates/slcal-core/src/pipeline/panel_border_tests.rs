//! Photographs of a picture that was shown in another way than it was drawn, from pixels to the warning.

use image::DynamicImage;
use nalgebra::Vector2;

use super::{Calibrator, SheetPhoto};
use crate::pattern::{CheckerConfig, CheckerPattern, Pattern};
use crate::photo::PhotoView;
use crate::rig::{Quality, Verdict};
use crate::simulate::{PatternKind, Photographer, ProjectedImage, RigConfig, SceneSetup, SurfaceKind};

/// A picture's pixel p is shown at the panel's pixel scale·p + offset.
#[derive(Clone, Copy)]
struct Shown {
    scale: f64,
    offset: Vector2<f64>,
}

const AS_DRAWN: Shown = Shown { scale: 1.0, offset: Vector2::new(0.0, 0.0) };

fn centred(scale: f64) -> Shown {
    Shown { scale, offset: Vector2::new(1023.0, 767.0) * ((1.0 - scale) / 2.0) }
}

fn drawn(marks: bool) -> CheckerPattern {
    CheckerPattern::new([1024, 768], &CheckerConfig { marks, ..CheckerConfig::default() }).unwrap()
}

/// What appears on the panel.
fn appearing(drawn: &CheckerPattern, shown: Shown) -> CheckerPattern {
    let mut on_panel = drawn.clone();
    on_panel.square_px *= shown.scale;
    on_panel.origin_px = drawn.origin_px * shown.scale + shown.offset;
    if let Some(marks) = &mut on_panel.marks {
        marks.side_px *= shown.scale;
        marks.centres_px.iter_mut().for_each(|c| *c = *c * shown.scale + shown.offset);
    }
    on_panel
}

/// The sheet under a picture. The light of this projector ends on the sheet all around.
fn photograph(picture: &image::RgbImage, tilt_deg: [f64; 2], focal_px: f64) -> DynamicImage {
    let setup = SceneSetup {
        rig: RigConfig { projector_focal_px: focal_px, ..RigConfig::default() },
        surface: SurfaceKind::Sheet,
        turn_rad: Some([tilt_deg[0].to_radians(), tilt_deg[1].to_radians(), 0.0]),
        pattern: PatternKind::Known(Pattern::Checker(drawn(false))),
        ..SceneSetup::default()
    };
    let stage = setup.set_up().unwrap();
    let photographer = Photographer::new(&stage.rig, &stage.surfaces, &stage.render).unwrap();
    photographer.photograph(ProjectedImage::Picture(picture), 0).unwrap()
}

/// The quality of the calibration and the number of points at the panel's border that were found.
fn calibrated(photos: &[DynamicImage], pattern: &CheckerPattern) -> (Quality, usize) {
    let mut calibrator = Calibrator::new("594x420mm".parse().unwrap()).with_pattern(pattern);
    for photo in photos {
        calibrator.add(SheetPhoto::new(PhotoView::try_from(photo).unwrap())).unwrap();
    }
    let points = calibrator.detections().iter().map(|d| d.observation.panel_points.len()).sum();
    (calibrator.calibrate().unwrap().rig.quality.unwrap(), points)
}

fn told(quality: &Quality) -> Option<&str> {
    let found = quality.warnings.iter().find(|w| w.code == "shown-1:1")?;
    assert!(quality.verdict >= Verdict::Weak);
    Some(&found.message)
}

const WIDE_SHEET: f64 = 2300.0;

#[test]
fn a_scaled_picture_is_named_where_its_light_ends_on_the_sheet() {
    for (scale, percent) in [(0.95, 95.0), (1.05, 105.0), (0.9, 90.0)] {
        let picture = appearing(&drawn(false), centred(scale)).image().unwrap();
        let photo = photograph(&picture, [25.0, 28.0], WIDE_SHEET);
        let (quality, _) = calibrated(&[photo], &drawn(false));
        let message = told(&quality).unwrap();
        let (_, rest) = message.split_once("pixel for pixel: at ").unwrap();
        let found: f64 = rest.split(' ').next().unwrap().parse().unwrap();
        assert!((found - percent).abs() < 0.5, "{message}");
    }
}

#[test]
fn a_picture_as_it_was_drawn_is_seen_to_be_so_with_and_without_marks() {
    for tilt in [[25.0, 28.0], [-22.0, -25.0], [-20.0, 24.0]] {
        for marks in [false, true] {
            let photo = photograph(&drawn(marks).image().unwrap(), tilt, WIDE_SHEET);
            let (quality, points) = calibrated(&[photo], &drawn(marks));
            assert_eq!(told(&quality), None);
            assert!(points > 40, "{points}");
        }
    }
}

#[test]
fn light_that_reaches_beyond_the_sheet_shows_nothing() {
    let picture = appearing(&drawn(false), centred(0.95)).image().unwrap();
    let photo = photograph(&picture, [25.0, 28.0], 1400.0);
    let mut calibrator = Calibrator::new("594x420mm".parse().unwrap()).with_pattern(&drawn(false));
    let found = calibrator.add(SheetPhoto::new(PhotoView::try_from(&photo).unwrap())).unwrap();
    assert!(found.observation.panel_points.is_empty());
}

#[test]
fn a_mirrored_picture_that_is_said_to_be_one_calibrates() {
    let pattern = drawn(true);
    let mirrored = image::imageops::flip_horizontal(&pattern.image().unwrap());
    let photo = photograph(&mirrored, [25.0, 28.0], WIDE_SHEET);
    let calibrate = |photo: &DynamicImage| {
        let mut calibrator = Calibrator::new("594x420mm".parse().unwrap()).with_mirrored_pattern(&pattern);
        calibrator.add(SheetPhoto::new(PhotoView::try_from(photo).unwrap())).unwrap();
        calibrator.calibrate().unwrap().rig
    };
    let rig = calibrate(&photo);
    assert!(rig.is_mirrored());
    assert_eq!(told(rig.quality.as_ref().unwrap()), None);
    let upright = photograph(&pattern.image().unwrap(), [25.0, 28.0], WIDE_SHEET);
    let rig = calibrate(&upright);
    assert!(told(rig.quality.as_ref().unwrap()).unwrap().contains("other way round than was said"));
}

#[test]
fn a_mirrored_picture_is_named_by_its_marks() {
    let pattern = drawn(true);
    let mirrored = image::imageops::flip_horizontal(&pattern.image().unwrap());
    let (quality, _) = calibrated(&[photograph(&mirrored, [25.0, 28.0], WIDE_SHEET)], &pattern);
    assert!(told(&quality).unwrap().contains("mirrored, left and right"));
    // Without marks the board looks the same.
    let mirrored = image::imageops::flip_horizontal(&drawn(false).image().unwrap());
    let (quality, _) = calibrated(&[photograph(&mirrored, [25.0, 28.0], WIDE_SHEET)], &drawn(false));
    assert_eq!(told(&quality), None);
}

#[test]
fn marks_do_not_disturb_the_calibration() {
    let focal = |marks: bool| {
        let pattern = drawn(marks);
        let picture = appearing(&pattern, AS_DRAWN).image().unwrap();
        let photos = [[25.0, 28.0], [-22.0, -25.0]].map(|tilt| photograph(&picture, tilt, WIDE_SHEET));
        let mut calibrator = Calibrator::new("594x420mm".parse().unwrap()).with_pattern(&pattern);
        for photo in &photos {
            calibrator.add(SheetPhoto::new(PhotoView::try_from(photo).unwrap())).unwrap();
        }
        let rig = calibrator.calibrate().unwrap().rig;
        let device = |d: &crate::rig::Device| (d.model.intrinsics.fx, d.sigma.unwrap().focal_px);
        [device(&rig.camera), device(&rig.projector.unwrap().device)]
    };
    for ((with, sigma), (without, _)) in focal(true).into_iter().zip(focal(false)) {
        assert!((with - without).abs() < 3.0 * sigma, "{with} {without} ± {sigma}");
    }
}
