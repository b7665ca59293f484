//! What projectors and cameras do to light and values.

use image::{DynamicImage, RgbImage};

use super::{exact, plane, rig};
use crate::error::Error;
use crate::photo::Encoding;
use crate::simulate::{
    Demosaic, Flicker, Photographer, PreparedScene, ProjectedImage, RenderConfig, RigConfig, SceneSetup,
    Shape, Sharpen, Surface, SurfaceKind,
};

const WIDTH: usize = 160;
const HEIGHT: usize = 120;

/// The samples (0–1) of a wall under white light, or under ambient light alone, where nothing but the pipeline varies.
fn samples(config: &RenderConfig, shown: ProjectedImage<'_>) -> Vec<[f64; 3]> {
    let wall = [Surface::object(Shape::Plane(plane(1000.0, 0.0, 0.0))).colored([1.0; 3])];
    let photo = Photographer::new(&rig(WIDTH as u32), &wall, config).unwrap().photograph(shown, 0).unwrap();
    photo.to_rgb16().pixels().map(|p| p.0.map(|c| f64::from(c) / 65535.0)).collect()
}

/// Linear light of 0.4 everywhere.
fn flat() -> RenderConfig {
    RenderConfig { encoding: Encoding::Linear, ambient: [0.5; 3], ..exact() }
}

fn dark(config: &RenderConfig) -> Vec<[f64; 3]> {
    samples(config, ProjectedImage::Black)
}

#[test]
fn vignetting_takes_its_share_in_the_corners() {
    let photo = dark(&RenderConfig { vignetting: 0.3, ..flat() });
    let r2 = |x: f64, y: f64| (x - 79.5).powi(2) + (y - 59.5).powi(2);
    for (x, y) in [(0, 0), (159, 0), (0, 119), (159, 119), (80, 60), (0, 60), (40, 100)] {
        let expected = 0.4 * (1.0 - 0.3 * r2(x as f64, y as f64) / r2(-0.5, -0.5));
        let found = photo[y * WIDTH + x];
        assert!(found.iter().all(|v| (v - expected).abs() < 1e-5), "{x},{y}: {found:?} {expected}");
    }
    assert!((photo[0][1] - 0.28).abs() < 0.002);
}

#[test]
fn flicker_darkens_rows_by_a_sine() {
    let photo = dark(&RenderConfig { flicker: Some(Flicker { amount: 0.6, period_px: 17.0 }), ..flat() });
    for (i, found) in photo.iter().enumerate() {
        let phase = 2.0 * std::f64::consts::PI * (i / WIDTH) as f64 / 17.0;
        let expected = 0.4 * (1.0 - 0.3 + 0.3 * phase.sin());
        assert!(found.iter().all(|v| (v - expected).abs() < 1e-5), "{i}: {found:?} {expected}");
    }
    // The light varies, not the values: in sRGB the same rows have the same light.
    let srgb = dark(&RenderConfig {
        flicker: Some(Flicker { amount: 0.6, period_px: 17.0 }),
        encoding: Encoding::Srgb,
        ..flat()
    });
    for (a, b) in photo.iter().zip(&srgb) {
        assert!((a[1] - Encoding::Srgb.to_linear(b[1])).abs() < 3e-5);
    }
}

#[test]
fn the_projector_has_its_own_curve_and_falloff() {
    let grey = RgbImage::from_pixel(1024, 768, image::Rgb([128; 3]));
    let shine = |config: &RenderConfig, picture: &RgbImage| {
        samples(
            &RenderConfig { ambient: [0.0; 3], exposure: 0.5, ..config.clone() },
            ProjectedImage::Picture(picture),
        )
    };
    let white = RgbImage::from_pixel(1024, 768, image::Rgb([255; 3]));
    let config = RenderConfig { projector_gamma: Some(1.8), ..flat() };
    let middle = 60 * WIDTH + 80;
    let share = shine(&config, &grey)[middle][1] / shine(&config, &white)[middle][1];
    assert!((share - (128.0_f64 / 255.0).powf(1.8)).abs() < 1e-4, "{share}");

    let fallen = RenderConfig { projector_falloff: 0.4, ..flat() };
    let wall = [Surface::object(Shape::Plane(plane(1000.0, 0.0, 0.0))).colored([1.0; 3])];
    let truth = Photographer::new(&rig(WIDTH as u32), &wall, &fallen).unwrap();
    let (with, without) = (shine(&fallen, &white), shine(&flat(), &white));
    let mut least = 1.0_f64;
    for (i, pixel) in truth.truth().pixels().enumerate() {
        let inside = |v: f64, n: f64| v > 8.0 && v < n - 9.0;
        let panel = pixel.and_then(|p| p.panel).filter(|q| inside(q.x, 1024.0) && inside(q.y, 768.0));
        let Some(q) = panel else { continue };
        let r2 = (q.x - 511.5).powi(2) + (q.y - 383.5).powi(2);
        let expected = 1.0 - 0.4 * r2 / (512.0_f64.powi(2) + 384.0_f64.powi(2));
        let found = with[i][1] / without[i][1];
        assert!((found - expected).abs() < 5e-4, "{q}: {found} {expected}");
        least = least.min(found);
    }
    assert!(least < 0.9, "{least}");
}

#[test]
fn the_noise_of_raw_samples_is_averaged_by_demosaicing() {
    let noisy = RenderConfig { noise_levels: 4.0, ..flat() };
    let variance = |config: &RenderConfig, c: usize| {
        let values = dark(config);
        let squares = values.iter().map(|v| ((v[c] - 0.4) * 255.0 / 4.0).powi(2)).sum::<f64>();
        squares / values.len() as f64
    };
    // Bilinear: green is a sample in half of the pixels and the mean of four in the others; red is a sample in a quarter, the
    // mean of two in half and of four in a quarter. Malvar: the squares of the filters' weights.
    let malvar_cross = (16.0 + 4.0 * 4.0 + 4.0) / 64.0;
    let malvar_row = (25.0 + 2.0 * 16.0 + 4.0 + 2.0 + 0.5) / 64.0;
    let malvar_diagonal = (36.0 + 4.0 * 4.0 + 4.0 * 2.25) / 64.0;
    for (demosaic, expected) in [
        (None, [1.0, 1.0]),
        (Some(Demosaic::Bilinear), [0.25 + 0.5 / 2.0 + 0.25 / 4.0, 0.5 + 0.5 / 4.0]),
        (
            Some(Demosaic::Malvar),
            [0.25 + 0.5 * malvar_row + 0.25 * malvar_diagonal, 0.5 + 0.5 * malvar_cross],
        ),
    ] {
        let config = RenderConfig { demosaic, ..noisy.clone() };
        for (channel, expected) in [(0, expected[0]), (1, expected[1]), (2, expected[0])] {
            // 19200 samples, of which neighbours share some: the σ of a variance is 1 to 2 %.
            let found = variance(&config, channel);
            assert!((found / expected - 1.0).abs() < 0.06, "{demosaic:?} {channel}: {found} {expected}");
        }
    }
}

#[test]
fn a_grey_wall_stays_grey_through_the_mosaic() {
    for demosaic in Demosaic::ALL {
        let config = RenderConfig { demosaic: Some(demosaic), encoding: Encoding::Srgb, ..flat() };
        let expected = Encoding::Srgb.from_linear(0.4);
        assert!(dark(&config).as_flattened().iter().all(|v| (v - expected).abs() < 1e-5));
    }
}

#[test]
fn tone_follows_the_transfer_curve_and_sharpening_the_tone() {
    let config = RenderConfig { encoding: Encoding::Srgb, tone: 0.35, ..flat() };
    let v = Encoding::Srgb.from_linear(0.4);
    let toned = v + 0.35 * (3.0 * v * v - 2.0 * v * v * v - v);
    assert!(dark(&config).as_flattened().iter().all(|found| (found - toned).abs() < 1e-5));
    // Sharpening leaves what is flat, and acts on the values behind the tone curve.
    let mask = Sharpen { amount: 0.6, radius_px: 1.0 };
    let sharpened = RenderConfig { sharpen: Some(mask), ..config.clone() };
    assert!(dark(&sharpened).as_flattened().iter().all(|found| (found - toned).abs() < 1e-5));
    let vignetted = RenderConfig { vignetting: 1.0, ..config };
    let mut expected = dark(&vignetted);
    mask.apply(&mut expected, WIDTH);
    let found = dark(&RenderConfig { sharpen: Some(mask), ..vignetted });
    for (found, expected) in found.as_flattened().iter().zip(expected.as_flattened()) {
        assert!((found - expected).abs() < 4e-5, "{found} {expected}");
    }
}

fn scene(render: RenderConfig) -> SceneSetup {
    let rig =
        RigConfig { camera: [WIDTH as u32, HEIGHT as u32], camera_focal_px: 190.0, ..RigConfig::default() };
    SceneSetup { rig, surface: SurfaceKind::Sphere { radius_mm: None }, render, ..SceneSetup::default() }
}

#[test]
fn photographs_as_jpeg_are_the_pixels_of_their_files() {
    let plain = scene(RenderConfig::default()).photograph().unwrap();
    assert_eq!(plain.jpeg_files, None);
    let made =
        scene(RenderConfig { jpeg_quality: Some(88), ..RenderConfig::default() }).photograph().unwrap();
    let files = made.jpeg_files.unwrap();
    for (file, read, plain) in [
        (&files[0], &made.photo, &plain.photo),
        (&files[1], &made.white, &plain.white),
        (&files[2], &made.black, &plain.black),
    ] {
        let decoded = image::load_from_memory(file).unwrap();
        assert_eq!(&decoded, read);
        let DynamicImage::ImageRgb8(plain) = plain else { panic!("8 bit") };
        let (again, same) = super::super::jpeg::through_jpeg(plain, 88).unwrap();
        assert_eq!((&again, same), (file, read.to_rgb8()));
        assert_ne!(plain, &read.to_rgb8());
        // Of brightness quality 88 loses a grey level or two; colour loses its fine detail.
        let luma = |p: &image::Rgb<u8>| {
            0.299 * f64::from(p.0[0]) + 0.587 * f64::from(p.0[1]) + 0.114 * f64::from(p.0[2])
        };
        let read = read.to_rgb8();
        let squares = plain.pixels().zip(read.pixels()).map(|(a, b)| (luma(a) - luma(b)).powi(2));
        let rms = (squares.sum::<f64>() / (WIDTH * HEIGHT) as f64).sqrt();
        assert!(rms < 4.0, "{rms}");
        // The frame header: three components, the first sampled twice as finely both ways (4:2:0).
        let header = file.windows(2).position(|w| w == [0xFF, 0xC0]).unwrap();
        assert_eq!(
            [file[header + 9], file[header + 11], file[header + 14], file[header + 17]],
            [3, 0x22, 0x11, 0x11]
        );
    }
    let coarse =
        scene(RenderConfig { jpeg_quality: Some(20), ..RenderConfig::default() }).photograph().unwrap();
    assert!(coarse.jpeg_files.unwrap()[0].len() < files[0].len());
}

#[test]
fn the_whole_pipeline_is_the_same_every_time_and_written_in_the_report() {
    let render = RenderConfig {
        projector_gamma: Some(2.2),
        projector_falloff: 0.2,
        channel_shift_px: [[0.5, -0.3], [-0.4, 0.5]],
        lateral_colour: [6e-4, -5e-4],
        vignetting: 0.3,
        flicker: Some(Flicker { amount: 0.1, period_px: 170.0 }),
        demosaic: Some(Demosaic::Malvar),
        tone: 0.35,
        sharpen: Some(Sharpen { amount: 0.6, radius_px: 1.0 }),
        jpeg_quality: Some(88),
        ..RenderConfig::default()
    };
    let made = [(); 2].map(|()| scene(render.clone()).photograph().unwrap());
    assert_eq!(made[0].jpeg_files, made[1].jpeg_files);
    let report = serde_json::to_value(&made[0].report).unwrap();
    let wanted = serde_json::json!({
        "projector_gamma": 2.2, "projector_falloff": 0.2, "channel_shift_px": [[0.5, -0.3], [-0.4, 0.5]],
        "lateral_colour": [6e-4, -5e-4], "vignetting": 0.3, "flicker": {"amount": 0.1, "period_px": 170.0},
        "demosaic": "malvar", "tone": 0.35, "sharpen": {"amount": 0.6, "radius_px": 1.0}, "jpeg_quality": 88,
    });
    for (name, value) in wanted.as_object().unwrap() {
        assert_eq!(&report["render"][name], value, "{name}");
    }
    assert_eq!(serde_json::from_value::<RenderConfig>(report["render"].clone()).unwrap(), render);
    // What is off is not mentioned.
    let plain = serde_json::to_value(RenderConfig::default()).unwrap();
    assert!(wanted.as_object().unwrap().keys().all(|name| plain.get(name).is_none()));
}

#[test]
fn effects_out_of_range_are_refused_by_name() {
    let default = RenderConfig::default;
    let flicker =
        |amount, period_px| RenderConfig { flicker: Some(Flicker { amount, period_px }), ..default() };
    let sharpen =
        |amount, radius_px| RenderConfig { sharpen: Some(Sharpen { amount, radius_px }), ..default() };
    let jpeg = |quality| RenderConfig { jpeg_quality: Some(quality), ..default() };
    let nan = f64::NAN;
    for (config, word) in [
        (RenderConfig { channel_shift_px: [[25.0, 0.0], [0.0; 2]], ..default() }, "channel shift"),
        (RenderConfig { channel_shift_px: [[0.0; 2], [0.0, nan]], ..default() }, "channel shift"),
        (RenderConfig { lateral_colour: [0.0, -0.5], ..default() }, "lateral colour"),
        (RenderConfig { lateral_colour: [nan, 0.0], ..default() }, "lateral colour"),
        (RenderConfig { projector_gamma: Some(0.0), ..default() }, "gamma"),
        (RenderConfig { projector_gamma: Some(nan), ..default() }, "gamma"),
        (RenderConfig { projector_falloff: 1.5, ..default() }, "falloff"),
        (RenderConfig { vignetting: -0.1, ..default() }, "vignetting"),
        (RenderConfig { vignetting: nan, ..default() }, "vignetting"),
        (RenderConfig { tone: 1.01, ..default() }, "tone"),
        (RenderConfig { tone: nan, ..default() }, "tone"),
        (flicker(1.1, 100.0), "flicker"),
        (flicker(0.5, 0.0), "period"),
        (flicker(0.5, f64::INFINITY), "period"),
        (flicker(nan, 100.0), "flicker"),
        (sharpen(0.5, -1.0), "radius"),
        (sharpen(0.5, 0.0), "radius"),
        (sharpen(-0.5, 1.0), "sharpening"),
        (sharpen(nan, 1.0), "sharpening"),
        (jpeg(0), "1 to 100"),
        (jpeg(101), "1 to 100"),
        (RenderConfig { bits: 16, ..jpeg(90) }, "8 with JPEG"),
    ] {
        let error = config.validate().unwrap_err();
        assert!(matches!(error, Error::Invalid { .. }) && error.to_string().contains(word), "{error}");
        assert_eq!(scene(config).photograph().err(), Some(error));
    }
}

#[test]
fn pictures_too_large_for_jpeg_are_refused_before_they_are_traced() {
    let PreparedScene { mut rig, surfaces, .. } = scene(RenderConfig::default()).set_up().unwrap();
    [rig.camera.model.width, rig.camera.model.height] = [70_000, 10];
    let config = RenderConfig { jpeg_quality: Some(90), ..RenderConfig::default() };
    let error = Photographer::new(&rig, &surfaces, &config).err().unwrap().to_string();
    assert!(error.contains("65535") && error.contains("70000x10"), "{error}");
}
