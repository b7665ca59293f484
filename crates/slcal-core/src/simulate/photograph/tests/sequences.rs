//! Photographs under a sequence against the code of the true columns and rows.

use std::f64::consts::TAU;

use image::DynamicImage;

use crate::pattern::{
    Axis, FrameLight, Pattern, SequenceAxes, SequenceConfig, SequencePattern, SequencePreset, SinusoidConfig,
};
use crate::photo::Encoding;
use crate::simulate::{PatternKind, RenderConfig, RigConfig, SceneSetup, SimulatedScene, SurfaceKind};

const PANEL: [u32; 2] = [256, 192];

/// A sphere before its wall; a pixel sees half of a panel pixel where the surface faces it.
fn scene(pattern: SequencePattern, render: RenderConfig) -> SimulatedScene {
    let rig = RigConfig {
        camera: [480, 360],
        camera_focal_px: 760.0,
        projector: PANEL,
        projector_focal_px: 425.0,
        ..RigConfig::default()
    };
    let pattern = PatternKind::Known(Pattern::Sequence(pattern));
    let setup = SceneSetup {
        rig,
        surface: SurfaceKind::Sphere { radius_mm: None },
        pattern,
        render,
        ..SceneSetup::default()
    };
    setup.photograph().unwrap()
}

fn linear() -> RenderConfig {
    RenderConfig { encoding: Encoding::Linear, ..RenderConfig::exact() }
}

/// The panel positions in every pixel, NaN where the panel position changes by a panel pixel or more from one pixel to the next, as it
/// does at borders and on steep slopes: such a pixel shows several of the panel's.
fn calm(positions: &[f32], width: usize) -> Vec<f64> {
    let at = |i: usize| positions.get(i).map_or(f64::NAN, |v| f64::from(*v));
    let is_calm = |i: usize| {
        let neighbours = [i.wrapping_sub(1), i + 1, i.wrapping_sub(width), i + width];
        neighbours.iter().all(|j| (at(*j) - at(i)).abs() < 0.9)
    };
    (0..positions.len()).map(|i| if is_calm(i) { at(i) } else { f64::NAN }).collect()
}

/// The green of every pixel.
fn greens(photo: &DynamicImage) -> Vec<f64> {
    photo.to_rgb16().pixels().map(|p| f64::from(p.0[1]) / 65535.0).collect()
}

fn sequence(axes: SequenceAxes, sinusoid: Option<SinusoidConfig>) -> SequencePattern {
    SequencePattern::new(PANEL, &SequenceConfig { axes, sinusoid, ..SequenceConfig::default() }).unwrap()
}

/// The bit of the reflected code by its definition: within blocks of 2^(bit + 2) cells the middle half is white.
fn is_white(cell: u32, bit: u32) -> bool {
    let block = 4_u32 << bit;
    let at = cell % block;
    (block / 4..block * 3 / 4).contains(&at)
}

#[test]
fn bits_are_those_of_the_true_column_and_row() {
    let scene = scene(sequence(SequenceAxes::Both, None), linear());
    let Pattern::Sequence(pattern) = &scene.pattern else { panic!("{:?}", scene.pattern) };
    let (black, white) = (greens(&scene.black), greens(&scene.white));
    let places = [scene.columns(), scene.rows()].map(|p| calm(&p, 480));
    let mut checked = 0;
    for (frame, shot) in pattern.frames.iter().zip(scene.frames()) {
        let values = greens(&shot.unwrap().picture);
        match frame.light {
            FrameLight::White => assert_eq!(values, white),
            FrameLight::Black => assert_eq!(values, black),
            FrameLight::Bit { axis, bit, inverted } => {
                for (i, value) in values.iter().enumerate() {
                    let at = places[usize::from(axis == Axis::Rows)][i];
                    // Pixel centres are integers: the edges of cells lie half-way between.
                    let from_centre = (at - at.round()).abs();
                    let lit = white[i] - black[i];
                    if at.is_nan() || from_centre > 0.1 || lit < 0.05 {
                        continue;
                    }
                    let share = (value - black[i]) / lit;
                    let expected = is_white(at.round() as u32, bit) != inverted;
                    assert!((share > 0.5) == expected, "pixel {i}, {}: {share} at {at}", frame.light);
                    checked += 1;
                }
            }
            FrameLight::Sinusoid { .. } => panic!("no sinusoids"),
        }
    }
    assert!(checked > 100_000, "{checked}");
}

/// Under a gamma of 1 the levels are linear light. The blur of the projector hides that its pixels have constant light, and moves no
/// phase but at the border of the panel.
#[test]
fn sinusoids_have_the_phase_of_the_true_column() {
    let sinusoid = SinusoidConfig { period_px: 20.0, steps: 6 };
    let render = RenderConfig { projector_gamma: Some(1.0), projector_blur_px: 0.7, ..linear() };
    let scene = scene(sequence(SequenceAxes::Columns, Some(sinusoid)), render);
    let Pattern::Sequence(pattern) = &scene.pattern else { panic!("{:?}", scene.pattern) };
    let columns = calm(&scene.columns(), 480);
    let mut sums = vec![[0.0_f64; 2]; columns.len()];
    for (frame, shot) in pattern.frames.iter().zip(scene.frames()) {
        let FrameLight::Sinusoid { step, of, .. } = frame.light else { continue };
        let angle = TAU * f64::from(step) / f64::from(of);
        for (sum, value) in sums.iter_mut().zip(greens(&shot.unwrap().picture)) {
            *sum = [sum[0] + value * angle.cos(), sum[1] + value * angle.sin()];
        }
    }
    let mut errors = Vec::new();
    for (column, [c, s]) in columns.iter().zip(sums) {
        if !(4.0..252.0).contains(column) {
            continue;
        }
        let found = s.atan2(c) / TAU * sinusoid.period_px;
        let error = found - *column;
        errors.push((error - (error / sinusoid.period_px).round() * sinusoid.period_px).abs());
    }
    errors.sort_by(f64::total_cmp);
    let n = errors.len();
    assert!(n > 50_000, "{n}");
    // Light is computed in steps of half a panel pixel, which steep slopes spread over several pixels: a quarter is possible there.
    let [median, most] = [errors[n / 2], errors[n - 1]];
    assert!(median < 0.04 && most < 0.27, "{median} {most} px");
}

#[test]
fn every_photograph_of_a_sequence_has_its_own_noise_and_the_same_each_time() {
    let render = RenderConfig { noise_levels: 2.0, ..RenderConfig::default() };
    let pattern = SequencePattern::preset(PANEL, SequencePreset::SlstudioGray, Some(2)).unwrap();
    let scene = scene(pattern, render);
    assert_eq!((scene.frame_count(), scene.frames().len(), scene.matches.items.len()), (4, 4, 0));
    let shot = |i| scene.frame(i).unwrap().picture.into_rgb8();
    assert_eq!(shot(0), shot(0));
    let other = scene.white.to_rgb8();
    let (a, b) = (shot(0), &other);
    // Both are white; what differs is noise, of 2√2 levels.
    let squares: Vec<f64> = (a.as_raw().iter().zip(b.as_raw()))
        .filter(|(x, _)| (40..220).contains(*x))
        .map(|(x, y)| (f64::from(*x) - f64::from(*y)).powi(2))
        .collect();
    let sigma = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    assert!((sigma / 8.0_f64.sqrt() - 1.0).abs() < 0.05, "{sigma}");
    assert_eq!(scene.photo.to_rgb8(), other);
    assert!(scene.frame(4).unwrap_err().to_string().contains("below 4"));
    let stripes =
        SceneSetup { rig: RigConfig { camera: [96, 72], ..RigConfig::default() }, ..SceneSetup::default() };
    let stripes = stripes.photograph().unwrap();
    assert_eq!((stripes.frame_count(), stripes.frames().count()), (0, 0));
    assert!(stripes.frame(0).unwrap_err().to_string().contains("a sequence"));
}

#[test]
fn jpeg_and_mirrors_hold_for_every_photograph() {
    let pattern = SequencePattern::preset(PANEL, SequencePreset::SlstudioGray, Some(1)).unwrap();
    let render = RenderConfig { jpeg_quality: Some(90), ..RenderConfig::default() };
    let shot = scene(pattern.clone(), render).frame(2).unwrap();
    assert!(shot.file.is_some_and(|file| file.starts_with(&[0xFF, 0xD8])));
    // One bit: the right half is white, or the left one in a mirror.
    let half = |mirrored| {
        let rig = RigConfig {
            camera: [96, 72],
            camera_focal_px: 114.0,
            projector: PANEL,
            projector_focal_px: 425.0,
            ..RigConfig::default()
        };
        let pattern = PatternKind::Known(Pattern::Sequence(pattern.clone()));
        let setup = SceneSetup { rig, pattern, mirrored, render: linear(), ..SceneSetup::default() };
        let scene = setup.photograph().unwrap();
        let values = greens(&scene.frame(2).unwrap().picture);
        let columns = scene.columns();
        let right = |&(c, _): &(&f32, &f64)| *c > 160.0;
        let lit: Vec<f64> = columns.iter().zip(&values).filter(right).map(|(_, v)| *v).collect();
        lit.iter().sum::<f64>() / lit.len() as f64
    };
    assert!(half(false) > 5.0 * half(true), "{} {}", half(false), half(true));
}
