//! Channels that are displaced against each other, by projector or camera.

use image::RgbImage;
use nalgebra::{Matrix3, Point2};

use super::{decode_image, pattern, photograph, slanted};
use crate::channel_registration::{
    ChannelDisplacements, ChannelRegistration, LateralColor, PanelDisplacement, RedBlue, RegistrationSource,
};
use crate::decode::{DecodeConfig, Decoding, decode};
use crate::geometry::Homography;
use crate::pattern::{Axis, StripePattern};
use crate::photo::PhotoView;
use crate::solve::median_f32;

const SIZE: [u32; 2] = [1060, 160];

/// Of the panel, then of the image about this place.
#[derive(Clone, Copy)]
struct Displaced {
    shift_px: f64,
    radial: f64,
}

const NONE: Displaced = Displaced { shift_px: 0.0, radial: 0.0 };

fn centre() -> Point2<f64> {
    Point2::new(500.0, 80.0)
}

/// A photograph whose red and blue are displaced.
fn displaced(columns: &StripePattern, red: Displaced, blue: Displaced) -> RgbImage {
    let photo = |d: Displaced| {
        let panel = Matrix3::new(1.0, 0.0, d.shift_px, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
        let (c, r) = (centre(), 1.0 + d.radial);
        let image = Matrix3::new(r, 0.0, c.x * (1.0 - r), 0.0, r, c.y * (1.0 - r), 0.0, 0.0, 1.0);
        photograph(columns, SIZE, &Homography(image * slanted().0 * panel))
    };
    let [red, green, blue] = [red, NONE, blue].map(photo);
    RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| {
        image::Rgb([red.get_pixel(x, y)[0], green.get_pixel(x, y)[1], blue.get_pixel(x, y)[2]])
    })
}

/// Median error of each hue, projector px.
fn biases(decoding: &Decoding, columns: &StripePattern) -> Vec<f32> {
    let back = slanted().inverse().unwrap();
    let error = |m: &crate::Match| (m.projector_column.unwrap() - back.map(m.camera).unwrap().x) as f32;
    let of_hue = |hue: u8| {
        let of = decoding.matches.items.iter();
        let of = of.filter(|m| columns.sequence[usize::from(m.slit.unwrap())] == hue);
        median_f32(&mut of.map(error).collect::<Vec<f32>>()).unwrap()
    };
    (0..columns.palette.len() as u8).map(of_hue).collect()
}

#[test]
fn shifts_of_the_panels_are_found_in_the_stripes_and_removed() {
    let columns = pattern(Axis::Columns);
    let clean = decode_image(displaced(&columns, NONE, NONE), &columns).unwrap();
    let found = clean.report.channel_shift.unwrap();
    assert!(!found.used && found.red_px.abs().max(found.blue_px.abs()) < 0.02, "{found:?}");
    for [red, blue] in [[0.3, -0.24], [-0.5, 0.4]] {
        let [red, blue] = [red, blue].map(|shift_px| Displaced { shift_px, radial: 0.0 });
        let decoding = decode_image(displaced(&columns, red, blue), &columns).unwrap();
        let found = decoding.report.channel_shift.unwrap();
        assert!(found.used, "{found:?}");
        let miss = (found.red_px - red.shift_px).abs().max((found.blue_px - blue.shift_px).abs());
        assert!(miss < 0.03, "{found:?}");
        let biases = biases(&decoding, &columns);
        assert!(biases.iter().all(|b| b.abs() < 0.03), "{biases:?}");
    }
}

#[test]
fn lateral_colour_is_removed_along_with_them() {
    let columns = pattern(Axis::Columns);
    let (red, blue) =
        (Displaced { shift_px: 0.3, radial: 4e-4 }, Displaced { shift_px: -0.2, radial: -3e-4 });
    let photo = displaced(&columns, red, blue);
    let worst = |config: &DecodeConfig| {
        let view = PhotoView::try_from(&photo).unwrap();
        let decoding = decode(view, &columns, config).unwrap();
        biases(&decoding, &columns).into_iter().map(f32::abs).fold(0.0, f32::max)
    };
    let alone = worst(&DecodeConfig::default());
    assert!(alone < 0.06, "{alone}");
    let panel = |d: Displaced| PanelDisplacement { shift_px: [d.shift_px, 0.0], scale: 0.0 };
    let lens = |d: Displaced| LateralColor { radial: d.radial };
    let registration = ChannelRegistration {
        displacements: ChannelDisplacements {
            projector: RedBlue { red: panel(red), blue: panel(blue) },
            camera: RedBlue { red: lens(red), blue: lens(blue) },
        },
        sigma: ChannelDisplacements::default(),
        from: RegistrationSource::Checker,
        camera_centre: centre(),
        panel_centre: Point2::new(0.5 * f64::from(columns.projector[0] - 1), 0.0),
    };
    let known = worst(&DecodeConfig { registration: Some(registration), ..DecodeConfig::default() });
    assert!(known < 0.03, "{known}");
}

#[test]
fn lateral_colour_alone_is_seen() {
    let columns = pattern(Axis::Columns);
    let lens = |radial| Displaced { shift_px: 0.0, radial };
    let decoding = decode_image(displaced(&columns, lens(6e-4), lens(-5e-4)), &columns).unwrap();
    assert!(decoding.report.channel_shift.unwrap().used);
    let biases = biases(&decoding, &columns);
    assert!(biases.iter().all(|b| b.abs() < 0.06), "{biases:?}");
}

#[test]
fn rows_that_alternate_are_averaged() {
    let columns = pattern(Axis::Columns);
    let even = displaced(&columns, NONE, NONE);
    // Blue, and what contains it, moves to and fro.
    let odd = displaced(&columns, NONE, Displaced { shift_px: 0.3, radial: 0.0 });
    let mixed =
        RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| *if y % 2 == 0 { &even } else { &odd }.get_pixel(x, y));
    let decoding = decode_image(mixed, &columns).unwrap();
    assert!(decoding.report.demosaiced);
    assert!(!decode_image(even, &columns).unwrap().report.demosaiced);
    let back = slanted().inverse().unwrap();
    let mean = |parity: f64| {
        let of = decoding.matches.items.iter().filter(|m| m.camera.y % 2.0 == parity);
        let errors: Vec<f64> =
            of.map(|m| m.projector_column.unwrap() - back.map(m.camera).unwrap().x).collect();
        errors.iter().sum::<f64>() / errors.len() as f64
    };
    assert!((mean(0.0) - mean(1.0)).abs() < 0.01, "{} {}", mean(0.0), mean(1.0));
}

#[test]
fn exchanged_channels_are_named() {
    let columns = pattern(Axis::Columns);
    let mut photo = displaced(&columns, NONE, NONE);
    photo.pixels_mut().for_each(|p| p.0.reverse());
    let error = decode_image(photo, &columns).unwrap_err().to_string();
    assert!(error.contains("red and blue exchanged") && error.contains("RGB"), "{error}");
}
