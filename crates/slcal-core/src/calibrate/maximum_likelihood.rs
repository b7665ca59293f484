//! The maximum-likelihood method: closed-form start, camera and poses first, then everything together.

use crate::calibrate::config::CalibrateConfig;
use crate::calibrate::initial_guess::{camera_starts, projector_starts};
use crate::calibrate::repeated::copies;
use crate::error::{Error, ErrorSubject, Result};
use crate::estimate::robust::RobustFit;
use crate::estimate::{
    BundleAdjustment, Kind, Measurement, Model, Priors, Sheet, Solution, Unknowns, measurements,
};
use crate::observations::Observations;

/// A sheet that bends by more than this part of its diagonal from valley to peak is none: another size or wrong corners are
/// explained by it.
const MOST_BENT: f64 = 0.08;
/// The part of their σ that bends have of sheets that are nearly flat.
const STIFF: f64 = 0.01;

/// The problem that observations pose under a configuration; without a projector in the model, that of the camera alone.
pub(crate) fn problem(
    observations: &Observations,
    config: &CalibrateConfig,
    model: &Model,
) -> BundleAdjustment {
    let with_projector = model.projector.is_some();
    let assumptions = config.assumptions();
    let unknowns = Unknowns::new(&assumptions, with_projector, model.views.len());
    let mut priors = Priors::new(&assumptions, &unknowns, model);
    // Copies of a photograph show one bend, not several.
    for (bend, copies) in priors.bends.iter_mut().zip(copies(observations)) {
        for sigma in bend {
            *sigma *= (copies as f64).sqrt();
        }
    }
    let all: Vec<Measurement> =
        measurements(observations).into_iter().filter(|m| with_projector || m.kind() != Kind::Pair).collect();
    BundleAdjustment::new(all, unknowns, priors)
}

/// The best refinement over several starts; a start that fails is passed over. Where lens or sheet had to be bent, the starts are
/// tried again with sheets that are nearly flat at first: a bend may take up what another pose explains.
fn best(observations: &Observations, config: &CalibrateConfig, starts: &[Model]) -> Option<Solution> {
    let refined = |start: &Model| Solution::refine(problem(observations, config, start), start.clone());
    let first = lowest(starts.iter().filter_map(refined));
    if first.as_ref().is_some_and(|s| s.problem.priors.hold(s.model())) {
        return first;
    }
    let stiff = |start: &Model| {
        let mut stiff = problem(observations, config, start);
        stiff.priors.bends.iter_mut().flatten().for_each(|sigma| *sigma *= STIFF);
        Some(Solution::refine(stiff, start.clone())?.fit.state)
    };
    let again = starts.iter().filter_map(stiff).filter_map(|start| refined(&start));
    lowest(first.into_iter().chain(again))
}

/// Of those that tie, the first one; one whose sheets are none only where there is no other.
fn lowest(solutions: impl Iterator<Item = Solution>) -> Option<Solution> {
    let rank = |s: &Solution| (!s.model().views.iter().all(is_a_sheet), penalised_cost(&s.fit));
    solutions.min_by(|a, b| {
        let ((a_bent, a), (b_bent, b)) = (rank(a), rank(b));
        a_bent.cmp(&b_bent).then(a.total_cmp(&b))
    })
}

/// Whether a sheet bends no further than paper does that somebody takes for flat.
fn is_a_sheet(sheet: &Sheet) -> bool {
    let diagonal = sheet.size.width_mm.hypot(sheet.size.height_mm);
    sheet.bend.is_flat() || sheet.bend.sag_mm(sheet.size).0 <= MOST_BENT * diagonal
}

/// What starts are compared by: outliers first lower a redescending cost, so those count as well.
fn penalised_cost(fit: &RobustFit<Model>) -> f64 {
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
pub(crate) fn solve_camera(observations: &Observations, config: &CalibrateConfig) -> Result<Solution> {
    let (starts, complaint) = camera_starts(observations, config)?;
    best(observations, config, &starts).ok_or_else(|| failed(complaint, "camera"))
}

/// Everything together from a solved camera, when the observations have a projector.
pub(crate) fn add_projector(
    observations: &Observations,
    config: &CalibrateConfig,
    camera: &Solution,
) -> Result<Solution> {
    let Some(panel) = observations.projector else { return Ok(camera.clone()) };
    let (starts, complaint) = projector_starts(observations, config, panel, camera.model())?;
    let mut both = best(observations, config, &starts).ok_or_else(|| failed(complaint, "projector"))?;
    both.fit.iterations += camera.fit.iterations;
    Ok(both)
}

/// Camera, poses and, when the observations have one, the projector.
pub(crate) fn solve(observations: &Observations, config: &CalibrateConfig) -> Result<Solution> {
    solve_in_steps(observations, config).map(|(_, all)| all)
}

/// The camera and the poses alone, and everything together.
pub(crate) fn solve_in_steps(
    observations: &Observations,
    config: &CalibrateConfig,
) -> Result<(Solution, Solution)> {
    let camera = solve_camera(observations, config)?;
    let all = add_projector(observations, config, &camera)?;
    Ok((camera, all))
}
