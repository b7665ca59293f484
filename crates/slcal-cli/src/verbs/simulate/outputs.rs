//! The files and the summary of `slcal simulate scene`.

use std::path::Path;

use image::{DynamicImage, GrayImage};
use serde::Serialize;
use slcal_core::format::{write_matches, write_pattern, write_pfm, write_ply, write_rig};
use slcal_core::pattern::{Pattern, SequencePattern};
use slcal_core::simulate::{Exposure, SceneReport, SimulatedScene};

use crate::exit::{Exit, Failure, Outcome};
use crate::io::{bytes_of, png_bytes};
use crate::output::{TextLayout, sanitized, unbroken};

/// A file of the folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SceneFile {
    /// The photograph under one picture of a sequence.
    Frame(usize),
    Photo,
    White,
    Black,
    Picture,
    Pattern,
    Rig,
    Matches,
    Cloud,
    Column,
    Row,
    Depth,
    Surface,
}

impl SceneFile {
    /// Those of a pattern, in the order in which they are told. A sequence has a photograph for each of its pictures. The exact matches
    /// of slits or corners have no counterpart there: the maps are the truth of every pixel.
    pub(super) fn all(pattern: &Pattern) -> Vec<Self> {
        let truth = [Self::Column, Self::Row, Self::Depth, Self::Surface];
        let before = match pattern {
            Pattern::Sequence(sequence) => {
                let frames = (0..sequence.frames.len()).map(Self::Frame);
                frames.chain([Self::Pattern, Self::Rig]).collect()
            }
            Pattern::Checker(_) | Pattern::Stripes(_) => vec![
                Self::Photo,
                Self::White,
                Self::Black,
                Self::Picture,
                Self::Pattern,
                Self::Rig,
                Self::Matches,
                Self::Cloud,
            ],
        };
        [before, truth.to_vec()].concat()
    }

    /// Its name; `jpeg`: the camera writes JPEG.
    pub(super) fn name(self, pattern: &Pattern, jpeg: bool) -> String {
        match self {
            Self::Frame(i) => photograph_name(&format!("frame_{i:03}"), jpeg),
            Self::Photo => photograph_name("photo", jpeg),
            Self::White => photograph_name("white", jpeg),
            Self::Black => photograph_name("black", jpeg),
            Self::Picture => "pattern.png".into(),
            Self::Pattern if matches!(pattern, Pattern::Sequence(_)) => "sequence.json".into(),
            Self::Pattern => "pattern.json".into(),
            Self::Rig => "rig.json".into(),
            Self::Matches => "truth_matches.csv".into(),
            Self::Cloud => "truth_cloud.ply".into(),
            Self::Column => "truth_column.pfm".into(),
            Self::Row => "truth_row.pfm".into(),
            Self::Depth => "truth_depth.pfm".into(),
            Self::Surface => "truth_surface.png".into(),
        }
    }

    /// Its content. A photograph of a sequence is taken for it.
    pub(super) fn content(self, scene: &SimulatedScene) -> Outcome<Vec<u8>> {
        let truth = scene.photographer.truth();
        let map = |values: Vec<f32>| bytes_of(|out| write_pfm(truth.width(), &values, out));
        let photograph = |picture: &DynamicImage, which: usize| match &scene.jpeg_files {
            Some(files) => Ok(files[which].clone()),
            None => png_bytes(picture),
        };
        match self {
            Self::Frame(i) => match scene.frame(i)? {
                Exposure { file: Some(file), .. } => Ok(file),
                Exposure { picture, .. } => png_bytes(&picture),
            },
            Self::Photo => photograph(&scene.photo, 0),
            Self::White => photograph(&scene.white, 1),
            Self::Black => photograph(&scene.black, 2),
            Self::Picture => png_bytes(&DynamicImage::ImageRgb8(scene.picture.clone())),
            Self::Pattern => match &scene.pattern {
                Pattern::Sequence(sequence) => {
                    let photographed = photographed(sequence, scene.jpeg_files.is_some());
                    bytes_of(|out| write_pattern(&Pattern::Sequence(photographed), out))
                }
                other => bytes_of(|out| write_pattern(other, out)),
            },
            Self::Rig => bytes_of(|out| write_rig(&scene.rig, out)),
            Self::Matches => bytes_of(|out| write_matches(&scene.matches, out)),
            Self::Cloud => bytes_of(|out| write_ply(&scene.cloud(), out)),
            Self::Column => map(scene.columns()),
            Self::Row => map(scene.rows()),
            Self::Depth => map(scene.depths()),
            Self::Surface => {
                let (width, height) = (truth.width() as u32, truth.height() as u32);
                let surfaces = GrayImage::from_raw(width, height, scene.surfaces())
                    .ok_or_else(|| Failure::new(Exit::Other, "the map and the photograph differ in size"))?;
                png_bytes(&DynamicImage::ImageLuma8(surfaces))
            }
        }
    }
}

fn photograph_name(stem: &str, jpeg: bool) -> String {
    format!("{stem}.{}", if jpeg { "jpg" } else { "png" })
}

/// The sequence with the names of its photographs.
fn photographed(sequence: &SequencePattern, jpeg: bool) -> SequencePattern {
    let mut sequence = sequence.clone();
    for (i, frame) in sequence.frames.iter_mut().enumerate() {
        frame.file = Some(photograph_name(&format!("frame_{i:03}"), jpeg));
    }
    sequence
}

/// The report, as JSON.
#[derive(Serialize)]
pub(super) struct SceneOutputs {
    #[serde(flatten)]
    scene: SceneReport,
    files: Vec<String>,
    /// How many of the files are photographs of a sequence.
    #[serde(skip)]
    frames: usize,
}

impl SceneOutputs {
    pub(super) fn of(scene: &SimulatedScene) -> Self {
        let name = |file: SceneFile| file.name(&scene.pattern, scene.jpeg_files.is_some());
        Self {
            scene: scene.report.clone(),
            files: SceneFile::all(&scene.pattern).into_iter().map(name).collect(),
            frames: scene.frame_count(),
        }
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
        let (frames, others) = self.files.split_at(self.frames);
        match frames {
            [first, .., last] => {
                layout.line("sequence", format!("{} photographs, {first} to {last}", frames.len()));
            }
            _ => layout.line("matches", format!("{} exact matches in truth_matches.csv", scene.matches)),
        }
        layout.line("files", format!("in {}:", unbroken(&sanitized(&folder.display().to_string()))));
        layout.line("", others.join(", "));
        layout.into_text()
    }
}
