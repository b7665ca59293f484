//! Time of decoding a frame in memory, and of all the way to its cloud, on one thread, in buffers that are used again. Run with
//! `cargo bench -p slcal-core --features simulate --bench decode`.

mod scene;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use image::DynamicImage;
use slcal_core::decode::{DecodeConfig, DecodeInput, Decoder, decode};
use slcal_core::pattern::{StripeConfig, StripePattern};
use slcal_core::photo::PhotoView;
use slcal_core::reconstruct::{TriangulateConfig, Triangulator};
use slcal_core::simulate::ProjectedImage;
use slcal_core::{PointCloud, ReconstructConfig, Reconstructor, Rig};

use self::scene::ball_before_wall;

/// Photographs with stripes, black and white.
fn photographs(camera: [u32; 2]) -> (Rig, StripePattern, [DynamicImage; 3]) {
    let (rig, projector, photographer) = ball_before_wall(camera);
    let stripes = StripePattern::new(projector, &StripeConfig::default()).expect("a pattern");
    let picture = stripes.image().expect("a picture");
    let mut frame = 0;
    let photos =
        [ProjectedImage::Picture(&picture), ProjectedImage::Black, ProjectedImage::White].map(|shown| {
            frame += 1;
            photographer.photograph(shown, frame).expect("a photograph")
        });
    (rig, stripes, photos)
}

fn decoding(c: &mut Criterion) {
    let mut group = c.benchmark_group("decode");
    group.sample_size(20);
    for [width, height] in [[1280, 960], [2560, 1920]] {
        let (rig, stripes, photos) = photographs([width, height]);
        let [photo, black, white] = photos.each_ref().map(|p| PhotoView::try_from(p).expect("8 bit RGB"));
        let alone = DecodeInput { photo, black: None, white: None };
        let three = DecodeInput { photo, black: Some(black), white: Some(white) };
        group.throughput(Throughput::Elements(u64::from(width) * u64::from(height)));
        for (name, input) in [("one frame", &alone), ("with black and white frames", &three)] {
            let mut decoder = Decoder::new(&stripes, DecodeConfig::default()).expect("a pattern");
            group.bench_function(format!("{width}x{height}/{name}"), |b| {
                b.iter(|| decoder.decode(*input).expect("stripes").matches.items.len());
            });
        }
        group.bench_function(format!("{width}x{height}/one frame, decoder made anew"), |b| {
            b.iter(|| {
                decode(photo, &stripes, &DecodeConfig::default()).expect("stripes").matches.items.len()
            });
        });
        let matches = decode(photo, &stripes, &DecodeConfig::default()).expect("stripes").matches;
        let mut triangulator = Triangulator::new(&rig, TriangulateConfig::default()).expect("a rig");
        let mut cloud = PointCloud::default();
        group.bench_function(format!("{width}x{height}/triangulation after it"), |b| {
            b.iter(|| triangulator.triangulate(&matches, &mut cloud));
        });
        let config = ReconstructConfig { mesh: true, ..ReconstructConfig::default() };
        let mut scanner = Reconstructor::new(&rig, &stripes, config).expect("a rig");
        group.bench_function(format!("{width}x{height}/photograph to mesh"), |b| {
            b.iter(|| scanner.reconstruct(photo).expect("a surface").cloud.points.len());
        });
    }
    group.finish();
}

criterion_group!(benches, decoding);
criterion_main!(benches);
