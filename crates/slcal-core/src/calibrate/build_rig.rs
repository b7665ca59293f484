//! A solution as a [`Rig`]: devices with σ, views with vanishing points and residuals, quality, covariance.

use nalgebra::Point2;

use crate::assumption::Assumption;
use crate::calibrate::diagnostics::verdict::Assessment;
use crate::estimate::{Kind, Lens, Sheet, Solution, Target, covariance};
use crate::geometry::Camera;
use crate::parameter::LensParameter;
use crate::rig::{Device, DeviceSigma, Projector, Quality, Rig, StereoPose, View, ViewBend, ViewRms};
use crate::solve::rms;

fn device(model: Camera, lens: Lens, solution: &Solution) -> Device {
    let [focal, cx_px, cy_px, distortion @ .., aspect] =
        LensParameter::ALL.map(|p| solution.sigma(lens, p).unwrap_or(0.0));
    let sigma = DeviceSigma { focal_px: focal * model.intrinsics.fx, cx_px, cy_px, distortion, aspect };
    Device { model, sigma: Some(sigma) }
}

/// The sheet's corners in a device's image; those behind it (which a calibrated view never has) at the principal point.
pub(crate) fn projected_corners(device: &Camera, sheet: &Sheet) -> [Point2<f64>; 4] {
    let corners = sheet.size.corners();
    corners.map(|c| device.project(&sheet.lift_fixed(c)).unwrap_or(device.intrinsics.principal_point()))
}

fn view_rms(solution: &Solution, view: usize) -> ViewRms {
    let model = solution.model();
    let kept = || solution.measured().filter(move |(m, _, keep)| *keep && m.view == view);
    let sheet = kept().filter(|(m, ..)| m.kind() != Kind::Pair).map(|(_, norm, _)| norm);
    let pairs = kept().filter(|(m, ..)| m.kind() == Kind::Pair).map(|(_, norm, _)| norm);
    let on_panel = kept().filter_map(|(m, ..)| match m.of {
        Target::Pair(q) => Some((model.on_panel(&model.views[view], m.seen)? - q).norm()),
        _ => None,
    });
    ViewRms { edges: rms(sheet).unwrap_or(0.0), corners: rms(pairs), projector: rms(on_panel) }
}

/// A view of a rig without its photograph.
pub(crate) fn view(
    camera: &Camera,
    projector: Option<&Projector>,
    sheet: &Sheet,
    bend: Option<&ViewBend>,
    rms_px: ViewRms,
) -> View {
    let pose = &sheet.pose;
    let projector_from_sheet = projector.map(|p| p.from_camera.pose.compose(pose));
    View {
        photo: None,
        size: sheet.size,
        camera_from_sheet: *pose,
        bend: bend.copied(),
        projector_from_sheet,
        camera_vanishing_points: camera.vanishing_points(pose),
        projector_vanishing_points: projector
            .zip(projector_from_sheet)
            .map(|(p, pose)| p.device.model.vanishing_points(&pose)),
        corners_px: projected_corners(camera, sheet),
        rms_px: Some(rms_px),
        clipped_percent: None,
    }
}

fn bend(solution: &Solution, view: usize) -> Option<ViewBend> {
    let at = solution.problem.unknowns.bend(view)?;
    Some(ViewBend {
        shape: solution.model().views[view].bend,
        sigma_mm: std::array::from_fn(|k| solution.covariance[(at + k, at + k)].sqrt()),
        expected_mm: *solution.problem.priors.bends.get(view)?,
    })
}

/// The rig of a maximum-likelihood solution.
pub(crate) fn rig(solution: &Solution, assessment: &Assessment, assumptions: Vec<Assumption>) -> Rig {
    let (model, unknowns) = (solution.model(), &solution.problem.unknowns);
    let projector = model.projector.zip(unknowns.projector_from_camera()).map(|(p, at)| {
        let sigma = |i: usize| std::array::from_fn(|k| solution.covariance[(at + i + k, at + i + k)].sqrt());
        let pose = model.projector_from_camera;
        let from_camera = StereoPose { pose, sigma_t_mm: Some(sigma(3)), sigma_r_rad: Some(sigma(0)) };
        Projector { device: device(p, Lens::Projector, solution), from_camera, mirrored: false }
    });
    let views = model.views.iter().enumerate().map(|(i, sheet)| {
        view(&model.camera, projector.as_ref(), sheet, bend(solution, i).as_ref(), view_rms(solution, i))
    });
    let point_sigmas = solution.depth_sigmas().map(|s| s.total());
    let percent = |s: f64| 100.0 * s;
    let (cause, advice) = assessment.why();
    Rig {
        camera: device(model.camera, Lens::Camera, solution),
        projector,
        views: views.collect(),
        method: "ml".into(),
        quality: Some(Quality {
            verdict: assessment.verdict,
            focal_sigma_percent_camera: percent(assessment.sigma.camera),
            focal_sigma_percent_projector: assessment.sigma.projector.map(percent),
            depth_sigma_percent: assessment.depth.map(percent),
            expected_point_sigma_mm: rms(point_sigmas),
            cause: cause.to_owned(),
            advice: advice.to_owned(),
            warnings: assessment.warnings.clone(),
            assumptions,
        }),
        covariance: Some(covariance::to_rig(&solution.covariance, unknowns, model)),
        channel_registration: None,
    }
}
