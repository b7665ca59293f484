//! Photographs of a sequence → cloud, one scan after another.

use super::reconstructor::{Finish, ReconstructConfig, Reconstruction, check_possible, no_surface};
use crate::decode::{SequenceDecodeConfig, SequenceDecodeReport, SequenceDecoder, SequenceDecoding};
use crate::dense_matches::DenseMatches;
use crate::error::{ErrorSubject, Result};
use crate::pattern::SequencePattern;
use crate::photo::PhotoView;
use crate::reconstruct::{CullRule, Culler, DenseTriangulator};
use crate::rig::{Rig, check_photo_size};

/// Reconstructs scans by Gray code or phase shift with the same rig and pattern: a point per pixel.
///
/// Frames are given one by one and are not kept. [`SequenceDecoder::reading_order`] has the order in which least has to be held.
#[derive(Debug, Clone)]
pub struct SequenceReconstructor {
    camera: [u32; 2],
    decoder: SequenceDecoder,
    stages: DenseStages,
}

impl SequenceReconstructor {
    /// Checks that rig, pattern and configuration fit together. The picture counts as mirrored where the rig or the configuration of
    /// decoding says so.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for a rig without a projector, a pattern for another panel or that is not valid, the sheet's frame with a
    /// rig that has no views, or a configuration out of range.
    pub fn new(rig: &Rig, pattern: &SequencePattern, config: ReconstructConfig) -> Result<Self> {
        rig.projector_for(ErrorSubject::Pattern, pattern.projector)?;
        let mut decode = SequenceDecodeConfig::default();
        decode.mirrored = config.decode.mirrored || rig.is_mirrored();
        decode.parallel = config.decode.parallel;
        let decoder = SequenceDecoder::new(pattern, decode)?;
        Ok(Self { camera: rig.camera.model.size(), decoder, stages: DenseStages::new(rig, &config)? })
    }

    /// The order of frames in which the least has to be held.
    #[must_use]
    pub fn reading_order(&self) -> &[usize] {
        self.decoder.reading_order()
    }

    /// Takes the photograph of a frame of the pattern, counted from 0; in any order.
    ///
    /// # Errors
    /// As [`SequenceDecoder::push`]; [`Error::Invalid`](crate::Error::Invalid) for a photograph of another size than the rig's camera.
    pub fn push(&mut self, frame: usize, photo: PhotoView<'_>) -> Result<()> {
        check_photo_size(self.camera, [photo.width(), photo.height()])?;
        self.decoder.push(frame, photo)
    }

    /// The cloud of frames that lie in memory, in the order of the pattern.
    ///
    /// # Errors
    /// As [`push`](Self::push) and [`finish`](Self::finish); [`Error::Invalid`](crate::Error::Invalid) for another number of frames than the pattern has.
    pub fn reconstruct(&mut self, frames: &[PhotoView<'_>]) -> Result<Reconstruction> {
        for photo in frames {
            check_photo_size(self.camera, [photo.width(), photo.height()])?;
        }
        let decoding = self.decoder.decode(frames)?;
        self.cloud(&decoding.matches, decoding.report)
    }

    /// The cloud, once all frames have come; the next scan can come then.
    ///
    /// # Errors
    /// As [`SequenceDecoder::finish`]; [`Error::NotFound`](crate::Error::NotFound) when no surface is left, or most pixels contradict the rig.
    pub fn finish(&mut self) -> Result<Reconstruction> {
        self.finish_with_matches().map(|(result, _)| result)
    }

    /// The same with the panel coordinates of every pixel (of the camera's image, width times height, row by row), from which the cloud
    /// was made.
    ///
    /// # Errors
    /// As [`finish`](Self::finish).
    pub fn finish_with_matches(&mut self) -> Result<(Reconstruction, DenseMatches)> {
        let SequenceDecoding { matches, report, .. } = self.decoder.finish()?;
        let result = self.cloud(&matches, report)?;
        Ok((result, matches))
    }

    fn cloud(&mut self, matches: &DenseMatches, report: SequenceDecodeReport) -> Result<Reconstruction> {
        let mut result = self.stages.run(matches)?;
        result.sequence = Some(report);
        Ok(result)
    }

    /// Drops the frames that have come.
    pub fn clear(&mut self) {
        self.decoder.clear();
    }
}

/// The cloud of the matches of every pixel, from any decoder: triangulated, culled, with normals, in the requested frame.
///
/// # Errors
/// As [`cloud_from_matches`](crate::cloud_from_matches).
pub fn cloud_from_dense_matches(
    rig: &Rig,
    matches: &DenseMatches,
    config: &ReconstructConfig,
) -> Result<Reconstruction> {
    DenseStages::new(rig, config)?.run(matches)
}

/// The stages after decoding.
#[derive(Debug, Clone)]
struct DenseStages {
    triangulator: DenseTriangulator,
    culler: Culler,
    rule: CullRule,
    finish: Finish,
}

impl DenseStages {
    fn new(rig: &Rig, config: &ReconstructConfig) -> Result<Self> {
        let triangulator = DenseTriangulator::new(rig, config.triangulate)?;
        let (culler, finish) = (Culler::default(), Finish::new(rig, config)?);
        Ok(Self { triangulator, culler, rule: config.cull, finish })
    }

    fn run(&mut self, matches: &DenseMatches) -> Result<Reconstruction> {
        let mut result = Reconstruction::default();
        let cloud = &mut result.cloud;
        result.triangulate = self.triangulator.triangulate(matches, cloud);
        let known = matches.known();
        check_possible(&result.triangulate, known)?;
        result.cull = self.triangulator.connect(matches.width, cloud, self.rule, &mut self.culler)?;
        if cloud.points.is_empty() {
            return Err(no_surface(known, &result.triangulate, &result.cull));
        }
        self.finish.apply(cloud);
        // Those of millions of pixels are not held in vain.
        cloud.triangles.shrink_to_fit();
        Ok(result)
    }
}
