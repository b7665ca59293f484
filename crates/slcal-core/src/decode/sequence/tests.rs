//! Sequences against truth: frames that follow from a formula, and a real stack.

use image::DynamicImage;

use super::*;
use crate::error::Result;
use crate::for_tests::{Noise, shared_data};
use crate::pattern::{FrameLight, SequenceConfig, SequencePattern, SequencePreset, SinusoidConfig};
use crate::photo::{Layout, PhotoView, Samples};

pub(super) const WIDTH: usize = 400;
pub(super) const HEIGHT: usize = 300;
pub(super) const PANEL: [u32; 2] = [1024, 768];

/// What a camera sees: a slanted surface of two shades, the light of a projector and of a room, with noise.
#[derive(Clone, Copy)]
pub(super) struct Scene {
    pub(super) gamma: f64,
    /// Code values of 8 bit.
    pub(super) noise: f64,
    pub(super) albedo: f64,
    pub(super) ambient: f64,
}

pub(super) const USUAL: Scene = Scene { gamma: 2.2, noise: 2.0, albedo: 0.8, ambient: 0.1 };

/// Where on the panel the light of a pixel comes from.
fn truth(u: usize, v: usize) -> [f64; 2] {
    let (u, v) = (u as f64, v as f64);
    [
        150.3 + 1.3 * u + 0.11 * v + 25.0 * (u / 90.0).sin(),
        60.7 - 0.07 * u + 1.9 * v + 12.0 * (v / 70.0).cos(),
    ]
}

impl Scene {
    /// The share of a panel's light that a pixel sees of a frame, blurred over a panel pixel.
    fn light(&self, pattern: &SequencePattern, light: FrameLight, at: [f64; 2]) -> f64 {
        let level = match light {
            FrameLight::White => 1.0,
            FrameLight::Black => 0.0,
            FrameLight::Sinusoid { axis, period_px, step, of } => {
                let turns = at[axis.index()] / period_px - f64::from(step) / f64::from(of);
                0.5 + 0.5 * (std::f64::consts::TAU * turns).cos()
            }
            FrameLight::Bit { axis, bit, inverted } => {
                let code = pattern.code(axis).unwrap();
                // The share of a footprint of one panel pixel that is lit.
                let place = at[axis.index()];
                let lit = |column: f64| {
                    let cell = (column.max(0.0) as u32) / code.cell_px;
                    f64::from((cell ^ (cell >> 1)) >> bit & 1)
                };
                let first = place.floor();
                let share = place - first;
                let level = (1.0 - share) * lit(first) + share * lit(first + 1.0);
                return if inverted { 1.0 - level } else { level };
            }
        };
        level.powf(self.gamma)
    }

    pub(super) fn frames(&self, pattern: &SequencePattern, seed: u64) -> Vec<Vec<u8>> {
        let mut noise = Noise::new(seed);
        let mut frame = |light: FrameLight| {
            let pixels = (0..WIDTH * HEIGHT).map(|i| {
                let of_projector = self.light(pattern, light, truth(i % WIDTH, i / WIDTH));
                let level = 230.0 * self.albedo * (self.ambient + of_projector);
                (level + self.noise * noise.normal()).round().clamp(0.0, 255.0) as u8
            });
            pixels.collect()
        };
        pattern.frames.iter().map(|f| frame(f.light)).collect()
    }
}

pub(super) fn views(frames: &[Vec<u8>]) -> Vec<PhotoView<'_>> {
    let view = |f| PhotoView::new(Samples::U8(f), WIDTH, HEIGHT, WIDTH, Layout::Grey).unwrap();
    frames.iter().map(|f| view(f.as_slice())).collect()
}

pub(super) fn decode(pattern: &SequencePattern, frames: &[Vec<u8>]) -> Result<SequenceDecoding> {
    SequenceDecoder::new(pattern, SequenceDecodeConfig::default())?.decode(&views(frames))
}

pub(super) fn phase(bits: Option<u32>, period_px: f64, steps: u32) -> SequencePattern {
    let sinusoid = Some(SinusoidConfig { period_px, steps });
    SequencePattern::new(PANEL, &SequenceConfig { bits, sinusoid, ..SequenceConfig::default() }).unwrap()
}

/// Errors of the positions on an axis, and errors over σ.
fn errors(of: &[f32], sigma: &[f32], axis: usize) -> Vec<(f64, f64)> {
    let known = of.iter().zip(sigma).enumerate().filter(|(_, (x, _))| x.is_finite());
    let error = |i: usize, x: f32| f64::from(x) - truth(i % WIDTH, i / WIDTH)[axis];
    known.map(|(i, (x, s))| (error(i, *x), error(i, *x) / f64::from(*s))).collect()
}

fn rms(values: impl Iterator<Item = f64> + Clone) -> f64 {
    (values.clone().map(|x| x * x).sum::<f64>() / values.count() as f64).sqrt()
}

#[test]
fn phases_reach_the_bound_of_the_noise_whatever_the_gamma() {
    // With 6 bits of 10, cells are as wide as the period of 16 px: at their borders code and phase are reconciled.
    for (bits, albedo, gamma, period, steps) in [
        (None, 0.8, 2.2, 16.0, 8),
        (None, 0.5, 2.2, 16.0, 5),
        (None, 0.2, 2.2, 16.0, 8),
        (None, 0.8, 1.0, 20.0, 8),
        (Some(6), 0.8, 2.2, 16.0, 8),
        (Some(6), 0.5, 1.0, 16.0, 8),
    ] {
        let scene = Scene { gamma, albedo, ..USUAL };
        let pattern = phase(bits, period, steps);
        let found = decode(&pattern, &scene.frames(&pattern, 7)).unwrap();
        // The first harmonic of a sinusoid's power, by numerical integration.
        let n = 1000;
        let harmonic = (0..n).map(|i| std::f64::consts::TAU * f64::from(i) / f64::from(n));
        let share: f64 =
            harmonic.map(|a| (0.5 + 0.5 * a.cos()).powf(gamma) * a.cos()).sum::<f64>() * 2.0 / f64::from(n);
        let amplitude = 230.0 * albedo * share;
        // Rounding to whole code values is noise, too.
        let noise = scene.noise.hypot(1.0 / 12.0_f64.sqrt());
        let bound = period / std::f64::consts::TAU * (2.0 / f64::from(steps)).sqrt() * noise / amplitude;
        let errors = errors(&found.matches.column, &found.matches.sigma_column, 0);
        assert_eq!(errors.len(), WIDTH * HEIGHT, "{:?}", found.report);
        let (of_error, of_ratio) = (rms(errors.iter().map(|e| e.0)), rms(errors.iter().map(|e| e.1)));
        let wrong = errors.iter().filter(|e| e.0.abs() > 0.5 * period).count();
        assert!(
            of_error <= 1.15 * bound,
            "{bits:?} {albedo} {gamma}: rms {of_error}, bound {bound}, {wrong} off by a period"
        );
        assert!((0.9..1.1).contains(&of_ratio), "error over σ: {of_ratio}");
        assert!(errors.iter().all(|e| e.0.abs() < 0.5 * period));
        assert!(
            found.matches.row.is_empty() && (found.report.noise * 255.0 - noise).abs() < 0.2,
            "{:?}",
            found.report
        );
    }
}

#[test]
fn gray_code_is_read_to_a_part_of_a_cell() {
    for (preset, bits) in [(SequencePreset::OpencvGray, None), (SequencePreset::OpencvGray, Some(9))] {
        let pattern = SequencePattern::preset(PANEL, preset, bits).unwrap();
        let found = decode(&pattern, &USUAL.frames(&pattern, 3)).unwrap();
        for (axis, of, sigma) in [
            (0, &found.matches.column, &found.matches.sigma_column),
            (1, &found.matches.row, &found.matches.sigma_row),
        ] {
            let errors = errors(of, sigma, axis);
            assert!(errors.len() as f64 > 0.9 * (WIDTH * HEIGHT) as f64, "{:?}", found.report);
            assert!(rms(errors.iter().map(|e| e.0)) < 0.3, "{}", rms(errors.iter().map(|e| e.0)));
            assert!(errors.iter().all(|e| e.0.abs() < 2.0));
        }
    }
}

/// Of the panel's pixels that white lights by 30 code values or more, 97 % are certain, and none is farther than 2 px from what its
/// neighbourhood says (the panel is flat, its lens bends it little over ten pixels).
#[test]
fn a_real_stack_is_read() {
    let Some(folder) = shared_data("real/gray_stack") else { return };
    let frames: Vec<DynamicImage> =
        (0..42).map(|i| image::open(folder.join(format!("graycode_{i:02}.png"))).unwrap()).collect();
    let views: Vec<PhotoView<'_>> = frames.iter().map(|f| PhotoView::try_from(f).unwrap()).collect();
    let pattern = SequencePattern::preset(PANEL, SequencePreset::OpencvGray, None).unwrap();
    let mut decoder = SequenceDecoder::new(&pattern, SequenceDecodeConfig::default()).unwrap();
    let found = decoder.decode(&views).unwrap();
    // Frame by frame, in the order of the files, the same bits.
    for (i, view) in views.iter().enumerate() {
        decoder.push(i, *view).unwrap();
    }
    let again = decoder.finish().unwrap();
    assert_eq!(again.report, found.report);
    let bits = |plane: &[f32]| plane.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert!(bits(&again.matches.column) == bits(&found.matches.column));
    assert!(bits(&again.matches.sigma_row) == bits(&found.matches.sigma_row));

    let (white, black) = (frames[40].to_luma8(), frames[41].to_luma8());
    // The panel's corners in the picture.
    let corners = [[424.0, 162.0], [1022.0, 48.0], [944.0, 862.0], [356.0, 800.0]];
    let inside = |x: f64, y: f64| {
        (0..4).all(|i| {
            let ([ax, ay], [bx, by]) = (corners[i], corners[(i + 1) % 4]);
            (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0
        })
    };
    let (mut lit, mut certain, mut far, mut compared) = (0, 0, 0, 0);
    for y in 0..1024_usize {
        for x in 0..1280_usize {
            let difference = |p: &image::GrayImage| i32::from(p.get_pixel(x as u32, y as u32).0[0]);
            if !inside(x as f64, y as f64) || difference(&white) - difference(&black) < 30 {
                continue;
            }
            lit += 1;
            let pixel = y * 1280 + x;
            let is_certain = found.matches.column[pixel].is_finite() && found.matches.row[pixel].is_finite();
            certain += usize::from(is_certain);
            if !is_certain || x < 10 || y < 10 {
                continue;
            }
            for plane in [&found.matches.column, &found.matches.row] {
                let around = (y - 10..=y + 10).flat_map(|v| (x - 10..=x + 10).map(move |u| v * 1280 + u));
                let mut near: Vec<f64> =
                    around.map(|i| f64::from(plane[i])).filter(|c| c.is_finite()).collect();
                if near.len() > 400 && (x + y) % 7 == 0 {
                    compared += 1;
                    let middle = crate::solve::median(&mut near).unwrap();
                    far += usize::from((f64::from(plane[pixel]) - middle).abs() > 2.0);
                }
            }
        }
    }
    assert!(f64::from(certain as u32) >= 0.97 * f64::from(lit), "{certain} of {lit}");
    assert!(compared > 10_000 && far == 0, "{far} of {compared}");
}
