//! σ of the stripe centres from their scatter along tracks.

use super::crossing_features::NONE;
use super::labeling::VotedLabel;
use super::stripe_centers::{SAMPLED, StripeCenter};
use super::tracks::Tracks;
use crate::solve::median_f32;

/// Variance of a centre minus the cubic through its four neighbours, over that of a centre: 1 + (1 + 16 + 16 + 1)/36 =
/// 1.94 for independent centres, 2.29 with the edges that they share.
const CUBIC_VARIANCE: f32 = 2.286;
/// Error from sampling that neighbouring stripes have in common, which no difference shows, px.
const COMMON_PX: f32 = 0.003;
/// The estimate of σ over the whole photograph has the weight of this many centres.
const PRIOR_WEIGHT: f64 = 10.0;
/// A squared residual counts at most this many times the usual one.
const MAX_RATIO: f32 = 1000.0;

/// Scales σ to the measured scatter of the centres. Each centre is compared with the cubic through the two slits on
/// either side, which shows noise, the effect of sampling and blur on edges, and detail finer than the stripes. The
/// scatter over ± `reach` scanlines along the track, and with less weight over the whole photograph, scales the
/// prediction.
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
    // The median of the square of a normal variable. The prediction must suffice where no five slits stand side by
    // side.
    let usual = median_f32(scratch).map_or(1.0, |m| (m / 0.455).clamp(0.01, 100.0));
    for track in tracks.iter() {
        sums.clear();
        sums.push((0.0, 0.0));
        let (mut sum, mut n) = (0.0_f64, 0.0_f64);
        for &i in track {
            let ratio = ratios[i as usize];
            if ratio.is_finite() {
                // A truncated stripe that was not detected must not dominate.
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
