//! The verdict on a calibration: how well the focal lengths are known, why not better, and what to do.

use super::advice::{advise, percent, tilt};
use super::far_from_prior::far_from_prior;
use crate::calibrate::config::CalibrateConfig;
use crate::error::{Error, ErrorSubject};
use crate::estimate::assumptions::PrincipalPointRule;
use crate::estimate::hyperparameters::WIDEST;
use crate::estimate::model::{FOCAL_RANGE, ORDINARY_FOCAL};
use crate::estimate::solution::FocalSigma;
use crate::estimate::{Kind, Lens, Solution};
use crate::parameter::LensParameter;
use crate::rig::{Verdict, Warning};
use crate::solve::rms;

/// Warnings about how well the geometry determines the result; all others are about what does not fit.
const GEOMETRY_WARNINGS: [&str; 5] = [
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
/// Residuals this many times their σ are structure that σ does not cover.
const STRUCTURED: f64 = 3.0 * MISFIT;
/// From this many times σ of the focal lengths on, σ of depth is named as what decides.
const CLEARLY_MORE: f64 = 1.2;
/// A coefficient of a bend this many σ of the widest prior is beyond it.
const FAR_BENT: f64 = 3.0;
/// A vertical principal point known no better than this part of the panel's height is undetermined.
const SHIFT_UNDETERMINED: f64 = 0.25;
/// Known no better than this part, the focal length cannot be trusted either: the two trade off along a curve, which σ does not
/// follow.
const SHIFT_UNKNOWN: f64 = 0.5;
/// Shares of measurements left out by the robust loss that deserve a warning.
const MANY_OUTLIERS: f64 = 0.3;
/// Code of the warning about corners given by hand that do not fit.
const CORNERS_OFF: &str = "sheet-corners-off";
/// Poses whose sheets are turned against each other by less than this add next to nothing, rad (1°).
const ALIKE: f64 = std::f64::consts::PI / 180.0;

/// The verdict with its reason, and all warnings.
pub(crate) struct Assessment {
    pub(crate) sigma: FocalSigma,
    /// Relative σ of depth at the sheet's distance.
    pub(crate) depth: Option<f64>,
    pub(crate) verdict: Verdict,
    /// How the sheet is seen and how well the focal length is known from it.
    cause: String,
    advice: String,
    /// What is worse than σ indicates.
    doubt: Option<Warning>,
    /// Whether the photographs cannot be of one rig.
    contradicted: bool,
    pub(crate) warnings: Vec<Warning>,
}

impl Assessment {
    /// Adds, before all else, a warning about an error larger than σ: the verdict is never good then.
    pub(crate) fn doubt(&mut self, warning: Warning, best: Verdict) {
        self.verdict = self.verdict.max(best);
        self.contradicted = best == Verdict::Degenerate;
        self.doubt = Some(warning.clone());
        self.warnings.insert(0, warning);
    }

    fn worsen(&mut self, to: Verdict, warning: &Warning) {
        if self.verdict < to {
            self.verdict = to;
            self.doubt = Some(warning.clone());
        }
    }

    /// Whether the photographs determine no rig at all: that of a depth alone does not count.
    pub(crate) fn is_refused(&self) -> bool {
        let by_depth_alone = self.doubt.is_none() && self.sigma.worst() < Verdict::WEAK_BELOW;
        self.verdict == Verdict::Degenerate && !by_depth_alone
    }

    /// Why the verdict is what it is, and what to do: the geometry, or what is worse than σ indicates.
    pub(crate) fn why(&self) -> (&str, &str) {
        match &self.doubt {
            Some(w) => (&w.message, &w.advice),
            None => (&self.cause, &self.advice),
        }
    }

    /// The error that refuses a degenerate view. A model that does not fit comes first: more tilt would not help.
    pub(crate) fn refusal(&self) -> Error {
        if let Some(w) = self.doubt.as_ref().filter(|_| self.contradicted) {
            return Error::undetermined(ErrorSubject::Calibration, format!("{}; {}", w.message, w.advice));
        }
        let misfit = self.warnings.iter().find(|w| !GEOMETRY_WARNINGS.contains(&w.code.as_str()));
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

/// Why the rig is as uncertain as it is; `limited` is whether the principal point is what limits it.
fn cause(
    solution: &Solution,
    sigma: &FocalSigma,
    depth: Option<f64>,
    config: &CalibrateConfig,
    limited: bool,
) -> String {
    let of_projector = sigma.projector.is_some_and(|p| p > sigma.camera);
    let (device, rule) =
        if of_projector { ("projector", config.projector_pp) } else { ("camera", config.camera_pp) };
    let model = solution.model();
    let tilts = |k: usize| model.views.iter().map(|v| tilt(&v.pose)[k].abs()).fold(0.0, f64::max);
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
    if let Some(depth) = depth.filter(|d| *d > CLEARLY_MORE * sigma.worst()) {
        return format!(
            "{seen}: σ of the depth of a point at the sheet's distance is {}, more than that of the focal lengths ({})",
            percent(depth),
            percent(sigma.worst())
        );
    }
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

/// Assesses a maximum-likelihood solution.
pub(crate) fn assess(solution: &Solution, config: &CalibrateConfig) -> Assessment {
    let sigma = solution.focal_sigma();
    let depth = depth(solution);
    let limited = exact_would_be(solution, &sigma);
    let mut assessment = Assessment {
        sigma,
        depth,
        verdict: Verdict::of_focal_sigma(sigma.worst().max(depth.unwrap_or(0.0))),
        cause: cause(solution, &sigma, depth, config, limited.is_some()),
        advice: advise(solution, sigma.worst()),
        doubt: None,
        contradicted: false,
        warnings: Vec::new(),
    };
    if let Some((w, verdict)) = implausible_focal(solution) {
        assessment.worsen(verdict, &w);
        assessment.warnings.push(w);
    }
    if let Some((w, verdict)) = bent(solution) {
        assessment.worsen(verdict, &w);
        assessment.warnings.push(w);
    }
    let shift = shift_undetermined(solution, config);
    if let Some(w) = shift.as_ref().filter(|_| shift_unknown(solution, config)) {
        assessment.worsen(Verdict::Weak, w);
    }
    let misfits = misfits(solution);
    let far = far_from_prior(solution);
    // Corners are too few to widen their own σ, and a prior never does: what they miss by is not in σ of the focal length.
    let against = far.iter().filter(|(_, against)| *against).map(|(w, _)| w);
    for w in misfits.iter().filter(|w| w.code == CORNERS_OFF).chain(against) {
        assessment.worsen(Verdict::Weak, w);
    }
    // σ is widened by what the residuals are too large by, as far as they are noise: what has a shape may be worse.
    if let Some(w) = misfits.iter().find(|w| w.code.ends_with("-residuals-large")) {
        let structured = [Kind::Edge, Kind::Pair].into_iter().any(|k| solution.noise_left(k) > STRUCTURED);
        assessment.worsen(if structured { Verdict::Weak } else { Verdict::Fair }, w);
    }
    let Assessment { verdict, cause, advice, warnings, .. } = &mut assessment;
    if *verdict >= Verdict::Weak {
        let code = if *verdict == Verdict::Weak { "weak-geometry" } else { "degenerate-geometry" };
        warnings.push(Warning::new(code, cause.clone(), advice.clone()));
    }
    warnings.extend(limited.map(|exact| principal_point_limited(&exact, advice)));
    warnings.extend(shift);
    warnings.extend(on_its_side(solution, config));
    warnings.extend(far.into_iter().map(|(w, _)| w));
    warnings.extend(misfits);
    warnings.extend(poses_alike(solution));
    assessment
}

/// The relative σ of depth that the rig's own uncertainty causes at the sheets' distance.
fn depth(solution: &Solution) -> Option<f64> {
    rms(solution.depth_sigmas().map(|s| s.of_rig / s.distance))
}

/// A focal length outside the range of ordinary lenses, or at the end of the range that the search is confined to.
fn implausible_focal(solution: &Solution) -> Option<(Warning, Verdict)> {
    Lens::ALL.into_iter().find_map(|lens| {
        let device = solution.model().lens(lens)?;
        solution.sigma(lens, LensParameter::Focal)?;
        let in_sides = device.intrinsics.fx / f64::from(device.width.max(device.height));
        let within = |range: [f64; 2]| (range[0]..range[1]).contains(&in_sides);
        (!within(ORDINARY_FOCAL)).then(|| {
            let searched = within([FOCAL_RANGE[0] * 1.5, FOCAL_RANGE[1] / 1.5]);
            let warning = Warning::new(
                "focal-length-outlandish",
                format!(
                    "the focal length of the {} is implausible: {in_sides:.3} times the longer side of its image",
                    lens.name()
                ),
                "check the sheet's size and corners, and the principal point",
            );
            (warning, if searched { Verdict::Weak } else { Verdict::Degenerate })
        })
    })
}

/// A sheet that bends further than the prior on it was allowed to widen, and the best verdict on it: beyond 3σ of the widest
/// prior the bend is pulled flat and takes the pose with it.
fn bent(solution: &Solution) -> Option<(Warning, Verdict)> {
    let limit = WIDEST * 0.99;
    if solution.bend_widths.iter().all(|w| *w < limit) {
        return None;
    }
    let sags = solution.model().views.iter().map(|v| (v, v.bend.sag_mm(v.size)));
    let (i, (sheet, (sag, at))) = sags.enumerate().max_by(|a, b| a.1.1.0.total_cmp(&b.1.1.0))?;
    let place = sheet.size.place_in_words(at);
    let diagonal = sheet.size.width_mm.hypot(sheet.size.height_mm);
    let warning = Warning::new(
        "sheet-bent",
        format!(
            "the sheet is bent: in photograph {} by {sag:.1} mm from valley to peak ({} of its diagonal), most at the {place}",
            i + 1,
            percent(sag / diagonal)
        ),
        "tape the sheet to a flat board or a wall and take the photographs again; σ covers the bend as far as it has the shape of a \
         smooth surface",
    );
    let bends = solution.model().views.iter().zip(&solution.problem.priors.bends);
    let off = bends.flat_map(|(v, sigmas)| v.bend.0.iter().zip(sigmas).map(|(c, s)| (c / s).abs()));
    let beyond = off.fold(0.0, f64::max) > FAR_BENT;
    Some((warning, if beyond { Verdict::Weak } else { Verdict::Fair }))
}

/// Whether a projector's lens shift is so uncertain that its focal length hangs in the air with it.
fn shift_unknown(solution: &Solution, config: &CalibrateConfig) -> bool {
    shift_sigma(solution, config).is_some_and(|(_, sigma, extent)| sigma > SHIFT_UNKNOWN * extent)
}

/// The axis along which the projector's lens may be shifted, σ of its principal point there, px, and the panel's extent.
fn shift_sigma(solution: &Solution, config: &CalibrateConfig) -> Option<(LensParameter, f64, f64)> {
    let p = solution.model().projector?;
    let [axis, _] = config.shift_axes([p.width, p.height]);
    let extent = if axis == LensParameter::Cx { p.width } else { p.height };
    Some((axis, solution.sigma(Lens::Projector, axis)?, f64::from(extent)))
}

/// What σ would be if principal points were known exactly, where it is mostly them.
fn exact_would_be(solution: &Solution, sigma: &FocalSigma) -> Option<FocalSigma> {
    /// Below this σ it does not matter what limits it.
    const WORTH_TELLING: f64 = 0.005;
    if sigma.worst() < WORTH_TELLING {
        return None;
    }
    solution.with_exact_principal_points().filter(|exact| exact.worst() < 0.5 * sigma.worst())
}

fn principal_point_limited(exact: &FocalSigma, advice: &str) -> Warning {
    Warning::new(
        "principal-point-limited",
        format!(
            "if the principal point were known exactly, σ of the focal length would be {}",
            percent(exact.worst())
        ),
        advice,
    )
}

fn shift_undetermined(solution: &Solution, config: &CalibrateConfig) -> Option<Warning> {
    let (axis, sigma, extent) = shift_sigma(solution, config)?;
    let free = matches!(config.projector_pp, PrincipalPointRule::Shift | PrincipalPointRule::Free);
    let [along, across] =
        if axis == LensParameter::Cx { ["horizontal", "vertical"] } else { ["vertical", "horizontal"] };
    (free && sigma > SHIFT_UNDETERMINED * extent).then(|| {
        Warning::new(
            "lens-shift-undetermined",
            format!("the projector's {along} principal point is known to {sigma:.0} px only"),
            format!(
                "tilt the sheet about its {along} axis as well (a tilt about the {across} axis alone cannot separate lens shift \
                 from focal length), or give the principal point"
            ),
        )
    })
}

/// What is assumed of a panel that stands upright.
fn on_its_side(solution: &Solution, config: &CalibrateConfig) -> Option<Warning> {
    let p = solution.model().projector?;
    let upright = config.shift_axes([p.width, p.height])[0] == LensParameter::Cx;
    (upright && config.projector_pp == PrincipalPointRule::Shift).then(|| {
        Warning::new(
            "projector-on-its-side",
            format!(
                "the panel of {}x{} px stands upright: the projector is taken to lie on its side, with its lens shifted along \
                 the rows",
                p.width, p.height
            ),
            "if the projector does not lie on its side, set the display's rotation to normal and take the photographs again, or \
             give the projector's principal point",
        )
    })
}

fn misfits(solution: &Solution) -> Vec<Warning> {
    let mut warnings = Vec::new();
    for (kind, name, code) in
        [(Kind::Edge, "the sheet's edge points", "edge"), (Kind::Pair, "the projected corners", "corner")]
    {
        let [out, all] = solution.outliers(kind);
        let widened = solution.noise_left(kind);
        if widened > MISFIT {
            warnings.push(Warning::new(
                &format!("{code}-residuals-large"),
                format!("{name} lie {widened:.1} times further from the model than their noise explains"),
                "is the sheet as flat as was said and its size right, is a side covered or curled, was the lens's model or the principal \
                 point given rightly?",
            ));
        }
        let share = out as f64 / all.max(1) as f64;
        if share > MANY_OUTLIERS {
            warnings.push(Warning::new(
                &format!("{code}-outliers"),
                format!("{:.0} % of {name} do not fit the model and were left out", share * 100.0),
                "remove what covers the sheet's border, and check the overlay",
            ));
        }
    }
    warnings.extend(corner_misfit(solution));
    warnings
}

/// Photographs of one and the same pose.
fn poses_alike(solution: &Solution) -> Option<Warning> {
    let views = &solution.model().views;
    (1..views.len()).find_map(|j| {
        let i = views[..j].iter().position(|v| v.pose.rotation_vector_from(&views[j].pose).norm() < ALIKE)?;
        Some(Warning::new(
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
fn corner_misfit(solution: &Solution) -> Option<Warning> {
    let corners = solution.measured().filter(|(m, ..)| m.kind() == Kind::SheetCorner);
    let worst = corners.map(|(m, norm, _)| norm / m.sigma_px).fold(0.0, f64::max);
    (worst > 2.0 * MISFIT).then(|| {
        Warning::new(
            CORNERS_OFF,
            format!("a corner of the sheet lies {worst:.0} σ from the model"),
            "check the corners, their order (TL TR BR BL) and the sheet's size",
        )
    })
}
