//! The maximum-likelihood method: closed-form start, camera and poses first, then everything together.

use crate::calibrate::config::CalibrateConfig;
use crate::calibrate::initial_guess::{camera_starts, projector_starts};
use crate::error::{Error, ErrorSubject, Result};
use crate::estimate::model::{Layout, Model, priors};
use crate::estimate::refine::{Fit, refine};
use crate::estimate::{Joint, Kind, Measurement, measurements};
use crate::geometry::RectangleSize;
use crate::observations::Observations;

/// A fit and the problem that it solves.
#[derive(Clone)]
pub(crate) struct Solved {
    pub(crate) joint: Joint,
    pub(crate) fit: Fit,
}

pub(crate) fn problem(observations: &Observations, config: &CalibrateConfig, model: &Model) -> Joint {
    let sizes: Vec<RectangleSize> = observations.views.iter().map(|v| v.size).collect();
    let with_projector = model.projector.is_some();
    let layout = Layout::new(config, with_projector, sizes.len());
    let priors = priors(config, &layout, model);
    let all: Vec<Measurement> =
        measurements(observations).into_iter().filter(|m| with_projector || m.kind() != Kind::Pair).collect();
    Joint::new(sizes, all, layout, priors)
}

/// The best refinement over several starts; a start that fails is passed over.
fn best(observations: &Observations, config: &CalibrateConfig, starts: Vec<Model>) -> Option<Solved> {
    let mut best: Option<Solved> = None;
    for start in starts {
        let mut joint = problem(observations, config, &start);
        if let Some(fit) = refine(&mut joint, start)
            && best.as_ref().is_none_or(|b| quality(&fit) < quality(&b.fit))
        {
            best = Some(Solved { joint, fit });
        }
    }
    best
}

/// What starts are compared by: outliers first lower a redescending cost, so those count as well.
fn quality(fit: &Fit) -> f64 {
    let outliers = fit.inliers.iter().filter(|k| !**k).count();
    fit.cost + 10.0 * outliers as f64
}

fn failed(complaint: Option<Error>, device: &'static str) -> Error {
    complaint.unwrap_or_else(|| Error::Degenerate {
        what: ErrorSubject::Calibration,
        measure: 0.0,
        limit: 0.0,
        advice: format!(
            "no model of the {device} explains what was seen: check the corners, their order and the sheet's size"
        ),
    })
}

/// Camera and poses, from the sheet alone.
pub(crate) fn solve_camera(observations: &Observations, config: &CalibrateConfig) -> Result<Solved> {
    let (starts, complaint) = camera_starts(observations, config)?;
    best(observations, config, starts).ok_or_else(|| failed(complaint, "camera"))
}

/// Everything together from a solved camera, when the observations have a projector.
pub(crate) fn add_projector(
    observations: &Observations,
    config: &CalibrateConfig,
    camera: &Solved,
) -> Result<Solved> {
    let Some(panel) = observations.projector else { return Ok(camera.clone()) };
    let (starts, complaint) = projector_starts(observations, config, panel, &camera.fit.model)?;
    let both = best(observations, config, starts).ok_or_else(|| failed(complaint, "projector"))?;
    Ok(Solved { fit: Fit { iterations: both.fit.iterations + camera.fit.iterations, ..both.fit }, ..both })
}

/// Camera, poses and, when the observations have one, the projector.
pub(crate) fn solve(observations: &Observations, config: &CalibrateConfig) -> Result<Solved> {
    add_projector(observations, config, &solve_camera(observations, config)?)
}
