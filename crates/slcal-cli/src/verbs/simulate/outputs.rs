//! The files and the summary of `slcal simulate scene`.

use std::path::Path;

use image::{DynamicImage, GrayImage};
use serde::Serialize;
use slcal_core::format::{write_matches, write_pattern, write_pfm, write_ply, write_rig};
use slcal_core::simulate::{SceneReport, SimulatedScene};

use crate::exit::{Exit, Failure, Outcome};
use crate::io::{bytes_of, png_bytes};
use crate::output::{TextLayout, sanitized, unbroken};

/// The files, in the order of [`contents`]; `jpeg`: the camera writes JPEG.
pub(super) fn names(jpeg: bool) -> [&'static str; 12] {
    let [photo, white, black] =
        if jpeg { ["photo.jpg", "white.jpg", "black.jpg"] } else { ["photo.png", "white.png", "black.png"] };
    [
        photo,
        white,
        black,
        "pattern.png",
        "pattern.json",
        "rig.json",
        "truth_matches.csv",
        "truth_cloud.ply",
        "truth_column.pfm",
        "truth_row.pfm",
        "truth_depth.pfm",
        "truth_surface.png",
    ]
}

/// The files' contents.
pub(super) fn contents(scene: &SimulatedScene) -> Outcome<Vec<Vec<u8>>> {
    let truth = scene.photographer.truth();
    let map = |values: Vec<f32>| bytes_of(|out| write_pfm(truth.width(), &values, out));
    let surfaces = GrayImage::from_raw(truth.width() as u32, truth.height() as u32, scene.surfaces())
        .ok_or_else(|| Failure::new(Exit::Other, "the map and the photograph differ in size"))?;
    let [photo, white, black] = match &scene.jpeg_files {
        Some(files) => files.clone(),
        None => [png_bytes(&scene.photo)?, png_bytes(&scene.white)?, png_bytes(&scene.black)?],
    };
    Ok(vec![
        photo,
        white,
        black,
        png_bytes(&DynamicImage::ImageRgb8(scene.picture.clone()))?,
        bytes_of(|out| write_pattern(&scene.pattern, out))?,
        bytes_of(|out| write_rig(&scene.rig, out))?,
        bytes_of(|out| write_matches(&scene.matches, out))?,
        bytes_of(|out| write_ply(&scene.cloud(), out))?,
        map(scene.columns())?,
        map(scene.rows())?,
        map(scene.depths())?,
        png_bytes(&DynamicImage::ImageLuma8(surfaces))?,
    ])
}

/// The report, as JSON.
#[derive(Serialize)]
pub(super) struct SceneOutputs {
    #[serde(flatten)]
    scene: SceneReport,
    files: [&'static str; 12],
}

impl SceneOutputs {
    pub(super) fn of(scene: &SimulatedScene) -> Self {
        Self { scene: scene.report.clone(), files: names(scene.jpeg_files.is_some()) }
    }

    pub(super) fn in_words(&self, folder: &Path) -> String {
        let scene = &self.scene;
        let [w, h] = scene.camera;
        let percent = |n: usize| 100.0 * n as f64 / (f64::from(w) * f64::from(h));
        let mut layout = TextLayout::new();
        layout.line(
            "photograph",
            format!(
                "{w} x {h} px; {:.1} % show a surface, {:.1} % are lit by the projector",
                percent(scene.seen_pixels),
                percent(scene.lit_pixels)
            ),
        );
        if let Some([near, far]) = scene.depth_mm {
            layout.line("depth", format!("{near:.1} to {far:.1} mm"));
        }
        let board = scene.thickness_mm.map(|mm| format!("a board, {mm} mm thick"));
        let bend = scene.bend.map(|b| format!("bent: {b}"));
        if board.is_some() || bend.is_some() {
            layout.line("sheet", [board, bend].into_iter().flatten().collect::<Vec<_>>().join("; "));
        }
        layout.line("matches", format!("{} exact matches in truth_matches.csv", scene.matches));
        layout.line("files", format!("in {}:", unbroken(&sanitized(&folder.display().to_string()))));
        layout.line("", self.files.join(", "));
        layout.into_text()
    }
}
