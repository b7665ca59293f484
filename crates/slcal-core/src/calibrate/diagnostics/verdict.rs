//! The judgement on a calibration: how well the focal lengths are known, why not better, and what to do.

use crate::advise::advice::{advise, percent};
use crate::advise::predict::{FocalSigma, focal_sigma, has, tilt, with_exact_principal_points};
use crate::calibrate::config::{CalibrateConfig, PrincipalPointRule};
use crate::calibrate::maximum_likelihood::Solved;
use crate::error::{Error, ErrorSubject};
use crate::estimate::model::{FOCAL_RANGE, lens_values};
use crate::estimate::{Kind, Target};
use crate::rig::{Verdict, Warning};

/// Warnings about how well the geometry determines the result; all others are about what does not fit.
const SAID_BY_CAUSE: [&str; 5] = [
    "weak-geometry",
    "degenerate-geometry",
    "principal-point-limited",
    "lens-shift-undetermined",
    "poses-alike",
];

/// Below this tilt the sheet is called almost face-on, rad (15°).
const FACE_ON: f64 = 15.0 * std::f64::consts::PI / 180.0;
/// Residuals this many times their σ mean that the model misses something (distortion, a bent sheet, wrong corners).
const MISFIT: f64 = 3.0;
/// A vertical principal point known no better than this part of the panel's height is undetermined.
const SHIFT_UNDETERMINED: f64 = 0.25;
/// Shares of measurements left out by the robust loss that deserve a word.
const MANY_OUTLIERS: f64 = 0.3;
/// Code of the warning about corners given by hand that do not fit.
const CORNERS_OFF: &str = "sheet-corners-off";
/// Poses whose sheets are turned against each other by less than this add next to nothing, rad (1°).
const ALIKE: f64 = std::f64::consts::PI / 180.0;
/// Distance of a principal point from its prior, in σ, that deserves a word.
const FAR_FROM_PRIOR: f64 = 3.0;
/// Beyond this distance, in σ, prior and photographs contradict each other, and σ of the result means little.
const AGAINST_PRIOR: f64 = 6.0;

/// The same for a coefficient of distortion: no ordinary lens has a k1 of 0.5.
const NO_SUCH_LENS: f64 = 5.0;

pub(crate) fn warning(code: &str, message: String, advice: impl Into<String>) -> Warning {
    Warning { code: code.into(), message, advice: advice.into() }
}

/// Everything that is said about a fit.
pub(crate) struct Judgement {
    pub(crate) sigma: FocalSigma,
    pub(crate) verdict: Verdict,
    /// How the sheet is seen and how well the focal length is known from it.
    cause: String,
    advice: String,
    /// What is worse than σ says.
    doubt: Option<Warning>,
    pub(crate) warnings: Vec<Warning>,
}

impl Judgement {
    /// Adds what makes the result wrong by more than σ says, before all else: it is never called good then.
    pub(crate) fn doubt(&mut self, warning: Warning) {
        self.verdict = self.verdict.max(Verdict::Weak);
        self.doubt = Some(warning.clone());
        self.warnings.insert(0, warning);
    }

    fn worsen(&mut self, to: Verdict, warning: &Warning) {
        if self.verdict < to {
            self.verdict = to;
            self.doubt = Some(warning.clone());
        }
    }

    /// Why the verdict is what it is, and what to do: the geometry, or what is worse than σ says.
    pub(crate) fn why(&self) -> (&str, &str) {
        match &self.doubt {
            Some(w) => (&w.message, &w.advice),
            None => (&self.cause, &self.advice),
        }
    }

    /// The error that refuses a degenerate view. Where the model does not fit, that is said first: more tilt would not help.
    pub(crate) fn refusal(&self) -> Error {
        let misfit = self.warnings.iter().find(|w| !SAID_BY_CAUSE.contains(&w.code.as_str()));
        let advice = match misfit {
            Some(w) => format!("{}: {}; as it is, {}", w.message, w.advice, self.cause),
            None => {
                format!(
                    "{}; {} is the most that is accepted; {}",
                    self.cause,
                    percent(Verdict::WEAK_BELOW),
                    self.advice
                )
            }
        };
        Error::Degenerate {
            what: ErrorSubject::FocalLength,
            measure: self.sigma.worst(),
            limit: Verdict::WEAK_BELOW,
            advice,
        }
    }
}

fn worse_device(sigma: &FocalSigma) -> &'static str {
    if sigma.projector.is_some_and(|p| p > sigma.camera) { "projector" } else { "camera" }
}

/// Why the focal length is as uncertain as it is; `limited` is whether the principal point is what limits it.
fn cause(solved: &Solved, sigma: &FocalSigma, config: &CalibrateConfig, limited: bool) -> String {
    let device = worse_device(sigma);
    let model = &solved.fit.model;
    let tilts = |k: usize| model.views.iter().map(|v| tilt(v)[k].abs()).fold(0.0, f64::max);
    let [all, about_x, about_y] = [tilts(0), tilts(1), tilts(2)];
    let seen = if all < FACE_ON {
        format!("the sheet is seen almost face-on ({:.1}°)", all.to_degrees())
    } else {
        format!(
            "the sheet is tilted by {:.1}° about the horizontal and {:.1}° about the vertical axis",
            about_x.to_degrees(),
            about_y.to_degrees()
        )
    };
    let rule = if device == "camera" { config.camera_pp } else { config.projector_pp };
    let alone = model.views.len() == 1 && rule == PrincipalPointRule::Free && sigma.worst() > 0.0;
    let (free, because) = match (alone, limited) {
        (true, _) => (" with its principal point free, which one photograph does not determine,", ""),
        (false, true) => (
            "",
            ", nearly all of it because the principal point, where the lens's axis meets the image, is not known exactly",
        ),
        (false, false) => ("", ""),
    };
    format!("{seen}: σ of the focal length of the {device}{free} is {}{because}", percent(sigma.worst()))
}

/// Judges a maximum-likelihood fit.
pub(crate) fn judge(solved: &Solved, config: &CalibrateConfig) -> Judgement {
    let Solved { joint, fit } = solved;
    let sigma = focal_sigma(&fit.covariance, &joint.layout);
    let limited = exact_would_be(solved, &sigma);
    let mut judgement = Judgement {
        sigma,
        verdict: Verdict::of_focal_sigma(sigma.worst()),
        cause: cause(solved, &sigma, config, limited.is_some()),
        advice: advise(joint, fit, sigma.worst()),
        doubt: None,
        warnings: Vec::new(),
    };
    if let Some(w) = outlandish(solved) {
        judgement.worsen(Verdict::Degenerate, &w);
        judgement.warnings.push(w);
    }
    let misfits = misfits(solved);
    let far: Vec<_> =
        [far_from_prior(solved), distortion_far_from_prior(solved), focal_far_from_prior(solved)]
            .into_iter()
            .flatten()
            .collect();
    // Corners are too few to widen their own σ, and a prior never does: what they miss by is not in σ of the focal length.
    let against = far.iter().filter(|(_, against)| *against).map(|(w, _)| w);
    for w in misfits.iter().filter(|w| w.code == CORNERS_OFF).chain(against) {
        judgement.worsen(Verdict::Weak, w);
    }
    let Judgement { verdict, cause, advice, warnings, .. } = &mut judgement;
    if *verdict >= Verdict::Weak {
        let code = if *verdict == Verdict::Weak { "weak-geometry" } else { "degenerate-geometry" };
        warnings.push(warning(code, cause.clone(), advice.clone()));
    }
    warnings.extend(limited.map(|exact| principal_point_limited(&exact, advice)));
    warnings.extend(shift_undetermined(solved, config));
    warnings.extend(far.into_iter().map(|(w, _)| w));
    warnings.extend(misfits);
    warnings.extend(poses_alike(solved));
    judgement
}

/// A focal length at the end of the range that the search is confined to.
fn outlandish(solved: &Solved) -> Option<Warning> {
    let model = &solved.fit.model;
    let devices = [
        Some(("camera", model.camera, solved.joint.layout.camera[0])),
        model.projector.map(|p| ("projector", p, solved.joint.layout.projector[0])),
    ];
    devices.into_iter().flatten().find_map(|(name, lens, place)| {
        place?;
        let in_sides = lens.intrinsics.fx / f64::from(lens.width.max(lens.height));
        (!(FOCAL_RANGE[0] * 1.5..FOCAL_RANGE[1] / 1.5).contains(&in_sides)).then(|| {
            warning(
                "focal-length-outlandish",
                format!("the focal length of the {name} came out as {in_sides:.3} times the longer side of its image"),
                "check the sheet's size and corners, and the principal point",
            )
        })
    })
}

/// What σ would be if principal points were known exactly, where it is mostly them.
fn exact_would_be(solved: &Solved, sigma: &FocalSigma) -> Option<FocalSigma> {
    /// Below this σ nobody needs to be told what limits it.
    const WORTH_TELLING: f64 = 0.005;
    if sigma.worst() < WORTH_TELLING {
        return None;
    }
    with_exact_principal_points(&solved.joint, &solved.fit)
        .filter(|exact| exact.worst() < 0.5 * sigma.worst())
}

fn principal_point_limited(exact: &FocalSigma, advice: &str) -> Warning {
    warning(
        "principal-point-limited",
        format!(
            "if the principal point were known exactly, σ of the focal length would be {}",
            percent(exact.worst())
        ),
        advice,
    )
}

fn shift_undetermined(solved: &Solved, config: &CalibrateConfig) -> Option<Warning> {
    let projector = solved.fit.model.projector?;
    let place = solved.joint.layout.projector[2]?;
    let sigma = solved.fit.covariance[(place, place)].sqrt();
    let free = matches!(config.projector_pp, PrincipalPointRule::Shift | PrincipalPointRule::Free);
    (free && sigma > SHIFT_UNDETERMINED * f64::from(projector.height)).then(|| {
        warning(
            "lens-shift-undetermined",
            format!("the projector's vertical principal point is known to {sigma:.0} px only"),
            "tilt the sheet about its vertical axis as well (a tilt about the horizontal axis alone cannot separate lens \
             shift from focal length), or give the principal point",
        )
    })
}

/// The principal point that lies furthest from its prior, if far, and whether the two contradict each other.
fn far_from_prior(solved: &Solved) -> Option<(Warning, bool)> {
    let model = &solved.fit.model;
    let offs = solved.joint.priors.iter().filter(|p| p.index == 1 || p.index == 2).filter_map(|p| {
        let lens = if p.of_projector { model.projector? } else { model.camera };
        Some((p, (lens_values(&lens)[p.index] - p.mean) / p.sigma))
    });
    let (prior, off) = offs.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    let name = if prior.of_projector { "projector" } else { "camera" };
    let axis = if prior.index == 1 { "cx" } else { "cy" };
    (off.abs() > FAR_FROM_PRIOR).then(|| {
        let told = warning(
            "principal-point-far",
            format!(
                "{axis} of the {name} lies {:.0} px from where it was expected, {:.1} σ",
                off * prior.sigma,
                off.abs()
            ),
            "check the sheet's size, and whether the photograph was cropped or the lens distorts",
        );
        (told, off.abs() > AGAINST_PRIOR)
    })
}

/// The distortion coefficient that lies furthest from its prior, if far, and whether no lens has it: a bent sheet seen face-on
/// passes for one.
fn distortion_far_from_prior(solved: &Solved) -> Option<(Warning, bool)> {
    const NAMES: [&str; 5] = ["k1", "k2", "p1", "p2", "k3"];
    let model = &solved.fit.model;
    let offs = solved.joint.priors.iter().filter_map(|p| {
        let name = NAMES.get(p.index.checked_sub(3)?)?;
        let lens = if p.of_projector { model.projector? } else { model.camera };
        let value = lens_values(&lens)[p.index];
        Some((name, p, value, ((value - p.mean) / p.sigma).abs()))
    });
    let (name, prior, value, off) = offs.max_by(|a, b| a.3.total_cmp(&b.3))?;
    let device = if prior.of_projector { "projector" } else { "camera" };
    (off > FAR_FROM_PRIOR).then(|| {
        let told = warning(
            "distortion-far",
            format!("{name} of the {device} came out as {value:.2}, {off:.1} σ from what lenses have"),
            "is the sheet flat? tilt it more, or estimate no distortion if the lens is good",
        );
        (told, off > NO_SUCH_LENS)
    })
}

/// The camera's focal length against what was expected of it. Of an estimate that contains the prior, the distance from
/// the prior's mean has the variance σ² of the prior less that of the estimate.
fn focal_far_from_prior(solved: &Solved) -> Option<(Warning, bool)> {
    let Solved { joint, fit } = solved;
    let prior = joint.priors.iter().find(|p| p.index == 0 && !p.of_projector)?;
    let place = joint.layout.camera[0]?;
    let off = lens_values(&fit.model.camera)[0] - prior.mean;
    let spread = (prior.sigma.powi(2) - fit.covariance[(place, place)]).max(0.0).sqrt();
    let off = off.abs() / spread;
    (off.is_finite() && off > FAR_FROM_PRIOR).then(|| {
        let told = warning(
            "focal-far-from-prior",
            format!(
                "the camera's focal length is {:.0} px where {:.0} px was expected within {}: {:.1} σ apart",
                fit.model.camera.intrinsics.fx,
                prior.mean.exp(),
                percent(prior.sigma),
                off
            ),
            "check the sheet's size, whether the photograph was cropped or scaled after it was taken, and whether the \
             expected focal length is that of this lens at this zoom",
        );
        (told, off > AGAINST_PRIOR)
    })
}

/// Residuals that the noise does not explain, and measurements that were left out.
fn misfits(solved: &Solved) -> Vec<Warning> {
    let Solved { joint, fit } = solved;
    let mut warnings = Vec::new();
    for (i, kind, name, code) in [
        (0, Kind::Edge, "the sheet's edge points", "edge"),
        (1, Kind::Pair, "the projected corners", "corner"),
    ] {
        if !has(joint, kind) {
            continue;
        }
        if fit.widened[i] > MISFIT {
            warnings.push(warning(
                &format!("{code}-residuals-large"),
                format!("{name} lie {:.1} times further from the model than their noise explains", fit.widened[i]),
                "is the sheet flat and its size right, does the lens distort, was the principal point given rightly?",
            ));
        }
        let of_kind = joint.measurements.iter().zip(&fit.inliers).filter(|(m, _)| m.kind() == kind);
        let (out, all) = of_kind.fold((0usize, 0usize), |(o, n), (_, keep)| (o + usize::from(!keep), n + 1));
        let share = out as f64 / all as f64;
        if share > MANY_OUTLIERS {
            warnings.push(warning(
                &format!("{code}-outliers"),
                format!("{:.0} % of {name} do not fit the model and were left out", share * 100.0),
                "remove what covers the sheet's border, and check the overlay",
            ));
        }
    }
    warnings.extend(corner_misfit(solved));
    warnings
}

/// Photographs of one and the same pose.
fn poses_alike(solved: &Solved) -> Option<Warning> {
    let views = &solved.fit.model.views;
    (1..views.len()).find_map(|j| {
        let i = views[..j].iter().position(|v| v.turn_from(&views[j]).norm() < ALIKE)?;
        Some(warning(
            "poses-alike",
            format!(
                "photographs {} and {} show the sheet in the same pose: the second adds next to nothing",
                i + 1,
                j + 1
            ),
            "photograph the sheet with its tilt reversed instead, and give each photograph once",
        ))
    })
}

/// Corners given by hand that the model cannot reach.
fn corner_misfit(solved: &Solved) -> Option<Warning> {
    let of_corners = solved.joint.measurements.iter().zip(&solved.fit.norms_px);
    let worst = of_corners
        .filter(|(m, _)| matches!(m.of, Target::SheetCorner(_)))
        .map(|(m, n)| n / m.sigma_px)
        .fold(0.0, f64::max);
    (worst > 2.0 * MISFIT).then(|| {
        warning(
            CORNERS_OFF,
            format!("a corner of the sheet lies {worst:.0} σ from the model"),
            "check the corners, their order (TL TR BR BL) and the sheet's size",
        )
    })
}
