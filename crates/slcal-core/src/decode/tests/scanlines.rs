//! Edges, scale and noise against scanlines rendered in closed form.

use image::{DynamicImage, Rgb, RgbImage};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

use super::super::config::{DecodeInput, ScanDirection};
use super::super::noise::Noise;
use super::super::scanlines::{Scanline, ScanlineReader, Tables};
use super::super::stripe_edges::{FilterRadii, Scratch, StripeEdges, find};
use super::super::stripe_scale::{ScaleScratch, measure_scale};
use crate::photo::{Encoding, PhotoView};

/// The integral up to x of a step at zero blurred by a Gaussian: σ (z Φ(z) + φ(z)), z = x/σ.
fn ramp(x: f64, sigma: f64) -> f64 {
    let z = x / sigma;
    let phi = (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
    let cumulative = 0.5 * (1.0 + libm::erf(z / std::f64::consts::SQRT_2));
    sigma * (z * cumulative + phi)
}

/// Mean over a pixel of stripes 0 to 1 with the given edges.
fn pixel(x: usize, stripes: &[[f64; 2]], sigma: f64) -> f64 {
    let (a, b) = (x as f64 - 0.5, x as f64 + 0.5);
    let step = |edge: f64| ramp(b - edge, sigma) - ramp(a - edge, sigma);
    let near = |s: &&[f64; 2]| s[0] - 8.0 * sigma < b + 1.0 && s[1] + 8.0 * sigma > a - 1.0;
    stripes.iter().filter(near).map(|s| step(s[0]) - step(s[1])).sum()
}

fn line(length: usize, stripes: &[[f64; 2]], sigma: f64, rng: &mut ChaCha8Rng, noise: f64) -> Scanline {
    let normal = Normal::new(0.0, noise).unwrap();
    let mut line = Scanline::default();
    for x in 0..length {
        let light = 0.04 + 0.5 * pixel(x, stripes, sigma);
        line.rgb.push([1.0, 0.7, 0.2].map(|c| (c * light + normal.sample(rng)) as f32));
    }
    line.total.extend(line.rgb.iter().map(|c| c[0] + c[1] + c[2]));
    line
}

fn noise_of(sigma: f64) -> Noise {
    let mut noise = Noise::new(Encoding::Linear);
    noise.set(sigma as f32);
    noise
}

/// The stripes of a scanline, and the number of rejected peaks.
fn crossings(line: &Scanline, edge: usize, noise: f64) -> (Vec<StripeEdges>, usize) {
    let (radii, mut found) = (FilterRadii { smoothing: 0, edge }, Vec::new());
    let color = |x: usize| line.rgb.get(x).copied().unwrap_or([0.0; 3]);
    let rejected = find(line, radii, &noise_of(noise), &mut Scratch::default(), color, &mut found, None);
    (found, rejected)
}

#[test]
fn edges_are_located_without_bias_for_any_blur_and_phase() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for (width, sigma, edge) in [(8.0, 0.4, 3), (8.0, 0.8, 3), (12.0, 1.2, 5), (20.0, 2.0, 7), (40.0, 3.0, 9)]
    {
        let (mut worst, mut sum, mut n) = (0.0_f64, 0.0, 0.0);
        for _ in 0..100 {
            let phase = rng.random_range(0.0..1.0);
            let stripes: Vec<[f64; 2]> =
                (0..6).map(|k| 20.0 + phase + 2.0 * width * f64::from(k)).map(|l| [l, l + width]).collect();
            let line = line((13.0 * width) as usize + 40, &stripes, sigma, &mut rng, 0.0);
            let (found, rejected) = crossings(&line, edge, 1e-3);
            assert_eq!((found.len(), rejected), (6, 0));
            for (c, truth) in found.iter().zip(&stripes) {
                for (at, truth) in [(c.left, truth[0]), (c.right, truth[1])] {
                    let error = f64::from(at) - truth;
                    worst = worst.max(error.abs());
                    sum += error;
                    n += 1.0;
                }
            }
        }
        let bias = sum / n;
        assert!(worst < 0.02 && bias.abs() < 1e-3, "{width} px wide, blur {sigma}: {worst} {bias}");
    }
}

#[test]
fn the_predicted_sigma_of_an_edge_is_its_scatter() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let (stripes, noise) = ([[20.3, 32.3], [44.3, 56.3]], 0.01);
    let (mut squares, mut predicted, mut n) = (0.0, 0.0, 0.0);
    for _ in 0..500 {
        let line = line(80, &stripes, 0.8, &mut rng, noise);
        let (mut found, _) = crossings(&line, 3, noise);
        // Noise peaks in the dark between them do not count here.
        found.retain(|c| c.height > 0.4);
        assert_eq!(found.len(), 2);
        for (c, truth) in found.iter().zip(&stripes) {
            squares += (f64::from(c.left) - truth[0]).powi(2) + (f64::from(c.right) - truth[1]).powi(2);
            predicted += 2.0 * f64::from(c.edge_sigma);
            n += 2.0;
        }
    }
    let ratio = (squares / n).sqrt() / (predicted / n);
    assert!((0.7..1.4).contains(&ratio), "{ratio}");
}

/// An 8-bit photograph of stripes down the image, `width` px wide and as far apart, with noise.
fn photograph(width: f64, size: [u32; 2], noise: f64, seed: u64) -> DynamicImage {
    let count = (f64::from(size[0]) / (2.0 * width)) as usize;
    let stripes: Vec<[f64; 2]> =
        (0..count).map(|k| (2.0 * k as f64 + 0.6) * width).map(|l| [l, l + width]).collect();
    let (mut rng, normal) = (ChaCha8Rng::seed_from_u64(seed), Normal::new(0.0, noise).unwrap());
    let row: Vec<f64> = (0..size[0] as usize).map(|x| pixel(x, &stripes, 0.7)).collect();
    DynamicImage::from(RgbImage::from_fn(size[0], size[1], |x, _| {
        let code = 40.0 + 140.0 * row[x as usize];
        Rgb([1.0, 0.6, 0.8].map(|c| (c * code + normal.sample(&mut rng)).round().clamp(0.0, 255.0) as u8))
    }))
}

/// Calls `with` with readers of the photograph along rows and along columns, in linear encoding.
fn read<T>(photo: &DynamicImage, with: impl Fn(&ScanlineReader<'_>, &ScanlineReader<'_>) -> T) -> T {
    let view = PhotoView::try_from(photo).unwrap();
    let mut tables = Tables::default();
    tables.prepare(&view, Encoding::Linear);
    let input = DecodeInput { photo: view, black: None, white: None };
    let [rows, columns] =
        [ScanDirection::Rows, ScanDirection::Columns].map(|scan| ScanlineReader::new(&input, &tables, scan));
    with(&rows, &columns)
}

#[test]
fn noise_is_measured_between_the_stripes() {
    for levels in [1.0, 3.0, 8.0] {
        let photo = photograph(30.0, [1200, 120], levels, 7);
        let measured = read(&photo, |rows, _| {
            let mut noise = Noise::new(Encoding::Linear);
            noise.measure(rows);
            f64::from(noise.sigma_code) * 255.0
        });
        // Rounding to whole levels adds 1/√12.
        let truth = levels.hypot(12.0_f64.sqrt().recip());
        // Second differences of whole levels come in steps of a half: in σ, 1.28.
        assert!((measured - truth).abs() < 0.64 + 0.1 * truth, "{measured} for {truth}");
    }
}

#[test]
fn direction_and_scale_are_estimated_for_any_stripes() {
    for (width, levels) in [(3.0, 1.0), (5.0, 4.0), (8.5, 4.0), (16.0, 6.0), (30.0, 6.0), (60.0, 6.0)] {
        let photo = photograph(width, [1500, 60], levels, 11);
        let (seen, other) = read(&photo, |rows, columns| {
            let mut noise = Noise::new(Encoding::Linear);
            noise.measure(rows);
            let mut work = ScaleScratch::default();
            (measure_scale(rows, &noise, &mut work), measure_scale(columns, &noise, &mut work))
        });
        let seen = seen.expect("stripes");
        let half = f64::from(seen.half_period_px);
        assert!((half / width - 1.0).abs() < 0.1, "{half} for {width}");
        // Smoothing keeps stripes of half the width visible, and an edge is no longer than the blur.
        assert!(2 * seen.radii.smoothing < width as usize, "{:?} for {width}", seen.radii);
        assert!((2..=6).contains(&seen.radii.edge), "{:?} for {width}", seen.radii);
        assert!(other.is_none_or(|o| o.covered_px < 0.1 * seen.covered_px), "{other:?}");
    }
}
