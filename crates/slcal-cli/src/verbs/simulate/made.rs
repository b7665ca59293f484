//! What `slcal simulate scene` leaves in its folder, and what it says of it.

use std::fmt::Write as _;
use std::path::Path;

use image::{DynamicImage, GrayImage, Luma, RgbImage};
use serde::Serialize;
use slcal_core::format::report_json::SceneReport;
use slcal_core::format::{write_matches, write_pfm};
use slcal_core::pattern::Pattern;
use slcal_core::simulate::{Photographer, Seen};
use slcal_core::{CloudPoint, Matches, PointCloud, Rig};

use super::super::calibrate::rig_bytes;
use super::super::pattern::pattern_bytes;
use crate::exit::Outcome;
use crate::io::{CloudFormat, png_bytes};

/// The files, in the order of [`contents`].
pub(super) const NAMES: [&str; 12] = [
    "photo.png",
    "white.png",
    "black.png",
    "pattern.png",
    "pattern.json",
    "rig.json",
    "truth_matches.csv",
    "truth_cloud.ply",
    "truth_column.pfm",
    "truth_row.pfm",
    "truth_depth.pfm",
    "truth_surface.png",
];
/// The files' contents.
pub(super) fn contents(
    photos: &[DynamicImage; 3],
    picture: RgbImage,
    pattern: &Pattern,
    rig: &Rig,
    matches: &Matches,
    photographer: &Photographer,
) -> Outcome<Vec<Vec<u8>>> {
    let truth = photographer.truth();
    let map = |value: &dyn Fn(Seen) -> Option<f64>| -> Outcome<Vec<u8>> {
        let values: Vec<f32> =
            truth.pixels().map(|s| s.and_then(value).map_or(f32::NAN, |v| v as f32)).collect();
        let mut bytes = Vec::new();
        write_pfm(truth.width(), &values, &mut bytes)?;
        Ok(bytes)
    };
    let surfaces = GrayImage::from_fn(truth.width() as u32, truth.height() as u32, |x, y| {
        Luma([truth.at(x as usize, y as usize).map_or(0, |s| (s.surface + 1).min(255) as u8)])
    });
    let mut table = Vec::new();
    write_matches(matches, &mut table)?;
    let cloud = CloudFormat::Ply.bytes(&cloud(matches, &photos[1], photographer))?;
    let mut files = photos.iter().map(png_bytes).collect::<Outcome<Vec<_>>>()?;
    files.extend([
        png_bytes(&DynamicImage::ImageRgb8(picture))?,
        pattern_bytes(pattern)?,
        rig_bytes(rig)?,
        table,
        cloud,
        map(&|s| s.panel.map(|q| q.x))?,
        map(&|s| s.panel.map(|q| q.y))?,
        map(&|s| Some(s.point.z))?,
        png_bytes(&DynamicImage::ImageLuma8(surfaces))?,
    ]);
    Ok(files)
}

/// The points that the matches see, in the colours of the white photograph.
fn cloud(matches: &Matches, white: &DynamicImage, photographer: &Photographer) -> PointCloud {
    let white = white.to_rgb8();
    let points = matches.items.iter().filter_map(|m| {
        let seen = photographer.look(m.camera)?;
        let [x, y] = [(m.camera.x, white.width()), (m.camera.y, white.height())]
            .map(|(v, n)| v.round().clamp(0.0, f64::from(n - 1)) as u32);
        Some(CloudPoint {
            position: seen.point,
            pixel: m.camera,
            color: white.get_pixel(x, y).0,
            sigma_mm: 0.0,
            noise_mm: 0.0,
            slit: m.slit.unwrap_or(0),
            confidence: 1.0,
        })
    });
    PointCloud { points: points.collect(), ..PointCloud::default() }
}

/// What was made, as JSON.
#[derive(Serialize)]
pub(super) struct Made {
    #[serde(flatten)]
    scene: SceneReport,
    files: [&'static str; 12],
}

impl Made {
    pub(super) fn of(scene: SceneReport) -> Self {
        Self { scene, files: NAMES }
    }

    pub(super) fn in_words(&self, folder: &Path) -> String {
        let scene = &self.scene;
        let [w, h] = scene.camera;
        let percent = |n: usize| 100.0 * n as f64 / (f64::from(w) * f64::from(h));
        let mut text = format!(
            "photograph  {w} x {h} px; {:.1} % see a surface, {:.1} % in the projector's light\n",
            percent(scene.seen_pixels),
            percent(scene.lit_pixels)
        );
        // Writing into a string cannot fail.
        if let Some([near, far]) = scene.depth_mm {
            let _ = writeln!(text, "depth       {near:.1} to {far:.1} mm");
        }
        let _ = writeln!(text, "matches     {} without error in truth_matches.csv", scene.matches);
        let _ = write!(text, "files       {}: {}", folder.display(), self.files.join(", "));
        text
    }
}
