//! The light on the sensor.

use image::{DynamicImage, Rgb, RgbImage};

use super::{bent_rig, block, exact, plane, rig, wall};
use crate::pattern::{StripeConfig, StripePattern};
use crate::photo::Encoding;
use crate::rig::Rig;
use crate::simulate::{Photographer, ProjectedImage, RenderConfig, Shape, Surface};

/// Linear light by channel.
fn light(photo: &DynamicImage, encoding: Encoding) -> Vec<[f64; 3]> {
    let samples = photo.to_rgb16();
    samples.pixels().map(|p| p.0.map(|c| encoding.to_linear(f64::from(c) / 65535.0))).collect()
}

fn linear() -> RenderConfig {
    RenderConfig { encoding: Encoding::Linear, ambient: [0.1; 3], ..exact() }
}

/// Camera and projector in one place with one lens, the projector's pixels `n` camera pixels wide and offset by half a
/// camera pixel: the light on each camera pixel follows by counting.
fn twins(n: u32) -> Rig {
    let mut rig = rig(96);
    let camera = rig.camera.model;
    let projector = &mut rig.projector.as_mut().unwrap().device.model;
    [projector.width, projector.height] = [camera.width / n, camera.height / n];
    projector.intrinsics = camera.intrinsics;
    let k = &mut projector.intrinsics;
    [k.fx, k.fy] = [k.fx / f64::from(n), k.fy / f64::from(n)];
    // Camera position x is panel position (x + 0.5 − 0.5) / n − 0.5.
    [k.cx, k.cy] = [k.cx / f64::from(n) - 0.5, (k.cy + 0.5) / f64::from(n) - 0.5];
    rig.projector.as_mut().unwrap().from_camera.pose = crate::geometry::Pose::identity();
    rig
}

#[test]
fn pixels_average_the_light_that_falls_on_them_exactly() {
    let rig = twins(4);
    let mut picture = RgbImage::new(24, 18);
    picture.put_pixel(7, 5, Rgb([255, 0, 0]));
    let wall = [Surface::object(Shape::Plane(plane(1000.0, 0.0, 0.0)))];
    let seen = Photographer::new(&rig, &wall, &linear()).unwrap();
    let photo = light(&seen.photograph(ProjectedImage::Picture(&picture), 0).unwrap(), Encoding::Linear);
    let reference = (seen.truth().pixels().flatten().filter(|s| s.panel.is_some()))
        .map(|s| s.point.coords.norm())
        .collect::<Vec<_>>();
    let mut sorted = reference.clone();
    sorted.sort_by(f64::total_cmp);
    let reference = sorted[sorted.len() / 2];
    for y in 0..72_usize {
        for x in 0..96_usize {
            // Panel pixel 7 covers camera positions 28 to 32 (of pixels centred at integers, half a pixel aside).
            let across = match x {
                29..=31 => 1.0,
                28 | 32 => 0.5,
                _ => 0.0,
            };
            let down = f64::from(u8::from((20..24).contains(&y)));
            let d = seen.truth().at(x, y).unwrap().point.coords.norm();
            let e = (1000.0 / d) * (reference / d).powi(2);
            let red = 0.8 * (0.1 + e * across * down);
            let [r, g, _] = photo[y * 96 + x];
            assert!((r - red).abs() < 2e-5, "{x},{y}: {r} {red}");
            assert!((g - 0.08).abs() < 2e-5, "{x},{y}: {g}");
        }
    }
}

#[test]
fn light_falls_off_by_cosine_and_square() {
    let rig = bent_rig(96);
    let slanted = plane(1000.0, 10.0, 35.0);
    let surface = Surface::object(Shape::Plane(slanted)).colored([0.9, 0.5, 0.2]);
    let config = RenderConfig { reference_mm: Some(1100.0), exposure: 0.5, ..linear() };
    let seen = Photographer::new(&rig, &[surface], &config).unwrap();
    let photo = light(&seen.photograph(ProjectedImage::White, 0).unwrap(), Encoding::Linear);
    let lamp = rig.projector.unwrap().from_camera.pose.centre();
    let mut checked = 0;
    for (pixel, found) in seen.truth().pixels().zip(&photo) {
        let Some(pixel) = pixel
            .filter(|p| p.panel.is_some_and(|q| q.x > 10.0 && q.x < 1013.0 && q.y > 10.0 && q.y < 757.0))
        else {
            continue;
        };
        let way = lamp - pixel.point;
        let e = slanted.normal.dot(&way.normalize()).abs() * (1100.0 / way.norm()).powi(2);
        for (albedo, found) in [0.9, 0.5, 0.2].into_iter().zip(found) {
            assert!((0.5 * albedo * (0.1 + e) - found).abs() < 2e-4, "{found}");
        }
        checked += 1;
    }
    assert!(checked > 1000, "{checked}");
}

#[test]
fn stripes_are_at_their_true_places() {
    let rig = bent_rig(1280);
    let pattern = StripePattern::new([1024, 768], &StripeConfig::default()).unwrap();
    let white = StripePattern { palette: vec![[255; 3]; 4], ..pattern.clone() };
    let surface = [Surface::object(Shape::Plane(plane(1000.0, 12.0, 30.0)))];
    // Sharp, the pixels at a slit's two borders move the sum's centroid by √(2/720) px over the slit's 6 to 7 px; blurred, nothing.
    for (blur_px, projector_blur_px, most) in [(0.0, 0.0, 0.009), (0.6, 0.5, 0.004)] {
        let config = RenderConfig { blur_px, projector_blur_px, ambient: [0.0; 3], ..linear() };
        let seen = Photographer::new(&rig, &surface, &config).unwrap();
        let shot = |shown| light(&seen.photograph(shown, 0).unwrap(), Encoding::Linear);
        // Divided by white, since the falloff across a slanted stripe also moves its centroid.
        let (photo, full) =
            (shot(ProjectedImage::Picture(&white.image().unwrap())), shot(ProjectedImage::White));
        let (mut sum, mut squares, mut n) = (0.0, 0.0, 0.0);
        for m in seen.stripe_matches(&pattern).items.windows(3) {
            let [a, b, c] = [m[0], m[1], m[2]].map(|m| m.camera);
            if a.y != b.y || c.y != b.y || b.y % 7.0 != 0.0 {
                continue;
            }
            let row = b.y as usize * 1280;
            let (from, to) =
                (f64::midpoint(a.x, b.x).ceil() as usize, f64::midpoint(b.x, c.x).ceil() as usize);
            let (mut weight, mut moment) = (0.0, 0.0);
            for x in from..to {
                let light = photo[row + x][1] / full[row + x][1];
                weight += light;
                moment += light * x as f64;
            }
            let off = moment / weight - b.x;
            sum += off;
            squares += off * off;
            n += 1.0;
        }
        assert!(n > 1500.0, "{n}");
        let (bias, rms) = (sum / n, f64::sqrt(squares / n));
        // The middle of a slit's image is not the image of its middle: perspective over half a slit, a few thousandths.
        assert!(bias.abs() < 0.004 && rms < most, "blur {blur_px}: bias {bias:.5}, rms {rms:.5}");
    }
}

#[test]
fn the_background_is_the_same_near_an_object_and_far_from_it() {
    let config = RenderConfig { background: [0.05; 3], ..linear() };
    let thing = [Surface::object(block(40.0, 1000.0, 200.0))];
    let seen = Photographer::new(&rig(96), &thing, &config).unwrap();
    let photo = light(&seen.photograph(ProjectedImage::Black, 0).unwrap(), Encoding::Linear);
    let [dark, bright] = [0.8 * 0.05, 0.8 * 0.1].map(|l| (l - 2e-5)..(l + 2e-5));
    let count = |range: &std::ops::Range<f64>| photo.iter().filter(|l| range.contains(&l[0])).count();
    assert!(count(&dark) > photo.len() / 2 && count(&bright) > 20);
    // Between the two there is nothing but a border a pixel wide.
    assert!(photo.iter().all(|l| l[0] > dark.start && l[0] < bright.end));
}

#[test]
fn edges_of_objects_are_antialiased() {
    let rig = rig(160);
    let surfaces = [wall(1400.0), Surface::object(block(20.0, 1000.0, 200.0))];
    let at = |samples| {
        let config = RenderConfig { samples, ..linear() };
        let seen = Photographer::new(&rig, &surfaces, &config).unwrap();
        light(&seen.photograph(ProjectedImage::White, 0).unwrap(), Encoding::Linear)
    };
    let (fine, default, coarse) = (at(16), at(4), at(1));
    let squares = |a: &[[f64; 3]]| a.iter().zip(&fine).map(|(a, b)| (a[0] - b[0]).powi(2)).sum::<f64>();
    let (d, c) = (squares(&default).sqrt(), squares(&coarse).sqrt());
    // Four rays instead of one across an edge: a quarter of the error.
    assert!(d < 0.3 * c && c > 1.0, "{d} {c}");
}

#[test]
fn noise_blur_and_crosstalk_are_as_configured() {
    let rig = rig(160);
    let grey = [Surface::object(Shape::Plane(plane(1000.0, 0.0, 0.0))).colored([0.6, 0.4, 0.2])];
    let photo = |config: &RenderConfig, frame| {
        Photographer::new(&rig, &grey, config).unwrap().photograph(ProjectedImage::White, frame).unwrap()
    };
    let noisy = RenderConfig { noise_levels: 3.0, seed: 7, bits: 16, ..RenderConfig::default() };
    let quiet = RenderConfig { noise_levels: 0.0, ..noisy.clone() };
    let (clean, a, b) = (photo(&quiet, 0), photo(&noisy, 0), photo(&noisy, 1));
    assert_eq!(a, photo(&noisy, 0), "the same seed and frame");
    assert_ne!(a, b, "another frame");
    let codes = |i: &DynamicImage| i.to_rgb16().into_raw().into_iter().map(f64::from).collect::<Vec<_>>();
    let (clean, a, b) = (codes(&clean), codes(&a), codes(&b));
    let sigma = |d: Vec<f64>| (d.iter().map(|v| v * v).sum::<f64>() / d.len() as f64).sqrt() / 257.0;
    let difference = |a: &[f64], b: &[f64]| sigma(a.iter().zip(b).map(|(a, b)| a - b).collect());
    // 57600 samples: the σ of a measured σ is 0.3 %.
    assert!((difference(&a, &clean) - 3.0).abs() < 0.04);
    assert!((difference(&a, &b) - 3.0 * 2_f64.sqrt()).abs() < 0.06, "frames are independent");

    let mixed = RenderConfig { crosstalk: RenderConfig::neighbour_crosstalk(0.2), ..linear() };
    let (plain, mixed) =
        (light(&photo(&linear(), 0), Encoding::Linear), light(&photo(&mixed, 0), Encoding::Linear));
    for (p, m) in plain.iter().zip(&mixed) {
        let expected =
            [(p[0] + 0.2 * p[1]) / 1.2, (0.2 * p[0] + p[1] + 0.2 * p[2]) / 1.4, (0.2 * p[1] + p[2]) / 1.2];
        assert!((0..3).all(|c| (m[c] - expected[c]).abs() < 3e-5));
    }
}

#[test]
fn a_blurred_edge_has_the_width_of_the_gaussian() {
    let rig = twins(1);
    let mut picture = RgbImage::new(96, 72);
    (0..72).for_each(|y| (48..96).for_each(|x| picture.put_pixel(x, y, Rgb([255; 3]))));
    let wall = [Surface::object(Shape::Plane(plane(1000.0, 0.0, 0.0)))];
    // The edge falls on a pixel's middle, so that two neighbours share its step: that adds 1/4 to the second moment of the
    // slope; a projector's blur in steps of half a pixel falls on middles and borders in turn: 1/8.
    for (blur_px, projector_blur_px, sampling) in [(1.5, 0.0, 0.25), (0.0, 1.5, 0.125), (1.2, 0.9, 0.125)] {
        let config = RenderConfig { blur_px, projector_blur_px, ambient: [0.0; 3], ..linear() };
        let seen = Photographer::new(&rig, &wall, &config).unwrap();
        let shot = |shown| light(&seen.photograph(shown, 0).unwrap(), Encoding::Linear);
        let (edge, white) = (shot(ProjectedImage::Picture(&picture)), shot(ProjectedImage::White));
        let row: Vec<f64> = (36 * 96 + 34..36 * 96 + 62).map(|i| edge[i][0] / white[i][0]).collect();
        let slope: Vec<f64> = row.windows(2).map(|w| w[1] - w[0]).collect();
        let mean = slope.iter().enumerate().map(|(i, s)| s * i as f64).sum::<f64>();
        let variance = slope.iter().enumerate().map(|(i, s)| s * (i as f64 - mean).powi(2)).sum::<f64>();
        let sigma = (variance - sampling).sqrt();
        assert!((sigma - 1.5).abs() < 0.005, "{blur_px} {projector_blur_px}: {sigma}");
    }
}

#[test]
fn a_picture_of_another_size_is_refused() {
    let seen = Photographer::new(&rig(96), &[wall(1000.0)], &exact()).unwrap();
    let error = seen.photograph(ProjectedImage::Picture(&RgbImage::new(10, 10)), 0).unwrap_err();
    assert!(error.to_string().contains("1024x768"), "{error}");
}
