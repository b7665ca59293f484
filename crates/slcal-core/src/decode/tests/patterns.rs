//! Patterns of other programs and photographs of other sizes, through the whole decoder.

use image::{DynamicImage, RgbImage};
use nalgebra::Matrix3;

use super::{decode_image, measure_errors, pattern, photograph, slanted};
use crate::decode::{DecodeConfig, Decoding, decode};
use crate::geometry::Homography;
use crate::pattern::{Axis, StripeConfig, StripePattern};
use crate::photo::PhotoView;
use crate::{Error, ErrorClass, ErrorSubject};

fn scaled(scale: f64, shift: f64) -> Homography {
    // The stripes lean a little: every scanline crosses them at another phase.
    Homography(Matrix3::new(scale, 0.05 * scale, shift, 0.0, scale, -200.0 * scale, 2e-5, 0.0, 1.0))
}

/// The number of matches over the expected number of crossings of scanlines with completely visible slits.
fn found(decoding: &Decoding, pattern: &StripePattern, size: [u32; 2], h: &Homography) -> f64 {
    let back = h.inverse().unwrap();
    let mut expected = 0;
    for y in 0..size[1] {
        let ends = [-0.5, f64::from(size[0]) - 0.5]
            .map(|x| back.map(nalgebra::Point2::new(x, f64::from(y))).unwrap().x);
        let whole = |c: &&f64| **c - pattern.width_px > ends[0] && **c + pattern.width_px < ends[1];
        expected += pattern.centres_px.iter().filter(whole).count();
    }
    decoding.matches.items.len() as f64 / expected as f64
}

#[test]
fn three_hues_of_order_four_on_uneven_rows_decode() {
    let config =
        StripeConfig { hues: 3, order: 4, slits: Some(61), axis: Axis::Rows, ..StripeConfig::default() };
    let mut rows = StripePattern::new([800, 854], &config).unwrap();
    // Another program's slits: of another width, and displaced by up to a pixel and a half.
    rows.width_px = 6.0;
    for (k, c) in rows.centres_px.iter_mut().enumerate() {
        *c += [0.0, 1.5, -1.0, 0.5, -1.5][k % 5];
    }
    rows.validate().unwrap();
    let h = Homography(Matrix3::new(1.0, 0.03, -300.0, 0.04, 1.25, 10.0, 1e-5, 1e-4, 1.0));
    let decoding = decode_image(photograph(&rows, [140, 1000], &h), &rows).unwrap();
    let (right, bias, rms) = measure_errors(&decoding, &rows, &h);
    assert!(right == 1.0 && bias.abs() < 0.02 && rms < 0.08, "{right} {bias} {rms}");
    assert!(decoding.report.slits >= 59 && decoding.matches.items.len() > 57 * 140, "{:?}", decoding.report);
    assert!(decoding.matches.items.iter().all(|m| m.projector_column.is_none()));
}

/// Decodes a part of a photograph with the whole pattern.
fn check_part(from: u32, width: u32) {
    let (columns, h) = (pattern(Axis::Columns), slanted());
    let whole = photograph(&columns, [1060, 120], &h);
    let part = image::imageops::crop_imm(&whole, from, 0, width, 120).to_image();
    let shifted = Homography(Matrix3::new(1.0, 0.0, -f64::from(from), 0.0, 1.0, 0.0, 0.0, 0.0, 1.0) * h.0);
    let decoding = decode_image(part, &columns).unwrap();
    let (right, bias, rms) = measure_errors(&decoding, &columns, &shifted);
    assert!(right == 1.0 && bias.abs() < 0.01 && rms < 0.06, "{right} {bias} {rms}");
    let found = found(&decoding, &columns, [width, 120], &shifted);
    assert!(found > 0.95, "{found} from {from}: {:?}", decoding.report);
}

#[test]
fn a_photograph_of_a_part_of_the_pattern_decodes() {
    check_part(330, 250);
    check_part(700, 360);
}

#[test]
fn a_part_in_which_one_hue_prevails_decodes() {
    check_part(0, 400);
}

#[test]
fn sixteen_bits_decode_as_eight_do() {
    let (columns, h) = (pattern(Axis::Columns), slanted());
    let eight = photograph(&columns, [1000, 80], &h);
    let decode = |photo: &DynamicImage| {
        decode(PhotoView::try_from(photo).unwrap(), &columns, &DecodeConfig::default()).unwrap()
    };
    let a = decode(&DynamicImage::from(eight.clone()));
    // 257 times the value: the same light, sample by sample.
    let b = decode(&DynamicImage::from(DynamicImage::from(eight).into_rgb16()));
    assert_eq!(a.matches.items.len(), b.matches.items.len());
    for (a, b) in a.matches.items.iter().zip(&b.matches.items) {
        assert!(a.slit == b.slit && (a.camera - b.camera).norm() < 1e-3, "{a:?} {b:?}");
    }
}

#[test]
fn stripes_of_sixty_pixels_and_of_three_decode() {
    let columns = pattern(Axis::Columns);
    // The first is a strip of a photograph of 24 megapixels through a lens that sees two fifths of the pattern.
    for (scale, shift, size) in [(7.5, -1800.0, [3000, 90]), (0.375, 4.0, [400, 90])] {
        let h = scaled(scale, shift);
        let decoding = decode_image(photograph(&columns, size, &h), &columns).unwrap();
        let (right, bias, rms) = measure_errors(&decoding, &columns, &h);
        assert!(right > 0.999 && bias.abs() < 0.02 && rms < 0.1, "{scale}: {right} {bias} {rms}");
        let found = found(&decoding, &columns, size, &h);
        assert!(found > 0.95, "{scale}: {found}");
        let width = decoding.report.stripe_width_px / (8.0 * scale);
        assert!((0.85..1.25).contains(&width), "{scale}: {width}");
    }
}

#[test]
fn a_mirrored_photograph_of_the_mirrored_pattern_decodes_the_same() {
    let (columns, h) = (pattern(Axis::Columns), slanted());
    let photo: RgbImage = photograph(&columns, [900, 90], &h);
    let mut mirrored = columns.clone();
    mirrored.sequence.reverse();
    mirrored.centres_px = columns.centres_px.iter().rev().map(|c| columns.length_px() - 1.0 - c).collect();
    mirrored.validate().unwrap();
    let a = decode_image(photo.clone(), &columns).unwrap();
    let b = decode_image(image::imageops::flip_horizontal(&photo), &mirrored).unwrap();
    assert!(!a.report.reversed && !b.report.reversed);
    let (n, last) = (columns.sequence.len() as u16 - 1, 899.0);
    let there: std::collections::HashMap<_, _> = b
        .matches
        .items
        .iter()
        .map(|m| ((m.camera.y as i64, n - m.slit.unwrap()), last - m.camera.x))
        .collect();
    let same = a.matches.items.iter().filter(|m| {
        there.get(&(m.camera.y as i64, m.slit.unwrap())).is_some_and(|u| (u - m.camera.x).abs() < 0.02)
    });
    let (same, all) = (same.count(), a.matches.items.len());
    assert!(same as f64 > 0.99 * all as f64, "{same} of {all} and {}", there.len());
}

/// A pattern with other hues, order and slits, for the same panel.
fn of(hues: u32, order: u32, slits: Option<u32>) -> StripePattern {
    StripePattern::new([1024, 768], &StripeConfig { hues, order, slits, ..StripeConfig::default() }).unwrap()
}

#[test]
fn a_pattern_that_shares_parts_of_the_code_is_refused_and_its_own_photograph_decodes() {
    let (columns, h) = (pattern(Axis::Columns), slanted());
    let photo = photograph(&columns, [1060, 100], &h);
    let others = [
        of(5, 3, None),
        of(6, 3, None),
        of(3, 3, Some(27)),
        of(3, 4, None),
        of(4, 3, Some(40)),
        of(5, 3, Some(125)),
        of(4, 4, Some(100)),
    ];
    for other in others {
        let (hues, slits) = (other.palette.len(), other.sequence.len());
        let decoding = decode_image(photograph(&other, [1060, 100], &h), &other).unwrap();
        let (right, ..) = measure_errors(&decoding, &other, &h);
        assert!(right > 0.999, "{hues} hues, {slits} slits: {right}");
        let refused = decode_image(photo.clone(), &other).map(|d| d.report).unwrap_err();
        assert_eq!(refused.class(), ErrorClass::NotFound, "{hues} hues, {slits} slits: {refused}");
        assert!(refused.to_string().contains("the pattern's"), "{refused}");
    }
}

#[test]
fn stripes_that_continue_beyond_the_code_are_refused() {
    let (columns, h) = (pattern(Axis::Columns), slanted());
    let photo = photograph(&columns, [1060, 100], &h);
    // The first 60 of the 64 slits, at their places: all but the last four fit.
    let mut shorter = columns.clone();
    shorter.sequence.truncate(60);
    shorter.centres_px.truncate(60);
    shorter.validate().unwrap();
    let refused = |photo: RgbImage, pattern: &StripePattern| {
        decode_image(photo, pattern).map(|d| d.report).unwrap_err().to_string()
    };
    let told = refused(photo.clone(), &shorter);
    assert!(told.contains("beyond an end of the code"), "{told}");
    let told = refused(image::imageops::flip_horizontal(&photo), &shorter);
    assert!(told.contains("beyond an end of the code"), "{told}");
}

#[test]
fn a_single_row_or_column_of_pixels_is_refused() {
    let (columns, h) = (pattern(Axis::Columns), slanted());
    let photo = photograph(&columns, [1060, 100], &h);
    let row = image::imageops::crop_imm(&photo, 0, 50, 1060, 1).to_image();
    for strip in [image::imageops::rotate90(&row), row] {
        let refused = decode_image(strip, &columns).map(|d| d.report).unwrap_err();
        assert!(matches!(refused, Error::NotFound { what: ErrorSubject::Stripes, .. }), "{refused}");
        assert!(refused.to_string().contains("1 line of pixels"), "{refused}");
    }
}

#[test]
fn stripes_that_touch_are_named() {
    // Each stripe begins where the one before ends; no two neighbours are alike.
    const HUES: [[u8; 3]; 6] =
        [[255, 0, 0], [0, 255, 0], [255, 255, 0], [0, 0, 255], [255, 0, 255], [0, 255, 255]];
    let hue = |stripe: u32| HUES[(stripe * 7 + stripe / 6) as usize % 6];
    let drawn = RgbImage::from_fn(1024, 768, |x, _| image::Rgb(hue(x / 8)));
    let photo = crate::pattern::warp_image(&drawn, [1060, 160], &slanted().into(), [0; 3]).unwrap();
    let error = decode_image(photo, &pattern(Axis::Columns)).unwrap_err().to_string();
    assert!(error.contains("touch") && error.contains("black between"), "{error}");
}

#[test]
fn a_coloured_surface_is_not_taken_for_touching_stripes() {
    // Wood: bright bands of one hue.
    let wood = RgbImage::from_fn(1060, 160, |x, _| {
        let light = 150.0 + 80.0 * (f64::from(x) * 0.5).sin();
        image::Rgb([light as u8, (0.55 * light) as u8, (0.2 * light) as u8])
    });
    let error = decode_image(wood, &pattern(Axis::Columns)).unwrap_err().to_string();
    assert!(!error.contains("touch"), "{error}");
}
