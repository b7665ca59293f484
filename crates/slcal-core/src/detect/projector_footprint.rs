//! The projector footprint on the sheet. Its border in the photograph follows from the detected pattern.
//!
//! All points are undistorted (see [`super::rough_undistort`]).

use nalgebra::{Point2, Vector2};

use super::board::Board;
use super::rough_undistort::RoughLens;
use crate::geometry::{Homography, Line};
use crate::observations::CornerPair;
use crate::pattern::CheckerPattern;

/// The images of the four borders of the panel on the plane of the sheet.
#[derive(Debug, Clone)]
pub(super) struct ProjectorFootprint {
    borders: Vec<Line>,
}

impl ProjectorFootprint {
    /// Without a projector.
    pub(super) fn none() -> Self {
        Self { borders: Vec::new() }
    }

    pub(super) fn new(undistorted_from_projector: &Homography, panel: [u32; 2]) -> Self {
        // A pixel extends half a pixel beyond its centre.
        let [w, h] = panel.map(|n| f64::from(n) - 0.5);
        Self::between(undistorted_from_projector, [-0.5, w, h, -0.5])
    }

    /// With borders at the coordinates [upper, right, lower, left] in the pattern's pixels.
    pub(super) fn between(
        undistorted_from_projector: &Homography,
        [top, right, bottom, left]: [f64; 4],
    ) -> Self {
        let c = [(left, top), (right, top), (right, bottom), (left, bottom)].map(|(x, y)| Point2::new(x, y));
        let borders = (0..4)
            .filter_map(|i| {
                undistorted_from_projector.map_line(Line::through_pixels(c[i], c[(i + 1) % 4]))?.normalized()
            })
            .collect();
        Self { borders }
    }

    /// Whether an edge at `p` with unit normal `normal` runs along a border: within `distance_px` and a few degrees.
    pub(super) fn explains(&self, p: Point2<f64>, normal: Vector2<f64>, distance_px: f64) -> bool {
        /// cos 4°: the border is predicted to a fraction of a degree, an edge's direction is measured to a few.
        const PARALLEL: f64 = 0.9976;
        self.borders.iter().any(|l| {
            l.signed_distance_px(p).abs() <= distance_px && l.normal().dot(&normal).abs() >= PARALLEL
        })
    }

    /// Distance from the nearest border, px.
    pub(super) fn distance_px(&self, p: Point2<f64>) -> f64 {
        self.borders.iter().map(|l| l.signed_distance_px(p).abs()).fold(f64::INFINITY, f64::min)
    }
}

/// The edges of the projected picture in the photograph: the border of the footprint and the pattern's squares.
#[derive(Debug, Clone, Copy)]
pub(super) struct ProjectedEdges<'a> {
    pub(super) footprint: &'a ProjectorFootprint,
    pub(super) lens: &'a RoughLens,
    pub(super) board: Option<(&'a Board, &'a CheckerPattern)>,
    /// Points of the sheet that the projector lights: those of the board, or of a sequence. None without a projector.
    pub(super) lit: &'a [CornerPair],
}

impl ProjectedEdges<'_> {
    /// Distance of a point of the photograph from the nearest of these edges, px.
    pub(super) fn distance_px(&self, p: Point2<f64>) -> f64 {
        self.footprint.distance_px(self.lens.undistort(p)).min(self.square_distance_px(p))
    }

    /// Whether a point of the sheet, seen at `p`, lies in the projector footprint; true without a projector.
    pub(super) fn lights(&self, p: Point2<f64>) -> bool {
        let p = self.lens.undistort(p);
        if self.lit.is_empty() {
            return true;
        }
        let n = self.lit.len() as f64;
        let middle = self.lit.iter().fold(Vector2::zeros(), |sum, q| sum + q.camera.coords / n);
        let middle = self.lens.undistort(middle.into());
        let borders = &self.footprint.borders;
        borders.iter().all(|l| l.signed_distance_px(p) * l.signed_distance_px(middle) > 0.0)
    }

    /// Whether a side of the sheet at `p` is further than `reach_px` from all of these edges.
    ///
    /// The border of the footprint counts on the sheet only, towards `inward`: beyond the side no surface lies in the
    /// sheet's plane.
    pub(super) fn leaves_clear(&self, p: Point2<f64>, inward: Vector2<f64>, reach_px: f64) -> bool {
        /// The border itself is as wide as the blur of projector and camera, px.
        const BORDER_BLUR_PX: f64 = 2.0;
        let seen = self.lens.undistort(p);
        let ends = [seen - inward * BORDER_BLUR_PX, seen + inward * reach_px];
        let border = self.footprint.borders.iter().any(|l| {
            let [a, b] = ends.map(|q| l.signed_distance_px(q));
            a * b <= 0.0 || a.abs().min(b.abs()) <= BORDER_BLUR_PX
        });
        !border && self.square_distance_px(p) > reach_px
    }

    fn square_distance_px(&self, p: Point2<f64>) -> f64 {
        let p = self.lens.undistort(p);
        self.board.map_or(f64::INFINITY, |(board, pattern)| board.edge_distance_px(pattern, p))
    }
}
