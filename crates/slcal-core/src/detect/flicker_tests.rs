//! Bands of flicker in drawn photographs: the truth is known by construction.

use std::f64::consts::PI;

use image::{DynamicImage, ImageBuffer, Luma, RgbImage};

use super::row_flicker::{RowFlicker, gains};
use super::steady::Steady;
use crate::photo::{Encoding, LinearPhoto, PhotoView};

const WIDTH: u32 = 640;
const HEIGHT: u32 = 480;
/// σ of the camera's noise, linear light.
const NOISE: f64 = 0.004;

/// A tilted sheet with dark squares on it in front of something dark.
fn sheet(x: f64, y: f64) -> f64 {
    if !(60.0 + 0.1 * y..560.0).contains(&x) || !(50.0 + 0.05 * x..430.0 - 0.04 * x).contains(&y) {
        return 0.03;
    }
    let on_board = (150.0..470.0).contains(&x) && (120.0..360.0).contains(&y);
    let square = ((x + 0.1 * y) / 32.0).floor() + ((y - 0.07 * x) / 32.0).floor();
    if on_board && square as i32 % 2 == 0 { 0.12 } else { 0.6 - 0.0002 * x + 0.0003 * y }
}

/// Pixels of one light in all channels, each row times the gain of its channel, and noise.
fn photograph(light: impl Fn(f64, f64) -> f64, gain: impl Fn(f64, usize) -> f64) -> DynamicImage {
    let mut noise = noise();
    let image = RgbImage::from_fn(WIDTH, HEIGHT, |x, y| {
        let (x, y) = (f64::from(x), f64::from(y));
        let code = |c: usize| {
            let value = Encoding::Srgb.from_linear(light(x, y) * gain(y, c) + NOISE * noise());
            (value * 255.0).round() as u8
        };
        image::Rgb([0, 1, 2].map(code))
    });
    DynamicImage::ImageRgb8(image)
}

/// Numbers of variance one.
fn noise() -> impl FnMut() -> f64 {
    let mut seed = 1_u64;
    move || {
        let mut uniform = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as f64 / f64::from(1_u32 << 31)
        };
        (0..4).map(|_| uniform() - 0.5).sum::<f64>() * 3.0_f64.sqrt()
    }
}

/// The gain of a lamp.
fn lamp(amount: f64, period: f64, phase: f64) -> impl Fn(f64) -> f64 {
    move |y| 1.0 - amount / 2.0 + amount / 2.0 * (2.0 * PI * y / period + phase).sin()
}

fn found(photo: &DynamicImage) -> Option<RowFlicker> {
    RowFlicker::find(&LinearPhoto::new(PhotoView::try_from(photo).unwrap(), Encoding::Srgb), &[])
}

fn steady(photo: &DynamicImage) -> Steady<'_> {
    Steady::new(PhotoView::try_from(photo).unwrap(), Encoding::Srgb)
}

/// The largest error of the gains, after a common factor: what is left of the bands.
fn error(bands: &[RowFlicker], truth: impl Fn(f64, usize) -> f64) -> f64 {
    let ratio = |y: u32, c: usize| f64::from(gains(bands, y as usize)[c]) / truth(f64::from(y), c);
    let of_channel = |c: usize| {
        let mean = (0..HEIGHT).map(|y| ratio(y, c)).sum::<f64>() / f64::from(HEIGHT);
        (0..HEIGHT).map(|y| (ratio(y, c) / mean - 1.0).abs()).fold(0.0, f64::max)
    };
    (0..3).map(of_channel).fold(0.0, f64::max)
}

#[test]
fn the_gain_of_a_lamp_is_found_in_every_channel() {
    for (amount, period, colour) in [
        (0.1, 40.0, 0.0),
        (0.2, 12.0, 2.1),
        (0.6, 85.0, 0.0),
        (0.6, 200.0, 2.1),
        (0.9, 20.0, 2.1),
        (0.9, 85.0, 0.0),
    ] {
        let truth = |y: f64, c: usize| lamp(amount, period, colour * c as f64)(y);
        let photo = photograph(sheet, truth);
        let bands = found(&photo).unwrap_or_else(|| panic!("{amount} {period} {colour}"));
        assert!(bands.periodic && (bands.period_px / period - 1.0).abs() < 0.02, "{bands:?}");
        assert!((bands.depth - amount).abs() < 0.03, "{bands:?}");
        let left = error(&[bands], truth);
        assert!(left < 0.04, "{amount} {period} {colour}: {left}");
    }
}

#[test]
fn deep_samples_and_grey_photographs_are_read_as_well() {
    let gain = lamp(0.6, 85.0, 1.0);
    let code = |x: u32, y: u32| {
        let light = sheet(f64::from(x), f64::from(y)) * gain(f64::from(y));
        // A sensor of 12 bit whose samples were not scaled.
        Luma([(light * 4095.0).round() as u16])
    };
    let photo = DynamicImage::ImageLuma16(ImageBuffer::from_fn(WIDTH, HEIGHT, code));
    let view = PhotoView::try_from(&photo).unwrap();
    let bands = RowFlicker::find(&LinearPhoto::new(view, Encoding::Linear), &[]).unwrap();
    let left = error(&[bands], |y, _| gain(y));
    assert!(left < 0.03, "{left}");
    let steady = Steady::new(view, Encoding::Linear);
    let even = steady.photo();
    // Beside the board, where the light of the sheet changes by 1 % only.
    let column: Vec<f32> = (120..360).map(|y| even.at(500, y)).collect();
    let (low, high) = column.iter().fold((f32::MAX, 0.0_f32), |(l, h), v| (l.min(*v), h.max(*v)));
    assert!(high / low < 1.2 && low > 0.5, "{low} {high}");
}

#[test]
fn bands_that_are_no_sinusoid_are_fitted_with_harmonics() {
    let gain = |y: f64, _| {
        let phase = 2.0 * PI * y / 70.0;
        0.7 + 0.25 * phase.sin() + 0.06 * (2.0 * phase + 0.5).cos()
    };
    let bands = found(&photograph(sheet, gain)).unwrap();
    let left = error(&[bands], gain);
    assert!(left < 0.04, "{left}");
}

/// The light at a place.
type Light<'a> = &'a dyn Fn(f64, f64) -> f64;

#[test]
fn pictures_without_flicker_have_none() {
    let one = |_: f64, _: usize| 1.0;
    let checker = |x: f64, y: f64| if ((x / 40.0) as i32 + (y / 40.0) as i32) % 2 == 0 { 0.1 } else { 0.6 };
    let blinds = |y: f64| 0.25 + 0.1 * (2.0 * PI * y / 30.0).sin();
    let scenes: [(&str, Light<'_>); 7] = [
        ("a sheet", &sheet),
        ("squares along the rows", &checker),
        ("a ruled sheet", &|x, y| {
            let on_sheet = (50.0..590.0).contains(&x) && (40.0..440.0).contains(&y);
            if !on_sheet {
                0.05
            } else if y % 20.0 < 2.0 {
                0.35
            } else {
                0.6
            }
        }),
        ("a sheet in front of blinds", &|x, y| {
            if (50.0..300.0).contains(&x) && (60.0..420.0).contains(&y) { 0.6 } else { blinds(y) }
        }),
        ("courses of bricks", &|x, y| if (y + 0.02 * x) % 30.0 < 2.0 { 0.15 } else { 0.4 }),
        ("shading", &|x, y| 0.6 - 0.3 * ((x - 320.0).powi(2) + (y - 240.0).powi(2)) / 320.0_f64.powi(2)),
        ("darkness", &|_, _| 0.0),
    ];
    for (name, scene) in scenes {
        assert_eq!(found(&photograph(scene, one)), None, "{name}");
    }
    for side in [1, 7, 40] {
        assert_eq!(found(&DynamicImage::new_rgb8(side, side)), None);
        assert_eq!(found(&DynamicImage::new_luma8(side, 300)), None);
        assert_eq!(found(&DynamicImage::new_luma16(300, side)), None);
    }
}

#[test]
fn a_photograph_without_bands_is_measured_as_it_is() {
    let photo = photograph(sheet, |_, _| 1.0);
    let steady = steady(&photo);
    assert!(steady.notes.is_empty() && steady.warnings.is_empty());
    let even = steady.photo();
    let same = |x, y| {
        even.at(x, y) == LinearPhoto::new(PhotoView::try_from(&photo).unwrap(), Encoding::Srgb).at(x, y)
    };
    assert!((0..20).all(|i| same(30 * i, 20 * i)));
}

#[test]
fn two_lamps_are_divided_out_one_after_the_other() {
    let gain = |y: f64, _| lamp(0.5, 85.0, 0.3)(y) * lamp(0.2, 22.0, 1.0)(y);
    let photo = photograph(sheet, gain);
    let steady = steady(&photo);
    assert_eq!(steady.notes.len(), 2, "{:?} {:?}", steady.notes, steady.warnings);
    assert!(
        steady.notes.iter().any(|n| n == "bands of flicker, 50 % deep and 85 px apart, were divided out")
    );
    assert!(steady.warnings.is_empty());
}

#[test]
fn dark_and_irregular_bands_are_named() {
    let photo = photograph(sheet, |y, _| lamp(0.98, 60.0, 0.0)(y));
    let of_dark = steady(&photo);
    assert_eq!(of_dark.warnings.len(), 1, "{:?}", of_dark.notes);
    assert_eq!(of_dark.warnings[0].code, "flicker");
    assert!(of_dark.warnings[0].message.contains("only 2 % of the light"), "{}", of_dark.warnings[0].message);
    // A lamp that went on and off in the middle of the photograph.
    let swelling =
        |y: f64, _| 1.0 - 0.6 * (1.0 - lamp(1.0, 45.0, 0.0)(y)) * (-((y - 240.0) / 125.0).powi(2)).exp();
    let photo = photograph(sheet, swelling);
    let irregular = steady(&photo);
    assert_eq!(irregular.warnings.len(), 1, "{:?}", irregular.notes);
    assert!(
        irregular.warnings[0].message.contains("left in the photograph"),
        "{}",
        irregular.warnings[0].message
    );
}
