//! Red and blue beside green, by a checkerboard measured channel by channel.

use image::{DynamicImage, ImageBuffer, Luma};
use nalgebra::{Point2, Vector2};

use super::{exact, plane};
use crate::detect::{DetectConfig, find_corners};
use crate::geometry::Ray;
use crate::pattern::{CheckerConfig, CheckerPattern};
use crate::photo::PhotoView;
use crate::rig::Rig;
use crate::simulate::{
    Photographer, PoseConfig, ProjectedImage, RenderConfig, RigConfig, Scene, Shape, Surface,
};

const RED: usize = 0;
const GREEN: usize = 1;
const BLUE: usize = 2;

/// A tilted wall, both lenses bent, both principal points off the centre.
fn set_up() -> (Rig, Surface, CheckerPattern) {
    let config = RigConfig {
        camera: [960, 720],
        camera_focal_px: 1100.0,
        camera_offset_px: [14.0, -9.0],
        distortion: [-0.1, 0.02, 4e-4, -3e-4, 0.0],
        projector_distortion: [-0.02, 0.01, 3e-4, -2e-4, 0.0],
        projector_offset_px: 20.0,
        ..RigConfig::default()
    };
    let rig = Scene::new(&config, &[PoseConfig::tilted(0.0, 0.0)]).unwrap().rig();
    let checker = CheckerPattern::new(config.projector, &CheckerConfig::default()).unwrap();
    (rig, Surface::object(Shape::Plane(plane(1000.0, 12.0, -18.0))), checker)
}

/// The corners of one channel, by panel position.
fn corners(
    photo: &DynamicImage,
    channel: usize,
    checker: &CheckerPattern,
) -> Vec<(Point2<f64>, Point2<f64>)> {
    let rgb = photo.to_rgb16();
    let grey = ImageBuffer::from_fn(rgb.width(), rgb.height(), |x, y| Luma([rgb.get_pixel(x, y).0[channel]]));
    let grey = DynamicImage::ImageLuma16(grey);
    let view = PhotoView::try_from(&grey).unwrap();
    let found = find_corners(view, checker, &DetectConfig::default()).unwrap();
    found.pairs.iter().map(|p| (p.projector, p.camera)).collect()
}

/// Where the camera of the rig sees the light of a panel position on the wall: by the models of the lenses alone.
fn seen(rig: &Rig, surface: &Surface, panel: Point2<f64>) -> Point2<f64> {
    let Shape::Plane(plane) = &surface.shape else { panic!("a wall") };
    let projector = rig.require_projector().unwrap();
    let pose = projector.from_camera.pose;
    let direction = pose.rotation.inverse() * projector.device.model.bearing(panel).unwrap();
    let point = Ray { origin: pose.centre(), direction }.meet(plane).unwrap();
    rig.camera.model.project(&point).unwrap()
}

fn photograph(render: &RenderConfig) -> (Rig, Surface, CheckerPattern, DynamicImage) {
    let (rig, surface, checker) = set_up();
    let photographer = Photographer::new(&rig, std::slice::from_ref(&surface), render).unwrap();
    let photo = photographer.photograph(ProjectedImage::Picture(&checker.image().unwrap()), 0).unwrap();
    (rig, surface, checker, photo)
}

/// Mean and rms distance between measured and expected corners of a channel.
fn errors(
    (rig, surface, checker, photo): &(Rig, Surface, CheckerPattern, DynamicImage),
    channel: usize,
    expected: impl Fn(&Rig, &Surface, Point2<f64>) -> Point2<f64>,
) -> (f64, f64) {
    let off: Vec<Vector2<f64>> = (corners(photo, channel, checker).iter())
        .map(|(panel, camera)| camera - expected(rig, surface, *panel))
        .collect();
    assert!(off.len() >= 60, "{}", off.len());
    let n = off.len() as f64;
    let mean: Vector2<f64> = off.iter().sum::<Vector2<f64>>() / n;
    (mean.norm(), (off.iter().map(Vector2::norm_squared).sum::<f64>() / n).sqrt())
}

fn sharp() -> RenderConfig {
    RenderConfig { blur_px: 0.6, ..exact() }
}

#[test]
fn light_of_shifted_panels_falls_where_green_light_of_the_sum_falls() {
    let [red, blue] = [[1.3, -0.7], [-0.9, 1.6]];
    let shot = photograph(&RenderConfig { channel_shift_px: [red, blue], ..sharp() });
    for (channel, shift) in [(RED, red), (GREEN, [0.0; 2]), (BLUE, blue)] {
        let (mean, rms) = errors(&shot, channel, |rig, wall, q| seen(rig, wall, q + Vector2::from(shift)));
        assert!(mean < 0.005 && rms < 0.015, "channel {channel}: mean {mean:.4}, rms {rms:.4} px");
        // The shift is large against what this measures.
        let (mean, _) = errors(&shot, channel, seen);
        assert!((mean > 0.3) == (channel != GREEN), "channel {channel}: {mean}");
    }
}

#[test]
fn lateral_colour_scales_about_the_principal_point() {
    let [red, blue] = [0.003, -0.002];
    let shot = photograph(&RenderConfig { lateral_colour: [red, blue], ..sharp() });
    let centre = shot.0.camera.model.intrinsics.principal_point();
    for (channel, radial) in [(RED, red), (GREEN, 0.0), (BLUE, blue)] {
        let scaled = |rig: &Rig, wall: &Surface, q| centre + (seen(rig, wall, q) - centre) * (1.0 + radial);
        let (mean, rms) = errors(&shot, channel, scaled);
        assert!(mean < 0.005 && rms < 0.015, "channel {channel}: mean {mean:.4}, rms {rms:.4} px");
        let (_, rms) = errors(&shot, channel, seen);
        assert!((rms > 0.15) == (channel != GREEN), "channel {channel}: {rms}");
    }
}

/// The red channel under `config`, and the green one of another rig under `plain`, must be the same picture.
fn red_is_green_of(config: &RenderConfig, change: impl FnOnce(&mut Rig)) {
    let (rig, surface, checker) = set_up();
    let config = RenderConfig { reference_mm: Some(1000.0), ..config.clone() };
    let plain = RenderConfig { channel_shift_px: [[0.0; 2]; 2], lateral_colour: [0.0; 2], ..config.clone() };
    let mut other = rig.clone();
    change(&mut other);
    let [red, green] = [(&rig, &config, RED), (&other, &plain, GREEN)].map(|(rig, config, channel)| {
        let photographer = Photographer::new(rig, std::slice::from_ref(&surface), config).unwrap();
        let photo = photographer.photograph(ProjectedImage::Picture(&checker.image().unwrap()), 0).unwrap();
        photo.into_rgb16().pixels().map(|p| p.0[channel]).collect::<Vec<_>>()
    });
    // Apart from the last bit, and from single pixels at the border of the light that a ray just misses.
    let differ = red.iter().zip(&green).filter(|(r, g)| r.abs_diff(**g) > 2).count();
    assert!(differ <= 2, "{differ} pixels");
}

#[test]
fn a_shifted_panel_is_a_projector_with_another_principal_point() {
    let shift = [1.3, -0.7];
    let config = RenderConfig { channel_shift_px: [shift, [0.0; 2]], blur_px: 0.0, ..sharp() };
    red_is_green_of(&config, |rig| {
        let k = &mut rig.projector.as_mut().unwrap().device.model.intrinsics;
        [k.cx, k.cy] = [k.cx - shift[0], k.cy - shift[1]];
    });
}

#[test]
fn lateral_colour_is_a_camera_with_another_focal_length() {
    let config = RenderConfig { lateral_colour: [0.003, 0.0], blur_px: 0.0, ..sharp() };
    red_is_green_of(&config, |rig| {
        let k = &mut rig.camera.model.intrinsics;
        [k.fx, k.fy] = [k.fx * 1.003, k.fy * 1.003];
    });
}

#[test]
fn green_and_the_truth_stay_as_they_are() {
    let (rig, surface, checker) = set_up();
    let apart = RenderConfig {
        channel_shift_px: [[0.5, -0.3], [-0.4, 0.5]],
        lateral_colour: [6e-4, -5e-4],
        noise_levels: 1.0,
        ..sharp()
    };
    let plain = RenderConfig { channel_shift_px: [[0.0; 2]; 2], lateral_colour: [0.0; 2], ..apart.clone() };
    let shoot = |config| Photographer::new(&rig, std::slice::from_ref(&surface), config).unwrap();
    let (apart, plain) = (shoot(&apart), shoot(&plain));
    assert!(apart.truth().pixels().eq(plain.truth().pixels()));
    assert_eq!(apart.corner_matches(&checker), plain.corner_matches(&checker));
    let picture = checker.image().unwrap();
    let [a, p] =
        [&apart, &plain].map(|s| s.photograph(ProjectedImage::Picture(&picture), 0).unwrap().into_rgb16());
    let differ = |c: usize| a.pixels().zip(p.pixels()).filter(|(a, p)| a.0[c] != p.0[c]).count();
    assert_eq!(differ(GREEN), 0);
    assert!(differ(RED) > 1000 && differ(BLUE) > 1000);
    // Light beside one panel that is not beside the other ends at the border of each.
    let white = apart.photograph(ProjectedImage::White, 0).unwrap().into_rgb16();
    assert!(white.pixels().any(|p| p.0[RED].abs_diff(p.0[GREEN]) > 4_000));
}
