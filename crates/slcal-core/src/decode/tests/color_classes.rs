//! Colour classes and crosstalk against rendered colours.

use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

use super::super::color_classes::{ColorClasses, ColorSample, NO_CLASS};
use super::super::crosstalk::{crosstalk, mixing};
use super::super::rgb::unit;
use crate::pattern::{StripeConfig, StripePattern};
use crate::photo::Encoding;

/// A camera whose channels see a fifth of the light of the adjacent ones, and that is out of balance.
fn camera() -> Matrix3<f32> {
    let mixed = Matrix3::new(1.0, 0.2, 0.0, 0.2, 1.0, 0.2, 0.0, 0.2, 1.0);
    Matrix3::from_diagonal(&Vector3::new(1.3, 1.0, 0.75)) * mixed
}

struct Drawn {
    palette: Vec<[f32; 3]>,
    sequence: Vec<u8>,
    /// Light of each hue in the camera.
    light: Vec<[f32; 3]>,
    samples: Vec<ColorSample>,
}

/// Forty scanlines across a pattern whose left part lies on a surface three times as bright as the other.
fn draw(hues: u32, order: u32, noise: f32) -> Drawn {
    let config = StripeConfig { hues, order, ..StripeConfig::default() };
    let pattern = StripePattern::new([1024, 768], &config).unwrap();
    let linear = |c: u8| Encoding::Srgb.to_linear(f64::from(c) / 255.0) as f32;
    let palette: Vec<[f32; 3]> = pattern.palette.iter().map(|c| c.map(linear)).collect();
    let light: Vec<[f32; 3]> = palette.iter().map(|&p| (camera() * Vector3::from(p)).into()).collect();
    let (mut rng, normal) = (ChaCha8Rng::seed_from_u64(1), Normal::new(0.0, noise).unwrap());
    let mut samples = Vec::new();
    for _ in 0..40 {
        for (k, &s) in pattern.sequence.iter().enumerate() {
            let lit = if k < 20 { 0.6 } else { 0.2 };
            let color = light[usize::from(s)].map(|c| lit * (c + normal.sample(&mut rng)));
            let sum = color[0] + color[1] + color[2];
            samples.push(ColorSample {
                unit: unit(color).unwrap(),
                sigma: noise,
                light: sum,
                log_light: sum.ln(),
            });
        }
    }
    Drawn { palette, sequence: pattern.sequence, light, samples }
}

fn angle(a: [f32; 3], b: [f32; 3]) -> f32 {
    Vector3::from(a).angle(&Vector3::from(b))
}

#[test]
fn classes_are_learned_as_the_camera_sees_them() {
    for (hues, order) in [(3, 4), (4, 3), (5, 3)] {
        let d = draw(hues, order, 0.01);
        let mut learned = ColorClasses::default();
        learned.seed(&d.palette, &d.sequence, &d.samples, true);
        learned.learn(&d.samples, None);
        for (seen, drawn) in learned.directions.iter().zip(&d.light) {
            let off = angle(*seen, unit(*drawn).unwrap());
            assert!(off < 0.01, "{off} rad of {hues} hues");
        }
        let right = d
            .samples
            .iter()
            .enumerate()
            .filter(|(i, s)| learned.nearest(s.unit) == d.sequence[i % d.sequence.len()]);
        assert!(right.count() as f64 > 0.999 * d.samples.len() as f64);
        let mut odds = vec![0.0; hues as usize];
        learned.log_odds(&d.samples[0], &mut odds);
        let best = odds[usize::from(d.sequence[0])];
        assert!(best > 0.9 * (hues as f32).ln() && odds.iter().all(|&o| o <= best), "{odds:?}");
    }
}

#[test]
fn brightness_of_classes_comes_from_neighbours_on_one_surface() {
    for (hues, order) in [(3, 4), (4, 3), (5, 3)] {
        let d = draw(hues, order, 0.005);
        let mut learned = ColorClasses::default();
        learned.seed(&d.palette, &d.sequence, &d.samples, true);
        let labels: Vec<u8> = (0..d.samples.len()).map(|i| d.sequence[i % d.sequence.len()]).collect();
        learned.learn(&d.samples, Some(&labels));
        let sums: Vec<f32> = d.light.iter().map(|c| c.iter().sum()).collect();
        let mean = sums.iter().sum::<f32>() / sums.len() as f32;
        for (seen, drawn) in learned.brightness.iter().zip(&sums) {
            assert!((seen / (drawn / mean) - 1.0).abs() < 0.03, "{:?} for {sums:?}", learned.brightness);
        }
    }
}

#[test]
fn nothing_is_learned_from_nothing() {
    let d = draw(4, 3, 0.01);
    let mut learned = ColorClasses::default();
    learned.seed(&d.palette, &d.sequence, &[], true);
    let before = learned.directions.clone();
    learned.learn(&[], None);
    learned.learn(&d.samples, Some(&vec![NO_CLASS; d.samples.len()]));
    assert!(learned.directions == before && learned.brightness.iter().all(|b| b.is_finite()));
}

#[test]
fn a_given_crosstalk_is_recovered() {
    let d = draw(4, 3, 0.01);
    let units: Vec<[f32; 3]> = d.light.iter().map(|&c| unit(c).unwrap()).collect();
    let sums: Vec<f32> = d.light.iter().map(|c| c.iter().sum()).collect();
    let m = crosstalk(&mixing(&d.palette, &units, &sums).unwrap()).unwrap();
    let drawn = camera();
    for k in 0..3 {
        let top = drawn.column(k).amax();
        for row in 0..3 {
            let expected = f64::from(drawn[(row, k)] / top);
            assert!((m[row][k] - expected).abs() < 1e-5, "{m:?}");
        }
    }
    // Two colours do not distinguish three primaries; nor do colours in one plane.
    assert!(mixing(&d.palette[..2], &units[..2], &sums[..2]).is_none());
    assert!(mixing(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]], &units[..3], &sums[..3]).is_none());
}
