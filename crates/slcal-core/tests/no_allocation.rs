//! After the first frames nothing is allocated.

use nalgebra::{Point2, Point3};
use slcal_core::reconstruct::{CullRule, Culler};
use slcal_core::{CloudPoint, PointCloud};

/// How often memory is asked for in the meantime.
fn allocations(work: impl FnOnce()) -> u64 {
    allocation_counter::measure(work).count_total
}

#[test]
fn spade() {
    let frame = |k: f64| {
        let mut cloud = PointCloud::default();
        for v in 0..500 {
            for s in 0..60 {
                let (v, s) = (f64::from(v), f64::from(s));
                let u = 40.0
                    + 16.0 * s
                    + 3.0 * (v / 90.0 + s * 0.3 + k).sin()
                    + 0.05 * (v * 7.7 + s * 13.3).sin();
                let z = 1000.0 + 30.0 * (u / 150.0).sin() + if u > 500.0 { 200.0 } else { 0.0 };
                cloud.points.push(CloudPoint {
                    position: Point3::new((u - 500.0) * z / 1500.0, (v - 250.0) * z / 1500.0, z),
                    pixel: Point2::new(u, v),
                    color: [0; 3],
                    sigma_mm: 0.1,
                    noise_mm: 0.1,
                    slit: 0,
                    confidence: 1.0,
                });
            }
        }
        cloud
    };
    let mut culler = Culler::default();
    let mut all: Vec<PointCloud> = (0..8).map(|k| frame(f64::from(k))).collect();
    for (i, cloud) in all.iter_mut().enumerate() {
        cloud.triangles.reserve(100_000);
        let t = std::time::Instant::now();
        let mut report = None;
        let n = allocations(|| report = Some(culler.cull(cloud, CullRule::Auto)));
        println!("{i} {n} {:?} {report:?}", t.elapsed());
    }
}
