//! Parameters that lie far from where they were expected.

use super::advice::percent;
use crate::estimate::Solution;
use crate::estimate::prior::LensPrior;
use crate::parameter::LensParameter;
use crate::rig::Warning;

/// Distance of a principal point from its prior, in σ, that deserves a warning.
const FAR_FROM_PRIOR: f64 = 3.0;
/// Beyond this distance, in σ, prior and photographs contradict each other, and σ of the result means little.
const AGAINST_PRIOR: f64 = 6.0;
/// The same for a coefficient of distortion: no ordinary lens has a k1 of 0.5.
const NO_SUCH_LENS: f64 = 5.0;

/// What lies far from its prior, and whether the two contradict each other.
pub(crate) fn far_from_prior(solution: &Solution) -> Vec<(Warning, bool)> {
    let kinds = [principal_point(solution), distortion(solution), focal_length(solution)];
    kinds.into_iter().flatten().collect()
}

/// Of the priors of some parameters, the one whose parameter lies furthest from it, and by how many σ.
fn furthest(solution: &Solution, of: impl Fn(LensParameter) -> bool) -> Option<(&LensPrior, f64)> {
    let priors = solution.problem.priors.lenses.iter().filter(|p| of(p.parameter));
    let offs = priors.filter_map(|p| Some((p, p.stated_residual(solution.model())?)));
    offs.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}

/// The principal point that lies furthest from its prior, if far, and whether the two contradict each other.
fn principal_point(solution: &Solution) -> Option<(Warning, bool)> {
    let (prior, off) = furthest(solution, |p| matches!(p, LensParameter::Cx | LensParameter::Cy))?;
    let axis = if prior.parameter == LensParameter::Cx { "cx" } else { "cy" };
    (off.abs() > FAR_FROM_PRIOR).then(|| {
        let warning = Warning::new(
            "principal-point-far",
            format!(
                "{axis} of the {} lies {:.0} px from where it was expected, {:.1} σ",
                prior.lens.name(),
                off * prior.sigma / prior.widened,
                off.abs()
            ),
            "check the sheet's size, and whether the photograph was cropped or the lens distorts",
        );
        (warning, off.abs() > AGAINST_PRIOR)
    })
}

/// The distortion coefficient that lies furthest from its prior, if far, and whether no lens has it: a bent sheet seen face-on
/// passes for one.
fn distortion(solution: &Solution) -> Option<(Warning, bool)> {
    let (prior, off) = furthest(solution, |p| {
        (LensParameter::K1 as usize..=LensParameter::K3 as usize).contains(&(p as usize))
    })?;
    let (value, off) = (prior.value(solution.model())?, off.abs());
    (off > FAR_FROM_PRIOR).then(|| {
        let warning = Warning::new(
            "distortion-far",
            format!(
                "{} of the {} came out as {value:.2}, {off:.1} σ from what lenses have",
                prior.parameter.name(),
                prior.lens.name()
            ),
            "is the sheet flat? tilt it more, or estimate no distortion if the lens is good",
        );
        (warning, off > NO_SUCH_LENS)
    })
}

/// The camera's focal length against what was expected of it. Of an estimate that contains the prior, the distance from
/// the prior's mean has the variance σ² of the prior less that of the estimate.
fn focal_length(solution: &Solution) -> Option<(Warning, bool)> {
    let (prior, off) = furthest(solution, |p| p == LensParameter::Focal)?;
    let spread = (prior.sigma.powi(2) - solution.sigma(prior.lens, prior.parameter)?.powi(2)).max(0.0).sqrt();
    let off = (off * prior.sigma).abs() / spread;
    (off.is_finite() && off > FAR_FROM_PRIOR).then(|| {
        let warning = Warning::new(
            "focal-far-from-prior",
            format!(
                "the camera's focal length is {:.0} px where {:.0} px was expected within {}: {:.1} σ apart",
                solution.model().camera.intrinsics.fx,
                prior.mean.exp(),
                percent(prior.sigma),
                off
            ),
            "check the sheet's size, whether the photograph was cropped or scaled after it was taken, and whether the \
             expected focal length is that of this lens at this zoom",
        );
        (warning, off > AGAINST_PRIOR)
    })
}
