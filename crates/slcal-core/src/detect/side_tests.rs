//! Sides of the sheet that are not a plain edge, on drawn photographs with known truth: the side face of a board, clips,
//! shadows, ends that curl.

use image::{DynamicImage, ImageBuffer, Luma};
use nalgebra::Point2;

use super::tests::{Drawn, from_panel, pattern};
use super::*;
use crate::geometry::{Line, RectangleSize};
use crate::observations::SheetObservation;
use crate::photo::{Encoding, PhotoView};

/// Light of the sheet under full projection and of what is behind it, as [`Drawn`] has them.
const SHEET: f64 = 0.75;
const BEHIND: f64 = 0.02;
/// σ of the camera's blur, px, and of its noise, linear light.
const BLUR: f64 = 0.6;
const NOISE: f64 = 0.003;

const SIDES: [&str; 4] = ["top", "right", "bottom", "left"];

/// The drawn sheet with something changed about it: `light` has the light at a point, and how it would be otherwise.
fn photograph(drawn: &Drawn, light: impl Fn(Point2<f64>, f64) -> f64) -> DynamicImage {
    /// Fibonacci lattices of samples in a pixel, (number, step): beside the outline, which is to be exact to 0.01 px, and
    /// elsewhere.
    const FINE: (u32, u32) = (233, 144);
    const COARSE: (u32, u32) = (13, 8);
    let [w, h] = drawn.size.map(|n| n as usize);
    let inverse = drawn.camera_from_projector.map(|c| c.inverse().unwrap());
    let outline: [SideLine; 4] = std::array::from_fn(|i| SideLine::of(drawn, i));
    let reach = 0.02 * f64::from(drawn.size[0]);
    let pixel = |x: usize, y: usize| {
        let middle = Point2::new(x as f64, y as f64);
        let beside = outline.iter().any(|side| side.split(middle).1.abs() < reach);
        let (samples, step) = if beside { FINE } else { COARSE };
        let offset = |k: u32| (f64::from(k % samples) + 0.5) / f64::from(samples) - 0.5;
        let at = |k: u32| middle + nalgebra::Vector2::new(offset(k), offset(step * k));
        let all = (0..samples).map(at).map(|p| light(p, drawn.light(p, inverse.as_ref())));
        all.sum::<f64>() / f64::from(samples)
    };
    let sharp: Vec<f64> = (0..w * h).map(|i| pixel(i % w, i / w)).collect();
    let kernel: Vec<f64> = (-3..=3).map(|k| (-0.5 * (f64::from(k) / BLUR).powi(2)).exp()).collect();
    let whole: f64 = kernel.iter().sum();
    let blurred = |image: &[f64], step: [usize; 2]| -> Vec<f64> {
        let clamped = |v: usize, k: usize, d: usize, n: usize| (v + k * d).saturating_sub(3 * d).min(n - 1);
        let at =
            |i: usize, k: usize| image[clamped(i / w, k, step[1], h) * w + clamped(i % w, k, step[0], w)];
        (0..w * h).map(|i| (0..7).map(|k| kernel[k] * at(i, k)).sum::<f64>() / whole).collect()
    };
    let soft = blurred(&blurred(&sharp, [1, 0]), [0, 1]);
    let mut seed = 1_u64;
    let mut uniform = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as f64 / f64::from(1_u32 << 31)
    };
    let mut noise = || (0..4).map(|_| uniform() - 0.5).sum::<f64>() * 3.0_f64.sqrt() * NOISE;
    DynamicImage::ImageLuma16(ImageBuffer::from_fn(w as u32, h as u32, |x, y| {
        let v = soft[y as usize * w + x as usize];
        Luma([(Encoding::Srgb.from_linear((v + noise()).clamp(0.0, 1.0)) * 65535.0).round() as u16])
    }))
}

/// A tilted sheet that the projector lights with all its sides, in a photograph `width` pixels wide.
fn lit(width: u32) -> Drawn {
    let s = f64::from(width) / 640.0;
    let panel = [(80.0, 40.0), (640.0, 30.0), (635.0, 440.0), (130.0, 400.0)];
    let panel = panel.map(|(x, y)| Point2::new(x * s, y * s));
    Drawn { camera_from_projector: Some(from_panel(panel)), ..Drawn::tilted(width) }
}

fn observed(image: &DynamicImage) -> Detection {
    let size = RectangleSize::new(594.0, 420.0).unwrap();
    observe(PhotoView::try_from(image).unwrap(), None, size, Some(&pattern()), &DetectConfig::default())
        .unwrap()
}

/// A side from corner to corner.
struct SideLine {
    from: Point2<f64>,
    line: Line,
    length: f64,
}

impl SideLine {
    fn of(drawn: &Drawn, i: usize) -> Self {
        let [from, to] = [drawn.sheet[i], drawn.sheet[(i + 1) % 4]];
        Self {
            from,
            line: Line::through_pixels(from, to).normalized().unwrap(),
            length: nalgebra::distance(&from, &to),
        }
    }

    /// How far along the side a point lies, as a part of it, and how far inside the sheet, px.
    fn split(&self, p: Point2<f64>) -> (f64, f64) {
        let inward = self.line.normal();
        let along = nalgebra::Vector2::new(inward.y, -inward.x);
        (along.dot(&(p - self.from)) / self.length, self.line.signed_distance_px(p))
    }
}

/// All points lie within 0.1 px of the true sides and within six σ.
fn assert_on_the_sides(drawn: &Drawn, found: &Detection) {
    let SheetObservation::Edges(sides) = &found.observation.sheet else { panic!("edges") };
    for (i, points) in sides.iter().enumerate() {
        let side = SideLine::of(drawn, i);
        for point in points {
            let (along, off) = side.split(point.position);
            let sigma = point.sigma_px.unwrap();
            assert!(
                off.abs() < 0.1 && off.abs() < 6.0 * sigma,
                "{} side at {along:.3}: off by {off:.3} ± {sigma:.3} px; {:?}",
                SIDES[i],
                found.warnings
            );
        }
        let mean = points.iter().map(|p| side.split(p.position).1).sum::<f64>() / points.len() as f64;
        assert!(mean.abs() < 0.03, "{} side: {mean:.3} px; {:?}", SIDES[i], found.warnings);
    }
}

fn codes(found: &Detection) -> Vec<&str> {
    found.warnings.iter().map(|w| w.code.as_str()).collect()
}

/// How many points a side has within a part of it.
fn points_within(drawn: &Drawn, found: &Detection, i: usize, part: std::ops::Range<f64>) -> usize {
    let SheetObservation::Edges(sides) = &found.observation.sheet else { panic!("edges") };
    let side = SideLine::of(drawn, i);
    sides[i].iter().filter(|p| part.contains(&side.split(p.position).0)).count()
}

#[test]
fn a_plain_sheet_has_no_warnings() {
    let drawn = lit(640);
    let found = observed(&photograph(&drawn, |_, light| light));
    assert_eq!(codes(&found), [""; 0]);
    assert_on_the_sides(&drawn, &found);
}

/// A board whose side faces `faces` (side, px at its start and end, light) are seen.
fn board(drawn: &Drawn, faces: &[(usize, [f64; 2], f64)]) -> DynamicImage {
    let lines: Vec<_> = faces.iter().map(|f| (SideLine::of(drawn, f.0), f.1, f.2)).collect();
    photograph(drawn, |p, light| {
        let face = lines.iter().find(|(side, [from, to], _)| {
            let (along, inside) = side.split(p);
            (0.0..1.0).contains(&along) && (-(from + (to - from) * along)..0.0).contains(&inside)
        });
        face.map_or(light, |f| f.2)
    })
}

#[test]
fn of_the_two_edges_of_a_board_the_inner_one_is_the_sheets() {
    let drawn = lit(640);
    let mut told = String::new();
    for light in [0.15, 0.3, 0.45, 0.6, 0.95] {
        for width in [3.0, 4.5, 7.0] {
            // A ridge of four blurs or less could be sharpening by the camera.
            if light > SHEET && width < 4.0 {
                continue;
            }
            let found = observed(&board(&drawn, &[(1, [width, 0.9 * width], light)]));
            let faces: Vec<_> = found.warnings.iter().filter(|w| w.code == "side-face").collect();
            assert!(faces.len() == 1 && found.warnings.len() == 1, "{light} {width}: {:?}", found.warnings);
            told.clone_from(&faces[0].message);
            assert_on_the_sides(&drawn, &found);
        }
    }
    assert!(told.contains("the right side") && told.contains("6.3 to 7.0 px"), "{told}");
}

#[test]
fn two_faces_are_seen_of_a_board_and_no_more() {
    let drawn = lit(640);
    let found = observed(&board(&drawn, &[(0, [3.0, 3.5], 0.3), (1, [4.0, 3.5], 0.5)]));
    assert_eq!(codes(&found), ["side-face"; 2]);
    assert_on_the_sides(&drawn, &found);
    // Along opposite sides: no board, so that the outline is taken as it is.
    let found = observed(&board(&drawn, &[(1, [4.0, 4.0], 0.3), (3, [4.0, 4.0], 0.3)]));
    assert!(!codes(&found).contains(&"side-face"), "{:?}", found.warnings);
}

#[test]
fn the_face_of_a_board_is_told_in_a_large_photograph() {
    let drawn = lit(2560);
    let found = observed(&board(&drawn, &[(1, [16.0, 14.0], 0.45)]));
    assert_eq!(codes(&found), ["side-face"]);
    assert_on_the_sides(&drawn, &found);
}

#[test]
fn a_clip_over_a_part_of_a_side_is_left_out_and_told() {
    let drawn = lit(640);
    for light in [0.01, 0.3, 0.9] {
        for (i, name) in SIDES.iter().enumerate() {
            let side = SideLine::of(&drawn, i);
            let image = photograph(&drawn, |p, behind| {
                let (along, inside) = side.split(p);
                if (0.4..0.55).contains(&along) && (-15.0..9.0).contains(&inside) { light } else { behind }
            });
            let found = observed(&image);
            assert_eq!(codes(&found), ["side-covered"], "{name} {light}: {:?}", found.warnings);
            assert!(found.warnings[0].message.contains(&format!("the {name} side")), "{:?}", found.warnings);
            assert_on_the_sides(&drawn, &found);
            assert_eq!(points_within(&drawn, &found, i, 0.4..0.55), 0);
            assert!(points_within(&drawn, &found, i, 0.0..0.4) > 10);
        }
    }
}

#[test]
fn a_shadow_over_half_of_a_side_does_not_move_it() {
    let drawn = lit(640);
    for depth in [0.3, 0.7, 0.97] {
        for soft in [0.002, 0.02] {
            let side = SideLine::of(&drawn, 2);
            let image = photograph(&drawn, |p, light| {
                let (along, inside) = side.split(p);
                // Its border runs obliquely across the side, and it ends within the sheet.
                let border = along - 0.5 - 0.002 * inside;
                let within = ((24.0 - inside) / 3.0).clamp(0.0, 1.0);
                light * (1.0 - depth * within * (0.5 + border / soft).clamp(0.0, 1.0))
            });
            let found = observed(&image);
            assert_on_the_sides(&drawn, &found);
        }
    }
}

#[test]
fn an_end_that_curls_is_left_out() {
    let drawn = lit(640);
    for (i, name) in SIDES.iter().enumerate() {
        let side = SideLine::of(&drawn, i);
        for depth in [-4.0, -1.5, 1.5, 4.0] {
            let image = photograph(&drawn, |p, light| {
                let (along, inside) = side.split(p);
                let bend = depth * ((along - 0.9) / 0.1).clamp(0.0, 1.0).powi(2);
                let near = (0.9..1.0).contains(&along) && inside.abs() < 6.0;
                match near {
                    true if inside > bend => SHEET,
                    true => BEHIND,
                    false => light,
                }
            });
            let found = observed(&image);
            assert_on_the_sides(&drawn, &found);
            let told = codes(&found).iter().any(|c| ["side-covered", "side-curled"].contains(c));
            assert!(told || depth.abs() < 2.0, "{name} {depth}: {:?}", found.warnings);
        }
    }
}
