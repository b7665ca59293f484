//! Observations → rig, in one call.

use super::config::{CalibrateConfig, Method};
use super::hypotheses::explain::explanations;
use super::hypotheses::shown_scale::shown_scale;
use super::hypotheses::told::{Told, told};
use super::maximum_likelihood::solve_in_steps;
use super::report::{Calibration, CalibrationReport};
use super::variance_components::{measure_noise, warning};
use super::{
    build_rig, channel_registration, diagnostics, hypotheses, repeated, sensitivity, two_vp, validate,
};
use crate::error::Result;
use crate::estimate::{Kind, Solution};
use crate::observations::Observations;
use crate::rig::{Rig, Verdict};

/// Calibrates camera and projector (the camera alone when `observations.projector` is `None`) from what was seen in one
/// photograph or several.
///
/// A σ that is not stated is measured by the residuals where there are enough of them, pooled over the views, and assumed
/// otherwise (with the warning `noise-assumed`). Of more than 4000 points of a side or pairs of a view an evenly spread
/// part is used.
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) for inconsistent observations (no view, NaN, σ not positive, collinear or
/// mirrored corners, fewer than four pairs with a projector, projector pixels off the panel);
/// [`Error::ImaginaryFocal`](crate::Error::ImaginaryFocal) when no real focal length explains the view;
/// [`Error::Degenerate`](crate::Error::Degenerate) when the predicted σ of a focal length is 25 % or more and
/// `config.allow_degenerate` is not set.
///
/// # Examples
/// ```
/// use slcal_core::nalgebra::{Point3, Rotation3, Vector3};
/// use slcal_core::{
///     CalibrateConfig, Camera, Distortion, Intrinsics, Observations, Pose, RectangleSize, SheetObservation, ViewObservation,
///     calibrate_observations,
/// };
///
/// // What a detector of one's own found: here the exact corners of an A2 sheet, seen tilted by a camera of f = 1500 px.
/// let size: RectangleSize = "A2-landscape".parse()?;
/// # let camera = Camera {
/// #     width: 1280,
/// #     height: 960,
/// #     intrinsics: Intrinsics::square(1500.0, Camera::image_centre(1280, 960)),
/// #     distortion: Distortion::NONE,
/// # };
/// # let pose = Pose {
/// #     rotation: Rotation3::from_euler_angles(0.5, -0.5, 0.0),
/// #     translation: Vector3::new(-240.0, -220.0, 1100.0),
/// # };
/// # let corners = size.corners().map(|c| camera.project(&pose.transform(&Point3::new(c.x, c.y, 0.0))).unwrap());
/// let sheet = SheetObservation::Corners { corners, sigma_px: Some(0.1) };
/// let view = ViewObservation { photo: None, size, sheet, pairs: Vec::new(), panel_points: Vec::new(), channel_offsets: Vec::new() };
/// let observations = Observations { camera: [1280, 960], projector: None, mirrored: false, views: vec![view] };
/// let calibration = calibrate_observations(&observations, &CalibrateConfig::default())?;
/// assert!((calibration.rig.camera.model.intrinsics.fx - 1500.0).abs() < 1.0);
/// # Ok::<(), slcal_core::Error>(())
/// ```
pub fn calibrate_observations(observations: &Observations, config: &CalibrateConfig) -> Result<Calibration> {
    validate::check(observations, config)?;
    let (observations, noise) = measure_noise(observations, config);
    let (mut rig, report) = match config.method {
        Method::Ml => maximum_likelihood(&observations, config),
        Method::TwoVp => two_vp::rig::calibrate(&observations, config),
    }?;
    if let Some(quality) = &mut rig.quality {
        quality.warnings.extend(hypotheses::centimetres::hint(&observations));
        quality.warnings.extend(noise.iter().filter_map(|n| warning(n, &observations)));
    }
    for (view, seen) in rig.views.iter_mut().zip(&observations.views) {
        view.photo.clone_from(&seen.photo);
    }
    if let Some(projector) = &mut rig.projector {
        projector.mirrored = observations.mirrored;
    }
    rig.channel_registration = channel_registration::fit(&rig, &observations);
    Ok(Calibration { rig, report, observations, noise })
}

fn maximum_likelihood(
    observations: &Observations,
    config: &CalibrateConfig,
) -> Result<(Rig, CalibrationReport)> {
    let (observations, repetition) = repeated::counted_once(observations);
    let (camera, stated) = match solve_in_steps(&observations, config) {
        Ok(solved) => solved,
        Err(error) => return Err(hypotheses::transposed::explain(error, &observations, config)),
    };
    // What is assumed of the observations is tested with the σ that they state.
    let (solution, told) = explained(&observations, config, &camera, &stated);
    let solution = &solution;
    let shown = shown_scale(&observations, solution);
    let mut assessment = diagnostics::verdict::assess(solution, config);
    assessment.warnings.extend(repetition);
    // The proportion as it is measured, beside the size that has it.
    let named = matches!(&told, Some(Told::Doubt(w)) if w.code == hypotheses::other_size::CODE);
    let measured = named.then(|| hypotheses::aspect::hint(&observations, config, solution)).flatten();
    assessment.warnings.extend(measured);
    match told {
        None => {}
        Some(Told::MadeGood(warnings)) => assessment.warnings.splice(0..0, warnings).for_each(drop),
        Some(Told::Doubt(warning)) => assessment.doubt(warning, Verdict::Weak),
        Some(Told::Contradiction(warning)) => assessment.doubt(warning, Verdict::Degenerate),
    }
    if let Some(doubt) = shown.as_ref().and_then(|shown| shown.hint(&observations)) {
        assessment.doubt(doubt, Verdict::Weak);
    }
    if assessment.is_refused() && !config.allow_degenerate {
        return Err(assessment.refusal());
    }
    let share = |kind| match solution.outliers(kind) {
        [_, 0] => 1.0,
        [out, all] => (all - out) as f64 / all as f64,
    };
    let (cause, advice) = assessment.why();
    let report = CalibrationReport {
        iterations: solution.fit.iterations,
        edge_inliers: share(Kind::Edge),
        corner_inliers: share(Kind::Pair),
        cause: cause.to_owned(),
        advice: advice.to_owned(),
    };
    Ok((
        build_rig::rig(solution, &assessment, sensitivity::assumptions(solution, config, shown.as_ref())),
        report,
    ))
}

/// The solution under what explains the photographs, if they ask for an explanation, with the weights that it asks for; and
/// what is to be told.
fn explained(
    observations: &Observations,
    config: &CalibrateConfig,
    camera: &Solution,
    stated: &Solution,
) -> (Solution, Option<Told>) {
    let learned = stated.clone().with_learned_weights();
    if let Some(doubt) = hypotheses::transposed::hint(observations, config, Some(camera)) {
        return (learned, Some(Told::Doubt(doubt)));
    }
    let proportion = || hypotheses::aspect::hint(observations, config, stated);
    let other_size = || hypotheses::other_size::hint(observations, config, Some(camera));
    match explanations(observations, config, stated, &learned).and_then(told) {
        Some((None, Told::Doubt(warning))) => {
            let measured = || proportion().filter(|w| w.code == warning.code);
            let better = other_size().or_else(measured);
            (learned, Some(Told::Doubt(better.unwrap_or(warning))))
        }
        Some((solution, told)) => (solution.unwrap_or(learned), Some(told)),
        None => {
            let contradiction = || hypotheses::contradiction::hint(observations, config, stated);
            let doubt = other_size().or_else(contradiction).or_else(proportion);
            (learned, doubt.map(Told::Doubt))
        }
    }
}
