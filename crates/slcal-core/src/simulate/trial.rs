//! One draw: calibrate with one method and compare with the truth.

use nalgebra::{Point2, Point3, Vector3};
use serde::{Deserialize, Serialize};

use super::cube::Cube;
use super::draws::Draws;
use super::scene::{Scene, lit_point};
use super::statistics::{Coverage, ErrorStatistics, Statistics, coverage};
use crate::calibrate::{CalibrateConfig, calibrate_observations};
use crate::error::Error;
use crate::geometry::{Camera, Plane, Pose, Ray};
use crate::observations::{Observations, SheetObservation};
use crate::rig::{Projector, Rig, Verdict};
use crate::solve::rms;

/// The estimator of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MethodName {
    /// Two vanishing points alone.
    TwoVp,
    /// Maximum likelihood.
    Ml,
}

/// One method at one level. Statistics are over the draws that gave a rig, including those refused as degenerate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MethodReport {
    /// The estimator.
    pub method: MethodName,
    /// Draws of the noise.
    pub draws: usize,
    /// Draws without a real focal length.
    pub imaginary: usize,
    /// Draws whose rig is degenerate by its own σ.
    pub refused: usize,
    /// Draws that failed in another way.
    pub failed: usize,
    /// Reprojection error of the sheet's and the projected corners, rms per draw, camera px.
    pub camera_reprojection_px: Statistics,
    /// Reprojection error of the projected corners, mapped over the sheet into the projector, projector px.
    pub projector_reprojection_px: Statistics,
    /// Distance of the cube's corners from their true positions, mean per draw, per cent of its edge.
    pub cube_position_percent: Statistics,
    /// Error of the lengths of its edges, rms per draw, per cent.
    pub cube_length_percent: Statistics,
    /// Rigs that do not give a position for a corner of the cube.
    pub cube_missed: usize,
    /// Focal length of the camera against the truth, px.
    pub camera_focal_px: ErrorStatistics,
    /// Focal length of the projector against the truth, px.
    pub projector_focal_px: ErrorStatistics,
    /// Translation camera → projector against the truth, mm.
    pub translation_mm: ErrorStatistics,
    /// Coverage of the rig's 95 % intervals: how often they contain the truth.
    #[serde(rename = "held")]
    pub coverage: Coverage,
}

/// Results over the draws of one method at one level.
#[derive(Debug, Default)]
pub(super) struct Tally {
    draws: usize,
    imaginary: usize,
    refused: usize,
    failed: usize,
    camera_px: Vec<f64>,
    projector_px: Vec<f64>,
    position: Vec<f64>,
    length: Vec<f64>,
    camera_focal: Vec<[f64; 1]>,
    projector_focal: Vec<[f64; 1]>,
    translation: Vec<[f64; 3]>,
    /// Error and σ of the camera's focal length, the projector's, and the baseline.
    intervals: [Vec<(f64, f64)>; 3],
}

impl Tally {
    /// Calibrates from one draw and adds the result.
    pub(super) fn add(
        &mut self,
        (scene, cube, sigma_px): (&Scene, &Cube, f64),
        observations: &Observations,
        config: &CalibrateConfig,
        draws: &mut Draws,
    ) {
        self.draws += 1;
        let rig = match calibrate_observations(observations, config) {
            Ok(calibration) => calibration.rig,
            Err(Error::ImaginaryFocal { .. }) => {
                self.imaginary += 1;
                return;
            }
            Err(_) => {
                self.failed += 1;
                return;
            }
        };
        let Some(Projector { device: projector, from_camera, .. }) = rig.projector else {
            self.failed += 1;
            return;
        };
        let verdict = rig.quality.as_ref().map(|q| q.verdict);
        self.refused += usize::from(verdict == Some(Verdict::Degenerate));
        let pose = from_camera.pose;
        let off = pose.translation - scene.projector_from_camera.translation;
        self.camera_focal.push([rig.camera.model.intrinsics.fx - scene.camera.intrinsics.fx]);
        self.projector_focal.push([projector.model.intrinsics.fx - scene.projector.intrinsics.fx]);
        self.translation.push(off.into());
        let truth = scene.projector_from_camera.translation.norm();
        let sigmas = [
            rig.camera.sigma.map(|s| s.focal_px),
            projector.sigma.map(|s| s.focal_px),
            rig.baseline_sigma_mm(),
        ];
        let errors = [
            rig.camera.model.intrinsics.fx - scene.camera.intrinsics.fx,
            projector.model.intrinsics.fx - scene.projector.intrinsics.fx,
            pose.translation.norm() - truth,
        ];
        for (of_one, (error, sigma)) in self.intervals.iter_mut().zip(errors.into_iter().zip(sigmas)) {
            of_one.extend(sigma.filter(|s| *s > 0.0).map(|s| (error, s)));
        }
        let (camera, panel) = reprojection(&rig, &projector.model, &pose, observations);
        self.camera_px.push(camera);
        self.projector_px.push(panel);
        if let Ok(Some(error)) = cube.error(&rig, sigma_px, draws) {
            self.position.push(error.position_percent);
            self.length.push(error.length_percent);
        }
    }

    /// The statistics.
    pub(super) fn report(&self, method: MethodName) -> MethodReport {
        let [camera_focal, projector_focal, baseline] = [0, 1, 2].map(|i| coverage(&self.intervals[i]));
        MethodReport {
            method,
            draws: self.draws,
            imaginary: self.imaginary,
            refused: self.refused,
            failed: self.failed,
            camera_reprojection_px: Statistics::of(&self.camera_px),
            projector_reprojection_px: Statistics::of(&self.projector_px),
            cube_position_percent: Statistics::of(&self.position),
            cube_length_percent: Statistics::of(&self.length),
            cube_missed: self.camera_focal.len() - self.position.len(),
            camera_focal_px: ErrorStatistics::of(&self.camera_focal),
            projector_focal_px: ErrorStatistics::of(&self.projector_focal),
            translation_mm: ErrorStatistics::of(&self.translation),
            coverage: Coverage { camera_focal, projector_focal, baseline },
        }
    }
}

/// Root mean square reprojection error: of the sheet's and the projected corners in the camera's picture, and of the
/// projected corners mapped over the sheet into the projector's. NaN where the rig puts a point behind a device.
fn reprojection(rig: &Rig, projector: &Camera, stereo: &Pose, observations: &Observations) -> (f64, f64) {
    let camera = &rig.camera.model;
    let mut in_camera = Vec::new();
    let mut in_projector = Vec::new();
    let apart = |a: Option<Point2<f64>>, b: Point2<f64>| a.map_or(f64::NAN, |a| (a - b).norm());
    for (view, seen) in rig.views.iter().zip(&observations.views) {
        let pose = &view.camera_from_sheet;
        if let SheetObservation::Corners { corners, .. } = &seen.sheet {
            for (mm, px) in seen.size.corners().iter().zip(corners) {
                let p = camera.project(&pose.lift(*mm));
                in_camera.push(apart(p, *px));
            }
        }
        for pair in &seen.pairs {
            let lit = lit_point(projector, stereo, pose, pair.projector);
            in_camera.push(apart(lit.and_then(|p| camera.project(&p)), pair.camera));
            let onto = on_sheet(camera, pose, pair.camera).map(|p| stereo.transform(&p));
            in_projector.push(apart(onto.and_then(|p| projector.project(&p)), pair.projector));
        }
    }
    let rms = |distances: Vec<f64>| rms(distances.into_iter()).unwrap_or(f64::NAN);
    (rms(in_camera), rms(in_projector))
}

/// The point of the sheet at a camera pixel, in the camera frame.
fn on_sheet(camera: &Camera, pose: &Pose, pixel: Point2<f64>) -> Option<Point3<f64>> {
    let plane = Plane::from_point_normal(&pose.translation.into(), pose.rotation * Vector3::z())?;
    Ray { origin: Point3::origin(), direction: camera.bearing(pixel)? }.meet(&plane)
}
