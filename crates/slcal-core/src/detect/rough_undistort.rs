//! Rough undistortion: one radial coefficient, estimated from the board's corners, that makes straight edges straight.
//!
//! It serves the search only. Calibration estimates distortion from the measurements.

use nalgebra::Point2;

use crate::geometry::Homography;
use crate::observations::CornerPair;
use crate::solve::homography_from_points;

/// Undistorted = centre + (distorted − centre)·(1 + k·r²), with r = 1 at half the diagonal of the frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RoughLens {
    centre: Point2<f64>,
    half_diagonal: f64,
    k: f64,
}

/// Ordinary lenses stay within this; it also keeps the map invertible in and around the frame.
const MAX_K: f64 = 0.3;
/// The lens is used when it lowers the rms of the corners to this part of the rms of a homography alone.
const WORTHWHILE: f64 = 0.7;

impl RoughLens {
    /// No distortion.
    pub(super) fn none(width: usize, height: usize) -> Self {
        Self {
            centre: Point2::new((width as f64 - 1.0) / 2.0, (height as f64 - 1.0) / 2.0),
            half_diagonal: (width as f64).hypot(height as f64) / 2.0,
            k: 0.0,
        }
    }

    /// A lens of given k.
    pub(super) fn radial(width: usize, height: usize, k: f64) -> Self {
        Self { k, ..Self::none(width, height) }
    }

    /// The lens under which the corners are best explained by a homography (golden-section search).
    pub(super) fn from_corners(width: usize, height: usize, pairs: &[CornerPair]) -> Self {
        let lens = |k: f64| Self::radial(width, height, k);
        let rms = |k: f64| lens(k).rms(pairs);
        let inverse_golden = (5.0_f64.sqrt() - 1.0) / 2.0;
        let (mut low, mut high) = (-MAX_K, MAX_K);
        for _ in 0..24 {
            let width = (high - low) * inverse_golden;
            if rms(high - width) < rms(low + width) {
                high = low + width;
            } else {
                low = high - width;
            }
        }
        let k = f64::midpoint(low, high);
        if rms(k) < WORTHWHILE * rms(0.0) { lens(k) } else { lens(0.0) }
    }

    fn rms(&self, pairs: &[CornerPair]) -> f64 {
        let points: Vec<_> = pairs.iter().map(|p| (p.projector, self.undistort(p.camera))).collect();
        let Ok(h) = homography_from_points(&points) else { return f64::INFINITY };
        let error = |h: &Homography| -> f64 {
            points.iter().map(|(a, b)| h.map(*a).map_or(f64::INFINITY, |p| (p - b).norm_squared())).sum()
        };
        (error(&h) / points.len() as f64).sqrt()
    }

    /// The undistorted position of a point, px.
    pub(super) fn undistort(&self, p: Point2<f64>) -> Point2<f64> {
        let d = p - self.centre;
        self.centre + d * (1.0 + self.k * d.norm_squared() / self.half_diagonal.powi(2))
    }

    /// The distorted position of an undistorted point, px.
    pub(super) fn distort(&self, p: Point2<f64>) -> Point2<f64> {
        let target = (p - self.centre) / self.half_diagonal;
        let length = target.norm();
        // Newton on r·(1 + k·r²) = length, monotone within the bounds of k for points in and around the frame.
        let mut r = length;
        for _ in 0..8 {
            let slope = 1.0 + 3.0 * self.k * r * r;
            if slope < 0.1 {
                break;
            }
            r -= (r * (1.0 + self.k * r * r) - length) / slope;
        }
        let ratio = if length > 0.0 { r / length } else { 1.0 };
        self.centre + target * (ratio * self.half_diagonal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;

    #[test]
    fn distort_inverts_undistort() {
        let lens = RoughLens { k: -0.12, ..RoughLens::none(1280, 960) };
        for p in [Point2::new(0.0, 0.0), Point2::new(639.5, 479.5), Point2::new(1200.0, 30.0)] {
            assert!((lens.distort(lens.undistort(p)) - p).norm() < 1e-9);
        }
    }

    #[test]
    fn the_coefficient_is_estimated_from_a_distorted_board_and_is_zero_for_an_undistorted_one() {
        let truth = RoughLens { k: 0.05, ..RoughLens::none(1280, 960) };
        let h = Homography(Matrix3::new(0.9, 0.1, 200.0, -0.05, 1.0, 100.0, 1e-4, 5e-5, 1.0));
        let board = |lens: &RoughLens| -> Vec<CornerPair> {
            (0..70)
                .map(|i| {
                    let projector =
                        Point2::new(300.0 + f64::from(i % 10) * 48.0, 200.0 + f64::from(i / 10) * 48.0);
                    CornerPair {
                        projector,
                        camera: lens.distort(h.map(projector).unwrap()),
                        sigma_px: Some(0.01),
                    }
                })
                .collect()
        };
        assert!((RoughLens::from_corners(1280, 960, &board(&truth)).k - 0.05).abs() < 1e-4);
        assert!(RoughLens::from_corners(1280, 960, &board(&RoughLens::none(1280, 960))).k.abs() < 1e-6);
    }
}
