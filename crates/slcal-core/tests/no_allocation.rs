//! After the first frames of a video nothing is allocated, from the photograph to the mesh.

use std::path::Path;

use image::RgbImage;
use slcal_core::format::read_rig;
use slcal_core::pattern::{StripeConfig, StripePattern};
use slcal_core::photo::{Layout, PhotoView, Samples};
use slcal_core::reconstruct::{ReconstructConfig, Reconstructor};
use slcal_core::{Frame, Rig};

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
            .map(String::from)
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
    for frame in [Frame::Camera, Frame::Plane] {
        let config = ReconstructConfig { mesh: true, frame, ..ReconstructConfig::default() };
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
                if round > 1 {
                    assert_eq!(count.count_total, 0);
                }
            }
        }
    }
}
