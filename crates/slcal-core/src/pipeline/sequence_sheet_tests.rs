//! Poses of a sheet under a sequence, rendered, against the truth of the scene.

use image::DynamicImage;
use nalgebra::{Matrix2, Point2, Point3, Vector2};

use super::{Calibrator, SheetPhoto};
use crate::calibrate::Calibration;
use crate::decode::{SequenceDecodeConfig, SequenceDecoder};
use crate::dense_matches::DenseMatches;
use crate::error::Result;
use crate::observations::CornerPair;
use crate::pattern::{Pattern, SequenceAxes, SequenceConfig, SequencePattern, SinusoidConfig};
use crate::photo::PhotoView;
use crate::rig::Verdict;
use crate::simulate::{
    PatternKind, RenderConfig, RigConfig, SceneSetup, SimulatedScene, SurfaceKind, WallKind,
};

const PANEL: [u32; 2] = [512, 384];

fn gray(axes: SequenceAxes) -> SequencePattern {
    SequencePattern::new(PANEL, &SequenceConfig { axes, ..SequenceConfig::default() }).unwrap()
}

fn phase() -> SequencePattern {
    let sinusoid = Some(SinusoidConfig { period_px: 16.0, steps: 5 });
    SequencePattern::new(PANEL, &SequenceConfig { axes: SequenceAxes::Both, sinusoid, bits: None }).unwrap()
}

fn setup(pattern: &SequencePattern) -> SceneSetup {
    let rig = RigConfig {
        camera: [640, 480],
        camera_focal_px: 750.0,
        distortion: [-0.08, 0.0, 0.0, 0.0, 0.0],
        projector: PANEL,
        projector_focal_px: 800.0,
        projector_distortion: [-0.05, 0.0, 0.0, 0.0, 0.0],
        ..RigConfig::default()
    };
    SceneSetup {
        rig,
        surface: SurfaceKind::Sheet,
        wall: WallKind::Behind(400.0),
        wall_albedo: 0.2,
        pattern: PatternKind::Known(Pattern::Sequence(pattern.clone())),
        render: RenderConfig { exposure: 0.55, ambient: [0.15; 3], ..RenderConfig::default() },
        ..SceneSetup::default()
    }
}

/// Poses with tilts about the horizontal and the vertical axis, all before the same rig.
fn poses(setup: &SceneSetup, tilts_deg: &[[f64; 2]]) -> Vec<SimulatedScene> {
    let rig = setup.set_up().unwrap().rig;
    let scene = |(i, tilt): (usize, &[f64; 2])| {
        let mut setup = setup.clone();
        setup.known_rig = Some(rig.clone());
        setup.turn_rad = Some([tilt[0].to_radians(), tilt[1].to_radians(), 0.0]);
        setup.render.seed = i as u64;
        setup.photograph().unwrap()
    };
    tilts_deg.iter().enumerate().map(scene).collect()
}

fn view(photo: &DynamicImage) -> PhotoView<'_> {
    PhotoView::try_from(photo).unwrap()
}

fn decoded(scene: &SimulatedScene, mirrored: bool) -> DenseMatches {
    let Pattern::Sequence(pattern) = &scene.pattern else { panic!("{:?}", scene.pattern) };
    let config = SequenceDecodeConfig { mirrored, ..SequenceDecodeConfig::default() };
    let mut decoder = SequenceDecoder::new(pattern, config).unwrap();
    for i in decoder.reading_order().to_vec() {
        decoder.push(i, view(&scene.frame(i).unwrap().picture)).unwrap();
    }
    decoder.finish().unwrap().matches
}

fn calibrator(scenes: &[SimulatedScene], mirrored: bool) -> Result<Calibrator> {
    let Pattern::Sequence(pattern) = &scenes[0].pattern else { panic!("{:?}", scenes[0].pattern) };
    let calibrator = Calibrator::new("594x420mm".parse().unwrap());
    let mut calibrator =
        if mirrored { calibrator.with_mirrored_sequence(pattern) } else { calibrator.with_sequence(pattern) };
    for scene in scenes {
        calibrator.add(SheetPhoto::new(view(&scene.white)).matches(&decoded(scene, mirrored)))?;
    }
    Ok(calibrator)
}

#[test]
fn three_poses_give_both_devices_and_their_lenses() {
    let scenes = poses(&setup(&phase()), &[[25.0, 28.0], [-25.0, -20.0], [15.0, -30.0]]);
    let calibrator = calibrator(&scenes, false).unwrap();
    for (scene, found) in scenes.iter().zip(calibrator.detections()) {
        let pairs = &found.observation.pairs;
        assert!(pairs.len() > 200 && found.pattern_corners >= pairs.len());
        let ratio = error_over_sigma(scene, pairs);
        assert!((0.4..1.3).contains(&ratio), "{ratio}");
    }
    let Calibration { rig, .. } = calibrator.calibrate().unwrap();
    let quality = rig.quality.as_ref().unwrap();
    assert_eq!(quality.verdict, Verdict::Good, "{quality:?}");
    let truth = &scenes[0].rig;
    let (projector, true_projector) = (rig.projector.as_ref().unwrap(), truth.projector.as_ref().unwrap());
    for (device, truth) in
        [(&rig.camera, &truth.camera.model), (&projector.device, &true_projector.device.model)]
    {
        let (sigma, found, expected) = (device.sigma.unwrap(), device.model.intrinsics, truth.intrinsics);
        for (error, sigma) in [
            (found.fx - expected.fx, sigma.focal_px),
            (found.cx - expected.cx, sigma.cx_px),
            (found.cy - expected.cy, sigma.cy_px),
        ] {
            assert!(error.abs() <= 3.0 * sigma, "{error} ± {sigma}: {found:?}, {expected:?}, {quality:?}");
        }
        assert!(sigma.focal_px < 0.002 * expected.fx, "{sigma:?}");
    }
    // A photograph of a checkerboard says little of it: see docs/experiments.md.
    let k1 = projector.device.model.distortion.k1;
    assert!((k1 + 0.05).abs() < 0.01, "{k1}");
}

#[test]
fn a_mirrored_sequence_gives_the_places_on_the_panel() {
    let mut setup = setup(&phase());
    setup.mirrored = true;
    let scenes = poses(&setup, &[[25.0, 28.0]]);
    let calibrator = calibrator(&scenes, true).unwrap();
    let ratio = error_over_sigma(&scenes[0], &calibrator.detections()[0].observation.pairs);
    assert!(ratio < 1.3, "{ratio}");
    let observations = calibrator.observations().unwrap();
    assert!(observations.mirrored && observations.projector == Some(PANEL));
}

/// Where the light ends on the sheet, its border is a brighter quadrilateral.
#[test]
fn the_border_of_the_light_is_not_taken_for_the_sheet() {
    let mut setup = setup(&gray(SequenceAxes::Both));
    setup.rig.projector_focal_px = 1300.0;
    let scene = poses(&setup, &[[25.0, 28.0]]).remove(0);
    let (columns, rows) = (scene.columns(), scene.rows());
    let matches = DenseMatches {
        width: 640,
        height: 480,
        sigma_column: vec![0.1; columns.len()],
        sigma_row: vec![0.1; rows.len()],
        confidence: vec![1.0; rows.len()],
        column: columns,
        row: rows,
        color: Vec::new(),
    };
    let mut calibrator =
        Calibrator::new("594x420mm".parse().unwrap()).with_sequence(&gray(SequenceAxes::Both));
    let found =
        calibrator.add(SheetPhoto::new(view(&scene.white)).matches(&matches)).unwrap().observation.clone();
    let (camera, pose) = (scene.rig.camera.model, scene.rig.views[0].camera_from_sheet);
    let corners = scene.rig.views[0].size.corners();
    let expected = corners.map(|c| camera.project(&pose.transform(&Point3::new(c.x, c.y, 0.0))).unwrap());
    for (corner, expected) in found.sheet.corners().unwrap().iter().zip(expected) {
        assert!((corner - expected).norm() < 4.0, "{corner} {expected}");
    }
    assert!(found.pairs.len() > 12);
}

#[test]
fn matches_belong_to_a_sequence_and_to_their_photograph() {
    let photo = DynamicImage::new_rgb8(64, 48);
    let sheet = || Calibrator::new("594x420mm".parse().unwrap());
    let message = |mut calibrator: Calibrator, matches: Option<&DenseMatches>| {
        let shot = SheetPhoto::new(view(&photo));
        calibrator.add(matches.map_or(shot.clone(), |m| shot.matches(m))).unwrap_err().to_string()
    };
    let sequence = sheet().with_sequence(&gray(SequenceAxes::Both));
    let matches = DenseMatches { width: 32, height: 48, ..DenseMatches::default() };
    assert!(message(sequence.clone(), None).contains("matches of the sequence"));
    assert!(message(sheet(), Some(&matches)).contains("without matches"));
    let found = message(sequence, Some(&matches));
    assert!(found.contains("64x48") && found.contains("32x48"), "{found}");
}

/// Root mean square of the errors of pairs in the camera's image, over their σ.
fn error_over_sigma(scene: &SimulatedScene, pairs: &[CornerPair]) -> f64 {
    let at = |q: Point2<f64>| scene.photographer.trace(q).unwrap().panel.unwrap();
    let square = |p: &CornerPair| {
        let along = |d: Vector2<f64>| at(p.camera + d / 2.0) - at(p.camera - d / 2.0);
        let panel_by_camera = Matrix2::from_columns(&[along(Vector2::x()), along(Vector2::y())]);
        let off = panel_by_camera.try_inverse().unwrap() * (at(p.camera) - p.projector);
        off.norm_squared() / (2.0 * p.sigma_px.unwrap().powi(2))
    };
    (pairs.iter().map(square).sum::<f64>() / pairs.len() as f64).sqrt()
}
