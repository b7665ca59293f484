//! Threads change no bit of a result (the feature `rayon`, which the tests of the workspace have; without it both runs are on one thread).

use std::path::Path;

use image::{DynamicImage, GrayImage, Luma};
use nalgebra::{DMatrix, Point2};
use slcal_core::decode::{DecodeConfig, SequenceDecodeConfig, SequenceDecoder, decode};
use slcal_core::format::read_rig;
use slcal_core::pattern::{SequenceAxes, SequenceConfig, SequencePattern, StripeConfig, StripePattern};
use slcal_core::photo::PhotoView;
use slcal_core::reconstruct::{TriangulateConfig, triangulate};
use slcal_core::{Covariance, Match, Matches, Rig};

/// The rig of the demonstration, with a bent lens and some covariance.
fn rig() -> Rig {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../slcal-cli/demo/truth_rig.json");
    let mut rig = read_rig(&std::fs::read(path).unwrap()[..]).unwrap();
    rig.camera.model.distortion.k1 = -0.1;
    rig.covariance = Some(Covariance {
        parameters: ["camera.focal_px", "projector.cy_px", "projector_from_camera.tx_mm"]
            .map(slcal_core::Parameter::from)
            .to_vec(),
        matrix: DMatrix::identity(3, 3),
    });
    rig
}

#[test]
fn points_are_the_same_on_any_number_of_threads() {
    let rig = rig();
    let items = (0..60_000_u32).map(|i| {
        let (line, slit) = (i / 60, (i % 60) as u16);
        let u = 100.0 + 17.0 * f64::from(slit) + 3.0 * (0.01 * f64::from(line) + f64::from(slit)).sin();
        Match {
            // Some are refused, so that parts give different numbers of points.
            camera: Point2::new(if i % 17 == 0 { f64::NAN } else { u }, f64::from(line)),
            projector_column: Some(8.0 + 16.0 * f64::from(slit)),
            projector_row: None,
            slit: Some(slit),
            confidence: 1.0,
            sigma_px: 0.05,
            color: [0; 3],
        }
    });
    let matches = Matches { items: items.collect() };
    let config = TriangulateConfig { panel_margin: 5.0, ..TriangulateConfig::default() };
    let one = triangulate(&rig, &matches, &config).unwrap();
    let many = triangulate(&rig, &matches, &TriangulateConfig { parallel: true, ..config }).unwrap();
    assert!(one.0.points.len() > 10_000 && one.1.rig_sigma_known, "{:?}", one.1);
    assert_eq!(one.1, many.1);
    for (p, q) in one.0.points.iter().zip(&many.0.points) {
        let bits = |p: &slcal_core::CloudPoint| {
            [p.position.x, p.position.y, p.position.z, p.sigma_mm, p.noise_mm].map(f64::to_bits)
        };
        assert_eq!(bits(p), bits(q));
    }
    assert_eq!(one, many);
}

#[test]
fn stripes_are_the_same_on_any_number_of_threads() {
    let stripes = StripePattern::new([1024, 768], &StripeConfig::default()).unwrap();
    let picture =
        image::open(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/sphere.jpg")).unwrap();
    let photo = PhotoView::try_from(&picture).unwrap();
    let one = decode(photo, &stripes, &DecodeConfig::default()).unwrap();
    let many = decode(photo, &stripes, &DecodeConfig { parallel: true, ..DecodeConfig::default() }).unwrap();
    assert!(one.matches.items.len() > 10_000);
    assert_eq!(one, many);
}

#[test]
fn sequences_are_the_same_on_any_number_of_threads() {
    let config = SequenceConfig { axes: SequenceAxes::Both, ..SequenceConfig::default() };
    let pattern = SequencePattern::new([640, 480], &config).unwrap();
    // A camera that sees nearly all of the panel, three of its pixels for two.
    let frames: Vec<DynamicImage> = (0..pattern.frames.len())
        .map(|i| {
            let picture = pattern.image(i).unwrap();
            let seen =
                |x: u32, y: u32| Luma([picture.get_pixel(20 + 2 * x / 3, 5 + 2 * y / 3).0[0] / 2 + 20]);
            DynamicImage::ImageLuma8(GrayImage::from_fn(900, 700, seen))
        })
        .collect();
    let views: Vec<PhotoView<'_>> = frames.iter().map(|f| PhotoView::try_from(f).unwrap()).collect();
    let decoded = |parallel: bool| {
        let mut config = SequenceDecodeConfig::default();
        config.parallel = parallel;
        SequenceDecoder::new(&pattern, config).unwrap().decode(&views).unwrap()
    };
    let (one, many) = (decoded(false), decoded(true));
    assert_eq!(one.report, many.report);
    assert!(one.report.decoded > 600_000, "{:?}", one.report);
    let bits = |plane: &[f32]| plane.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    for (a, b) in [
        (&one.matches.column, &many.matches.column),
        (&one.matches.sigma_column, &many.matches.sigma_column),
        (&one.matches.row, &many.matches.row),
        (&one.matches.sigma_row, &many.matches.sigma_row),
        (&one.matches.confidence, &many.matches.confidence),
    ] {
        assert!(a.len() == 900 * 700 && bits(a) == bits(b));
    }
}
