//! A projector that exchanges left and right of its pictures, from photographs to points.

use image::DynamicImage;

use super::{Calibrator, PhotoVerifier, ReconstructConfig, Reconstructor, SheetPhoto, VerifyPhotoConfig};
use crate::decode::{DecodeConfig, Decoder};
use crate::pattern::{CheckerConfig, CheckerPattern, Pattern, StripeConfig, StripePattern};
use crate::photo::PhotoView;
use crate::rectify::rectify_checker_picture;
use crate::rig::Rig;
use crate::simulate::{
    PatternKind, Photographer, ProjectedImage, RigConfig, SceneSetup, SimulatedScene, SurfaceKind,
};

/// 10 columns: the mirrored board has other colours.
fn checker() -> CheckerPattern {
    let config = CheckerConfig { squares: [10, 7], ..CheckerConfig::default() };
    CheckerPattern::new([1024, 768], &config).unwrap()
}

fn stripes() -> StripePattern {
    StripePattern::new([1024, 768], &StripeConfig::default()).unwrap()
}

fn setup(surface: SurfaceKind, pattern: Pattern) -> SceneSetup {
    SceneSetup {
        rig: RigConfig { projector_focal_px: 2300.0, ..RigConfig::default() },
        surface,
        pattern: PatternKind::Known(pattern),
        mirrored: true,
        ..SceneSetup::default()
    }
}

fn view(photo: &DynamicImage) -> PhotoView<'_> {
    PhotoView::try_from(photo).unwrap()
}

fn sheet() -> SimulatedScene {
    setup(SurfaceKind::Sheet, Pattern::Checker(checker())).photograph().unwrap()
}

fn calibrated(photo: &DynamicImage) -> Rig {
    let mut calibrator = Calibrator::new("594x420mm".parse().unwrap()).with_mirrored_pattern(&checker());
    calibrator.add(SheetPhoto::new(view(photo))).unwrap();
    calibrator.calibrate().unwrap().rig
}

#[test]
fn the_rig_is_that_of_the_panel() {
    let scene = sheet();
    let rig = calibrated(&scene.photo);
    let (found, truth) = (rig.projector.unwrap(), scene.rig.projector.unwrap());
    assert!(found.mirrored && truth.mirrored);
    let sigma = found.device.sigma.unwrap();
    let [found, truth] = [found, truth].map(|p| p.device.model.intrinsics);
    assert!((found.fx - truth.fx).abs() < 3.0 * sigma.focal_px, "{found:?} {truth:?}");
    assert!((found.cx - truth.cx).abs() < 3.0 * sigma.cx_px, "{found:?} {truth:?}");
}

#[test]
fn columns_are_those_of_the_panel_and_slits_those_of_the_pattern() {
    let scene = setup(SurfaceKind::Plane, Pattern::Stripes(stripes())).photograph().unwrap();
    let config = DecodeConfig { mirrored: true, ..DecodeConfig::default() };
    let mut decoder = Decoder::new(&stripes(), config).unwrap();
    let decoded = decoder.decode(view(&scene.photo)).unwrap();
    assert!(!decoded.report.reversed);
    let pattern = stripes();
    for m in decoded.matches.items.iter().chain(&scene.matches.items) {
        let drawn = pattern.centres_px[usize::from(m.slit.unwrap())];
        assert_eq!(m.projector_column, Some(1023.0 - drawn));
    }
    let truth = scene.columns();
    let off = decoded.matches.items.iter().map(|m| {
        let (x, y) = (m.camera.x.round() as usize, m.camera.y.round() as usize);
        (f64::from(truth[1280 * y + x]) - m.projector_column.unwrap()).abs()
    });
    let wrong = off.filter(|d| *d > 2.0).count();
    assert!(decoded.matches.items.len() > 10_000 && wrong < 20, "{wrong} of {}", decoded.matches.items.len());
}

#[test]
fn points_follow_from_a_rig_that_says_so_and_else_the_reason_is_named() {
    let scene = setup(SurfaceKind::Plane, Pattern::Stripes(stripes())).photograph().unwrap();
    let points = |rig: &Rig, config: ReconstructConfig| {
        let mut reconstructor = Reconstructor::new(rig, &stripes(), config).unwrap();
        reconstructor.reconstruct(view(&scene.photo)).map(|r| r.cloud.points.clone())
    };
    let found = points(&scene.rig, ReconstructConfig::default()).unwrap();
    assert!(found.len() > 10_000);
    for p in found.iter().step_by(97) {
        let truth = scene.photographer.trace(p.pixel).unwrap().point;
        assert!((p.position - truth).norm() < 2.0, "{p:?} {truth:?}");
    }
    let mut unsaid = scene.rig.clone();
    unsaid.projector.as_mut().unwrap().mirrored = false;
    let message = points(&unsaid, ReconstructConfig::default()).unwrap_err().to_string();
    assert!(message.contains("left and right of the picture exchanged"), "{message}");
    // Said of the photograph instead.
    let mut config = ReconstructConfig::default();
    config.decode.mirrored = true;
    assert_eq!(points(&unsaid, config).unwrap(), found);
}

#[test]
fn a_rectified_picture_is_upright_on_the_sheet() {
    let scene = sheet();
    let rig = calibrated(&scene.photo);
    let verified = |photo: &DynamicImage, as_drawn| {
        let config = VerifyPhotoConfig { as_drawn, ..VerifyPhotoConfig::default() };
        PhotoVerifier::new(&rig, &checker(), &config).unwrap().verify(view(photo)).unwrap().verification
    };
    assert!(!verified(&scene.photo, true).rig_moved());
    let (picture, _) = rectify_checker_picture(&rig, 0, &checker()).unwrap();
    let photographer =
        Photographer::new(&scene.rig, scene.photographer.surfaces(), scene.photographer.config());
    let photo = photographer.unwrap().photograph(ProjectedImage::Picture(&picture), 1).unwrap();
    assert!(!verified(&photo, false).rig_moved());
}
