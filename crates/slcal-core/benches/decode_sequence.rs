//! Time of decoding a sequence of frames in memory and of triangulating it with σ, on one thread, beside the sum of the same frames: the
//! least that reading them costs. Run with `cargo bench -p slcal-core --features simulate --bench decode_sequence`.

mod scene;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use image::DynamicImage;
use slcal_core::decode::{SequenceDecodeConfig, SequenceDecoder};
use slcal_core::pattern::{SequenceConfig, SequencePattern, SequencePreset, SinusoidConfig};
use slcal_core::photo::PhotoView;
use slcal_core::reconstruct::{DenseTriangulator, TriangulateConfig};
use slcal_core::simulate::ProjectedImage;
use slcal_core::{PointCloud, ReconstructConfig, Rig, SequenceReconstructor};

use self::scene::ball_before_wall;

/// As a grey camera sees every frame of a sequence.
fn frames(
    camera: [u32; 2],
    pattern: impl Fn([u32; 2]) -> SequencePattern,
) -> (Rig, SequencePattern, Vec<DynamicImage>) {
    let (rig, projector, photographer) = ball_before_wall(camera);
    let pattern = pattern(projector);
    let frames = (0..pattern.frames.len())
        .map(|i| {
            let picture = DynamicImage::ImageLuma8(pattern.image(i).expect("a frame")).to_rgb8();
            let photo =
                photographer.photograph(ProjectedImage::Picture(&picture), i as u64).expect("a photograph");
            DynamicImage::ImageLuma8(photo.to_luma8())
        })
        .collect();
    (rig, pattern, frames)
}

/// The yardstick: all frames into one image of 16 bit.
fn sum(frames: &[&[u8]], sums: &mut [u16]) {
    sums.fill(0);
    for frame in frames {
        for (sum, v) in sums.iter_mut().zip(*frame) {
            *sum += u16::from(*v);
        }
    }
}

fn sequences(c: &mut Criterion) {
    let mut group = c.benchmark_group("sequence");
    group.sample_size(20);
    let camera = [1280, 1024];
    let gray = |panel| SequencePattern::preset(panel, SequencePreset::OpencvGray, None).expect("a pattern");
    let config = SequenceConfig { sinusoid: Some(SinusoidConfig::default()), ..SequenceConfig::default() };
    let phase = |panel| SequencePattern::new(panel, &config).expect("a pattern");
    for (kind, (rig, pattern, pictures)) in
        [("Gray code", frames(camera, gray)), ("phase", frames(camera, phase))]
    {
        let n = pictures.len();
        group.throughput(Throughput::Elements(u64::from(camera[0]) * u64::from(camera[1])));
        let samples: Vec<&[u8]> = pictures.iter().map(DynamicImage::as_bytes).collect();
        let mut sums = vec![0; samples[0].len()];
        group.bench_function(format!("{kind}, {n} frames/sum"), |b| b.iter(|| sum(&samples, &mut sums)));
        let views: Vec<PhotoView<'_>> = pictures.iter().map(|p| p.try_into().expect("8 bit")).collect();
        let mut decoder = SequenceDecoder::new(&pattern, SequenceDecodeConfig::default()).expect("a pattern");
        group.bench_function(format!("{kind}, {n} frames/decode"), |b| {
            b.iter(|| decoder.decode(&views).expect("frames").matches.confidence.len());
        });
        let mut triangulator = DenseTriangulator::new(&rig, TriangulateConfig::default()).expect("a rig");
        let mut cloud = PointCloud::default();
        group.bench_function(format!("{kind}, {n} frames/decode, triangulate, σ"), |b| {
            b.iter(|| {
                let decoding = decoder.decode(&views).expect("frames");
                triangulator.triangulate(&decoding.matches, &mut cloud).points
            });
        });
        let mut scanner =
            SequenceReconstructor::new(&rig, &pattern, ReconstructConfig::default()).expect("a rig");
        group.bench_function(format!("{kind}, {n} frames/frames to mesh with normals"), |b| {
            b.iter(|| scanner.reconstruct(&views).expect("a surface").cloud.points.len());
        });
    }
    group.finish();
}

criterion_group!(benches, sequences);
criterion_main!(benches);
