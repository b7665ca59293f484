//! Sub-pixel points on a side of the sheet.
//!
//! A steep side is measured once per image row, a flat one once per column (`scan`). It is located roughly, and then by a
//! fit of a blurred step to the light across it (`profile`, `step_model`). Consistent crossings are reduced to points
//! (`crossing`). The side face of a thick board shows as a second step (`side_face`); parts of a side that something covers
//! or that bend away are left out (`coverage`).

mod coverage;
mod crossing;
mod profile;
mod scan;
mod side_face;
mod step_model;

use std::ops::RangeInclusive;

use nalgebra::{Point2, Vector2};

use super::projector_footprint::ProjectedEdges;
use crate::detect::erf::ErfTable;
use crate::observations::EdgePoint;
use crate::photo::LinearPhoto;
use crate::solve::Polynomial;
use coverage::Coverage;
use crossing::{CURVE_DEGREE, Crossing, condense, robust_curve};
use profile::Profiles;
use scan::Scan;
use side_face::SideFace;
use step_model::Common;

/// Part of a side next to each corner that is ignored: the blur of the adjacent side affects it.
const CORNER_MARGIN: f64 = 0.02;
/// Approximate maximum number of lines of the first pass.
const COARSE_LINES: usize = 160;
/// Neighbouring lines are averaged before the fit while at least this many profiles of a side remain. That loses no
/// information, and the expensive fit is done once for all of them.
const MIN_PROFILES: usize = 240;
/// Averaged lines spread the side by at most this part of its blur. A box of this width adds 2 % to the blur, and a
/// symmetric blur does not move the crossing.
const MAX_SPREAD_BLURS: f64 = 0.7;
/// Steps of the fit across the side, in the first pass and in the second, which starts from its result.
const FIRST_ROUNDS: usize = 5;
const ROUNDS: usize = 2;
/// A side is extrapolated by this part of its measured length.
const MOST_BEYOND: f64 = 0.05;
/// Fewest crossings of a side, and their least share of the attempts.
const MIN_CROSSINGS: usize = 12;
const MIN_SHARE: f64 = 0.3;
/// Blurs from the middle of a step to where it is flat.
const BLURS: f64 = 3.0;
/// The transition between the plateaus is at least this far wide on each side: a sharp edge across a pixel, slanted by
/// up to 45°, ends within it.
const MIN_HALF_TRANSITION_PX: f64 = 1.5;
/// Number of pixels beyond half the transition's width from which the slopes of the light are estimated. With fewer,
/// their error moves the whole side.
const PLATEAU_PX: f64 = 4.0;
/// The same next to the border of the frame.
const NARROW_PLATEAU_PX: f64 = 2.0;

/// A side face is searched for within this many times the uncertainty of the side. Edges further apart than that are two
/// lines in the downsampled image, and the inner one is chosen there.
const FACE_REACH: f64 = 3.0;
/// The sheet's edge beside a face is uneven by this many times as much as other edges are.
const FACE_UNEVENNESS: f64 = 3.0;

/// A side that was measured.
#[derive(Debug, Clone)]
pub(super) struct MeasuredSide {
    /// Points on the sheet's own edge.
    pub(super) points: Vec<EdgePoint>,
    /// The narrowest and the widest part of the side face beside it, px, if there is one.
    pub(super) face_px: Option<[f64; 2]>,
    /// The part of the side that something covers. It is left out.
    pub(super) covered: f64,
    /// The part of the side, at an end, that bends away from the rest. It is left out.
    pub(super) bent: f64,
}

/// Measures the side that runs along `path` (a few points from corner to corner), known to within `uncertainty_px`, with
/// the sheet on the side of `inward`. A side face is looked for if `with_face`. `None` when too little of it is visible.
pub(super) fn measure_side(
    photo: &LinearPhoto<'_>,
    path: &[Point2<f64>],
    inward: Vector2<f64>,
    uncertainty_px: f64,
    projected: &ProjectedEdges<'_>,
    with_face: bool,
) -> Option<MeasuredSide> {
    let scan = Scan::new(inward);
    let search = Search { photo, scan, uncertainty_px, projected };
    let lines = search.scan_lines(path)?;
    // In a large photograph a subset of the lines gives the position and the width of the side.
    let stride = lines.len().div_ceil(COARSE_LINES);
    let some: Vec<(usize, f64)> = lines.iter().copied().step_by(stride).collect();
    let (coarse, mut supported) = search.localise(&some)?;
    let toward_sheet = inward.normalize();
    let face = with_face.then(|| search.side_face(&some, &coarse, &supported, toward_sheet)).flatten();
    let (coarse, transition, start) = if let Some(f) = &face {
        let transition = (BLURS * f.blur).max(MIN_HALF_TRANSITION_PX) + 1.0;
        (f.edge.clone(), transition, Common { blur: f.blur, slopes: [0.0; 2] })
    } else {
        let transition = search.half_transition(&some, &coarse);
        (coarse, transition, Common::start(transition))
    };
    let plateau = search.plateau(&some, &coarse, transition);
    let width = face.as_ref().map_or(0.0, |f| f.widths[1]);
    let transition = transition + width.ceil();
    let clearance = transition + plateau + 1.0;
    let erf = ErfTable::new();
    let mut curve = coarse;
    let (mut crossings, mut tried, mut common_sigma, mut span) = (Vec::new(), 0, 0.0, 0.0);
    let (mut common, mut located_all) = (start, Vec::new());
    // The second pass starts from the position and the common parameters of the first one.
    for (lines, rounds, average) in [(&some, FIRST_ROUNDS, false), (&lines, ROUNDS, true)] {
        let clear =
            |line: f64| projected.leaves_clear(scan.join(line, curve.value(line)), toward_sheet, clearance);
        // Beyond the crossings the curve may leave the path, where the side is not visible.
        let near =
            |line: f64, expected: f64| (curve.value(line) - expected).abs() <= uncertainty_px + width + 1.0;
        let seen: Vec<(usize, f64)> = lines
            .iter()
            .filter(|&&(line, _)| supported.contains(&(line as f64)))
            .filter(|&&(line, expected)| near(line as f64, expected) && clear(line as f64))
            .map(|&(line, _)| (line, curve.value(line as f64)))
            .collect();
        let together = if average { averaged(&seen, common.blur) } else { 1 };
        let located = Profiles::take(photo, scan, &seen, [transition, plateau], together).locate(
            &erf,
            &curve,
            common,
            rounds,
            face.as_ref(),
        )?;
        (crossings, tried, common_sigma) = (located.crossings, located.tried, located.common_sigma);
        common = located.common;
        span = 0.5 * (together * located.together * if average { 1 } else { stride }) as f64 + 1.0;
        located_all.clone_from(&crossings);
        curve = robust_curve(&mut crossings)?;
        supported = support(&crossings)?;
    }
    if crossings.len() < MIN_CROSSINGS || (crossings.len() as f64) < MIN_SHARE * tried as f64 {
        return None;
    }
    let across = if scan.along_x { inward.x.abs() } else { inward.y.abs() } / inward.norm();
    let expected = search.lines_to_be_seen(&lines, &curve, toward_sheet, [clearance, width]);
    // The width of a face is known to some hundredths of the blur, and moves the edge by as much.
    let evenness = common.blur * if face.is_some() { FACE_UNEVENNESS } else { 1.0 };
    let mut coverage =
        Coverage::of(&expected, [&crossings, &located_all], &curve, span, [evenness, transition]);
    if !coverage.left_out.is_empty() {
        let mut rest: Vec<Crossing> = crossings.iter().copied().filter(|c| coverage.leaves(c.line)).collect();
        match robust_curve(&mut rest).filter(|_| rest.len() >= MIN_CROSSINGS) {
            Some(through) => (crossings, curve) = (rest, through),
            None => coverage = Coverage::default(),
        }
    }
    let separated = |a: &Crossing, b: &Crossing| coverage.separates(a, b);
    Some(MeasuredSide {
        points: condense(scan, &crossings, separated, &curve, across, common_sigma),
        face_px: face.map(|f| f.widths.map(|w| w * across)),
        covered: coverage.covered,
        bent: coverage.bent,
    })
}

/// How many neighbouring lines of a side may be averaged. Shifted by whole pixels they spread it by at most one, and by
/// less when it runs so steeply along them that it does not shift by one.
fn averaged(lines: &[(usize, f64)], blur: f64) -> usize {
    let most = (lines.len() / MIN_PROFILES).max(1);
    let (Some(a), Some(b)) = (lines.first(), lines.last()) else { return 1 };
    let slope = (b.1 - a.1).abs() / (b.0 as f64 - a.0 as f64).max(1.0);
    let spread = MAX_SPREAD_BLURS * blur;
    if spread >= 1.0 { most } else { ((spread / slope.max(1e-9)) as usize).clamp(1, most) }
}

/// Where a side is searched for.
struct Search<'a> {
    photo: &'a LinearPhoto<'a>,
    scan: Scan,
    /// How far the side may be from where it is expected.
    uncertainty_px: f64,
    projected: &'a ProjectedEdges<'a>,
}

impl Search<'_> {
    /// The rows or columns that the side crosses, away from its corners, with the position expected there.
    fn scan_lines(&self, path: &[Point2<f64>]) -> Option<Vec<(usize, f64)>> {
        let Self { photo, scan, uncertainty_px, .. } = *self;
        let samples: Vec<(f64, f64, f64)> =
            path.iter().map(|&p| scan.split(p)).map(|(l, p)| (l, p, 1.0)).collect();
        let curve = Polynomial::fit(&samples, CURVE_DEGREE.min(path.len() - 1))?;
        let (a, b) = (samples.first()?.0, samples.last()?.0);
        let (from, to) = (a.min(b), a.max(b));
        let margin = CORNER_MARGIN * (to - from) + uncertainty_px.min(0.1 * (to - from)) + 2.0;
        let first = (from + margin).ceil().max(0.0);
        let last = (to - margin).floor().min(scan.lines(photo) as f64 - 1.0);
        if !(first.is_finite() && last.is_finite() && last > first) {
            return None;
        }
        Some((first as usize..=last as usize).map(|line| (line, curve.value(line as f64))).collect())
    }

    /// The curve along the strongest steps from dark to bright near the expected positions, and the lines that it holds for.
    fn localise(&self, lines: &[(usize, f64)]) -> Option<(Polynomial, RangeInclusive<f64>)> {
        let Self { photo, scan, uncertainty_px, projected } = *self;
        let reach = (uncertainty_px.ceil() as isize).max(2);
        // The step is measured between means over some pixels, so that noise does not exceed it at full resolution.
        let arm = (reach / 3).clamp(1, 8);
        let mut found: Vec<(f64, f64)> = Vec::with_capacity(lines.len());
        let mut steps = Vec::with_capacity(2 * reach as usize + 1);
        for &(line, expected) in lines {
            let first = expected.round() as isize - reach;
            let step = |s: isize| {
                let arm_sum = |from: isize, to: isize| -> Option<f64> {
                    (from..=to).map(|p| scan.pixel(photo, line, p)).sum()
                };
                Some((arm_sum(s + 1, s + arm)? - arm_sum(s - arm + 1, s)?) * scan.toward)
            };
            steps.clear();
            steps.extend((first..=first + 2 * reach).map(|s| step(s).unwrap_or(f64::NEG_INFINITY)));
            // The footprint's border is a stronger step than an unlit side of the sheet, and is ignored.
            let side = |k: usize| {
                let around = &steps[k.saturating_sub(1)..(k + 2).min(steps.len())];
                let position = (first + k as isize) as f64 + 0.5;
                let at_border =
                    || projected.distance_px(scan.join(line as f64, position)) <= arm as f64 + 1.5;
                (steps[k] > 0.0 && around.iter().all(|s| *s <= steps[k]) && !at_border())
                    .then_some((steps[k], position))
            };
            let best = (0..steps.len()).filter_map(side).reduce(|a, b| if b.0 > a.0 { b } else { a });
            found.extend(best.map(|(_, position)| (line as f64, position)));
        }
        let mut crossings: Vec<Crossing> =
            found.into_iter().map(|(line, position)| Crossing { line, position, sigma: 1.0 }).collect();
        let curve = robust_curve(&mut crossings)?;
        Some((curve, support(&crossings)?))
    }

    /// The lines on which nothing but a cover can hide the side that lies on `curve`: it is in the frame and lit, and clear
    /// of the projected edges.
    fn lines_to_be_seen(
        &self,
        lines: &[(usize, f64)],
        curve: &Polynomial,
        toward_sheet: Vector2<f64>,
        [clearance, face_px]: [f64; 2],
    ) -> Vec<f64> {
        let Self { photo, scan, uncertainty_px, projected } = *self;
        let seen = |&&(line, expected): &&(usize, f64)| {
            let position = curve.value(line as f64);
            let at = scan.join(line as f64, position);
            let inside = |p: f64| scan.pixel(photo, line, p as isize).is_some();
            (position - expected).abs() <= uncertainty_px + face_px + 1.0
                && inside(position - clearance)
                && inside(position + clearance)
                && projected.lights(at)
                && projected.leaves_clear(at, toward_sheet, clearance)
        };
        lines.iter().filter(seen).map(|l| l.0 as f64).collect()
    }

    /// The side face of a board along the side.
    fn side_face(
        &self,
        lines: &[(usize, f64)],
        curve: &Polynomial,
        supported: &RangeInclusive<f64>,
        toward_sheet: Vector2<f64>,
    ) -> Option<SideFace> {
        let Self { photo, scan, uncertainty_px, projected } = *self;
        let reach = FACE_REACH * uncertainty_px;
        let clear: Vec<(usize, f64)> = lines
            .iter()
            .map(|l| (l.0, curve.value(l.0 as f64)))
            .filter(|l| supported.contains(&(l.0 as f64)))
            .filter(|&(line, position)| {
                projected.leaves_clear(scan.join(line as f64, position), toward_sheet, reach)
            })
            .collect();
        SideFace::find(photo, scan, &clear, reach)
    }

    /// Half the width of the transition, px: where the mean profile across the side becomes flat.
    fn half_transition(&self, lines: &[(usize, f64)], curve: &Polynomial) -> f64 {
        let Self { photo, scan, uncertainty_px, projected } = *self;
        let reach = (2.0 * uncertainty_px).ceil().clamp(6.0, 40.0) as isize;
        let bins = (2 * reach) as usize;
        let mut gradient = vec![0.0; bins];
        // The footprint's border is another step, which would count as blur.
        let clear = |line: f64| projected.distance_px(scan.join(line, curve.value(line))) > reach as f64;
        let any = lines.iter().any(|l| clear(l.0 as f64));
        for line in lines.iter().map(|l| l.0).filter(|&line| !any || clear(line as f64)) {
            let position = curve.value(line as f64);
            let base = position.floor() as isize;
            for (bin, sum) in gradient.iter_mut().enumerate() {
                let s = base - reach + bin as isize;
                if let (Some(p), Some(q)) = (scan.pixel(photo, line, s), scan.pixel(photo, line, s + 1)) {
                    *sum += (q - p) * scan.toward;
                }
            }
        }
        let middle = bins / 2;
        let peak =
            gradient[middle.saturating_sub(3)..(middle + 3).min(bins)].iter().copied().fold(0.0, f64::max);
        let quiet = |i: usize| gradient[i] < 0.06 * peak;
        let right = (middle..bins - 1).find(|&i| quiet(i) && quiet(i + 1)).unwrap_or(bins - 1) - middle;
        let left = middle - (1..=middle).rev().find(|&i| quiet(i) && quiet(i - 1)).unwrap_or(0);
        (right.max(left) as f64).max(MIN_HALF_TRANSITION_PX) + 1.0
    }
    /// Width of the plateaus, px: the wider one unless the frame ends within it along much of the side.
    fn plateau(&self, lines: &[(usize, f64)], curve: &Polynomial, transition: f64) -> f64 {
        let Self { photo, scan, .. } = *self;
        let with = |extra: f64| (0.5 * transition).ceil() + extra;
        let size = if scan.along_x { photo.width() } else { photo.height() } as f64;
        let reach = transition + with(PLATEAU_PX) + 1.0;
        let fitting =
            lines.iter().map(|l| curve.value(l.0 as f64)).filter(|p| (reach..size - reach).contains(p));
        let enough = 2 * fitting.count() >= lines.len();
        with(if enough { PLATEAU_PX } else { NARROW_PLATEAU_PX })
    }
}

/// The lines for which a curve through these crossings is valid. A cubic is unreliable beyond them, and along the
/// footprint's border much of a side may be invisible.
fn support(crossings: &[Crossing]) -> Option<RangeInclusive<f64>> {
    let (from, to) = (crossings.first()?.line, crossings.last()?.line);
    let beyond = MOST_BEYOND * (to - from);
    Some(from - beyond..=to + beyond)
}
