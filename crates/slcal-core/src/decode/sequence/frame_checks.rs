//! Whether the frames are those of the pattern, in its order, exposed alike, of a scene that stood still.

use super::code_borders::MOST_CELLS;
use super::frame_noise::FrameNoise;
use super::frame_plan::FramePlan;
use super::levels::LevelScale;
use super::planes::number_of;
use super::sample_lines::SampleLines;
use crate::error::{Error, ErrorSubject, Result};
use crate::pattern::{Axis, FrameLight};
use crate::rig::Warning;

/// Fewer lit samples say nothing about a sequence.
const ENOUGH: usize = 200;
/// A sample is lit when white less black is more than this many times its noise: well above what decoding asks.
const LIT_SIGMAS: f32 = 12.0;
/// In any case, when it is more than this share of the scale.
const LIT_SHARE: f32 = 0.08;
/// Of the right code, more than this share of neighbours agree; a wrong one leaves a half at most.
const LEAST_AGREEING: f64 = 0.8;
/// Another order is named when this share of neighbours agrees by it.
const CLEARLY_AGREEING: f64 = 0.9;
/// A frame that is brighter than white by more than this was exposed otherwise.
const SAME_EXPOSURE: f64 = 0.05;
/// A bit and its inverse contradict white and black when both are so near to the same of them, as a share of white less black. On a
/// border, and in light from other parts of the scene, both are well between.
const CONTRADICTION: f32 = 0.12;
/// Pairs of frames that must contradict white and black at a sample before something moved there.
const CONTRADICTING_PAIRS: usize = 2;
/// A scene in which less moved is not told.
const LEAST_MOVED: f64 = 0.01;
/// Above this share of lit samples at the end of the scale, sinusoids are cut off.
const MOST_SATURATED: f64 = 0.05;

/// A bit has little contrast below this share of white less black.
const WEAK: f32 = 0.3;
/// From this share of the lit samples on, those with at most one such bit are asked alone.
const LEAST_CLEAR: f64 = 0.05;
/// What a share of them tells is asked of about so many lit samples, spread evenly.
const LIT_SAMPLES: usize = 1 << 12;

/// Which frame stands for each.
type Role<'a> = Box<dyn Fn(usize) -> usize + 'a>;

/// What is asked of the samples.
pub(super) struct FrameChecks<'a> {
    pub(super) samples: &'a SampleLines,
    pub(super) plan: &'a FramePlan,
    pub(super) noise: &'a FrameNoise,
    pub(super) scale: LevelScale,
}

impl FrameChecks<'_> {
    /// Warnings of what can be lived with.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a photograph that is there twice, frames in another order than the pattern's, and exposures that differ.
    pub(super) fn check(&self) -> Result<Vec<Warning>> {
        let white_and_black = (self.plan.position(FrameLight::White), self.plan.position(FrameLight::Black));
        let (Some(white), Some(black)) = white_and_black else { return Ok(Vec::new()) };
        let [white, black] = [white, black].map(|i| self.samples.levels(i));
        let least = |s: usize| {
            let level = 0.5 * (f32::from(white[s]) + f32::from(black[s]));
            // Frames in disorder seem to have any noise.
            (LIT_SIGMAS * self.noise.at(level)).min(LIT_SHARE * f32::from(self.scale.full))
        };
        let lit: Vec<usize> = (0..self.samples.len())
            .filter(|s| (f32::from(white[*s]) - f32::from(black[*s])).abs() > least(*s))
            .collect();
        if lit.len() < ENOUGH {
            return Ok(Vec::new());
        }
        self.check_twice()?;
        let reversed = lit.iter().filter(|s| white[**s] < black[**s]).count();
        if 2 * reversed > lit.len() {
            return Err(order(
                "white is darker than black: they are exchanged, or not where the pattern has them",
            ));
        }
        let step = lit.len().div_ceil(LIT_SAMPLES);
        let some: Vec<usize> = lit.iter().copied().step_by(step).collect();
        self.check_exposures(&some, white, black)?;
        for axis in [Axis::Columns, Axis::Rows] {
            self.check_order(axis, &lit, white, black)?;
        }
        let mut warnings = Vec::new();
        warnings.extend(self.moved(&some, white, black));
        warnings.extend(self.saturated(&some));
        Ok(warnings)
    }

    fn check_twice(&self) -> Result<()> {
        let n = self.plan.lights.len();
        for i in 0..n {
            for j in 0..i {
                if self.samples.levels(i) == self.samples.levels(j) {
                    let found = format!(
                        "frames {j} ({}) and {i} ({}) with the same pixels; one of them is missing",
                        self.plan.lights[j], self.plan.lights[i]
                    );
                    return Err(Error::invalid("frames of the sequence", "a photograph for each", found));
                }
            }
        }
        Ok(())
    }

    /// A frame of a code is nowhere brighter than white, whatever other parts of the scene reflect and however blurred its stripes are. One
    /// that was exposed less is not told apart from light that other parts reflect. (That a bit and its inverse add up to white and black holds for light alone, not for code values.)
    fn check_exposures(&self, lit: &[usize], white: &[u16], black: &[u16]) -> Result<()> {
        for (i, light) in self.plan.lights.iter().enumerate() {
            if !matches!(light, FrameLight::Bit { .. }) {
                continue;
            }
            let own = self.samples.levels(i);
            let is_bright =
                |s: &&usize| u32::from(own[**s]) * 2 > u32::from(black[**s]) + u32::from(white[**s]);
            let of_white = |s: &usize| f64::from(own[*s]) / f64::from(white[*s].max(1));
            let bright = quartiles(lit.iter().filter(is_bright).map(of_white));
            if let Some([least, middle, _]) = bright
                && least > 1.0
                && middle > 1.0 + SAME_EXPOSURE
            {
                return Err(exposure(i, light, middle));
            }
        }
        Ok(())
    }

    /// Of neighbouring lit samples along an axis that see different cells, the share of those whose cells are close, where frame `role(i)` stands for frame i.
    fn agreeing(
        &self,
        axis: Axis,
        lit: &[bool],
        white: &[u16],
        black: &[u16],
        role: impl Fn(usize) -> usize,
    ) -> Option<f64> {
        let mut word = vec![0_u16; self.samples.len()];
        let mut weak = vec![0_u8; self.samples.len()];
        let mut bits = 0;
        for (i, light) in self.plan.lights.iter().enumerate() {
            let FrameLight::Bit { axis: a, bit, inverted } = *light else { continue };
            let partner = self.plan.partners[i];
            if a != axis || (inverted && partner.is_some()) {
                continue;
            }
            bits += 1;
            let own = self.samples.levels(role(i));
            let other = partner.map(|p| self.samples.levels(role(p)));
            for (s, word) in word.iter_mut().enumerate() {
                let contrast = match other {
                    Some(other) => i32::from(own[s]) - i32::from(other[s]),
                    None => 2 * i32::from(own[s]) - i32::from(white[s]) - i32::from(black[s]),
                };
                let is_set = (contrast > 0) != inverted;
                *word |= u16::from(is_set) << bit;
                let full = f32::from(white[s]) - f32::from(black[s]);
                weak[s] += u8::from((contrast.unsigned_abs() as f32) < WEAK * full);
            }
        }
        // Where the projector's light comes by way of other surfaces, bits have little contrast and say nothing. With the wrong partners
        // they have little everywhere.
        let is_clear = |s: usize| lit[s] && weak[s] <= 1;
        let (lit_samples, clear) = (0..lit.len())
            .filter(|s| lit[*s])
            .fold((0_usize, 0_usize), |(n, clear), s| (n + 1, clear + usize::from(is_clear(s))));
        let is_asked =
            |s: usize| lit[s] && (is_clear(s) || (clear as f64) < LEAST_CLEAR * lit_samples as f64);
        let (mut pairs, mut agree) = (0_usize, 0_usize);
        for line in self.samples.lines(axis == Axis::Columns) {
            for s in line.start + 1..line.end {
                if is_asked(s) && is_asked(s - 1) && word[s] != word[s - 1] {
                    pairs += 1;
                    let apart = number_of(word[s]).abs_diff(number_of(word[s - 1]));
                    agree += usize::from(apart <= MOST_CELLS);
                }
            }
        }
        // With a few cells, neighbours agree by any order.
        (bits > 3 && pairs >= ENOUGH).then(|| agree as f64 / pairs as f64)
    }

    fn check_order(&self, axis: Axis, lit: &[usize], white: &[u16], black: &[u16]) -> Result<()> {
        let mut is_lit = vec![false; self.samples.len()];
        for s in lit {
            is_lit[*s] = true;
        }
        let agreeing = |role: &dyn Fn(usize) -> usize| self.agreeing(axis, &is_lit, white, black, role);
        let Some(share) = agreeing(&|i| i) else { return Ok(()) };
        if share >= LEAST_AGREEING {
            return Ok(());
        }
        let lights = &self.plan.lights;
        let n = lights.len();
        let bits = lights
            .iter()
            .filter(|l| matches!(l, FrameLight::Bit { axis: a, inverted: false, .. } if *a == axis))
            .count();
        let with = |i: usize, change: &dyn Fn(Axis, u32, bool) -> (Axis, u32, bool)| {
            let FrameLight::Bit { axis: a, bit, inverted } = lights[i] else { return i };
            let (axis, bit, inverted) = change(a, bit, inverted);
            self.plan.position(FrameLight::Bit { axis, bit, inverted }).unwrap_or(i)
        };
        let last = bits.saturating_sub(1) as u32;
        let orders: [(&str, Role<'_>); 5] = [
            (
                "the least significant bit comes first",
                Box::new(|i| with(i, &|a, b, v| (a, last.saturating_sub(b), v))),
            ),
            ("each bit comes after its inverse", Box::new(|i| with(i, &|a, b, v| (a, b, !v)))),
            ("one frame more stands before them", Box::new(move |i| (i + 1) % n)),
            ("a frame is missing before them", Box::new(move |i| (i + n - 1) % n)),
            ("the last frame comes first", Box::new(move |i| n - 1 - i)),
        ];
        for (name, role) in &orders {
            if agreeing(role.as_ref()).is_some_and(|share| share >= CLEARLY_AGREEING) {
                return Err(order(&format!("frames whose bits of the {axis} fit if {name}")));
            }
        }
        Err(order(&format!(
            "frames whose bits of the {axis} contradict each other on {:.0} % of neighbouring pixels",
            100.0 * (1.0 - share)
        )))
    }

    /// Where a bit and its inverse are both white or both black.
    fn moved(&self, lit: &[usize], white: &[u16], black: &[u16]) -> Option<Warning> {
        let pairs: Vec<(usize, usize)> = self
            .plan
            .partners
            .iter()
            .enumerate()
            .filter_map(|(i, partner)| partner.filter(|p| *p > i).map(|p| (i, p)))
            .collect();
        if pairs.len() < CONTRADICTING_PAIRS {
            return None;
        }
        let contradicts = |s: usize| {
            let [w, b] = [white[s], black[s]].map(f32::from);
            let off = |(i, p): &(usize, usize)| {
                let sum = f32::from(self.samples.levels(*i)[s]) + f32::from(self.samples.levels(*p)[s]);
                let share = (0.5 * sum - b) / (w - b);
                !(CONTRADICTION..=1.0 - CONTRADICTION).contains(&share)
            };
            pairs.iter().filter(|pair| off(pair)).count() >= CONTRADICTING_PAIRS
        };
        let moved: Vec<[usize; 2]> =
            lit.iter().filter(|s| contradicts(**s)).map(|s| self.samples.pixel(*s)).collect();
        let share = moved.len() as f64 / lit.len() as f64;
        if share < LEAST_MOVED {
            return None;
        }
        let [x, y] = [0, 1].map(|k| {
            let mut at: Vec<usize> = moved.iter().map(|p| p[k]).collect();
            at.sort_unstable();
            (at[at.len() / 20], at[at.len() - 1 - at.len() / 20])
        });
        Some(Warning {
            code: "moved".into(),
            message: format!(
                "in {:.1} % of the lit pixels, between ({}, {}) and ({}, {}), the frames contradict white and black: something moved while they were taken",
                100.0 * share, x.0, y.0, x.1, y.1
            ),
            advice: "keep camera, projector and object still until the last frame, and the light of the room unchanged".into(),
        })
    }

    /// Sinusoids that are cut off at the end of the scale.
    fn saturated(&self, lit: &[usize]) -> Option<Warning> {
        let steps: Vec<usize> = (0..self.plan.lights.len())
            .filter(|i| matches!(self.plan.lights[*i], FrameLight::Sinusoid { .. }))
            .collect();
        let end = self.scale.full - self.scale.step;
        let is_cut = |s: usize| steps.iter().any(|i| self.samples.levels(*i)[s] > end);
        let share = lit.iter().filter(|s| is_cut(**s)).count() as f64 / lit.len() as f64;
        (share > MOST_SATURATED).then(|| Warning {
            code: "saturated".into(),
            message: format!("{:.0} % of the lit pixels are overexposed in frames of the sinusoid, so that their phase is wrong", 100.0 * share),
            advice: "expose less".into(),
        })
    }
}

/// The lower quartile, the median and the upper quartile; `None` where there are too few.
fn quartiles(values: impl Iterator<Item = f64>) -> Option<[f64; 3]> {
    let mut values: Vec<f64> = values.collect();
    if values.len() < ENOUGH {
        return None;
    }
    values.sort_unstable_by(f64::total_cmp);
    Some([0.25, 0.5, 0.75].map(|share| values[((values.len() - 1) as f64 * share) as usize]))
}

fn exposure(frame: usize, light: &FrameLight, factor: f64) -> Error {
    Error::invalid(
        "frames of the sequence",
        "all with the exposure of the white one",
        format!(
            "frame {frame} ({light}) with {factor:.2} times its light; fix exposure, gain and white balance of the camera"
        ),
    )
}

fn order(found: &str) -> Error {
    Error::invalid(ErrorSubject::Named("frames of the sequence"), "the order of the pattern", found)
}
