//! The position of a slit's centre between the edges of its stripe, and which stripes are truncated so that it is
//! unknown.
//!
//! The projector columns of the edges are known: half a slit to either side of its own centre, and the edges of the
//! neighbouring slits. The polynomial through these edges, evaluated at the centre, accounts for perspective and
//! curvature, which move the centre away from the midpoint of the two edges. No polynomial follows a fold. Where the
//! scale shows a fold, the centre lies on the plane before or behind it.

use super::crossing_features::NONE;
use super::labeling::VotedLabel;
use super::slit_layout::{SlitLayout, polynomial_at_zero};
use super::stripe_edges::StripeEdges;
use super::tracks::Tracks;
use crate::solve::median_f32;

/// Scales (image px per projector px) of a stripe and of the gap beside it differ by less than this factor on one
/// surface.
const MAX_SCALE_RATIO: f32 = 1.8;
/// A stripe narrower by this share than predicted from its gaps and neighbours is truncated. Narrowed by a twelfth, its
/// midpoint is off by a third of a projector pixel in a slit of eight.
const MIN_NARROWING: f32 = 0.08;
/// The same where only one side predicts the width.
const MIN_NARROWING_AT_END: f32 = 0.12;
/// Stripes wider than predicted are not truncated. Where light fades along them they may be wider, by this share at
/// most.
const MAX_WIDE_SHARE: f32 = 0.15;
/// A truncation must exceed this many σ of the widths.
const TRUNCATION_SIGMAS: f32 = 4.0;
/// Effect of sampling and blur on the width of a stripe, px; large for a narrow one.
const EDGE_SLACK_PX: f32 = 0.15;
/// Share of the change of scale from one side to the other by which the predicted width is uncertain.
const CURVATURE_SLACK: f32 = 0.5;
/// σ of the difference of two steps of scale, for σ = 1 of the edges, times the width of the slits: four edges a slit's
/// width apart have the weights 1, 3, 3 and 1.
const STEP_NOISE: f32 = 4.47;
/// A fold is detected from this many σ of the change of scale, and is certain at twice that.
const FOLD_SIGMAS: f32 = 3.0;
/// A step of scale this many times those beside it is a fold, or a bend narrower than a period, which stripes cannot
/// distinguish from one.
const SMOOTH_GROWTH: f32 = 8.0;

/// Every fourth scanline is enough for a median.
pub(super) const SAMPLED: usize = 4;

/// Position of a slit's centre on a scanline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StripeCenter {
    /// Sub-pixel position, px; NaN for a crossing that is unlabelled or truncated.
    pub(super) u: f32,
    /// 1σ as predicted from pixel noise, px.
    pub(super) sigma: f32,
    /// Whether an outline or a shadow truncates the stripe.
    pub(super) truncated: bool,
}

/// A crossing and its neighbours on the same surface.
#[derive(Debug, Clone, Copy)]
struct StripeNeighbors {
    own: StripeEdges,
    label: usize,
    before: Option<StripeEdges>,
    after: Option<StripeEdges>,
}

/// Local scale of the parts about a crossing, image px per projector px; `None` where there is nothing on the same
/// surface.
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

    /// Scales of the parts on the same surface. A neighbour behind a gap of another scale is removed.
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

/// The difference over the mean: nearly the logarithm of the ratio, and much faster.
fn relative(a: f32, b: f32) -> f32 {
    2.0 * (a - b) / (a + b)
}

/// Which neighbours confirm the width of a stripe.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Confirmation {
    Both,
    /// One side, and its misfit as a share of the tolerance, 0–1.
    Side(usize, f32),
}

impl LocalScales {
    /// Interpolation between the gaps: the width minus the predicted one, as a share, and the tolerance for the local
    /// change of scale.
    fn between(&self) -> Option<(f32, f32)> {
        let [a, b] = [self.gap[0]?, self.gap[1]?];
        Some((relative(self.own, 0.5 * (a + b)), CURVATURE_SLACK * 0.5 * relative(a, b).abs()))
    }

    /// The same by extrapolation from the gap and the stripe on one side.
    fn beyond(&self, side: usize) -> Option<(f32, f32)> {
        let (gap, stripe) = (self.gap[side]?, self.stripe[side]?);
        Some((relative(self.own, gap * gap / stripe), CURVATURE_SLACK * 2.0 * relative(gap, stripe).abs()))
    }

    /// Confidence, 0–1, that the surface has a fold in the stripe or in a gap beside it, where `noise` is the effect of
    /// noise on the difference of two steps of scale. A fold leaves the scale unchanged on one side at least; on a
    /// curved surface the scale changes from part to part throughout.
    fn fold(&self, noise: f32) -> f32 {
        let [Some(a), Some(b)] = self.gap else { return 0.0 };
        let least = FOLD_SIGMAS * noise;
        if (self.own - a).abs().max((b - self.own).abs()) < least {
            return 0.0;
        }
        let [Some(before), Some(after)] = self.stripe else { return 0.0 };
        // Steps along the line; those in the direction of the whole change are positive.
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

    /// Which neighbours confirm that the stripe is complete. On a surface with a fold in the gap beside it, only the
    /// other side can.
    fn confirmation(&self, scatter: f32, width_px: f32) -> Option<Confirmation> {
        // The misfit as a share of the tolerance.
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

/// Half the width of the stripes as photographed, in projector px. Light that spills over makes them wider than drawn.
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
                // The stripe's share of a period, measured from the middles of the gaps on either side.
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

/// Locates the centres of all labelled crossings, into `out`, one per crossing.
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
        // Nothing shows whether a stripe alone on its surface is truncated.
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

/// The polynomial through the edges at the slit's centre, and its σ over that of an edge.
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

/// The centre on a surface that is folded with the confidence `fold`. With a fold it lies on one of the two planes
/// through the edges on either side, without one on the smooth surface; the confidence interpolates between the two.
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

/// The centre of the last stripe of a surface, whose outer edge may be an outline. The larger the misfit of its width,
/// the more the inner edges alone decide.
fn at_end(n: &StripeNeighbors, side: usize, misfit_share: f32, layout: &SlitLayout) -> (f32, f32) {
    let (Some(other), sign) =
        (if side == 0 { n.before } else { n.after }, if side == 0 { -1.0 } else { 1.0 })
    else {
        // Beside a fold not even the neighbour that confirms the width adds an edge.
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
