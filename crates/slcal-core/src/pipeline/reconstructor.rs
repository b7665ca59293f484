//! Photograph → cloud in one call, with buffers that are kept from frame to frame.

use serde::{Deserialize, Serialize};

use crate::cloud::{Frame, PointCloud};
use crate::decode::{DecodeConfig, DecodeInput, DecodeReport, Decoder, SequenceDecodeReport};
use crate::error::{Error, ErrorSubject, Result};
use crate::geometry::Pose;
use crate::matches::{Match, Matches};
use crate::pattern::StripePattern;
use crate::reconstruct::{
    CullReport, CullRule, Culler, RigCheckReport, RigChecker, TriangulateConfig, TriangulateReport,
    Triangulator, first_view, turn,
};
use crate::rig::{Rig, Warning, check_photo_size};

/// Largest share of matches whose ray does not meet light from the panel in front of the devices. Above it pattern, rig
/// and photograph do not belong together. The right pattern leaves a few in a thousand (labels that are wrong by
/// chance); a wrong one that decodes nevertheless leaves a tenth.
const MAX_IMPOSSIBLE: f64 = 0.05;

/// Configuration of the reconstruction.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ReconstructConfig {
    /// Photograph → matches.
    pub decode: DecodeConfig,
    /// Matches → points.
    pub triangulate: TriangulateConfig,
    /// Which triangles and outliers are removed.
    pub cull: CullRule,
    /// Coordinate frame of the cloud.
    pub frame: Frame,
    /// Whether the cloud keeps its triangles.
    pub mesh: bool,
}

/// A cloud, and how its stages went.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Reconstruction {
    /// The points, and triangles if requested.
    pub cloud: PointCloud,
    pub(super) decode: Option<DecodeReport>,
    pub(super) sequence: Option<SequenceDecodeReport>,
    pub(super) triangulate: TriangulateReport,
    pub(super) cull: CullReport,
    pub(super) rig_check: RigCheckReport,
}

impl Reconstruction {
    /// Median 1σ of a point along the camera's ray, mm.
    #[must_use]
    pub fn median_sigma_mm(&self) -> f64 {
        self.triangulate.median_sigma_mm
    }

    /// Median of the part of it that differs from point to point, mm.
    #[must_use]
    pub fn median_noise_mm(&self) -> f64 {
        self.triangulate.median_noise_mm
    }

    /// What makes the cloud doubtful: `rig-moved` where the matches contradict the rig, `shown-1:1` where the stripes seem
    /// to be shown at another scale. An empty list proves nothing: most motion along the baseline leaves no trace in
    /// stripes.
    #[must_use]
    pub fn warnings(&self) -> Vec<Warning> {
        let of_frames = self.sequence.iter().flat_map(|report| report.warnings.iter().cloned());
        of_frames.chain(self.rig_check.warning()).collect()
    }
}

/// The reports of the stages.
#[cfg(feature = "report")]
impl Reconstruction {
    /// Report of decoding; `None` when the matches were given.
    #[must_use]
    pub fn decode(&self) -> Option<&DecodeReport> {
        self.decode.as_ref()
    }

    /// Report of decoding a sequence; `None` for a single photograph.
    #[must_use]
    pub fn sequence(&self) -> Option<&SequenceDecodeReport> {
        self.sequence.as_ref()
    }

    /// Counts of matches that gave no point.
    #[must_use]
    pub fn triangulate(&self) -> &TriangulateReport {
        &self.triangulate
    }

    /// Counts of removed triangles and points.
    #[must_use]
    pub fn cull(&self) -> &CullReport {
        &self.cull
    }

    /// How the matches agree with the rig.
    #[must_use]
    pub fn rig_check(&self) -> &RigCheckReport {
        &self.rig_check
    }
}

/// Reconstructs one photograph after another with the same rig and pattern. After the first photographs no buffer grows
/// any more (see "Cost" in the documentation of the architecture).
///
/// # Examples
/// ```
/// use slcal_core::{PhotoView, ReconstructConfig, Reconstructor, StripePattern};
///
/// # let rig = slcal_core::format::read_rig(&include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/../slcal-cli/demo/truth_rig.json"))[..])?;
/// let stripes = StripePattern::new([1024, 768], &Default::default())?;
/// let config = ReconstructConfig { mesh: true, ..ReconstructConfig::default() };
/// let mut reconstructor = Reconstructor::new(&rig, &stripes, config)?;
/// // One photograph after another; the buffers stay.
/// let photo = image::open(concat!(env!("CARGO_MANIFEST_DIR"), "/../slcal-cli/demo/board.jpg"))?;
/// let cloud = &reconstructor.reconstruct(PhotoView::try_from(&photo)?)?.cloud;
/// assert!(cloud.points.len() > 10_000 && !cloud.triangles.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Reconstructor {
    /// Width and height of its photographs, px.
    camera: [u32; 2],
    decoder: Decoder,
    /// Width of the panel, px.
    panel_width: u32,
    stages: Stages,
    result: Reconstruction,
}

impl Reconstructor {
    /// Checks that rig, pattern and configuration fit together. The rig's registration of the colour channels is decoded with, unless
    /// [`DecodeConfig::registration`](crate::decode::DecodeConfig::registration) has another. The picture counts as mirrored where
    /// the rig or the configuration says so.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a rig without a projector, a pattern for another panel, the sheet's frame with a rig that
    /// has no views, or a configuration out of range.
    pub fn new(rig: &Rig, pattern: &StripePattern, config: ReconstructConfig) -> Result<Self> {
        rig.projector_for(ErrorSubject::StripePattern, pattern.projector)?;
        let panel_width = pattern.projector[0];
        let stages = Stages::new(rig, &config)?;
        let registration = config.decode.registration.or(rig.channel_registration);
        let mirrored = config.decode.mirrored || rig.is_mirrored();
        let decoder = Decoder::new(pattern, DecodeConfig { mirrored, registration, ..config.decode })?;
        let camera = rig.camera.model.size();
        Ok(Self { camera, decoder, panel_width, stages, result: Reconstruction::default() })
    }

    /// The cloud of one scene: from the striped photograph alone, or with photographs under a dark and a white projector. It
    /// belongs to the reconstructor and is valid until the next scene; clone it, or [take](Self::take_last) it, to keep it.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a photograph of another size than the rig's camera or than its dark and white twins;
    /// [`Error::NotFound`] when the stripes are not seen or cannot be read, or no surface is left.
    pub fn reconstruct<'a>(&mut self, scene: impl Into<DecodeInput<'a>>) -> Result<&Reconstruction> {
        let input: DecodeInput<'_> = scene.into();
        check_photo_size(self.camera, [input.photo.width(), input.photo.height()])?;
        let decoding = self.decoder.decode(input)?;
        let matches = &decoding.matches;
        let run = self.stages.run(matches, &mut self.result);
        if let Err(error) = run.and_then(|()| check_possible(&self.result.triangulate, matches.items.len())) {
            let otherwise = mirrored(matches, self.panel_width);
            return Err(if self.stages.explain(&otherwise) { mirrored_unsaid() } else { error });
        }
        self.decoder.swap_report(self.result.decode.get_or_insert_default());
        Ok(&self.result)
    }

    /// The result of the last photograph, moved out of the buffers instead of copied; the next one allocates new ones.
    /// Empty when there was none, or it failed.
    #[must_use]
    pub fn take_last(&mut self) -> Reconstruction {
        std::mem::take(&mut self.result)
    }
}

/// The cloud of matches from any decoder: triangulated, culled, in the requested frame.
///
/// # Errors
/// [`Error::Invalid`] for a rig without a projector, the sheet's frame with a rig that has no views, or a configuration out of
/// range; [`Error::NotFound`] when no point is left.
///
/// # Examples
/// ```
/// use slcal_core::nalgebra::Point2;
/// use slcal_core::reconstruct::CullRule;
/// use slcal_core::{Match, Matches, ReconstructConfig, cloud_from_matches};
///
/// # let rig = slcal_core::format::read_rig(&include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/../slcal-cli/demo/truth_rig.json"))[..])?;
/// // A decoder of one's own says which projector column each camera pixel sees.
/// let one = Match {
///     camera: Point2::new(640.0, 480.0),
///     projector_column: Some(500.0),
///     projector_row: None,
///     slit: None,
///     confidence: 1.0,
///     sigma_px: Match::DEFAULT_SIGMA_PX,
///     color: [255; 3],
/// };
/// // A few points make no surface: without culling they stay.
/// let config = ReconstructConfig { cull: CullRule::Off, ..ReconstructConfig::default() };
/// let cloud = cloud_from_matches(&rig, &Matches { items: vec![one] }, &config)?.cloud;
/// assert!(cloud.points[0].position.z > 0.0 && cloud.points[0].sigma_mm > 0.0);
/// # Ok::<(), slcal_core::Error>(())
/// ```
pub fn cloud_from_matches(
    rig: &Rig,
    matches: &Matches,
    config: &ReconstructConfig,
) -> Result<Reconstruction> {
    let mut result = Reconstruction::default();
    Stages::new(rig, config)?.run(matches, &mut result)?;
    Ok(result)
}

/// The stages after decoding, with their buffers.
#[derive(Debug, Clone)]
struct Stages {
    triangulator: Triangulator,
    rig_checker: RigChecker,
    culler: Culler,
    rule: CullRule,
    finish: Finish,
}

impl Stages {
    fn new(rig: &Rig, config: &ReconstructConfig) -> Result<Self> {
        Ok(Self {
            triangulator: Triangulator::new(rig, config.triangulate)?,
            rig_checker: RigChecker::new(rig, config.triangulate.min_angle_rad)?,
            culler: Culler::default(),
            rule: config.cull,
            finish: Finish::new(rig, config)?,
        })
    }

    /// Whether these matches are a surface that the rig explains.
    fn explain(&mut self, matches: &Matches) -> bool {
        let mut result = Reconstruction::default();
        let run = self.run(matches, &mut result);
        run.is_ok() && check_possible(&result.triangulate, matches.items.len()).is_ok()
    }

    /// Replaces the content of `result`.
    fn run(&mut self, matches: &Matches, result: &mut Reconstruction) -> Result<()> {
        result.cull = CullReport::default();
        let cloud = &mut result.cloud;
        result.triangulate = self.triangulator.triangulate(matches, cloud);
        result.rig_check = self.rig_checker.check(matches);
        if self.finish.mesh || self.rule != CullRule::Off {
            result.cull = self.culler.cull(cloud, self.rule)?;
        }
        if cloud.points.is_empty() {
            return Err(no_surface(matches.items.len(), &result.triangulate, &result.cull));
        }
        self.finish.apply(cloud);
        Ok(())
    }
}

/// What becomes of a cloud once its points are known.
#[derive(Debug, Clone)]
pub(super) struct Finish {
    /// Whether the triangles stay.
    mesh: bool,
    /// The transform into the requested frame, unless that is the camera's.
    sheet_from_camera: Option<Pose>,
}

impl Finish {
    pub(super) fn new(rig: &Rig, config: &ReconstructConfig) -> Result<Self> {
        let sheet_from_camera = match config.frame {
            Frame::Camera => None,
            Frame::Plane => Some(first_view(rig)?.camera_from_sheet.inverse()),
        };
        Ok(Self { mesh: config.mesh, sheet_from_camera })
    }

    pub(super) fn apply(&self, cloud: &mut PointCloud) {
        if !self.mesh {
            cloud.triangles.clear();
        }
        if let Some(pose) = &self.sheet_from_camera {
            turn(cloud, pose);
            cloud.frame = Frame::Plane;
        }
    }
}

/// Matches of the panel with left and right exchanged.
fn mirrored(matches: &Matches, panel_width: u32) -> Matches {
    let right = f64::from(panel_width) - 1.0;
    let flip = |m: &Match| Match { projector_column: m.projector_column.map(|c| right - c), ..*m };
    Matches { items: matches.items.iter().map(flip).collect() }
}

fn mirrored_unsaid() -> Error {
    Error::NotFound {
        what: ErrorSubject::Named("the pattern as this rig would project it"),
        seen: "stripes that fit the rig only with left and right of the picture exchanged".into(),
        advice: "switch the projector's mirroring (rear projection) to what it was at the calibration; or take the picture as mirrored, in calibration and scan alike".into(),
    }
}

pub(super) fn no_surface(matches: usize, report: &TriangulateReport, culled: &CullReport) -> Error {
    Error::NotFound {
        what: ErrorSubject::Surface,
        seen: format!(
            "{} points from {matches} matches (rejected: {} without coordinates, {} whose light plane nearly contains the camera ray, {} behind the devices, {} lit from outside the panel, {} with contradicting column and row, {} outside the depth limits); {} of the points are outliers",
            report.points,
            report.invalid,
            report.grazing,
            report.behind,
            report.outside_panel,
            report.contradicting,
            report.outside_depth,
            culled.outliers
        ),
        advice: "check that the rig, the pattern and the photograph belong together, and that nothing has moved since the calibration; with culling off, a few points without a surface are kept".into(),
    }
}

/// Refuses a cloud when many of its matches are impossible: the others are then chance, too.
pub(super) fn check_possible(report: &TriangulateReport, matches: usize) -> Result<()> {
    let impossible = report.behind + report.grazing + report.outside_panel + report.contradicting;
    if impossible as f64 <= MAX_IMPOSSIBLE * matches as f64 {
        return Ok(());
    }
    Err(Error::NotFound {
        what: ErrorSubject::Named("the pattern as this rig would project it"),
        seen: format!(
            "{impossible} of {matches} decoded matches where the camera ray does not meet the light of its column or row in front of both devices"
        ),
        advice: "check that the pattern file is the one that was projected, upright and not mirrored, that the rig is the one that took the photograph, and that nothing has moved since the calibration".into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::test_rig;
    use crate::pattern::StripeConfig;
    use crate::photo::PhotoView;

    #[test]
    fn inputs_that_do_not_belong_together_are_refused() {
        let rig = test_rig();
        let stripes = StripePattern::new([1024, 768], &StripeConfig::default()).unwrap();
        let other = StripePattern::new([1280, 800], &StripeConfig::default()).unwrap();
        let config = ReconstructConfig::default();
        assert!(Reconstructor::new(&rig, &other, config).unwrap_err().to_string().contains("1280x800"));
        let plane = ReconstructConfig { frame: Frame::Plane, ..config };
        assert!(Reconstructor::new(&rig, &stripes, plane).unwrap_err().to_string().contains("no view"));
        let mut scanner = Reconstructor::new(&rig, &stripes, config).unwrap();
        let small = [0_u8; 300];
        let photo =
            PhotoView::new(crate::photo::Samples::U8(&small), 10, 10, 30, crate::photo::Layout::Rgb).unwrap();
        assert!(scanner.reconstruct(photo).unwrap_err().to_string().contains("1280x960"));
        let mut camera_alone = rig;
        camera_alone.projector = None;
        assert!(Reconstructor::new(&camera_alone, &stripes, config).is_err());
    }
}
