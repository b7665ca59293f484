//! What the estimate assumes, and by how much each assumption would move it: the problem is solved again with the changed
//! assumption, from the solution as the start. (Derivatives at the solution are wrong at departures of 5 to 10 %.)

mod departure;

use self::departure::{Departure, of_inliers};
use crate::assumption::{Assumption, AssumptionStatus, Moves};
use crate::calibrate::config::CalibrateConfig;
use crate::calibrate::hypotheses::shown_scale::ShownScale;
use crate::estimate::{BundleAdjustment, Lens, Model, Solution};
use crate::parameter::LensParameter;
use crate::solve::{INITIAL_DAMPING, minimise_from, undamped};

/// Moves are of interest to two digits: χ² is minimised to this.
const DECREASE: f64 = 1e-3;
/// Steps towards a changed assumption; the solution is near, and four or five are common.
const UNDAMPED_STEPS: usize = 12;
/// From so many σ on the photographs contradict a departure, and from this increase of χ².
const TESTED_SIGMAS: f64 = 5.0;
const CONTRADICTED: f64 = TESTED_SIGMAS * TESTED_SIGMAS;
/// The assumption that the border of the light tests.
const SHOWN: &str = "shown-1:1";
/// A parameter whose σ the photographs bring below this part of its prior is estimated.
const ESTIMATED: f64 = 0.5;

/// Ordinary departures: of pixel aspects (pictures are stretched by 1 % and more), principal points and scales (shares of the
/// width), k1 of a projector, the width of a sheet, its curl (share of the diagonal, valley to peak), px of bands of light.
const ASPECT: f64 = 0.01;
const SHIFT: f64 = 0.05;
const SCALE: f64 = 0.05;
const PROJECTOR_K1: f64 = 0.02;
const WIDTH: f64 = 0.01;
const CURL: f64 = 0.003;
const BANDS_PX: f64 = 0.02;

/// An assumption before its cost is known.
struct Assumed {
    code: &'static str,
    text: String,
    unit: &'static str,
    value: f64,
    sigma: Option<f64>,
    if_off_by: f64,
    /// What to change, by an amount in the departure's own unit; the costliest one is told.
    departures: Vec<(Departure, f64)>,
    /// The photographs determine the value.
    estimated: bool,
}

/// Value, 1σ and status of a lens parameter in its own unit: what the photographs say where they say more than the prior.
fn known(
    solution: &Solution,
    lens: Lens,
    parameter: LensParameter,
    expected: f64,
) -> (f64, Option<f64>, bool) {
    let prior = solution.problem.priors.lenses.iter().find(|p| (p.lens, p.parameter) == (lens, parameter));
    match (prior, solution.sigma(lens, parameter)) {
        (Some(prior), Some(sigma)) if sigma < ESTIMATED * prior.sigma => {
            (prior.value(solution.model()).unwrap_or(prior.mean), Some(sigma), true)
        }
        (Some(prior), Some(_)) => (prior.mean, Some(prior.sigma), false),
        _ => (expected, None, false),
    }
}

fn aspect(solution: &Solution, lens: Lens) -> Option<Assumed> {
    let k = solution.model().lens(lens)?.intrinsics;
    let (ln, sigma, estimated) = known(solution, lens, LensParameter::Aspect, (k.fy / k.fx).ln());
    let (code, owner) = match lens {
        Lens::Camera => ("square-pixels-camera", "camera"),
        Lens::Projector => ("square-pixels-projector", "projector"),
    };
    let value = ln.exp();
    let shape = if (value - 1.0).abs() < 0.005 {
        "square".to_owned()
    } else {
        format!("{value:.3} times as wide as high")
    };
    Some(Assumed {
        code,
        text: format!("the {owner}'s pixels are {shape}"),
        unit: "fy/fx",
        value,
        sigma: sigma.map(|s| s * value),
        if_off_by: ASPECT * value,
        departures: vec![(Departure::Lens(lens, LensParameter::Aspect), ASPECT)],
        estimated,
    })
}

/// The axis across that along which a lens shift is expected.
fn sideways_shift(solution: &Solution, config: &CalibrateConfig) -> Option<Assumed> {
    let p = solution.model().projector?;
    let size = [p.width, p.height];
    let [_, axis] = config.shift_axes(size);
    let middle = config.projector_pp.start(size);
    let (middle, extent) = if axis == LensParameter::Cx { (middle.x, size[0]) } else { (middle.y, size[1]) };
    let extent = f64::from(extent);
    let (value, sigma, estimated) = known(solution, Lens::Projector, axis, middle);
    let percent = |px: f64| 100.0 * px / extent;
    Some(Assumed {
        code: "projector-sideways-shift",
        text: "the projector's lens is not shifted sideways".to_owned(),
        unit: "% of the width",
        value: percent(value - middle),
        sigma: sigma.map(percent),
        if_off_by: 100.0 * SHIFT,
        departures: vec![(Departure::Lens(Lens::Projector, axis), SHIFT * extent)],
        estimated,
    })
}

fn undistorted(solution: &Solution) -> Option<Assumed> {
    solution.model().projector?;
    let (value, sigma, estimated) = known(solution, Lens::Projector, LensParameter::K1, 0.0);
    Some(Assumed {
        code: "projector-undistorted",
        text: "the projector's lens does not distort".to_owned(),
        unit: "k1",
        value,
        sigma,
        if_off_by: PROJECTOR_K1,
        departures: vec![(Departure::Lens(Lens::Projector, LensParameter::K1), PROJECTOR_K1)],
        estimated,
    })
}

fn uncropped(solution: &Solution, config: &CalibrateConfig) -> Assumed {
    let camera = solution.model().camera;
    let middle = config.camera_pp.start([camera.width, camera.height]);
    let axes = [(LensParameter::Cx, middle.x), (LensParameter::Cy, middle.y)];
    let of_axes = axes.map(|(axis, at)| {
        let (value, sigma, estimated) = known(solution, Lens::Camera, axis, at);
        (value - at, sigma, estimated)
    });
    // The axis of which less is known stands for both.
    let (value, sigma, estimated) = if of_axes[0].2 { of_axes[1] } else { of_axes[0] };
    let width = f64::from(camera.width);
    Assumed {
        code: "not-cropped",
        text: "the photograph is not cropped off centre".to_owned(),
        unit: "% of the width",
        value: 100.0 * value / width,
        sigma: sigma.map(|s| 100.0 * s / width),
        if_off_by: 100.0 * SHIFT,
        departures: axes.map(|(axis, _)| (Departure::Lens(Lens::Camera, axis), SHIFT * width)).to_vec(),
        estimated,
    }
}

fn shown_one_to_one(solution: &Solution) -> Option<Assumed> {
    solution.model().projector?;
    Some(Assumed {
        code: SHOWN,
        text: "the pattern was shown pixel by pixel, without scaling".to_owned(),
        unit: "%",
        value: 100.0,
        sigma: None,
        if_off_by: 100.0 * SCALE,
        // Shown at 95 %, a picture's pixels are those of one 1/0.95 times as large.
        departures: vec![(Departure::ShownScale, 1.0 / (1.0 - SCALE) - 1.0)],
        estimated: false,
    })
}

fn steady_light() -> Assumed {
    Assumed {
        code: "steady-light",
        text: "the light was steady while the photograph was exposed".to_owned(),
        unit: "px",
        value: 0.0,
        sigma: None,
        if_off_by: BANDS_PX,
        departures: vec![(Departure::LightBands(0), BANDS_PX), (Departure::LightBands(1), BANDS_PX)],
        estimated: false,
    }
}

fn flat(solution: &Solution, config: &CalibrateConfig) -> Option<Assumed> {
    let sheet = solution.model().views.first()?;
    let sag = CURL * sheet.size.width_mm.hypot(sheet.size.height_mm);
    let learned = solution.bend_widths[0];
    let text =
        if config.flatness.is_flat() { "the sheet is flat" } else { "the sheet is flat to within its σ" };
    Some(Assumed {
        code: "sheet-flat",
        text: text.to_owned(),
        unit: "mm",
        value: 0.0,
        sigma: (!config.flatness.is_flat()).then(|| config.flatness.sigma_mm(sheet.size) * learned),
        if_off_by: sag,
        departures: vec![(Departure::Curl, sag)],
        estimated: false,
    })
}

fn size(solution: &Solution) -> Option<Assumed> {
    let size = solution.model().views.first()?.size;
    Some(Assumed {
        code: "size",
        text: format!("the sheet measures {:.1} x {:.1} mm", size.width_mm, size.height_mm),
        unit: "mm",
        value: size.width_mm,
        sigma: None,
        if_off_by: WIDTH * size.width_mm,
        departures: vec![(Departure::Width, WIDTH), (Departure::Scale, WIDTH)],
        estimated: false,
    })
}

/// What departures are compared with.
struct Base<'a> {
    model: &'a Model,
    problem: BundleAdjustment,
    chi2: f64,
}

impl Base<'_> {
    /// What a departure does: the moves, and by how much χ² grows.
    fn departed(&self, departure: Departure, amount: f64) -> Option<(Moves, f64)> {
        let (problem, start) = departure.apply(&self.problem, self.model, amount)?;
        let (model, cost) = solve_again(&problem, start)?;
        Some((moves(self.model, &model), cost - self.chi2))
    }
}

fn solve_again(problem: &BundleAdjustment, start: Model) -> Option<(Model, f64)> {
    let minimum = undamped(problem, start.clone(), DECREASE, UNDAMPED_STEPS)
        .or_else(|| minimise_from(problem, start, INITIAL_DAMPING, DECREASE))?;
    Some((minimum.state, minimum.cost))
}

fn moves(from: &Model, to: &Model) -> Moves {
    let percent = |a: f64, b: f64| Some(100.0 * (b / a - 1.0)).filter(|p| p.is_finite());
    let both = from.projector.zip(to.projector);
    let baseline = |m: &Model| m.projector_from_camera.translation.norm();
    Moves {
        f_cam: percent(from.camera.intrinsics.fx, to.camera.intrinsics.fx),
        f_proj: both.and_then(|(a, b)| percent(a.intrinsics.fx, b.intrinsics.fx)),
        baseline: both.and_then(|_| percent(baseline(from), baseline(to))),
    }
}

/// What a calibration assumes and what each assumption would cost if it were wrong.
pub(crate) fn assumptions(
    solution: &Solution,
    config: &CalibrateConfig,
    shown: Option<&ShownScale>,
) -> Vec<Assumption> {
    let unknown_camera = config.known_camera.is_none();
    let all = [
        aspect(solution, Lens::Camera).filter(|_| unknown_camera),
        aspect(solution, Lens::Projector),
        sideways_shift(solution, config),
        undistorted(solution),
        unknown_camera.then(|| uncropped(solution, config)),
        shown_one_to_one(solution),
        Some(steady_light()),
        flat(solution, config),
        size(solution),
    ];
    let (model, problem) = (solution.model(), of_inliers(solution));
    let Some((_, chi2)) = solve_again(&problem, model.clone()) else { return Vec::new() };
    let base = Base { model, problem, chi2 };
    let mut all: Vec<Assumption> = all.into_iter().flatten().map(|assumed| assess(&base, assumed)).collect();
    // The border of the light tells what the geometry cannot.
    if let Some((sigma, a)) = shown.and_then(ShownScale::tested).zip(all.iter_mut().find(|a| a.code == SHOWN))
        && sigma < SCALE / TESTED_SIGMAS
    {
        (a.status, a.sigma) = (AssumptionStatus::Tested, Some(100.0 * sigma));
    }
    all
}

fn assess(base: &Base, assumed: Assumed) -> Assumption {
    let Assumed { code, text, unit, value, sigma, if_off_by, departures, estimated } = assumed;
    let both = departures.into_iter().flat_map(|(d, amount)| [(d, amount), (d, -amount)]);
    let tried: Vec<_> = both.filter_map(|(d, amount)| base.departed(d, amount)).collect();
    let against = tried.iter().map(|(_, more)| *more).fold(f64::INFINITY, f64::min);
    let tested = !estimated && !tried.is_empty() && against > CONTRADICTED;
    // What the photographs contradict has no cost, unless they contradict all of it.
    let possible = tried.iter().filter(|(_, more)| tested || *more <= CONTRADICTED).map(|(moves, _)| *moves);
    let moves = possible.max_by(|a, b| a.worst().total_cmp(&b.worst()));
    let status = if estimated {
        AssumptionStatus::Estimated
    } else if tested {
        AssumptionStatus::Tested
    } else {
        AssumptionStatus::Assumed
    };
    Assumption {
        code: code.to_owned(),
        text,
        value,
        unit: unit.to_owned(),
        sigma: if tested { Some(if_off_by / against.sqrt()) } else { sigma },
        if_off_by,
        moves_percent: moves.unwrap_or_default(),
        status,
    }
}
