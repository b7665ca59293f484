//! Whether the sheet's proportions are those that were given. A common factor of width and height changes nothing in the
//! photograph but its distance and can never be noticed; a wrong proportion can, where the principal point is held or
//! several views agree on it.

use nalgebra::DMatrix;

use super::explanation::change_proportion;
use super::misfit::{Misfit, misfit, weights};
use super::told::with_sigma;
use crate::calibrate::config::CalibrateConfig;
use crate::calibrate::maximum_likelihood::problem;
use crate::estimate::{Model, Solution};
use crate::observations::Observations;
use crate::rig::Warning;
use crate::solve::{Problem as _, Structure, predicted_decrease};

/// Distance from the given proportion, in σ, that is reported. By chance it is passed once in 16 000 photographs.
const DOUBTFUL: f64 = 4.0;
/// Changes of ln(width/height) that matter to nobody; the step of differences.
const NEAR: f64 = 2e-4;
/// The first step of the search, and how often it doubles: up to a factor of two.
const STEP: f64 = 0.01;
const DOUBLINGS: usize = 6;

/// The camera and its views with the proportion of the sheets changed by a factor e^`change`, area kept.
fn with_proportion(model: &Model, change: f64) -> Model {
    let mut model = Model { projector: None, ..model.clone() };
    change_proportion(&mut model.views, change);
    model
}

/// By how much χ² would fall to first order with the proportion free: the test of the score, which asks for no fit.
pub(super) fn promised(sheet: &Observations, config: &CalibrateConfig, from: &Solution) -> Option<f64> {
    let model = with_proportion(from.model(), 0.0);
    let problem = problem(sheet, config, &model);
    let here = problem.at(&model)?;
    let residuals = |change| problem.at(&with_proportion(&model, change)).map(|at| at.residuals);
    let by_change = (residuals(NEAR)? - residuals(-NEAR)?) / (2.0 * NEAR);
    // The same loss as in the misfits that are compared: a wrong proportion makes outliers of good points.
    let weights = weights(&problem, &model)?;
    let structure = problem.structure();
    let decrease = |structure: &Structure, jacobian: &DMatrix<f64>| {
        predicted_decrease(structure, jacobian, here.residuals.as_slice(), &weights)
    };
    let fixed = decrease(&structure, &here.jacobian)?;
    let last = here.jacobian.ncols();
    let mut wider = here.jacobian.insert_column(last, 0.0);
    wider.set_column(last, &by_change);
    let free = decrease(&Structure { shared: structure.shared + 1, ..structure }, &wider)?;
    Some(free - fixed)
}

/// The fit of the sheet alone with its proportion changed by a factor e^`change`, area kept.
fn fit_at(sheet: &Observations, config: &CalibrateConfig, from: &Solution, change: f64) -> Option<Misfit> {
    let model = with_proportion(from.model(), change);
    Some(misfit(&Solution::refine(problem(sheet, config, &model), model)?))
}

/// How well each change of the proportion fits.
struct Search<'a> {
    sheet: &'a Observations,
    config: &'a CalibrateConfig,
    from: &'a Solution,
}

/// What came of it: the change of ln(width/height) that fits with its σ, and by how many σ it beats the given one.
struct Found {
    change: f64,
    sigma: f64,
    beats: f64,
}

impl Search<'_> {
    fn chi2(&self, change: f64) -> Option<f64> {
        fit_at(self.sheet, self.config, self.from, change).map(|m| m.chi2)
    }

    /// Slope and curvature of χ² at `at`, whose χ² is `here`.
    fn shape(&self, at: f64, here: f64) -> Option<(f64, f64)> {
        let (less, more) = (self.chi2(at - NEAR)?, self.chi2(at + NEAR)?);
        Some(((more - less) / (2.0 * NEAR), (less - 2.0 * here + more) / (NEAR * NEAR)))
    }

    /// The lowest point in the direction that falls: steps that double until χ² rises, then the golden section.
    fn lowest(&self, here: f64, direction: f64) -> Option<f64> {
        const GOLDEN: f64 = 0.618_033_988_75;
        let (mut before, mut at, mut value, mut step) = (0.0, 0.0, here, STEP * direction);
        let mut beyond = step;
        for _ in 0..DOUBLINGS {
            beyond = at + step;
            let next = self.chi2(beyond)?;
            if next > value {
                break;
            }
            (before, at, value, step) = (at, beyond, next, 2.0 * step);
        }
        let (mut low, mut high) = (before.min(beyond), before.max(beyond));
        while high - low > NEAR {
            let (a, b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
            if self.chi2(a)? < self.chi2(b)? { high = b } else { low = a }
        }
        Some(0.5 * (low + high))
    }

    /// `None` when the given proportion is not doubtful.
    fn run(&self) -> Option<Found> {
        let given = self.chi2(0.0)?;
        let (slope, curvature) = self.shape(0.0, given)?;
        // The gain that the parabola promises; far from the minimum χ² is no parabola but falls all the faster.
        let promised = slope * slope / (2.0 * curvature);
        if curvature > 0.0 && promised < DOUBTFUL * DOUBTFUL {
            return None;
        }
        let near = self.lowest(given, -slope.signum())?;
        let (slope, curvature) = self.shape(near, self.chi2(near)?)?;
        if !(curvature.is_finite() && curvature > 0.0) {
            return None;
        }
        let change = near - slope / curvature;
        let best = fit_at(self.sheet, self.config, self.from, change)?;
        // What is left beyond the noise makes everything less certain.
        let unit = best.per_row().max(1.0).sqrt();
        let beats = (given - best.chi2).max(0.0).sqrt() / unit;
        Some(Found { change, sigma: (2.0 / curvature).sqrt() * unit, beats })
    }
}

/// A warning when another proportion fits the sheet's outline clearly better than the one given.
pub(crate) fn hint(
    observations: &Observations,
    config: &CalibrateConfig,
    solved: &Solution,
) -> Option<Warning> {
    let held = config.known_camera.is_some() || config.camera_pp.is_exact();
    // In one photograph an uncertain principal point takes up any proportion.
    if !held && observations.views.len() < 2 {
        return None;
    }
    let sheet = observations.of_camera();
    if promised(&sheet, config, solved).is_some_and(|gain| gain < DOUBTFUL * DOUBTFUL) {
        return None;
    }
    let Found { change, sigma, beats } = Search { sheet: &sheet, config, from: solved }.run()?;
    if beats < DOUBTFUL || change.abs() < NEAR {
        return None;
    }
    let size = observations.views.first()?.size;
    let given = size.width_mm / size.height_mm;
    let fits = given * change.exp();
    Some(Warning::new(
        "aspect-doubtful",
        format!(
            "width to height of the sheet is {} as it is seen, {given:.4} as it was given ({beats:.0} σ apart)",
            with_sigma(fits, fits * sigma)
        ),
        format!(
            "measure the sheet again: {:.1}x{:.1} mm or {:.1}x{:.1} mm would fit; if its size is right, the principal point \
             that was given or the lens's distortion is not",
            size.width_mm * change.exp(),
            size.height_mm,
            size.width_mm,
            size.height_mm / change.exp()
        ),
    ))
}
