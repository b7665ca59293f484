//! Whether the sheet is another one of the usual sizes than was given. Only the proportion of its sides shows: A3 given for A4
//! is never noticed.

use super::aspect::promised;
use super::misfit::{Misfit, misfit};
use super::outline_fit::Outlines;
use super::plausible::{is_ordinary, with_usual_focal};
use crate::calibrate::config::CalibrateConfig;
use crate::calibrate::maximum_likelihood::{problem, solve_camera};
use crate::estimate::Solution;
use crate::geometry::{RectangleSize, UsualSheet, usual_proportions};
use crate::observations::Observations;
use crate::rig::Warning;

/// From this misfit on, in σ, the size that was given is doubted: what is left of the residuals (per degree of freedom), what
/// another proportion promises to gain, and how far a parameter of the lens lies from what is expected.
const MISFITS: f64 = 2.0;
const DOUBTFUL: f64 = 16.0;
const FAR_FROM_PRIOR: f64 = 3.0;
/// χ² of the lens against its priors up to which nothing else is looked at; lenses drawn from the priors stay below.
const STRAINED: f64 = 9.0;
/// By how many σ another size must fit better, and within how many those that fit as well.
const CLEARLY: f64 = 5.0;
const AS_WELL: f64 = 3.0;
/// What the proportion of another size may be off, in χ² as a part of what the given one is off: it is then ten times nearer.
const NEARER: f64 = 0.01;
/// What another size may leave of the misfit that the given one has, where noise alone leaves more than it should.
const SHARE_LEFT: f64 = 0.25;
/// Code of the warning.
pub(crate) const CODE: &str = "other-size";
/// Proportions that are fitted: those that go with the outlines best, of some thirty. A fit of a wrong size may take as long as
/// a calibration.
const MOST_FITTED: usize = 4;
/// Most sheets that are listed.
const MOST_NAMED: usize = 3;

/// A proportion that was tried.
struct Tried {
    sheets: Vec<UsualSheet>,
    turned: bool,
    solution: Solution,
    misfit: Misfit,
}

/// A warning that names the usual sheets that fit the outlines clearly better than the given size, of which `given` is the
/// solution of the camera alone (`None` where it has none).
pub(crate) fn hint(
    observations: &Observations,
    config: &CalibrateConfig,
    given: Option<&Solution>,
) -> Option<Warning> {
    let sheet_alone = observations.of_camera();
    if given.is_some_and(|s| !is_doubtful(&sheet_alone, config, s)) {
        return None;
    }
    let size = observations.views.first()?.size;
    let config = &with_usual_focal(config, observations.camera);
    let given = given.and_then(|_| solve_camera(&sheet_alone, config).ok());
    let mut all = tried(&sheet_alone, config, size);
    all.sort_by(|a, b| a.misfit.chi2.total_cmp(&b.misfit.chi2));
    let best = all.first()?;
    let unit = best.misfit.per_row().max(1.0);
    // The given size has to fit from there, too: a search from afar may have ended on the way.
    let from_best = || {
        let mut start = best.solution.model().clone();
        let sizes = start.views.iter_mut().zip(&sheet_alone.views);
        sizes.for_each(|(sheet, seen)| sheet.size = seen.size);
        Solution::refine(problem(&sheet_alone, config, &start), start)
    };
    let again = given.is_some().then(from_best).flatten();
    let given = given.into_iter().chain(again);
    let before = given.map(|s| misfit(&s)).min_by(|a, b| a.chi2.total_cmp(&b.chi2));
    let fits = best.misfit.per_row() < before.map_or(MISFITS, |m| MISFITS.max(SHARE_LEFT * m.per_row()));
    let better = before.map_or(f64::INFINITY, |m| (m.chi2 - best.misfit.chi2) / unit);
    let is_the_given_turned = best.turned && same_proportion(best.sheets[0].size, size);
    // Where the outlines ask for a proportion between the usual ones, none is named. Papers are cut to a few parts in a thousand.
    let asks_for_more = || {
        let of_best = laid(&sheet_alone, best.sheets[0].size, best.turned);
        let most = unit * (AS_WELL * AS_WELL).max(if better.is_finite() { NEARER * better } else { 0.0 });
        promised(&of_best, config, &best.solution).is_some_and(|gain| gain > most)
    };
    if !fits || better < CLEARLY * CLEARLY || is_the_given_turned || asks_for_more() {
        return None;
    }
    let as_well = all.iter().filter(|t| t.misfit.chi2 < best.misfit.chi2 + AS_WELL * AS_WELL * unit);
    let sheets = as_well.flat_map(|t| t.sheets.iter().map(move |s| in_words(s, t.turned, size)));
    let names: Vec<String> = sheets.take(MOST_NAMED).collect();
    let against = match before {
        Some(m) => {
            format!("far better than the one given (χ² falls from {:.0} to {:.0})", m.chi2, best.misfit.chi2)
        }
        None => "and the one given does not fit at all".into(),
    };
    Some(Warning::new(
        CODE,
        format!(
            "the sheet is probably not {} x {} mm: the size of {} fits {against}",
            rounded(size.width_mm),
            rounded(size.height_mm),
            names.join(" or ")
        ),
        "measure the sheet and calibrate again with its size. Photographs show only the proportion of the sides: a sheet of the \
         same proportion in another size fits as well. If the size is right, the photograph was cropped, or a principal point \
         that was given is not",
    ))
}

/// Whether anything about the solution is far from what is expected of a sheet of the right size.
fn is_doubtful(sheet: &Observations, config: &CalibrateConfig, given: &Solution) -> bool {
    let lenses = given.problem.priors.lenses.iter();
    let off: Vec<f64> = lenses.filter_map(|p| p.stated_residual(given.model())).collect();
    // What another proportion gains is taken from the lens or from the residuals, so that most solutions need no test.
    let strained = off.iter().map(|off| off * off).sum::<f64>() > STRAINED;
    misfit(given).per_row() > MISFITS
        || !is_ordinary(given)
        || off.iter().any(|off| off.abs() > FAR_FROM_PRIOR)
        || strained && promised(sheet, config, given).is_some_and(|gain| gain > DOUBTFUL)
}

/// The fits of the usual proportions that come into question, both ways round, but that which was given.
fn tried(sheet: &Observations, config: &CalibrateConfig, given: RectangleSize) -> Vec<Tried> {
    let Some(outlines) = Outlines::new(sheet, config) else { return Vec::new() };
    let ways =
        usual_proportions(given).into_iter().flat_map(|p| [(p.sheets.clone(), false), (p.sheets, true)]);
    let others = ways.filter(|(sheets, turned)| *turned || !same_proportion(sheets[0].size, given));
    let mut rough: Vec<(f64, Vec<UsualSheet>, bool)> = others
        .map(|(sheets, turned)| {
            let laid = laid(sheet, sheets[0].size, turned);
            let sizes: Vec<RectangleSize> = laid.views.iter().map(|v| v.size).collect();
            (outlines.chi2(&sizes), sheets, turned)
        })
        .collect();
    rough.sort_by(|a, b| a.0.total_cmp(&b.0));
    let fit = |(_, sheets, turned): (f64, Vec<UsualSheet>, bool)| {
        let solution = solve_camera(&laid(sheet, sheets[0].size, turned), config).ok()?;
        let misfit = misfit(&solution);
        Some(Tried { sheets, turned, solution, misfit })
    };
    rough.into_iter().take(MOST_FITTED).filter_map(fit).collect()
}

/// The observations with sheets of another size (upright), which lie as the given ones or, `turned`, the other way round.
fn laid(sheet: &Observations, upright: RectangleSize, turned: bool) -> Observations {
    let mut laid = sheet.clone();
    for view in &mut laid.views {
        let across = view.size.width_mm > view.size.height_mm;
        view.size = if across == turned { upright } else { upright.transposed() };
    }
    laid
}

/// Whether the sides have one proportion, as far as sheets that people cut and measure can be told apart by it: A4, B5 and
/// 50 x 70 cm cannot.
fn same_proportion(a: RectangleSize, b: RectangleSize) -> bool {
    const ALIKE: f64 = 0.012;
    (a.elongation() / b.elongation()).ln().abs() < ALIKE
}

/// "letter (279.4 x 215.9 mm)": lying as the given size or, `turned`, the other way round.
fn in_words(sheet: &UsualSheet, turned: bool, given: RectangleSize) -> String {
    let across = (given.width_mm > given.height_mm) != turned;
    let size = if across { sheet.size.transposed() } else { sheet.size };
    format!("{} ({} x {} mm)", sheet.name, rounded(size.width_mm), rounded(size.height_mm))
}

/// To a tenth of a millimetre.
fn rounded(mm: f64) -> f64 {
    (10.0 * mm).round() / 10.0
}
