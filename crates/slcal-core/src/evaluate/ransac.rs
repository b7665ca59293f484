//! Consensus and refinement, for any kind of surface.

use nalgebra::Point3;

use super::report::FitConfig;
use crate::solve::median;

/// Points on which a proposal is scored; enough to estimate shares of the cloud to a few per cent.
const JUDGES: usize = 2000;
/// Rounds of refinement; the limit converges in a few.
const ROUNDS: usize = 30;
/// Lower limit of the scatter as a share of the distance from the camera: the resolution of 32-bit coordinates.
const LEAST_SCATTER: f64 = 1e-6;

/// A surface that can be proposed, measured against and refined.
pub(super) trait FitModel: Sized {
    /// Points that determine it.
    const SAMPLE: usize;
    /// The surface through a sample; `None` when there is none, or none that the camera could see.
    fn through(sample: &[Point3<f64>], camera: &Point3<f64>) -> Option<Self>;
    /// Distance of a point from it, mm; infinite for points of its far side.
    fn distance(&self, p: &Point3<f64>, camera: &Point3<f64>) -> f64;
    /// Its least-squares fit to points, starting from itself.
    fn refined(&self, points: &[Point3<f64>], camera: &Point3<f64>) -> Option<Self>;
}

/// Steele, Lea and Flood's `SplitMix64`: small, and the same on every machine.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        ((u128::from(z) * n as u128) >> 64) as usize
    }
}

/// The surface with the best consensus, refined, and the inlier limit, mm.
pub(super) fn fit<S: FitModel>(
    points: &[Point3<f64>],
    camera: &Point3<f64>,
    config: &FitConfig,
) -> Option<(S, f64)> {
    let mut distances: Vec<f64> = points.iter().map(|p| (p - camera).norm()).collect();
    let far = median(&mut distances)?;
    let start = config.consensus_percent / 100.0 * far;
    let mut random = Random(config.seed);
    let judges: Vec<Point3<f64>> = if points.len() <= JUDGES {
        points.to_vec()
    } else {
        (0..JUDGES).map(|_| points[random.below(points.len())]).collect()
    };
    let mut best: Option<(f64, S)> = None;
    let mut sample = vec![Point3::origin(); S::SAMPLE];
    for _ in 0..config.samples {
        for s in &mut sample {
            *s = points[random.below(points.len())];
        }
        let Some(surface) = S::through(&sample, camera) else { continue };
        // Truncated squares: among surfaces with equal numbers of inliers the closer one wins.
        let cost: f64 = judges.iter().map(|p| (surface.distance(p, camera) / start).powi(2).min(1.0)).sum();
        if best.as_ref().is_none_or(|b| cost < b.0) {
            best = Some((cost, surface));
        }
    }
    let (cost, mut surface) = best?;
    if cost.is_nan() || cost >= judges.len() as f64 {
        return None;
    }
    let mut limit = start;
    let mut inliers = Vec::with_capacity(points.len());
    for _ in 0..ROUNDS {
        inliers.clear();
        inliers.extend(points.iter().filter(|p| surface.distance(p, camera) <= limit));
        if inliers.len() < S::SAMPLE {
            return None;
        }
        surface = surface.refined(&inliers, camera)?;
        let mut residuals: Vec<f64> = inliers.iter().map(|p| surface.distance(p, camera)).collect();
        let sigma = 1.4826 * median(&mut residuals)?;
        let next = config.inlier_sigmas * sigma.max(LEAST_SCATTER * far);
        let settled = (next / limit - 1.0).abs() < 1e-3;
        limit = next;
        if settled {
            break;
        }
    }
    Some((surface, limit))
}
