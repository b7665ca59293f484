//! Times decoding and triangulation of frames in memory, on one thread, on request: `benches/compare_blur.py` lets another
//! program's work and this take turns.
//!
//! ```text
//! cargo run --release --example time_frame -- rig.json stripes.json photo.png
//! ```
//!
//! reads lines from stdin, `matches`, `points` or `cloud`, does that much with the photograph, and answers each with
//! the milliseconds it took and how many points there are: matches alone, points triangulated from them, or the
//! cloud without its outliers.

use std::error::Error;
use std::fs::File;
use std::io::{BufReader, Write, stdin, stdout};
use std::time::Instant;

use slcal_core::decode::{DecodeConfig, Decoder};
use slcal_core::format::{read_pattern, read_rig};
use slcal_core::pattern::Pattern;
use slcal_core::photo::{Layout, PhotoView, Samples};
use slcal_core::reconstruct::{TriangulateConfig, Triangulator};
use slcal_core::{PointCloud, ReconstructConfig, Reconstructor};

/// What stays from frame to frame.
struct Scanner {
    decoder: Decoder,
    triangulator: Triangulator,
    cloud: PointCloud,
    reconstructor: Reconstructor,
}

impl Scanner {
    /// How many points one frame gives.
    fn frame(&mut self, work: &str, photo: PhotoView<'_>) -> Result<usize, Box<dyn Error>> {
        if work == "cloud" {
            return Ok(self.reconstructor.reconstruct(photo)?.cloud.points.len());
        }
        let decoding = self.decoder.decode(photo)?;
        match work {
            "matches" => Ok(decoding.matches.items.len()),
            "points" => {
                self.triangulator.triangulate(&decoding.matches, &mut self.cloud);
                Ok(self.cloud.points.len())
            }
            other => Err(format!("{other}: say matches, points or cloud").into()),
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [rig, pattern, photo] = arguments.as_slice() else {
        return Err("usage: time_frame rig.json stripes.json photo.png".into());
    };
    let rig = read_rig(BufReader::new(File::open(rig)?))?;
    let Pattern::Stripes(pattern) = read_pattern(BufReader::new(File::open(pattern)?))? else {
        return Err(format!("{pattern}: not a pattern of stripes").into());
    };
    let image = image::open(photo)?.into_rgb8();
    let (width, height) = (image.width() as usize, image.height() as usize);
    let view = PhotoView::new(Samples::U8(image.as_raw()), width, height, 3 * width, Layout::Rgb)?;
    let mut scanner = Scanner {
        decoder: Decoder::new(&pattern, DecodeConfig::default())?,
        triangulator: Triangulator::new(&rig, TriangulateConfig::default())?,
        cloud: PointCloud::default(),
        reconstructor: Reconstructor::new(&rig, &pattern, ReconstructConfig::default())?,
    };
    for line in stdin().lines() {
        let start = Instant::now();
        let points = scanner.frame(line?.trim(), view)?;
        let milliseconds = start.elapsed().as_secs_f64() * 1e3;
        println!("{milliseconds:.4} {points}");
        stdout().flush()?;
    }
    Ok(())
}
