//! Decoding of rendered photographs whose ground truth is a homography.

mod channels;
mod color_classes;
mod patterns;
mod scanlines;
mod stripe_centers;

use image::{DynamicImage, Rgb, RgbImage};
use nalgebra::Matrix3;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};

use super::{DecodeConfig, DecodeInput, Decoding, ScanDirection, decode};
use crate::geometry::Homography;
use crate::pattern::{Axis, StripeConfig, StripePattern, warp_image};
use crate::photo::{PhotoView, Samples};
use crate::{Error, ErrorClass, Result};

fn pattern(axis: Axis) -> StripePattern {
    StripePattern::new([1024, 768], &StripeConfig { axis, ..StripeConfig::default() }).unwrap()
}

/// A slanted plane: the stripes get narrower from left to right and lean.
fn slanted() -> Homography {
    Homography(Matrix3::new(1.1, 0.12, 20.0, 0.01, 1.0, -120.0, 1.5e-4, 1e-5, 1.0))
}

fn photograph(pattern: &StripePattern, size: [u32; 2], h: &Homography) -> RgbImage {
    let mut photo = warp_image(&pattern.image().unwrap(), size, &(*h).into(), [0; 3]).unwrap();
    // Ambient light, and a projector that does not saturate the sensor.
    for p in photo.pixels_mut() {
        p.0 = p.0.map(|c| (20.0 + f64::from(c) * 0.8) as u8);
    }
    photo
}

fn decode_image(photo: RgbImage, pattern: &StripePattern) -> Result<Decoding> {
    let photo = DynamicImage::from(photo);
    decode(PhotoView::try_from(&photo).unwrap(), pattern, &DecodeConfig::default())
}

/// The share of matches within half a period, and their bias and rms error in projector pixels.
fn measure_errors(decoding: &Decoding, pattern: &StripePattern, h: &Homography) -> (f64, f64, f64) {
    let back = h.inverse().unwrap();
    let errors: Vec<f64> = decoding
        .matches
        .items
        .iter()
        .map(|m| {
            let truth = back.map(m.camera).unwrap();
            m.projector_column.map_or_else(|| m.projector_row.unwrap() - truth.y, |c| c - truth.x)
        })
        .collect();
    let right: Vec<f64> = errors.iter().copied().filter(|e| e.abs() < 0.5 * pattern.period_px()).collect();
    let n = right.len() as f64;
    let rms = (right.iter().map(|e| e * e).sum::<f64>() / n).sqrt();
    (n / errors.len() as f64, right.iter().sum::<f64>() / n, rms)
}

#[test]
fn a_slanted_plane_is_decoded_without_bias() {
    let (pattern, h) = (pattern(Axis::Columns), slanted());
    let decoding = decode_image(photograph(&pattern, [1060, 200], &h), &pattern).unwrap();
    let (right, bias, rms) = measure_errors(&decoding, &pattern, &h);
    assert!(right == 1.0 && bias.abs() < 0.01 && rms < 0.06, "{right} {bias} {rms}");
    let r = &decoding.report;
    assert_eq!((r.slits, r.decoded, r.reversed), (64, decoding.matches.items.len(), false));
    assert!(r.decoded > 63 * 200, "{r:?}");
    assert!(decoding.matches.items.iter().all(|m| m.confidence > 0.9 && m.sigma_px < 0.5));
}

#[test]
fn noise_is_tolerated_and_reported() {
    let (pattern, h) = (pattern(Axis::Columns), slanted());
    let mut photo = photograph(&pattern, [1000, 120], &h);
    let (mut rng, noise) = (rand_chacha::ChaCha8Rng::seed_from_u64(2), Normal::new(0.0, 5.0).unwrap());
    for p in photo.pixels_mut() {
        p.0 = p.0.map(|c| (f64::from(c) + noise.sample(&mut rng)).round() as u8);
    }
    let decoding = decode_image(photo, &pattern).unwrap();
    let (right, bias, rms) = measure_errors(&decoding, &pattern, &h);
    assert!(right > 0.999 && bias.abs() < 0.01 && rms < 0.15, "{right} {bias} {rms}");
    // σ is in camera pixels, the error in projector pixels; their ratio is 0.7 to 1.1 over this photograph.
    let sigma =
        decoding.matches.items.iter().map(|m| m.sigma_px).sum::<f64>() / decoding.matches.items.len() as f64;
    assert!(sigma > 0.4 * rms && sigma < 2.0 * rms, "{sigma} for {rms}");
}

#[test]
fn stripes_along_rows_and_mirrored_ones_decode_as_well() {
    let rows = pattern(Axis::Rows);
    let h = Homography(Matrix3::new(1.0, 0.02, -300.0, 0.05, 1.2, 10.0, 1e-5, 1e-4, 1.0));
    let decoding = decode_image(photograph(&rows, [150, 900], &h), &rows).unwrap();
    let (right, bias, _) = measure_errors(&decoding, &rows, &h);
    assert!(right == 1.0 && bias.abs() < 0.01, "{right} {bias}");
    assert!(decoding.matches.items.iter().all(|m| m.camera.x.fract() == 0.0 && m.projector_column.is_none()));

    let columns = pattern(Axis::Columns);
    let mirrored = Homography(Matrix3::new(-0.95, 0.0, 990.0, 0.0, 1.0, -200.0, 0.0, 0.0, 1.0));
    let decoding = decode_image(photograph(&columns, [1000, 100], &mirrored), &columns).unwrap();
    let (right, bias, _) = measure_errors(&decoding, &columns, &mirrored);
    assert!(right == 1.0 && bias.abs() < 0.01 && decoding.report.reversed, "{right} {bias}");
}

/// From a rotated photograph's pixels to the upright one's.
type Back = fn(f64, f64) -> (f64, f64);

#[test]
fn a_rotated_camera_decodes_the_same_stripes() {
    let (pattern, h) = (pattern(Axis::Columns), slanted());
    let upright = photograph(&pattern, [900, 160], &h);
    let decode = |p: &RgbImage| decode_image(p.clone(), &pattern).unwrap();
    let reference = decode(&upright);
    assert!(!reference.report.turned && reference.report.lines == ScanDirection::Rows);
    // No scanline of a plane crosses a slit twice.
    let expected: std::collections::BTreeMap<_, _> =
        reference.matches.items.iter().map(|m| ((m.camera.y as i64, m.slit), m.camera.x)).collect();
    let turned: [(RgbImage, Back, bool); 3] = [
        (image::imageops::rotate180(&upright), |x, y| (899.0 - x, 159.0 - y), false),
        (image::imageops::rotate90(&upright), |x, y| (y, 159.0 - x), true),
        (image::imageops::flip_horizontal(&upright), |x, y| (899.0 - x, y), false),
    ];
    for (photo, back, quarter) in turned {
        let decoding = decode(&photo);
        assert_eq!(decoding.report.turned, quarter);
        // Scanlines are sampled from the other end, and edges found from the other side: a few differ.
        let same = decoding.matches.items.iter().filter(|m| {
            let (x, y) = back(m.camera.x, m.camera.y);
            expected.get(&(y.round() as i64, m.slit)).is_some_and(|u| (u - x).abs() < 0.01)
        });
        let (same, all) = (same.count(), expected.len());
        assert!(same as f64 > 0.99 * all as f64, "{same} of {all} and {}", decoding.matches.items.len());
    }
}

#[test]
fn black_and_white_frames_remove_ambient_light_and_surface_colour() {
    let (pattern, h) = (pattern(Axis::Columns), slanted());
    let mut white = RgbImage::from_pixel(1000, 80, Rgb([0; 3]));
    for (x, y, p) in white.enumerate_pixels_mut() {
        p.0 = if (x / 70 + y / 40) % 2 == 0 { [220, 120, 90] } else { [70, 150, 220] };
    }
    let black = RgbImage::from_pixel(1000, 80, Rgb([25, 20, 15]));
    let mut photo = warp_image(&pattern.image().unwrap(), [1000, 80], &h.into(), [0; 3]).unwrap();
    let curve = crate::photo::Encoding::Srgb;
    let light = |c: u8| curve.to_linear(f64::from(c) / 255.0);
    for (x, y, p) in photo.enumerate_pixels_mut() {
        let (w, b) = (white.get_pixel(x, y).0, black.get_pixel(x, y).0);
        p.0 = std::array::from_fn(|k| {
            let l = light(p.0[k]) * (light(w[k]) - light(b[k])) + light(b[k]);
            (curve.from_linear(l) * 255.0).round() as u8
        });
    }
    let [photo, black, white] = [photo, black, white].map(DynamicImage::from);
    let view = |i| PhotoView::try_from(i).unwrap();
    let input = DecodeInput { photo: view(&photo), black: Some(view(&black)), white: Some(view(&white)) };
    let decoding = decode(input, &pattern, &DecodeConfig::default()).unwrap();
    let (right, bias, rms) = measure_errors(&decoding, &pattern, &h);
    assert!(right > 0.999 && bias.abs() < 0.02 && rms < 0.15, "{right} {bias} {rms}");
    assert!(decoding.matches.items.len() > 60 * 80);
}

#[test]
fn photographs_without_such_stripes_are_refused_with_the_reason() {
    let columns = pattern(Axis::Columns);
    let not_found = |photo: RgbImage, pattern: &StripePattern| {
        let e = decode_image(photo, pattern).map(|d| d.report).unwrap_err();
        assert_eq!(e.class(), ErrorClass::NotFound, "{e}");
        e.to_string()
    };
    not_found(RgbImage::from_pixel(300, 200, Rgb([250; 3])), &columns);
    not_found(RgbImage::from_pixel(300, 200, Rgb([0; 3])), &columns);
    for (w, h) in [(1, 1), (2, 9), (9, 2), (17, 3)] {
        not_found(RgbImage::from_fn(w, h, |x, _| Rgb([(x * 90) as u8, 0, 0])), &columns);
    }
    // Grey stripes; those of another code.
    let h = slanted();
    let mut grey = photograph(&columns, [1000, 120], &h);
    for p in grey.pixels_mut() {
        let mean = p.0.iter().map(|&c| u32::from(c)).sum::<u32>() / 3;
        p.0 = [mean as u8; 3];
    }
    assert!(not_found(grey, &columns).contains("saturation"));
    let mut other = columns.clone();
    let n = other.sequence.len();
    other.sequence = (0..n).map(|i| columns.sequence[(i * 37 + 11) % n]).collect();
    assert!(not_found(photograph(&columns, [1000, 120], &h), &other).contains("code"));
}

#[test]
fn every_layout_of_a_photograph_gives_the_same_matches() {
    let stripes = pattern(Axis::Columns);
    let rgb = photograph(&stripes, [1000, 60], &slanted());
    let mut first: Option<Decoding> = None;
    for (bytes, layout, stride) in crate::for_tests::layouts(&rgb, 1000) {
        let wide: Vec<u16> = bytes.iter().map(|&c| u16::from(c) * 257).collect();
        for samples in [Samples::U8(&bytes), Samples::U16(&wide)] {
            let view = PhotoView::new(samples, 1000, 60, stride, layout).unwrap();
            let found = decode(view, &stripes, &DecodeConfig::default()).unwrap();
            assert!(found.matches.items.len() > 1000);
            assert_eq!(found.matches, first.get_or_insert_with(|| found.clone()).matches, "{layout:?}");
        }
    }
}

#[test]
fn grey_layouts_and_frames_of_other_sizes_are_refused() {
    let columns = pattern(Axis::Columns);
    let grey = DynamicImage::new_luma8(100, 100);
    let color = DynamicImage::new_rgb8(100, 100);
    let small = DynamicImage::new_rgb8(50, 100);
    let view = |i| PhotoView::try_from(i).unwrap();
    let config = DecodeConfig::default();
    assert!(matches!(decode(view(&grey), &columns, &config), Err(Error::Invalid { .. })));
    let input = DecodeInput { photo: view(&color), black: Some(view(&small)), white: None };
    assert!(matches!(decode(input, &columns, &config), Err(Error::Invalid { .. })));
    let unsure = DecodeConfig { min_confidence: f64::NAN, ..config };
    assert!(decode(view(&color), &columns, &unsure).is_err());
}
