//! The displacement of red and blue from the stripes themselves: on a smooth surface the centres of neighbouring slits of
//! different hues zigzag about a smooth curve.
//!
//! A centre minus the cubic through the two on either side is linear in the displacements of its own edges and of those around,
//! which depend on the hues alone. Robust least squares over many crossings give the displacements of red and blue light
//! and their magnification. An offset of each hue, which is small, takes what else depends on the hue.

use nalgebra::{SMatrix, SVector};

use super::hue_shift::{Centres, HueShares, HueShift, across};
use super::labeling::VotedLabel;
use super::slit_layout::SlitLayout;
use super::stripe_centers::StripeCenter;
use super::tracks::Tracks;
use crate::solve::median_f32;

/// Every so many scanlines are used, and more where there are more of these than enough: an odd number, for both parities.
const LEAST_STEP: usize = 5;
const LINES: usize = 200;
/// The darkest of five stripes has this share of the light of the brightest tenth: dim ones are more noise than displacement.
const MIN_LIGHT: f32 = 0.25;
/// Distances of neighbours change by at most this share from one to the next, displacements included, and over five slits.
const EVEN: f32 = 0.16;
const MIN_SAMPLES: usize = 200;
/// The misfits of one stripe are alike over this many of the scanlines that are used.
const CORRELATED: f64 = 5.0;
/// Tukey's constant, in σ.
const TUKEY: f64 = 4.685;
const ROUNDS: usize = 4;
/// What is known before, 1σ: nothing of shifts, projector px; usual magnifications; usual offsets of hues.
const UNKNOWN_SHIFT_PX: f64 = 2.0;
const USUAL_RADIAL: f64 = 3e-4;
const USUAL_OFFSET_PX: f64 = 0.03;
/// The same where a calibration measured them.
const KNOWN_SHIFT_PX: f64 = 0.02;
const KNOWN_RADIAL: f64 = 2e-4;
/// Shifts are never known better than this from stripes, 1σ: surfaces bend, too.
const FLOOR_PX: f64 = 0.02;
/// Unknown displacements: shift and magnification of red and blue.
const DISPLACEMENTS: usize = 4;
/// Hues that have an offset.
const MAX_HUES: usize = 8;
const MAX_UNKNOWNS: usize = DISPLACEMENTS + MAX_HUES;
type Unknowns = SVector<f64, MAX_UNKNOWNS>;
type Matrix = SMatrix<f64, MAX_UNKNOWNS, MAX_UNKNOWNS>;

/// What the stripes of a photograph show.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Zigzag {
    pub(super) shift: HueShift,
    /// 1σ of the shifts of red and blue, projector px.
    pub(super) sigma_px: [f64; 2],
    /// 1σ of the magnifications of red and blue.
    pub(super) sigma_radial: [f64; 2],
    /// Further offsets of the hues, projector px.
    pub(super) offsets_px: [f32; MAX_HUES],
}

/// One misfit, projector px, and what it is made of.
#[derive(Debug, Clone, Copy)]
struct Sample {
    misfit: f32,
    /// What a magnification by one would displace it by, projector px.
    magnified: f32,
    factors: [f32; MAX_UNKNOWNS],
}

/// Working memory.
#[derive(Debug, Clone, Default)]
pub(super) struct ZigzagWork {
    samples: Vec<Sample>,
    scratch: Vec<f32>,
}

/// The crossings of a photograph with what is known of them.
#[derive(Clone, Copy)]
pub(super) struct Located<'a> {
    pub(super) tracks: &'a Tracks,
    pub(super) votes: &'a [VotedLabel],
    pub(super) centers: &'a [StripeCenter],
    pub(super) layout: &'a SlitLayout,
    /// Hues of the slits in the order of a scanline.
    pub(super) slits: &'a [u8],
    pub(super) shares: &'a HueShares,
    pub(super) centres: &'a Centres,
}

/// Estimates the displacements that remain in the centres. `known`: a calibration's were removed already. `None` where too few
/// slits stand side by side.
pub(super) fn measure(at: Located<'_>, known: bool, work: &mut ZigzagWork) -> Option<Zigzag> {
    gather(at, work);
    let hues = at.shares.primaries.len().min(MAX_HUES);
    if work.samples.len() < MIN_SAMPLES {
        return None;
    }
    let (shift, radial) =
        if known { (KNOWN_SHIFT_PX, KNOWN_RADIAL) } else { (UNKNOWN_SHIFT_PX, USUAL_RADIAL) };
    let priors = |k: usize| {
        if k < 2 {
            shift
        } else if k < 4 {
            radial
        } else {
            USUAL_OFFSET_PX
        }
    };
    // Offsets of hues that the pattern does not have stay zero.
    let mut found = Unknowns::zeros();
    let mut covariance = Matrix::identity();
    for _ in 0..ROUNDS {
        let residual = |s: &Sample| {
            let model: f64 = s.factors.iter().zip(found.iter()).map(|(f, x)| f64::from(*f) * x).sum();
            f64::from(s.misfit) - model
        };
        work.scratch.clear();
        work.scratch.extend(work.samples.iter().map(|s| residual(s).abs() as f32));
        let sigma = f64::from(median_f32(&mut work.scratch)?.max(1e-4)) / 0.6745;
        let mut normal = Matrix::from_fn(|i, j| if i == j { priors(i).powi(-2) } else { 0.0 });
        let mut right = Unknowns::zeros();
        for s in &work.samples {
            let t = residual(s) / (TUKEY * sigma);
            if t.abs() >= 1.0 {
                continue;
            }
            let weight = (1.0 - t * t).powi(2) / (CORRELATED * sigma * sigma);
            for i in 0..DISPLACEMENTS + hues {
                let f = weight * f64::from(s.factors[i]);
                right[i] += f * f64::from(s.misfit);
                // The factorisation reads the lower triangle only.
                for j in 0..=i {
                    normal[(i, j)] += f * f64::from(s.factors[j]);
                }
            }
        }
        covariance = normal.cholesky()?.inverse();
        found = covariance * right;
    }
    let squares: f64 = work.samples.iter().map(|s| f64::from(s.magnified).powi(2)).sum();
    // Over the stripes that were used, a magnification is known no better than a shift.
    let floor_radial = FLOOR_PX / (squares / work.samples.len() as f64).sqrt().max(1.0);
    let sigma = |k: usize, floor: f64| covariance[(k, k)].sqrt().max(floor);
    let value = |k: usize| found[k] as f32;
    let mut offsets_px = [0.0; MAX_HUES];
    for (hue, offset) in offsets_px.iter_mut().enumerate().take(hues) {
        *offset = value(DISPLACEMENTS + hue);
    }
    Some(Zigzag {
        shift: HueShift {
            panel_px: [value(0), value(1)],
            panel_scale: [0.0; 2],
            radial: [value(2), value(3)],
        },
        sigma_px: [0, 1].map(|k| sigma(k, FLOOR_PX)),
        sigma_radial: [2, 3].map(|k| sigma(k, floor_radial)),
        offsets_px,
    })
    .filter(|z| z.shift.panel_px.iter().chain(&z.shift.radial).all(|x| x.is_finite()))
}

fn gather(at: Located<'_>, work: &mut ZigzagWork) {
    let ZigzagWork { samples, scratch } = work;
    samples.clear();
    scratch.clear();
    let step = (at.tracks.line_count() / LINES).max(LEAST_STEP) | 1;
    let lines = || (0..at.tracks.line_count()).step_by(step);
    for y in lines() {
        let labelled = at.tracks.of(y).filter(|&i| usize::from(at.votes[i].label) < at.slits.len());
        scratch.extend(labelled.map(|i| at.tracks.crossings[i].height));
    }
    if scratch.is_empty() {
        return;
    }
    let place = scratch.len() * 9 / 10;
    let bright = *scratch.select_nth_unstable_by(place, f32::total_cmp).1;
    for y in lines() {
        let line = at.tracks.of(y);
        for i in line.start + 2..line.end.saturating_sub(2).max(line.start + 2) {
            samples.extend(sample(at, i, y, MIN_LIGHT * bright));
        }
    }
}

/// The misfit of a crossing whose slit and the three on either side are known; `None` on what is no smooth surface.
fn sample(at: Located<'_>, i: usize, y: usize, least_light: f32) -> Option<Sample> {
    let label = usize::from(at.votes[i].label);
    if label < 3 || label + 3 >= at.slits.len() {
        return None;
    }
    let five = i - 2..=i + 2;
    let follow = at.votes[five.clone()].iter().zip(label - 2..).all(|(v, l)| usize::from(v.label) == l);
    if !follow || at.tracks.crossings[five.clone()].iter().any(|c| c.height < least_light) {
        return None;
    }
    let &[a, b, c, d, e] = &at.centers[five] else { return None };
    let u = [a.u, b.u, c.u, d.u, e.u];
    let gaps: [f32; 4] = std::array::from_fn(|k| u[k + 1] - u[k]);
    let even = |a: f32, b: f32| (a - b).abs() <= EVEN * 0.5 * (a + b);
    if !gaps.windows(2).all(|g| even(g[0], g[1])) || !even(u[4] - u[2], u[2] - u[0]) {
        return None;
    }
    // Image px per projector px, and per slit.
    let per_slit = 0.25 * (u[4] - u[0]);
    let scale = (u[3] - u[1]) / (at.layout.gap_px(label, 0) + at.layout.gap_px(label, 1));
    let cubic = at.layout.misfit_weights(label);
    let misfit: f32 = cubic.iter().zip(u).map(|(w, u)| w * u).sum::<f32>() / scale;
    let mut factors = [0.0; MAX_UNKNOWNS];
    let [along, beside] = at.centres.image;
    let magnified_at = |place: f32, slope: f32| across([place - along, y as f32 - beside], slope) / scale;
    let slope = at.tracks.slope(i);
    // Each centre is made of the edges of its own stripe and of its neighbours'.
    let [before, own, after] = at.layout.weights_of_stripes(label);
    for (k, weight) in cubic.iter().enumerate() {
        for (side, share) in [(0, before), (1, own), (2, after)] {
            let slit = label + k + side - 3;
            let hue = usize::from(at.slits[slit]);
            let (weight, place) = (weight * share, c.u + (slit as f32 - label as f32) * per_slit);
            let (Some(primaries), Some(channels)) =
                (at.shares.primaries.get(hue), at.shares.channels.get(hue))
            else {
                return None;
            };
            let magnified = magnified_at(place, slope);
            for k in 0..2 {
                factors[k] += weight * primaries[k];
                factors[2 + k] += weight * channels[k] * magnified;
            }
            if let Some(offset) = factors.get_mut(DISPLACEMENTS + hue) {
                *offset += weight;
            }
        }
    }
    let magnified = magnified_at(c.u, slope);
    misfit.is_finite().then_some(Sample { misfit, magnified, factors })
}
