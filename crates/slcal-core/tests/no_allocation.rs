//! After the first frames of a video nothing is allocated from the photograph to the points, and nothing from the points to
//! the mesh but by `spade`, whose list of edges to flip leaves the stack when there are more than eight: that happens at
//! some points of the border, which is nearly straight, so that some of its points have dozens of neighbours.

use std::path::Path;

use image::RgbImage;
use nalgebra::{Point2, Point3};
use slcal_core::format::read_rig;
use slcal_core::pattern::{StripeConfig, StripePattern};
use slcal_core::photo::{Layout, PhotoView, Samples};
use slcal_core::reconstruct::{CullRule, Culler};
use slcal_core::{CloudPoint, Frame, PointCloud, ReconstructConfig, Reconstructor, Rig};

/// At most one of so many points may need a longer list; measured: one in 2000.
const MOST_ONE_IN: u64 = 1000;

/// One of the photographs of the demonstration.
fn photo(name: &str) -> RgbImage {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../slcal-cli/demo").join(name);
    image::open(path).unwrap().to_rgb8()
}

fn rig() -> Rig {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../slcal-cli/demo/truth_rig.json");
    let mut rig = read_rig(&std::fs::read(path).unwrap()[..]).unwrap();
    // With a share of the rig in every σ.
    rig.covariance = Some(slcal_core::Covariance {
        parameters: ["camera.focal_px", "projector.cy_px", "projector_from_camera.tx_mm"]
            .map(slcal_core::Parameter::from)
            .to_vec(),
        matrix: nalgebra::DMatrix::identity(3, 3),
    });
    rig
}

#[test]
fn a_reconstructor_allocates_nothing_once_it_has_seen_its_frames() {
    let rig = rig();
    let stripes = StripePattern::new([1024, 768], &StripeConfig::default()).unwrap();
    let frames: Vec<RgbImage> = ["board.jpg", "head.jpg"].map(photo).to_vec();
    let whole = ReconstructConfig { mesh: true, ..ReconstructConfig::default() };
    let points_alone = ReconstructConfig { mesh: false, cull: CullRule::Off, ..whole };
    for config in [points_alone, whole, ReconstructConfig { frame: Frame::Plane, ..whole }] {
        let mut scanner = Reconstructor::new(&rig, &stripes, config).unwrap();
        for round in 0..4 {
            for picture in &frames {
                let (width, height) = (picture.width() as usize, picture.height() as usize);
                let samples = Samples::U8(picture.as_raw());
                let view = PhotoView::new(samples, width, height, 3 * width, Layout::Rgb).unwrap();
                let mut points = 0;
                let count = allocation_counter::measure(|| {
                    points = scanner.reconstruct(view).map_or(0, |r| r.cloud.points.len());
                });
                assert!(points > 5000, "{points}");
                println!("round {round}: {} allocations for {points} points", count.count_total);
                let most = if config.mesh { points as u64 / MOST_ONE_IN } else { 0 };
                if round > 1 {
                    assert!(count.count_total <= most);
                    // What is asked for is given back at once.
                    assert_eq!(count.count_current, 0);
                }
            }
        }
    }
}

/// Stripes with holes in them: the points about a hole have many neighbours.
fn stripes_with_holes(seed: u32) -> PointCloud {
    let mut points = Vec::new();
    for line in 0..500_u32 {
        for slit in 0..60_u32 {
            let patch = (line / 20 * 60 + slit).wrapping_add(seed).wrapping_mul(0x9e37_79b9);
            if (patch >> 16).is_multiple_of(8) {
                continue;
            }
            let (v, s) = (f64::from(line), f64::from(slit));
            let (u, z) = (20.0 + 13.0 * s + 5.0 * (0.02 * v + 0.3 * s).sin(), 1000.0 + s);
            points.push(CloudPoint {
                position: Point3::new(u * z / 1500.0, v * z / 1500.0, z),
                pixel: Point2::new(u, v),
                color: [0; 3],
                sigma_mm: 0.1,
                noise_mm: 0.1,
                slit: Some(slit as u16),
                confidence: 1.0,
            });
        }
    }
    PointCloud { points, ..PointCloud::default() }
}

#[test]
fn a_culler_allocates_nothing_for_stripes_with_holes() {
    let mut culler = Culler::default();
    for seed in 0..6 {
        let first = stripes_with_holes(seed);
        // The second time the buffers have their size.
        for warm in [false, true] {
            let mut cloud = first.clone();
            // As those of a reconstructor, whose cloud is filled anew.
            cloud.triangles.reserve(2 * cloud.points.len());
            let count = allocation_counter::measure(|| {
                culler.cull(&mut cloud, CullRule::Auto).unwrap();
            });
            assert!(cloud.points.len() > 20_000);
            assert!(!warm || count.count_total == 0, "{} allocations", count.count_total);
        }
    }
}
