//! A fit as a [`Rig`]: devices with σ, views with vanishing points and residuals, quality, covariance.

use nalgebra::{DVector, Point2, Point3, Vector3};

use crate::calibrate::diagnostics::verdict::Judgement;
use crate::estimate::model::{Layout, Model};
use crate::estimate::refine::Fit;
use crate::estimate::{Joint, Kind, Target};
use crate::geometry::{Camera, Plane, Pose, Ray, RectangleSize};
use crate::rig::{Covariance, Device, DeviceSigma, Projector, Quality, Rig, StereoPose, View, ViewRms};

/// 1σ of a stripe's position in the camera image that the expected point σ assumes, px.
const STRIPE_NOISE_PX: f64 = 0.1;
/// Each round gains two digits or more at the strongest distortion that a projector has.
const ROUNDS_ON_A_CURVED_COLUMN: usize = 30;

fn device(model: Camera, places: &[Option<usize>; crate::estimate::residual::LENS], fit: &Fit) -> Device {
    let sigma = |i: usize| places[i].map_or(0.0, |p| fit.covariance[(p, p)].sqrt());
    let sigma = DeviceSigma {
        focal_px: sigma(0) * model.intrinsics.fx,
        cx_px: sigma(1),
        cy_px: sigma(2),
        distortion: std::array::from_fn(|i| sigma(3 + i)),
    };
    Device { model, sigma: Some(sigma) }
}

/// The sheet's corners in a device's image; those behind it (which a calibrated view never has) at the principal point.
pub(crate) fn projected_corners(device: &Camera, pose: &Pose, size: RectangleSize) -> [Point2<f64>; 4] {
    size.corners().map(|c| {
        let p = pose.transform(&Point3::new(c.x, c.y, 0.0));
        device.project(&p).unwrap_or(device.intrinsics.principal_point())
    })
}

/// A camera pixel cast onto the sheet and seen from the projector, projector px.
pub(crate) fn cast_onto_panel(
    camera: &Camera,
    projector: &Camera,
    projector_from_camera: &Pose,
    sheet: &Pose,
    seen: Point2<f64>,
) -> Option<Point2<f64>> {
    let plane = Plane::from_point_normal(&sheet.translation.into(), sheet.rotation * Vector3::z())?;
    let ray = Ray { origin: Point3::origin(), direction: camera.bearing(seen)? };
    projector.project(&projector_from_camera.transform(&ray.meet(&plane)?))
}

/// Root mean square; `None` for nothing.
pub(crate) fn rms(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, n) = values.fold((0.0, 0), |(s, n), v| (s + v * v, n + 1));
    (n > 0).then(|| (sum / f64::from(n)).sqrt())
}

fn view_rms(joint: &Joint, fit: &Fit, view: usize) -> ViewRms {
    let kept = || {
        joint
            .measurements
            .iter()
            .zip(&fit.norms_px)
            .zip(&fit.inliers)
            .filter(move |((m, _), keep)| **keep && m.view == view)
            .map(|(pair, _)| pair)
    };
    let sheet = kept().filter(|(m, _)| m.kind() != Kind::Pair).map(|(_, n)| *n);
    let pairs = kept().filter(|(m, _)| m.kind() == Kind::Pair).map(|(_, n)| *n);
    let model = &fit.model;
    let on_panel = kept().filter_map(|(m, _)| match (m.of, &model.projector) {
        (Target::Pair(q), Some(p)) => {
            cast_onto_panel(&model.camera, p, &model.projector_from_camera, &model.views[view], m.seen)
                .map(|on_panel| (on_panel - q).norm())
        }
        _ => None,
    });
    ViewRms { edges: rms(sheet).unwrap_or(0.0), corners: rms(pairs), projector: rms(on_panel) }
}

/// The rig of a maximum-likelihood fit.
pub(crate) fn rig(joint: &Joint, fit: &Fit, judgement: &Judgement) -> Rig {
    let (model, layout) = (&fit.model, &joint.layout);
    let projector = model.projector.zip(layout.stereo).map(|(p, at)| {
        let sigma = |i: usize| std::array::from_fn(|k| fit.covariance[(at + i + k, at + i + k)].sqrt());
        let pose = model.projector_from_camera;
        let from_camera = StereoPose { pose, sigma_t_mm: Some(sigma(3)), sigma_r_rad: Some(sigma(0)) };
        Projector { device: device(p, &layout.projector, fit), from_camera }
    });
    let views = model.views.iter().zip(&joint.sizes).enumerate().map(|(i, (pose, &size))| {
        let projector_from_sheet = projector.map(|p| p.from_camera.pose.compose(pose));
        View {
            photo: None,
            size,
            camera_from_sheet: *pose,
            projector_from_sheet,
            camera_vanishing_points: model.camera.vanishing_points(pose),
            projector_vanishing_points: model
                .projector
                .zip(projector_from_sheet)
                .map(|(p, pose)| p.vanishing_points(&pose)),
            corners_px: projected_corners(&model.camera, pose, size),
            rms_px: Some(view_rms(joint, fit, i)),
        }
    });
    let percent = |s: f64| 100.0 * s;
    let (cause, advice) = judgement.why();
    Rig {
        camera: device(model.camera, &layout.camera, fit),
        projector,
        views: views.collect(),
        method: "ml".into(),
        quality: Some(Quality {
            verdict: judgement.verdict,
            focal_sigma_percent_camera: percent(judgement.sigma.camera),
            focal_sigma_percent_projector: judgement.sigma.projector.map(percent),
            expected_point_sigma_mm: expected_point_sigma(layout, fit, &joint.sizes),
            cause: cause.to_owned(),
            advice: advice.to_owned(),
            warnings: judgement.warnings.clone(),
        }),
        covariance: Some(Covariance {
            parameters: layout.names(),
            matrix: layout.in_pixels(&fit.covariance, model),
        }),
    }
}

/// Distance along the camera's ray through pixel `p` (per unit of the bearing's length) at which the projector's column
/// `column` crosses it (paper, eq. 17 to 19).
pub(crate) fn depth_on_column(model: &Model, p: Point2<f64>, column: f64, row: f64) -> Option<f64> {
    let projector = model.projector.as_ref()?;
    let ray = model.projector_from_camera.rotation * model.camera.bearing(p)?;
    let t = model.projector_from_camera.translation;
    // The column as the plane through the projector's centre and the light at (column, row) along the panel's y axis. A
    // distorted column is no plane: its part at the row that the point is lit from.
    let mut row = row;
    for _ in 0..ROUNDS_ON_A_CURVED_COLUMN {
        let light = projector.bearing(Point2::new(column, row))?;
        let s = -(t.x - light.x * t.z) / (ray.x - light.x * ray.z);
        if !(s.is_finite() && s > 0.0) {
            return None;
        }
        if projector.distortion.is_none() {
            return Some(s);
        }
        let next = projector.project(&Point3::from(ray * s + t))?.y;
        if (next - row).abs() < 1e-9 * f64::from(projector.height) {
            return Some(s);
        }
        row = next;
    }
    None
}

/// 1σ along the camera's ray of a point at the middle of the sheet, the root mean square over the views.
fn expected_point_sigma(layout: &Layout, fit: &Fit, sizes: &[RectangleSize]) -> Option<f64> {
    rms(fit
        .model
        .views
        .iter()
        .zip(sizes)
        .filter_map(|(pose, size)| sigma_at_middle(layout, fit, pose, *size)))
}

/// 1σ along the camera's ray of a point at the middle of a sheet, from stripe noise and the rig's covariance, to first
/// order.
fn sigma_at_middle(layout: &Layout, fit: &Fit, pose: &Pose, size: RectangleSize) -> Option<f64> {
    let model = &fit.model;
    let middle = pose.transform(&Point3::new(size.width_mm / 2.0, size.height_mm / 2.0, 0.0));
    let pixel = model.camera.project(&middle)?;
    let lit = model.projector.as_ref()?.project(&model.projector_from_camera.transform(&middle))?;
    let length = model.camera.bearing(pixel)?.norm();
    let depth = |m: &Model, shift: f64| {
        depth_on_column(m, Point2::new(pixel.x + shift, pixel.y), lit.x, lit.y).map(|s| s * length)
    };
    let slope = (depth(model, 0.5)? - depth(model, -0.5)?) * STRIPE_NOISE_PX;
    // The poses of the sheet play no part.
    let devices = Model { views: Vec::new(), ..model.clone() };
    let mut gradient = DVector::zeros(layout.views);
    for i in 0..layout.views {
        // A small part of the parameter's own σ: far above rounding, far below curvature.
        let h = 1e-3 * fit.covariance[(i, i)].sqrt();
        if h > 0.0 {
            let mut delta = DVector::zeros(layout.views);
            delta[i] = h;
            let (up, down) = (devices.moved(layout, &delta)?, devices.moved(layout, &-delta)?);
            gradient[i] = (depth(&up, 0.0)? - depth(&down, 0.0)?) / (2.0 * h);
        }
    }
    let of_rig =
        gradient.dot(&(fit.covariance.view((0, 0), (layout.views, layout.views)) * &gradient)).max(0.0);
    let sigma = (of_rig + slope * slope).sqrt();
    sigma.is_finite().then_some(sigma)
}
