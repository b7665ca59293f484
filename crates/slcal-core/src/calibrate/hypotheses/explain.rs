//! Photographs that contradict what was assumed: the mistake that explains them is searched, and taken where the photographs
//! determine it.

use nalgebra::Vector2;

use super::explanation::Explanation;
use super::misfit::{Misfit, misfit};
use super::plausible::is_ordinary;
use super::with_amounts::WithAmounts;
use crate::calibrate::config::CalibrateConfig;
use crate::calibrate::initial_guess::{camera_starts, projector_starts};
use crate::calibrate::maximum_likelihood::{problem, solve};
use crate::estimate::assumptions::PixelAspect;
use crate::estimate::planar_pose::{camera_from_sheet, pose_from_homography};
use crate::estimate::{BundleAdjustment, Kind, Model, Sheet, Solution, robust};
use crate::geometry::Camera;
use crate::observations::{Observations, ViewObservation};
use crate::rig::Verdict;
use crate::solve::rms;

/// Explanations are searched when a lens parameter lies further than this from its prior, in σ of what the photographs say
/// against it, or when χ² per residual is above the second.
const ASKED: f64 = 3.5;
const MISFIT: f64 = 1.6;
/// The same where the noise with its correlation is left so many times larger than stated.
const STRUCTURED: f64 = 3.0;
/// A parameter is judged where the photographs bring its σ below this part of the prior's.
const DETERMINED: f64 = 0.9;
/// By how much χ² must fall, and how much more for each quantity that an explanation adds.
const CLEARLY: f64 = 16.0;
const PER_PARAMETER: f64 = 6.0;
/// Explanations whose χ² differ by less are not told apart.
const ALIKE: f64 = 9.0;
/// What an explanation must leave at most, in χ² per residual.
const EXPLAINED: f64 = 1.6;
/// Largest displacement of a photograph by a stabiliser or a crop, in widths.
const DISPLACED: f64 = 0.1;
/// Photographs that are tried as the odd one.
const MOST_ODD: usize = 2;
/// Mistakes that are searched at once.
const MOST_MISTAKES: usize = 2;
/// Steps that are spent on each start of an explanation; those that hold converge in a few.
const STEPS: usize = 60;
/// Ratios of pixel aspects that pictures are stretched by: between 5:4, 4:3, 16:10, 16:9, and diamond pixels.
const STRETCHED: [f64; 8] = [0.5, 0.75, 0.8, 0.9, 1.1, 1.25, 1.333, 2.0];

/// An explanation with the solution under it.
#[derive(Debug, Clone)]
pub(crate) struct Explained {
    pub(super) by: Explanation,
    pub(crate) solution: Solution,
    /// Of what is no unknown of the problem.
    pub(super) amounts: Vector2<f64>,
    /// χ², and what it was without the explanation.
    pub(super) chi2: f64,
    pub(super) before: f64,
}

/// Mistakes that explain the photographs together.
pub(crate) struct Explanations {
    /// In the order in which they were found, the larger one first.
    pub(super) mistakes: Vec<Explained>,
    /// What would explain as much as the last one.
    pub(super) alternatives: Vec<Explained>,
    /// Under all of them.
    pub(super) solution: Solution,
}

impl Explained {
    /// What an explanation has to be worth in χ².
    fn price(&self) -> f64 {
        PER_PARAMETER * self.by.parameters() as f64
    }

    fn score(&self) -> f64 {
        self.chi2 + self.price()
    }
}

/// How strongly the photographs speak against the prior of a lens parameter, in σ, for the parameter where they do most.
fn against_priors(solution: &Solution) -> f64 {
    let of_prior = solution.problem.priors.lenses.iter().filter_map(|p| {
        let sigma = solution.sigma(p.lens, p.parameter)?;
        (sigma < DETERMINED * p.sigma).then_some(())?;
        let seen = (p.sigma.powi(2) - sigma.powi(2)).sqrt();
        Some(p.residual(solution.model())?.abs() * p.sigma / seen)
    });
    of_prior.fold(0.0, f64::max)
}

/// Whether the fit asks for another explanation.
fn is_asked_for(solution: &Solution, learned: &Solution) -> bool {
    let asked = || {
        misfit(solution).per_row() > MISFIT
            || against_priors(solution) > ASKED
            || noise_left(learned) > STRUCTURED
    };
    solution.model().views.len() > 1 && asked()
}

/// What makes the photographs fit; `None` where nothing is wrong or nothing explains it. A second mistake is searched where the
/// first one does not explain all. `learned` is the given solution with its learned weights.
pub(crate) fn explanations(
    observations: &Observations,
    config: &CalibrateConfig,
    given: &Solution,
    learned: &Solution,
) -> Option<Explanations> {
    let sideways = observations.projector.map(|panel| config.shift_axes(panel)[1]);
    let all = Explanation::all(&odd_views(given), sideways);
    let before = misfit(given).chi2;
    let mut search = Search { observations, config, given: given.clone(), before, freed: Vec::new() };
    let mut mistakes: Vec<Explained> = Vec::new();
    let mut alternatives = Vec::new();
    let mut solution = learned.clone();
    while mistakes.len() < MOST_MISTAKES && is_asked_for(&search.given, &solution) {
        let others = all.iter().filter(|by| !search.freed.contains(by));
        let mut found: Vec<Explained> = others.filter_map(|&by| search.under(by)).collect();
        found.retain(|e| search.before - e.score() > CLEARLY);
        found.sort_by(|a, b| a.score().total_cmp(&b.score()));
        let mut found = found.into_iter();
        let Some(best) = found.next() else { break };
        alternatives = found.collect();
        let is_the_last = best.by.frees().is_empty();
        search.freed.push(best.by);
        (search.given, search.before) = (best.solution.clone(), best.chi2);
        solution = best.solution.clone().with_learned_weights();
        mistakes.push(best);
        if is_the_last {
            break;
        }
    }
    let Misfit { chi2, rows } = misfit(&search.given);
    let fits = chi2 < EXPLAINED * rows as f64 && noise_left(&solution) < STRUCTURED;
    if mistakes.is_empty() || !fits || !is_plausible(&search.given) {
        return None;
    }
    // What is left beyond the stated noise, and the correlation of its points, make every χ² count for less.
    let unit = noise_left(&solution).powi(2);
    let last = mistakes.last()?.score();
    alternatives.retain(|e| e.score() < last + ALIKE * unit);
    let gain = before - mistakes.iter().map(Explained::price).sum::<f64>() - chi2;
    (gain > CLEARLY * unit * mistakes.len() as f64).then_some(Explanations {
        mistakes,
        alternatives,
        solution,
    })
}

/// Whether lenses and sheets are what they may be, and the photographs determine them.
fn is_plausible(solution: &Solution) -> bool {
    let camera = solution.model().camera;
    let middle = Camera::image_centre(camera.width, camera.height);
    let off = camera.intrinsics.principal_point() - middle;
    let inside = off.x.abs() < f64::from(camera.width) && off.y.abs() < f64::from(camera.height);
    inside
        && is_ordinary(solution)
        && solution.problem.priors.hold(solution.model())
        && solution.focal_sigma().worst() < Verdict::FAIR_BELOW
}

/// The photographs that fit worst; of two either one may be the odd one.
fn odd_views(given: &Solution) -> Vec<usize> {
    let count = given.model().views.len();
    if count == 2 {
        return vec![1];
    }
    let typical = |view: usize| {
        let own = given.measured().filter(|(m, ..)| m.view == view).map(|(m, norm, _)| norm / m.sigma_px);
        (view, rms(own).unwrap_or(0.0))
    };
    let mut views: Vec<(usize, f64)> = (0..count).map(typical).collect();
    views.sort_by(|a, b| b.1.total_cmp(&a.1));
    views.iter().take(MOST_ODD).map(|(view, _)| *view).collect()
}

/// By how much σ are to be multiplied for the noise that a solution leaves.
fn noise_left(solution: &Solution) -> f64 {
    solution.noise_left(Kind::Edge).max(solution.noise_left(Kind::Pair))
}

/// The solution with the lowest χ², and that.
fn best(solutions: impl Iterator<Item = Solution>) -> Option<(Solution, f64)> {
    let rated = solutions.map(|s| {
        let chi2 = misfit(&s).chi2;
        (s, chi2)
    });
    rated.min_by(|a, b| a.1.total_cmp(&b.1))
}

struct Search<'a> {
    observations: &'a Observations,
    config: &'a CalibrateConfig,
    given: Solution,
    /// Its χ².
    before: f64,
    /// What was found before.
    freed: Vec<Explanation>,
}

impl Search<'_> {
    fn under(&self, by: Explanation) -> Option<Explained> {
        if by.frees().is_empty() {
            return self.with_amounts(by);
        }
        let starts = self.starts(by);
        let (solution, chi2) = best(starts.into_iter().filter_map(|start| self.refine(by, start)))?;
        Some(Explained { by, solution, amounts: Vector2::zeros(), chi2, before: self.before })
    }

    fn refine(&self, by: Explanation, start: Model) -> Option<Solution> {
        Solution::refine(by.freed(self.problem(&start)?, &start)?, start)
    }

    /// The problem under what was found before.
    fn problem(&self, start: &Model) -> Option<BundleAdjustment> {
        let stated = problem(self.observations, self.config, start).within(STEPS);
        self.freed.iter().try_fold(stated, |problem, by| by.freed(problem, start))
    }

    /// From the solution that was given, and from the beginning.
    fn starts(&self, by: Explanation) -> Vec<Model> {
        let mut starts = vec![self.given.model().clone()];
        // The sheet alone: together with a projector that does not fit, the camera is spoilt.
        let Some((camera, panel)) = self.camera(by).zip(self.observations.projector) else { return starts };
        let mut configs = vec![self.config.clone()];
        if by == Explanation::ProjectorAspect {
            configs.extend(STRETCHED.map(|ratio| CalibrateConfig {
                projector_pixel_aspect: PixelAspect::Ratio(ratio),
                ..self.config.clone()
            }));
        }
        for config in &configs {
            if let Ok((more, _)) = projector_starts(self.observations, config, panel, &camera) {
                starts.extend(more);
            }
        }
        starts
    }

    fn camera(&self, by: Explanation) -> Option<Model> {
        let (starts, _) = camera_starts(self.observations, self.config).ok()?;
        let alone = |start: Model| self.refine(by, Model { projector: None, ..start });
        let (solution, _) = best(starts.into_iter().filter_map(alone))?;
        Some(solution.model().clone())
    }

    /// By amounts that are no unknowns of the problem alone.
    fn with_amounts(&self, by: Explanation) -> Option<Explained> {
        let found = self.starts_with_amounts(by).into_iter().filter_map(|start| {
            let mut wider = WithAmounts { by, problem: self.problem(&start)? };
            let fit = robust::fit(&mut wider, (start, Vector2::zeros()), [0; 2])?;
            let (model, amounts) = fit.state;
            let far = matches!(by, Explanation::Displaced(_))
                && amounts.norm() > DISPLACED * f64::from(model.camera.width);
            let (changed, model) = (!far).then(|| by.changed(&wider.problem, &model, amounts))?;
            let solution = Solution::refine(changed, model)?;
            let chi2 = misfit(&solution).chi2;
            Some(Explained { by, solution, amounts, chi2, before: self.before })
        });
        found.min_by(|a, b| a.chi2.total_cmp(&b.chi2))
    }

    /// From the solution that was given, and from that without the photograph that may be displaced, which it spoils.
    fn starts_with_amounts(&self, by: Explanation) -> Vec<Model> {
        let given = self.given.model();
        let mut starts = vec![given.clone()];
        if let Explanation::Displaced(view) | Explanation::OtherSheet(view) = by {
            let mut others = self.observations.clone();
            let odd = others.views.remove(view);
            starts.extend(solve(&others, self.config).ok().and_then(|solution| {
                let mut model = solution.model().clone();
                let sheet = sheet(&odd, &model)?;
                model.views.insert(view, sheet);
                Some(model)
            }));
        }
        starts
    }
}

/// The sheet of one photograph under a calibrated camera.
fn sheet(seen: &ViewObservation, model: &Model) -> Option<Sheet> {
    let camera = &model.camera;
    let h = camera_from_sheet(seen, Some(camera)).ok()?;
    Some(Sheet::flat(pose_from_homography(&h, &camera.intrinsics, seen.size.centre())?, seen.size))
}
