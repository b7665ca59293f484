//! Time of a calibration against the number of views: it must grow in proportion. Run with `cargo bench -p slcal-core`.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::{Point2, Point3, Rotation3, Vector2, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use slcal_core::geometry::{Camera, Distortion, Intrinsics, Plane, Pose, Ray, RectangleSize};
use slcal_core::{
    CalibrateConfig, CornerPair, DistortionModel, EdgePoint, Observations, SheetObservation, ViewObservation,
    calibrate_observations,
};

const SIZE: RectangleSize = RectangleSize { width_mm: 594.0, height_mm: 420.0 };
/// Edge points per side, about as many as are measured on a photograph.
const POINTS: usize = 60;

fn lens([width, height]: [u32; 2], focal_px: f64, pp: Point2<f64>) -> Camera {
    let intrinsics = Intrinsics::square(focal_px, pp);
    Camera { width, height, intrinsics, distortion: Distortion::NONE }
}

fn around(axis: nalgebra::Unit<Vector3<f64>>, degrees: f64) -> Rotation3<f64> {
    Rotation3::from_axis_angle(&axis, degrees.to_radians())
}

/// An A2 sheet 1 m away, tilted by 15° to 35° in a direction that goes round from view to view.
fn pose(k: usize) -> Pose {
    let (turn, tilt) = (2.4 * k as f64, 15.0 + (7 * k % 20) as f64);
    let rotation =
        around(Vector3::x_axis(), tilt * turn.cos()) * around(Vector3::y_axis(), tilt * turn.sin());
    Pose {
        rotation,
        translation: Vector3::new(0.0, 0.0, 1000.0) - rotation * Vector3::new(297.0, 210.0, 0.0),
    }
}

/// What a camera and a shifted projector to its right see, with noise of a tenth of a pixel.
fn observations(views: usize) -> Observations {
    let camera = lens([1280, 960], 1500.0, Point2::new(639.5, 479.5));
    let projector = lens([1024, 768], 1700.0, Point2::new(511.5, 768.0));
    let aim = around(Vector3::y_axis(), 11.5);
    let back = Pose { rotation: aim.inverse(), translation: Vector3::new(250.0, 237.0, 0.0) };
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut noisy =
        |p: Point2<f64>| p + Vector2::new(rng.random_range(-0.17..0.17), rng.random_range(-0.17..0.17));
    let views = (0..views).map(pose).map(|pose| {
        let mut seen = |p: Point3<f64>| noisy(camera.project(&p).expect("in front"));
        let corners = SIZE.corners();
        let sides = std::array::from_fn(|i| {
            let (a, b) = (corners[i], corners[(i + 1) % 4]);
            let on_side = |k: usize| a + (b - a) * ((k as f64 + 0.5) / POINTS as f64);
            let points = (0..POINTS).map(on_side).map(|p| pose.transform(&Point3::new(p.x, p.y, 0.0)));
            points.map(|p| EdgePoint { position: seen(p), sigma_px: Some(0.1) }).collect()
        });
        let normal = pose.rotation * Vector3::z();
        let plane = Plane::from_point_normal(&pose.translation.into(), normal).expect("a plane");
        let pairs = (0..70).map(|k| {
            let q = Point2::new(271.5 + 48.0 * f64::from(k % 10), 233.5 + 48.0 * f64::from(k / 10));
            let direction = back.rotation * projector.bearing(q).expect("no distortion");
            let p = Ray { origin: back.translation.into(), direction }.meet(&plane).expect("lit");
            CornerPair { camera: seen(p), projector: q, sigma_px: Some(0.1) }
        });
        let pairs = pairs.collect();
        ViewObservation {
            photo: None,
            size: SIZE,
            sheet: SheetObservation::Edges(sides),
            pairs,
            panel_points: Vec::new(),
            channel_offsets: Vec::new(),
        }
    });
    let views = views.collect();
    Observations { camera: [1280, 960], projector: Some([1024, 768]), mirrored: false, views }
}

fn calibrate(c: &mut Criterion) {
    let mut group = c.benchmark_group("calibrate");
    group.sample_size(10);
    for views in [1, 2, 5, 10, 20] {
        let o = observations(views);
        group.throughput(Throughput::Elements(views as u64));
        // What is fitted is held the same for every number of views.
        let config = CalibrateConfig { distortion: DistortionModel::K1K2, ..CalibrateConfig::default() };
        group.bench_with_input(BenchmarkId::new("k1k2", views), &o, |b, o| {
            b.iter(|| calibrate_observations(o, &config).expect("a rig"));
        });
        // With three views or more the projector's distortion is tried as well.
        let config =
            CalibrateConfig { projector_distortion: DistortionModel::Auto, ..CalibrateConfig::default() };
        group.bench_with_input(BenchmarkId::new("auto", views), &o, |b, o| {
            b.iter(|| calibrate_observations(o, &config).expect("a rig"));
        });
    }
    group.finish();
}

criterion_group!(benches, calibrate);
criterion_main!(benches);
