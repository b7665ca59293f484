//! Stripe centres against known maps from projector to image.

use rand::SeedableRng;
use rand_distr::{Distribution, Normal};

use super::super::center_sigma::{SigmaWork, measure_sigma};
use super::super::crossing_features::NONE;
use super::super::labeling::VotedLabel;
use super::super::slit_layout::SlitLayout;
use super::super::stripe_centers::{StripeCenter, locate, measure_half_width};
use super::super::stripe_edges::StripeEdges;
use super::super::tracks::Tracks;

/// Slits 8 px wide, 16 px apart.
const PERIOD: f64 = 16.0;
const HALF: f64 = 4.0;

fn crossing(left: f64, right: f64) -> StripeEdges {
    StripeEdges {
        left: left as f32,
        right: right as f32,
        height: 0.5,
        edge_sigma: 0.05,
        approximate_color: [0.577; 3],
    }
}

/// The edges of `n` slits where `u` maps projector columns to the image.
fn edges(n: usize, u: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    (0..n).map(|k| PERIOD * k as f64).map(|x| [u(x - HALF), u(x + HALF)]).collect()
}

fn layout(gaps: &[f32]) -> SlitLayout {
    let mut layout = SlitLayout::default();
    layout.set(gaps.iter().copied(), HALF as f32);
    layout
}

/// All crossings of scanlines, the k-th of each being slit k, and their centres.
struct LabeledCrossings {
    tracks: Tracks,
    votes: Vec<VotedLabel>,
    gaps: Vec<f32>,
    half_px: f32,
    centers: Vec<StripeCenter>,
}

fn labeled(lines: &[Vec<[f64; 2]>]) -> LabeledCrossings {
    let (mut tracks, mut votes) = (Tracks::default(), Vec::new());
    tracks.clear();
    for line in lines {
        tracks.crossings.extend(line.iter().map(|e| crossing(e[0], e[1])));
        tracks.lines.push(tracks.crossings.len() as u32);
        votes.extend((0..line.len()).map(|k| VotedLabel { label: k as u16, support: 1.0 }));
    }
    tracks.link();
    let gaps = vec![PERIOD as f32; lines[0].len() - 1];
    let (mut scratch, mut centers) = (Vec::new(), Vec::new());
    let layout = layout(&gaps);
    let half_px = measure_half_width(&tracks, &votes, &layout, &mut scratch);
    locate(&tracks, &votes, &layout, &mut scratch, &mut centers);
    LabeledCrossings { tracks, votes, gaps, half_px, centers }
}

/// Largest errors of the centres and of the midpoints of the edges, over all slits but those at either end.
fn worst(seen: &[[f64; 2]], centers: &[StripeCenter], u: impl Fn(f64) -> f64) -> (f64, f64) {
    let inner = 1..seen.len() - 1;
    let error = |k: usize, at: f64| (at - u(PERIOD * k as f64)).abs();
    let of = |f: &dyn Fn(usize) -> f64| inner.clone().map(f).fold(0.0, f64::max);
    (of(&|k| error(k, f64::from(centers[k].u))), of(&|k| error(k, 0.5 * (seen[k][0] + seen[k][1]))))
}

#[test]
fn the_centre_is_exact_to_third_order() {
    let u = |x: f64| 30.0 + 1.5 * x + 2e-3 * x * x + 4e-6 * x.powi(3);
    let seen = edges(20, u);
    let s = labeled(std::slice::from_ref(&seen));
    let (polynomial, middle) = worst(&seen, &s.centers, u);
    // The remaining error is the rounding of positions to 24 bits.
    assert!(polynomial < 2e-4 && middle > 0.08, "{polynomial} {middle}");
    // At either end there are edges on one side only.
    for k in [0, 19] {
        let error = f64::from(s.centers[k].u) - u(PERIOD * k as f64);
        assert!(!s.centers[k].truncated && error.abs() < 0.02, "{error}");
    }
}

#[test]
fn on_a_strongly_curved_surface_it_beats_the_midpoint_of_the_edges() {
    // A cylinder seen from the side: its scale falls to a third towards its outlines.
    let u = |x: f64| 500.0 + 400.0 * ((x - 304.0) / 250.0).sin();
    let seen = edges(39, u);
    let s = labeled(std::slice::from_ref(&seen));
    assert!(s.centers.iter().all(|c| !c.truncated));
    let (polynomial, middle) = worst(&seen, &s.centers, u);
    assert!(polynomial < 2e-3 && middle > 0.04, "{polynomial} {middle}");
}

#[test]
fn a_truncated_stripe_is_detected_whichever_side_is_missing() {
    let whole = edges(15, |x| 20.0 + 2.0 * x);
    for lost in [1.5, 2.5, 4.0, 6.0, 9.0] {
        for side in [0, 1] {
            let mut seen = whole.clone();
            seen[7][side] += if side == 0 { lost } else { -lost };
            let s = labeled(std::slice::from_ref(&seen));
            let truncated: Vec<usize> = (0..15).filter(|&k| s.centers[k].truncated).collect();
            assert_eq!(truncated, [7], "{lost} px off side {side}");
            assert!(s.centers[7].u.is_nan());
        }
    }
}

#[test]
fn a_fold_in_a_gap_does_not_truncate_the_stripes_beside_it() {
    // The scale doubles in the middle of the gap behind slit 6.
    let fold = 6.5 * PERIOD;
    let u = |x: f64| 20.0 + 1.5 * x + 1.5 * (x - fold).max(0.0);
    let seen = edges(14, u);
    let s = labeled(std::slice::from_ref(&seen));
    assert!(s.centers.iter().all(|c| !c.truncated));
    // Away from the fold all edges lie on one plane. Beside it, the narrower stripe is compared with its own side.
    for k in (0..14).filter(|&k| k != 7) {
        let error = f64::from(s.centers[k].u) - u(PERIOD * k as f64);
        assert!(error.abs() < 1e-3, "{error} at {k}");
    }
}

/// A plane in perspective, 12 image px per projector px, whose scale changes by the share `bend` at column `fold`.
fn folded(fold: f64, bend: f64) -> impl Fn(f64) -> f64 {
    let plane = |x: f64| (20.0 + 12.0 * x) / (1.0 + 1e-4 * x);
    move |x| plane(x) + bend * (plane(x) - plane(fold)).max(0.0)
}

#[test]
fn a_fold_moves_no_centre_wherever_it_lies() {
    for bend in [-0.4, -0.25, -0.1, 0.1, 0.3, 0.5, 0.7] {
        for step in 0..64 {
            let fold = 7.0 * PERIOD + 0.25 * f64::from(step);
            let u = folded(fold, bend);
            let s = labeled(&[edges(16, &u)]);
            for k in (1..15).filter(|&k| !s.centers[k].truncated) {
                let error = (f64::from(s.centers[k].u) - u(PERIOD * k as f64)).abs() / 12.0;
                // Cubics through edges on both sides are off by up to a fifth of a pixel with the fold in a gap, and
                // half a pixel in a stripe. The remaining error comes from perspective beside straight lines, and from
                // the expected noise.
                assert!(error < 0.02, "{error} projector px at {k}: bend {bend} at {fold}");
            }
            assert!(s.centers.iter().filter(|c| c.truncated).count() <= 1, "bend {bend} at {fold}");
        }
    }
}

#[test]
fn a_rounded_edge_wider_than_a_period_is_no_fold() {
    // The scale changes from 1 to 1.6 as a logistic curve; this is its integral.
    for width in [10.0, 14.0, 20.0] {
        for shift in 0..16 {
            let at = 7.0 * PERIOD + f64::from(shift);
            let u = |x: f64| 12.0 * (x + 0.6 * width * ((x - at) / width).exp().ln_1p());
            let s = labeled(&[edges(16, u)]);
            let error = |k: usize| (f64::from(s.centers[k].u) - u(PERIOD * k as f64)).abs() / 12.0;
            let worst = (1..15).map(error).fold(0.0, f64::max);
            // The error of the cubic; the two planes of a fold would be off by a quarter of a pixel.
            assert!(worst < 0.007, "{worst} projector px: {width} px wide at {at}");
        }
    }
}

#[test]
fn fold_detection_costs_no_accuracy_on_a_plane() {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(11);
    let noise = Normal::new(0.0, 0.05).unwrap();
    let u = |x: f64| 30.0 + 1.2 * x;
    let lines: Vec<_> = (0..400)
        .map(|_| edges(20, u).into_iter().map(|e| e.map(|x| x + noise.sample(&mut rng))).collect())
        .collect();
    let s = labeled(&lines);
    let errors: Vec<f64> = (0..s.centers.len())
        .filter(|i| (2..18).contains(&(i % 20)) && !s.centers[*i].truncated)
        .map(|i| f64::from(s.centers[i].u) - u(PERIOD * (i % 20) as f64))
        .collect();
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    // The cubic weighs the edges by -1, 9, 9 and -1 sixteenths.
    let cubic = 0.05 * 164.0_f64.sqrt() / 16.0;
    assert!((rms / cubic - 1.0).abs() < 0.03, "{rms} {cubic}");
}

#[test]
fn the_width_of_the_slits_is_measured_as_photographed() {
    // Light spills over by 0.7 projector px to either side.
    let seen: Vec<[f64; 2]> =
        edges(12, |x| 3.0 * x).iter().map(|e| [e[0] - 3.0 * 0.7, e[1] + 3.0 * 0.7]).collect();
    let half = labeled(&[seen]).half_px;
    assert!((half - 4.7).abs() < 1e-3, "{half}");
    // No slit has neighbours on both sides: the drawn width is used.
    assert!((labeled(&[edges(2, |x| 3.0 * x)]).half_px - 4.0).abs() < 1e-6);
}

#[test]
fn sigma_is_the_scatter_of_the_centres_for_any_prediction() {
    let u = |x: f64| 30.0 + 1.5 * x + 1e-3 * x * x;
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
    for truth in [0.02, 0.05, 0.12] {
        let noise = Normal::new(0.0, truth).unwrap();
        let lines: Vec<_> = (0..150)
            .map(|_| edges(20, u).into_iter().map(|e| e.map(|x| x + noise.sample(&mut rng))).collect())
            .collect();
        let mut s = labeled(&lines);
        measure_sigma(&s.tracks, &s.votes, 12, &mut SigmaWork::default(), &mut s.centers);
        let ratios: Vec<f64> = s
            .centers
            .iter()
            .enumerate()
            .filter(|(i, c)| (2..18).contains(&(i % 20)) && !c.truncated)
            .map(|(i, c)| (f64::from(c.u) - u(PERIOD * (i % 20) as f64)) / f64::from(c.sigma))
            .collect();
        assert!(ratios.len() > 2300, "{}", ratios.len());
        let within = ratios.iter().filter(|r| r.abs() < 1.0).count() as f64 / ratios.len() as f64;
        assert!((0.65..0.71).contains(&within), "{within} within σ of {truth}");
    }
}

#[test]
fn unlabelled_crossings_have_no_centre() {
    let mut s = labeled(&[edges(5, |x| 2.0 * x)]);
    s.votes[2].label = NONE;
    let layout = layout(&s.gaps);
    locate(&s.tracks, &s.votes, &layout, &mut Vec::new(), &mut s.centers);
    assert!(s.centers[2].u.is_nan() && s.centers[1].u.is_finite());
    locate(&Tracks::default(), &[], &layout, &mut Vec::new(), &mut s.centers);
    assert!(s.centers.is_empty());
}
