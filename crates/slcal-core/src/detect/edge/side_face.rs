//! The side face of a thick board: two parallel edges, of which the inner one bounds the sheet.
//!
//! Outside to inside the light then has two steps with a plateau between them. Both are located in mean profiles of parts
//! of the side, by a fit of two blurred steps of one blur. A side has a face only where both edges run along most of it
//! and their distance changes evenly. A face that is hardly wider than the blur, or hardly darker or brighter than the
//! sheet or what is behind it, cannot be told.

use nalgebra::{SMatrix, SVector};

use super::scan::Scan;
use crate::detect::erf::ErfTable;
use crate::photo::LinearPhoto;
use crate::solve::{Polynomial, median};

/// Parts of a side that are looked at, fewest of them, and the share of them that must show the face.
const PARTS: usize = 12;
const MIN_PARTS: usize = 4;
const MIN_SEEN: f64 = 0.6;
/// Fewest lines in a part.
const MIN_LINES: usize = 4;
/// Distance of the samples of a mean profile, px: a pixel is cut in two, as in the sampling of blurred edges.
const SAMPLE_PX: f64 = 0.5;
/// A step is significant beyond this many σ of the mean profile: of a hundred samples none is by chance.
const MIN_SIGNIFICANCE: f64 = 6.0;
/// Least height of either step, as a part of the step from outside to the sheet: a weaker one moves the side by less than
/// a tenth of the face's width.
const MIN_STEP: f64 = 0.06;
/// Least height of a step down from a face that is brighter than the sheet: sharpening in the camera makes ridges of a
/// tenth of the step along every side.
const MIN_STEP_DOWN: f64 = 0.15;
/// Two steps up are apart from this many blurs on, which is where their slopes have two peaks; a ridge has a flat top, that
/// sharpening does not make, from this many on.
const MIN_WIDTH_BLURS: f64 = 2.2;
const MIN_RIDGE_BLURS: f64 = 4.0;
/// The slope of the light between two steps falls below this part of the smaller one.
const MAX_VALLEY: f64 = 0.9;
/// Greatest rms of the residuals of a part, as a part of the lower step.
const MAX_MISFIT: f64 = 0.2;
/// The widths of the parts scatter around a line by at most this part of the blur, and this part of the width.
const MAX_SCATTER_BLURS: f64 = 0.3;
const MAX_SCATTER: f64 = 0.12;

/// A face along a side.
#[derive(Debug, Clone)]
pub(super) struct SideFace {
    /// Position of the sheet's own edge on each line, px.
    pub(super) edge: Polynomial,
    /// Distance of the outer edge from it on each line, px.
    width: Polynomial,
    /// The narrowest and the widest part, px.
    pub(super) widths: [f64; 2],
    /// The outer step as a part of both.
    pub(super) share: f64,
    /// σ of the blur of both edges, px.
    pub(super) blur: f64,
}

/// Two steps in the mean profile of a part of the side.
#[derive(Debug, Clone, Copy)]
struct TwoSteps {
    line: f64,
    /// Position of the inner edge.
    inner: f64,
    width: f64,
    share: f64,
    blur: f64,
}

/// A mean profile: light at multiples of [`SAMPLE_PX`] from the expected side, towards the sheet, and its variance.
struct MeanProfile {
    light: Vec<f64>,
    variance: Vec<f64>,
    /// Index of the expected side.
    middle: usize,
}

impl SideFace {
    /// Looks for a face within `reach_px` of the side. `lines` have the expected position of the side.
    pub(super) fn find(
        photo: &LinearPhoto<'_>,
        scan: Scan,
        lines: &[(usize, f64)],
        reach_px: f64,
    ) -> Option<Self> {
        let erf = ErfTable::new();
        let parts: Vec<_> =
            lines.chunks(lines.len().div_ceil(PARTS).max(1)).filter(|p| p.len() >= MIN_LINES).collect();
        if parts.len() < MIN_PARTS {
            return None;
        }
        let seen: Vec<TwoSteps> = parts
            .iter()
            .filter_map(|part| {
                let found = MeanProfile::of(photo, scan, part, reach_px)?.two_steps(&erf)?;
                let n = part.len() as f64;
                let line = part.iter().map(|l| l.0 as f64).sum::<f64>() / n;
                let expected = part.iter().map(|l| l.1).sum::<f64>() / n;
                Some(TwoSteps { line, inner: expected + scan.toward * found.inner, ..found })
            })
            .collect();
        Self::of_parts(seen, parts.len())
    }

    /// The face that most of the parts agree on.
    fn of_parts(mut seen: Vec<TwoSteps>, tried: usize) -> Option<Self> {
        let enough = |n: usize| n >= MIN_PARTS && n as f64 >= MIN_SEEN * tried as f64;
        let middle = |seen: &[TwoSteps], f: &dyn Fn(&TwoSteps) -> f64| {
            median(&mut seen.iter().map(f).collect::<Vec<_>>())
        };
        // Parts where another edge was taken for one of the two are far from the others.
        for _ in 0..3 {
            if !enough(seen.len()) {
                return None;
            }
            let width = linear(seen.iter().map(|s| (s.line, s.width)))?;
            let (typical, blur) = (middle(&seen, &|s| s.width)?, middle(&seen, &|s| s.blur)?);
            let off = |s: &TwoSteps| (s.width - width.value(s.line)).abs();
            let scatter = 1.4826 * middle(&seen, &off)?;
            let limit = (3.0 * scatter).min(MAX_SCATTER_BLURS * blur + MAX_SCATTER * typical);
            seen.retain(|s| off(s) <= limit.max(1e-6));
        }
        if !enough(seen.len()) {
            return None;
        }
        let width = linear(seen.iter().map(|s| (s.line, s.width)))?;
        let samples: Vec<_> = seen.iter().map(|s| (s.line, s.inner, 1.0)).collect();
        let edge = Polynomial::fit(&samples, if seen.len() > 5 { 2 } else { 1 })?;
        let ends = [seen.first()?, seen.last()?].map(|s| width.value(s.line));
        let (share, blur) = (middle(&seen, &|s| s.share)?, middle(&seen, &|s| s.blur)?);
        let widths = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        (widths[0] > 0.0).then_some(Self { edge, width, widths, share, blur })
    }

    /// The width of the face on a line, px.
    pub(super) fn width(&self, line: f64) -> f64 {
        self.width.value(line).clamp(0.5 * self.widths[0], 2.0 * self.widths[1])
    }
}

fn linear(samples: impl Iterator<Item = (f64, f64)>) -> Option<Polynomial> {
    Polynomial::fit(&samples.map(|(x, y)| (x, y, 1.0)).collect::<Vec<_>>(), 1)
}

impl MeanProfile {
    fn of(photo: &LinearPhoto<'_>, scan: Scan, lines: &[(usize, f64)], reach_px: f64) -> Option<Self> {
        let middle = (reach_px / SAMPLE_PX).ceil() as usize;
        let n = 2 * middle + 1;
        let (mut sum, mut squares, mut count) = (vec![0.0; n], vec![0.0; n], 0.0);
        let mut light = Vec::with_capacity(n);
        for &(line, position) in lines {
            light.clear();
            light.extend((0..n).map_while(|k| {
                let at = position + scan.toward * (k as f64 - middle as f64) * SAMPLE_PX;
                let (base, part) = (at.floor(), at - at.floor());
                let [a, b] = [0, 1].map(|i| scan.pixel(photo, line, base as isize + i));
                Some(a? * (1.0 - part) + b? * part)
            }));
            if light.len() < n {
                continue;
            }
            for (k, v) in light.iter().enumerate() {
                sum[k] += v;
                squares[k] += v * v;
            }
            count += 1.0;
        }
        if count < MIN_LINES as f64 {
            return None;
        }
        let variance = sum.iter().zip(&squares);
        let variance =
            variance.map(|(s, q)| ((q - s * s / count) / (count - 1.0)).max(0.0) / count).collect();
        Some(Self { light: sum.iter().map(|s| s / count).collect(), variance, middle })
    }

    fn at(&self, k: usize) -> f64 {
        (k as f64 - self.middle as f64) * SAMPLE_PX
    }

    /// Change of the light over two samples.
    fn slope(&self, k: usize) -> f64 {
        self.light[k + 1] - self.light[k - 1]
    }

    /// The two steps that the profile has, with `inner` counted from the expected side.
    fn two_steps(&self, erf: &ErfTable) -> Option<TwoSteps> {
        let n = self.light.len();
        let peaks: Vec<usize> = (3..n - 3)
            .filter(|&k| {
                let s = self.slope(k);
                let top = |i: usize| self.slope(i) * s.signum() <= s.abs();
                let sigma = (self.variance[k - 1] + self.variance[k + 1]).sqrt();
                top(k - 1) && top(k + 1) && top(k - 2) && top(k + 2) && s.abs() > MIN_SIGNIFICANCE * sigma
            })
            .collect();
        let main = peaks.iter().copied().max_by(|&a, &b| self.slope(a).total_cmp(&self.slope(b)))?;
        let height = self.slope(main);
        if height <= 0.0 {
            return None;
        }
        let partner = peaks.iter().copied().filter(|&k| {
            let s = self.slope(k);
            let between = (k.min(main) + 1)..k.max(main);
            let valley = between.map(|i| self.slope(i).abs()).fold(f64::INFINITY, f64::min);
            k.abs_diff(main) > 1
                && s.abs() >= 0.5 * MIN_STEP * height
                && (s > 0.0 || k > main)
                && valley < MAX_VALLEY * s.abs()
        });
        let partner = partner
            .max_by(|&a, &b| self.slope(a).abs().total_cmp(&self.slope(b).abs()))
            .or_else(|| self.shoulder(main))?;
        // The flank on the far side from the partner gives the blur: there nothing is added to the slope.
        let blur = self.flank_px(main, partner < main)?.max(0.4);
        self.fit(erf, self.at(main.min(partner)), self.at(main.max(partner)), blur)
    }

    /// σ of the blur by one flank of a peak of the slope, where it falls to half the height, px.
    fn flank_px(&self, main: usize, above: bool) -> Option<f64> {
        let at = |i: usize| if above { Some(main + i) } else { main.checked_sub(i) };
        let inside = |k: &usize| (1..self.light.len() - 1).contains(k);
        let low = |i: &usize| at(*i).filter(inside).is_none_or(|k| self.slope(k) < 0.5 * self.slope(main));
        let half = (1..self.light.len()).find(low)?;
        Some(half as f64 * SAMPLE_PX / (2.0 * std::f64::consts::LN_2).sqrt())
    }

    /// A step so near to the main one that the slope has no second peak: on one flank of the peak it is steeper than on the
    /// other.
    fn shoulder(&self, main: usize) -> Option<usize> {
        let range = 1..self.light.len() - 1;
        let excess = |k: usize| {
            let mirrored = (2 * main).checked_sub(k).filter(|m| range.contains(m))?;
            let sigma = (self.variance[k - 1] + self.variance[k + 1]).sqrt();
            let excess = self.slope(k) - self.slope(mirrored);
            let far = MIN_WIDTH_BLURS * self.flank_px(main, k < main)?;
            (k.abs_diff(main) as f64 * SAMPLE_PX >= far
                && self.slope(k) >= MIN_STEP * self.slope(main)
                && excess >= 0.5 * self.slope(k)
                && excess > MIN_SIGNIFICANCE * sigma)
                .then_some(excess)
        };
        let shoulders = range.clone().filter_map(|k| Some((k, excess(k)?)));
        shoulders.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
    }

    /// Least squares of D + A·Φ((d − x₁)/s) + B·Φ((d − x₂)/s).
    fn fit(&self, erf: &ErfTable, outer: f64, inner: f64, blur: f64) -> Option<TwoSteps> {
        let (mut x, mut s) = ([outer, inner], blur);
        let beyond = 3.0 * blur + 1.0;
        let window: Vec<usize> = (0..self.light.len())
            .filter(|&k| (outer - beyond..=inner + beyond).contains(&self.at(k)))
            .collect();
        if window.len() < 8 {
            return None;
        }
        let step = |d: f64, s: f64| {
            let u = d / (s * std::f64::consts::SQRT_2);
            let (value, slope) = erf.at(u);
            (0.5 * (1.0 + value), 0.5 * slope / (s * std::f64::consts::SQRT_2))
        };
        let mut level = SVector::<f64, 3>::zeros();
        for round in 0..12 {
            // The heights are linear; they are solved for before each step of the positions and the blur.
            let (mut normal, mut right) = (SMatrix::<f64, 3, 3>::zeros(), SVector::<f64, 3>::zeros());
            for &k in &window {
                let d = self.at(k);
                let row = SVector::<f64, 3>::new(1.0, step(d - x[0], s).0, step(d - x[1], s).0);
                normal += row * row.transpose();
                right += row * self.light[k];
            }
            level = normal.try_inverse()? * right;
            if round == 11 {
                break;
            }
            let (mut normal, mut right) = (SMatrix::<f64, 6, 6>::zeros(), SVector::<f64, 6>::zeros());
            for &k in &window {
                let d = self.at(k);
                let [(f, df), (g, dg)] = [step(d - x[0], s), step(d - x[1], s)];
                let by_blur = -level[1] * df * (d - x[0]) / s - level[2] * dg * (d - x[1]) / s;
                let row = SVector::<f64, 6>::from([1.0, f, g, -level[1] * df, -level[2] * dg, by_blur]);
                normal += row * row.transpose();
                right += row * (self.light[k] - level[0] - level[1] * f - level[2] * g);
            }
            for i in 0..6 {
                normal[(i, i)] *= 1.0 + 1e-6;
            }
            let change = normal.try_inverse()? * right;
            if !change.iter().all(|c| c.is_finite()) {
                return None;
            }
            x[0] += change[3].clamp(-0.5 * s, 0.5 * s);
            x[1] += change[4].clamp(-0.5 * s, 0.5 * s);
            s = (s + change[5]).clamp(0.7 * s, 1.4 * s);
        }
        let misfit = window.iter().map(|&k| {
            let d = self.at(k);
            let model = level[0] + level[1] * step(d - x[0], s).0 + level[2] * step(d - x[1], s).0;
            (self.light[k] - model).powi(2)
        });
        let rms = (misfit.sum::<f64>() / window.len() as f64).sqrt();
        let (whole, width) = (level[1] + level[2], x[1] - x[0]);
        let fits =
            (x[0] - outer).abs() < 0.5 * (inner - outer) && (x[1] - inner).abs() < 0.5 * (inner - outer);
        let up = level[2] >= MIN_STEP * whole && width >= MIN_WIDTH_BLURS * s;
        let down = level[2] <= -MIN_STEP_DOWN * whole && width >= MIN_RIDGE_BLURS * s;
        (fits
            && whole > 0.0
            && level[1] >= MIN_STEP * whole
            && (up || down)
            && rms <= MAX_MISFIT * level[1].min(level[2].abs()))
        .then_some(TwoSteps { line: 0.0, inner: x[1], width, share: level[1] / whole, blur: s })
    }
}
