//! A rig by the method of two vanishing points (see `two_vp`), with σ from the noise of what was measured, the method's
//! own assumptions taken as exact, and a check of the result against what was seen.

use nalgebra::{DMatrix, Point2, Vector3};

use super::advice::percent;
use super::assemble::{projected_corners, projector_distance, rms, vanishing_points as images_of_axes};
use super::config::CalibrateConfig;
use super::model::principal_point;
use super::residual::lit_point;
use super::start::{robust_homography, sheet_corners};
use super::two_vp::{focal, pose, rectified_pattern, vanishing_points, vanishing_points_of_quad};
use super::verdict::{WEAK, verdict, warning};
use super::{Calibration, CalibrationReport};
use crate::error::{Error, Result};
use crate::geometry::{Camera, Distortion, Homography, Intrinsics, Line, Pose, RectangleSize};
use crate::observations::{Observations, SheetObservation, ViewObservation};
use crate::rig::{Device, DeviceSigma, Quality, Rig, StereoPose, Verdict, View, ViewRms, Warning};
use crate::solve::{covariance, homography_from_points};

type Quad = [Point2<f64>; 4];

/// Residuals this many times the noise say that the assumptions (centred principal points, no distortion) do not hold.
const MISFIT: f64 = 10.0;
/// σ of a focal length that a small change of the measurements already makes imaginary (1000 %).
const NO_KNOWLEDGE: f64 = 10.0;
/// Part of a mode's σ by which it is displaced to differentiate.
const STEP: f64 = 0.05;

/// What the closed form starts from, in square, undistorted camera pixels.
#[derive(Clone)]
struct Input {
    corners: Quad,
    /// The pattern's outer corners in the camera image (through the homography) and in the projector.
    outline: Option<(Quad, Quad)>,
    size: RectangleSize,
    camera: [u32; 2],
    camera_pp: Point2<f64>,
    known_focal: Option<f64>,
    projector: Option<([u32; 2], Point2<f64>)>,
}

/// What it answers.
struct Output {
    camera: Camera,
    sheet: Pose,
    projector: Option<(Camera, Pose)>,
}

fn pinhole([width, height]: [u32; 2], f: f64, pp: Point2<f64>) -> Camera {
    Camera { width, height, intrinsics: Intrinsics::square(f, pp), distortion: Distortion::NONE }
}

/// The published method.
fn closed_form(input: &Input) -> Result<Output> {
    let v = vanishing_points_of_quad(&input.corners);
    let f = match input.known_focal {
        Some(f) => f,
        None => focal(&v, input.camera_pp, "camera")?,
    };
    let camera = pinhole(input.camera, f, input.camera_pp);
    let sheet = pose(&camera, &v, &input.corners, input.size)?;
    let (Some((panel, pp)), Some((seen, drawn))) = (input.projector, input.outline) else {
        return Ok(Output { camera, sheet, projector: None });
    };
    let pairs: Vec<_> = seen.into_iter().zip(drawn).collect();
    let projector_from_camera = homography_from_points(&pairs)?;
    let v = vanishing_points(&rectified_pattern(&seen, &v, &projector_from_camera));
    let projector = pinhole(panel, focal(&v, pp, "projector")?, pp);
    let mut corners = input.corners;
    for c in &mut corners {
        *c = projector_from_camera.map(*c).ok_or_else(|| {
            Error::invalid("the sheet in the projector's image", "finite corners", "a corner at infinity")
        })?;
    }
    let projector_from_sheet = pose(&projector, &v, &corners, input.size)?;
    Ok(Output { camera, sheet, projector: Some((projector, projector_from_sheet.compose(&sheet.inverse()))) })
}

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

/// Independent displacements of the four corners, each of one σ.
fn corner_modes(view: &ViewObservation, corners: &Quad) -> Vec<[nalgebra::Vector2<f64>; 4]> {
    let mut modes = Vec::new();
    match &view.sheet {
        SheetObservation::Corners { sigma_px, .. } => {
            for i in 0..8 {
                let mut mode = [nalgebra::Vector2::zeros(); 4];
                mode[i / 2][i % 2] = *sigma_px;
                modes.push(mode);
            }
        }
        SheetObservation::Edges(sides) => {
            for (i, points) in sides.iter().enumerate() {
                modes.extend(side_modes(i, points, corners));
            }
        }
    }
    modes
}

/// The offset and the slope of one side, as displacements of its two corners along the neighbouring sides.
fn side_modes(
    side: usize,
    points: &[crate::observations::EdgePoint],
    corners: &Quad,
) -> Vec<[nalgebra::Vector2<f64>; 4]> {
    let (from, to) = (side, (side + 1) % 4);
    let along = corners[to] - corners[from];
    let place = |p: &Point2<f64>| (p - corners[from]).dot(&along) / along.norm_squared();
    let weight: f64 = points.iter().map(|p| p.sigma_px.powi(-2)).sum();
    let mean = points.iter().map(|p| p.sigma_px.powi(-2) * place(&p.position)).sum::<f64>() / weight;
    let spread: f64 = points.iter().map(|p| p.sigma_px.powi(-2) * (place(&p.position) - mean).powi(2)).sum();
    let line = |a, b| Line::through_pixels(a, b);
    let normal = nalgebra::Vector2::new(-along.y, along.x).normalize();
    let moved = |at_from: f64, at_to: f64| -> Option<[nalgebra::Vector2<f64>; 4]> {
        let shifted = line(corners[from] + normal * at_from, corners[to] + normal * at_to);
        let before = line(corners[(side + 3) % 4], corners[from]);
        let after = line(corners[to], corners[(side + 2) % 4]);
        let mut mode = [nalgebra::Vector2::zeros(); 4];
        mode[from] = before.meet(shifted).pixel()? - corners[from];
        mode[to] = shifted.meet(after).pixel()? - corners[to];
        Some(mode)
    };
    let (offset, slope) = (weight.sqrt().recip(), spread.sqrt().recip());
    let modes = [moved(offset, offset), moved(-mean * slope, (1.0 - mean) * slope)];
    modes.into_iter().flatten().collect()
}

/// Independent displacements of the outline's corners that stand for the noise of all pairs.
fn outline_modes(
    view: &ViewObservation,
    seen: &Quad,
    drawn: &Quad,
) -> Option<Vec<[nalgebra::Vector2<f64>; 4]>> {
    let map =
        |seen: &Quad| homography_from_points(&drawn.iter().copied().zip(*seen).collect::<Vec<_>>()).ok();
    let n = view.pairs.len();
    let mut j = DMatrix::zeros(2 * n, 8);
    let h = 1e-3;
    for c in 0..8 {
        let at = |s: f64| {
            let mut moved = *seen;
            moved[c / 2][c % 2] += s * h;
            map(&moved)
        };
        let (up, down) = (at(1.0)?, at(-1.0)?);
        for (i, p) in view.pairs.iter().enumerate() {
            let d = (up.map(p.projector)? - down.map(p.projector)?) / (2.0 * h * p.sigma_px);
            j[(2 * i, c)] = d.x;
            j[(2 * i + 1, c)] = d.y;
        }
    }
    let factor = covariance(&j)?.cholesky()?.l();
    let modes =
        factor.column_iter().map(|l| std::array::from_fn(|k| nalgebra::Vector2::new(l[2 * k], l[2 * k + 1])));
    Some(modes.collect())
}

/// ln f of both devices, then rotation and translation between them, as displacements from `base`.
fn difference(a: &Output, base: &Output) -> [f64; 8] {
    let mut d = [0.0; 8];
    d[0] = (a.camera.intrinsics.fx / base.camera.intrinsics.fx).ln();
    if let (Some((k, pose)), Some((k0, pose0))) = (&a.projector, &base.projector) {
        d[1] = (k.intrinsics.fx / k0.intrinsics.fx).ln();
        let turn = (pose.rotation * pose0.rotation.inverse()).scaled_axis();
        let shift: Vector3<f64> = pose.translation - pose0.translation;
        d[2..5].copy_from_slice(turn.as_slice());
        d[5..8].copy_from_slice(shift.as_slice());
    }
    d
}

/// 1σ of what [`difference`] lists.
fn sigmas(input: &Input, base: &Output, view: &ViewObservation) -> [f64; 8] {
    let mut inputs = Vec::new();
    let displaced = |q: &Quad, mode: &[nalgebra::Vector2<f64>; 4], s: f64| -> Quad {
        std::array::from_fn(|i| q[i] + mode[i] * s)
    };
    for mode in corner_modes(view, &input.corners) {
        inputs.push(
            [STEP, -STEP].map(|s| Input { corners: displaced(&input.corners, &mode, s), ..input.clone() }),
        );
    }
    if let Some((seen, drawn)) = &input.outline {
        for mode in outline_modes(view, seen, drawn).unwrap_or_default() {
            inputs.push(
                [STEP, -STEP]
                    .map(|s| Input { outline: Some((displaced(seen, &mode, s), *drawn)), ..input.clone() }),
            );
        }
    }
    let mut variance = [0.0; 8];
    for [up, down] in inputs {
        match (closed_form(&up), closed_form(&down)) {
            (Ok(up), Ok(down)) => {
                let (a, b) = (difference(&up, base), difference(&down, base));
                for k in 0..8 {
                    variance[k] += ((a[k] - b[k]) / (2.0 * STEP)).powi(2);
                }
            }
            _ => variance.iter_mut().for_each(|v| *v += NO_KNOWLEDGE * NO_KNOWLEDGE),
        }
    }
    variance.map(|v: f64| if v.is_finite() { v.sqrt().min(NO_KNOWLEDGE * 1e3) } else { NO_KNOWLEDGE })
}

/// The rig by two vanishing points.
pub(crate) fn calibrate(observations: &Observations, config: &CalibrateConfig) -> Result<Calibration> {
    let [view] = observations.views.as_slice() else {
        return Err(Error::invalid(
            "photographs for the two-vp method",
            "exactly one view (the maximum-likelihood method takes any number)",
            observations.views.len(),
        ));
    };
    let known = config.known_camera.as_ref();
    let view = squared(view, known)?;
    let [w, h] = observations.camera;
    let panel = observations.projector;
    let seen = panel.map(|_| outline(&view)).transpose()?;
    let input = Input {
        corners: sheet_corners(&view, None)?,
        outline: seen.map(|(seen, drawn, _)| (seen, drawn)),
        size: view.size,
        camera: observations.camera,
        camera_pp: known.map_or(principal_point(config.camera_pp, w, h), |c| c.intrinsics.principal_point()),
        known_focal: known.map(|c| c.intrinsics.fx),
        projector: panel.map(|p| (p, principal_point(config.projector_pp, p[0], p[1]))),
    };
    let output = closed_form(&input)?;
    let sigma = sigmas(&input, &output, &view);
    judge(&input, &output, &sigma, &view, config)
}

/// Reprojection in camera pixels: rms of the sheet's corners and of the pairs, and of the pairs in projector pixels.
fn reprojection(output: &Output, input: &Input, view: &ViewObservation) -> ViewRms {
    let corners = projected_corners(&output.camera, &output.sheet, input.size);
    let edges = rms(corners.iter().zip(&input.corners).map(|(a, b)| (a - b).norm())).unwrap_or(0.0);
    let Some((projector, stereo)) = &output.projector else {
        return ViewRms { edges, corners: None, projector: None };
    };
    let far = f64::from(input.camera[0].max(input.camera[1]));
    let of_pair = |p: &crate::observations::CornerPair| {
        let lit = lit_point(projector, stereo, &output.sheet, p.projector);
        // Light that misses the sheet's plane altogether is as wrong as the image is wide.
        lit.and_then(|x| output.camera.project(&x)).map_or(far, |q| (q - p.camera).norm())
    };
    let on_panel = view.pairs.iter().filter_map(|p| {
        projector_distance(&output.camera, projector, stereo, &output.sheet, p.camera, p.projector)
    });
    ViewRms { edges, corners: rms(view.pairs.iter().map(of_pair)), projector: rms(on_panel) }
}

fn misfit(found: &ViewRms, view: &ViewObservation, input: &Input) -> Option<Warning> {
    let sheet = match &view.sheet {
        SheetObservation::Corners { sigma_px, .. } => *sigma_px,
        SheetObservation::Edges(_) => {
            let modes = corner_modes(view, &input.corners);
            (modes.iter().flatten().map(nalgebra::Vector2::norm_squared).sum::<f64>() / 8.0).sqrt()
        }
    };
    let noise = view.pairs.iter().map(|p| p.sigma_px).fold(sheet, f64::max);
    let worst = found.edges.max(found.corners.unwrap_or(0.0));
    (worst > MISFIT * noise).then(|| {
        warning(
            "two-vp-misfit",
            format!(
                "reprojected, the sheet's corners lie {:.2} px and the projected corners {:.2} px from where they were \
                 seen, where noise explains {noise:.2} px: the assumptions of the method do not hold here, and the \
                 focal lengths may be far off",
                found.edges,
                found.corners.unwrap_or(0.0)
            ),
            "use the maximum-likelihood method, or give the projector's principal point (lens shift is usual)",
        )
    })
}

fn judge(
    input: &Input,
    output: &Output,
    sigma: &[f64; 8],
    view: &ViewObservation,
    config: &CalibrateConfig,
) -> Result<Calibration> {
    let known = config.known_camera;
    let camera_sigma = if known.is_some() { 0.0 } else { sigma[0] };
    let projector_sigma = output.projector.as_ref().map(|_| sigma[1]);
    let worst = camera_sigma.max(projector_sigma.unwrap_or(0.0));
    let found = reprojection(output, input, view);
    let mut verdict = verdict(worst);
    let cause = format!(
        "σ of the focal length by two vanishing points is {}, with principal points taken as exact",
        percent(worst)
    );
    let mut warnings = vec![warning(
        "two-vp-assumptions",
        "σ is the measured points' noise propagated through the method; that principal points are exact and lenses \
         undistorted is assumed, not checked"
            .into(),
        "use the maximum-likelihood method for σ that covers these",
    )];
    if let Some(w) = misfit(&found, view, input) {
        warnings.insert(0, w);
        verdict = verdict.max(Verdict::Weak);
    }
    let advice = "tilt the sheet about both axes, or use the maximum-likelihood method".to_owned();
    if verdict == Verdict::Degenerate && !config.allow_degenerate {
        let advice = format!("{cause}; {advice}");
        return Err(Error::Degenerate { what: "the focal length", measure: worst, limit: WEAK, advice });
    }
    let rig = assemble(output, sigma, input, found, known, verdict, warnings);
    Ok(Calibration {
        rig,
        report: CalibrationReport { iterations: 0, edge_inliers: 1.0, corner_inliers: 1.0, cause, advice },
    })
}

fn assemble(
    output: &Output,
    sigma: &[f64; 8],
    input: &Input,
    found: ViewRms,
    known: Option<Camera>,
    verdict: Verdict,
    warnings: Vec<Warning>,
) -> Rig {
    let device = |model: Camera, s: f64| Device {
        sigma: Some(DeviceSigma {
            focal_px: s * model.intrinsics.fx,
            cx_px: 0.0,
            cy_px: 0.0,
            distortion: [0.0; 5],
        }),
        model,
    };
    let camera_sigma = if known.is_some() { 0.0 } else { sigma[0] };
    let camera = known.unwrap_or(output.camera);
    let stereo = output.projector.map(|(_, pose)| StereoPose {
        projector_from_camera: pose,
        sigma_r_rad: Some([sigma[2], sigma[3], sigma[4]]),
        sigma_t_mm: Some([sigma[5], sigma[6], sigma[7]]),
    });
    let projector_from_sheet = output.projector.map(|(_, pose)| pose.compose(&output.sheet));
    Rig {
        camera: device(camera, camera_sigma),
        projector: output.projector.map(|(p, _)| device(p, sigma[1])),
        stereo,
        views: vec![View {
            photo: None,
            size: input.size,
            camera_from_sheet: output.sheet,
            projector_from_sheet,
            camera_vanishing_points: images_of_axes(&camera, &output.sheet),
            projector_vanishing_points: output
                .projector
                .zip(projector_from_sheet)
                .map(|((p, _), pose)| images_of_axes(&p, &pose)),
            corners_px: projected_corners(&camera, &output.sheet, input.size),
            rms_px: Some(found),
        }],
        method: "two-vp".into(),
        quality: Some(Quality {
            verdict,
            focal_sigma_percent_camera: 100.0 * camera_sigma,
            focal_sigma_percent_projector: output.projector.map(|_| 100.0 * sigma[1]),
            expected_point_sigma_mm: None,
            warnings,
        }),
        covariance: None,
    }
}
