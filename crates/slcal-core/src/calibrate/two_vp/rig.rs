//! A rig by the method of two vanishing points (see `two_vp`), with σ from the noise of what was measured, the method's
//! own assumptions taken as exact, and a check of the result against what was seen.

use nalgebra::{Point2, Vector2};

use super::closed_form::{Input, Output, Quad, closed_form};
use super::sigma::{SHIFT, TURN, corner_modes, sigmas};
use crate::calibrate::build_rig::{projected_corners, view as view_of_rig};
use crate::calibrate::config::CalibrateConfig;
use crate::calibrate::diagnostics::advice::percent;
use crate::calibrate::initial_guess::robust_homography;
use crate::calibrate::report::CalibrationReport;
use crate::error::{Error, ErrorSubject, Result};
use crate::estimate::planar_pose::sheet_corners;
use crate::estimate::{Model, Sheet};
use crate::geometry::{Camera, Homography};
use crate::observations::{CornerPair, Observations, SheetObservation, ViewObservation};
use crate::rig::{Device, DeviceSigma, Projector, Quality, Rig, StereoPose, Verdict, ViewRms, Warning};
use crate::solve::rms;

/// At residuals this many times the noise, the assumptions (centred principal points, no distortion) do not hold.
const MISFIT: f64 = 10.0;

const ADVICE: &str = "use the maximum-likelihood method: its σ covers principal points and distortion";
const ADVICE_WEAK: &str = "tilt the sheet about both axes, or use the maximum-likelihood method";

/// A known camera's pixel as one of square pixels without distortion and skew, of the same fx and principal point.
fn square_pixel(known: Option<&Camera>, p: Point2<f64>) -> Option<Point2<f64>> {
    let Some(c) = known else { return Some(p) };
    c.undistort(p).map(|x| c.intrinsics.principal_point() + x * c.intrinsics.fx)
}

fn squared(view: &ViewObservation, known: Option<&Camera>) -> Result<ViewObservation> {
    let beyond =
        || Error::invalid("observed points", "pixels inside the range of the lens model", "pixels beyond it");
    let mut view = view.clone();
    match &mut view.sheet {
        SheetObservation::Corners { corners, .. } => {
            for c in corners {
                *c = square_pixel(known, *c).ok_or_else(beyond)?;
            }
        }
        SheetObservation::Edges(sides) => {
            for p in sides.iter_mut().flatten() {
                p.position = square_pixel(known, p.position).ok_or_else(beyond)?;
            }
        }
    }
    for p in &mut view.pairs {
        p.camera = square_pixel(known, p.camera).ok_or_else(beyond)?;
    }
    Ok(view)
}

/// The extent of the pattern in the projector, and where the homography puts it in the camera image.
fn outline(view: &ViewObservation) -> Result<(Quad, Quad, Homography)> {
    let pairs: Vec<_> = view.pairs.iter().map(|p| (p.projector, p.camera)).collect();
    let camera_from_projector = robust_homography(&pairs)?;
    let range = |get: fn(&Point2<f64>) -> f64| {
        let values = pairs.iter().map(|p| get(&p.0));
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
    };
    let ((x0, x1), (y0, y1)) = (range(|p| p.x), range(|p| p.y));
    let drawn = [Point2::new(x0, y0), Point2::new(x1, y0), Point2::new(x1, y1), Point2::new(x0, y1)];
    let mut seen = drawn;
    for p in &mut seen {
        *p = camera_from_projector.map(*p).ok_or_else(|| {
            Error::invalid("the projected pattern", "an outline in the image", "a corner at infinity")
        })?;
    }
    Ok((seen, drawn, camera_from_projector))
}

/// The rig by two vanishing points.
pub(crate) fn calibrate(
    observations: &Observations,
    config: &CalibrateConfig,
) -> Result<(Rig, CalibrationReport)> {
    let [view] = observations.views.as_slice() else {
        return Err(Error::invalid(
            "photographs for the two-vp method",
            "exactly one view (the maximum-likelihood method takes any number)",
            observations.views.len(),
        ));
    };
    let known = config.known_camera.as_ref();
    let view = squared(view, known)?;
    let panel = observations.projector;
    let seen = panel.map(|_| outline(&view)).transpose()?;
    let input = Input {
        corners: sheet_corners(&view, None)?,
        outline: seen.map(|(seen, drawn, _)| (seen, drawn)),
        size: view.size,
        camera: observations.camera,
        camera_pp: known
            .map_or(config.camera_pp.start(observations.camera), |c| c.intrinsics.principal_point()),
        known_focal: known.map(|c| c.intrinsics.fx),
        projector: panel.map(|p| (p, config.projector_pp.start(p))),
    };
    let output = closed_form(&input)?;
    let sigma = sigmas(&input, &output, &view);
    assessed(&input, &output, &sigma, &view, config)
}

/// Reprojection in camera pixels: rms of the sheet's corners and of the pairs, and of the pairs in projector pixels.
fn reprojection(output: &Output, input: &Input, view: &ViewObservation) -> ViewRms {
    let sheet = Sheet::flat(output.sheet, input.size);
    let corners = projected_corners(&output.camera, &sheet);
    let edges = rms(corners.iter().zip(&input.corners).map(|(a, b)| (a - b).norm())).unwrap_or(0.0);
    let Some((projector, projector_from_camera)) = output.projector else {
        return ViewRms { edges, corners: None, projector: None };
    };
    let camera = output.camera;
    let model = Model { camera, projector: Some(projector), projector_from_camera, views: Vec::new() };
    let far = f64::from(input.camera[0].max(input.camera[1]));
    let of_pair = |p: &CornerPair| {
        let lit = model.lit(&sheet, p.projector);
        // Light that misses the sheet's plane altogether is as wrong as the image is wide.
        lit.and_then(|x| camera.project(&x)).map_or(far, |q| (q - p.camera).norm())
    };
    let on_panel =
        view.pairs.iter().filter_map(|p| Some((model.on_panel(&sheet, p.camera)? - p.projector).norm()));
    ViewRms { edges, corners: rms(view.pairs.iter().map(of_pair)), projector: rms(on_panel) }
}

/// What the method's assumptions make wrong, where that is seen; and whether it is the sheet that does not fit.
fn misfit(found: &ViewRms, view: &ViewObservation, input: &Input) -> Option<Warning> {
    let sheet = match &view.sheet {
        SheetObservation::Corners { sigma_px, .. } => sigma_px.unwrap_or(0.0),
        SheetObservation::Edges(_) => {
            let modes = corner_modes(view, &input.corners);
            (modes.iter().flatten().map(Vector2::norm_squared).sum::<f64>() / 8.0).sqrt()
        }
    };
    let noise = view.pairs.iter().filter_map(|p| p.sigma_px).fold(sheet, f64::max);
    let pairs = found.corners.unwrap_or(0.0);
    if found.edges.max(pairs) <= MISFIT * noise {
        return None;
    }
    let (name, off, why, advice) = if found.edges > MISFIT * noise {
        (
            "sheet's corners",
            found.edges,
            "the sheet's size is not as given, or the camera's principal point is not where it was assumed",
            "check width and height of the sheet, or use the maximum-likelihood method",
        )
    } else {
        (
            "projected corners",
            pairs,
            "the projector's principal point is not where it was assumed (lens shift is usual)",
            "use the maximum-likelihood method, or give the projector's principal point",
        )
    };
    Some(Warning::new(
        "two-vp-misfit",
        format!(
            "this result is wrong: by it the {name} should lie {off:.1} px (rms) from where they were seen, and noise \
             explains {noise:.2} px; {why}"
        ),
        advice,
    ))
}

fn assessed(
    input: &Input,
    output: &Output,
    sigma: &[f64; 8],
    view: &ViewObservation,
    config: &CalibrateConfig,
) -> Result<(Rig, CalibrationReport)> {
    let known = config.known_camera;
    let camera_sigma = if known.is_some() { 0.0 } else { sigma[0] };
    let projector_sigma = output.projector.as_ref().map(|_| sigma[1]);
    let worst = camera_sigma.max(projector_sigma.unwrap_or(0.0));
    let found = reprojection(output, input, view);
    let mut verdict = Verdict::of_focal_sigma(worst);
    let mut cause = format!(
        "σ of the focal length by two vanishing points is {}, with principal points taken as exact",
        percent(worst)
    );
    let mut warnings = vec![Warning::new(
        "two-vp-assumptions",
        "σ is the measured points' noise propagated through the method; that principal points are exact and lenses \
         undistorted is assumed, not checked"
            .into(),
        ADVICE,
    )];
    let advice = if verdict <= Verdict::Fair { ADVICE } else { ADVICE_WEAK }.to_owned();
    if let Some(w) = misfit(&found, view, input) {
        verdict = verdict.max(Verdict::Weak);
        cause = format!("what was seen does not fit this result; {cause} and the misfit left out");
        warnings.insert(0, w);
    }
    if verdict == Verdict::Degenerate && !config.allow_degenerate {
        let advice = format!("{cause}; {advice}");
        return Err(Error::Degenerate {
            what: ErrorSubject::FocalLength,
            measure: worst,
            limit: Verdict::WEAK_BELOW,
            advice,
        });
    }
    let quality = Quality {
        verdict,
        focal_sigma_percent_camera: 100.0 * camera_sigma,
        focal_sigma_percent_projector: projector_sigma.map(|s| 100.0 * s),
        depth_sigma_percent: None,
        expected_point_sigma_mm: None,
        cause: cause.clone(),
        advice: advice.clone(),
        warnings,
        assumptions: Vec::new(),
    };
    let rig = assemble(output, sigma, input, found, known, quality);
    Ok((rig, CalibrationReport { iterations: 0, edge_inliers: 1.0, corner_inliers: 1.0, cause, advice }))
}

fn assemble(
    output: &Output,
    sigma: &[f64; 8],
    input: &Input,
    found: ViewRms,
    known: Option<Camera>,
    quality: Quality,
) -> Rig {
    let device = |model: Camera, s: f64| Device {
        sigma: Some(DeviceSigma {
            focal_px: s * model.intrinsics.fx,
            cx_px: 0.0,
            cy_px: 0.0,
            distortion: [0.0; 5],
            aspect: 0.0,
        }),
        model,
    };
    let camera_sigma = if known.is_some() { 0.0 } else { sigma[0] };
    let camera = known.unwrap_or(output.camera);
    let projector = output.projector.map(|(model, pose)| Projector {
        device: device(model, sigma[1]),
        from_camera: StereoPose {
            pose,
            sigma_r_rad: Some(std::array::from_fn(|k| sigma[TURN + k])),
            sigma_t_mm: Some(std::array::from_fn(|k| sigma[SHIFT + k])),
        },
        mirrored: false,
    });
    Rig {
        camera: device(camera, camera_sigma),
        projector,
        views: vec![view_of_rig(
            &camera,
            projector.as_ref(),
            &Sheet::flat(output.sheet, input.size),
            None,
            found,
        )],
        method: "two-vp".into(),
        quality: Some(quality),
        covariance: None,
        channel_registration: None,
    }
}
