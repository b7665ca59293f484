//! The whole stage on drawn photographs with known truth, and on the rendered scenes where they are at hand.

use image::{DynamicImage, GrayImage, Luma};
use nalgebra::{Matrix3, Point2};

use super::*;
use crate::error::{Error, ErrorSubject, Result};
use crate::for_tests::rendered_scenes;
use crate::geometry::{Homography, Line, RectangleSize};
use crate::observations::{SheetObservation, ViewObservation};
use crate::pattern::{CheckerPattern, SquareColor};
use crate::photo::{Encoding, PhotoView, Samples};
use crate::solve::homography_from_points;

pub(super) fn pattern() -> CheckerPattern {
    CheckerPattern {
        projector: [1024, 768],
        squares: [11, 8],
        square_px: 48.0,
        origin_px: Point2::new(247.5, 191.5),
        first_square: SquareColor::Black,
        background: SquareColor::White,
        marks: None,
    }
}

/// `camera_from_projector` of a panel whose corners are seen at the given pixels.
pub(super) fn from_panel(corners: [Point2<f64>; 4]) -> Homography {
    let border = [(-0.5, -0.5), (1023.5, -0.5), (1023.5, 767.5), (-0.5, 767.5)];
    let pairs: Vec<_> = border.iter().map(|b| Point2::new(b.0, b.1)).zip(corners).collect();
    homography_from_points(&pairs).unwrap()
}

/// A drawn photograph: a sheet and the pattern's light on it, and nothing else.
pub(super) struct Drawn {
    pub(super) size: [u32; 2],
    pub(super) sheet: [Point2<f64>; 4],
    pub(super) camera_from_projector: Option<Homography>,
}

impl Drawn {
    /// A tilted sheet with the whole pattern on it, scaled to a photograph `width` pixels wide.
    pub(super) fn tilted(width: u32) -> Self {
        let s = f64::from(width) / 640.0;
        let p = |x: f64, y: f64| Point2::new(x * s, y * s);
        let panel = [p(120.0, 40.0), p(640.0, 30.0), p(635.0, 440.0), p(165.0, 400.0)];
        Self {
            size: [width, width * 3 / 4],
            sheet: [p(100.3, 86.6), p(554.0, 73.8), p(556.6, 404.9), p(168.4, 347.0)],
            camera_from_projector: Some(from_panel(panel)),
        }
    }

    /// The same photograph with the camera turned upside down.
    fn turned(&self) -> Self {
        let (w, h) = (f64::from(self.size[0]) - 1.0, f64::from(self.size[1]) - 1.0);
        let turn = |p: Point2<f64>| Point2::new(w - p.x, h - p.y);
        let s = self.sheet.map(turn);
        let half = Homography(Matrix3::new(-1.0, 0.0, w, 0.0, -1.0, h, 0.0, 0.0, 1.0));
        Self {
            size: self.size,
            sheet: [s[2], s[3], s[0], s[1]],
            camera_from_projector: self.camera_from_projector.map(|c| half.compose(&c)),
        }
    }

    pub(super) fn light(&self, p: Point2<f64>, projector_from_camera: Option<&Homography>) -> f64 {
        if !sheet::contains(&self.sheet, p) {
            return 0.02;
        }
        let lit = projector_from_camera.and_then(|h| h.map(p)).map_or(0.0, |q| {
            let pattern = pattern();
            let on_panel = (-0.5..1023.5).contains(&q.x) && (-0.5..767.5).contains(&q.y);
            let s = (q - pattern.origin_px) / pattern.square_px;
            let on_board = (0.0..11.0).contains(&s.x) && (0.0..8.0).contains(&s.y);
            let black = on_board && (s.x.floor() + s.y.floor()) as i32 % 2 == 0;
            f64::from(u8::from(on_panel && !black))
        });
        0.15 + 0.6 * lit
    }

    pub(super) fn draw(&self) -> DynamicImage {
        const SUB: i32 = 6;
        let inverse = self.camera_from_projector.map(|h| h.inverse().unwrap());
        let image = GrayImage::from_fn(self.size[0], self.size[1], |x, y| {
            let mut sum = 0.0;
            for j in 0..SUB {
                for i in 0..SUB {
                    let offset = |k: i32| (f64::from(k) + 0.5) / f64::from(SUB) - 0.5;
                    sum += self.light(
                        Point2::new(f64::from(x) + offset(i), f64::from(y) + offset(j)),
                        inverse.as_ref(),
                    );
                }
            }
            let code = Encoding::Srgb.from_linear(sum / f64::from(SUB * SUB)) * 255.0;
            Luma([code.round() as u8])
        });
        DynamicImage::ImageLuma8(image)
    }

    fn observe(&self, pattern: Option<&CheckerPattern>) -> Result<Detection> {
        let image = self.draw();
        let size = RectangleSize::new(594.0, 420.0)?;
        observe(PhotoView::try_from(&image)?, None, size, pattern, &DetectConfig::default())
    }

    fn assert_found(&self, detection: &Detection, scale: f64) {
        let corners = detection.observation.sheet.corners().unwrap();
        for (found, truth) in corners.iter().zip(&self.sheet) {
            assert!((found - truth).norm() < 0.05 * scale, "{found} for {truth}");
        }
        if let SheetObservation::Edges(sides) = &detection.observation.sheet {
            for (i, side) in sides.iter().enumerate() {
                let line = Line::through_pixels(self.sheet[i], self.sheet[(i + 1) % 4]).normalized().unwrap();
                let mean =
                    side.iter().map(|p| line.signed_distance_px(p.position)).sum::<f64>() / side.len() as f64;
                assert!(mean.abs() < 0.02 * scale, "side {i}: {mean}");
            }
        }
        let h = self.camera_from_projector.unwrap();
        for pair in &detection.observation.pairs {
            let error = (h.map(pair.projector).unwrap() - pair.camera).norm();
            assert!(error < 0.05 * scale, "{:?} is off by {error}", pair.projector);
        }
    }
}

#[test]
fn finds_sheet_and_pattern_to_sub_pixel() {
    let drawn = Drawn::tilted(640);
    let detection = drawn.observe(Some(&pattern())).unwrap();
    assert_eq!(detection.observation.pairs.len(), 70, "{:?}", detection.notes);
    drawn.assert_found(&detection, 1.0);
}

#[test]
fn a_large_photograph_gives_the_same() {
    let drawn = Drawn::tilted(2600);
    let detection = drawn.observe(Some(&pattern())).unwrap();
    assert_eq!(detection.observation.pairs.len(), 70, "{:?}", detection.notes);
    drawn.assert_found(&detection, 2.0);
}

#[test]
fn the_half_turn_is_resolved_and_the_sheet_named_as_the_camera_sees_it() {
    let drawn = Drawn::tilted(640).turned();
    let detection = drawn.observe(Some(&pattern())).unwrap();
    assert_eq!(detection.observation.pairs.len(), 70, "{:?}", detection.notes);
    drawn.assert_found(&detection, 1.0);
}

#[test]
fn without_a_pattern_the_bright_quadrilateral_is_the_sheet() {
    let drawn = Drawn { camera_from_projector: None, ..Drawn::tilted(640) };
    let corners = drawn.observe(None).unwrap().observation.sheet.corners().unwrap();
    for (found, truth) in corners.iter().zip(&drawn.sheet) {
        assert!((found - truth).norm() < 0.05, "{found} for {truth}");
    }
}

#[test]
fn corners_and_sheet_are_found_each_by_itself() {
    let drawn = Drawn::tilted(640);
    let image = drawn.draw();
    let view = PhotoView::try_from(&image).unwrap();
    let both = drawn.observe(Some(&pattern())).unwrap();
    let found = find_corners(view, &pattern(), &DetectConfig::default()).unwrap();
    assert_eq!((found.expected, &found.pairs), (70, &both.observation.pairs));

    // The sheet's own sides outside the frame.
    let close = image.crop_imm(170, 90, 380, 256);
    let view = PhotoView::try_from(&close).unwrap();
    let found = find_corners(view, &pattern(), &DetectConfig::default()).unwrap();
    let h = drawn.camera_from_projector.unwrap();
    assert!(found.pairs.len() >= 40, "{}", found.pairs.len());
    for pair in &found.pairs {
        let truth = h.map(pair.projector).unwrap() - nalgebra::Vector2::new(170.0, 90.0);
        assert!((truth - pair.camera).norm() < 0.05, "{:?}", pair.projector);
    }

    let bare = Drawn { camera_from_projector: None, ..Drawn::tilted(640) };
    let image = bare.draw();
    let view = PhotoView::try_from(&image).unwrap();
    let sheet = find_sheet(view, &DetectConfig::default()).unwrap();
    assert_eq!(sheet.observation, bare.observe(None).unwrap().observation.sheet);
    for (found, truth) in sheet.observation.corners().unwrap().iter().zip(&bare.sheet) {
        assert!((found - truth).norm() < 0.05, "{found} for {truth}");
    }
    let error = find_corners(view, &pattern(), &DetectConfig::default()).unwrap_err();
    assert!(matches!(error, Error::NotFound { what: ErrorSubject::Checkerboard, .. }), "{error}");
}

#[test]
fn every_layout_of_a_photograph_gives_the_same_detection() {
    let rgb = Drawn::tilted(640).draw().into_rgb8();
    let (width, height) = (rgb.width() as usize, rgb.height() as usize);
    let size = RectangleSize::new(594.0, 420.0).unwrap();
    let observed = |samples: Samples<'_>, stride, layout| {
        let view = PhotoView::new(samples, width, height, stride, layout).unwrap();
        observe(view, None, size, Some(&pattern()), &DetectConfig::default()).unwrap().observation
    };
    let points = |view: &ViewObservation| -> Vec<Point2<f64>> {
        view.pairs.iter().map(|p| p.camera).chain(view.sheet.corners().unwrap()).collect()
    };
    let mut first: Option<Vec<Point2<f64>>> = None;
    for (bytes, layout, stride) in crate::for_tests::layouts(&rgb, width) {
        let wide: Vec<u16> = bytes.iter().map(|&c| u16::from(c) * 257).collect();
        for samples in [Samples::U8(&bytes), Samples::U16(&wide)] {
            let found = points(&observed(samples, stride, layout));
            let first = first.get_or_insert_with(|| found.clone());
            assert_eq!(found.len(), first.len());
            assert!(found.iter().zip(&*first).all(|(a, b)| (a - b).norm() < 1e-4), "{layout:?}");
        }
    }
}

#[test]
fn the_corners_of_a_moved_pattern_have_their_pixels_on_the_panel() {
    let drawn = Drawn::tilted(640);
    let image = drawn.draw();
    let view = PhotoView::try_from(&image).unwrap();
    // The same light, said to be a pattern drawn half as large that was enlarged about the panel's origin.
    let half = CheckerPattern { square_px: 24.0, origin_px: pattern().origin_px / 2.0, ..pattern() };
    let twice = Homography(Matrix3::from_diagonal(&nalgebra::Vector3::new(2.0, 2.0, 1.0)));
    let config = DetectConfig { panel_from_pattern: Some(twice.into()), ..DetectConfig::default() };
    let found = find_corners(view, &half, &config).unwrap();
    let plain = find_corners(view, &pattern(), &DetectConfig::default()).unwrap();
    assert_eq!(found.pairs.len(), plain.pairs.len());
    for (a, b) in found.pairs.iter().zip(&plain.pairs) {
        assert!((a.projector - b.projector).norm() < 1e-9, "{a:?} {b:?}");
    }
    let singular = Homography(Matrix3::zeros());
    let config = DetectConfig { panel_from_pattern: Some(singular.into()), ..DetectConfig::default() };
    assert!(matches!(find_corners(view, &half, &config), Err(Error::Invalid { .. })));
}

#[test]
fn a_sheet_without_a_pattern_and_a_dark_room_are_not_found() {
    let bare = Drawn { camera_from_projector: None, ..Drawn::tilted(640) };
    let error = bare.observe(Some(&pattern())).unwrap_err();
    assert!(matches!(error, Error::NotFound { what: ErrorSubject::Checkerboard, .. }), "{error}");
    for level in [0_u8, 128] {
        let flat = DynamicImage::ImageLuma8(GrayImage::from_pixel(640, 480, Luma([level])));
        let size = RectangleSize::new(594.0, 420.0).unwrap();
        let view = PhotoView::try_from(&flat).unwrap();
        let error = observe(view, None, size, None, &DetectConfig::default()).unwrap_err();
        assert!(matches!(error, Error::NotFound { what: ErrorSubject::Sheet, .. }), "{error}");
    }
}

#[test]
fn tiny_photographs_are_refused_without_a_panic() {
    for (w, h) in [(1, 1), (1, 3000), (3, 700), (17, 16), (40, 30)] {
        let image =
            DynamicImage::ImageLuma8(GrayImage::from_fn(w, h, |x, y| Luma([(x * 40 + y * 13) as u8])));
        let size = RectangleSize::new(594.0, 420.0).unwrap();
        for p in [None, Some(&pattern())] {
            let view = PhotoView::try_from(&image).unwrap();
            assert!(observe(view, None, size, p, &DetectConfig::default()).is_err());
            assert!(p.is_none_or(|p| find_corners(view, p, &DetectConfig::default()).is_err()));
            assert!(find_sheet(view, &DetectConfig::default()).is_err());
        }
    }
}

#[test]
fn a_truncated_pattern_is_registered_by_its_border_or_rejected() {
    let whole = Drawn::tilted(640);
    // The left part cut away: two columns of squares and the border beside them are lost.
    let cut = whole.draw().crop_imm(300, 0, 340, 480);
    let size = RectangleSize::new(594.0, 420.0).unwrap();
    let config = DetectConfig {
        corners: Some(whole.sheet.map(|p| Point2::new(p.x - 300.0, p.y))),
        ..DetectConfig::default()
    };
    let detection =
        observe(PhotoView::try_from(&cut).unwrap(), None, size, Some(&pattern()), &config).unwrap();
    let h = whole.camera_from_projector.unwrap();
    assert!(detection.observation.pairs.len() < 70);
    for pair in &detection.observation.pairs {
        let truth = h.map(pair.projector).unwrap() - nalgebra::Vector2::new(300.0, 0.0);
        let error = (truth - pair.camera).norm();
        assert!(error < 0.05, "{:?} is off by {error}", pair.projector);
    }
}

#[test]
fn corners_by_hand_are_measured_or_kept() {
    let drawn = Drawn::tilted(640);
    let image = drawn.draw();
    let size = RectangleSize::new(594.0, 420.0).unwrap();
    let near = drawn.sheet.map(|p| p + nalgebra::Vector2::new(1.5, -2.0));
    let config = DetectConfig { corners: Some(near), ..DetectConfig::default() };
    let view = PhotoView::try_from(&image).unwrap();
    let found = observe(view, None, size, Some(&pattern()), &config).unwrap();
    assert!(found.notes.is_empty(), "{:?}", found.notes);
    drawn.assert_found(&found, 1.0);

    let elsewhere = drawn.sheet.map(|p| Point2::new(320.0, 240.0) + (p - Point2::new(320.0, 240.0)) * 1.3);
    let config = DetectConfig { corners: Some(elsewhere), ..DetectConfig::default() };
    let kept = observe(view, None, size, Some(&pattern()), &config).unwrap();
    assert!(
        matches!(kept.observation.sheet, SheetObservation::Corners { corners, .. } if corners == elsewhere)
    );
    assert_eq!(kept.notes.len(), 1);

    let crossed = [near[0], near[2], near[1], near[3]];
    let config = DetectConfig { corners: Some(crossed), ..DetectConfig::default() };
    assert!(matches!(observe(view, None, size, None, &config), Err(Error::Invalid { .. })));
}

#[test]
fn a_footprint_smaller_than_the_sheet_is_not_detected_as_the_sheet() {
    let p = |x: f64, y: f64| Point2::new(2.0 * x, 2.0 * y);
    let mut drawn = Drawn::tilted(1280);
    let panel = [p(190.0, 120.0), p(520.0, 105.0), p(515.0, 360.0), p(205.0, 330.0)];
    drawn.camera_from_projector = Some(from_panel(panel));
    let detection = drawn.observe(Some(&pattern())).unwrap();
    drawn.assert_found(&detection, 2.0);
}

#[test]
fn a_side_along_the_border_of_the_footprint_is_named() {
    let p = |x: f64, y: f64| Point2::new(2.0 * x, 2.0 * y);
    let crossing = |top: f64, bottom: f64| {
        let mut drawn = Drawn::tilted(1280);
        let panel = [p(120.0, 40.0), p(top, 30.0), p(bottom, 440.0), p(165.0, 400.0)];
        drawn.camera_from_projector = Some(from_panel(panel));
        drawn
    };
    // The sheet's right side runs from 554.0 to 556.6.
    let said = crossing(554.0, 558.0).observe(Some(&pattern())).unwrap_err().to_string();
    assert!(said.contains("the right one runs along the border of the projector footprint"), "{said}");
    // Where it is clear of the border in part, it is measured there or not at all, and never between the two.
    let mut found = 0;
    for (top, along) in
        [(540.0, 30.0), (550.0, 8.0), (552.0, 8.0), (553.0, 20.0), (556.0, -4.0), (558.0, -8.0)]
    {
        let drawn = crossing(top, top + along);
        let Ok(detection) = drawn.observe(Some(&pattern())) else { continue };
        let SheetObservation::Edges(sides) = &detection.observation.sheet else { panic!("edges") };
        let side = (drawn.sheet[2] - drawn.sheet[1]).normalize();
        for point in &sides[1] {
            let off = side.perp(&(point.position - drawn.sheet[1])).abs();
            assert!(
                off < 0.1 && off < 5.0 * point.sigma_px.unwrap(),
                "{top} {along}: {point:?} is off by {off}"
            );
        }
        found += 1;
    }
    assert!(found >= 3, "{found}");
}

#[test]
fn corners_beside_the_sheet_are_rejected() {
    let p = |x: f64, y: f64| Point2::new(x, y);
    let mut drawn = Drawn::tilted(640);
    let panel = [p(-60.0, 40.0), p(460.0, 30.0), p(455.0, 440.0), p(-15.0, 400.0)];
    drawn.camera_from_projector = Some(from_panel(panel));
    let detection = drawn.observe(Some(&pattern())).unwrap();
    assert!(detection.observation.pairs.len() < 70 && !detection.notes.is_empty());
    drawn.assert_found(&detection, 1.0);
}

#[test]
fn rendered_corners_are_within_hundredths_of_a_pixel_of_the_truth() {
    let Some(folder) = rendered_scenes("") else { return };
    // (scene, rms per coordinate of the corners allowed, px): the last has 3 % of noise at a tenth of the contrast.
    for (scene, limit) in [
        ("paper_tilted", 0.01),
        ("paper_lensshift", 0.01),
        ("pair_a", 0.01),
        ("pair_b", 0.01),
        ("dark_clutter", 0.03),
    ] {
        let image = image::open(folder.join(scene).join("checker.png")).unwrap();
        let size = RectangleSize::new(594.0, 420.0).unwrap();
        let view = PhotoView::try_from(&image).unwrap();
        let found = observe(view, None, size, Some(&pattern()), &DetectConfig::default()).unwrap();
        let truth = std::fs::read(folder.join(scene).join("checker_corners.json")).unwrap();
        let truth: serde_json::Value = serde_json::from_slice(&truth).unwrap();
        let points = |key: &str| -> Vec<Point2<f64>> {
            let list = truth[key].as_array().unwrap();
            list.iter().map(|p| Point2::new(p[0].as_f64().unwrap(), p[1].as_f64().unwrap())).collect()
        };
        let (projector, camera) = (points("corners_projector_px"), points("corners_camera_px"));
        let pairs = &found.observation.pairs;
        assert_eq!(pairs.len(), 70, "{scene}");
        let mut sum = 0.0;
        for pair in pairs {
            let k = projector.iter().position(|p| (p - pair.projector).norm() < 1e-6).unwrap();
            sum += (pair.camera - camera[k]).norm_squared();
        }
        let rms = (sum / pairs.len() as f64 / 2.0).sqrt();
        assert!(rms < limit, "{scene}: {rms} px");
    }
}
