//! A simulated scene with its ground truth.

use image::{DynamicImage, RgbImage};

use super::photographer::{Photographer, ProjectedImage};
use super::report_json::SceneReport;
use super::sensor::Exposure;
use super::truth::PixelTruth;
use crate::cloud::{CloudPoint, PointCloud};
use crate::error::{Error, ErrorSubject, Result};
use crate::matches::Matches;
use crate::pattern::Pattern;
use crate::rig::Rig;

/// Photographs of a scene, and the ground truth of every pixel.
pub struct SimulatedScene {
    /// The true rig.
    pub rig: Rig,
    /// The projected pattern.
    pub pattern: Pattern,
    /// The same as a picture of the panel's size; of a sequence, the first one.
    pub picture: RgbImage,
    /// The photograph under the pattern, 8 or 16 bit RGB; of a sequence, that under a white projector.
    pub photo: DynamicImage,
    /// That under a white projector.
    pub white: DynamicImage,
    /// That under a dark one.
    pub black: DynamicImage,
    /// The camera's files of these three, where it writes JPEG: the photographs are what is read from them.
    pub jpeg_files: Option<[Vec<u8>; 3]>,
    /// Exact correspondences of slits or corners of the pattern; none of a sequence, whose [`columns`](Self::columns) and
    /// [`rows`](Self::rows) are the truth of every pixel.
    pub matches: Matches,
    /// The renderer of the photographs, which can trace any pixel.
    pub photographer: Photographer,
    /// The contents as numbers.
    pub report: SceneReport,
}

/// Photographs of a scene before those of a sequence's pictures, which have other noise: under the pattern, white and black.
const EARLIER_PHOTOGRAPHS: u64 = 3;

impl SimulatedScene {
    /// How many pictures the sequence has; 0 for other patterns.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        match &self.pattern {
            Pattern::Sequence(sequence) => sequence.frames.len(),
            Pattern::Checker(_) | Pattern::Stripes(_) => 0,
        }
    }

    /// The photograph under one picture of a sequence. It is taken when it is asked for, always with the same noise, which is that of
    /// no other picture.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a picture that the sequence does not have, and for other patterns.
    pub fn frame(&self, frame: usize) -> Result<Exposure> {
        let Pattern::Sequence(sequence) = &self.pattern else {
            return Err(Error::invalid(ErrorSubject::Pattern, "a sequence", self.pattern.kind()));
        };
        let shown = DynamicImage::ImageLuma8(sequence.image(frame)?).into_rgb8();
        self.photographer.exposure(ProjectedImage::Picture(&shown), EARLIER_PHOTOGRAPHS + frame as u64)
    }

    /// The photographs under the pictures of a sequence, in its order, each taken when the iterator comes to it, so that a long
    /// sequence needs the memory of one; none for other patterns.
    #[must_use = "photographs are taken when the iterator comes to them"]
    pub fn frames(&self) -> impl ExactSizeIterator<Item = Result<Exposure>> + '_ {
        (0..self.frame_count()).map(|frame| self.frame(frame))
    }

    /// The points of the matches, in the camera's frame and in the colours of the white photograph.
    #[must_use]
    pub fn cloud(&self) -> PointCloud {
        let white = self.white.to_rgb8();
        let points = self.matches.items.iter().filter_map(|m| {
            let seen = self.photographer.trace(m.camera)?;
            let [x, y] = [(m.camera.x, white.width()), (m.camera.y, white.height())]
                .map(|(v, n)| v.round().clamp(0.0, f64::from(n - 1)) as u32);
            Some(CloudPoint {
                position: seen.point,
                pixel: m.camera,
                color: white.get_pixel(x, y).0,
                sigma_mm: 0.0,
                noise_mm: 0.0,
                slit: m.slit,
                confidence: 1.0,
            })
        });
        PointCloud { points: points.collect(), ..PointCloud::default() }
    }

    /// The panel column whose light falls on the point of each pixel, row by row; NaN in shadow and outside the
    /// projector footprint.
    #[must_use]
    pub fn columns(&self) -> Vec<f32> {
        self.map(|s| s.panel.map(|q| q.x))
    }

    /// The panel row, as [`columns`](Self::columns).
    #[must_use]
    pub fn rows(&self) -> Vec<f32> {
        self.map(|s| s.panel.map(|q| q.y))
    }

    /// Depth of the point of each pixel along the camera's axis, mm, row by row; NaN where there is no surface.
    #[must_use]
    pub fn depths(&self) -> Vec<f32> {
        self.map(|s| Some(s.point.z))
    }

    /// The surface of each pixel, row by row: counted from one, 0 for none, 255 for that and all after it.
    #[must_use]
    pub fn surfaces(&self) -> Vec<u8> {
        let number = |s: Option<PixelTruth>| s.map_or(0, |s| (s.surface + 1).min(255) as u8);
        self.photographer.truth().pixels().map(number).collect()
    }

    fn map(&self, value: impl Fn(PixelTruth) -> Option<f64>) -> Vec<f32> {
        let pixels = self.photographer.truth().pixels();
        pixels.map(|s| s.and_then(&value).map_or(f32::NAN, |v| v as f32)).collect()
    }
}
