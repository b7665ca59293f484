//! Where a side crosses rows or columns: a blurred step, integrated over the pixels, fitted to the light across the side.
//!
//! At distance d from the side towards the sheet the light is D + S·(B + a·d·(1 − B) + b·d·B): D and S, the dark level and
//! the step, belong to each crossing; the blur s of B = Φ(d/s) averaged over the pixel and the relative slopes a and b of
//! the light on either side belong to the whole side. A symmetric blur of another shape does not move the crossing.

use super::crossing::Crossing;
use super::scan::Scan;
use super::side_face::SideFace;
use super::step_model::{Common, Equations, MIN_BLUR_PX, Noise, Profile, State, Summary};
use crate::detect::erf::ErfTable;
use crate::photo::LinearPhoto;
use crate::solve::{Polynomial, median};

/// Weakest step that is measured, as a part of the side's median step (an unlit part of the sheet).
const MIN_RELATIVE_STEP: f64 = 0.1;
/// Lines are combined until the σ of a crossing is this part of the blur. With a larger σ the fit is not linear in the
/// noise, and different noise in dark and bright pixels would bias it.
const LINEAR_PART: f64 = 0.25;
/// Fewest crossings of a side after combining lines.
const MIN_BUNDLES: usize = 48;
/// Least noise, linear light: a thousandth of the range of a dark photograph.
const MIN_NOISE: f64 = 1e-5;

/// The light across a side, along lines of pixels from dark to bright.
#[derive(Debug)]
pub(super) struct Profiles {
    scan: Scan,
    /// Pixels before and behind the side.
    half: usize,
    /// Pixels at each end that are beyond the transition.
    plateau: usize,
    /// Row or column (their mean), position expected of the side from the boundary between the middle two pixels.
    lines: Vec<[f64; 2]>,
    /// 2·half values per line.
    light: Vec<f64>,
}

/// Crossings of a side.
pub(super) struct Located {
    pub(super) crossings: Vec<Crossing>,
    /// Number of crossings tried.
    pub(super) tried: usize,
    /// Number of profiles of a crossing.
    pub(super) together: usize,
    /// What the crossings have in common.
    pub(super) common: Common,
    /// Common 1σ of all crossings, px: by the uncertainty of blur and slopes.
    pub(super) common_sigma: f64,
}

impl Profiles {
    /// Reads the lines whose numbers and expected positions are given, as far as they lie in the photograph. `together`
    /// neighbouring lines are averaged, each shifted by whole pixels along the side.
    pub(super) fn take(
        photo: &LinearPhoto<'_>,
        scan: Scan,
        lines: &[(usize, f64)],
        [transition, plateau]: [f64; 2],
        together: usize,
    ) -> Self {
        let half = (transition + plateau).ceil() as usize;
        let mut all = Self { scan, half, plateau: plateau as usize, lines: Vec::new(), light: Vec::new() };
        let mut rest = lines;
        while let Some(&(first, _)) = rest.first() {
            let near = rest.iter().take(together).take_while(|l| l.0 < first + together).count();
            let (group, others) = rest.split_at(near.max(1));
            all.add(photo, group);
            rest = others;
        }
        all
    }

    /// The mean profile of some lines.
    fn add(&mut self, photo: &LinearPhoto<'_>, group: &[(usize, f64)]) {
        let (scan, reach, start) = (self.scan, self.half as isize, self.light.len());
        self.light.resize(start + 2 * self.half, 0.0);
        let from = group.first().map_or(0.0, |l| l.1);
        let (mut count, mut line_sum, mut expected) = (0.0, 0.0, 0.0);
        for &(line, position) in group {
            let base = from.round() - 0.5 * scan.toward + (position - from).round();
            let pixel =
                |k: isize| scan.pixel(photo, line, (base + scan.toward * (k as f64 + 0.5)).round() as isize);
            if pixel(-reach).is_none() || pixel(reach - 1).is_none() {
                continue;
            }
            for (sum, k) in self.light[start..].iter_mut().zip(-reach..) {
                *sum += pixel(k).unwrap_or(0.0);
            }
            count += 1.0;
            line_sum += line as f64;
            expected += scan.toward * (position - base);
        }
        if count > 0.0 {
            self.light[start..].iter_mut().for_each(|sum| *sum /= count);
            self.lines.push([line_sum / count, expected / count]);
        } else {
            self.light.truncate(start);
        }
    }

    fn profile(&self, i: usize, face: Option<&SideFace>) -> Profile<'_> {
        let [line, expected] = self.lines[i];
        let face_px = face.map_or(0.0, |f| f.width(line));
        Profile { light: self.light(i), middle: self.half as f64, expected, face_px }
    }

    fn light(&self, i: usize) -> &[f64] {
        &self.light[2 * self.half * i..2 * self.half * (i + 1)]
    }

    fn levels(&self, i: usize) -> (f64, f64) {
        let light = self.light(i);
        let mean = |s: &[f64]| s.iter().sum::<f64>() / s.len() as f64;
        (mean(&light[..self.plateau]), mean(&light[light.len() - self.plateau..]))
    }

    /// Fits all crossings in `rounds` steps from initial common parameters. The expected positions lie on `curve`. `None`
    /// when there is no step.
    pub(super) fn locate(
        &self,
        erf: &ErfTable,
        curve: &Polynomial,
        start: Common,
        rounds: usize,
        face: Option<&SideFace>,
    ) -> Option<Located> {
        match face {
            None => self.locate_with::<3>(erf, curve, start, rounds, None),
            Some(_) => self.locate_with::<4>(erf, curve, start, rounds, face),
        }
    }

    fn locate_with<const N: usize>(
        &self,
        erf: &ErfTable,
        curve: &Polynomial,
        start: Common,
        rounds: usize,
        face: Option<&SideFace>,
    ) -> Option<Located> {
        let mut steps: Vec<f64> =
            (0..self.lines.len()).map(|i| self.levels(i)).map(|(low, high)| high - low).collect();
        let typical_step = median(&mut steps)?;
        if typical_step.is_nan() || typical_step <= 0.0 {
            return None;
        }
        let usable: Vec<usize> = (0..self.lines.len())
            .filter(|&i| {
                let (low, high) = self.levels(i);
                high - low > MIN_RELATIVE_STEP * typical_step
            })
            .collect();
        let noise = self.noise(&usable, typical_step)?;
        let mut shared = start;
        let bundle = bundle_size(&noise, shared.blur, usable.len());
        let bundles: Vec<&[usize]> = usable.chunks(bundle).collect();
        let share = face.map_or(0.0, |f| f.share);
        let mut states: Vec<State> = bundles
            .iter()
            .map(|b| {
                let mean = |f: &dyn Fn(usize) -> f64| b.iter().map(|&i| f(i)).sum::<f64>() / b.len() as f64;
                let dark = mean(&|i| self.levels(i).0);
                let step = mean(&|i| self.levels(i).1) - dark;
                State { offset: 0.0, dark, step: step * (1.0 - share), face: step * share }
            })
            .collect();
        let mut own = vec![Equations::<N>::default(); bundles.len()];
        let mut summary = Summary::default();
        for _ in 0..rounds {
            for ((equations, state), bundle) in own.iter_mut().zip(&states).zip(&bundles) {
                let profiles = bundle.iter().map(|&i| self.profile(i, face));
                *equations = Equations::of(erf, profiles, state, &shared, &noise);
            }
            summary = Summary::of(&own)?;
            self.update(&mut shared, &mut states, &own, &summary);
        }
        let crossings = (bundles.iter().zip(&states).zip(&own))
            .filter_map(|((bundle, state), equations)| {
                let line = bundle.iter().map(|&i| self.lines[i][0]).sum::<f64>() / bundle.len() as f64;
                let position = curve.value(line) + self.scan.toward * state.offset;
                let sigma = equations.offset_variance()?.sqrt();
                (position.is_finite() && sigma.is_finite()).then_some(Crossing {
                    line,
                    position,
                    sigma: sigma.max(1e-4),
                })
            })
            .collect();
        Some(Located {
            crossings,
            tried: self.lines.len().min(bundles.len()),
            together: bundle,
            common: shared,
            common_sigma: summary.common_sigma,
        })
    }

    /// Scatter of the light on either side around its own slope: medians, which a clip or a shadow does not move.
    fn noise(&self, usable: &[usize], typical_step: f64) -> Option<Noise> {
        let scatter = |samples: &[f64]| {
            let n = samples.len() as f64;
            let mean = samples.iter().sum::<f64>() / n;
            let (mut sxy, mut sxx, mut syy) = (0.0, 0.0, 0.0);
            for (i, v) in samples.iter().enumerate() {
                let x = i as f64 - (n - 1.0) / 2.0;
                sxy += x * (v - mean);
                sxx += x * x;
                syy += (v - mean).powi(2);
            }
            (syy - sxy * sxy / sxx).max(0.0) / (n - 2.0).max(1.0)
        };
        let plateau = self.plateau;
        let mut dark: Vec<f64> = usable.iter().map(|&i| scatter(&self.light(i)[..plateau])).collect();
        let mut bright: Vec<f64> =
            usable.iter().map(|&i| scatter(&self.light(i)[2 * self.half - plateau..])).collect();
        // The median of χ² of a few degrees of freedom lies below its mean.
        let freedom = (plateau as f64 - 2.0).max(1.0);
        let to_mean = (1.0 - 2.0 / (9.0 * freedom)).powi(-3);
        let least = MIN_NOISE * MIN_NOISE;
        let variance = |v: &mut [f64]| Some((median(v)? * to_mean).max(least));
        Some(Noise { dark: variance(&mut dark)?, bright: variance(&mut bright)?, typical_step })
    }

    fn update<const N: usize>(
        &self,
        shared: &mut Common,
        states: &mut [State],
        own: &[Equations<N>],
        summary: &Summary,
    ) {
        let step = summary.step;
        let reach = (self.half - self.plateau) as f64;
        shared.blur = (shared.blur + step.x)
            .clamp((0.5 * shared.blur).max(MIN_BLUR_PX), 2.0 * shared.blur + MIN_BLUR_PX);
        shared.slopes = [shared.slopes[0] + step.y, shared.slopes[1] + step.z];
        for (state, e) in states.iter_mut().zip(own) {
            let Some(inverse) = e.own_inverse else { continue };
            let change = -(inverse * (e.own_gradient + e.cross * step));
            if change.iter().all(|x| x.is_finite()) {
                state.offset = (state.offset + change[0].clamp(-shared.blur - 0.5, shared.blur + 0.5))
                    .clamp(-reach, reach);
                state.dark += change[1];
                state.step += change[2];
                state.face += if N > 3 { change[3] } else { 0.0 };
            }
        }
    }
}

/// How many lines to take together.
fn bundle_size(noise: &Noise, blur: f64, lines: usize) -> usize {
    // A step of height S seen through a blur s is located to √(2√π·s)·noise/S.
    let single = f64::midpoint(noise.dark, noise.bright).sqrt() / noise.typical_step
        * (2.0 * std::f64::consts::PI.sqrt() * blur.max(0.5)).sqrt();
    let wanted = (single / (LINEAR_PART * blur.max(0.5))).powi(2).ceil().min(1e6);
    (wanted as usize).clamp(1, (lines / MIN_BUNDLES).max(1))
}
