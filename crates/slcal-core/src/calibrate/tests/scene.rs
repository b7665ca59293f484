//! Synthetic observations with known truth for the tests of this folder.

use nalgebra::{Point2, Rotation3, Vector2, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

use crate::calibrate::{CalibrateConfig, DistortionModel, Flatness, calibrate_observations};
use crate::estimate::{Model, Sheet};
use crate::geometry::{Camera, Distortion, Intrinsics, Pose, RectangleSize, SheetBend};
use crate::observations::{CornerPair, EdgePoint, Observations, SheetObservation, ViewObservation};
use crate::rig::Rig;

pub(crate) fn rng(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// An A2 sheet about 1 m away, tilted about the camera's X, then Y axis (degrees).
pub(crate) fn pose(tilt_x: f64, tilt_y: f64) -> Pose {
    let [x, y] = [tilt_x, tilt_y].map(f64::to_radians);
    let rotation =
        Rotation3::from_axis_angle(&Vector3::x_axis(), x) * Rotation3::from_axis_angle(&Vector3::y_axis(), y);
    let centre = Vector3::new(297.0, 210.0, 0.0);
    Pose { rotation, translation: Vector3::new(0.0, 0.0, 1000.0) - rotation * centre }
}

pub(crate) fn size() -> RectangleSize {
    RectangleSize { width_mm: 594.0, height_mm: 420.0 }
}

/// What these scenes are unless they say otherwise: flat sheets, no distortion, square pixels.
pub(crate) fn ideal() -> CalibrateConfig {
    CalibrateConfig {
        distortion: DistortionModel::None,
        projector_distortion: DistortionModel::None,
        flatness: Flatness::Flat,
        ..CalibrateConfig::default()
    }
}

/// A bend of all terms with this sag, mm.
pub(crate) fn bend(sag_mm: f64) -> SheetBend {
    let shape = SheetBend([0.7, -0.5, 0.4, 0.2, -0.15, 0.25, -0.1, 0.08, -0.06, 0.1, -0.05, 0.09]);
    let scale = sag_mm / shape.sag_mm(size()).0;
    SheetBend(shape.0.map(|c| c * scale))
}

/// The flat sheet in a pose.
pub(crate) fn flat(pose: Pose) -> Sheet {
    Sheet::flat(pose, size())
}

fn camera([width, height]: [u32; 2], f: f64, pp: Point2<f64>) -> Camera {
    Camera { width, height, intrinsics: Intrinsics::square(f, pp), distortion: Distortion::NONE }
}

/// 1280×960, f = 1500; 1024×768, f = 1700, cy as given; the projector 250 mm to the right, turned towards the sheet.
pub(crate) fn rig(cy: f64, views: Vec<Pose>) -> Model {
    let aim = Rotation3::from_axis_angle(&Vector3::y_axis(), 0.2);
    // A shifted projector throws upwards: it stands lower and keeps its axis level.
    let drop = (cy - 383.5) / 1700.0 * 1050.0;
    let centre = Vector3::new(250.0, drop, 0.0);
    Model {
        camera: camera([1280, 960], 1500.0, Point2::new(639.5, 479.5)),
        projector: Some(camera([1024, 768], 1700.0, Point2::new(511.5, cy))),
        projector_from_camera: Pose { rotation: aim, translation: -(aim * centre) },
        views: views.into_iter().map(flat).collect(),
    }
}

/// Noise of standard deviation `sigma` per coordinate.
pub(crate) fn jitter(rng: &mut ChaCha8Rng, sigma: f64) -> Vector2<f64> {
    let n = Normal::new(0.0, sigma).unwrap();
    Vector2::new(n.sample(rng), n.sample(rng))
}

/// What a model shows: sheet corners with noise `sheet_px`, 9×6 projected corners with noise `pair_px`.
pub(crate) fn observe(model: &Model, sheet_px: f64, pair_px: f64, rng: &mut ChaCha8Rng) -> Observations {
    let views = model
        .views
        .iter()
        .map(|sheet| {
            let corners = sheet
                .size
                .corners()
                .map(|c| model.camera.project(&sheet.lift_fixed(c)).unwrap() + jitter(rng, sheet_px));
            let mut pairs = Vec::new();
            if model.projector.is_some() {
                for k in 0..54 {
                    let q = Point2::new(271.5 + 60.0 * f64::from(k % 9), 233.5 + 60.0 * f64::from(k / 9));
                    let p = model.lit(sheet, q).unwrap();
                    let seen = model.camera.project(&p).unwrap() + jitter(rng, pair_px);
                    pairs.push(CornerPair { camera: seen, projector: q, sigma_px: Some(pair_px) });
                }
            }
            let seen = SheetObservation::Corners { corners, sigma_px: Some(sheet_px) };
            ViewObservation {
                photo: None,
                size: sheet.size,
                sheet: seen,
                pairs,
                panel_points: Vec::new(),
                channel_offsets: Vec::new(),
            }
        })
        .collect();
    let projector = model.projector.map(|p| [p.width, p.height]);
    Observations { camera: [model.camera.width, model.camera.height], projector, mirrored: false, views }
}

/// The same with `n` edge points per side instead of corners.
pub(crate) fn with_edges(
    mut observations: Observations,
    model: &Model,
    n: usize,
    sigma: f64,
    rng: &mut ChaCha8Rng,
) -> Observations {
    for (view, sheet) in observations.views.iter_mut().zip(&model.views) {
        let corners = sheet.size.corners();
        let sides = std::array::from_fn(|i| {
            let (a, b) = (corners[i], corners[(i + 1) % 4]);
            (0..n)
                .map(|k| {
                    let p = a + (b - a) * ((k as f64 + 0.5) / n as f64);
                    let seen = model.camera.project(&sheet.lift_fixed(p)).unwrap();
                    EdgePoint { position: seen + jitter(rng, sigma), sigma_px: Some(sigma) }
                })
                .collect()
        });
        view.sheet = SheetObservation::Edges(sides);
    }
    observations
}

/// A rig that was calibrated from one view with noise of 0.1 px.
pub(crate) fn calibrated() -> Rig {
    let truth = rig(700.0, vec![pose(25.0, 28.0)]);
    let mut rng = rng(3);
    let seen = observe(&truth, 0.1, 0.1, &mut rng);
    let seen = with_edges(seen, &truth, 40, 0.1, &mut rng);
    calibrate_observations(&seen, &CalibrateConfig::default()).unwrap().rig
}
