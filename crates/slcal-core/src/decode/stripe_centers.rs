//! Where a slit's centre lies between the edges of its stripe, and which stripes are cut so that it cannot be told.
//!
//! Projector columns between edges are known: half a slit to either side of its own centre, and the edges of the
//! neighbouring slits beyond. The polynomial through these edges, taken at the centre, allows for perspective and
//! curvature, which move the centre away from the middle of the two edges. No polynomial follows a fold; where the scale says
//! that there is one, the centre lies on the plane before or behind it.

use super::labeling::VotedLabel;
use super::sequence_alignment::NONE;
use super::slit_layout::{SlitLayout, polynomial_at_zero};
use super::stripe_edges::StripeEdges;
use super::tracks::Tracks;
use crate::solve::median_f32;

/// Scales (image px per projector px) of a stripe and of the gap beside it differ by less than this factor on one
/// surface.
const MAX_SCALE_RATIO: f32 = 1.8;
/// A stripe narrower than its gaps and neighbours let expect by this share is cut: by a twelfth, its middle is off by a
/// third of a projector pixel in a slit of eight.
const MIN_NARROWING: f32 = 0.08;
/// The same where only one side is there to tell.
const MIN_NARROWING_AT_END: f32 = 0.12;
/// Stripes wider than expected are not cut; where light fades along them they may seem so, by this share and no more.
const MAX_WIDE_SHARE: f32 = 0.15;
/// Scatter of widths in units of which a cut must stand out.
const TRUNCATION_SIGMAS: f32 = 4.0;
/// What sampling and blur may make of the width of a stripe, px; much of a narrow one.
const EDGE_SLACK_PX: f32 = 0.15;
/// Share of the change of scale from one side to the other by which the expected width is uncertain.
const CURVATURE_SLACK: f32 = 0.5;
/// What noise of σ 1 in the edges makes of the difference of two steps of scale, times the width of the slits: four edges a
/// slit's width apart count 1, 3, 3 and 1 times.
const STEP_NOISE: f32 = 4.47;
/// A fold shows from this many times what noise makes of the change of scale, and is certain at twice that.
const FOLD_SIGMAS: f32 = 3.0;
/// A step of scale so many times those beside it is a fold, or a bend narrower than a period, which stripes cannot tell
/// from one.
const SMOOTH_GROWTH: f32 = 8.0;

/// Variance of a centre less the cubic through its four neighbours, over that of a centre: 1 + (1 + 16 + 16 + 1)/36 = 1.94 if
/// centres were independent, 2.29 by the edges that they share.
const CUBIC_VARIANCE: f32 = 2.286;
/// What sampling does to neighbouring stripes alike, which no difference shows, px.
const COMMON_PX: f32 = 0.003;
/// What the whole photograph says of σ counts as much as this many centres.
const PRIOR_WEIGHT: f64 = 10.0;
/// A squared miss counts at most this many times what is usual.
const MAX_RATIO: f32 = 1000.0;
/// Every so many lines tell a median as well as all.
const SAMPLED: usize = 4;

/// Position of a slit's centre on a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StripeCenter {
    /// Sub-pixel position, px; NaN for a crossing without a number or one that is cut.
    pub(super) u: f32,
    /// 1σ as predicted from the noise of pixels, px.
    pub(super) sigma: f32,
    /// Whether an outline or a shadow cuts the stripe.
    pub(super) truncated: bool,
}

/// A crossing and what stands beside it on the same surface.
#[derive(Debug, Clone, Copy)]
struct StripeNeighbors {
    own: StripeEdges,
    label: usize,
    before: Option<StripeEdges>,
    after: Option<StripeEdges>,
}

/// Image px per projector px of the parts about a crossing; `None` where there is nothing on the same surface.
struct LocalScales {
    own: f32,
    gap: [Option<f32>; 2],
    stripe: [Option<f32>; 2],
}

impl StripeNeighbors {
    fn at(tracks: &Tracks, votes: &[VotedLabel], line: std::ops::Range<usize>, i: usize) -> Self {
        let label = votes[i].label;
        let before =
            (i > line.start && label > 0 && votes[i - 1].label == label - 1).then(|| tracks.crossings[i - 1]);
        let after = (i + 1 < line.end && label + 1 == votes[i + 1].label).then(|| tracks.crossings[i + 1]);
        Self { own: tracks.crossings[i], label: usize::from(label), before, after }
    }

    /// Scales of what is on the same surface; a neighbour behind a gap unlike itself is forgotten.
    fn scales(&mut self, layout: &SlitLayout) -> LocalScales {
        let per_stripe = 0.5 / layout.half_px();
        let scale = |image: f32, per_projector: f32| (image * per_projector).max(1e-6);
        let own = scale(self.own.width(), per_stripe);
        let mut scales = LocalScales { own, gap: [None; 2], stripe: [None; 2] };
        for side in 0..2 {
            let Some(other) = (if side == 0 { self.before } else { self.after }) else { continue };
            let distance = if side == 0 { self.own.left - other.right } else { other.left - self.own.right };
            let gap = scale(distance, layout.per_gap(self.label, side));
            let stripe = scale(other.width(), per_stripe);
            let near = |a: f32, b: f32| a < MAX_SCALE_RATIO * b && b < MAX_SCALE_RATIO * a;
            if near(gap, own) && near(gap, stripe) {
                scales.gap[side] = Some(gap);
            } else {
                *(if side == 0 { &mut self.before } else { &mut self.after }) = None;
            }
            if near(gap, stripe) {
                scales.gap[side] = Some(gap);
                scales.stripe[side] = Some(stripe);
            }
        }
        scales
    }
}

/// The difference over the mean; nearly the logarithm of the ratio, and much quicker.
fn relative(a: f32, b: f32) -> f32 {
    2.0 * (a - b) / (a + b)
}

/// Which neighbours bear out the width of a stripe.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Confirmation {
    Both,
    /// One side, and how much of what is tolerated it took, 0–1.
    Side(usize, f32),
}

impl LocalScales {
    /// By how much the width is more than the expected one, as a share, and how far it may be off for the change of scale
    /// about, by interpolation between the gaps.
    fn between(&self) -> Option<(f32, f32)> {
        let [a, b] = [self.gap[0]?, self.gap[1]?];
        Some((relative(self.own, 0.5 * (a + b)), CURVATURE_SLACK * 0.5 * relative(a, b).abs()))
    }

    /// The same by extrapolation from the gap and the stripe on one side.
    fn beyond(&self, side: usize) -> Option<(f32, f32)> {
        let (gap, stripe) = (self.gap[side]?, self.stripe[side]?);
        Some((relative(self.own, gap * gap / stripe), CURVATURE_SLACK * 2.0 * relative(gap, stripe).abs()))
    }

    /// How certain it is, 0–1, that the surface has a fold in the stripe or in a gap beside it, where noise makes `noise` of the
    /// difference of two steps of scale. A fold leaves the scale as it was on one side at least; where the surface is curved,
    /// the scale changes from part to part throughout.
    fn fold(&self, noise: f32) -> f32 {
        let [Some(a), Some(b)] = self.gap else { return 0.0 };
        let least = FOLD_SIGMAS * noise;
        if (self.own - a).abs().max((b - self.own).abs()) < least {
            return 0.0;
        }
        let [Some(before), Some(after)] = self.stripe else { return 0.0 };
        // Steps along the line; those the way of the whole change are positive.
        let sign = if after > before { 1.0 } else { -1.0 };
        let [first, left, right, last] =
            [a - before, self.own - a, b - self.own, after - b].map(|s| sign * s);
        let stands_out = |step: f32, one: f32, other: f32| {
            step - SMOOTH_GROWTH * (one.abs().max(other.abs()) - noise).max(0.0)
        };
        let beside = stands_out(right, first, left).max(stands_out(left, right, last));
        let within = stands_out(left.min(right), first, last);
        (beside.max(within) / least - 1.0).clamp(0.0, 1.0)
    }

    /// Who bears out that the stripe is whole; on a surface with a fold in the gap beside it, only the other side can.
    fn confirmation(&self, scatter: f32, width_px: f32) -> Option<Confirmation> {
        // How much of what is tolerated a misfit takes.
        let misfit_share = |(misfit, slack): (f32, f32), least: f32| {
            let narrow = least.max(TRUNCATION_SIGMAS * scatter) + slack + EDGE_SLACK_PX / width_px;
            if misfit < 0.0 { -misfit / narrow } else { misfit / (narrow + MAX_WIDE_SHARE) }
        };
        if self.between().is_some_and(|m| misfit_share(m, MIN_NARROWING) < 1.0) {
            return Some(Confirmation::Both);
        }
        let least = if self.gap.iter().all(Option::is_some) { MIN_NARROWING } else { MIN_NARROWING_AT_END };
        let sides = (0..2).filter_map(|side| Some((side, misfit_share(self.beyond(side)?, least))));
        let best = sides.min_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, misfit_share)| *misfit_share < 1.0);
        best.map(|(side, misfit_share)| Confirmation::Side(side, misfit_share))
    }
}

/// Half the width of the stripes as photographed, in projector px: light that spills over makes them wider than they
/// were drawn.
pub(super) fn measure_half_width(
    tracks: &Tracks,
    votes: &[VotedLabel],
    layout: &SlitLayout,
    scratch: &mut Vec<f32>,
) -> f32 {
    scratch.clear();
    for y in (0..tracks.line_count()).step_by(SAMPLED) {
        let line = tracks.of(y);
        for i in line.clone().filter(|&i| votes[i].label != NONE) {
            let n = StripeNeighbors::at(tracks, votes, line.clone(), i);
            if let (Some(a), Some(b)) = (n.before, n.after) {
                // From the middles of the gaps on either side, the stripe's share of a period.
                let period = 0.5 * (b.left + n.own.right - a.right - n.own.left);
                let projector = 0.5 * (layout.gap_px(n.label, 0) + layout.gap_px(n.label, 1));
                scratch.push(0.5 * projector * n.own.width() / period);
            }
        }
    }
    let drawn = layout.half_px();
    let half = median_f32(scratch).unwrap_or(drawn);
    if half.is_finite() { half.clamp(0.5 * drawn, 1.7 * drawn) } else { drawn }
}

/// Centres of all numbered crossings, into `out`, one per crossing.
pub(super) fn locate(
    tracks: &Tracks,
    votes: &[VotedLabel],
    layout: &SlitLayout,
    scratch: &mut Vec<f32>,
    out: &mut Vec<StripeCenter>,
) {
    let each = |step: usize, visit: &mut dyn FnMut(usize, StripeNeighbors, LocalScales)| {
        for y in (0..tracks.line_count()).step_by(step) {
            let line = tracks.of(y);
            for i in line.clone().filter(|&i| votes[i].label != NONE) {
                let mut n = StripeNeighbors::at(tracks, votes, line.clone(), i);
                let scales = n.scales(layout);
                visit(i, n, scales);
            }
        }
    };
    scratch.clear();
    each(SAMPLED, &mut |_, _, scales| scratch.extend(scales.between().map(|m| m.0.abs())));
    // The median of |x| of a normal variable.
    let scatter = median_f32(scratch).unwrap_or(0.0) / 0.6745;
    out.clear();
    out.resize(tracks.crossings.len(), StripeCenter { u: f32::NAN, sigma: 0.0, truncated: false });
    let step_noise = STEP_NOISE / (2.0 * layout.half_px());
    each(1, &mut |i, n, scales| {
        // A stripe alone on its surface may be cut or not: nothing tells.
        let Some(confirmation) = scales.confirmation(scatter, n.own.width()) else {
            out[i].truncated = true;
            return;
        };
        let smooth = match confirmation {
            Confirmation::Both => interpolate(&n, layout),
            Confirmation::Side(side, misfit_share) => at_end(&n, side, misfit_share, layout),
        };
        // A misfit is half a difference of steps.
        let fold = scales.fold((2.0 * scatter * scales.own).max(step_noise * n.own.edge_sigma));
        let (u, gain) = if fold > 0.0 { on_fold(&n, fold, smooth, layout) } else { smooth };
        out[i] = StripeCenter { u, sigma: gain * n.own.edge_sigma, truncated: false };
    });
}

/// The polynomial through the edges at the slit's centre, and σ of it over σ of an edge.
fn interpolate(n: &StripeNeighbors, layout: &SlitLayout) -> (f32, f32) {
    let half = layout.half_px();
    let own = [(-half, n.own.left), (half, n.own.right)];
    let before = |c: &StripeEdges| (half - layout.gap_px(n.label, 0), c.right);
    let after = |c: &StripeEdges| (layout.gap_px(n.label, 1) - half, c.left);
    match (&n.before, &n.after) {
        (Some(b), Some(a)) => layout.cubic(n.label, (n.own.left, n.own.right), b.right, a.left),
        (Some(b), None) => polynomial_at_zero(&[own[0], own[1], before(b)]),
        (None, Some(a)) => polynomial_at_zero(&[own[0], own[1], after(a)]),
        (None, None) => polynomial_at_zero(&own),
    }
}

/// The centre where the surface is folded as certainly as `fold` says: on one of the two planes that the edges on either side
/// lie on, as far as there is a fold, and else where it would be on a smooth surface.
fn on_fold(n: &StripeNeighbors, fold: f32, smooth: (f32, f32), layout: &SlitLayout) -> (f32, f32) {
    let (Some(before), Some(after)) = (n.before, n.after) else { return smooth };
    let (half, gaps) = (layout.half_px(), [layout.gap_px(n.label, 0), layout.gap_px(n.label, 1)]);
    let left = polynomial_at_zero(&[(-half - gaps[0], before.left), (-half, n.own.left)]);
    let right = polynomial_at_zero(&[(half, n.own.right), (half + gaps[1], after.right)]);
    // Where the scale grows along the line, positions follow the greater of the two straight lines, else the smaller.
    let grows = after.width() > before.width();
    let plane = if grows == (left.0 > right.0) { left } else { right };
    (smooth.0 + fold * (plane.0 - smooth.0), smooth.1 + fold * (plane.1 - smooth.1))
}

/// The centre of the last stripe of a surface: its outer edge may be an outline. The more its width strains what the
/// inner edges let expect, the more these alone decide.
fn at_end(n: &StripeNeighbors, side: usize, misfit_share: f32, layout: &SlitLayout) -> (f32, f32) {
    let (Some(other), sign) =
        (if side == 0 { n.before } else { n.after }, if side == 0 { -1.0 } else { 1.0 })
    else {
        // Beside a fold not even the neighbour that bears the width out has an edge to add.
        return interpolate(&StripeNeighbors { before: None, after: None, ..*n }, layout);
    };
    let (half, gap) = (layout.half_px(), layout.gap_px(n.label, side));
    let (inner, outer) = if side == 0 { (n.own.left, n.own.right) } else { (n.own.right, n.own.left) };
    let (near, far) = if side == 0 { (other.right, other.left) } else { (other.left, other.right) };
    let nodes = [
        (sign * half, inner),
        (sign * (gap - half), near),
        (sign * (gap + half), far),
        (-sign * half, outer),
    ];
    let (with, without) = (polynomial_at_zero(&nodes), polynomial_at_zero(&[nodes[0], nodes[1], nodes[2]]));
    (with.0 + misfit_share * (without.0 - with.0), with.1 + misfit_share * (without.1 - with.1))
}

/// Makes σ what the scatter of the centres says: each is compared with the cubic through the two slits on either side,
/// which tells noise, what sampling and blur do to edges, and detail finer than the stripes alike. The scatter over ±
/// `reach` lines along the curve, and with less weight over the whole photograph, scales the prediction.
pub(super) fn measure_sigma(
    tracks: &Tracks,
    votes: &[VotedLabel],
    reach: usize,
    work: &mut SigmaWork,
    centers: &mut [StripeCenter],
) {
    let SigmaWork { ratios, scratch, sums } = work;
    ratios.clear();
    ratios.resize(centers.len(), f32::NAN);
    scratch.clear();
    for y in 0..tracks.line_count() {
        let line = tracks.of(y);
        for i in line.start + 2..line.end.saturating_sub(2).max(line.start + 2) {
            let label = votes[i].label;
            // NONE is far above any label that has two more beyond it.
            if !(2..NONE - 2).contains(&label)
                || votes[i - 2..=i + 2].iter().zip(label - 2..).any(|(v, l)| v.label != l)
            {
                continue;
            }
            let &[a, b, StripeCenter { u: c, .. }, d, e] = &centers[i - 2..=i + 2] else { continue };
            let (a, b, d, e) = (a.u, b.u, d.u, e.u);
            let miss = c - (4.0 * (b + d) - a - e) / 6.0;
            let ratio = miss * miss / (CUBIC_VARIANCE * centers[i].sigma * centers[i].sigma);
            if ratio.is_finite() {
                ratios[i] = ratio;
                if y % SAMPLED == 0 {
                    scratch.push(ratio);
                }
            }
        }
    }
    // The median of the square of a normal variable; some prediction must do where no five slits stand side by side.
    let usual = median_f32(scratch).map_or(1.0, |m| (m / 0.455).clamp(0.01, 100.0));
    for track in tracks.iter() {
        sums.clear();
        sums.push((0.0, 0.0));
        let (mut sum, mut n) = (0.0_f64, 0.0_f64);
        for &i in track {
            let ratio = ratios[i as usize];
            if ratio.is_finite() {
                // One that is cut unnoticed shall not speak for all.
                sum += f64::from(ratio.min(MAX_RATIO * usual));
                n += 1.0;
            }
            sums.push((sum, n));
        }
        for (at, &i) in track.iter().enumerate() {
            let (from, to) = (sums[at.saturating_sub(reach)], sums[(at + reach + 1).min(track.len())]);
            let (sum, n) = (to.0 - from.0, to.1 - from.1);
            let scale = (sum + PRIOR_WEIGHT * f64::from(usual)) / (n + PRIOR_WEIGHT);
            let centre = &mut centers[i as usize];
            let variance = centre.sigma * centre.sigma * scale as f32;
            centre.sigma = (variance + COMMON_PX * COMMON_PX).sqrt();
        }
    }
}

/// Working memory of [`measure_sigma`].
#[derive(Debug, Clone, Default)]
pub(super) struct SigmaWork {
    ratios: Vec<f32>,
    scratch: Vec<f32>,
    sums: Vec<(f64, f64)>,
}
