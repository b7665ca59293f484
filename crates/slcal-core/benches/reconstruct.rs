//! Time of the stages between matches and cloud, for 40,000 points on one thread. Run with
//! `cargo bench -p slcal-core --features simulate --bench reconstruct`.

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::{DMatrix, Point2, Point3};
use slcal_core::geometry::Distortion;
use slcal_core::reconstruct::{CullRule, Culler, TriangulateConfig, Triangulator};
use slcal_core::simulate::{RigConfig, Scene};
use slcal_core::{Covariance, Match, Matches, Parameter, PointCloud, Projector, Rig};

/// The default simulated rig with these lenses and a covariance.
fn rig(camera: Distortion, projector: Distortion) -> Rig {
    let mut rig = Scene::new(&RigConfig::default(), &[]).expect("a scene").rig();
    rig.camera.model.distortion = camera;
    rig.projector.as_mut().expect("a projector").device.model.distortion = projector;
    let lens = ["focal_px", "cx_px", "cy_px"];
    let pose = ["rx_rad", "ry_rad", "rz_rad", "tx_mm", "ty_mm", "tz_mm"];
    let of = |device: &str, names: &[&str]| {
        names.iter().map(|n| format!("{device}.{n}").as_str().into()).collect::<Vec<Parameter>>()
    };
    let parameters =
        [of("camera", &lens), of("projector", &lens), of("projector_from_camera", &pose)].concat();
    rig.covariance = Some(Covariance { parameters, matrix: DMatrix::identity(12, 12) * 1e-4 });
    rig
}

/// 625 lines across 64 stripes on a surface a metre away, slanted and bent; every slit at its own column.
fn matches(rig: &Rig) -> Matches {
    let Projector { device, from_camera, .. } = rig.projector.expect("a projector");
    let column = |pixel: Point2<f64>| {
        let bearing = rig.camera.model.bearing(pixel).expect("within the lens");
        let depth = 1000.0 + 60.0 * (pixel.x / 200.0).sin() + 0.05 * pixel.y;
        let point = from_camera.pose.transform(&Point3::from(bearing * depth));
        device.model.project(&point).expect("in front").x
    };
    let mut items = Vec::new();
    for line in 0..625 {
        let v = 150.0 + f64::from(line);
        let first = column(Point2::new(150.0, 460.0));
        let mut u = 150.0;
        for slit in 0..64 {
            let wanted = first + 13.0 * f64::from(slit);
            for _ in 0..8 {
                let here = column(Point2::new(u, v));
                u -= (here - wanted) / (column(Point2::new(u + 0.5, v)) - column(Point2::new(u - 0.5, v)));
            }
            items.push(Match {
                camera: Point2::new(u, v),
                projector_column: Some(wanted),
                projector_row: None,
                slit: Some(slit as u16),
                confidence: 1.0,
                sigma_px: 0.05,
                color: [128; 3],
            });
        }
    }
    Matches { items }
}

fn reconstruct(c: &mut Criterion) {
    let mut group = c.benchmark_group("reconstruct");
    let bent = Distortion { k1: -0.12, k2: 0.03, ..Distortion::NONE };
    // The panel's margin is wide: what is timed is triangulation, not refusal.
    let config = TriangulateConfig { panel_margin: 5.0, ..TriangulateConfig::default() };
    let lenses =
        [("plain", [Distortion::NONE; 2]), ("camera", [bent, Distortion::NONE]), ("both", [bent; 2])];
    for (name, [camera, projector]) in lenses {
        let rig = rig(camera, projector);
        let matches = matches(&rig);
        group.throughput(Throughput::Elements(matches.items.len() as u64));
        for known in [true, false] {
            let mut rig = rig.clone();
            rig.covariance = rig.covariance.filter(|_| known);
            let mut triangulator = Triangulator::new(&rig, config).expect("a rig");
            let mut cloud = PointCloud::default();
            let share = if known { "with the rig's share" } else { "noise alone" };
            group.bench_function(format!("triangulate/{name}, {share}"), |b| {
                b.iter(|| triangulator.triangulate(&matches, &mut cloud));
            });
        }
    }
    let rig = rig(Distortion::NONE, Distortion::NONE);
    let mut cloud = PointCloud::default();
    Triangulator::new(&rig, config).expect("a rig").triangulate(&matches(&rig), &mut cloud);
    let mut culler = Culler::default();
    group.bench_function("cull", |b| {
        b.iter_batched_ref(
            || cloud.clone(),
            |cloud| culler.cull(cloud, CullRule::Auto).expect("a surface"),
            BatchSize::LargeInput,
        );
    });
    group.finish();
}

criterion_group!(benches, reconstruct);
criterion_main!(benches);
