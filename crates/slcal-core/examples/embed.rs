//! A capture program that reconstructs its camera's frames: borrowed rows of BGR from the driver's own memory, one scanner
//! for all frames, buffers that stay from frame to frame.
//!
//! ```sh
//! slcal demo --out demo
//! cargo run --release -p slcal-core --example embed -- demo/rig.json demo/stripes.json demo/board.jpg demo/head.jpg
//! ```
//!
//! The photographs stand in for the camera. Needs nothing but the library, and `image` to open them.

use std::fs;
use std::process::ExitCode;
use std::time::Instant;

use slcal_core::format::{read_pattern, read_rig};
use slcal_core::pattern::Pattern;
use slcal_core::photo::{Layout, PhotoView, Samples};
use slcal_core::{ReconstructConfig, Reconstructor};

/// Drivers align their rows.
const ALIGNMENT: usize = 256;
/// How often the camera shows its photographs.
const ROUNDS: usize = 5;

/// A frame as a driver hands it out: BGR, rows padded.
struct DriverFrame {
    memory: Vec<u8>,
    width: usize,
    height: usize,
    stride: usize,
}

impl DriverFrame {
    fn open(path: &str) -> Result<Self, Box<dyn std::error::Error>> {
        let picture = image::open(path)?.to_rgb8();
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let stride = (3 * width).next_multiple_of(ALIGNMENT);
        let mut memory = vec![0; stride * height];
        for (to, from) in memory.chunks_exact_mut(stride).zip(picture.as_raw().chunks_exact(3 * width)) {
            for (bgr, rgb) in to.chunks_exact_mut(3).zip(from.chunks_exact(3)) {
                bgr.copy_from_slice(&[rgb[2], rgb[1], rgb[0]]);
            }
        }
        Ok(Self { memory, width, height, stride })
    }

    /// The pixels where they are; nothing is copied.
    fn view(&self) -> slcal_core::Result<PhotoView<'_>> {
        PhotoView::new(Samples::U8(&self.memory), self.width, self.height, self.stride, Layout::Bgr)
    }
}

fn run(rig: &str, pattern: &str, photographs: &[String]) -> Result<(), Box<dyn std::error::Error>> {
    let rig = read_rig(&fs::read(rig)?[..])?;
    let Pattern::Stripes(stripes) = read_pattern(&fs::read(pattern)?[..])? else {
        return Err("expected a pattern of stripes".into());
    };
    let frames = photographs.iter().map(|p| DriverFrame::open(p)).collect::<Result<Vec<_>, _>>()?;

    let mut scanner = Reconstructor::new(&rig, &stripes, ReconstructConfig::default())?;
    for (number, frame) in (0..ROUNDS).flat_map(|_| &frames).enumerate() {
        let start = Instant::now();
        // A frame without stripes is no reason to stop.
        match scanner.reconstruct(frame.view()?) {
            // The cloud is the scanner's, until the next frame.
            Ok(result) => println!(
                "frame {number}: {} points, σ {:.3} mm ({:.3} mm of it noise), {:.1} ms",
                result.cloud.points.len(),
                result.median_sigma_mm(),
                result.median_noise_mm(),
                1e3 * start.elapsed().as_secs_f64()
            ),
            Err(error) => println!("frame {number}: {error}"),
        }
    }
    Ok(())
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [rig, pattern, photographs @ ..] = arguments.as_slice() else {
        eprintln!("usage: embed RIG.json STRIPES.json PHOTO...");
        return ExitCode::from(2);
    };
    match run(rig, pattern, photographs) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("embed: {error}");
            ExitCode::FAILURE
        }
    }
}
