//! Sub-pixel points on a side of the sheet.
//!
//! A steep side is measured once per image row, a flat one once per column: the light between the two plateaus,
//! summed over whole pixels, is an integral over their areas, so the position it gives does not depend on where the
//! side falls on the pixel grid, nor on blur that is symmetric, nor on any interpolation.

use std::f64::consts::SQRT_2;

use nalgebra::{Point2, Vector2};

use super::board::Board;
use super::lens::Lens;
use super::light_field::LightField;
use crate::observations::EdgePoint;
use crate::pattern::CheckerPattern;
use crate::photo::GreyImage;
use crate::solve::Polynomial;

/// Part of a side next to each corner that is left out: there the other side's blur shines in.
const CORNER_MARGIN: f64 = 0.02;
/// Degree of the curve that a side may follow: an image of a straight line through an ordinary lens.
const CURVE_DEGREE: usize = 3;
/// Crossings further from the curve than this many robust standard deviations are not the side's.
const REJECT_SIGMAS: f64 = 3.5;
/// Points per side, each the mean over neighbouring crossings: more would say nothing new.
const MAX_POINTS: usize = 80;
/// A side needs this many crossings, and this share of those that were tried.
const MIN_CROSSINGS: usize = 12;
const MIN_SHARE: f64 = 0.3;
/// The transition between the plateaus is at least this far wide on each side: a sharp edge across a pixel, slanted by
/// up to 45°, ends within it.
const MIN_HALF_TRANSITION_PX: f64 = 1.5;
/// Weakest step, as a part of the side's median step, that is still measured (an unlit part of the sheet).
const MIN_RELATIVE_STEP: f64 = 0.1;
/// Standard deviation that no point goes below, px: what remains of the light's bleeding and shading on
/// rendered sheets with exact truth.
const FLOOR_SIGMA_PX: f64 = 0.01;

/// How a side is scanned: one crossing per row (steep sides) or per column (flat ones).
#[derive(Debug, Clone, Copy)]
struct Scan {
    /// Crossings are searched along x (rows) or along y (columns).
    along_x: bool,
    /// +1 when the sheet lies towards larger coordinates.
    toward: f64,
}

impl Scan {
    fn new(inward: Vector2<f64>) -> Self {
        let along_x = inward.x.abs() >= inward.y.abs();
        let component = if along_x { inward.x } else { inward.y };
        Self { along_x, toward: component.signum() }
    }

    /// (line, position) of a point: which row or column, and where on it.
    fn split(self, p: Point2<f64>) -> (f64, f64) {
        if self.along_x { (p.y, p.x) } else { (p.x, p.y) }
    }

    fn join(self, line: f64, position: f64) -> Point2<f64> {
        if self.along_x { Point2::new(position, line) } else { Point2::new(line, position) }
    }

    fn lines(self, image: &GreyImage) -> usize {
        if self.along_x { image.height() } else { image.width() }
    }

    /// The pixel at an integer position of a line, or `None` outside the frame.
    fn pixel(self, image: &GreyImage, line: usize, position: isize) -> Option<f64> {
        let position = usize::try_from(position).ok()?;
        let (x, y) = if self.along_x { (position, line) } else { (line, position) };
        (x < image.width() && y < image.height()).then(|| f64::from(image.at(x, y)))
    }
}

/// Measures the side that runs along `path` (a few points from corner to corner), known to within `uncertainty_px`, with
/// the sheet on the side of `inward`. `None` when too little of it is seen.
pub(super) fn measure_side(
    grey: &GreyImage,
    path: &[Point2<f64>],
    inward: Vector2<f64>,
    uncertainty_px: f64,
    light: &Light<'_>,
) -> Option<Vec<EdgePoint>> {
    let scan = Scan::new(inward);
    let lines = scan_lines(grey, scan, path, uncertainty_px)?;
    let coarse = localise(grey, scan, &lines, uncertainty_px, light)?;
    let transition = half_transition(grey, scan, &lines, &coarse, uncertainty_px, light);
    let plateau = (0.5 * transition).ceil() + 2.0;
    let clearance = transition + plateau + 1.0;
    let mut curve = coarse;
    let (mut crossings, mut tried) = (Vec::new(), 0);
    // The second pass has its windows where the first found the side.
    for _ in 0..2 {
        let clear = |line: f64| light.distance_px(scan.join(line, curve.value(line))) > clearance;
        // Beyond the crossings it was fitted to, the curve may leave the path: there the side is not seen.
        let near = |line: f64, expected: f64| (curve.value(line) - expected).abs() <= uncertainty_px + 1.0;
        let profiles: Vec<Profile> = lines
            .iter()
            .filter(|&&(line, expected)| clear(line as f64) && near(line as f64, expected))
            .filter_map(|l| Profile::take(grey, scan, l.0, curve.value(l.0 as f64), transition, plateau))
            .collect();
        tried = profiles.len();
        crossings = locate(scan, &profiles)?;
        curve = robust_curve(&mut crossings)?;
    }
    if crossings.len() < MIN_CROSSINGS || (crossings.len() as f64) < MIN_SHARE * tried as f64 {
        return None;
    }
    let across = if scan.along_x { inward.x.abs() } else { inward.y.abs() } / inward.norm();
    Some(condense(scan, &crossings, &curve, across))
}

/// The edges of the projected light, its border and the pattern's squares, in the photograph as it is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Light<'a> {
    pub(super) field: &'a LightField,
    pub(super) lens: &'a Lens,
    pub(super) board: Option<(&'a Board, &'a CheckerPattern)>,
}

impl Light<'_> {
    fn distance_px(&self, p: Point2<f64>) -> f64 {
        let p = self.lens.straighten(p);
        let squares = self.board.map_or(f64::INFINITY, |(board, pattern)| board.edge_distance_px(pattern, p));
        self.field.distance_px(p).min(squares)
    }
}

/// The rows or columns that the side crosses, away from its corners, with the position expected there.
fn scan_lines(
    grey: &GreyImage,
    scan: Scan,
    path: &[Point2<f64>],
    uncertainty_px: f64,
) -> Option<Vec<(usize, f64)>> {
    let samples: Vec<(f64, f64, f64)> =
        path.iter().map(|&p| scan.split(p)).map(|(l, p)| (l, p, 1.0)).collect();
    let curve = Polynomial::fit(&samples, CURVE_DEGREE.min(path.len() - 1))?;
    let (a, b) = (samples.first()?.0, samples.last()?.0);
    let (from, to) = (a.min(b), a.max(b));
    let margin = CORNER_MARGIN * (to - from) + uncertainty_px.min(0.1 * (to - from)) + 2.0;
    let first = (from + margin).ceil().max(0.0);
    let last = (to - margin).floor().min(scan.lines(grey) as f64 - 1.0);
    if !(first.is_finite() && last.is_finite() && last > first) {
        return None;
    }
    Some((first as usize..=last as usize).map(|line| (line, curve.value(line as f64))).collect())
}

/// The curve along the strongest steps from dark to bright near the expected positions.
fn localise(
    grey: &GreyImage,
    scan: Scan,
    lines: &[(usize, f64)],
    uncertainty_px: f64,
    light: &Light<'_>,
) -> Option<Polynomial> {
    let reach = (uncertainty_px.ceil() as isize).max(2);
    // The step is taken between means over some pixels, so that noise at full resolution does not outdo the side.
    let arm = (reach / 3).clamp(1, 8);
    let mut found: Vec<(f64, f64)> = Vec::with_capacity(lines.len());
    for &(line, expected) in lines {
        let centre = expected.round() as isize;
        let mut best = (0.0, f64::NAN);
        for s in centre - reach..=centre + reach {
            let arm_sum = |from: isize, to: isize| -> Option<f64> {
                (from..=to).map(|p| scan.pixel(grey, line, p)).sum::<Option<f64>>()
            };
            let (Some(low), Some(high)) = (arm_sum(s - arm + 1, s), arm_sum(s + 1, s + arm)) else {
                continue;
            };
            let step = (high - low) * scan.toward;
            // The light's own border is a stronger step than an unlit side of the sheet.
            let border = || light.distance_px(scan.join(line as f64, s as f64 + 0.5)) <= arm as f64 + 1.5;
            if step > best.0 && !border() {
                best = (step, s as f64 + 0.5);
            }
        }
        if best.1.is_finite() {
            found.push((line as f64, best.1));
        }
    }
    let mut crossings: Vec<Crossing> =
        found.into_iter().map(|(line, position)| Crossing { line, position, sigma: 1.0 }).collect();
    robust_curve(&mut crossings)
}

/// Half the width of the transition, px: where the mean profile across the side has come to rest.
fn half_transition(
    grey: &GreyImage,
    scan: Scan,
    lines: &[(usize, f64)],
    curve: &Polynomial,
    uncertainty_px: f64,
    light: &Light<'_>,
) -> f64 {
    let reach = (2.0 * uncertainty_px).ceil().clamp(6.0, 40.0) as isize;
    let bins = (2 * reach) as usize;
    let mut gradient = vec![0.0; bins];
    // The border of the light, a step of its own, would pass for blur.
    let clear = |line: f64| light.distance_px(scan.join(line, curve.value(line))) > reach as f64;
    let any = lines.iter().any(|l| clear(l.0 as f64));
    for line in lines.iter().map(|l| l.0).filter(|&line| !any || clear(line as f64)) {
        let position = curve.value(line as f64);
        let base = position.floor() as isize;
        for (bin, sum) in gradient.iter_mut().enumerate() {
            let s = base - reach + bin as isize;
            if let (Some(p), Some(q)) = (scan.pixel(grey, line, s), scan.pixel(grey, line, s + 1)) {
                *sum += (q - p) * scan.toward;
            }
        }
    }
    let middle = bins / 2;
    let peak = gradient[middle.saturating_sub(3)..(middle + 3).min(bins)].iter().copied().fold(0.0, f64::max);
    let quiet = |i: usize| gradient[i] < 0.06 * peak;
    let right = (middle..bins - 1).find(|&i| quiet(i) && quiet(i + 1)).unwrap_or(bins - 1) - middle;
    let left = middle - (1..=middle).rev().find(|&i| quiet(i) && quiet(i - 1)).unwrap_or(0);
    (right.max(left) as f64).max(MIN_HALF_TRANSITION_PX) + 1.0
}

/// One crossing of the side.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    line: f64,
    position: f64,
    sigma: f64,
}

/// The pixels of one line around the side, from dark to bright.
#[derive(Debug, Clone)]
struct Profile {
    line: f64,
    /// Position of the boundary between the middle two pixels.
    base: f64,
    /// Light at base + toward·(k + ½ − n/2).
    light: Vec<f64>,
    /// Pixels in each plateau.
    plateau: usize,
}

impl Profile {
    fn take(
        grey: &GreyImage,
        scan: Scan,
        line: usize,
        position: f64,
        transition: f64,
        plateau: f64,
    ) -> Option<Self> {
        let half = (transition + plateau).ceil() as isize;
        let base = position.round() - 0.5 * scan.toward;
        let light: Option<Vec<f64>> = (-half..half)
            .map(|k| scan.pixel(grey, line, (base + scan.toward * (k as f64 + 0.5)).round() as isize))
            .collect();
        Some(Self { line: line as f64, base, light: light?, plateau: plateau as usize })
    }

    fn levels(&self) -> (f64, f64) {
        let n = self.light.len();
        let mean = |s: &[f64]| s.iter().sum::<f64>() / s.len() as f64;
        (mean(&self.light[..self.plateau]), mean(&self.light[n - self.plateau..]))
    }
}

/// Slope of a plateau and scatter around it, both relative to the step.
#[derive(Debug, Clone, Copy)]
struct Plateau {
    slope: f64,
    scatter: f64,
}

/// Positions from the integrals of profiles.
fn locate(scan: Scan, profiles: &[Profile]) -> Option<Vec<Crossing>> {
    let mut steps: Vec<f64> = profiles.iter().map(Profile::levels).map(|(low, high)| high - low).collect();
    let typical = median(&mut steps)?;
    let usable: Vec<&Profile> = profiles
        .iter()
        .filter(|p| {
            let (low, high) = p.levels();
            high - low > MIN_RELATIVE_STEP * typical && typical > 0.0
        })
        .collect();
    // The plateaus' slopes are those of the illumination, the same along the side: their medians carry little noise.
    let low = common_plateau(&usable, |p| &p.light[..p.plateau])?;
    let high = common_plateau(&usable, |p| &p.light[p.light.len() - p.plateau..])?;
    let scatter = low.scatter.hypot(high.scatter) / SQRT_2;
    let crossings = usable
        .iter()
        .map(|p| {
            let n = p.light.len() as f64;
            let inset = (p.plateau as f64) / 2.0;
            let (dark, bright) = p.levels();
            let step = bright - dark;
            // Levels at k (pixels from the start of the profile) extrapolated from the plateaus' middles.
            let dark_at = |k: f64| dark + low.slope * step * (k - inset);
            let bright_at = |k: f64| bright + high.slope * step * (k - (n - inset));
            let from = p.plateau;
            let to = p.light.len() - p.plateau;
            let excess: f64 = (from..to).map(|i| p.light[i] - dark_at(i as f64 + 0.5)).sum();
            // excess = ∫ from the crossing to `to` of bright − dark, both linear.
            let end = to as f64;
            let (d0, d1) = (bright_at(end) - dark_at(end), (high.slope - low.slope) * step);
            let mut length = excess / d0;
            for _ in 0..3 {
                length = excess / (d0 - 0.5 * d1 * length);
            }
            let transition = (to - from) as f64;
            // Noise of the summed pixels and of the two plateaus' means.
            let sigma = scatter * typical / step
                * (transition + transition * transition / (2.0 * p.plateau as f64)).sqrt();
            Crossing {
                line: p.line,
                position: p.base + scan.toward * (end - length - n / 2.0),
                sigma: sigma.max(1e-4),
            }
        })
        .filter(|c| c.position.is_finite())
        .collect();
    Some(crossings)
}

fn common_plateau<'a>(profiles: &[&'a Profile], part: impl Fn(&'a Profile) -> &'a [f64]) -> Option<Plateau> {
    let relative = |p: &'a Profile| {
        let (low, high) = p.levels();
        let samples = part(p);
        let n = samples.len() as f64;
        let mean = samples.iter().sum::<f64>() / n;
        let (mut sxy, mut sxx) = (0.0, 0.0);
        for (i, v) in samples.iter().enumerate() {
            let x = i as f64 - (n - 1.0) / 2.0;
            sxy += x * (v - mean);
            sxx += x * x;
        }
        let slope = sxy / sxx;
        let rest: f64 = samples
            .iter()
            .enumerate()
            .map(|(i, v)| (v - mean - slope * (i as f64 - (n - 1.0) / 2.0)).powi(2))
            .sum();
        (slope / (high - low), (rest / (n - 2.0).max(1.0)).sqrt() / (high - low))
    };
    let (mut slopes, mut scatters): (Vec<f64>, Vec<f64>) = profiles.iter().map(|p| relative(p)).unzip();
    Some(Plateau { slope: median(&mut slopes)?, scatter: median(&mut scatters)? })
}

/// Fits the curve, dropping what is far from it; what remains is in `crossings`.
fn robust_curve(crossings: &mut Vec<Crossing>) -> Option<Polynomial> {
    let samples =
        |c: &[Crossing]| c.iter().map(|c| (c.line, c.position, c.sigma.powi(-2))).collect::<Vec<_>>();
    // A straight line through the medians of three parts starts off robustly; the degree then grows as outliers leave.
    let mut curve = median_line(crossings)?;
    let all = std::mem::take(crossings);
    let mut kept: Vec<Crossing> = Vec::new();
    for round in 0..8 {
        let mut residuals: Vec<f64> = all.iter().map(|c| (c.position - curve.value(c.line)).abs()).collect();
        let scale = 1.4826 * median(&mut residuals)?;
        let limit = (REJECT_SIGMAS * scale).max(0.02);
        kept = all.iter().copied().filter(|c| (c.position - curve.value(c.line)).abs() <= limit).collect();
        let degree = if round < 2 { 1 } else { CURVE_DEGREE };
        if kept.len() <= 2 * (degree + 1) {
            return None;
        }
        curve = Polynomial::fit(&samples(&kept), degree)?;
    }
    *crossings = kept;
    Some(curve)
}

/// A line through the medians of the first and the last third.
fn median_line(crossings: &[Crossing]) -> Option<Polynomial> {
    let third = crossings.len() / 3;
    if third == 0 {
        return None;
    }
    let middle = |part: &[Crossing]| {
        let mut lines: Vec<f64> = part.iter().map(|c| c.line).collect();
        let mut positions: Vec<f64> = part.iter().map(|c| c.position).collect();
        Some((median(&mut lines)?, median(&mut positions)?, 1.0))
    };
    Polynomial::fit(&[middle(&crossings[..third])?, middle(&crossings[crossings.len() - third..])?], 1)
}

/// Means over runs of neighbouring crossings, with a σ that counts what neighbours have in common.
fn condense(scan: Scan, crossings: &[Crossing], curve: &Polynomial, across: f64) -> Vec<EdgePoint> {
    let run = crossings.len().div_ceil(MAX_POINTS);
    let means: Vec<(f64, f64, f64)> = crossings
        .chunks(run)
        .map(|c| {
            let weight: f64 = c.iter().map(|c| c.sigma.powi(-2)).sum();
            let mean = |f: &dyn Fn(&Crossing) -> f64| {
                c.iter().map(|c| f(c) * c.sigma.powi(-2)).sum::<f64>() / weight
            };
            let line = mean(&|c| c.line);
            // The mean of the offsets from the curve, put back onto it: a run of a bent side is not pulled to its chord.
            let offset = mean(&|c| c.position - curve.value(c.line));
            (line, offset, weight.sqrt().recip())
        })
        .collect();
    let freedom = (means.len() as f64 - CURVE_DEGREE as f64 - 1.0).max(1.0);
    let chi = (means.iter().map(|m| (m.1 / m.2).powi(2)).sum::<f64>() / freedom).sqrt().max(1.0);
    let norm: f64 = means.iter().map(|m| (m.1 / m.2).powi(2)).sum();
    let lag: f64 = means.windows(2).map(|w| w[0].1 / w[0].2 * w[1].1 / w[1].2).sum();
    // A first-order autoregressive sequence of correlation ρ holds (1 − ρ)/(1 + ρ) as many independent points.
    let rho = if norm > 0.0 { (lag / norm).clamp(0.0, 0.9) } else { 0.0 };
    let inflation = chi * ((1.0 + rho) / (1.0 - rho)).sqrt();
    means
        .iter()
        .map(|&(line, offset, sigma)| EdgePoint {
            position: scan.join(line, curve.value(line) + offset),
            sigma_px: (sigma * inflation * across).max(FLOOR_SIGMA_PX),
        })
        .collect()
}

fn median(values: &mut [f64]) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    let middle = values.len() / 2;
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}
