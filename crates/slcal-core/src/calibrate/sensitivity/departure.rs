//! Ways in which a rig and its photographs depart from what is assumed of them: each changes the problem that is solved.

use nalgebra::DVector;

use crate::estimate::{BundleAdjustment, Kind, Lens, Model, Solution, Target, Unknowns};
use crate::geometry::{Camera, RectangleSize};
use crate::parameter::LensParameter;

/// Steps that are spent on a departure: the photographs contradict what does not converge in these.
const STEPS: usize = 60;
/// Bands of light across the image's height.
const BANDS: f64 = 5.0;
/// The second Legendre polynomial runs from -1/2 to 1.
const VALLEY_TO_PEAK: f64 = 1.5;

/// A quantity that is assumed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Departure {
    /// A parameter of a lens lies elsewhere than where it is expected.
    Lens(Lens, LensParameter),
    /// The projected picture is scaled about the panel's middle.
    ShownScale,
    /// Brightness varies from row to row and shifts what is seen; the phase of the bands, in quarters of a period.
    LightBands(u8),
    /// A sheet that bends as a cylinder about its height.
    Curl,
    /// The sheet's width.
    Width,
    /// Both sides of the sheet.
    Scale,
}

impl Departure {
    /// The problem under the changed assumption, and where to start; `amount` is in the unit of the parameter, a share for
    /// scale and width, px for bands, mm from valley to peak for a curl.
    pub(super) fn apply(
        self,
        problem: &BundleAdjustment,
        model: &Model,
        amount: f64,
    ) -> Option<(BundleAdjustment, Model)> {
        let (mut problem, mut model) = (problem.clone(), model.clone());
        match self {
            Self::Lens(lens, parameter) => {
                let prior = problem.priors.lenses.iter_mut();
                match prior.into_iter().find(|p| (p.lens, p.parameter) == (lens, parameter)) {
                    Some(prior) => prior.mean += amount,
                    None => model = with_moved(&model, lens, parameter, amount)?,
                }
            }
            Self::ShownScale => {
                let panel = model.projector?;
                let middle = Camera::image_centre(panel.width, panel.height);
                for m in &mut problem.measurements {
                    if let Target::Pair(q) = &mut m.of {
                        *q = middle + (*q - middle) * (1.0 + amount);
                    }
                }
            }
            Self::LightBands(quarter) => {
                let turns = BANDS / f64::from(model.camera.height);
                for m in problem.measurements.iter_mut().filter(|m| m.kind() != Kind::SheetCorner) {
                    let phase = m.seen.y * turns + f64::from(quarter) / 4.0;
                    m.seen.y += amount * (std::f64::consts::TAU * phase).sin();
                }
            }
            Self::Curl => {
                // What a flat sheet would have shown: to first order the misses of the curled one come off.
                let before = problem.misses_px(&model)?;
                let mut curled = model.clone();
                for view in &mut curled.views {
                    view.bend.0[0] += amount / VALLEY_TO_PEAK;
                }
                let after = problem.misses_px(&curled)?;
                for (m, (before, after)) in problem.measurements.iter_mut().zip(before.iter().zip(&after)) {
                    m.seen -= after - before;
                }
            }
            Self::Width => {
                for view in &mut model.views {
                    let height_mm = view.size.height_mm;
                    view.size = RectangleSize { width_mm: view.size.width_mm * (1.0 + amount), height_mm };
                }
            }
            Self::Scale => scale(&mut model, 1.0 + amount),
        }
        Some((problem, model))
    }
}

/// The problem of what the solution keeps, without robust losses: a departure may move everything.
pub(super) fn of_inliers(solution: &Solution) -> BundleAdjustment {
    let BundleAdjustment { unknowns, priors, .. } = &solution.problem;
    let kept = solution.measured().filter(|(.., keep)| *keep).map(|(m, ..)| *m);
    BundleAdjustment::new(kept.collect(), unknowns.clone(), priors.clone()).within(STEPS)
}

/// A model with a parameter of a lens moved.
fn with_moved(model: &Model, lens: Lens, parameter: LensParameter, by: f64) -> Option<Model> {
    let unknowns = Unknowns::all(model.views.len(), false);
    let mut step = DVector::zeros(unknowns.len());
    step[unknowns.lens(lens, parameter)?] = by;
    model.moved(&unknowns, &step)
}

/// All lengths multiplied: every pixel stays where it is.
fn scale(model: &mut Model, by: f64) {
    model.projector_from_camera.translation *= by;
    for view in &mut model.views {
        view.size = RectangleSize { width_mm: view.size.width_mm * by, height_mm: view.size.height_mm * by };
        view.pose.translation *= by;
        view.bend.0.iter_mut().for_each(|c| *c *= by);
    }
}
